//! Whether the certificate of a manoeuvre still holds.

use crate::avoider::demand::{RUNGS, WANTED};
use crate::avoider::{Avoider, Now, Places, Plan};
use crate::command::Command;
use crate::search::Outcome;

/// A manoeuvre continues while this share of the margin is certified, over at least this share of the horizon ...
pub(in crate::avoider) const KEEP_SHARE: f64 = 0.5;

/// ... and over all of it but this, seconds: the time between two looks for something better at ten decisions a second.
const KEEP_SHORTER_S: f64 = 1.0;

impl Avoider<dyn Places + '_> {
    /// The highest rung whose demand the rest of the manoeuvre of a plan keeps, with a new certificate in the plan; the longer horizon only where
    /// it was planned for it.
    pub(super) fn kept_rung(
        &mut self,
        plan: &mut Plan,
        rest: &mut Command,
        now: &Now<'_>,
    ) -> Option<usize> {
        if plan.outcome == Outcome::Proven || self.tracks.changed {
            // Searches that found nothing may find something now.
            self.grids = 0;
        }
        plan.outcome = Outcome::Open;
        let highest = plan.rung.min(WANTED);
        for rung in highest..RUNGS {
            if rung > highest && self.distinct_demand(rung).is_none() {
                continue;
            }
            if self.meter.is_met() {
                return None;
            }
            let demand = self.demand_of(rung);
            self.ask(&demand, 0.0);
            let asked = (
                (demand.horizon_s - KEEP_SHORTER_S).max(KEEP_SHARE * demand.horizon_s),
                KEEP_SHARE * demand.margin_m,
                demand.margin_m,
            );
            if self.within_limits(&demand, |avoider| avoider.prove(rest, now, asked)) {
                plan.outcome = Outcome::Proven;
                return Some(rung);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{RADIUS_M, among, plan, sphere};
    use super::*;

    /// The rung that a straight flight keeps, planned on the second one, past a sphere that it clears by some metres; 9 m are
    /// kept for drift.
    fn kept(clears_m: f64) -> Option<usize> {
        let row = sphere(1, (150.0, RADIUS_M + clears_m), (0.0, 0.0));
        among(&[row], |avoider, situation, now| {
            avoider.drift_m = 9.0;
            let mut plan = plan(avoider, situation, (0.0, WANTED));
            let mut rest = avoider.flown;
            let kept = avoider.kept_rung(&mut plan, &mut rest, now);
            assert_eq!(rest.proof().is_some(), kept.is_some());
            kept
        })
    }

    /// Half of 9.05, 4.55 and 0.05 m.
    #[test]
    fn a_plan_falls_to_the_highest_rung_of_which_it_keeps_half_of_the_margin() {
        assert_eq!(kept(4.6), Some(WANTED));
        assert_eq!(kept(4.4), Some(WANTED + 1));
        assert_eq!(kept(2.4), Some(WANTED + 1));
        assert_eq!(kept(2.2), Some(WANTED + 2));
        assert_eq!(kept(0.1), Some(WANTED + 2));
        assert_eq!(kept(-0.1), None);
    }
}
