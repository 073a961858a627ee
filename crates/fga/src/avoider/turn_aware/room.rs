//! More room for drift than the present manoeuvre has.

use crate::avoider::{Avoider, Plan};
use crate::maneuver::Maneuver;
use crate::prediction::MotionState;
use crate::search::Proof;

use super::{SEARCH_AGAIN, TARGETS};

/// A larger margin is worth another manoeuvre if it is larger by this, metres.
const CLEARLY_MORE_M: f64 = 1.0;

impl Avoider {
    /// A manoeuvre with more of the wanted margin than the present one was found with, or the present one if it has it
    /// by now. What drift takes from a margin without room for it, nothing gives back.
    pub(super) fn roomier(&mut self, plan: &Plan, now: &MotionState, time_s: f64) -> Option<Plan> {
        if plan.target_m >= self.wanted_m - CLEARLY_MORE_M
            || !self.cycle.is_multiple_of(SEARCH_AGAIN)
        {
            return None;
        }
        let flown = plan.remaining(time_s);
        let more = self
            .targets_m()
            .filter(|target_m| *target_m > plan.target_m + CLEARLY_MORE_M);
        let mut better = None;
        let mut demand = self.demand();
        for target_m in more {
            demand.margin_m = target_m;
            let asked = (demand.horizon_s, target_m, target_m);
            if let Some(certified) = self.certified(&flown, now, asked) {
                better = Some(Plan {
                    target_m,
                    proof: Proof::Certified(certified),
                    ..*plan
                });
                break;
            }
            let (found, ..) = self.search(&Maneuver::hold(), now, &demand, |search| {
                search.share_work(TARGETS);
                let found = search.cheapest(0.0)?;
                let (found, proof) = search.proven(found)?;
                Some((found, search.maneuver(&found.turns, now), proof))
            });
            if let Some((found, maneuver, proof)) = found {
                better = Some(Plan {
                    target_m,
                    ..plan.with(&maneuver, (&found, proof), time_s)
                });
                break;
            }
        }
        better
    }
}
