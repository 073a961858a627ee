//! On the way back: it is kept, replaced by one that joins the mission sooner, or leads to the next encounter.
//!
//! A way back is a list of turns at planned moments. An aircraft that flies faster than planned meets the mission before the last
//! turn and flies past it; and the first way that is certified is often shallow, because the obstacle is still near. So another
//! look begins where the aircraft has come to.

use crate::avoider::intruders::Freedom;
use crate::avoider::{Avoider, Decision, Now, Places, Plan, Reason, State};
use crate::command::Command;
use crate::maneuver::{Maneuver, Stage};
use crate::situation::Situation;

use super::LOOK_EVERY;
use super::holding::KEEP_SHARE;

/// Parts of a step's work: one for the manoeuvre that is known.
const HALVES: u32 = 2;

/// Another way back joins the mission sooner than this one by this, seconds.
const SOONER_S: f64 = 0.5;

impl Avoider<dyn Places + '_> {
    /// Sets a command to the guidance along the mission up to a horizon, and returns the moment from which it is straight, seconds. Once a
    /// manoeuvre has led off the mission it stays between the limits of altitude.
    pub(in crate::avoider) fn guide(
        &mut self,
        (situation, now): (&Situation<'_>, &Now<'_>),
        horizon_s: f64,
        command: &mut Maneuver,
    ) -> f64 {
        let straight_s = self.on_mission(situation, |progress, route| {
            progress.guidance(route, now, horizon_s, command)
        });
        if self.has_avoided {
            command.limit_climbs(self.level_rad.0, self.level_rad.1);
        }
        straight_s
    }

    /// Whether a way back is kept: it is clear of the expected motion, or a manoeuvre that begins later still suffices.
    fn keeps_back(&mut self, plan: &mut Plan, back: &mut Command, now: &Now<'_>) -> bool {
        self.prove_back(plan, back, now)
            || self.tracks.has_aircraft() && self.has_reserve(back, now)
    }

    /// Proves that a way back is clear of the expected motion, if it is.
    fn prove_back(&mut self, plan: &mut Plan, back: &mut Command, now: &Now<'_>) -> bool {
        // What avoids the next encounter is a manoeuvre like any other.
        let left_s = match plan.next_start_s {
            Some(_) => self.tracks.walls_s(),
            None => plan.joined_s - self.last_time_s,
        };
        if !self.tracks.has_aircraft() {
            let rung = self.within_walls(left_s, |avoider| avoider.kept_rung(plan, back, now));
            return rung == Some(plan.rung);
        }
        let keep_m = KEEP_SHARE * self.demand_of(plan.rung).margin_m;
        self.withstand(&|_| Freedom::Expected, (0.0, self.wanted_m()));
        let asked = (self.settings.horizon_s, keep_m, keep_m);
        self.within_walls(left_s, |avoider| avoider.prove(back, now, asked))
    }

    /// On the way back.
    #[inline(never)]
    pub(super) fn come_back(
        &mut self,
        situation: &Situation<'_>,
        now: &Now<'_>,
        decision: &mut Decision,
    ) {
        let time_s = situation.time_s;
        if let Some(plan) = &self.plan {
            if let Some(start_s) = plan.next_start_s.filter(|start_s| time_s >= *start_s) {
                return self.meet_next(start_s, (situation, now), decision);
            }
            // Beyond the mission's end there is nothing to return to.
            let is_back = time_s >= plan.joined_s || self.progress.is_complete();
            if !is_back && self.flies_back(situation, now, decision) {
                return;
            }
            // Off the mission between walls only another way back is known to be clear of them.
            if !is_back && self.has_walls(now) {
                self.state = State::Avoiding;
                return self.avoid(situation, now, decision);
            }
        }
        self.settle(situation, now, decision);
    }

    /// Takes level flight straight on as the manoeuvre that is flown: the search goes on from it.
    fn hold_on(&mut self, now: &Now<'_>, time_s: f64) {
        let straight_on = Stage::turn(0.0, now.course_rad, 0.0);
        self.flown.edit().set([straight_on]);
        self.state = State::Avoiding;
        self.plan = Some(Plan::at(time_s));
    }

    /// Without a planned way back: follows the guidance along the mission, on the way back until the aircraft is on its leg by position
    /// and course, whatever was planned, while that is clear of zones and ground.
    #[inline(never)]
    pub(super) fn settle(
        &mut self,
        situation: &Situation<'_>,
        now: &Now<'_>,
        decision: &mut Decision,
    ) {
        self.plan = None;
        self.state = State::Cruise;
        self.watch(situation, now, decision);
        if decision.record.reason == Reason::Clear {
            decision.record.reason = Reason::Rejoined;
            if !self.progress.is_back(now, self.can_climb()) {
                if self.has_walls(now) && !self.joins_before_walls(&decision.command, now) {
                    self.hold_on(now, situation.time_s);
                    return self.avoid(situation, now, decision);
                }
                self.state = State::Recovering;
                (decision.state, decision.record.reason) = (self.state, Reason::RejoinKept);
            }
        }
    }

    /// Whether it flies the way back on, or a sooner one; then the decision to do so.
    #[inline(never)]
    fn flies_back(
        &mut self,
        situation: &Situation<'_>,
        now: &Now<'_>,
        decision: &mut Decision,
    ) -> bool {
        let Some(mut plan) = self.plan else {
            return false;
        };
        let back = &mut decision.command;
        self.go_on(&plan, situation.time_s, back);
        if !self.keeps_back(&mut plan, back, now) {
            return false;
        }
        let is_proven = back.proof().is_some();
        let mut reason = Reason::RejoinKept;
        if self.sooner_back(situation, now, &mut plan, back) {
            self.flown = *back;
            reason = Reason::RejoinChosen;
        } else if is_proven && back.proof().is_none() {
            // The look for a sooner one took its place.
            self.prove_back(&mut plan, back, now);
        }
        self.plan = Some(plan);
        self.report(decision, &plan, situation.time_s, reason);
        true
    }

    /// Meets the next encounter with a new manoeuvre. Where the new one is not certified, or the way back avoided the same obstacle,
    /// the manoeuvre of the way back is flown.
    #[inline(never)]
    fn meet_next(
        &mut self,
        start_s: f64,
        (situation, now): (&Situation<'_>, &Now<'_>),
        decision: &mut Decision,
    ) {
        let Some(plan) = self.plan else {
            return;
        };
        let came = self.returned.as_ref().zip(plan.threat);
        let is_again = came.is_some_and(|(came, threat)| came.against.contains(threat.id));
        if !is_again {
            self.meter.reserve(HALVES);
            self.settle(situation, now, decision);
            self.meter.extend(HALVES);
            if !decision.record.reason.is_unproven() {
                return;
            }
            if self.plan.is_some() {
                core::mem::swap(&mut self.flown, &mut self.tables.answer);
            }
        }
        self.plan = Some(Plan {
            start_s,
            next_start_s: None,
            ..plan
        });
        self.state = State::Threatened;
        self.watch(situation, now, decision);
    }

    /// Changes a plan to a certified way back that joins the mission sooner than this one, if there is one now.
    fn sooner_back(
        &mut self,
        situation: &Situation<'_>,
        now: &Now<'_>,
        plan: &mut Plan,
        back: &mut Command,
    ) -> bool {
        let left_s = plan.joined_s - situation.time_s;
        if plan.next_start_s.is_some() || left_s < SOONER_S {
            return false;
        }
        let looks = (LOOK_EVERY / 2, plan.joined_s - SOONER_S);
        self.way_back(situation, now, plan, looks, back)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{aircraft, among, plan};
    use crate::avoider::demand::WANTED;
    use crate::situation::Obstacle;

    /// Among aircraft a way back is kept where it is clear of what is expected, or a turn still suffices.
    #[test]
    fn a_way_back_is_kept_while_it_is_clear_or_a_turn_remains() {
        let keeps = |row: Obstacle| {
            among(&[row], |avoider, situation, now| {
                let mut plan = plan(avoider, situation, (0.0, WANTED));
                let mut back = avoider.flown;
                avoider.keeps_back(&mut plan, &mut back, now)
            })
        };
        assert!(keeps(aircraft(1, (150.0, 60.0), (-20.0, 0.0))));
        assert!(keeps(aircraft(1, (900.0, 0.0), (-20.0, 0.0))));
        assert!(!keeps(aircraft(1, (150.0, 0.0), (-20.0, 0.0))));
    }
}
