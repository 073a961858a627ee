//! Whether the certificate of a manoeuvre still holds.

use crate::Vec3;
use crate::avoider::{Avoider, Plan};
use crate::prediction::MotionState;
use crate::search::Proof;
use crate::situation::Situation;

/// A manoeuvre continues while this share of the margin is certified.
pub(super) const KEEP_SHARE: f64 = 0.5;

/// The same where the manoeuvre was found with less than the wanted margin: drift takes the rest sooner.
const KEEP_SHARE_OF_LESS: f64 = 0.8;

/// Tolerance when comparing a prediction with what happened, m (velocities: a tenth of it, m/s).
const SAME_M: f64 = 1e-6;

/// The same tolerance for angles, radians.
const SAME_RAD: f64 = 1e-9;

/// A certificate is renewed after this long in any case, so that its horizon moves on, seconds.
const RENEWED_AFTER_S: f64 = 1.0;

/// The assumptions of a certificate. While they hold, as in a simulation without noise, the certificate
/// holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::avoider) struct Basis {
    /// Its time, seconds from the plan's decision.
    since_s: f64,
    own: MotionState,
    obstacles: Outlook,
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
        if plan.proof != Proof::Certified {
            return false;
        }
        let since_s = situation.time_s - plan.decided_s;
        let obstacles = self.outlook(situation.wind_mps, since_s);
        let comes_true = !self.tracks.has_aircraft()
            && plan.basis.is_some_and(|basis| {
                basis.obstacles.is(&obstacles) && self.flies_as(plan, &basis, situation, now)
            });
        if comes_true {
            return true;
        }
        let share = if plan.target_m < self.wanted_m {
            KEEP_SHARE_OF_LESS
        } else {
            KEEP_SHARE
        };
        let keep_m = share * plan.target_m;
        let remaining = plan.remaining(situation.time_s);
        let holds = self.margin_of(&remaining, now, (keep_m, keep_m)) >= keep_m;
        if let Some(plan) = self.plan.as_mut().filter(|_| holds) {
            plan.basis = Some(Basis {
                since_s,
                own: *now,
                obstacles,
            });
        }
        holds
    }

    /// Whether the aircraft has followed the plan since its certificate.
    fn flies_as(
        &self,
        plan: &Plan,
        basis: &Basis,
        situation: &Situation<'_>,
        now: &MotionState,
    ) -> bool {
        let since_s = situation.time_s - plan.decided_s;
        let passed_s = since_s - basis.since_s;
        if !(0.0..RENEWED_AFTER_S).contains(&passed_s) {
            return false;
        }
        let from = MotionState {
            time_s: basis.since_s,
            ..basis.own
        };
        let there = self.after(&from, &plan.maneuver, since_s);
        let position_m = there.position_m + situation.wind_mps * passed_s;
        let turned_rad = [
            now.course_rad - there.course_rad,
            now.climb_rad - there.climb_rad,
            now.bank_rad - there.bank_rad,
        ];
        (position_m - now.position_m).abs().max_element() < SAME_M
            && turned_rad.iter().all(|angle| angle.abs() < SAME_RAD)
    }

    fn outlook(&self, wind_mps: Vec3, since_s: f64) -> Outlook {
        let mut outlook = Outlook::default();
        // Different weights, so that two obstacles cannot compensate each other.
        let mut weight = 1.0;
        self.meter.count(self.tracks.hazards().rows().len() / 2);
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
