//! Which obstacles could matter: columns of thousands, obstacles kept from step to step, and the test that
//! ends nearly every step because none comes near.
//!
//! | module | question |
//! |---|---|
//! | [`situation`] | what is around the aircraft? |
//! | [`quiet`] | is anything near the straight line ahead? |
//! | [`Kept`] | which obstacles need a look in this step? |
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::unwrap_used, clippy::expect_used)]
#![deny(clippy::panic, clippy::indexing_slicing)]

#[cfg(test)]
extern crate alloc;

mod columns;
#[cfg(test)]
mod draw;
mod kept;
pub mod quiet;
pub mod situation;

pub use kept::{Block, Kept, KeptError};
