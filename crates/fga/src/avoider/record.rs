//! The decision and its reasons.

use crate::command::Command;
use crate::maneuver::{Maneuver, StageList};

/// State of the avoider.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum State {
    /// On the mission, nothing threatens.
    #[default]
    Cruise,
    /// A threat is known; the manoeuvre waits for its start time.
    Threatened,
    /// Flying the avoiding manoeuvre.
    Avoiding,
    /// Flying back to the mission.
    Recovering,
}

impl State {
    /// All states, in the order of an encounter.
    pub const ALL: [Self; 4] = [
        Self::Cruise,
        Self::Threatened,
        Self::Avoiding,
        Self::Recovering,
    ];

    /// Whether the aircraft is off its mission: it avoids, or comes back.
    pub const fn is_away(self) -> bool {
        matches!(self, Self::Avoiding | Self::Recovering)
    }

    /// The state's name in logs and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cruise => "cruise",
            Self::Threatened => "threatened",
            Self::Avoiding => "avoiding",
            Self::Recovering => "recovering",
        }
    }
}

/// The reason of a decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Reason {
    /// Nothing comes too close on the mission.
    #[default]
    Clear,
    /// The input is unusable (a number is not finite); the avoider holds course and climb angle.
    InvalidInput,
    /// A threat is seen; its manoeuvre begins later.
    WaitingForStart,
    /// A certified manoeuvre begins.
    ManeuverChosen,
    /// The manoeuvre continues.
    ManeuverKept,
    /// Another manoeuvre replaces it: a better one, or it was no longer certified.
    ManeuverReplaced,
    /// No manoeuvre is certified: the manoeuvre that keeps farthest away flies.
    BestAvailable,
    /// The aircraft is inside a protected volume or a zone, and leaves it.
    InsideVolume,
    /// A way back to the mission begins.
    RejoinChosen,
    /// The way back continues.
    RejoinKept,
    /// The aircraft is back on its leg: within [`BACK_WITHIN_M`](crate::mission::BACK_WITHIN_M) of it and
    /// [`BACK_WITHIN_RAD`](crate::mission::BACK_WITHIN_RAD) of its course.
    Rejoined,
    /// The aircraft passed the last waypoint; the avoider holds course and altitude.
    MissionComplete,
    /// The wind is too strong to reach any waypoint ahead; the aircraft flies against it.
    WindTooStrong,
    /// Obstacles at rest have kept the aircraft from the waypoint ahead for 120 s: the mission goes on with the next one.
    WaypointGivenUp,
}

/// The obstacle that the decision is about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Threat {
    /// The obstacle's identifier.
    pub id: u32,
    /// Time of the entry into its volume on the mission, seconds from now.
    pub entry_s: f64,
    /// Time of the closest approach, seconds from now.
    pub closest_s: f64,
    /// Separation from its volume at that time, metres; negative inside.
    pub margin_m: f64,
}

impl Threat {
    /// The same some seconds later; after the predicted entry it is history.
    pub(super) fn later(&self, elapsed_s: f64) -> Option<Self> {
        (self.entry_s >= elapsed_s).then_some(Self {
            entry_s: self.entry_s - elapsed_s,
            closest_s: self.closest_s - elapsed_s,
            ..*self
        })
    }
}

/// The result of a candidate manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// Certified to stay clear.
    Certified,
    /// Comes too close.
    Rejected,
    /// The flown one.
    Chosen,
}

/// What an examined manoeuvre is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Certified lower bound of the separation beyond every volume, metres.
    pub margin_m: f64,
    /// Its cost (Alg. 2 line 20, or the objective's).
    pub cost: f64,
    /// Its result.
    pub verdict: Verdict,
}

/// The work for one decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Obstacles within the surveillance radius.
    pub tracked: u32,
    /// Of these, those that threaten the mission.
    pub threats: u32,
    /// Obstacles left out because a number of theirs is not finite, or a length is negative.
    pub unusable: u32,
    /// Manoeuvres evaluated.
    pub candidates: u32,
    /// Work done, in the unit of [`Settings::work_limit`](super::Settings::work_limit).
    pub work: u32,
    /// Whether the step met its limit of work before the search ended.
    pub limit_met: bool,
}

/// The reasons of a decision.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Record {
    /// The reason.
    pub reason: Reason,
    /// The most urgent threat.
    pub threat: Option<Threat>,
    /// Latest start of a certified manoeuvre, seconds from now; `None` without one.
    pub latest_start_s: Option<f64>,
    /// Start of the chosen manoeuvre, seconds from now.
    pub start_s: Option<f64>,
    /// The manoeuvre of the command, flown or awaited.
    pub chosen: Option<Candidate>,
    /// The best manoeuvre to the other side and what it is worth, if there was a search for it and it has at most eight stages.
    pub alternative: Option<(StageList<8>, Candidate)>,
    /// Share of the bounds of aircraft, from 0 to 1, in the motions that its certificate covers: straight on, on along the present turn,
    /// and a turn of this share to either side that begins at the report or when ours may answer, each with changes of climb. Turns
    /// between these are not covered. `None` without a certified manoeuvre, on the way back, without an aircraft among the obstacles, and
    /// where some count as flying straight on.
    pub resilience: Option<f64>,
    /// Chance to enter a protected volume within a minute on the mission, as the reports are believed; `None` where reports count as
    /// exact.
    pub p_loss_hold: Option<f64>,
    /// The same as it flies.
    pub p_loss: Option<f64>,
    /// Weight of the futures of the aircraft around of which the certified path keeps clear of the whole volumes, as of the last choice, each
    /// aircraft deciding for itself; `None` where reports count as exact, without a certificate, and where an aircraft is left out.
    pub proven_share: Option<f64>,
    /// Number of aircraft that count as flying straight on, because only the turns of the nearest ones are considered.
    pub straight_aircraft: u32,
    /// Whether the limits in need apply: nothing was certified with the normal ones.
    pub in_need: bool,
    /// Whether the situation's clock was set back by more than a second since the last step: the avoider forgot its plan.
    pub clock_set_back: bool,
    /// The work.
    pub work: Work,
}

/// The command until the next step, and its reasons.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Decision {
    /// State of the avoider.
    pub state: State,
    /// The command, with its proof if it has one; in cruise the guidance along the mission.
    pub command: Command,
    /// The reasons.
    pub record: Record,
}

impl Reason {
    /// All reasons.
    pub const ALL: [Self; 14] = [
        Self::Clear,
        Self::InvalidInput,
        Self::WaitingForStart,
        Self::ManeuverChosen,
        Self::ManeuverKept,
        Self::ManeuverReplaced,
        Self::BestAvailable,
        Self::InsideVolume,
        Self::RejoinChosen,
        Self::RejoinKept,
        Self::Rejoined,
        Self::MissionComplete,
        Self::WindTooStrong,
        Self::WaypointGivenUp,
    ];

    /// Whether the command has no certificate.
    pub const fn is_unproven(self) -> bool {
        matches!(
            self,
            Self::BestAvailable | Self::InsideVolume | Self::InvalidInput
        )
    }
}

impl Decision {
    /// A decision of which nothing is proven, with nothing on record but its reason.
    pub fn new(state: State, command: &Maneuver, reason: Reason) -> Self {
        let mut decision = Self {
            command: Command::from(*command),
            ..Self::default()
        };
        decision.set(state, reason);
        decision
    }

    /// All but its command and its alternative in its place: what is large on record is not written.
    pub(super) fn set(&mut self, state: State, reason: Reason) {
        self.state = state;
        let record = &mut self.record;
        (record.reason, record.work) = (reason, Work::default());
        record.threat = None;
        (record.chosen, record.start_s, record.latest_start_s) = (None, None, None);
        (record.resilience, record.straight_aircraft) = (None, 0);
        (record.p_loss_hold, record.p_loss, record.proven_share) = (None, None, None);
        (record.in_need, record.clock_set_back) = (false, false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decision_in_the_place_of_another_one_has_nothing_of_it() {
        let chosen = Some(Candidate {
            margin_m: 1.0,
            cost: 1.0,
            verdict: Verdict::Chosen,
        });
        let threat = Some(Threat {
            id: 1,
            entry_s: 1.0,
            closest_s: 1.0,
            margin_m: 1.0,
        });
        let record = Record {
            reason: Reason::RejoinKept,
            threat,
            latest_start_s: Some(1.0),
            start_s: Some(1.0),
            chosen,
            alternative: None,
            resilience: Some(1.0),
            p_loss_hold: Some(1.0),
            p_loss: Some(1.0),
            proven_share: Some(1.0),
            straight_aircraft: 1,
            in_need: true,
            clock_set_back: true,
            work: Work {
                work: 1,
                ..Work::default()
            },
        };
        let mut decision = Decision {
            record,
            ..Decision::default()
        };
        decision.set(State::Cruise, Reason::Clear);
        assert_eq!(decision, Decision::default());
    }
}
