//! Logged decisions.

use fga::avoider::Decision;
use fga::situation::{Obstacle, Ownship};

use super::AircraftFutures;

/// A logged decision.
#[derive(Debug, Clone, PartialEq)]
pub struct DecisionLog {
    /// Seconds since the start.
    pub time_s: f64,
    /// The aircraft at that time; angles through the air.
    pub ownship: Ownship,
    /// The decision.
    pub decision: Decision,
    /// Its duration, nanoseconds.
    pub elapsed_ns: u64,
    /// Whether it differs from the previous one in more than its numbers.
    pub changed: bool,
    /// The known obstacles within the surveillance radius, over the ground; kept only
    /// while something threatens.
    pub known: Vec<Obstacle>,
    /// The futures of the aircraft that a choice weighs, once a second while the mission has a chance of a loss.
    pub futures: Vec<AircraftFutures>,
}
