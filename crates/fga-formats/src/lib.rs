//! File formats and wires of the field, read and written at the edge of fga.
//!
//! Each input is checked here once (finite, in range, consistent) and is a type in SI units and the
//! core's local frame afterwards. Each output is complete or absent.
//!
//! | module | question |
//! |---|---|
//! | [`units`] | how long is a nautical mile, and what does `kts` mean? |
//! | [`geodesy`] | where is a latitude and longitude in the local frame? |
//! | [`daa`] | what did the aircraft of a DAIDALUS recording do? |
//! | [`recordings`] | which encounters does a recording of any kind hold? |
//! | [`missions`] | which mission, fences and rally points did a ground station write? |
//! | [`terrain`] | how high is the ground, and where is that not known? |
//! | [`conf`] | how are alerts and bands configured? |
//! | [`encounters`] | which encounters does a batch file hold? |
//! | [`traffic`] | what do receivers of ADS-B say, as BaseStation lines or Beast frames? |
//! | [`decision`] | how does JSON hold a decision? |
//! | [`words`] | how do words say a decision? |
//! | [`flight_log`] | what did an aircraft do with the bank that was commanded? |
//! | [`flight`] | what does a finished flight hold, for other programs? |
//! | `export` | how does Google Earth, Cesium, a map or Foxglove get it? |
//! | [`encounter_model`] | how do aircraft fly that meet, statistically? |
//! | [`build`] | which build wrote a file? |
//! | [`atomic`] | how does a file become complete or stay absent? |
//! | [`number`] | how does a number become the same text on every machine? |
//! | [`error`] | what was wrong with an input, and where? |
//! | [`tally`] | how much of an input was used, and why not the rest? |
//!
//! Local frame: x east, y north, z up, metres; times in seconds. See the crate `fga`.
#![forbid(unsafe_code)]
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing
)]

extern crate alloc;

pub mod areas;
pub mod atomic;
pub mod build;
pub mod clock;
pub mod conf;
pub mod daa;
pub mod decision;
pub mod encounter_model;
pub mod encounters;
pub mod error;
#[cfg(feature = "export")]
pub mod export;
pub mod flight;
pub mod flight_log;
pub mod geodesy;
pub mod gzip;
pub mod missions;
pub mod number;
pub mod recordings;
pub mod tally;
pub mod terrain;
pub mod traffic;
pub mod units;
pub mod words;
pub mod zones;

pub use error::{InputError, OutputError};
