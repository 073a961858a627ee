//! Whether the certificate of a manoeuvre still holds.

use crate::Vec3;
use crate::avoider::{Avoider, Plan};
use crate::certificate::{Certified, keeps_on};
use crate::prediction::MotionState;
use crate::search::Proof;
use crate::situation::Situation;

use super::NEWS_M;

/// A manoeuvre continues while this share of the margin is certified.
pub(super) const KEEP_SHARE: f64 = 0.5;

/// The same where the manoeuvre was found with less than the wanted margin: drift takes the rest sooner.
const KEEP_SHARE_OF_LESS: f64 = 0.8;

/// A certificate is renewed once the aircraft may be off its prediction by more than this share of the margin before the
/// horizon; what it needs includes as much.
const SPARE_SHARE: f64 = 0.1;

/// A turn rate grows faster than the bank: at most so many times as fast below the largest bank.
const BANKS: f64 = 4.0;

/// Tolerance when comparing obstacles with how they were expected, m (velocities: a tenth of it, m/s).
const SAME_M: f64 = 1e-6;

/// A certificate is renewed after this long, so that its horizon moves on, seconds; where the straight flight at its end keeps
/// clear for as long again, after its whole horizon.
pub(super) const RENEWED_AFTER_S: f64 = 4.0;

/// An aircraft that has strayed less than this from its predictions, seconds of its flight, flies as planned.
const AS_PLANNED_S: f64 = 0.1;

/// The assumptions of a certificate. While they hold, as in a simulation without noise, the certificate
/// holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::avoider) struct Basis {
    /// When it is renewed at the latest, seconds from the plan's decision.
    pub(super) renewed_s: f64,
    /// The aircraft as predicted for the last step, its time counted from the plan's decision.
    pub(super) own: MotionState,
    obstacles: Outlook,
    /// The margin that was found, metres.
    pub(super) kept_m: f64,
    /// Margin beyond what the certificate needs, metres.
    pub(super) spare_m: f64,
    /// How far the aircraft has strayed from the predictions of all certificates since the plan's decision, metres; infinite
    /// where that is not known.
    strayed_m: f64,
}

impl Basis {
    /// Whether an aircraft of some airspeed has flown as predicted since the plan's decision.
    pub(super) fn is_as_planned(&self, airspeed_mps: f64) -> bool {
        self.strayed_m < AS_PLANNED_S * airspeed_mps
    }
}

/// The obstacles extrapolated to the plan's decision, in sums that distinguish them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Outlook {
    count: usize,
    position_m: Vec3,
    velocity_mps: Vec3,
    size_m: f64,
}

impl Outlook {
    fn is(&self, other: &Self) -> bool {
        self.count == other.count
            && (self.position_m - other.position_m).abs().max_element() < SAME_M
            && (self.velocity_mps - other.velocity_mps).abs().max_element() < 0.1 * SAME_M
            && (self.size_m - other.size_m).abs() < SAME_M
    }
}

impl Avoider {
    /// Whether the rest of a plan is still certified.
    pub(super) fn still_holds(
        &mut self,
        plan: &Plan,
        situation: &Situation<'_>,
        now: &MotionState,
    ) -> bool {
        if !plan.proof.is_certified() {
            return false;
        }
        if self.as_expected(plan, situation, now).is_some() {
            return true;
        }
        let since_s = situation.time_s - plan.decided_s;
        let strayed_m = match &plan.basis {
            Some(basis) => {
                let there = self.predicted(plan, basis, situation);
                basis.strayed_m + there.position_m.distance(now.position_m)
            }
            None if since_s < 1.5 * self.settings.decision_period_s => 0.0,
            None => f64::INFINITY,
        };
        let horizon_s = self.settings.horizon_s;
        self.predict(&plan.remaining(situation.time_s), now, horizon_s);
        let lasting = self.lasting(plan, situation, now, (strayed_m, horizon_s));
        if let Some((plan, (basis, certified))) = self.plan.as_mut().zip(lasting) {
            (plan.basis, plan.proof) = (Some(basis), Proof::Certified(certified));
        }
        lasting.is_some()
    }

    /// The assumptions with which the rest of a plan, predicted last, is certified from now on among obstacles that do not turn,
    /// and the certificate up to a horizon; since its decision the aircraft has strayed by some metres.
    pub(super) fn lasting(
        &self,
        plan: &Plan,
        situation: &Situation<'_>,
        now: &MotionState,
        (strayed_m, horizon_s): (f64, f64),
    ) -> Option<(Basis, Certified)> {
        let share = if plan.target_m < self.wanted_m {
            KEEP_SHARE_OF_LESS
        } else {
            KEEP_SHARE
        };
        let keep_m = share * plan.target_m;
        let most_m = keep_m + SPARE_SHARE * plan.target_m;
        let certified = self.prove((horizon_s, keep_m, most_m))?;
        let margin_m = certified.margin_m();
        let (hazards, ahead_s) = (self.tracks.hazards(), (horizon_s, 2.0 * horizon_s));
        (!self.tracks.has_aircraft()).then(|| {
            let lasts_s = if keeps_on(&self.path, hazards, ahead_s, margin_m, &self.meter) {
                horizon_s
            } else {
                RENEWED_AFTER_S
            };
            let basis = Basis {
                spare_m: margin_m.min(most_m) - keep_m,
                strayed_m,
                ..self.basis(plan, situation, now, (margin_m, lasts_s))
            };
            (basis, certified)
        })
    }

    /// The assumptions of a plan's margin, if aircraft and obstacles move as they were expected to when it was found.
    pub(super) fn as_expected(
        &mut self,
        plan: &Plan,
        situation: &Situation<'_>,
        now: &MotionState,
    ) -> Option<Basis> {
        let obstacles = self.outlook(situation.wind_mps, situation.time_s - plan.decided_s);
        let basis = (plan.basis)
            .filter(|basis| !self.tracks.has_aircraft() && basis.obstacles.is(&obstacles))
            .and_then(|basis| self.flies_as(plan, &basis, situation, now));
        if let Some(plan) = self.plan.as_mut().filter(|_| basis.is_some()) {
            plan.basis = basis;
        }
        basis
    }

    /// The assumptions of a margin found now, which may be off by what is news.
    pub(super) fn basis(
        &self,
        plan: &Plan,
        situation: &Situation<'_>,
        now: &MotionState,
        (kept_m, lasts_s): (f64, f64),
    ) -> Basis {
        let since_s = situation.time_s - plan.decided_s;
        Basis {
            renewed_s: since_s + lasts_s,
            own: MotionState {
                time_s: since_s,
                ..*now
            },
            obstacles: self.outlook(situation.wind_mps, since_s),
            kept_m,
            spare_m: NEWS_M,
            strayed_m: f64::INFINITY,
        }
    }

    /// The certificate's assumptions with the aircraft as predicted for now, if it has followed the plan since then.
    fn flies_as(
        &self,
        plan: &Plan,
        basis: &Basis,
        situation: &Situation<'_>,
        now: &MotionState,
    ) -> Option<Basis> {
        let since_s = situation.time_s - plan.decided_s;
        if since_s < basis.own.time_s || since_s >= basis.renewed_s {
            return None;
        }
        let there = self.predicted(plan, basis, situation);
        if self.meter.is_spent() {
            return None;
        }
        let off_m = there.position_m.distance(now.position_m);
        // A bank that is off turns the aircraft until it has gone: by less than it does at the rate of the largest bank.
        let full_rad = self.flyer.full_bank_rad().max(f64::MIN_POSITIVE);
        let banked_s = self.flyer.bank_time_constant_s() * self.flyer.course_rate_radps();
        let off_rad = (now.course_rad - there.course_rad).abs()
            + (now.climb_rad - there.climb_rad).abs()
            + BANKS * banked_s * (now.bank_rad - there.bank_rad).abs() / full_rad;
        let ahead_m = self.flyer.airspeed_mps() * self.settings.horizon_s;
        let is_spared = off_m + off_rad * ahead_m <= basis.spare_m;
        is_spared.then_some(Basis {
            own: there,
            ..*basis
        })
    }

    /// The aircraft as predicted for now.
    fn predicted(&self, plan: &Plan, basis: &Basis, situation: &Situation<'_>) -> MotionState {
        let since_s = situation.time_s - plan.decided_s;
        let passed_s = since_s - basis.own.time_s;
        let air = self.after(&basis.own, &plan.maneuver, since_s);
        MotionState {
            position_m: air.position_m + situation.wind_mps * passed_s,
            ..air
        }
    }

    fn outlook(&self, wind_mps: Vec3, since_s: f64) -> Outlook {
        let mut outlook = Outlook::default();
        // Different weights, so that two obstacles cannot compensate each other.
        let mut weight = 1.0;
        if !self.meter.take(self.tracks.hazards().rows().len() / 2) {
            return outlook;
        }
        for hazard in self.tracks.hazards().rows() {
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
