//! Real-time 3D collision avoidance for fixed-wing aircraft.
//!
//! The crate decides; it reads no clock, no file and no network, allocates nothing and cannot
//! panic on any input. It implements the Fast Geometric Avoidance algorithm (FGA) of the paper
//! "Fast 3D Collision Avoidance Algorithm for Fixed Wing UAS" — equation numbers in these pages
//! are the paper's, corrected where `docs/errata.md` shows a slip — and a policy of its own that
//! predicts the turn it will really fly and certifies the separation in continuous time.
//!
//! # Which module answers which question
//!
//! | module | question |
//! |---|---|
//! | [`situation`] | what is around the aircraft? |
//! | [`vehicle`] | what can the vehicle do? |
//! | [`maneuver`] | what is commanded, and when? |
//! | [`prediction`] | where would that take the aircraft? |
//! | [`certificate`] | how close to the obstacles, in continuous time? |
//! | [`search`] | which way? |
//! | [`mission`] | how does it follow its mission, and get back to it? |
//! | [`avoider`] | the state machine over all of it |
//! | [`conflict`] | will an obstacle come too close? (paper) |
//! | [`timing`] | when must an avoiding turn begin? (paper) |
//! | [`bounds`] | can the encounter be solved at all? (paper) |
//! | [`selection`] | which way? (paper) |
//! | [`recovery`] | how does it get back to its mission? (paper) |
//!
//! # Conventions
//!
//! Local tangent plane: x east, y north, z up. Metres, seconds, radians. Course ψ is measured from
//! +x towards +y (anticlockwise seen from above), so a **left** turn makes it grow; climb angle θ
//! is positive upwards (Eq. 10–12). Names carry their units. With wind, positions and velocities
//! are those in the air mass: there the aircraft flies its airspeed along its course and every
//! ground-fixed obstacle moves with minus the wind.
#![no_std]
#![forbid(unsafe_code)]
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing
)]
#![cfg_attr(
    test,
    allow(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing
    )
)]

#[cfg(test)]
extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod algorithm4;
pub mod angle;
pub mod avoider;
pub mod bounds;
pub mod certificate;
pub mod conflict;
pub mod limit;
pub mod maneuver;
pub mod mission;
pub mod paths;
pub mod prediction;
pub mod recovery;
pub mod search;
pub mod selection;
pub mod situation;
pub mod timing;
pub mod vehicle;

/// A vector in the local frame: x east, y north, z up.
pub type Vec3 = glam::DVec3;

/// The example of the readme, compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
