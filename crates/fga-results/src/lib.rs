//! What is kept of a flight or a campaign.
//!
//! | module | question |
//! |---|---|
//! | [`flight`] | how did a flight end? |
//! | [`flight_files`] | which files describe a flight? |
//! | [`flight_file`] | what does another program get of a flight? |
//! | `replay_guidance` | which alerts and bands does that page show? |
//! | [`replay_page`] | what does the page show that replays a flight? |
//! | [`campaign`] | which files describe a campaign? |
//! | [`league`] | how do policies compare over sets of encounters? |
//! | [`stress`] | in which motions does a policy fail? |
//! | [`worst`] | which results deserve a look? |
//! | [`provenance`] | where do results come from? |
//!
//! The command line, the Python package and the reproduction of the paper write with it: the same bytes.
#![forbid(unsafe_code)]

extern crate alloc;

pub mod campaign;
pub mod flight;
pub mod flight_file;
pub mod flight_files;
pub mod league;
mod named_rows;
mod parquet_rows;
pub mod provenance;
mod replay_guidance;
pub mod replay_page;
pub mod stress;
pub mod worst;
