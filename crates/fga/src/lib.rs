//! Real-time 3D collision avoidance for fixed-wing aircraft.
//!
//! The crate decides; it reads no clock, no file and no network, allocates nothing and cannot
//! panic on any input. It predicts the turn that the aircraft will really fly, and certifies the
//! separation from every obstacle in continuous time. Its origin is the paper "Fast 3D Collision
//! Avoidance Algorithm for Fixed Wing UAS", whose equation numbers these pages use; the crate
//! `fga-paper` has the paper's own rules.
//!
//! # Which module answers which question
//!
//! | module | question |
//! |---|---|
//! | [`situation`] | what is around the aircraft? |
//! | [`vehicle`] | what can the vehicle do? |
//! | [`maneuver`] | what does a command say, and when? |
//! | [`prediction`] | where would that take the aircraft? |
//! | [`certificate`] | how close to the obstacles, in continuous time? |
//! | [`search`] | which way? |
//! | [`mission`] | how does it follow its mission, and get back to it? |
//! | [`avoider`] | the state machine over all of it |
//! | [`pilot`] | whatever decides: the seam to simulators and autopilots |
//!
//! # Conventions
//!
//! Local tangent plane: x east, y north, z up. Metres, seconds, radians. Course ψ counts from
//! +x towards +y (anticlockwise from above), so a **left** turn increases it; climb angle θ
//! is positive upwards (Eq. 10–12). Names carry their units. A
//! [`Situation`](situation::Situation) and its obstacles are over the ground. A
//! [`Hazard`](certificate::Hazard), a prediction and everything computed from them are in the air mass:
//! there the aircraft flies its airspeed along its course, and an obstacle at rest moves against the
//! wind.
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

pub mod angle;
pub mod avoider;
pub mod certificate;
pub mod limit;
pub mod maneuver;
mod meter;
pub mod mission;
pub mod pilot;
pub mod prediction;
pub mod search;
pub mod situation;
pub mod vehicle;

/// A vector in the local frame: x east, y north, z up.
pub type Vec3 = glam::DVec3;

/// The example of the readme, compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// The program of the book, compiled and run with the tests of a checkout.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/how-to-embed.md")]
struct HowToEmbed;
