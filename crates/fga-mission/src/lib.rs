//! How does the aircraft follow its mission, and how does it get back onto it?
//!
//! | question | answer |
//! |---|---|
//! | which leg, and which command along it? | [`Progress`] |
//! | where is the aircraft on a leg? | [`leg`] |
//! | who flies the mission, in which wind? | [`Route`] |
//! | where does a turn lead once it is over? | [`Bend`] |
//! | how does the aircraft get from one leg onto the next? | `corner` |
//! | which way onto the leg? | [`Join`] |
//! | which way onto the beginning of the leg? | `turn_round` |
//! | which leg does a way onto the mission join? | `way_back` |
//! | what where no leg can be joined, or a waypoint was missed? | `restart` |
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::unwrap_used, clippy::expect_used)]
#![deny(clippy::panic, clippy::indexing_slicing)]

#[cfg(test)]
extern crate alloc;

mod aim;
mod bend;
mod corner;
#[cfg(test)]
mod draw;
mod join;
pub mod leg;
mod progress;
mod restart;
mod route;
mod turn_round;
mod way_back;

pub use bend::{Bend, Exit, Turner};
pub use join::Join;
pub use progress::{BACK_WITHIN_M, BACK_WITHIN_RAD, Progress};
pub use route::Route;
