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
//! | module | question | crate |
//! |---|---|---|
//! | [`situation`] | what is around the aircraft? | `fga-index` |
//! | [`vehicle`] | what can the vehicle do? | `fga-proof` |
//! | [`maneuver`] | what does a command say, and when? | `fga-proof` |
//! | [`prediction`] | where would that take the aircraft? | `fga-proof` |
//! | [`certificate`] | how close to the obstacles, in continuous time? | `fga-proof` |
//! | [`search`] | which manoeuvre is worth proving? | `fga-search` |
//! | [`mission`] | how does it follow its mission, and get back to it? | `fga-mission` |
//! | [`avoider`] | the state machine over all of it | `fga` |
//! | [`pilot`] | whatever decides: the seam to simulators and autopilots | `fga` |
//!
//! `fga-proof` proves, `fga-search`, `fga-mission` and `fga-index` propose, `fga` decides. What proposes builds on
//! `fga-proof`; the search also asks `fga-mission` where a turn leads.
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
#![deny(clippy::unwrap_used, clippy::expect_used)]
#![deny(clippy::panic, clippy::indexing_slicing)]

#[cfg(test)]
extern crate alloc;

pub mod avoider;
pub mod pilot;

pub use fga_index::situation;
pub use fga_mission as mission;
pub use fga_proof::{
    Vec2, Vec3, angle, assumptions, certificate, command, ground, limit, list, maneuver, meter,
    prediction, vehicle, zone,
};
pub use fga_search as search;

/// The example of the readme, compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// The program of the book, compiled and run with the tests of a checkout.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/how-to-embed.md")]
struct HowToEmbed;
