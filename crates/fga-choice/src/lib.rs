//! Which way is worth flying among aircraft that may do many things: the least expected cost.
//!
//! Reports of the others become beliefs ([`fga_belief`]), a belief becomes weighted futures. Each candidate is a manoeuvre,
//! predicted for the vehicle's real turn; its cost in metres is the chance of each loss times its price, the departure from the
//! mission, the extra path, the time and the change of mind. The least cost flies. So waiting, commitment and return are
//! prices.
//!
//! | module | question |
//! |---|---|
//! | [`beliefs`] | who is around? |
//! | [`candidate`] | which plans are there? |
//! | [`chance`] | how likely does a path meet the others? |
//! | [`price`] | what does a metre buy? |
//! | `recourse` | what is learned later? |
//! | [`chooser`] | which plans cost least? |
//!
//! It only proposes: zones, ground and continuous time are for the proof.
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::unwrap_used, clippy::expect_used)]
#![deny(clippy::panic, clippy::indexing_slicing)]
#![allow(
    clippy::cast_possible_truncation,
    reason = "single precision suffices for what is weighed"
)]

pub mod beliefs;
pub mod candidate;
pub mod chance;
pub mod chooser;
pub mod price;
mod recourse;

pub use beliefs::Beliefs;
pub use candidate::{Plan, Scene, Up, Way};
pub use chance::Chance;
pub use chooser::{Chooser, Ranked};
