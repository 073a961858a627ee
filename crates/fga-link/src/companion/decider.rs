//! Who decides: our own policy, or the paper's Algorithm 4.

use fga::avoider::{Avoider, Decision, Settings, Start, State};
use fga::limit::SettingsError;
use fga::pilot::Pilot as _;
use fga::situation::Situation;
use fga::vehicle::Vehicle;
use fga_paper::pilot::{PaperPilot, PaperSettings, Rule};

use crate::config::{CommandMode, Config};

/// How much faster than estimated a vehicle may turn: the estimate of the turn-rate factor is a little low.
const TURN_RATE_EXCESS: f64 = 1.07;

/// Where the configuration has no safety score: a manoeuvre for obstacles at rest begins after this share of the time until the
/// latest certified start. The least departure from the mission would begin as soon as the obstacle is seen, and hold the mode for
/// a minute; manoeuvres for aircraft wait anyway.
const LATE_SCORE: f64 = 0.9;

/// The pilot of a companion.
#[derive(Debug, Clone)]
pub(super) enum CompanionPilot {
    Avoider(Box<Avoider>),
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
        Ok(Self::Avoider(Box::new(Avoider::new(settings, vehicle)?)))
    }

    pub(super) fn step(&mut self, situation: &Situation<'_>) -> Decision {
        match self {
            Self::Avoider(avoider) => avoider.step(situation),
            Self::Paper(pilot) => pilot.step(situation),
        }
    }

    /// The limits that are planned with.
    pub(super) fn vehicle(&self) -> &Vehicle {
        match self {
            Self::Avoider(avoider) => avoider.vehicle(),
            Self::Paper(pilot) => pilot.vehicle(),
        }
    }

    /// The limits of plans in need; `None` where they are the ordinary ones.
    pub(super) fn vehicle_in_need(&self) -> Option<&Vehicle> {
        match self {
            Self::Avoider(avoider) => avoider.vehicle_in_need(),
            Self::Paper(_) => None,
        }
    }

    pub(super) const fn state(&self) -> State {
        match self {
            Self::Avoider(avoider) => avoider.state(),
            Self::Paper(pilot) => pilot.state(),
        }
    }

    /// Index of the waypoint at the start of the leg that is flown.
    pub(super) fn leg_index(&self) -> usize {
        match self {
            Self::Avoider(avoider) => avoider.leg_index(),
            Self::Paper(pilot) => pilot.leg_index(),
        }
    }

    /// Whether its manoeuvres are certified with its limits, so that they may be flown on without telemetry. Algorithm 4 follows its circle by
    /// the airspeed that the vehicle flies now.
    pub(super) const fn certifies(&self) -> bool {
        matches!(self, Self::Avoider(_))
    }

    /// Takes over other limits. Limits that cannot be flown change nothing.
    pub(super) fn retune(&mut self, vehicle: &Vehicle) {
        match self {
            Self::Avoider(avoider) => avoider.retune(vehicle),
            Self::Paper(pilot) => pilot.retune(vehicle),
        }
    }

    /// Sets the velocity with which it may leave its prediction, metres per second; Algorithm 4 has no such margin.
    pub(super) fn set_drift(&mut self, drift_mps: f64) {
        if let Self::Avoider(avoider) = self {
            // One out of range changes nothing.
            let _ = avoider.set_drift(drift_mps);
        }
    }

    /// Sets when a manoeuvre begins; Algorithm 4 has its own rule.
    pub(super) fn set_start(&mut self, start: Start) {
        if let Self::Avoider(avoider) = self {
            // Only a score can be out of range.
            let _ = avoider.set_start(start);
        }
    }

    /// Takes over other limits in need; those that cannot be flown change nothing.
    pub(super) fn set_vehicle_in_need(&mut self, vehicle: Option<Vehicle>) {
        if let Self::Avoider(avoider) = self {
            // Limits that cannot be flown change nothing.
            let _ = avoider.set_vehicle_in_need(vehicle);
        }
    }
}
