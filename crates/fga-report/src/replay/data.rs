//! What a replay page shows.

use crate::zone::DrawnZone;

/// The content of a page.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Replay {
    /// Heading of the page.
    pub title: String,
    /// The runs, in one scene; the first one is in focus when the page opens.
    pub runs: Vec<ReplayRun>,
    /// The ground below them, where it is known.
    pub ground: Option<ReplayGround>,
}

/// The ground: heights on a regular grid, bilinear between its posts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReplayGround {
    /// The south-west post, metres east and north.
    pub corner_m: [f64; 2],
    /// From one post to the next one east and north, metres.
    pub spacing_m: [f64; 2],
    /// Posts in a row.
    pub columns: usize,
    /// Heights row by row from the south, each from the west, metres; not a number where unknown. Beyond 256 posts a side the page has
    /// every second, third, … post, as high as the highest of its neighbours.
    pub heights_m: Vec<f32>,
}

/// One run of an encounter.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReplayRun {
    /// The name of the run, usually its policy.
    pub name: String,
    /// The flown samples, in time order. Beyond 24,000 samples for the whole page, evenly spaced
    /// ones are dropped; those where the state changes stay.
    pub samples: Vec<ReplaySample>,
    /// The mission's waypoints, metres.
    pub mission_m: Vec<[f64; 3]>,
    /// The obstacles.
    pub obstacles: Vec<ReplayObstacle>,
    /// The zones.
    pub zones: Vec<DrawnZone>,
    /// The decision records, in time order; each holds until the next one. The page drops records
    /// that repeat the previous one.
    pub decisions: Vec<ReplayDecision>,
    /// Wall-clock time of each decision. Leave it empty if the page must be the same every time.
    pub decision_times: Vec<ReplayDecisionTime>,
    /// Events, for the marks on the timeline.
    pub events: Vec<ReplayEvent>,
    /// The least margin from the simulator, in continuous time. Without it the page takes the
    /// least one at the samples.
    pub outcome: Option<ReplayOutcome>,
    /// Alerts and bands in the order of time; each holds until the next one. Without any the page
    /// has no display for them.
    pub guidance: Vec<ReplayGuidance>,
    /// The most alert levels that an aircraft can have.
    pub alert_levels: usize,
}

/// What a detect-and-avoid display shows from a time on.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReplayGuidance {
    /// From when on, seconds.
    pub t_s: f64,
    /// The highest alert level; 0 for no alert.
    pub level: usize,
    /// The aircraft that are looked at.
    pub aircraft: Vec<ReplayAlert>,
    /// Direction, horizontal speed, vertical speed, altitude.
    pub quantities: [ReplayBands; 4],
}

/// The alert about one aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplayAlert {
    /// Identifier of the obstacle.
    pub obstacle: u32,
    /// Its alert level; 0 for no alert.
    pub level: usize,
    /// Time until the corrective volume is violated, seconds; `None` for no violation ahead.
    pub violation_s: Option<f64>,
}

/// The bands of one quantity.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReplayBands {
    /// The ownship's value: radians clockwise from north, metres, metres per second.
    pub value: f64,
    /// Parts of the scale in growing order.
    pub bands: Vec<ReplayBand>,
    /// Time until well clear is regained, seconds, where every value meets a conflict; negative
    /// where nothing regains it.
    pub recovery_s: Option<f64>,
}

/// A part of the scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplayBand {
    /// Lower edge, in the unit of the value.
    pub low: f64,
    /// Upper edge.
    pub high: f64,
    /// What a maneuver into it meets.
    pub region: ReplayRegion,
}

/// What a maneuver into a band meets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReplayRegion {
    /// No conflict.
    Free,
    /// A conflict far ahead.
    Far,
    /// A conflict, most often the corrective one.
    Mid,
    /// A conflict close ahead.
    Near,
    /// A way out of a conflict that is certain.
    Recovery,
    /// It cannot be flown.
    Outside,
}

impl ReplayRegion {
    pub(super) const fn code(self) -> u8 {
        match self {
            Self::Free => 0,
            Self::Far => 1,
            Self::Mid => 2,
            Self::Near => 3,
            Self::Recovery => 4,
            Self::Outside => 5,
        }
    }
}

impl ReplayRun {
    /// An empty run of this name.
    #[must_use]
    pub fn named(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..Self::default()
        }
    }
}

/// Position, attitude and state of the aircraft at a time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ReplaySample {
    /// Time, seconds.
    pub t_s: f64,
    /// Position, metres.
    pub position_m: [f64; 3],
    /// Course ψ, radians from +x towards +y.
    pub course_rad: f64,
    /// Climb angle θ, radians, positive upwards.
    pub climb_rad: f64,
    /// Bank angle φ, radians, positive in a left turn.
    pub bank_rad: f64,
    /// State of the aircraft.
    pub state: ReplayState,
}

/// State of the aircraft; it colours the track.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum ReplayState {
    /// On the mission; nothing threatens.
    #[default]
    Cruise,
    /// A threat is known; the manoeuvre waits for its start.
    Threatened,
    /// Flying the avoiding manoeuvre.
    Avoiding,
    /// Flying back to the mission.
    Recovering,
    /// Somebody else flies: the pilot, or an autopilot mode that does not take commands.
    Manual,
}

impl ReplayState {
    pub(super) const fn code(self) -> u8 {
        match self {
            Self::Cruise => 0,
            Self::Threatened => 1,
            Self::Avoiding => 2,
            Self::Recovering => 3,
            Self::Manual => 4,
        }
    }
}

impl From<fga::avoider::State> for ReplayState {
    fn from(state: fga::avoider::State) -> Self {
        match state {
            fga::avoider::State::Cruise => Self::Cruise,
            fga::avoider::State::Threatened => Self::Threatened,
            fga::avoider::State::Avoiding => Self::Avoiding,
            fga::avoider::State::Recovering => Self::Recovering,
        }
    }
}

/// An obstacle and its protected volume.
#[derive(Debug, Clone, PartialEq)]
pub struct ReplayObstacle {
    /// Identifier; the decisions name their threat by it.
    pub id: u32,
    /// Name on its label; empty for `#id`.
    pub name: String,
    /// The protected volume.
    pub volume: fga::situation::ProtectedVolume,
    /// Its motion: straight pieces in time order. Each holds until the next one begins;
    /// the first one also before its start, the last one for ever.
    pub motion: Vec<ReplayPiece>,
    /// The times between which it exists, seconds; `None` for the whole run.
    pub present_s: Option<[f64; 2]>,
    /// When the aircraft first knew of it, seconds; before that it is faint. `None` if the aircraft knew
    /// it from the start.
    pub known_from_s: Option<f64>,
}

/// A straight, unaccelerated piece of an obstacle's track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplayPiece {
    /// When it begins, seconds.
    pub start_s: f64,
    /// Position of the volume's centre at that time, metres.
    pub position_m: [f64; 3],
    /// Velocity over the ground, metres per second.
    pub velocity_mps: [f64; 3],
}

/// A decision record.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReplayDecision {
    /// Time of the decision, seconds.
    pub t_s: f64,
    /// The new state.
    pub state: ReplayState,
    /// The record in words, one thought per line; the first line is the headline.
    pub lines: Vec<String>,
    /// Identifier of the most urgent threat.
    pub threat: Option<u32>,
    /// Latest certified start, seconds from `t_s`.
    pub latest_start_s: Option<f64>,
    /// The examined paths, and the way back.
    pub paths: Vec<ReplayPath>,
    /// The chances of a loss on the mission and as it flies, of a decision on beliefs.
    pub p_loss: Option<[f64; 2]>,
    /// What other aircraft may do, as the decision weighs it; empty where the last ones still hold.
    pub futures: Vec<ReplayFutures>,
}

/// What an aircraft may do.
#[derive(Debug, Clone, PartialEq)]
pub struct ReplayFutures {
    /// Identifier of the obstacle.
    pub obstacle: u32,
    /// Its futures: the weight, and points from the aircraft on, metres.
    pub ways: Vec<(f64, Vec<[f64; 3]>)>,
}

/// An examined path.
#[derive(Debug, Clone, PartialEq)]
pub struct ReplayPath {
    /// Its result.
    pub kind: ReplayPathKind,
    /// Certified lower bound of the separation beyond every volume, metres.
    pub margin_m: Option<f64>,
    /// Points on the path, metres, from the aircraft on. Dense points cost nothing: the page keeps
    /// those that change its shape by more than a few decimetres.
    pub points_m: Vec<[f64; 3]>,
}

/// The result of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ReplayPathKind {
    /// Certified to stay clear.
    Certified,
    /// Comes too close.
    Rejected,
    /// The flown one.
    Chosen,
    /// The way back to the mission.
    WayBack,
}

impl From<fga::avoider::Verdict> for ReplayPathKind {
    fn from(verdict: fga::avoider::Verdict) -> Self {
        match verdict {
            fga::avoider::Verdict::Certified => Self::Certified,
            fga::avoider::Verdict::Rejected => Self::Rejected,
            fga::avoider::Verdict::Chosen => Self::Chosen,
        }
    }
}

/// The duration of a decision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplayDecisionTime {
    /// Time of the decision, seconds.
    pub t_s: f64,
    /// Wall-clock duration, microseconds.
    pub decision_us: f64,
}

/// An event.
#[derive(Debug, Clone, PartialEq)]
pub struct ReplayEvent {
    /// Time, seconds.
    pub t_s: f64,
    /// A few words about it.
    pub text: String,
}

/// The least margin of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplayOutcome {
    /// Least distance to the surface of a protected volume, metres; negative inside.
    pub min_margin_m: f64,
    /// Time, seconds.
    pub t_s: f64,
    /// Identifier of the obstacle.
    pub obstacle: u32,
}
