//! Whether the certificate of a manoeuvre still holds.

use crate::Vec3;
use crate::avoider::demand::{Demand, RUNGS, WANTED};
use crate::avoider::{Avoider, Basis, Now, Outlook, Places, Plan};
use crate::certificate::Certified;
use crate::prediction::MotionState;
use crate::search::Proof;
use crate::situation::Situation;

/// A manoeuvre continues while this share of the margin is certified.
pub(super) const KEEP_SHARE: f64 = 0.5;

/// A certificate is renewed once the aircraft may be off its prediction by more than this share of the margin before the
/// horizon; what it needs includes as much.
const SPARE_SHARE: f64 = 0.1;

/// A turn rate grows faster than the bank: at most so many times as fast below the largest bank.
const BANKS: f64 = 4.0;

/// A certificate is renewed after this long, so that its horizon moves on, seconds.
const RENEWED_AFTER_S: f64 = 4.0;

impl Avoider<dyn Places + '_> {
    /// The highest rung whose demand the rest of a plan keeps, with its certificate in the plan; the longer horizon only where
    /// it was planned for it.
    pub(super) fn kept_rung(
        &mut self,
        plan: &mut Plan,
        situation: &Situation<'_>,
        now: &Now<'_>,
    ) -> Option<usize> {
        let was_certified = plan.proof.is_certified();
        if was_certified
            && let Some(basis) = self.within_limits(&self.demand_of(plan.rung), |avoider| {
                avoider.as_expected(plan, situation, now)
            })
        {
            plan.basis = Some(basis);
            return Some(plan.rung);
        }
        (plan.basis, plan.proof) = (None, Proof::Open);
        let outlook = self.outlook(situation.wind_mps, situation.time_s - plan.decided_s);
        if was_certified || !self.tracks.inside && !plan.outlook.is(&outlook) {
            // Searches that found nothing may find something now. A volume around the aircraft shrinks with its depth.
            self.grids = 0;
        }
        plan.outlook = outlook;
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
            let held = self.within_limits(&demand, |avoider| {
                let rest = avoider.remaining(plan, situation.time_s);
                avoider.predict(&rest, now, demand.horizon_s);
                avoider.lasting(plan, situation, now, &demand)
            });
            if let Some((basis, certified)) = held {
                (plan.basis, plan.proof) = (basis, Proof::Certified(certified));
                return Some(rung);
            }
        }
        None
    }

    /// The certificate of the rest of a plan, predicted last, by which it is kept, and its assumptions among obstacles that do
    /// not turn.
    pub(super) fn lasting(
        &self,
        plan: &Plan,
        situation: &Situation<'_>,
        now: &Now<'_>,
        demand: &Demand,
    ) -> Option<(Option<Basis>, Certified)> {
        let keep_m = KEEP_SHARE * demand.margin_m;
        let most_m = keep_m + SPARE_SHARE * demand.margin_m;
        let certified = self.prove(now, (demand.horizon_s, keep_m, most_m))?;
        let since_s = situation.time_s - plan.decided_s;
        let basis = (!self.tracks.has_aircraft()).then(|| Basis {
            renewed_s: since_s + RENEWED_AFTER_S,
            own: MotionState {
                time_s: since_s,
                ..now.state
            },
            spare_m: certified.margin_m().min(most_m) - keep_m,
        });
        Some((basis, certified))
    }

    /// The assumptions of a plan's certificate, if aircraft and obstacles move as they were expected to.
    fn as_expected(&self, plan: &Plan, situation: &Situation<'_>, now: &Now<'_>) -> Option<Basis> {
        let basis = plan.basis.filter(|_| !self.tracks.has_aircraft())?;
        let since_s = situation.time_s - plan.decided_s;
        let obstacles = self.outlook(situation.wind_mps, since_s);
        let passed_s = since_s - basis.own.time_s;
        if !plan.outlook.is(&obstacles) || passed_s < 0.0 || since_s >= basis.renewed_s {
            return None;
        }
        let mut own = self.after(&basis.own, &self.flown, since_s);
        own.position_m += situation.wind_mps * passed_s;
        if self.meter.is_spent() {
            return None;
        }
        let off_m = own.position_m.distance(now.position_m);
        // A bank that is off turns the aircraft until it has gone: by less than it does at the rate of the largest bank.
        let full_rad = self.flyer.full_bank_rad().max(f64::MIN_POSITIVE);
        let banked_s = self.flyer.bank_time_constant_s() * self.flyer.course_rate_radps();
        let off_rad = (now.course_rad - own.course_rad).abs()
            + (now.climb_rad - own.climb_rad).abs()
            + BANKS * banked_s * (now.bank_rad - own.bank_rad).abs() / full_rad;
        let ahead_m = self.flyer.airspeed_mps() * self.settings.horizon_s;
        (off_m + off_rad * ahead_m <= basis.spare_m).then_some(Basis { own, ..basis })
    }

    pub(super) fn outlook(&self, wind_mps: Vec3, since_s: f64) -> Outlook {
        let mut outlook = Outlook::default();
        // Different weights, so that two obstacles cannot compensate each other.
        let mut weight = 1.0;
        if !self.meter.take(self.tracks.rows().len() / 2) {
            return outlook;
        }
        for hazard in self.tracks.rows() {
            let ground_mps = hazard.velocity_mps + wind_mps;
            outlook.count += 1;
            outlook.position_m += (hazard.position_m - ground_mps * since_s) * weight;
            outlook.velocity_mps += hazard.velocity_mps * weight;
            let volume = &hazard.volume;
            outlook.size_m += (volume.radius_m() + 1.7 * volume.half_height_m()) * weight;
            outlook.size_m += 1e3 * hazard.growth_mps * weight;
            outlook.size_m += hazard.allowed_depth_m.max(0.0) * weight;
            weight += 0.618;
        }
        outlook
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
            let kept = avoider.kept_rung(&mut plan, situation, now);
            assert_eq!(plan.proof.is_certified(), kept.is_some());
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
