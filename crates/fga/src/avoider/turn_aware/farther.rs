//! Certifies farther ahead among obstacles that move nearly as the aircraft does: a gap between them that is
//! certified for a minute may close in the next.

use crate::avoider::demand::Demand;
use crate::avoider::{Avoider, Plan};
use crate::certificate::Hazard;
use crate::maneuver::Maneuver;
use crate::prediction::MotionState;
use crate::search::Effort;

use super::SEARCH_AGAIN;
use super::holding::KEEP_SHARE;

/// An obstacle whose velocity differs from the aircraft's by less than this share of the airspeed may stay
/// near for long.
const SLOW: f64 = 0.4;

/// Longest horizon of a manoeuvre among such obstacles, seconds.
const FAR_S: f64 = 240.0;

impl Avoider {
    /// The longer horizon of a manoeuvre's certificate: an obstacle that flies nearly as the aircraft does, now or
    /// on the mission, takes long to pass.
    pub(super) fn far_horizon_s(&self, now: &MotionState) -> f64 {
        let horizon_s = self.settings.horizon_s;
        let airspeed_mps = self.flyer.airspeed_mps();
        let leg = self.progress.leg(now);
        let on_mission = MotionState {
            course_rad: now.course_rad + leg.turn_onto_rad(now),
            ..*now
        };
        let ours_mps = [now, &on_mission].map(|state| self.flyer.velocity_mps(state));
        let stays = |hazard: &Hazard| {
            let relative_mps = ours_mps.map(|mps| (hazard.velocity_mps - mps).length());
            relative_mps.iter().any(|mps| *mps < SLOW * airspeed_mps)
        };
        if self.tracks.hazards().rows().iter().any(stays) {
            horizon_s.max(FAR_S)
        } else {
            horizon_s
        }
    }

    /// A manoeuvre that is certified farther ahead than the present one, if that one is not.
    pub(super) fn farther(&mut self, plan: &Plan, now: &MotionState, time_s: f64) -> Option<Plan> {
        if self.far_s <= self.settings.horizon_s || !self.cycle.is_multiple_of(SEARCH_AGAIN) {
            return None;
        }
        let flown = plan.remaining(time_s);
        let keep_m = KEEP_SHARE * plan.target_m;
        let far = Demand {
            horizon_s: self.far_s,
            ..self.demand()
        };
        let found = if self.margin_of(&flown, now, (far.horizon_s, keep_m, keep_m)) >= keep_m {
            None
        } else {
            let variety = self.cycle / SEARCH_AGAIN;
            let (found, ..) = self.search(&Maneuver::hold(), now, &far, |search| {
                let single = search.cheapest(0.0);
                let single = single.and_then(|found| search.proven(found));
                let (found, proof) = single.or_else(|| {
                    let best = search.best(Some(&flown), Effort::WHOLE, variety);
                    best.filter(|(_, proof)| proof.is_certified())
                })?;
                Some((found, search.maneuver(&found.turns, now), proof))
            });
            found
        };
        let (found, maneuver, proof) = found?;
        Some(Plan {
            against: self.also_against(&flown, now, plan.against, far.margin_m),
            ..plan.with(&maneuver, (&found, proof), time_s)
        })
    }
}
