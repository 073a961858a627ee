//! The state machine over all of it: situation in, decision out.
//!
//! ```text
//!            threat seen                start time reached            way back certified
//!  Cruise ───────────────► Threatened ─────────────────────► Avoiding ─────────────────► Recovering
//!    ▲                          │ threat gone                    ▲  new threat on the way back │
//!    ├──────────────────────────┘                                └─────────────────────────────┤
//!    └──────────────────────────────── on its leg, at its altitude ◄───────────────────────────┘
//! ```

mod against;
pub mod belief;
mod demand;
mod drift;
mod heights;
mod intruders;
mod record;
mod settings;
mod tracks;
mod turn_aware;
mod walls;

pub use crate::limit::SettingsError;
pub use against::Against;
pub use fga_index::{Block, Kept, KeptError};
pub use record::{Candidate, Decision, Reason, Record, State, Threat, Verdict, Work};
pub use settings::{LEAST_WORK, Settings, Start};
pub use tracks::{AllPlaces, Known, LIMIT_ID, LIMITS, Lent, MAX_TRACKED, Places, Tracks};

use fga_index::quiet;

use crate::Vec3;
use crate::assumptions::Assumptions;
use crate::certificate::{Closest, Hazard, certify_set};
use crate::command::Command;
use crate::maneuver::{Maneuver, Stage};
use crate::meter::Meter;
use crate::mission::{Progress, Route, Turner};
use crate::prediction::{FlightPath, MotionState, flown};
use crate::search::{Outcome, Tables};
use crate::situation::{Mission, Situation};
use crate::vehicle::Vehicle;

/// A step finishes when all but one part in this many of its work is done.
const FINISH_SHARE: u32 = 16;

/// A clock that is set back by at most this costs no plan, seconds.
const MOST_SET_BACK_S: f64 = 1.0;

/// Searches of the mission end when they have taken one part in this many of a step's work.
const MISSION_SHARE: u32 = 4;

/// To finish they take one part in this many at most: reading obstacles, which cannot be refused, comes after it.
const MISSION_MOST: u32 = 2;

/// The aircraft now, and its mission.
#[derive(Debug, Clone, Copy)]
struct Now<'a> {
    state: MotionState,
    mission: &'a Mission<'a>,
}

impl core::ops::Deref for Now<'_> {
    type Target = MotionState;

    fn deref(&self) -> &MotionState {
        &self.state
    }
}

/// A manoeuvre, flown or awaited.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Plan {
    /// Time of the decision, seconds on the situation's clock.
    decided_s: f64,
    /// Time of its departure from the mission, seconds on the situation's clock.
    start_s: f64,
    /// Time of the return to the mission, or infinity.
    joined_s: f64,
    /// What is known of it.
    outcome: Outcome,
    /// The rung of the ladder of demands that it keeps.
    rung: usize,
    margin_m: f64,
    cost: f64,
    /// Latest certified start, seconds on the situation's clock.
    latest_start_s: Option<f64>,
    threat: Option<Threat>,
    /// When the threat was found, seconds on the situation's clock: its times count from then on, whatever replaces
    /// the manoeuvre.
    threat_found_s: f64,
    /// Start of a manoeuvre against the next encounter, after the way back, seconds on the
    /// situation's clock.
    next_start_s: Option<f64>,
    /// Identifiers of the obstacles that it avoids: the way back must be clear of them.
    against: Against,
}

/// A chosen way back: its obstacles, leg and time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Returned {
    against: Against,
    /// Index of the waypoint at the start of the leg.
    leg: usize,
    /// Time, seconds on the situation's clock.
    time_s: f64,
}

/// What decides in a step, once the aircraft is on its leg of now.
type Policy<'p> =
    dyn FnMut(&mut Avoider<dyn Places + '_>, &Situation<'_>, &Now<'_>, &mut Decision) + 'p;

impl<P: Places + 'static> core::ops::Deref for Avoider<P> {
    type Target = Avoider<dyn Places>;

    fn deref(&self) -> &Self::Target {
        self
    }
}

impl<P: Places + 'static> core::ops::DerefMut for Avoider<P> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        self
    }
}

/// Collision avoidance for one aircraft: call it each cycle with a [`Situation`] and fly its [`Decision`].
///
/// It holds its scratch space (some 80 kB, 43 kB of them the room for obstacles) and never allocates: keep it in one place.
#[derive(Debug, Clone)]
pub struct Avoider<P: ?Sized = AllPlaces> {
    settings: Settings,
    vehicle: Vehicle,
    /// The limits of its vehicle.
    made_for: Vehicle,
    /// The limits for cases without a certified manoeuvre under the normal ones.
    in_need: Option<Vehicle>,
    flyer: Turner,
    state: State,
    progress: Progress,
    /// The same before a look for a way back.
    before: Progress,
    /// The mission's part of the step's work.
    mission_meter: Meter,
    path: FlightPath,
    tables: Tables,
    plan: Option<Plan>,
    /// The manoeuvre of the plan, with its proof of when it was decided.
    flown: Command,
    /// The climb angles that a manoeuvre may command between the mission's limits of altitude, radians.
    level_rad: (f64, f64),
    /// Whether it has left its mission in this flight.
    has_avoided: bool,
    /// The last chosen way back.
    returned: Option<Returned>,
    /// Time of the last step, seconds on a clock that never goes back, which is ahead of the situation's clock by this, seconds.
    last_time_s: f64,
    set_back_s: f64,
    cycle: u32,
    /// Counts the work of this step.
    meter: Meter,
    /// Manoeuvres evaluated in this step.
    looked_at: u32,
    /// Whether a search of this step met the limit of its work.
    is_cut: bool,
    /// Grids that searches have looked at since the last news.
    grids: u32,
    /// Predicted velocity of the aircraft over the ground, metres per second.
    ours_mps: Vec3,
    /// The drift of the aircraft.
    drift: drift::Drift,
    /// Distance kept clear for it, metres.
    drift_m: f64,
    /// Longer horizon of a manoeuvre's certificate where possible, seconds.
    far_s: f64,
    tracks: Tracks<P>,
}

impl Avoider {
    /// An avoider for a vehicle, in cruise on the first leg.
    ///
    /// # Errors
    /// A setting or a limit of the vehicle that is not finite or out of range.
    pub fn new(settings: Settings, vehicle: Vehicle) -> Result<Self, SettingsError> {
        let mut avoider = Self::blank(settings, vehicle);
        avoider.prepare()?;
        Ok(avoider)
    }

    /// An avoider of no use before [`Self::prepare`], to construct one where it stays: what is large of it is zeros, which are
    /// written there without a copy.
    pub fn blank(settings: Settings, vehicle: Vehicle) -> Self {
        Self::within(settings, vehicle, const { Tracks::new() })
    }
}

impl<P> Avoider<P> {
    /// The same with room for obstacles that is lent.
    #[expect(clippy::inline_always, reason = "written where it lies, not copied")]
    #[inline(always)]
    pub fn within(settings: Settings, vehicle: Vehicle, tracks: Tracks<P>) -> Self {
        Self {
            settings,
            vehicle,
            made_for: vehicle,
            in_need: None,
            flyer: Turner::NONE,
            state: State::Cruise,
            progress: Progress::new(),
            before: Progress::new(),
            tracks,
            path: const { FlightPath::new() },
            tables: Tables::NONE,
            mission_meter: Meter::unlimited(),
            plan: None,
            flown: Command::hold(),
            level_rad: (f64::NEG_INFINITY, f64::INFINITY),
            has_avoided: false,
            returned: None,
            last_time_s: f64::NEG_INFINITY,
            set_back_s: 0.0,
            cycle: 0,
            meter: Meter::unlimited(),
            looked_at: 0,
            is_cut: false,
            grids: 0,
            drift: drift::Drift::default(),
            drift_m: 0.0,
            ours_mps: Vec3::ZERO,
            far_s: settings.horizon_s,
        }
    }
}

impl<P: ?Sized> Avoider<P> {
    /// The assumed limits of the vehicle.
    pub const fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// Its state.
    pub const fn state(&self) -> State {
        self.state
    }

    /// Index of the waypoint at the start of the present leg.
    pub const fn leg_index(&self) -> usize {
        self.progress.index()
    }

    /// The limits in need, if there are any.
    pub const fn vehicle_in_need(&self) -> Option<&Vehicle> {
        self.in_need.as_ref()
    }
}

impl Avoider<dyn Places + '_> {
    /// Checks its settings and its vehicle, and computes what all of its flights share.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn prepare(&mut self) -> Result<(), SettingsError> {
        self.settings.check()?;
        self.vehicle.check()?;
        self.flyer.set(&self.vehicle);
        Ok(())
    }

    /// Forgets everything but its settings and the limits of its vehicle.
    pub(crate) fn forget_flight(&mut self) {
        self.vehicle = self.made_for;
        self.flyer.set(&self.vehicle);
        self.in_need = None;
        self.state = State::Cruise;
        self.progress = Progress::new();
        self.tracks.forget();
        self.plan = None;
        (self.returned, self.has_avoided) = (None, false);
        (self.last_time_s, self.set_back_s) = (f64::NEG_INFINITY, 0.0);
        self.cycle = 0;
        self.drift = drift::Drift::default();
    }

    /// The next situations have another mission, whose first `kept` waypoints are those of before: call it before the first of them.
    /// Where the present leg ends at a kept waypoint, its flight goes on; else the mission begins at its first leg, by a turn round
    /// where that ends behind the aircraft, or at the first leg that can be joined. A manoeuvre that is flown goes on, and leads back to
    /// the new mission.
    pub fn replace_mission(&mut self, kept: usize) {
        self.progress.take_up(kept);
        self.returned = None;
        if self.state != State::Avoiding {
            // It leads along the mission of before, or back to it.
            self.plan = None;
            self.state = State::Cruise;
        }
    }

    /// Replaces the vehicle's limits, for instance by a turn-rate factor estimated in flight.
    ///
    /// # Errors
    /// A limit that is not finite or out of range; nothing is changed then.
    pub fn set_vehicle(&mut self, vehicle: Vehicle) -> Result<(), SettingsError> {
        vehicle.check()?;
        self.vehicle = vehicle;
        self.flyer.set(&vehicle);
        Ok(())
    }

    /// Sets limits for cases without a certified manoeuvre under the normal ones, for
    /// instance a steeper bank with its own turn-rate factor and lag; `None` for no such limits.
    ///
    /// # Errors
    /// A limit that is not finite or out of range; nothing is changed then.
    pub fn set_vehicle_in_need(&mut self, vehicle: Option<Vehicle>) -> Result<(), SettingsError> {
        if let Some(vehicle) = &vehicle {
            vehicle.check()?;
        }
        self.in_need = vehicle;
        Ok(())
    }

    /// Replaces [`Settings::drift_mps`], for instance by what is not known of the vehicle's turn.
    ///
    /// # Errors
    /// A drift that is not finite or out of range; nothing is changed then.
    pub fn set_drift(&mut self, drift_mps: f64) -> Result<(), SettingsError> {
        let settings = Settings {
            drift_mps,
            ..self.settings
        };
        settings.check()?;
        self.settings = settings;
        Ok(())
    }

    /// Sets when a manoeuvre begins; one that is flown goes on.
    ///
    /// # Errors
    /// A score that is not in [0, 1]; nothing is changed then.
    pub fn set_start(&mut self, start: Start) -> Result<(), SettingsError> {
        start.check()?;
        self.settings.start = start;
        Ok(())
    }

    /// Decides what to fly until the next step.
    ///
    /// The caller steps every [`Settings::decision_period_s`], and says so where the mission is another one
    /// ([`Self::replace_mission`]). The command holds stages in time
    /// from now; the aircraft flies it if nothing new happens. The avoider
    /// ignores obstacles with numbers that are not finite. It holds the present course
    /// ([`Reason::InvalidInput`]) while the ownship's state or the time is unusable or beyond
    /// [`LARGEST_M`](crate::limit::LARGEST_M) and the other limits. A clock that is set back by up to a second changes nothing; a larger step
    /// back makes it forget its plan ([`Record::clock_set_back`]).
    pub fn step(&mut self, situation: &Situation<'_>) -> Decision {
        let mut decision = Decision::default();
        self.step_into(situation, &mut decision);
        decision
    }

    /// The same into the place of another decision, which is large.
    pub fn step_into(&mut self, situation: &Situation<'_>, decision: &mut Decision) {
        self.step_among(situation, None, decision);
    }

    /// Decides like [`Self::step`] among kept obstacles, whatever obstacles the situation has: the decision is the
    /// same to the last bit as with [`Kept::obstacles`] of this time as rows. It looks only at those that could
    /// matter: what a quiet step costs hardly depends on their number.
    pub fn step_kept(&mut self, situation: &Situation<'_>, kept: &mut Kept<'_>) -> Decision {
        kept.begin(situation.time_s);
        let mut decision = Decision::default();
        self.step_among(situation, Some(kept), &mut decision);
        decision
    }

    fn step_among(
        &mut self,
        situation: &Situation<'_>,
        mut kept: Option<&mut Kept<'_>>,
        decision: &mut Decision,
    ) {
        self.step_by(
            situation,
            decision,
            &mut |avoider, situation, now, decision| {
                avoider.step_turn_aware(situation, now, kept.as_deref_mut(), decision);
            },
        );
    }

    /// Decides by a policy.
    fn step_by(
        &mut self,
        situation: &Situation<'_>,
        decision: &mut Decision,
        policy: &mut Policy<'_>,
    ) {
        decision.record.alternative = None;
        if !situation.is_usable() {
            decision.command.edit().set([]);
            return self.say(decision, Reason::InvalidInput);
        }
        let (situation, clock_set_back) = &self.in_order(situation);
        self.cycle = self.cycle.wrapping_add(1);
        self.has_avoided |= self.state.is_away();
        self.tables.forget_turns();
        self.level_rad = self.level_rad(situation);
        let most = self.settings.work_limit;
        let limit = most - most / FINISH_SHARE;
        self.meter = Meter::new(limit, most);
        self.mission_meter = Meter::new(limit / MISSION_SHARE, most / MISSION_MOST);
        self.decide(situation, decision, policy);
        decision.record.work.work = self.meter.done();
        decision.record.work.limit_met |= self.meter.is_met();
        decision.record.clock_set_back = *clock_set_back;
    }

    /// The situation on a clock that never goes back, and whether the situation's clock was set back so far that
    /// the plan is forgotten. After a small step back, as of a clock that is kept in time by others, one decision period counts as
    /// passed: the plan goes on.
    fn in_order<'a>(&mut self, situation: &Situation<'a>) -> (Situation<'a>, bool) {
        let (time_s, is_far) = self.in_order_s(situation.time_s);
        if is_far {
            // Nobody knows how much time has passed, so the old plan has no meaning.
            self.plan = None;
            self.state = State::Cruise;
        } else if time_s != situation.time_s + self.set_back_s {
            self.set_back_s = time_s - situation.time_s;
        }
        self.last_time_s = time_s;
        (
            Situation {
                time_s,
                ..*situation
            },
            is_far,
        )
    }

    /// A time on that clock, seconds, and whether it was set back far.
    fn in_order_s(&self, time_s: f64) -> (f64, bool) {
        let ordered_s = time_s + self.set_back_s;
        let back_s = self.last_time_s - ordered_s;
        let is_far = back_s > MOST_SET_BACK_S;
        if back_s > 0.0 && !is_far {
            (self.last_time_s + self.settings.decision_period_s, false)
        } else {
            (ordered_s, is_far)
        }
    }

    #[inline(never)]
    fn decide(
        &mut self,
        situation: &Situation<'_>,
        decision: &mut Decision,
        policy: &mut Policy<'_>,
    ) {
        let now = Now {
            state: MotionState::of(&situation.ownship),
            mission: &situation.mission,
        };
        self.come_to(situation, &now);
        policy(self, situation, &now, decision);
        let planned = self.plan.as_ref().and_then(|plan| plan.threat);
        if self.gives_up(situation, &now, planned.or(decision.record.threat)) {
            decision.record.reason = Reason::WaypointGivenUp;
        }
    }

    /// Advances to the leg of now, and measures the drift.
    #[inline(never)]
    fn come_to(&mut self, situation: &Situation<'_>, now: &MotionState) {
        self.on_mission(situation, |progress, route| {
            progress.update(route, now, situation.time_s);
        });
        if self.state == State::Avoiding {
            self.progress.join_anywhere();
        }
        self.measure_drift(situation, now);
    }

    /// Whether it gives a waypoint up from which an obstacle at rest keeps the aircraft.
    #[inline(never)]
    fn gives_up(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        threat: Option<Threat>,
    ) -> bool {
        let is_at_rest = |hazard: &Hazard| hazard.velocity_mps == -situation.wind_mps;
        let hazards = self.tracks.rows();
        if !threat.is_some_and(|t| hazards.iter().any(|h| h.id() == t.id && is_at_rest(h))) {
            return false;
        }
        let passed_s = self.settings.decision_period_s;
        self.on_mission(situation, |progress, route| {
            progress.gives_up(route, now, passed_s)
        })
    }

    /// Measures the drift and the distance kept clear for it.
    fn measure_drift(&mut self, situation: &Situation<'_>, now: &MotionState) {
        self.ours_mps = situation.wind_mps + self.flyer.velocity_mps(now);
        let (time_s, position_m) = (situation.time_s, now.position_m);
        self.drift.observe(time_s, position_m, self.ours_mps);
        let radius_m = self.flyer.airspeed_mps() / self.flyer.course_rate_radps();
        self.drift_m = self.drift.margin_m(self.settings.drift_mps, radius_m);
    }

    /// Sets a command to the rest of a plan's manoeuvre, within the limits of altitude; the proof of one that was decided now stays.
    fn go_on(&self, plan: &Plan, time_s: f64, command: &mut Command) {
        if plan.decided_s == time_s {
            *command = self.flown;
            return;
        }
        let rest = command.edit();
        rest.set_later(&self.flown, time_s - plan.decided_s);
        rest.limit_climbs(self.level_rad.0, self.level_rad.1);
    }

    /// Predicts a manoeuvre into the path, up to a horizon.
    fn predict(&mut self, maneuver: &Maneuver, now: &MotionState, horizon_s: f64) {
        self.path
            .predict_within(&self.flyer, now, maneuver, horizon_s, &self.meter);
    }

    /// Bounds the separation from one hazard along the path.
    fn certify_one(&self, hazard: &Hazard, asked: (f64, f64, f64)) -> Closest {
        let one = Assumptions::only(core::slice::from_ref(hazard));
        certify_set(&self.flyer, &self.path, &one, asked, &self.meter)
    }

    /// The aircraft some time into some stages.
    fn after(&self, from: &MotionState, stages: &[Stage], until_s: f64) -> MotionState {
        flown(&self.flyer, from, stages, until_s, &self.meter)
    }

    #[inline(never)]
    fn load_tracks(
        &mut self,
        situation: &Situation<'_>,
        kept: Option<&mut Kept<'_>>,
        may_begin: bool,
    ) {
        let settings = &self.settings;
        let limits = (settings.surveillance_radius_m, settings.horizon_s);
        let sigmas = settings.confidence_sigmas;
        match kept {
            None => self.tracks.load(situation, limits.0, limits.1, sigmas),
            Some(kept) => self.tracks.load_kept(kept, situation, limits, sigmas),
        }
        // Without traffic there is no manoeuvre to bound, unless one may begin all the same.
        if may_begin || self.plan.is_some() || !self.tracks.rows().is_empty() {
            self.bind(situation);
        }
        self.meter.count(self.tracks.work);
    }

    /// Wanted distance beyond every volume, metres: the margin of the settings and that for drift.
    const fn wanted_m(&self) -> f64 {
        self.settings.margin_m + self.drift_m
    }

    /// Looks at the mission's geometry, with what is left of the step's work at most.
    fn on_mission<T>(
        &mut self,
        situation: &Situation<'_>,
        look: impl FnOnce(&mut Progress, &Route<'_>) -> T,
    ) -> T {
        let most = self.mission_meter.most_left().min(self.meter.most_left());
        let meter = Meter::new(self.mission_meter.left(), most);
        let route = Route {
            mission: &situation.mission,
            flyer: &self.flyer,
            wind_mps: situation.wind_mps,
            climb_limits_rad: self.climb_limits_rad(),
            meter: &meter,
        };
        let answer = look(&mut self.progress, &route);
        self.mission_meter.count(meter.done() as usize);
        self.meter.count(meter.done() as usize);
        answer
    }

    /// Decides on the command of a decision, with nothing on record but its reason.
    fn say(&self, decision: &mut Decision, reason: Reason) {
        let reason = match reason {
            Reason::Clear if self.progress.is_complete() => Reason::MissionComplete,
            Reason::Clear | Reason::ManeuverKept if self.progress.is_adrift() => {
                Reason::WindTooStrong
            }
            other => other,
        };
        decision.set(self.state, reason);
        decision.record.work.tracked = self.tracks.seen;
        decision.record.work.unusable = self.tracks.unusable;
    }
}
