//! Who decides: one of our own policies, or the paper's Algorithm 4.

use fga::avoider::belief::{BeliefAvoider, Errors, Sigma, Source};
use fga::avoider::{Avoider, Decision, Settings, Start, State};
use fga::limit::SettingsError;
use fga::pilot::Pilot as _;
use fga::situation::Situation;
use fga::vehicle::Vehicle;
use fga_paper::pilot::{PaperPilot, PaperSettings, Rule};

use crate::config::{CommandMode, Config, PolicyName};
use crate::traffic::motion::ALTITUDE_STEP_M;
use crate::traffic::report::VELOCITY_SIGMA_MPS;

/// How much faster than estimated a vehicle may turn: the estimate of the turn-rate factor is a little low.
const TURN_RATE_EXCESS: f64 = 1.07;

/// Where the configuration has no safety score: a manoeuvre for obstacles at rest begins after this share of the time until the
/// latest certified start. The least departure from the mission would begin as soon as the obstacle is seen, and hold the mode for
/// a minute; manoeuvres for aircraft wait anyway.
const LATE_SCORE: f64 = 0.9;

/// The errors of a report that does not say them; that of its altitude's datum is in the volume.
#[expect(clippy::cast_possible_truncation, reason = "standard deviations")]
fn assumed_errors(position_sigma_m: f64) -> Errors {
    let assumed = |value: f64| Sigma::new(value as f32, Source::Assumed);
    Errors {
        position_m: assumed(position_sigma_m),
        // σ of what is rounded to steps.
        altitude_m: assumed(ALTITUDE_STEP_M / libm::sqrt(12.0)),
        velocity_mps: assumed(VELOCITY_SIGMA_MPS),
        climb_mps: assumed(VELOCITY_SIGMA_MPS),
        ..Errors::default()
    }
}

/// The pilot of a companion.
#[derive(Debug, Clone)]
pub(super) enum CompanionPilot {
    Avoider(Box<Avoider>),
    Belief(Box<BeliefAvoider>),
    Paper(Box<PaperPilot>),
}

impl CompanionPilot {
    pub(super) fn new(config: &Config, vehicle: Vehicle) -> Result<Self, SettingsError> {
        let protection = &config.protection;
        let decision_period_s = config.command.decision_period_s;
        // The caller has left out distant obstacles.
        let surveillance_radius_m = f64::INFINITY;
        if config.command.mode == CommandMode::Paper {
            let settings = PaperSettings {
                decision_period_s,
                surveillance_radius_m,
                horizon_s: protection.horizon_s,
                margin_m: protection.margin_m,
                confidence_sigmas: protection.confidence_sigmas,
                turn_rate_excess: TURN_RATE_EXCESS,
                ..PaperSettings::new(Rule::Circle)
            };
            return Ok(Self::Paper(Box::new(PaperPilot::new(settings, vehicle)?)));
        }
        let settings = Settings {
            start: Start::Score(protection.safety_score.unwrap_or(LATE_SCORE)),
            decision_period_s,
            surveillance_radius_m,
            horizon_s: protection.horizon_s,
            margin_m: protection.margin_m,
            confidence_sigmas: protection.confidence_sigmas,
            ..Settings::default()
        };
        Ok(match config.command.policy {
            PolicyName::TurnAware => Self::Avoider(Box::new(Avoider::new(settings, vehicle)?)),
            PolicyName::Belief => {
                let errors = assumed_errors(config.traffic.position_sigma_m);
                Self::Belief(Box::new(BeliefAvoider::new(settings, vehicle, errors)?))
            }
        })
    }

    pub(super) fn step(&mut self, situation: &Situation<'_>) -> Decision {
        match self {
            Self::Avoider(avoider) => avoider.step(situation),
            Self::Belief(avoider) => {
                // The table of tracks says who is there, and for how long.
                avoider.forget_absent(situation);
                avoider.step(situation)
            }
            Self::Paper(pilot) => pilot.step(situation),
        }
    }

    /// The avoider, or the one of a choice among beliefs; `None` of Algorithm 4.
    const fn avoider(&self) -> Option<&Avoider> {
        match self {
            Self::Avoider(avoider) => Some(avoider),
            Self::Belief(avoider) => Some(avoider.avoider()),
            Self::Paper(_) => None,
        }
    }

    /// The same, to change its limits.
    const fn avoider_mut(&mut self) -> Option<&mut Avoider> {
        match self {
            Self::Avoider(avoider) => Some(avoider),
            Self::Belief(avoider) => Some(avoider.avoider_mut()),
            Self::Paper(_) => None,
        }
    }

    /// The limits that are planned with.
    pub(super) fn vehicle(&self) -> &Vehicle {
        match self {
            Self::Avoider(avoider) => avoider.vehicle(),
            Self::Belief(avoider) => avoider.avoider().vehicle(),
            Self::Paper(pilot) => pilot.vehicle(),
        }
    }

    /// The limits of plans in need; `None` where they are the ordinary ones.
    pub(super) fn vehicle_in_need(&self) -> Option<&Vehicle> {
        self.avoider()?.vehicle_in_need()
    }

    pub(super) const fn state(&self) -> State {
        match self {
            Self::Avoider(avoider) => avoider.state(),
            Self::Belief(avoider) => avoider.avoider().state(),
            Self::Paper(pilot) => pilot.state(),
        }
    }

    /// Index of the waypoint at the start of the leg that is flown.
    pub(super) fn leg_index(&self) -> usize {
        match self {
            Self::Avoider(avoider) => avoider.leg_index(),
            Self::Belief(avoider) => avoider.avoider().leg_index(),
            Self::Paper(pilot) => pilot.leg_index(),
        }
    }

    /// Whether its manoeuvres are certified with its limits, so that they may be flown on without telemetry. Algorithm 4 follows its circle by
    /// the airspeed that the vehicle flies now.
    pub(super) const fn certifies(&self) -> bool {
        self.avoider().is_some()
    }

    /// Takes over other limits. Limits that cannot be flown change nothing.
    pub(super) fn retune(&mut self, vehicle: &Vehicle) {
        match self {
            Self::Avoider(avoider) => avoider.retune(vehicle),
            Self::Belief(avoider) => avoider.retune(vehicle),
            Self::Paper(pilot) => pilot.retune(vehicle),
        }
    }

    /// Sets the velocity with which it may leave its prediction, metres per second; Algorithm 4 has no such margin.
    pub(super) fn set_drift(&mut self, drift_mps: f64) {
        if let Some(avoider) = self.avoider_mut() {
            // One out of range changes nothing.
            let _ = avoider.set_drift(drift_mps);
        }
    }

    /// Sets when a manoeuvre begins; Algorithm 4 has its own rule.
    pub(super) fn set_start(&mut self, start: Start) {
        if let Some(avoider) = self.avoider_mut() {
            // Only a score can be out of range.
            let _ = avoider.set_start(start);
        }
    }

    /// Takes over other limits in need; those that cannot be flown change nothing.
    pub(super) fn set_vehicle_in_need(&mut self, vehicle: Option<Vehicle>) {
        if let Some(avoider) = self.avoider_mut() {
            // Limits that cannot be flown change nothing.
            let _ = avoider.set_vehicle_in_need(vehicle);
        }
    }
}
