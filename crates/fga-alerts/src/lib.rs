//! Well clear, alert levels and manoeuvre bands as the standards of detect and avoid define them.
//!
//! The core `fga` decides; this crate speaks the language in which standards, displays and
//! regulators judge: how near is a volume, which level does that alert, which directions, speeds
//! and altitudes lead into a conflict, which resolution is preferred? It reads no clock and no file, and
//! cannot panic on any input.
//!
//! # Which item answers which question
//!
//! | item | question |
//! |---|---|
//! | [`volume`] | when do straight lines violate NMAC, well clear, a cylinder, TCAS thresholds? |
//! | [`Pair`] | how do two aircraft approach each other? |
//! | [`severity`] | how bad is a loss of well clear? |
//! | [`encounter`] | what happened between two tracks, in continuous time? |
//! | [`AlertSettings`] | which values can a user configure? |
//! | [`schemes`] | which configurations do the standards give? |
//! | [`Monitor`] | which alert level holds, and what do the bands look like, over time? |
//! | [`QuantityBands`] | which values of one quantity lead into a conflict, and which resolution is preferred? |
//! | [`FutureStates`] | where will the aircraft be, for the last time to manoeuvre? |
//!
//! # Conventions
//!
//! Local plane: x east, y north, z up from the datum of the altitudes. Metres, seconds, radians;
//! **directions are clockwise from north**, as these standards count them (the core counts
//! anticlockwise from east). Velocities are through the air: wind moves all aircraft alike, so the
//! caller subtracts it. Times are from now.
//!
//! ```
//! use fga_alerts::{Aircraft, AircraftId, AircraftState, Monitor, Quantity, Region, schemes};
//! use glam::DVec3;
//!
//! let at = |id, position_m, velocity_mps| {
//!     Aircraft::new(AircraftId(id), AircraftState { position_m, velocity_mps })
//! };
//! let ownship = at(0, DVec3::new(0.0, 0.0, 1000.0), DVec3::new(0.0, 50.0, 0.0));
//! let intruder = at(1, DVec3::new(0.0, 5000.0, 1000.0), DVec3::new(0.0, -50.0, 0.0));
//!
//! let mut monitor = Monitor::new(schemes::do_365b());
//! monitor.step(0.0, &ownship, &[intruder])?;
//! assert_eq!(monitor.highest_level(), 3, "well clear is lost in 11 s");
//! let directions = monitor.bands(Quantity::Direction);
//! assert_eq!(directions.region_at(0.0), Some(Region::Near));
//! # Ok::<(), fga_alerts::StepError>(())
//! ```
//!
//! # References
//!
//! - RTCA DO-365B, "Minimum Operational Performance Standards for Detect and Avoid Systems".
//! - ASTM F3442, "Standard Specification for Detect and Avoid System Performance Requirements".
//! - Muñoz et al., "DAIDALUS: Detect and Avoid Alerting Logic for Unmanned Systems", DASC 2015.
//!
//! The tables are compared with its implementation, version 2.0.4: `docs/alerts.md`.
#![no_std]
#![forbid(unsafe_code)]
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing
)]

extern crate alloc;
#[cfg(test)]
extern crate std;

mod aircraft;
mod almost;
mod approach;
mod bands;
pub mod encounter;
mod hysteresis;
mod loss;
mod monitor;
mod picture;
mod plane;
mod quantity;
pub mod schemes;
mod settings;
pub mod severity;
mod units;
pub mod volume;

pub use aircraft::{Aircraft, AircraftId, AircraftState, Deviation, Pair, PairDeviation};
pub use bands::QuantityBands;
pub use bands::colors::{Band, ManeuverSide};
pub use bands::memory::Resolution;
pub use bands::recovery::Recovery;

pub use hysteresis::HysteresisSettings;
pub use loss::Loss;
pub use monitor::{Alert, FutureStates, LastTime, Monitor, StepError};
pub use quantity::{PerManeuver, Quantity};
pub use settings::{
    AlertLevel, AlertSettings, Alerter, Region, SlowDirections, TerminalArea, TerminalGuidance,
    ValueRange,
};
