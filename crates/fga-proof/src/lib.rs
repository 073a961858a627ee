//! What is proven about a manoeuvre: the flight that it leads to, and a lower bound of the separation from
//! every obstacle in continuous time.
//!
//! Whoever checks a command reads this crate. Search and mission only propose manoeuvres and legs: a wrong
//! proposal costs quality, never separation.
//!
//! | module | question |
//! |---|---|
//! | [`situation`] | what is around the aircraft? |
//! | [`vehicle`] | what can the vehicle do? |
//! | [`maneuver`] | what does a command say, and when? |
//! | [`prediction`] | where would that take the aircraft? |
//! | [`certificate`] | how close to the obstacles, in continuous time? |
//! | [`meter`] | how much work is left in this step? |
//!
//! # Conventions
//!
//! Local tangent plane: x east, y north, z up. Metres, seconds, radians. Course ψ counts from
//! +x towards +y (anticlockwise from above), so a **left** turn increases it; climb angle θ
//! is positive upwards (Eq. 10–12). Names carry their units. Obstacles are over the ground. A
//! [`Hazard`](certificate::Hazard), a prediction and everything computed from them are in the air mass:
//! there the aircraft flies its airspeed along its course, and an obstacle at rest moves against the
//! wind.
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing
    )
)]

#[cfg(test)]
extern crate std;

pub mod angle;
pub mod certificate;
pub mod limit;
pub mod maneuver;
pub mod meter;
pub mod prediction;
pub mod situation;
pub mod vehicle;

/// A vector in the local frame: x east, y north, z up.
pub type Vec3 = glam::DVec3;
