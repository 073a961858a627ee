//! What was decided, and why.

use crate::maneuver::Maneuver;

/// Where the avoider stands.
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

/// Why the decision is what it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Reason {
    /// Nothing comes too close on the mission.
    #[default]
    Clear,
    /// The input is not usable (a number that is not finite); course and climb angle are held.
    InvalidInput,
    /// A threat is seen; its manoeuvre begins later.
    WaitingForStart,
    /// A certified manoeuvre begins.
    ManeuverChosen,
    /// The manoeuvre flown is still the right one.
    ManeuverKept,
    /// The manoeuvre flown was no longer certified and another one is.
    ManeuverReplaced,
    /// No manoeuvre is certified: the one with the largest least separation is flown.
    BestAvailable,
    /// The aircraft is inside a protected volume and leaves it.
    InsideVolume,
    /// A way back to the mission begins.
    RejoinChosen,
    /// The way back is flown.
    RejoinKept,
    /// The aircraft is back on its leg.
    Rejoined,
    /// The last waypoint was passed; course and altitude are held.
    MissionComplete,
}

/// The obstacle that the decision is about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Threat {
    /// The obstacle's identifier.
    pub id: u32,
    /// When its volume would be entered on the mission, seconds from now.
    pub entry_s: f64,
    /// When it would come closest, seconds from now.
    pub closest_s: f64,
    /// Separation from its volume then, metres; negative inside.
    pub margin_m: f64,
}

/// What became of a candidate manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// Certified to stay clear.
    Certified,
    /// Comes too close.
    Rejected,
    /// The one that is flown.
    Chosen,
}

/// A manoeuvre that was looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// What would be flown.
    pub maneuver: Maneuver,
    /// Certified lower bound of the separation beyond every volume, metres.
    pub margin_m: f64,
    /// Its cost (Alg. 2 line 20, or the objective's).
    pub cost: f64,
    /// What became of it.
    pub verdict: Verdict,
}

/// How much was computed for one decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Obstacles within the surveillance radius.
    pub tracked: u32,
    /// Of these, those that threaten the mission.
    pub threats: u32,
    /// Manoeuvres evaluated.
    pub candidates: u32,
    /// Work done, in the unit of [`Settings::work_limit`](super::Settings::work_limit).
    pub work: u32,
    /// Whether the limit of work per step was met before the search was finished.
    pub limit_met: bool,
}

/// Why a decision was made.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Record {
    /// Why.
    pub reason: Reason,
    /// The most urgent threat.
    pub threat: Option<Threat>,
    /// Latest start of a certified manoeuvre, seconds from now; `None` where none exists.
    pub latest_start_s: Option<f64>,
    /// Start of the chosen manoeuvre, seconds from now.
    pub start_s: Option<f64>,
    /// The manoeuvre flown or waited for.
    pub chosen: Option<Candidate>,
    /// The best manoeuvre to the other side, where one was looked for.
    pub alternative: Option<Candidate>,
    /// Share of what aircraft may do that the manoeuvre flown withstands, from 0 (they go on as they
    /// do) to 1 (turns and changes of climb up to their bounds); `None` where none is flown or no
    /// obstacle is an aircraft.
    pub resilience: Option<f64>,
    /// Whether the limits in need are flown: nothing was certified with the normal ones.
    pub in_need: bool,
    /// How much was computed.
    pub work: Work,
}

/// What to fly until the next step, and why.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decision {
    /// Where the avoider stands now.
    pub state: State,
    /// What to fly; in cruise the guidance along the mission.
    pub command: Maneuver,
    /// Why.
    pub record: Record,
}

impl Reason {
    /// Whether nothing certifies what is flown.
    pub const fn is_unproven(self) -> bool {
        matches!(
            self,
            Self::BestAvailable | Self::InsideVolume | Self::InvalidInput
        )
    }
}

impl Decision {
    /// A decision with nothing on record but its reason.
    pub fn new(state: State, command: &Maneuver, reason: Reason) -> Self {
        Self {
            state,
            command: *command,
            record: Record {
                reason,
                ..Record::default()
            },
        }
    }
}
