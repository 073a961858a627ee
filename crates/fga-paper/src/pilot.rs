//! The paper's rules as pilots: Algorithms 1–3 corrected and as printed, and the turn round a static
//! obstacle of Fig. 8 and Algorithm 4.

mod around;
mod circle;
mod directions;
mod settings;

pub use settings::{GridSteps, PaperSettings, Rule};

use fga::avoider::{
    Against, Candidate, Decision, Reason, SettingsError, State, Threat, Tracks, Verdict,
};
use fga::certificate::Hazard;
use fga::maneuver::Maneuver;
use fga::meter::Meter;
use fga::mission::{Progress, Route, Turner};
use fga::pilot::Pilot;
use fga::prediction::{FlightPath, MotionState};
use fga::situation::Situation;
use fga::vehicle::Vehicle;

use crate::conflict::{Conflict, Relative, assess};
use crate::printed;
use around::Around;

/// The formulas.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Edition {
    /// With the errata applied.
    Corrected,
    /// As printed.
    AsPrinted,
}

/// A manoeuvre, flown or awaited.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Planned {
    maneuver: Maneuver,
    /// Time of the decision, seconds on the situation's clock.
    decided_s: f64,
    /// Time of its departure from the mission, seconds on the situation's clock.
    start_s: f64,
    /// Time of the return to the mission, or infinity.
    joined_s: f64,
    /// Whether it clears every obstacle by the formulas that chose it.
    clears: bool,
    margin_m: f64,
    cost: f64,
    /// Latest start, seconds on the situation's clock.
    latest_start_s: Option<f64>,
    threat: Option<Threat>,
    /// The obstacles that it avoids.
    against: Against,
}

impl Planned {
    fn remaining(&self, time_s: f64) -> Maneuver {
        self.maneuver.after(time_s - self.decided_s)
    }
}

/// Flies by the rules of the paper: the simulator's policies `published`, `published-literal` and
/// `circle`.
#[derive(Debug, Clone)]
pub struct PaperPilot {
    settings: PaperSettings,
    vehicle: Vehicle,
    /// The limits of its vehicle.
    made_for: Vehicle,
    flyer: Turner,
    state: State,
    progress: Progress,
    around: Around,
    /// The obstacles with their uncertainty, for certifying a way back.
    tracks: Tracks,
    path: FlightPath,
    plan: Option<Planned>,
    /// The way round a static obstacle, of the rule [`Rule::Circle`].
    round: Option<circle::Round>,
    last_time_s: f64,
}

impl PaperPilot {
    /// A pilot for a vehicle, in cruise on the first leg.
    ///
    /// # Errors
    /// A setting or a limit of the vehicle that is not finite or out of range.
    pub fn new(settings: PaperSettings, vehicle: Vehicle) -> Result<Self, SettingsError> {
        settings.check()?;
        vehicle.check()?;
        Ok(Self {
            settings,
            vehicle,
            made_for: vehicle,
            flyer: Turner::new(&vehicle),
            state: State::Cruise,
            progress: Progress::new(),
            around: Around::new(),
            tracks: Tracks::new(),
            path: FlightPath::new(),
            plan: None,
            round: None,
            last_time_s: f64::NEG_INFINITY,
        })
    }

    /// The limits that it plans with.
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

    fn load_tracks(&mut self, situation: &Situation<'_>) {
        self.tracks.load(
            situation,
            self.settings.surveillance_radius_m,
            self.settings.horizon_s,
            self.settings.confidence_sigmas,
        );
    }

    /// Looks at the mission's geometry.
    fn on_mission<T>(
        &mut self,
        situation: &Situation<'_>,
        look: impl FnOnce(&mut Progress, &Route<'_>) -> T,
    ) -> T {
        let route = Route {
            mission: &situation.mission,
            flyer: &self.flyer,
            wind_mps: situation.wind_mps,
            climb_limits_rad: (self.vehicle.climb_min_rad, self.vehicle.climb_max_rad),
            meter: &Meter::unlimited(),
        };
        look(&mut self.progress, &route)
    }

    /// The guidance along the mission.
    fn guidance(&mut self, situation: &Situation<'_>, now: &MotionState) -> Maneuver {
        let (horizon_s, mut command) = (self.settings.horizon_s, Maneuver::hold());
        self.on_mission(situation, |progress, route| {
            progress.guidance(route, now, horizon_s, &mut command)
        });
        command
    }

    fn decision(&self, command: &Maneuver, reason: Reason) -> Decision {
        let reason = match reason {
            Reason::Clear if self.progress.is_complete() => Reason::MissionComplete,
            other => other,
        };
        let mut decision = Decision::new(self.state, command, reason);
        decision.record.work.tracked = self.around.seen();
        decision
    }

    /// The decision to fly the rest of a plan.
    fn report(&self, plan: &Planned, time_s: f64, reason: Reason) -> Decision {
        let elapsed_s = time_s - plan.decided_s;
        let command = plan.remaining(time_s);
        let mut decision = self.decision(&command, reason);
        let record = &mut decision.record;
        // After the predicted entry the threat is history.
        let ahead = plan.threat.filter(|threat| threat.entry_s >= elapsed_s);
        record.threat = ahead.map(|threat| Threat {
            entry_s: threat.entry_s - elapsed_s,
            closest_s: threat.closest_s - elapsed_s,
            ..threat
        });
        record.start_s = Some(plan.start_s - time_s);
        record.latest_start_s = plan.latest_start_s.map(|latest_s| latest_s - time_s);
        record.chosen = Some(Candidate {
            margin_m: plan.margin_m,
            cost: plan.cost,
            verdict: if plan.clears {
                Verdict::Chosen
            } else {
                Verdict::Rejected
            },
        });
        decision
    }
}

impl Pilot for PaperPilot {
    fn step(&mut self, situation: &Situation<'_>) -> Decision {
        if !situation.is_usable() {
            return self.decision(&Maneuver::hold(), Reason::InvalidInput);
        }
        if situation.time_s < self.last_time_s {
            // The clock jumped back, so the old plan has no meaning.
            self.plan = None;
            self.round = None;
            self.state = State::Cruise;
        }
        self.last_time_s = situation.time_s;
        let now = MotionState::of(&situation.ownship);
        self.on_mission(situation, |progress, route| {
            progress.update(route, &now, situation.time_s);
        });
        self.around.load(
            situation,
            self.settings.surveillance_radius_m,
            self.settings.horizon_s,
        );
        match self.settings.rule {
            Rule::Corrected(start) => {
                self.step_directions(situation, &now, Edition::Corrected, start)
            }
            Rule::AsPrinted => self.step_directions(
                situation,
                &now,
                Edition::AsPrinted,
                fga::avoider::Start::Latest,
            ),
            Rule::Circle => self.step_circle(situation, &now),
        }
    }

    fn retune(&mut self, vehicle: &Vehicle) {
        // If the guidance refuses the limits, it keeps its present ones.
        if vehicle.check().is_ok() {
            self.vehicle = *vehicle;
            self.flyer = Turner::new(vehicle);
        }
    }

    fn restart(&mut self) {
        self.vehicle = self.made_for;
        self.flyer = Turner::new(&self.vehicle);
        self.state = State::Cruise;
        self.progress = Progress::new();
        self.around.clear();
        self.tracks.forget();
        self.plan = None;
        self.round = None;
        self.last_time_s = f64::NEG_INFINITY;
    }
}

/// The threat of an obstacle, if there is one (Alg. 1).
fn threat(relative: &Relative, obstacle: &Hazard, edition: Edition) -> Option<Threat> {
    let closest = relative.closest();
    let of = |entry_s: f64, margin_m: f64| Threat {
        id: obstacle.id(),
        entry_s,
        closest_s: closest.time_s,
        margin_m,
    };
    match edition {
        Edition::AsPrinted => {
            let bias = relative.bias_rad()?;
            let radius_m = obstacle.volume.radius_m();
            let distance_m = relative.distance_m();
            printed::is_dangerous(distance_m, bias, radius_m)
                .then(|| of(closest.time_s, distance_m * libm::sin(bias) - radius_m))
        }
        Edition::Corrected => match assess(relative, &obstacle.volume) {
            Conflict::Passing { .. } | Conflict::Receding { .. } => None,
            Conflict::Inside { margin_m } => Some(of(0.0, margin_m)),
            Conflict::Threat {
                entry_s,
                closest_s,
                margin_m,
            } => Some(Threat {
                id: obstacle.id(),
                entry_s,
                closest_s,
                margin_m,
            }),
        },
    }
}
