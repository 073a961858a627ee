//! The distance of a way back from the mission.

use super::{MOST_LEGS, Progress, Way};
use fga_proof::Vec3;
use fga_proof::limit::Limit as _;
use fga_proof::situation::Mission;

/// Most work for measuring one way back, for each leg from which it is measured.
const WORK_A_LEG: usize = 80;

impl Progress {
    /// Whether this step has work left to measure another way back, onto one of the `last` legs after the present one.
    pub fn may_measure(&self, mission: &Mission<'_>, last: usize) -> bool {
        let ahead = mission.waypoints_m.len().saturating_sub(self.index + 1);
        let legs = (last.min(MOST_LEGS) + 1).min(ahead.max(1));
        self.meter().left() as usize >= WORK_A_LEG * (legs + 3)
    }

    /// Largest distance of a way onto the leg that begins at waypoint `index` from the mission, metres, or some that is
    /// at least `enough_m`.
    pub fn departure_m(
        &mut self,
        mission: &Mission<'_>,
        (way, index): (&Way, usize),
        enough_m: f64,
    ) -> f64 {
        let last = index.saturating_sub(self.index);
        let mut farthest_m: f64 = 0.0;
        for place in way.places() {
            if farthest_m >= enough_m {
                break;
            }
            farthest_m = farthest_m.max(self.aside_m(mission, last, (place.at_m, place.at_s)));
        }
        farthest_m
    }

    /// Distance of a place in the air, metres, at a time, seconds from the decision, from the present leg and the `last`
    /// ones after it, metres; infinite once the work is done.
    fn aside_m(&mut self, mission: &Mission<'_>, last: usize, (place_m, at_s): (Vec3, f64)) -> f64 {
        let legs = mission.waypoints_m.windows(2).skip(self.index);
        let legs = legs.take(last.min(MOST_LEGS) + 1);
        let meter = self.meter();
        if meter.is_met() || !meter.take(legs.size_hint().0 / 2) {
            return f64::INFINITY;
        }
        self.note(&meter);
        let place_m = place_m + self.wind_mps * at_s;
        let mut nearest_m = f64::INFINITY;
        for leg in legs {
            let [from_m, to_m] = leg else { continue };
            let (along, offset) = (*to_m - *from_m, place_m - *from_m);
            let share = offset.dot(along) / along.length_squared().max(1e-9);
            let aside = offset - along * share.limited(0.0, 1.0);
            nearest_m = nearest_m.min(aside.length_squared());
        }
        libm::sqrt(nearest_m)
    }
}
