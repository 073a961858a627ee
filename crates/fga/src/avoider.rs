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
mod intruders;
mod quiet;
mod record;
mod settings;
mod tracks;
mod turn_aware;

pub use crate::limit::SettingsError;
pub use against::Against;
pub use record::{Candidate, Decision, Reason, Record, State, Threat, Verdict, Work};
pub use settings::{LEAST_WORK, Settings, Start};
pub use tracks::{MAX_TRACKED, Tracks};

use crate::angle::Side;
use crate::certificate::{Asked, Certificate, Hazard, certify_set};
use crate::maneuver::Maneuver;
use crate::meter::Meter;
use crate::mission::Progress;
use crate::prediction::{FlightPath, Flyer, MotionState, flown};
use crate::search::Proof;
use crate::situation::Situation;
use crate::vehicle::Vehicle;

/// Work that is kept for what is still done once the limit is met: what is in hand is finished.
const LAST_WORK: u32 = 12_000;

/// The mission's geometry may take one part in this many of a step's work.
const MISSION_SHARE: u32 = 4;

/// A manoeuvre under way or waited for.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Plan {
    maneuver: Maneuver,
    /// When it was decided, seconds on the situation's clock.
    decided_s: f64,
    /// When it departs from the mission, seconds on the situation's clock.
    start_s: f64,
    /// When a way back is on the mission again, or infinity.
    joined_s: f64,
    /// What is known of its separation.
    proof: Proof,
    /// Since when nothing is certified, seconds on the situation's clock.
    open_since_s: f64,
    /// The obstacles when it was last searched for.
    picture: tracks::Picture,
    margin_m: f64,
    cost: f64,
    /// Latest certified start, seconds on the situation's clock.
    latest_start_s: Option<f64>,
    threat: Option<Threat>,
    /// When a manoeuvre against the next encounter begins that follows the way back, seconds on the
    /// situation's clock.
    next_start_s: Option<f64>,
    /// What it was last found certified from.
    basis: Option<turn_aware::Basis>,
    /// Identifiers of the obstacles that it was made against: the way back must be clear of them.
    against: Against,
    /// Share of what aircraft may do that it withstood when it was chosen; 1 without aircraft.
    resilience: f64,
    /// The side to which it was begun.
    side: Option<Side>,
}

/// A way back that was taken: what it was tried against, where and when.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Returned {
    against: Against,
    /// Index of the waypoint at the start of the leg.
    leg: usize,
    /// When, seconds on the situation's clock.
    time_s: f64,
}

impl Plan {
    fn remaining(&self, time_s: f64) -> Maneuver {
        self.maneuver.after(time_s - self.decided_s)
    }
}

/// Collision avoidance for one aircraft: feed it a [`Situation`] each cycle, fly its [`Decision`].
///
/// It holds its scratch space (some 170 kB) and never allocates: keep it in one place.
#[derive(Debug, Clone)]
pub struct Avoider {
    settings: Settings,
    vehicle: Vehicle,
    /// The limits that it was made for.
    made_for: Vehicle,
    /// The limits where nothing is certified with the normal ones.
    in_need: Option<Vehicle>,
    flyer: Flyer,
    state: State,
    progress: Progress,
    tracks: tracks::Tracks,
    path: FlightPath,
    plan: Option<Plan>,
    /// The last way back that was taken.
    returned: Option<Returned>,
    last_time_s: f64,
    cycle: u32,
    /// Counts the work of this step.
    meter: Meter,
    /// Searches in a row that were cut: the next one goes on with other manoeuvres.
    cut: u32,
    /// Work of the searches since there was news.
    searched: u32,
    /// The course at which the next look for a smaller departure begins.
    improved_to: u32,
    /// How far ahead separation is certified now, seconds.
    look_s: f64,
    /// How far ahead a maneuver is certified where it can be, seconds.
    far_s: f64,
}

impl Avoider {
    /// An avoider for a vehicle, in cruise on the first leg.
    ///
    /// # Errors
    /// A setting or a limit of the vehicle that is not finite or out of range.
    pub fn new(settings: Settings, vehicle: Vehicle) -> Result<Self, SettingsError> {
        settings.check()?;
        vehicle.check()?;
        Ok(Self {
            settings,
            vehicle,
            made_for: vehicle,
            in_need: None,
            flyer: Flyer::new(&vehicle),
            state: State::Cruise,
            progress: Progress::new(),
            tracks: tracks::Tracks::new(),
            path: FlightPath::new(),
            plan: None,
            returned: None,
            last_time_s: f64::NEG_INFINITY,
            cycle: 0,
            meter: Meter::unlimited(),
            cut: 0,
            searched: 0,
            improved_to: 0,
            look_s: settings.horizon_s,
            far_s: settings.horizon_s,
        })
    }

    /// Forgets everything but its settings and the limits that it was made for.
    pub(crate) fn forget_flight(&mut self) {
        self.vehicle = self.made_for;
        self.in_need = None;
        self.flyer = Flyer::new(&self.vehicle);
        self.state = State::Cruise;
        self.progress = Progress::new();
        self.tracks.forget();
        self.plan = None;
        self.returned = None;
        self.last_time_s = f64::NEG_INFINITY;
        self.cycle = 0;
        (self.cut, self.improved_to) = (0, 0);
    }

    /// The vehicle's limits as they are assumed.
    pub const fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// Where it stands.
    pub const fn state(&self) -> State {
        self.state
    }

    /// Index of the waypoint at the start of the leg that is flown.
    pub const fn leg_index(&self) -> usize {
        self.progress.index()
    }

    /// Replaces the vehicle's limits, for instance by a turn-rate factor estimated in flight.
    ///
    /// # Errors
    /// A limit that is not finite or out of range; nothing is changed then.
    pub fn set_vehicle(&mut self, vehicle: Vehicle) -> Result<(), SettingsError> {
        vehicle.check()?;
        self.vehicle = vehicle;
        self.flyer = Flyer::new(&vehicle);
        if let Some(plan) = &mut self.plan {
            plan.basis = None;
        }
        Ok(())
    }

    /// The limits in need, if there are any.
    pub const fn vehicle_in_need(&self) -> Option<&Vehicle> {
        self.in_need.as_ref()
    }

    /// Sets limits that are planned with only where nothing is certified with the normal ones, for
    /// instance those of a steeper bank with its own turn-rate factor and lag; `None` for no such limits.
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

    /// Decides what to fly until the next step.
    ///
    /// Steps are expected [`Settings::decision_period_s`] apart. The command holds stages in time
    /// from now; it is what will be flown if nothing new is learned. Obstacles whose numbers are
    /// not finite are left out; with an own state or time that is not usable, or beyond
    /// [`LARGEST`](crate::limit::LARGEST), the last command's course is held ([`Reason::InvalidInput`]).
    pub fn step(&mut self, situation: &Situation<'_>) -> Decision {
        if !situation.is_usable() {
            return self.decision(&Maneuver::hold(), Reason::InvalidInput);
        }
        if situation.time_s < self.last_time_s {
            // The clock jumped back: what was planned in its time means nothing now.
            self.plan = None;
            self.state = State::Cruise;
        }
        self.last_time_s = situation.time_s;
        self.cycle = self.cycle.wrapping_add(1);
        let limit = self.settings.work_limit.saturating_sub(LAST_WORK);
        self.meter = Meter::new(limit);
        self.progress.allow_work(limit / MISSION_SHARE);
        let mut decision = match self.in_need {
            Some(in_need) => self.decide_with(in_need, situation),
            None => self.decide(situation),
        };
        decision.record.work.work = self.meter.done();
        decision.record.work.limit_met |= self.meter.is_met();
        decision
    }

    fn decide(&mut self, situation: &Situation<'_>) -> Decision {
        let now = MotionState::of(&situation.ownship);
        self.progress.update(
            &situation.mission,
            &now,
            &self.flyer,
            situation.wind_mps,
            (situation.time_s, self.climb_limits_rad()),
        );
        self.count_mission();
        self.step_turn_aware(situation, &now, self.settings.start)
    }

    /// Predicts a manoeuvre into the path.
    fn predict(&mut self, maneuver: &Maneuver, now: &MotionState) {
        let horizon_s = self.look_s;
        self.path.predict(&self.flyer, now, maneuver, horizon_s);
        self.meter.count(self.path.work(&self.flyer));
    }

    /// Bounds the separation from one hazard along the path.
    fn certify_one(&self, hazard: &Hazard, until_s: f64, floor_m: f64) -> Certificate {
        let asked = Asked {
            horizon_s: until_s,
            floor_m,
            enough_m: self.settings.margin_m,
        };
        let one = core::slice::from_ref(hazard);
        certify_set(&self.flyer, &self.path, one, &asked, &self.meter)
    }

    /// The aircraft some time into a manoeuvre.
    fn after(&self, from: &MotionState, maneuver: &Maneuver, until_s: f64) -> MotionState {
        flown(&self.flyer, from, maneuver, until_s, &self.meter)
    }

    fn load_tracks(&mut self, situation: &Situation<'_>) {
        self.tracks.load(
            situation,
            self.settings.surveillance_radius_m,
            self.settings.horizon_s,
            self.settings.confidence_sigmas,
        );
        self.meter.count(self.tracks.work());
    }

    fn climb_limits_rad(&self) -> (f64, f64) {
        (self.vehicle.climb_min_rad, self.vehicle.climb_max_rad)
    }

    /// What the mission asks to fly, and the moment from which it is straight.
    fn guidance(&mut self, situation: &Situation<'_>, now: &MotionState) -> (Maneuver, f64) {
        let horizon_s = self.settings.horizon_s;
        let guidance = self
            .progress
            .guidance(&situation.mission, now, &self.flyer, horizon_s);
        self.count_mission();
        guidance
    }

    /// Counts the work that the mission's geometry has taken.
    fn count_mission(&mut self) {
        self.meter.count(self.progress.take_work() as usize);
    }

    fn decision(&self, command: &Maneuver, reason: Reason) -> Decision {
        let reason = match reason {
            Reason::Clear if self.progress.is_complete() => Reason::MissionComplete,
            other => other,
        };
        let work = Work {
            tracked: self.tracks.seen,
            ..Work::default()
        };
        let mut decision = Decision::new(self.state, command, reason);
        decision.record.work = work;
        decision
    }
}
