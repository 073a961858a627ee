//! What the other aircraft may do: reports in, a belief out, and from it weighted futures.
//!
//! A [`Belief`] is what is known of one aircraft: some modes of its motion, each with a weight and a Gaussian. Every report
//! updates all of them; between reports they spread. A [`Future`] is one of the motions that the belief allows.
//!
//! | module | question |
//! |---|---|
//! | [`report`] | what was reported, and how wrong may it be? |
//! | [`belief`] | where is the aircraft, and how well is that known? |
//! | [`future`] | what may it do from now on? |
//! | `prior` | what do aircraft do, before any report? |
//!
//! The filter is an interacting multiple model filter (Blom and Bar-Shalom, 1988, *The interacting multiple model algorithm
//! for systems with Markovian switching coefficients*, IEEE Trans. Automatic Control 33(8)): the modes are mixed by their
//! chance to change, each is a Kalman filter, and each is weighed by how well it foretold the report.
//!
//! Frame: the local tangent plane, x east, y north, z up, over the ground; metres, seconds, radians, turns to the left
//! positive. Horizontal vectors are complex numbers: x + iy. Horizontal errors are alike along every axis (circular);
//! σ are along one axis.
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::unwrap_used, clippy::expect_used)]
#![deny(clippy::panic, clippy::indexing_slicing)]
#![allow(
    clippy::cast_possible_truncation,
    reason = "single precision suffices for what is weighed"
)]

#[cfg(test)]
extern crate std;

pub mod belief;
mod climb;
mod complex;
pub mod future;
mod prior;
pub mod report;
mod table;
mod turn;

pub use belief::{Belief, ENDS_AFTER_S, Estimate};
pub use future::{FUTURES, Future, Futures};
pub use report::{Errors, Report, Sigma, Source};
