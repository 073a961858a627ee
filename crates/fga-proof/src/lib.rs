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
//! | [`assumptions`] | what is assumed about all of it? |
//! | [`certificate`] | how close to the obstacles, in continuous time? |
//! | [`command`] | what is flown, and what is proven about it? |
//! | [`ground`] | how high is a line above the ground? |
//! | [`zone`] | which airspace may not be flown in? |
//! | [`list`] | what holds a number of things that is known only in flight? |
//! | [`meter`] | how much work is left in this step? |
//!
//! Units, angles and frames are those of the crate `fga`; a [`Hazard`](certificate::Hazard) and a prediction are in the
//! air mass.
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::unwrap_used, clippy::expect_used)]
#![deny(clippy::panic, clippy::indexing_slicing)]

#[cfg(test)]
extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod angle;
pub mod assumptions;
pub mod certificate;
pub mod command;
pub mod ground;
pub mod limit;
pub mod list;
pub mod maneuver;
pub mod meter;
pub mod prediction;
pub mod situation;
pub mod vehicle;
pub mod zone;

/// A vector over the ground: x east, y north.
pub type Vec2 = glam::DVec2;

/// A vector in the local frame: x east, y north, z up.
pub type Vec3 = glam::DVec3;
