//! The paper "Fast 3D Collision Avoidance Algorithm for Fixed Wing UAS" as code.
//!
//! Equation numbers in these pages are the paper's, corrected where `docs/errata.md` shows a slip;
//! [`printed`] keeps the printed forms. `docs/from-paper-to-code.md` names the function and the test of
//! every equation, table and figure. The default decision is not here but in the
//! crate `fga`; the paper's own rules also implement its [`Pilot`](fga::pilot::Pilot).
//!
//! # Which module answers which question
//!
//! | module | question |
//! |---|---|
//! | [`classification`] | static or dynamic, single or multiple (§3.1)? |
//! | [`protection`] | how large is the protected volume (Eq. 15)? |
//! | [`surveillance`] | how far does the sensor look (§2.2)? |
//! | [`conflict`] | will an obstacle come too close (Eq. 1–6, Algorithm 1)? |
//! | [`turn`] | how does bank turn the aircraft (Eq. 9–12, 60)? |
//! | [`timing`] | when must an avoiding turn begin (Eq. 16–25)? |
//! | [`bounds`] | can the encounter be solved at all (Eq. 26–53)? |
//! | [`grid`] | which direction is the cheapest that clears every obstacle (Algorithm 2)? |
//! | [`waypoint`] | which waypoint is next (Algorithm 3)? |
//! | [`dubins`] | what is the shortest flyable path to a pose (§3)? |
//! | [`paths`] | how long is the way round an obstacle (Fig. 8)? |
//! | [`algorithm_4`] | how does bank alone fly a way round (Algorithm 4)? |
//! | [`printed`] | what do the printed formulas give? |
//! | [`pilot`] | how does an aircraft fly by these rules? |
//!
//! Everything is in the air mass: obstacles are [`Hazard`](fga::certificate::Hazard)s. Conventions
//! are the same as in `fga`; no function allocates or panics.
#![no_std]
#![forbid(unsafe_code)]
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing
)]

#[cfg(test)]
extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod algorithm_4;
pub mod bounds;
pub mod classification;
pub mod conflict;
pub mod dubins;
pub mod grid;
pub mod paths;
pub mod pilot;
pub mod printed;
pub mod protection;
pub mod surveillance;
pub mod timing;
pub mod turn;
pub mod waypoint;
