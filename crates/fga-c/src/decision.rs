//! What the avoider decides, as a structure of C.

use core::ffi::{CStr, c_char};

use fga::avoider::{Decision, Reason, State};
use fga::command::Proof;
use fga::maneuver::MAX_STAGES;

use crate::growable::Growable;
use crate::input::fga_stage;

/// Most stages of a command.
pub const FGA_STAGES_MOST: usize = 40;

const _: () = assert!(MAX_STAGES <= FGA_STAGES_MOST);

/// State of the avoider.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum fga_state {
    /// On the mission, nothing threatens: the command is the guidance along the mission.
    Cruise = 0,
    /// A threat is known; the manoeuvre waits for its start.
    Threatened = 1,
    /// Flying the avoiding manoeuvre.
    Avoiding = 2,
    /// Flying back to the mission, until the aircraft is on its leg.
    Recovering = 3,
}

impl From<State> for fga_state {
    fn from(state: State) -> Self {
        match state {
            State::Cruise => Self::Cruise,
            State::Threatened => Self::Threatened,
            State::Avoiding => Self::Avoiding,
            State::Recovering => Self::Recovering,
        }
    }
}

/// The reason of a decision.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum fga_reason {
    /// Nothing comes too close on the mission.
    Clear = 0,
    /// A number is unusable; the aircraft holds course and climb angle. This interface refuses such a step instead.
    InvalidInput = 1,
    /// A threat is seen; its manoeuvre begins later.
    WaitingForStart = 2,
    /// A certified manoeuvre begins.
    ManeuverChosen = 3,
    /// The manoeuvre continues.
    ManeuverKept = 4,
    /// Another manoeuvre replaces it: a better one, or it was no longer certified.
    ManeuverReplaced = 5,
    /// No manoeuvre is certified: the manoeuvre that keeps farthest away flies.
    BestAvailable = 6,
    /// The aircraft is inside a protected volume or a zone, and leaves it.
    InsideVolume = 7,
    /// A way back to the mission begins.
    RejoinChosen = 8,
    /// The way back continues.
    RejoinKept = 9,
    /// The aircraft is back on its leg: within 15 m of it, beside and where it can climb in height, and 0.2 radians of its course.
    Rejoined = 10,
    /// The aircraft passed the last waypoint; it holds course and altitude.
    MissionComplete = 11,
    /// The wind is too strong to reach any waypoint ahead; the aircraft flies against it.
    WindTooStrong = 12,
    /// Obstacles at rest have kept the aircraft from the waypoint ahead for 120 s: the mission goes on with the next one.
    WaypointGivenUp = 13,
}

impl From<Reason> for fga_reason {
    fn from(reason: Reason) -> Self {
        match reason {
            Reason::Clear => Self::Clear,
            Reason::InvalidInput => Self::InvalidInput,
            Reason::WaitingForStart => Self::WaitingForStart,
            Reason::ManeuverChosen => Self::ManeuverChosen,
            Reason::ManeuverKept => Self::ManeuverKept,
            Reason::ManeuverReplaced => Self::ManeuverReplaced,
            Reason::BestAvailable => Self::BestAvailable,
            Reason::InsideVolume => Self::InsideVolume,
            Reason::RejoinChosen => Self::RejoinChosen,
            Reason::RejoinKept => Self::RejoinKept,
            Reason::Rejoined => Self::Rejoined,
            Reason::MissionComplete => Self::MissionComplete,
            Reason::WindTooStrong => Self::WindTooStrong,
            Reason::WaypointGivenUp => Self::WaypointGivenUp,
        }
    }
}

impl fga_reason {
    const fn text(self) -> &'static CStr {
        match self {
            Self::Clear => c"nothing comes too close on the mission",
            Self::InvalidInput => c"a number is unusable: course and climb angle are held",
            Self::WaitingForStart => c"a threat is seen; its manoeuvre begins later",
            Self::ManeuverChosen => c"a certified manoeuvre begins",
            Self::ManeuverKept => c"the manoeuvre continues",
            Self::ManeuverReplaced => c"another manoeuvre replaces it",
            Self::BestAvailable => {
                c"no manoeuvre is certified: the manoeuvre that keeps farthest away flies"
            }
            Self::InsideVolume => c"inside a protected volume or a zone, which the aircraft leaves",
            Self::RejoinChosen => c"a way back to the mission begins",
            Self::RejoinKept => c"the way back continues",
            Self::Rejoined => c"back on the leg",
            Self::MissionComplete => c"the last waypoint is passed: course and altitude are held",
            Self::WindTooStrong => c"the wind is too strong to reach any waypoint ahead",
            Self::WaypointGivenUp => c"the waypoint ahead cannot be reached: on to the next one",
        }
    }
}

/// The name of an `fga_state`, for logs; never null, and valid for ever.
#[unsafe(no_mangle)]
pub extern "C" fn fga_state_text(state: u32) -> *const c_char {
    let known = State::ALL
        .into_iter()
        .map(fga_state::from)
        .find(|&known| known as u32 == state);
    let text = match known {
        Some(fga_state::Cruise) => c"cruise",
        Some(fga_state::Threatened) => c"threatened",
        Some(fga_state::Avoiding) => c"avoiding",
        Some(fga_state::Recovering) => c"recovering",
        None => c"no state of this library",
    };
    text.as_ptr()
}

/// The sentence of an `fga_reason`, for logs; never null, and valid for ever.
#[unsafe(no_mangle)]
pub extern "C" fn fga_reason_text(reason: u32) -> *const c_char {
    let mut all = Reason::ALL.into_iter().map(fga_reason::from);
    let known = all.find(|&known| known as u32 == reason);
    known
        .map_or(c"no reason of this library", fga_reason::text)
        .as_ptr()
}

/// Bit of `fga_decision::has`: there is a threat, `threat`.
pub const FGA_HAS_THREAT: u32 = 1;
/// Bit of `fga_decision::has`: there is a manoeuvre, flown or awaited, with `margin_m` and `cost`.
pub const FGA_HAS_MANEUVER: u32 = 2;
/// Bit of `fga_decision::has`: the manoeuvre is certified, with `certified_margin_m`, `certified_horizon_s` and
/// `certified_hazards`.
pub const FGA_HAS_CERTIFICATE: u32 = 4;
/// Bit of `fga_decision::has`: the manoeuvre has a start, `start_s`.
pub const FGA_HAS_START: u32 = 8;
/// Bit of `fga_decision::has`: a latest start of a certified manoeuvre is known, `latest_start_s`.
pub const FGA_HAS_LATEST_START: u32 = 16;
/// Bit of `fga_decision::has`: what the manoeuvre withstands is known, `resilience`.
pub const FGA_HAS_RESILIENCE: u32 = 32;
/// Bit of `fga_decision::has`: the aircraft is already in a volume; what is proven is that it leaves it, and keeps clear of all
/// others, `certified_...`. It excludes `FGA_HAS_CERTIFICATE`.
pub const FGA_HAS_LEAVING: u32 = 64;

/// Bit of `fga_decision::has`: chances of a loss are known, `p_loss_hold` and `p_loss`.
pub const FGA_HAS_CHANCES: u32 = 128;
/// Bit of `fga_decision::has`: the share of what aircraft may do that the certificate covers is known, `proven_share`.
pub const FGA_HAS_PROVEN_SHARE: u32 = 256;

/// The obstacle that a decision is about.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct fga_threat {
    /// The obstacle's identifier.
    pub id: u32,
    /// Time of the entry into its volume on the mission, seconds from now.
    pub entry_s: f64,
    /// Time of the closest approach, seconds from now.
    pub closest_s: f64,
    /// Separation from its volume at that time, metres; negative inside.
    pub margin_m: f64,
}

/// The command until the next step, and its reasons.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fga_decision {
    /// `sizeof(fga_decision)`.
    pub size: u32,
    /// State of the avoider.
    pub state: fga_state,
    /// The reason.
    pub reason: fga_reason,
    /// Number of stages of the command. With none, or before the first one, the aircraft holds course and climb angle.
    pub stage_count: u32,
    /// The command: of the stages that have begun, fly the last one.
    pub stages: [fga_stage; FGA_STAGES_MOST],
    /// Which of the following parts mean something, as bits `FGA_HAS_...`; the others are 0.
    pub has: u32,
    /// Whether the limits in need apply (1), because nothing was certified with the normal ones, or not (0).
    pub in_need: u32,
    /// The most urgent threat.
    pub threat: fga_threat,
    /// Lower bound of the manoeuvre's separation beyond every volume, metres.
    pub margin_m: f64,
    /// Cost of the manoeuvre.
    pub cost: f64,
    /// Proven lower bound of the separation beyond every volume, metres.
    pub certified_margin_m: f64,
    /// How far ahead it is proven, seconds.
    pub certified_horizon_s: f64,
    /// Start of the manoeuvre, seconds from now.
    pub start_s: f64,
    /// Latest start of a certified manoeuvre, seconds from now.
    pub latest_start_s: f64,
    /// Share of the bounds of aircraft that the manoeuvre withstands, 0 (the expected motion) to 1.
    pub resilience: f64,
    /// Number of hazards that the manoeuvre is proven against; an aircraft that may turn is several.
    pub certified_hazards: u32,
    /// Number of aircraft that count as flying straight on, because only the turns of the nearest ones are considered.
    pub straight_aircraft: u32,
    /// Obstacles of this step within the surveillance radius.
    pub obstacles_tracked: u32,
    /// Obstacles of this step without effect, because a number of theirs is unusable.
    pub obstacles_ignored: u32,
    /// Obstacles of this step without effect, because the storage has no room for them.
    pub obstacles_left_out: u32,
    /// Work done, in the unit of `work_limit`.
    pub work: u32,
    /// Whether the step met its limit of work before the search ended (1), or not (0).
    pub work_limit_met: u32,
    /// Whether the clock was set back by more than a second since the last step (1), which makes the avoider forget its
    /// plan, or not (0).
    pub clock_set_back: u32,
    /// Index of the waypoint at the start of the present leg.
    pub leg_index: u32,
    /// Chance to enter a protected volume on the mission, 0 to 1.
    pub p_loss_hold: f64,
    /// The same on what is flown.
    pub p_loss: f64,
    /// Weight of what aircraft may do of which the manoeuvre keeps clear by its certificate, 0 to 1.
    pub proven_share: f64,
}

// SAFETY: `repr(C)`, the size first, then numbers and enumerations with a value 0.
unsafe impl Growable for fga_decision {}

impl fga_decision {
    /// All that a decision says; the rest is 0 already.
    pub(crate) fn set(&mut self, decision: &Decision) {
        let record = &decision.record;
        self.state = decision.state.into();
        self.reason = record.reason.into();
        for (slot, stage) in self.stages.iter_mut().zip(decision.command.stages()) {
            *slot = fga_stage::of(stage);
            self.stage_count += 1;
        }
        self.in_need = u32::from(record.in_need);
        if let Some(threat) = &record.threat {
            self.has |= FGA_HAS_THREAT;
            self.threat = fga_threat {
                id: threat.id,
                entry_s: threat.entry_s,
                closest_s: threat.closest_s,
                margin_m: threat.margin_m,
            };
        }
        if let Some(chosen) = &record.chosen {
            self.has |= FGA_HAS_MANEUVER;
            (self.margin_m, self.cost) = (chosen.margin_m, chosen.cost);
        }
        if let Some(proof) = decision.command.proof() {
            self.has |= match proof {
                Proof::Certified(_) => FGA_HAS_CERTIFICATE,
                Proof::Leaving(_) => FGA_HAS_LEAVING,
            };
            self.certified_margin_m = proof.bound().margin_m;
            self.certified_horizon_s = proof.bound().horizon_s;
            self.certified_hazards = proof.bound().hazards;
        }
        if let Some(start_s) = record.start_s {
            self.has |= FGA_HAS_START;
            self.start_s = start_s;
        }
        if let Some(latest_start_s) = record.latest_start_s {
            self.has |= FGA_HAS_LATEST_START;
            self.latest_start_s = latest_start_s;
        }
        if let Some(resilience) = record.resilience {
            self.has |= FGA_HAS_RESILIENCE;
            self.resilience = resilience;
        }
        if let (Some(p_loss_hold), Some(p_loss)) = (record.p_loss_hold, record.p_loss) {
            self.has |= FGA_HAS_CHANCES;
            (self.p_loss_hold, self.p_loss) = (p_loss_hold, p_loss);
        }
        if let Some(proven_share) = record.proven_share {
            self.has |= FGA_HAS_PROVEN_SHARE;
            self.proven_share = proven_share;
        }
        self.straight_aircraft = record.straight_aircraft;
        self.obstacles_tracked = record.work.tracked;
        self.work = record.work.work;
        self.work_limit_met = u32::from(record.work.limit_met);
        self.clock_set_back = u32::from(record.clock_set_back);
    }
}
