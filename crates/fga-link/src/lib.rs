//! The MAVLink companion: fga on a fixed-wing aircraft with ArduPlane.
//!
//! | module | question |
//! |---|---|
//! | [`companion`] | how does it react to messages? |
//! | [`authority`] | who flies, and what does each fault do? |
//! | [`ownship`], [`clock`] | where is the aircraft now, and when was that measured? |
//! | [`traffic`] | who else is there? |
//! | [`mission`], [`parameters`], [`mode`] | what does the vehicle intend, and what can it do? |
//! | [`rates`] | how often does the vehicle send its telemetry, and how often does it arrive? |
//! | [`ground`] | how high is the ground around the flight? |
//! | [`response`] | how does it follow? |
//! | [`restart`] | what does a restarted program owe? |
//! | [`hand`], [`commanded`], [`commands`] | how does it command the vehicle? |
//! | [`telling`] | what does the operator read? |
//! | [`wire`], [`signing`], [`endpoint`], [`outgoing`], [`tlog`] | how do messages become bytes and travel? |
//! | [`fly`], [`replay`] | what drives the companion: sockets and a clock, or a recording? |
//! | [`player`], [`play`], [`rc`] | how does a test play traffic and fly by keyboard? |
//! | [`config`] | how does the user configure it? |
//!
//! All decisions are in the crate `fga`; this crate connects it to a vehicle.
#![forbid(unsafe_code)]
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing
)]
#![expect(
    deprecated,
    reason = "messages that vehicles and ground stations still send"
)]

extern crate alloc;

pub mod authority;
pub mod clock;
pub mod commanded;
pub mod commands;
pub mod companion;
pub mod config;
pub mod endpoint;
pub mod fly;
pub mod ground;
pub mod hand;
pub mod mission;
pub mod mode;
mod number;
pub mod outgoing;
pub mod ownship;
pub mod parameters;
pub mod play;
pub mod player;
pub mod rates;
pub mod rc;
pub mod replay;
pub mod response;
pub mod restart;
pub mod signing;
pub mod steps;
pub mod telling;
pub mod tlog;
pub mod traffic;
pub mod wire;

pub use companion::Companion;
pub use config::Config;
pub use mavlink;
