//! Certifies farther ahead among obstacles that move nearly as the aircraft does: a gap between them that is
//! certified for a minute may close in the next.

use crate::avoider::{Avoider, Places};
use crate::certificate::Hazard;
use crate::prediction::MotionState;

/// An obstacle whose velocity differs from the aircraft's by less than this share of the airspeed may stay
/// near for long.
const SLOW: f64 = 0.4;

/// Longest horizon of a manoeuvre among such obstacles, seconds.
const FAR_S: f64 = 240.0;

impl Avoider<dyn Places + '_> {
    /// The longer horizon of a manoeuvre's certificate: an obstacle that flies nearly as the aircraft does, now or
    /// on the mission, takes long to pass.
    #[inline(never)]
    pub(super) fn far_horizon_s(&self, now: &MotionState) -> f64 {
        let horizon_s = self.settings.horizon_s;
        let slow_mps = SLOW * self.flyer.airspeed_mps();
        let course_rad = now.course_rad + self.progress.leg(now).turn_onto_rad(now);
        let on_mission = MotionState { course_rad, ..*now };
        let ours_mps = [now, &on_mission].map(|state| self.flyer.velocity_mps(state));
        let stays = |hazard: &Hazard| {
            let mut ours_mps = ours_mps.iter();
            ours_mps.any(|mps| (hazard.velocity_mps - mps).length() < slow_mps)
        };
        if self.tracks.rows().iter().any(stays) {
            horizon_s.max(FAR_S)
        } else {
            horizon_s
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{among, sphere};
    use super::*;

    #[test]
    fn what_flies_nearly_as_the_aircraft_is_certified_for_longer() {
        let speed_mps = 15.0;
        let horizon_s = |velocity_mps| {
            let rows = [sphere(1, (200.0, 0.0), velocity_mps)];
            among(&rows, |avoider, _, now| {
                assert_eq!(avoider.flyer.airspeed_mps(), speed_mps);
                avoider.far_horizon_s(now)
            })
        };
        let usual_s = crate::avoider::Settings::default().horizon_s;
        assert_eq!(horizon_s((0.61 * speed_mps, 0.0)), FAR_S);
        assert_eq!(horizon_s((0.59 * speed_mps, 0.0)), usual_s);
        assert_eq!(horizon_s((-speed_mps, 0.0)), usual_s);
    }
}
