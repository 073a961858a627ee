//! Detours: the beginning of a way back from beside obstacles that fly alongside and so do not pass, or from between walls: zones and ground.

use crate::avoider::{Avoider, Now, Places};
use crate::maneuver::Stage;
use crate::prediction::MotionState;
use crate::situation::Situation;

/// After the time of this turn without a way back the search also covers detours, radians; between walls after twice that time.
pub(in crate::avoider) const AFTER_RAD: f64 = 4.0;

/// An obstacle within this distance flies alongside, turn radii, ...
const NEAR_RADII: f64 = 2.0;

/// ... and at most this share of the airspeed relative to the aircraft.
const SLOW_SHARE: f64 = 0.4;

/// The first turn of a detour is any up to this to either side, radians, ...
const TURN_RAD: f64 = 4.0;

/// ... and the straight flight after it any up to this, turn radii; ...
const STRAIGHT: f64 = 3.0;

/// ... up to this, out of a whole formation, ...
const FAR: f64 = 14.0;

/// ... after the time of this turn without a way back, radians.
const FAR_AFTER_RAD: f64 = 60.0;

/// The fractions of multiples of these two are spread evenly over a square: the reciprocals of the plastic ratio and of its square.
const SPREAD: [f64; 2] = [0.754_878, 0.569_840];

impl Avoider<dyn Places + '_> {
    /// A turn away from an obstacle alongside, or between walls, with a straight flight after it, one of many, and the aircraft after it;
    /// none while a way back without one may still be found.
    pub(super) fn detour(
        &self,
        situation: &Situation<'_>,
        now: &Now<'_>,
        (waited_s, which): (f64, usize),
    ) -> Option<(Stage, MotionState)> {
        let rate_radps = self.flyer.course_rate_radps();
        let waited_rad = waited_s * rate_radps;
        if waited_rad <= AFTER_RAD {
            return None;
        }
        if !self.is_between_walls(now, waited_s) && !self.is_accompanied(situation) {
            return None;
        }
        let [aside, along] = SPREAD.map(|spread| {
            let drawn = spread * which as f64;
            drawn - libm::floor(drawn)
        });
        let is_far = waited_rad > FAR_AFTER_RAD && which % 2 == 1;
        let most = if is_far { FAR } else { STRAIGHT };
        let turn_rad = TURN_RAD * (1.0 - 2.0 * aside);
        let first = Stage::turn(0.0, now.course_rad + turn_rad, now.climb_rad);
        let until_s = (turn_rad.abs() + most * libm::sqrt(along)) / rate_radps;
        Some((first, self.after(now, &[first], until_s)))
    }

    /// Whether an obstacle flies alongside, so that it does not pass; one at rest does not fly.
    fn is_accompanied(&self, situation: &Situation<'_>) -> bool {
        let own = situation.ownship;
        let velocity_mps = own.velocity_mps();
        let near_m = NEAR_RADII * own.airspeed_mps / self.flyer.course_rate_radps();
        self.tracks.rows().iter().any(|hazard| {
            (velocity_mps - hazard.velocity_mps).length() < SLOW_SHARE * own.airspeed_mps
                && hazard.velocity_mps != -situation.wind_mps
                && hazard.margin_m(own.position_m, 0.0) < near_m
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{among, sphere};
    use super::*;

    /// At 20 m/s, behind which an obstacle flies alongside, and one at rest never does.
    #[test]
    fn a_detour_leads_away_from_what_flies_alongside_for_long() {
        let course_rad = |velocity_mps, waited_s, which| {
            let rows = [sphere(1, (0.0, 60.0), velocity_mps)];
            among(&rows, |avoider, situation, now| {
                let detour = avoider.detour(situation, now, (waited_s, which));
                detour.map(|(first, _)| first.course_rad)
            })
        };
        let alongside = (18.0, 0.0);
        assert_eq!(course_rad(alongside, 1.0, 0), None);
        assert_eq!(course_rad(alongside, 30.0, 0), Some(TURN_RAD));
        let turns_rad = (0..100).filter_map(|which| course_rad(alongside, 30.0, which));
        let turns_rad: alloc::vec::Vec<f64> = turns_rad.collect();
        // Each tenth of the turns to both sides is tried as often as another one.
        for part in -5..5 {
            let [low_rad, high_rad] = [part, part + 1].map(|part| 0.2 * TURN_RAD * f64::from(part));
            let tried = turns_rad
                .iter()
                .filter(|turn_rad| (low_rad..high_rad).contains(*turn_rad));
            assert!((8..=12).contains(&tried.count()), "{part}");
        }
        assert_eq!(course_rad((-18.0, 0.0), 30.0, 0), None);
        assert_eq!(course_rad((0.0, 0.0), 30.0, 0), None);
    }
}
