//! What a flight shows while it lasts.

use fga::Vec3;
use fga::avoider::belief::Beliefs;
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
    /// What the pilot believes of the aircraft around, if it flies by that.
    pub beliefs: Option<&'a Beliefs>,
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
