//! Everything that one flight is made of.

pub use crate::obstacle::{TrackReport, WorldObstacle};

use fga::Vec3;
use fga::situation::Passing;
use fga::vehicle::Vehicle;

use crate::plant::Autopilot;
use crate::sensor::SensorSettings;
use crate::settings::PolicySettings;
use crate::track::Track;

/// When a flight ends before its horizon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// Not before.
    Horizon,
    /// Back on the mission's line with every obstacle passed (its distance no longer shrinks).
    BackAndPassed,
    /// The last waypoint was passed.
    MissionFlown,
}

/// How close to the line counts as back on it, metres.
pub const BACK_WITHIN_M: f64 = 1.0;

/// How close to the line's direction counts as back on it, radians (1°).
pub const BACK_WITHIN_RAD: f64 = 1.0 * core::f64::consts::PI / 180.0;

/// The aircraft at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartState {
    /// Position, metres, local frame.
    pub position_m: Vec3,
    /// Course through the air, radians.
    pub course_rad: f64,
    /// Climb angle through the air, radians.
    pub climb_rad: f64,
}

/// One flight to be flown: aircraft, mission, obstacles, sensor, wind, end.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    /// Waypoints of the mission, metres, local frame; at least two.
    pub mission_m: Vec<Vec3>,
    /// How each waypoint is passed; those beyond the end of this list are flown by.
    pub passing: Vec<Passing>,
    /// The aircraft at the start.
    pub start: StartState,
    /// The aircraft's limits.
    pub vehicle: Vehicle,
    /// How commands become bank and climb.
    pub autopilot: Autopilot,
    /// What is said about deciding; the policy is chosen with the pilot.
    pub settings: PolicySettings,
    /// Velocity of the air over the ground, metres per second.
    pub wind_mps: Vec3,
    /// The obstacles.
    pub obstacles: Vec<WorldObstacle>,
    /// How they are seen.
    pub sensor: SensorSettings,
    /// Master seed of the sensor's noise.
    pub seed: u64,
    /// Stream of the noise: the encounter's number.
    pub stream: u64,
    /// Longest time flown, seconds.
    pub horizon_s: f64,
    /// When the flight ends before.
    pub ending: Ending,
    /// Recorded flight of the aircraft until it first manoeuvres.
    pub recorded: Option<Track>,
}
