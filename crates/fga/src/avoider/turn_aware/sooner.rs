//! On the way back: another way that joins the mission sooner.
//!
//! A way back is a list of turns at planned moments. An aircraft that flies faster than planned meets the mission before the last
//! turn and flies past it; and the first way that is certified is often shallow, because the obstacle is still near.

use crate::angle::wrap_pi;
use crate::avoider::{Avoider, Plan};
use crate::prediction::MotionState;
use crate::situation::Situation;

/// Cycles between two looks for another way back.
pub(super) const LOOK_EVERY: u32 = 10;

/// Another way back joins the mission sooner by this, seconds.
const SOONER_S: f64 = 5.0;

/// The same way back, looked for from the present state, joins the mission sooner than planned by this, seconds: the aircraft is
/// faster than planned.
const EARLY_S: f64 = 0.5;

/// Ways back with courses within this are the same, radians.
const SAME_RAD: f64 = 0.05;

impl Avoider {
    /// A certified way back that joins the mission sooner than this one, if there is one now.
    pub(super) fn sooner_back(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        plan: &Plan,
    ) -> Option<Plan> {
        let time_s = situation.time_s;
        if !self.cycle.is_multiple_of(LOOK_EVERY) || !self.may_come_sooner(plan, time_s, now) {
            return None;
        }
        let before = (self.progress, self.returned);
        let back = self.way_back(situation, now, plan, plan.joined_s - EARLY_S)?;
        let course_rad = |plan: &Plan| {
            let flown = plan.remaining(time_s);
            flown.stages().first().map(|stage| stage.course_rad)
        };
        let same = course_rad(plan)
            .zip(course_rad(&back))
            .is_some_and(|(flown, other)| wrap_pi(flown - other).abs() < SAME_RAD);
        let sooner_s = if same { EARLY_S } else { SOONER_S };
        if back.next_start_s.is_none() && back.joined_s < plan.joined_s - sooner_s {
            return Some(back);
        }
        (self.progress, self.returned) = before;
        None
    }

    /// Whether another way back may join the mission clearly sooner. Once it cannot, it never can while the aircraft flies as
    /// planned: the time left falls as fast as time passes, and what the shortest way onto the leg takes no faster.
    pub(super) fn may_come_sooner(&self, plan: &Plan, time_s: f64, now: &MotionState) -> bool {
        let left_s = plan.joined_s - time_s;
        if left_s < EARLY_S || plan.next_start_s.is_some() {
            return false;
        }
        let airspeed_mps = self.flyer.airspeed_mps();
        let basis = self.plan.as_ref().and_then(|plan| plan.basis);
        let is_as_planned = basis.is_some_and(|basis| basis.is_as_planned(airspeed_mps));
        let least_s = self.progress.least_s_onto_leg(now, &self.flyer);
        !is_as_planned || left_s - least_s >= SOONER_S
    }
}
