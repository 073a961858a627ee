//! The distance of a way back from the mission.

use super::join::Join;
use super::{MOST_LEGS, Progress};
use crate::limit::Limit as _;
use crate::prediction::{Flyer, MotionState, for_each_piece};
use crate::situation::Mission;

/// Moments of a way back at which its distance from the mission is measured.
const MOMENTS: u32 = 12;

/// A step with less work left than this measures no further way back: those of 96 legs take at most this.
const LEAST_LEFT: u32 = 8_000;

impl Progress {
    /// Whether this step has work left to measure another way back.
    pub(crate) const fn may_measure(&self) -> bool {
        self.work.0.saturating_sub(self.work.1) >= LEAST_LEFT
    }

    /// Largest distance of a way onto the leg that begins at waypoint `index` from the mission, metres.
    pub fn departure_m(
        &mut self,
        mission: &Mission<'_>,
        state: &MotionState,
        flyer: &Flyer,
        (joined, index): (&Join, usize),
    ) -> f64 {
        let legs = mission.waypoints_m.windows(2).skip(self.index);
        let legs = legs.take(index.saturating_sub(self.index).min(MOST_LEGS) + 1);
        let meter = self.meter();
        let mut farthest_m: f64 = 0.0;
        let moment_s = |moment: u32| joined.joined_s * f64::from(moment) / f64::from(MOMENTS);
        let piece_work = flyer.piece_work();
        let mut moment = 1;
        for_each_piece(
            flyer,
            state,
            &joined.maneuver,
            joined.joined_s,
            |from, piece, lasts_s| {
                meter.count(piece_work);
                while moment <= MOMENTS && !meter.is_met() {
                    let after_s = moment_s(moment);
                    let since_s = after_s - from.time_s;
                    if since_s > lasts_s && moment < MOMENTS {
                        return;
                    }
                    meter.count(legs.len() / 2);
                    let there = flyer.advance(from, piece, since_s.min(lasts_s));
                    let place_m = there.position_m + self.wind_mps * after_s;
                    let mut nearest_m = f64::INFINITY;
                    for leg in legs.clone() {
                        let [from_m, to_m] = leg else { continue };
                        let (along, offset) = (*to_m - *from_m, place_m - *from_m);
                        let share = offset.dot(along) / along.length_squared().max(1e-9);
                        nearest_m =
                            nearest_m.min((offset - along * share.limited(0.0, 1.0)).length());
                    }
                    farthest_m = farthest_m.max(nearest_m);
                    moment += 1;
                }
            },
        );
        if meter.is_met() {
            farthest_m = f64::INFINITY;
        }
        self.note(&meter);
        farthest_m
    }
}
