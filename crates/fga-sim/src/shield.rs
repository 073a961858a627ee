//! Run-time assurance: any policy may fly as long as a certified way out remains.
//!
//! At each decision the shield predicts the path of the policy's wish until the next decision, certifies it,
//! and asks its own avoider whether a certified manoeuvre exists from its end. If either fails, the avoider
//! flies instead of the policy, from the last state with a certified way out, until a wish of the policy passes
//! again. The certificate has the avoider's assumptions: the aircraft flies as its limits say, and obstacles
//! move as expected.

use fga::assumptions::Assumptions;
use fga::avoider::{Avoider, Decision, Reason, Settings, SettingsError, Start, State};
use fga::certificate::{Hazard, certify_set};
use fga::maneuver::Maneuver;
use fga::meter::Meter;
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::{Mission, Movement, Obstacle, Obstacles, Ownship, Situation};
use fga::vehicle::Vehicle;

/// The result of the shield.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shielded {
    /// The command to fly.
    pub decision: Decision,
    /// Whether the command comes from the shield instead of the policy.
    pub engaged: bool,
}

/// Lets a policy fly as long as a certified way out remains.
#[derive(Debug, Clone)]
pub struct Shield {
    settings: Settings,
    flyer: Flyer,
    path: Box<FlightPath>,
    /// Looks for a way out; has no memory.
    probe: Box<Avoider>,
    /// Flies the way out.
    guard: Box<Avoider>,
    engaged: bool,
    /// The obstacles at the next decision.
    ahead: Vec<Obstacle>,
    /// The obstacles now, in the air mass.
    hazards: Vec<Hazard>,
}

impl Shield {
    /// A shield for a vehicle, with the settings of an avoider; their start does not matter.
    ///
    /// # Errors
    /// A setting or a limit of the vehicle that is not finite or out of range.
    pub fn new(settings: Settings, vehicle: Vehicle) -> Result<Self, SettingsError> {
        let at_once = Settings {
            start: Start::AtDetection,
            ..settings
        };
        Ok(Self {
            settings,
            flyer: Flyer::new(&vehicle),
            path: Box::new(FlightPath::new()),
            probe: Box::new(Avoider::new(at_once, vehicle)?),
            guard: Box::new(Avoider::new(at_once, vehicle)?),
            engaged: false,
            ahead: Vec::new(),
            hazards: Vec::new(),
        })
    }

    /// Forgets the last flight.
    pub fn restart(&mut self) {
        fga::pilot::Pilot::restart(self.guard.as_mut());
        self.engaged = false;
    }

    /// Passes the wish of a policy, or decides instead.
    pub fn step(&mut self, situation: &Situation<'_>, wish: &Maneuver) -> Shielded {
        if self.leaves_a_way_out(situation, wish) {
            self.engaged = false;
            return Shielded {
                decision: Decision::new(State::Cruise, wish, Reason::Clear),
                engaged: false,
            };
        }
        if !self.engaged {
            fga::pilot::Pilot::restart(self.guard.as_mut());
            self.engaged = true;
        }
        Shielded {
            decision: self.guard.step(situation),
            engaged: true,
        }
    }

    /// Whether a certified manoeuvre, or no manoeuvre, is enough at the end of the wish's path to the next
    /// decision.
    fn leaves_a_way_out(&mut self, situation: &Situation<'_>, wish: &Maneuver) -> bool {
        let period_s = self.settings.decision_period_s;
        let own = &situation.ownship;
        let now = MotionState::of(own);
        self.path.predict(&self.flyer, &now, wish, 2.0 * period_s);
        let Some(next) = self.path.state_at(&self.flyer, period_s) else {
            return false;
        };
        let sigmas = self.settings.confidence_sigmas;
        self.hazards.clear();
        let known = situation.obstacles.iter();
        self.hazards
            .extend(known.map(|obstacle| Hazard::new(&obstacle, situation.wind_mps, sigmas)));
        let margin_m = self.settings.margin_m;
        // The aircraft flies to the next decision whatever follows then.
        if !certify_set(
            &self.flyer,
            &self.path,
            &Assumptions::only(&self.hazards),
            (period_s, margin_m, margin_m),
            &Meter::unlimited(),
        )
        .holds(margin_m)
        {
            return false;
        }
        self.ahead.clear();
        self.ahead
            .extend(situation.obstacles.iter().map(|obstacle| {
                let moved_s = if obstacle.movement == Movement::AtRest {
                    0.0
                } else {
                    period_s
                };
                Obstacle {
                    position_m: obstacle.position_after_m(moved_s),
                    age_s: obstacle.age_s + moved_s,
                    ..obstacle
                }
            }));
        let ahead = Situation {
            time_s: situation.time_s + period_s,
            ownship: Ownship {
                position_m: next.position_m + situation.wind_mps * period_s,
                course_rad: next.course_rad,
                climb_rad: next.climb_rad,
                bank_rad: next.bank_rad,
                ..*own
            },
            obstacles: Obstacles::Rows(&self.ahead),
            // Without a threat the aircraft holds course and altitude: the policy may wish anything.
            mission: Mission::new(&[]),
            wind_mps: situation.wind_mps,
        };
        fga::pilot::Pilot::restart(self.probe.as_mut());
        let reason = self.probe.step(&ahead).record.reason;
        !matches!(
            reason,
            Reason::BestAvailable | Reason::InsideVolume | Reason::InvalidInput
        )
    }
}
