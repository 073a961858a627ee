//! The distance of a way back from the mission.

use super::{MOST_LEGS, Progress, Way};
use crate::limit::Limit as _;
use crate::situation::Mission;

/// A step with less work left than this measures no further way back: those of 96 legs take at most this.
const LEAST_LEFT: u32 = 8_000;

impl Progress {
    /// Whether this step has work left to measure another way back.
    pub(crate) const fn may_measure(&self) -> bool {
        self.work.0.saturating_sub(self.work.1) >= LEAST_LEFT
    }

    /// Largest distance of a way onto the leg that begins at waypoint `index` from the mission, metres.
    pub(crate) fn departure_m(&mut self, mission: &Mission<'_>, way: &Way, index: usize) -> f64 {
        let legs = mission.waypoints_m.windows(2).skip(self.index);
        let legs = legs.take(index.saturating_sub(self.index).min(MOST_LEGS) + 1);
        let meter = self.meter();
        let mut farthest_m: f64 = 0.0;
        for (place_m, at_s) in way.places() {
            if meter.is_met() {
                farthest_m = f64::INFINITY;
                break;
            }
            meter.count(legs.len() / 2);
            let place_m = *place_m + self.wind_mps * *at_s;
            let mut nearest_m = f64::INFINITY;
            for leg in legs.clone() {
                let [from_m, to_m] = leg else { continue };
                let (along, offset) = (*to_m - *from_m, place_m - *from_m);
                let share = offset.dot(along) / along.length_squared().max(1e-9);
                nearest_m = nearest_m.min((offset - along * share.limited(0.0, 1.0)).length());
            }
            farthest_m = farthest_m.max(nearest_m);
        }
        self.note(&meter);
        farthest_m
    }
}
