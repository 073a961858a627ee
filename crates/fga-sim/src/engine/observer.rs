//! What a flight shows while it lasts, and its result.

use fga::Vec3;
use fga::avoider::{Decision, State};
use fga::situation::Situation;

/// The flown state at a moment, for the log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Seconds since the start.
    pub time_s: f64,
    /// Position over the ground, metres.
    pub position_m: Vec3,
    /// Course over the ground, radians.
    pub course_rad: f64,
    /// Climb angle over the ground, radians.
    pub climb_rad: f64,
    /// Bank angle, radians, positive in a left turn.
    pub bank_rad: f64,
    /// The avoider's state.
    pub state: State,
}

/// A decision, for the log.
#[derive(Debug, Clone, Copy)]
pub struct DecisionMoment<'a> {
    /// Seconds since the start.
    pub time_s: f64,
    /// The situation.
    pub situation: &'a Situation<'a>,
    /// The decision.
    pub decision: &'a Decision,
    /// Duration of the step, nanoseconds.
    pub elapsed_ns: u64,
}

/// Observes a flight.
pub trait Observer {
    /// Whether it wants every decision and sample; without, the engine leaves out decisions that are known.
    fn watches(&self) -> bool {
        true
    }
    /// The state at the start, at most 0.1 s apart, and at the end.
    fn sample(&mut self, _sample: &Sample) {}
    /// A decision, before it is flown.
    fn decision(&mut self, _moment: &DecisionMoment<'_>) {}
}

/// Observes nothing.
impl Observer for () {
    fn watches(&self) -> bool {
        false
    }
}

/// The result of a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Least distance to the centre of any obstacle, metres; infinite without obstacles.
    pub min_separation_m: f64,
    /// Least signed distance to any protected volume, metres; infinite without obstacles.
    pub min_margin_m: f64,
    /// First time with a known threat, seconds.
    pub threat_s: Option<f64>,
    /// Start of the first manoeuvre, seconds.
    pub start_s: Option<f64>,
    /// End of the last manoeuvre, seconds.
    pub clear_s: Option<f64>,
    /// Time at which the aircraft was back on its mission for the last time, seconds.
    pub rejoined_s: Option<f64>,
    /// Largest distance from the mission, horizontal and vertical together, metres.
    pub max_cross_track_m: f64,
    /// Path flown less progress along the mission, metres.
    pub extra_path_m: f64,
    /// End of the flight, seconds.
    pub end_s: f64,
    /// Whether the aircraft flew the mission to its end and missed no waypoint.
    pub mission_flown: bool,
    /// Number of passed waypoints that it passed farther away than planned.
    pub waypoints_missed: usize,
    /// Least height above the ground where it is known, metres; `None` in a world without ground.
    pub min_terrain_clearance_m: Option<f64>,
    /// Least signed distance from the zones, metres, negative on the wrong side; `None` in a world without zones.
    pub min_zone_margin_m: Option<f64>,
    /// Largest work of a decision, in units of the core's meter; 0 for a pilot that counts none.
    pub work_most: u32,
}

impl Outcome {
    /// Whether the flight entered no protected volume.
    pub fn separated(&self) -> bool {
        self.min_margin_m >= 0.0
    }

    /// Largest work of a decision, in units of the core's meter; `None` for a pilot that counts none.
    pub fn work(&self) -> Option<f64> {
        (self.work_most > 0).then(|| f64::from(self.work_most))
    }
}
