//! The turn-aware policy: look, plan, fly, return.

mod choice;
pub(super) mod detour;
mod far;
pub(super) mod holding;
mod ladder;
mod recovering;
pub(super) mod reserve;
mod threat;
mod way_back;

use crate::avoider::demand::{Demand, RUNGS, WANTED};
use crate::avoider::intruders::Freedom;
use crate::avoider::quiet::LineAhead;
use crate::avoider::{
    Against, Avoider, Candidate, Decision, Kept, Now, Places, Plan, Reason, Start, State, Threat,
    Verdict,
};
use crate::certificate::certify_set;
use crate::command::{Command, Terms};
use crate::limit::{Limit as _, whole};
use crate::maneuver::{Maneuver, Stage};
use crate::prediction::MotionState;
use crate::search::{Found, GRIDS_A_SEARCH, Outcome, Scene, Search};
use crate::situation::Situation;

use self::holding::KEEP_SHARE;

/// Work of a search over some grids among few obstacles, whatever one step may do of it, and the most of later searches. The
/// first search of an encounter, once it is close to a solution, may use all: the first turn decides which solutions later
/// searches can still reach.
const GRID_WORK: u32 = 80_000;

/// Cycles between two looks for something better than what is flown.
pub(super) const LOOK_EVERY: u32 = 10;

/// Cycles between two searches for a way back, each at one intercept angle.
const LOOK_BACK_EVERY: u32 = 2;

/// Time of the search for a way back with all of the wanted margin, seconds; as long again for half of it.
const MORE_ROOM_S: f64 = 20.0;

/// No way back during the time of this turn, unless the aircraft passes, radians.
const BEGUN_RAD: f64 = 0.8;

/// Margins are capped at this value, m.
pub(super) const ENOUGH_M: f64 = 1e3;

/// An obstacle whose entry is later than this after the first one belongs to another encounter,
/// seconds.
const NEXT_ENCOUNTER_S: f64 = 10.0;

/// What was found of a manoeuvre, which is kept in the tables, and what was asked of it.
#[derive(Clone, Copy)]
struct Answer {
    found: Found,
    outcome: Outcome,
    rung: usize,
}

impl Answer {
    fn new(search: &mut Search<'_>, (found, outcome): (Found, Outcome), rung: usize) -> Self {
        if outcome != Outcome::Proven {
            search.keep(&found.turns);
        }
        Self {
            found,
            outcome,
            rung,
        }
    }
}

impl Plan {
    /// Decided at a time, seconds, and begun then; nothing is known of it.
    fn at(time_s: f64) -> Self {
        Self {
            decided_s: time_s,
            start_s: time_s,
            joined_s: f64::INFINITY,
            outcome: Outcome::Open,
            rung: WANTED,
            margin_m: 0.0,
            cost: 0.0,
            latest_start_s: None,
            threat: None,
            threat_found_s: time_s,
            next_start_s: None,
            against: Against::default(),
        }
    }

    /// The plan with another manoeuvre, decided now.
    fn with(&self, answer: &Answer, time_s: f64) -> Self {
        Self {
            decided_s: time_s,
            start_s: self.start_s.min(time_s),
            outcome: answer.outcome,
            rung: answer.rung,
            margin_m: answer.found.margin_m,
            cost: answer.found.cost,
            next_start_s: None,
            ..*self
        }
    }

    /// How often the time of a search for a way back from it has passed.
    fn given_up(&self, time_s: f64) -> usize {
        whole((time_s - self.start_s) / MORE_ROOM_S, 4) - 1
    }
}

impl Avoider<dyn Places + '_> {
    pub(super) fn step_turn_aware(
        &mut self,
        situation: &Situation<'_>,
        now: &Now<'_>,
        mut kept: Option<&mut Kept<'_>>,
        decision: &mut Decision,
    ) {
        if self.state == State::Cruise
            && self.is_quiet(situation, now, kept.as_deref_mut(), decision)
        {
            return;
        }
        let may_begin = self.state.is_away() || self.progress.returns();
        self.load_tracks(situation, kept, may_begin);
        self.ends_before_walls(situation, now);
        self.far_s = self.far_horizon_s(now);
        (self.looked_at, self.is_cut) = (0, false);
        match self.state {
            State::Cruise | State::Threatened => self.watch(situation, now, decision),
            State::Avoiding => self.avoid(situation, now, decision),
            State::Recovering => self.come_back(situation, now, decision),
        }
        decision.record.work.candidates = self.looked_at;
        decision.record.work.limit_met |= self.is_cut || self.looked_at > 0 && self.tracks.overflow;
    }

    /// Whether this is one of the many cycles in which the leg ahead is straight and clear; then with its decision.
    #[inline(never)]
    fn is_quiet(
        &mut self,
        situation: &Situation<'_>,
        now: &Now<'_>,
        kept: Option<&mut Kept<'_>>,
        decision: &mut Decision,
    ) -> bool {
        let horizon_s = self.settings.horizon_s;
        let course = (self.progress).straight_course_rad(now, &self.flyer, horizon_s);
        let Some(course_rad) = course else {
            return false;
        };
        let line = LineAhead {
            position_m: now.position_m,
            velocity_mps: self.ours_mps,
            surveillance_radius_m: self.settings.surveillance_radius_m,
            margin_m: self.wanted_m(),
            sigmas: self.settings.confidence_sigmas,
            horizon_s,
        };
        let is_clear = match kept {
            None => line.is_clear_of(&situation.obstacles),
            Some(kept) => kept.is_clear_of(&line),
        };
        if is_clear {
            let along = Stage::turn(0.0, course_rad, now.climb_rad);
            decision.command.edit().set([along]);
            self.say(decision, Reason::Clear);
        }
        is_clear
    }

    /// On the mission: is it clear, and if not, when and where should the aircraft turn?
    #[inline(never)]
    fn watch(&mut self, situation: &Situation<'_>, now: &Now<'_>, decision: &mut Decision) {
        let time_s = situation.time_s;
        decision.record.alternative = None;
        if self.state == State::Threatened && self.still_waits(now, time_s, decision) {
            return;
        }
        self.plan = None;
        self.guide((situation, now), self.far_s, decision.command.edit());
        let (nominal, demand) = (&decision.command, self.first_demand());
        self.withstand(&|_| Freedom::Expected, (0.0, demand.margin_m));
        let Some((threat, against)) = self.first_threat(nominal, now, &demand) else {
            self.state = State::Cruise;
            return self.say(decision, Reason::Clear);
        };
        self.grids = 0;
        let is_urgent = self.settings.start == Start::AtDetection;
        // A threat that may turn or is minutes ahead is waited for: a manoeuvre planned minutes ahead takes minutes.
        let may_wait = self.tracks.has_aircraft() || threat.entry_s > self.settings.horizon_s;
        if !is_urgent && may_wait && self.has_reserve(nominal, now) {
            match self.small_now(nominal, now, &threat) {
                Some(small) => self.begin(situation, &small, (threat, against), decision),
                None => self.wait(&threat, decision),
            }
        } else {
            self.plan_anew(situation, now, (threat, against), decision);
        }
        decision.record.work.threats = 1;
    }

    /// Whether a plan that waits keeps its certificate; then the decision waits on, or begins.
    #[inline(never)]
    fn still_waits(&mut self, now: &Now<'_>, time_s: f64, decision: &mut Decision) -> bool {
        let Some(mut plan) = self.plan else {
            return false;
        };
        self.go_on(&plan, time_s, &mut decision.command);
        if self.kept_rung(&mut plan, &mut decision.command, now) != Some(plan.rung) {
            return false;
        }
        self.plan = Some(plan);
        let reason = if plan.start_s > time_s {
            Reason::WaitingForStart
        } else {
            self.state = State::Avoiding;
            Reason::ManeuverChosen
        };
        self.report(decision, &plan, time_s, reason);
        true
    }

    /// Chooses a manoeuvre and its start, in place of the command of a decision.
    #[inline(never)]
    fn plan_anew(
        &mut self,
        situation: &Situation<'_>,
        now: &Now<'_>,
        threat: (Threat, Against),
        decision: &mut Decision,
    ) {
        // What may turn is avoided once it cannot wait, between walls perhaps by two turns.
        let (start, entry_s) = match (self.tracks.has_aircraft(), self.has_room_between_walls(now))
        {
            (true, true) => (Start::Free, 0.0),
            (true, false) => (Start::AtDetection, 0.0),
            (false, _) => (self.settings.start, threat.0.entry_s),
        };
        let moments = (entry_s, self.settings.decision_period_s);
        let mut latest_s = None;
        let Decision {
            command, record, ..
        } = decision;
        let (nominal, other) = (&*command, &mut record.alternative);
        let look = &mut |search: &mut Search<'_>| {
            choice::choose(search, start, moments, (&mut latest_s, other))
        };
        let answer = (self.inside(threat.0.closest_s, now, |avoider| {
            avoider.highest([0], nominal, now, look)
        }))
        .or_else(|| self.highest(0..RUNGS, nominal, now, look));
        let Some(answer) = answer.or_else(|| self.best(None, nominal, now)) else {
            *other = None;
            return self.say(decision, Reason::BestAvailable);
        };
        self.begin(situation, &answer, threat, decision);
        if let Some(plan) = &mut self.plan {
            plan.latest_start_s = latest_s.map(|latest_s| situation.time_s + latest_s);
        }
        decision.record.latest_start_s = latest_s;
    }

    /// Begins to avoid with a manoeuvre, or waits for its start. The one before it is left in the tables.
    #[inline(never)]
    fn begin(
        &mut self,
        situation: &Situation<'_>,
        answer: &Answer,
        (threat, against): (Threat, Against),
        decision: &mut Decision,
    ) {
        let time_s = situation.time_s;
        let plan = Plan {
            start_s: time_s + answer.found.turns.wait_s,
            outcome: answer.outcome,
            margin_m: answer.found.margin_m,
            rung: answer.rung,
            cost: answer.found.cost,
            threat: Some(threat),
            against,
            ..Plan::at(time_s)
        };
        self.plan = Some(plan);
        core::mem::swap(&mut self.flown, &mut self.tables.answer);
        decision.command = self.flown;
        let (state, reason) = if answer.outcome != Outcome::Proven {
            (State::Avoiding, self.unproven())
        } else if plan.start_s > time_s {
            (State::Threatened, Reason::WaitingForStart)
        } else {
            (State::Avoiding, Reason::ManeuverChosen)
        };
        self.state = state;
        self.report(decision, &plan, time_s, reason);
    }

    /// The reason of a manoeuvre without a certificate.
    pub(super) const fn unproven(&self) -> Reason {
        if self.tracks.inside {
            Reason::InsideVolume
        } else {
            Reason::BestAvailable
        }
    }

    /// Flying the manoeuvre: returns, keeps it, or replaces it.
    #[inline(never)]
    fn avoid(&mut self, situation: &Situation<'_>, now: &Now<'_>, decision: &mut Decision) {
        let time_s = situation.time_s;
        // Between walls only a way back that keeps clear of them ends it.
        let is_bound = !self.tracks.rows().is_empty() || self.has_walls(now);
        let waits = |plan: &Plan| is_bound || plan.given_up(time_s) == 0;
        let Some(mut plan) = self.plan.filter(waits) else {
            return self.settle(situation, now, decision);
        };
        let looks = (LOOK_BACK_EVERY, f64::INFINITY);
        if self.has_begun(&plan, situation)
            && self.way_back(situation, now, &mut plan, looks, &mut decision.command)
        {
            (self.plan, self.flown) = (Some(plan), decision.command);
            self.state = State::Recovering;
            return self.report(decision, &plan, time_s, Reason::RejoinChosen);
        }
        self.go_on(&plan, time_s, &mut decision.command);
        // A share of a circle from a wall it can still turn away, unless no circle is left soon.
        let walls_s = KEEP_SHARE * self.tracks.walls_s();
        let kept = self.within_walls(walls_s, |avoider| {
            avoider.kept_rung(&mut plan, &mut decision.command, now)
        });
        let kept = kept.filter(|_| !self.is_last_circle(&decision.command, now));
        let (flown, hold) = (&decision.command, &Maneuver::HOLD);
        // Whether it withstands no turn of an aircraft: then a better one waits only while a large turn remains.
        let is_bare = self.tracks.has_aircraft() && kept.is_none_or(|rung| rung > WANTED + 1);
        let is_waiting = is_bare && self.may_go_on(flown, now);
        let is_due = is_bare || self.cycle.is_multiple_of(LOOK_EVERY);
        plan.rung = kept.unwrap_or(plan.rung);
        let passes_s = plan.threat.map_or(0.0, |threat| threat.closest_s);
        let passes_s = plan.threat_found_s + passes_s - time_s;
        // With nobody near it circles between walls until there is a way back: straight on it would fly away.
        let is_alone = is_bound && self.tracks.obstacles().next().is_none();
        let answer = match kept {
            _ if is_waiting => None,
            Some(_) if is_alone => self.circle(&plan, now),
            Some(_) => (is_due.then(|| self.better(&plan, flown, situation, now))).flatten(),
            None if is_due || self.grids < GRIDS_A_SEARCH => {
                (self.inside(passes_s, now, |avoider| {
                    let look = &mut |search: &mut Search<'_>| search.least_departure(0.0)[0];
                    avoider.highest([0, WANTED + 2], hold, now, look)
                }))
                .or_else(|| self.highest_beside(0..RUNGS, now))
                .or_else(|| self.best(Some((&mut plan, flown)), hold, now))
            }
            None => None,
        };
        if let Some(answer) = &answer {
            let margin_m = self.demand_of(answer.rung).margin_m;
            plan = plan.with(answer, time_s);
            plan.against = self.also_against(flown, now, plan.against, margin_m);
            self.flown = self.tables.answer;
            decision.command = self.flown;
        }
        let reason = match (plan.outcome == Outcome::Proven, answer) {
            _ if is_waiting => Reason::WaitingForStart,
            (true, Some(_)) => Reason::ManeuverReplaced,
            (true, None) => Reason::ManeuverKept,
            (false, _) => Reason::BestAvailable,
        };
        self.plan = Some(plan);
        self.report(decision, &plan, time_s, reason);
    }

    /// Whether a way back may end the manoeuvre: it has been flown for the time of a turn, and is not held, or all aircraft pass. Otherwise
    /// an intruder that turns back and forth would start and end it.
    fn has_begun(&self, plan: &Plan, situation: &Situation<'_>) -> bool {
        let turned_rad = (situation.time_s - plan.start_s) * self.flyer.course_rate_radps();
        let all_pass = (self.tracks).all_pass(&situation.ownship, &plan.against);
        all_pass || turned_rad >= BEGUN_RAD && !self.is_held(plan, situation.time_s)
    }

    /// Whether a certified manoeuvre is flown until the only aircraft passes, for a minute at most: where reports are uncertain, most ways
    /// back are given up again, because the aircraft turns, or noise looks like that. Among several the next one would be met meanwhile.
    fn is_held(&self, plan: &Plan, time_s: f64) -> bool {
        let is_alone = self.tracks.uncertain && self.tracks.aircraft == 1;
        is_alone && plan.outcome == Outcome::Proven && plan.given_up(time_s) < 3
    }

    /// Runs a search in the present scene with the limits of a demand; returns its result, none if it met even the reserve for
    /// finishing.
    fn search<T: Default>(
        &mut self,
        nominal: &Maneuver,
        now: &Now<'_>,
        demand: &Demand,
        look: impl FnOnce(&mut Search<'_>) -> T,
    ) -> T {
        let (mut look, mut answer) = (Some(look), T::default());
        let is_whole = self.run_search(nominal, now, demand, &mut |search| {
            if let Some(look) = look.take() {
                answer = look(search);
            }
        });
        // Else it may rest on pieces that were refused.
        if is_whole { answer } else { T::default() }
    }

    /// Runs a search; whether it may answer.
    #[inline(never)]
    fn run_search(
        &mut self,
        nominal: &Maneuver,
        now: &Now<'_>,
        demand: &Demand,
        look: &mut dyn FnMut(&mut Search<'_>),
    ) -> bool {
        self.within_limits(demand, |avoider| {
            let is_whole = avoider.plan.is_none() || !avoider.flyer.is_ideal();
            let most = if is_whole { u32::MAX } else { GRID_WORK };
            let scene = Scene {
                flyer: &avoider.flyer,
                start: now.state,
                nominal,
                original: avoider.original_rad(now),
                around: avoider.tracks.around(now.mission),
                horizon_s: demand.horizon_s,
                target_m: demand.margin_m,
                climb_limits_rad: avoider.maneuver_climbs_rad(),
                costs: (avoider.settings.heading_cost, avoider.settings.pitch_cost),
                objective: avoider.settings.objective,
            };
            let meter = avoider.meter.part(most);
            let space = (&mut avoider.path, &mut avoider.tables);
            let mut search = Search::new(&scene, space, meter);
            look(&mut search);
            avoider.looked_at += search.evaluated;
            avoider.meter.count(search.work() as usize);
            avoider.grids = avoider.grids.saturating_add(search.grids);
            avoider.is_cut |= search.limit_met();
            !search.is_spent()
        })
    }

    /// Course and climb angle of the mission, radians.
    #[inline(never)]
    fn original_rad(&self, now: &MotionState) -> (f64, f64) {
        let leg = self.progress.leg(now);
        let (low, high) = self.climb_limits_rad();
        let course_rad = now.course_rad + leg.turn_onto_rad(now);
        (course_rad, leg.climb_rad.limited(low, high))
    }

    /// Margin of a manoeuvre up to a horizon, between `floor_m`, below which it stops, and `enough_m`.
    pub(super) fn margin_of(
        &mut self,
        maneuver: &Maneuver,
        now: &Now<'_>,
        asked: (f64, f64, f64),
    ) -> f64 {
        self.predict(maneuver, now, asked.0);
        let around = self.tracks.around(now.mission);
        certify_set(&self.flyer, &self.path, &around, asked, &self.meter).proven_m()
    }

    /// Proves that a command keeps a target up to a horizon, if it does; its margin is capped.
    pub(super) fn prove(
        &mut self,
        command: &mut Command,
        now: &Now<'_>,
        asked: (f64, f64, f64),
    ) -> bool {
        self.prove_from(command, now, asked, false)
    }

    /// The same, from zones and ground alone where those are asked for.
    fn prove_from(
        &mut self,
        command: &mut Command,
        now: &Now<'_>,
        (horizon_s, target_m, enough_m): (f64, f64, f64),
        is_of_walls: bool,
    ) -> bool {
        let mut around = self.tracks.around(now.mission);
        if is_of_walls {
            around.rows = &[];
        }
        let flight = (&*self.flyer, &mut self.path);
        Terms::new(horizon_s, target_m, enough_m).is_some_and(|terms| {
            let proof = command.prove(flight, now, &around, &terms, &self.meter);
            proof.is_ok()
        })
    }

    /// Records why the command of a decision is flown: it is the rest of a plan.
    fn report(&self, decision: &mut Decision, plan: &Plan, time_s: f64, reason: Reason) {
        let elapsed_s = time_s - plan.threat_found_s;
        self.say(decision, reason);
        let demand = self.demand_of(plan.rung);
        let record = &mut decision.record;
        record.threat = plan.threat.and_then(|threat| threat.later(elapsed_s));
        record.in_need = demand.in_need;
        record.straight_aircraft = self.tracks.straight_aircraft(demand.share, &self.meter);
        let is_proven = decision.command.proof().is_some();
        let is_shown = self.state == State::Avoiding && decision.command.certified().is_some();
        let is_all = self.tracks.has_aircraft() && record.straight_aircraft == 0;
        record.resilience = (is_shown && is_all).then_some(demand.share);
        record.start_s = Some(plan.start_s - time_s);
        record.latest_start_s = plan.latest_start_s.map(|latest_s| latest_s - time_s);
        record.chosen = Some(Candidate {
            margin_m: plan.margin_m,
            cost: plan.cost,
            verdict: if is_proven {
                Verdict::Chosen
            } else {
                Verdict::Rejected
            },
        });
    }
}

#[cfg(test)]
mod tests;
