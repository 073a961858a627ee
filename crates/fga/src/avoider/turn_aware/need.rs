//! Limits in need, for instance a steeper bank, if nothing is certified with the normal ones.

use crate::avoider::{Avoider, Decision, Kept, Start};
use crate::prediction::MotionState;
use crate::situation::Situation;

use super::ENOUGH_M;

/// Without a certificate, the limits in need must keep this much more, metres.
const CLEARLY_MORE_M: f64 = 1.0;

/// Parts of a step's work: one for the normal limits.
const HALVES: u32 = 2;

impl Avoider {
    /// Decides with the normal limits and half of the step's work; if that certifies nothing, also with the
    /// limits in need, which apply if they certify something or keep clearly more.
    pub(in crate::avoider) fn decide_with(
        &mut self,
        situation: &Situation<'_>,
        kept: Option<&mut Kept<'_>>,
    ) -> Decision {
        let before = (self.plan, self.state, self.returned);
        self.meter.reserve(HALVES);
        let normal = self.decide(situation, kept);
        self.meter.extend(HALVES);
        if !normal.record.reason.is_unproven() {
            return normal;
        }
        let now = MotionState::of(&situation.ownship);
        let normal_m = self.expected_m(&normal, &now);
        let after = (self.plan, self.state, self.returned);
        (self.plan, self.state, self.returned) = before;
        self.change_limits();
        self.tracks.as_expected();
        let mut steep = self.decide_among_tracks(situation, &now, Start::AtDetection);
        let steep_m = self.expected_m(&steep, &now);
        self.change_limits();
        if steep.record.reason.is_unproven() && steep_m <= normal_m + CLEARLY_MORE_M {
            (self.plan, self.state, self.returned) = after;
            return normal;
        }
        steep.record.in_need = true;
        steep
    }

    /// Takes the limits in need in place of the normal ones, or back again.
    const fn change_limits(&mut self) {
        if let Some((vehicle, flyer)) = &mut self.in_need {
            core::mem::swap(vehicle, &mut self.vehicle);
            core::mem::swap(flyer, &mut self.flyer);
        }
    }

    /// The margin that a decision keeps from the expected motion of the obstacles, by depth, metres.
    fn expected_m(&mut self, decision: &Decision, now: &MotionState) -> f64 {
        self.by_depth(now);
        let asked = (self.settings.horizon_s, f64::MIN, ENOUGH_M);
        self.margin_of(&decision.command, now, asked)
    }
}
