//! Round one static obstacle in the plane (Fig. 8, Algorithm 4): the policy `circle`.

use fga::angle::Side;
use fga::avoider::{Against, Decision, Reason, State, Threat};
use fga::certificate::Hazard;
use fga::prediction::MotionState;
use fga::situation::{Ownship, ProtectedVolume, Situation};

use super::{Edition, PaperPilot, Plan, threat};
use crate::classification::{Motion, motion};
use crate::conflict::{Relative, detect};
use crate::paths::RoundObstacle;
use crate::timing::Geometry;

/// Speed over the ground up to which an obstacle counts as static, metres per second.
const STATIC_MPS: f64 = 0.1;

/// How often the way round is widened by the drift in the time that it takes.
const DRIFT_STEPS: u32 = 6;

impl PaperPilot {
    /// The policy `circle`: round one static obstacle in the plane (Fig. 8, Alg. 4).
    pub(super) fn step_circle(&mut self, situation: &Situation<'_>, now: &MotionState) -> Decision {
        let time_s = situation.time_s;
        if let Some(plan) = self.plan {
            let begun = time_s >= plan.start_s;
            if time_s < plan.joined_s {
                self.state = if begun {
                    State::Avoiding
                } else {
                    State::Threatened
                };
                let reason = if begun {
                    Reason::ManeuverKept
                } else {
                    Reason::WaitingForStart
                };
                return self.report(&plan, time_s, reason);
            }
            self.plan = None;
        }
        self.state = State::Cruise;
        let nominal = self.guidance(situation, now);
        let own = situation.ownship;
        let radius_m = self.flyer.airspeed_mps() / self.flyer.course_rate_radps();
        let mut first: Option<(f64, Side, RoundObstacle, Threat)> = None;
        for detection in detect(&own, self.around.hazards(), f64::INFINITY) {
            let Some(obstacle) = self.around.hazards().get(detection.index) else {
                continue;
            };
            if motion(obstacle, situation.wind_mps, STATIC_MPS) != Motion::Static {
                continue;
            }
            let Some((still, geometry, round)) = self.round(&own, &detection.relative, obstacle)
            else {
                continue;
            };
            // The arcs follow their commands late by the bank's lag.
            let late_s = self.vehicle.response.bank_time_constant_s;
            let wait_s = (geometry.along_m - round.before_m) / geometry.closing_mps - late_s;
            let left_m = own.velocity_mps().cross(still.position_m()).z;
            let side = if left_m > 0.0 {
                Side::Right
            } else {
                Side::Left
            };
            let Some(threat) = threat(&detection.relative, obstacle, Edition::Corrected) else {
                continue;
            };
            if first.is_none_or(|(known_s, ..)| wait_s < known_s) {
                first = Some((wait_s, side, round, threat));
            }
        }
        let Some((wait_s, side, round, threat)) = first else {
            return self.decision(&nominal, Reason::Clear);
        };
        let wait_s = wait_s.max(0.0);
        let speeds = (own.airspeed_mps, radius_m);
        let Some(maneuver) = round.maneuver(wait_s, own.course_rad, now.climb_rad, side, speeds)
        else {
            return self.decision(&nominal, Reason::Clear);
        };
        let plan = Plan {
            maneuver,
            decided_s: time_s,
            start_s: time_s + wait_s,
            joined_s: time_s + wait_s + round.length_m() / own.airspeed_mps,
            clears: true,
            margin_m: self.settings.margin_m,
            cost: 0.0,
            latest_start_s: Some(time_s + wait_s),
            threat: Some(threat),
            against: Against::default(),
        };
        self.plan = Some(plan);
        let begins = wait_s < self.settings.decision_period_s;
        self.state = if begins {
            State::Avoiding
        } else {
            State::Threatened
        };
        let reason = if begins {
            Reason::ManeuverChosen
        } else {
            Reason::WaitingForStart
        };
        self.report(&plan, time_s, reason)
    }

    /// The way round an obstacle that stands on the ground, planned in the air mass, where it moves
    /// against the wind: round the place at which it is when it is abeam, so far that it stays clear
    /// of where it drifts from the first turn to the last. Returns that place as it is seen now, its
    /// geometry and the way.
    fn round(
        &self,
        own: &Ownship,
        relative: &Relative,
        obstacle: &Hazard,
    ) -> Option<(Relative, Geometry, RoundObstacle)> {
        let drift_mps = obstacle.velocity_mps;
        let abeam_m = relative.position_m() + drift_mps * relative.closest().time_s;
        let still = Relative::new(abeam_m, own.velocity_mps())?;
        let geometry = level_geometry(&still, obstacle)?;
        let radius_m = self.flyer.airspeed_mps() / self.flyer.course_rate_radps();
        let least_m = geometry.radius_m + self.settings.margin_m;
        let mut round = RoundObstacle::new(radius_m, least_m, geometry.across_m)?;
        // A wider way takes longer, in which the obstacle drifts farther.
        for _ in 0..DRIFT_STEPS {
            let half_s = 0.5 * round.length_m() / own.airspeed_mps;
            let kept_m = least_m + drift_mps.length() * half_s;
            round = RoundObstacle::new(radius_m, kept_m, geometry.across_m)?;
        }
        Some((still, geometry, round))
    }
}

/// The section of an obstacle at the aircraft's height.
fn level_geometry(relative: &Relative, obstacle: &Hazard) -> Option<Geometry> {
    let radius_m = obstacle.volume.radius_m();
    match obstacle.volume {
        ProtectedVolume::Sphere { .. } => Geometry::level_section(relative, radius_m),
        ProtectedVolume::Cylinder { .. } => Geometry::horizontal(relative, radius_m),
    }
}
