//! Policies of one's own, which this crate does not contain: it asks them at every step, with a time limit.
//!
//! | policy | who answers |
//! |---|---|
//! | `pipe:PROGRAM` | a program over a pipe, one JSON line a step ([`piped`]) |
//! | an object in Python | the package `fga` |
//!
//! All of them fly as [`OwnPilot`]: the simulator's guidance flies the mission while the policy leaves it alone, and
//! the rest of a flight in which the policy failed. The result of that flight says how the policy failed.

mod outside;
mod pilot;
mod pipe;
mod worker;

pub use outside::{FailureKind, Make, Nobody, Outside, PolicyAnswer, PolicyFailure};
pub use pilot::{OwnPilot, OwnPolicy};
pub use pipe::{PREFIX, piped};
pub use worker::{Silence, Worker};
