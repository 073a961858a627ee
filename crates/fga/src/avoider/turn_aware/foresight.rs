//! Which of the next decisions are known before they are made: a manoeuvre is flown on while nothing new can be seen and
//! nothing is looked for again.

use crate::avoider::{Avoider, Plan, State};
use crate::maneuver::Maneuver;
use crate::prediction::MotionState;
use crate::situation::Situation;

use super::holding::Basis;
use super::sooner::LOOK_EVERY;
use super::way_back::LOOK_BACK_EVERY;

/// Most decisions that are known.
const MOST: u32 = 40;

/// A certificate with less to spare may have to be made again because of rounding, metres.
const LEAST_SPARE_M: f64 = 1e-4;

/// Rounding of times, seconds: what may happen at a moment counts from this much before it.
const ROUNDING_S: f64 = 1e-6;

impl Avoider {
    /// How many of the decisions after the last one fly on the same manoeuvre, if the aircraft flies as commanded and the
    /// obstacles of its situation, and no others, move on as they do.
    pub(crate) fn known_decisions(&self, situation: &Situation<'_>) -> u32 {
        let Some(plan) = &self.plan else { return 0 };
        let Some(basis) = &plan.basis else { return 0 };
        let tracks = &self.tracks;
        let is_exact = plan.proof.is_certified()
            && !tracks.uncertain
            && !tracks.inside
            && !tracks.has_aircraft()
            && self.in_need.is_none()
            && basis.spare_m > LEAST_SPARE_M
            && (plan.decided_s + basis.own.time_s - self.last_time_s).abs() < ROUNDING_S;
        let is_all = situation.obstacles.len() == tracks.obstacle_count();
        if !(is_exact && is_all) {
            return 0;
        }
        let until_s = self.alike_until_s(situation);
        let now = MotionState::of(&situation.ownship);
        let may_come_sooner = self.may_come_sooner(plan, self.last_time_s, &now);
        let known = |later: &u32| {
            let time_s = self.last_time_s + f64::from(*later) * self.settings.decision_period_s;
            time_s + ROUNDING_S < until_s
                && !self.decides(plan, basis, (*later, time_s), may_come_sooner)
        };
        (1..=MOST).take_while(known).last().unwrap_or(0)
    }

    /// The command of the next decision, which is known, at a time on the situation's clock: the manoeuvre and its age, seconds.
    pub(crate) fn known_command(&mut self, time_s: f64) -> Option<(&Maneuver, f64)> {
        let plan = self.plan.as_ref()?;
        self.cycle = self.cycle.wrapping_add(1);
        let flown_s = time_s + self.set_back_s - plan.decided_s;
        Some((&plan.maneuver, flown_s))
    }

    /// Until when every obstacle surely stays within the surveillance radius and the aircraft on its leg, seconds.
    fn alike_until_s(&self, situation: &Situation<'_>) -> f64 {
        let own = &situation.ownship;
        let ours_mps = own.airspeed_mps + situation.wind_mps.length();
        let leg_s = self.progress.leaves_after_m(own.position_m) / ours_mps;
        let radius_m = self.settings.surveillance_radius_m;
        let stays_s = situation.obstacles.iter().map(|obstacle| {
            let distance_m = obstacle.position_m.distance(own.position_m);
            (radius_m - distance_m) / (ours_mps + obstacle.velocity_mps.length())
        });
        self.last_time_s + stays_s.fold(leg_s, f64::min)
    }

    /// Whether a decision some cycles later, at a time on the avoider's clock, may look for something else.
    fn decides(
        &self,
        plan: &Plan,
        basis: &Basis,
        (later, time_s): (u32, f64),
        may_come_sooner: bool,
    ) -> bool {
        let cycle = self.cycle.wrapping_add(later);
        let is_over = |moment_s: f64| time_s + ROUNDING_S >= moment_s;
        if is_over(plan.decided_s + basis.renewed_s) {
            return true;
        }
        match self.state {
            State::Cruise => true,
            State::Threatened => is_over(plan.start_s),
            State::Avoiding => cycle.is_multiple_of(LOOK_BACK_EVERY),
            State::Recovering => {
                (cycle.is_multiple_of(LOOK_EVERY) && may_come_sooner)
                    || is_over(plan.joined_s)
                    || plan.next_start_s.is_some_and(is_over)
            }
        }
    }
}
