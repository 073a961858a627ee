//! The formats against data, readers and writers from outside of this project:
//! `cargo test -p fga-formats --test formats daa::` runs the tests of one file.

extern crate alloc;

mod common;

#[cfg(feature = "beast")]
mod beast;
mod daa;
mod daidalus;
mod encounter_model;
mod encounters;
#[cfg(feature = "export")]
mod export;
mod flarm;
mod flight_log;
mod gdl90;
mod independent;
mod missions;
mod mutated;
mod recordings;
mod sbs;
mod terrain;
