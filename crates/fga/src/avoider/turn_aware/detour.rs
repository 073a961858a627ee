//! Detours: the beginning of a way back from beside obstacles that fly alongside and so do not pass, or from between zones.

use core::f64::consts::PI;

use crate::avoider::{Avoider, Places};
use crate::maneuver::{Maneuver, Stage};
use crate::prediction::MotionState;
use crate::situation::Situation;

/// After the time of this turn without a way back the search also covers ways behind an obstacle that flies
/// alongside, and after twice that time turns round between zones, radians.
const AFTER_RAD: f64 = 4.0;

/// An obstacle within this distance flies alongside, turn radii, ...
const ALONGSIDE: f64 = 2.0;

/// ... and at most this share of the airspeed relative to the aircraft.
const ALONGSIDE_SPEED: f64 = 0.4;

/// The first turns of a detour, radians, and the straight flight after them, turn radii.
const DETOURS: [(f64, f64); 8] = [
    (PI, 0.0),
    (-PI, 0.0),
    (2.1, 1.0),
    (-2.1, 1.0),
    (4.7, 0.0),
    (-4.7, 0.0),
    (1.3, 3.0),
    (-1.3, 3.0),
];

/// Between zones wind may leave room to turn round to one side alone, and only from farther away from the edge there: a turn, radians, a
/// straight flight after it, turn radii, and a turn round by this from the present course, radians.
const TURNS_BACK: [(f64, f64, f64); 4] = [
    (0.0, 0.0, PI),
    (0.0, 0.0, -PI),
    (-0.7, 2.0, PI),
    (0.7, 2.0, -PI),
];

/// After the time of this turn without a way back a detour may lead out of a whole formation, radians: ...
const FAR_AFTER_RAD: f64 = 60.0;

/// ... its first turn is any up to this to either side, radians, ...
const FAR_TURN_RAD: f64 = 5.0;

/// ... and the straight flight after it so many turn radii.
const FAR: f64 = 14.0;

/// The fractions of multiples of this are spread evenly: the golden ratio.
const GOLDEN: f64 = 0.618_034;

impl Avoider<dyn Places + '_> {
    /// A turn away from an obstacle alongside, or a turn round between zones, one of several, and the aircraft after it; none while a way
    /// back without one may still be found.
    pub(super) fn detour(
        &self,
        situation: &Situation<'_>,
        now: &MotionState,
        (waited_s, which): (f64, usize),
    ) -> Option<(Maneuver, MotionState)> {
        let rate_radps = self.flyer.course_rate_radps();
        let waited_rad = waited_s * rate_radps;
        if waited_rad <= AFTER_RAD {
            return None;
        }
        let turned = |turn_rad| Maneuver::turn(0.0, now.course_rad + turn_rad, now.climb_rad);
        if !self.is_accompanied(situation) {
            // In turn with the ways back without a detour.
            let is_long = waited_rad > 2.0 * AFTER_RAD;
            let is_next = which % 2 == 1 && is_long && self.tracks.has_zones();
            let turns = TURNS_BACK.get(which / 2 % TURNS_BACK.len());
            let (turn_rad, radii, round_rad) = turns.copied().filter(|_| is_next)?;
            let mut maneuver = turned(turn_rad);
            let start_s = (turn_rad.abs() + radii) / rate_radps;
            for stage in turned(round_rad).stages() {
                maneuver.push(Stage { start_s, ..*stage });
            }
            let until_s = start_s + (turn_rad - round_rad).abs() / rate_radps;
            return Some((maneuver, self.after(now, &maneuver, until_s)));
        }
        let (round, index) = (which / DETOURS.len(), which % DETOURS.len());
        let (turn_rad, radii) = if waited_rad > FAR_AFTER_RAD && round % 2 == 1 {
            let turns = GOLDEN * which as f64;
            let share = turns - libm::floor(turns);
            (FAR_TURN_RAD * (2.0 * share - 1.0), FAR)
        } else {
            DETOURS.get(index).copied().unwrap_or_default()
        };
        let maneuver = turned(turn_rad);
        let until_s = (turn_rad.abs() + radii) / rate_radps;
        Some((maneuver, self.after(now, &maneuver, until_s)))
    }

    /// Whether an obstacle flies alongside, so that it does not pass; one at rest does not fly.
    fn is_accompanied(&self, situation: &Situation<'_>) -> bool {
        let own = situation.ownship;
        let velocity_mps = own.velocity_mps();
        let near_m = ALONGSIDE * own.airspeed_mps / self.flyer.course_rate_radps();
        self.tracks.rows().iter().any(|hazard| {
            (velocity_mps - hazard.velocity_mps).length() < ALONGSIDE_SPEED * own.airspeed_mps
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
                detour.map(|(maneuver, _)| maneuver.stages()[0].course_rad)
            })
        };
        let alongside = (18.0, 0.0);
        assert_eq!(course_rad(alongside, 1.0, 0), None);
        assert_eq!(course_rad(alongside, 30.0, 0), Some(PI));
        assert_eq!(course_rad(alongside, 30.0, 1), Some(-PI));
        assert_eq!(course_rad((-18.0, 0.0), 30.0, 0), None);
        assert_eq!(course_rad((0.0, 0.0), 30.0, 0), None);
    }
}
