//! Decisions about aircraft: manoeuvres start as late as is robust, and continue while they withstand the
//! possible next motions of an aircraft.
//!
//! A manoeuvre *withstands* a share of the bounds of aircraft when it is certified against the expected
//! motion, turns of that share of the bounds to either side, and changes of climb of that share. Its
//! **resilience** is the largest share of [`SHARES`] that it withstands.

use crate::Vec3;
use crate::angle::Side;
use crate::avoider::demand::Demand;
use crate::avoider::intruders::{Clearance, Freedom};
use crate::avoider::{Against, Avoider, Decision, Plan, Reason, Start, State, Threat};
use crate::certificate::{Certified, Hazard};
use crate::limit::Limit as _;
use crate::maneuver::Maneuver;
use crate::prediction::MotionState;
use crate::search::{Effort, Found, Proof, Search};
use crate::situation::Situation;

use super::small::is_small;
use super::{ENOUGH_M, as_maneuver};

/// Candidate shares of the bounds, largest first.
const SHARES: [f64; 5] = [1.0, 0.75, 0.5, 0.25, 0.0];

/// Searches aim for this share: the aircraft may turn by half of its bounds, and change its climb by half of
/// them.
pub(super) const WANTED_SHARE: f64 = 0.5;

/// The aircraft stays on the mission while a manoeuvre that begins this much later still withstands everything,
/// seconds.
pub(super) const WAIT_S: f64 = 2.0;

/// Only manoeuvres with at most this turn are a reason to wait, radians (74.5°).
pub(super) const WAIT_FOR_TURN_RAD: f64 = 1.3;

/// A manoeuvre that withstands less than everything is replaced by one that withstands more by
/// this share.
const CLEARLY_MORE: f64 = 0.45;

/// Choosing a manoeuvre takes this much more distance beyond the volumes of aircraft than keeping it, metres:
/// the error of their vertical speed (0.2 m/s), over a quarter of a minute.
const BEYOND_M: f64 = 3.0;

/// Cycles between two searches for a larger margin if nothing withstands much.
const LOOK_FOR_MORE: u32 = 5;

/// The largest margin in the worst case must exceed the present one by this, metres.
const CLEARLY_FARTHER_M: f64 = 20.0;

/// The same against the expected motion, metres.
const EXPECTED_FARTHER_M: f64 = 5.0;

/// The same if the present one does not stay clear of the expected motion, metres.
const FARTHER_M: f64 = 2.0;

/// A way back withstands all motions of aircraft for this long, seconds: a turn of 60° at the standard
/// rate takes as long.
const BACK_WITHSTANDS_S: f64 = 20.0;

/// Cycles between two searches for a smaller departure.
const LOOK_FOR_LESS: u32 = 10;

/// A course that departs less by this replaces the present one, radians (15°).
const CLEARLY_LESS_RAD: f64 = 0.26;

/// No way back during the time of this turn, unless the aircraft passes, radians: otherwise an intruder
/// that turns back and forth would start and end the manoeuvre.
const BEGUN_RAD: f64 = 0.8;

/// Part of a step's work for one search.
const SEARCHES: u32 = 8;

impl Avoider {
    /// On the mission among aircraft: is the expected motion clear, and if not, does a manoeuvre that
    /// begins later still suffice?
    pub(super) fn watch_aircraft(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        start: Start,
    ) -> Decision {
        let own_m = now.position_m;
        self.plan = None;
        let (nominal, _) = self.guidance(situation, now);
        let demand = self.demand();
        self.withstand(Freedom::Expected, own_m, (0.0, demand.margin_m));
        let Some((threat, against)) = self.first_threat(&nominal, now, &demand) else {
            self.state = State::Cruise;
            return self.decision(&nominal, Reason::Clear);
        };
        let (may_wait, mut candidates, limit_met) = if start == Start::AtDetection {
            (false, 0, false)
        } else {
            self.may_wait(&nominal, now, WAIT_FOR_TURN_RAD, &demand)
        };
        let small = if may_wait {
            let (small, looked_at) = self.small_now(&nominal, now, &threat);
            candidates += looked_at;
            small
        } else {
            None
        };
        let mut decision = if let Some(small) = small {
            self.begin(situation, &small, (threat, against))
        } else if may_wait {
            self.state = State::Threatened;
            let mut decision = self.decision(&nominal, Reason::WaitingForStart);
            decision.record.threat = Some(threat);
            decision.record.start_s = Some(WAIT_S);
            decision
        } else {
            self.begin_most_resilient(situation, now, (threat, against))
        };
        let work = &mut decision.record.work;
        work.candidates += candidates;
        work.limit_met |= limit_met || self.tracks.overflow;
        work.threats = 1;
        decision
    }

    /// Whether a manoeuvre with at most this turn that begins later, along a path, still withstands everything; how many
    /// manoeuvres were looked at, and whether the work ran out.
    pub(super) fn may_wait(
        &mut self,
        along: &Maneuver,
        now: &MotionState,
        most_turn_rad: f64,
        demand: &Demand,
    ) -> (bool, u32, bool) {
        let clearance_m = (BEYOND_M, demand.margin_m);
        self.withstand(Freedom::Share(WANTED_SHARE), now.position_m, clearance_m);
        self.search(along, now, demand, |search| {
            search.share_work(SEARCHES);
            search.is_avoidable_within(WAIT_S, most_turn_rad)
        })
    }

    /// Begins to avoid with the manoeuvre that withstands most.
    fn begin_most_resilient(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        threat: (Threat, Against),
    ) -> Decision {
        let (mut answer, mut candidates) =
            self.cheapest_within(now, None, (0.0, WANTED_SHARE), self.demand());
        if answer.is_none() {
            let (found, looked_at) = self.farthest(now, None, None);
            answer = found;
            candidates += looked_at;
        }
        let Some(answer) = answer else {
            return self.decision(&Maneuver::hold(), Reason::BestAvailable);
        };
        let mut decision = self.begin(situation, &answer, threat);
        decision.record.work.candidates = candidates;
        decision
    }

    /// Begins to avoid with a manoeuvre.
    fn begin(
        &mut self,
        situation: &Situation<'_>,
        answer: &Answer,
        (threat, against): (Threat, Against),
    ) -> Decision {
        let time_s = situation.time_s;
        let plan = Plan {
            maneuver: answer.maneuver,
            decided_s: time_s,
            start_s: time_s,
            joined_s: f64::INFINITY,
            proof: answer.proof,
            picture: self.tracks.picture(),
            margin_m: answer.found.margin_m,
            target_m: answer.demand.margin_m,
            cost: answer.found.cost,
            latest_start_s: None,
            threat: Some(threat),
            threat_found_s: time_s,
            against,
            next_start_s: None,
            basis: None,
            resilience: answer.demand.share,
            side: side_of(&answer.found),
            is_small: is_small(answer) && self.pays_small(threat.id),
        };
        self.plan = Some(plan);
        self.state = State::Avoiding;
        let reason = if answer.proof.is_certified() {
            Reason::ManeuverChosen
        } else if self.tracks.inside {
            Reason::InsideVolume
        } else {
            Reason::BestAvailable
        };
        self.report(&plan, time_s, reason)
    }

    /// Flying a manoeuvre among aircraft: returns, keeps it, or replaces it.
    pub(super) fn avoid_aircraft(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        start: Start,
    ) -> Decision {
        let time_s = situation.time_s;
        let own_m = now.position_m;
        let Some(plan) = self.plan else {
            return self.watch_aircraft(situation, now, start);
        };
        let velocity_mps = situation.ownship.velocity_mps();
        let against = plan.against;
        let passing = self
            .tracks
            .all_pass(own_m, velocity_mps, |id| against.contains(id));
        self.withstand(Freedom::Expected, own_m, (0.0, self.wanted_m));
        let turned_rad = (time_s - plan.start_s) * self.flyer.course_rate_radps();
        let has_begun = passing
            || if plan.is_small {
                plan.has_met_threat(time_s)
            } else {
                turned_rad >= BEGUN_RAD
            };
        if has_begun && let Some(back) = self.way_back(situation, now, &plan, f64::INFINITY) {
            self.plan = Some(back);
            self.state = State::Recovering;
            return self.report(&back, time_s, Reason::RejoinChosen);
        }
        let flown = plan.remaining(time_s);
        let kept = self.resilience_of(&flown, now, plan.target_m);
        let proof = kept.map(|(_, certified)| certified).into();
        let kept = kept.map(|(share, _)| share);
        if plan.is_small
            && let Some(decision) = self.keep_small(situation, now, &plan, (kept, proof))
        {
            return decision;
        }
        let enough = kept.is_some_and(|kept| kept >= plan.kept_share());
        if enough {
            if let Some(plan) = self.improved(situation, now, &plan) {
                self.plan = Some(plan);
                return self.report(&plan, time_s, Reason::ManeuverReplaced);
            }
            let plan = Plan {
                proof,
                resilience: kept.unwrap_or(0.0),
                ..plan
            };
            self.plan = Some(plan);
            return self.report(&plan, time_s, Reason::ManeuverKept);
        }
        let above = kept.map_or(0.0, |kept| kept + CLEARLY_MORE);
        let (mut answer, mut candidates) =
            self.cheapest_within(now, plan.side, (above, WANTED_SHARE), self.demand());
        let poor = kept.is_none_or(|kept| kept <= 0.0);
        if answer.is_none() && poor && (kept.is_none() || self.cycle.is_multiple_of(LOOK_FOR_MORE))
        {
            let (found, looked_at) = self.farthest(now, Some((&flown, kept.is_some())), plan.side);
            answer = found;
            candidates += looked_at;
        }
        let plan = if let Some(answer) = &answer {
            plan.replaced_by(answer, time_s)
        } else {
            Plan {
                proof,
                resilience: kept.unwrap_or(0.0),
                ..plan
            }
        };
        let reason = match (plan.proof, answer) {
            (Proof::Certified(_), Some(_)) => Reason::ManeuverReplaced,
            (Proof::Certified(_), None) => Reason::ManeuverKept,
            _ => Reason::BestAvailable,
        };
        self.plan = Some(plan);
        let mut decision = self.report(&plan, time_s, reason);
        decision.record.work.candidates = candidates;
        decision
    }

    /// If nothing withstands any share: the manoeuvre with the largest margin in the worst case, if it stays clear
    /// of the expected motion; else the cheapest that does; else the one with the largest margin against it. During a
    /// manoeuvre only a clearly better one; `flown` says whether the present one stays clear of the expected motion.
    fn farthest(
        &mut self,
        now: &MotionState,
        flown: Option<(&Maneuver, bool)>,
        side: Option<Side>,
    ) -> (Option<Answer>, u32) {
        let own_m = now.position_m;
        let hold = Maneuver::hold();
        let variety = self.cycle;
        let worst = Freedom::Share(WANTED_SHARE);
        let demand = self.least_demand();
        let (horizon_s, target_m) = (demand.horizon_s, demand.margin_m);
        self.withstand(worst, own_m, (0.0, target_m));
        let kept_m = flown.map_or(f64::MIN, |(flown, _)| {
            self.margin_of(flown, now, (horizon_s, f64::MIN, ENOUGH_M))
        });
        let (best, mut candidates, _) = self.search(&hold, now, &demand, |search| {
            search.share_work(SEARCHES);
            let (found, _) = search.best(flown.map(|(flown, _)| flown), Effort::Quick, variety)?;
            Some(Answer::new(search, found, Proof::Open, demand))
        });
        self.withstand(Freedom::Share(0.0), own_m, (0.0, target_m));
        let is_clear = flown.is_some_and(|(_, is_clear)| is_clear);
        let more_m = if is_clear {
            CLEARLY_FARTHER_M
        } else {
            FARTHER_M
        };
        let best_m = best.as_ref().map(|best| best.found.margin_m);
        let is_better = best_m.is_some_and(|best_m| best_m > kept_m + more_m);
        let best = best.map(|mut best| {
            let asked = (horizon_s, target_m, target_m);
            if let Some(certified) = self.certified(&best.maneuver, now, asked) {
                best.proof = Proof::Certified(certified);
                best.found.margin_m = certified.margin_m();
            }
            best
        });
        match best {
            Some(best) if best.proof.is_certified() => {
                ((!is_clear || is_better).then_some(best), candidates)
            }
            _ if !is_clear => {
                let (mut answer, looked_at) = self.cheapest_within(now, side, (-1.0, 0.0), demand);
                candidates += looked_at;
                let again = flown.is_none() || self.cycle.is_multiple_of(LOOK_FOR_MORE);
                if answer.is_none() && self.meter.is_met() {
                    // No work is left for another search: what the first one found.
                    return (best.filter(|_| is_better), candidates);
                }
                if answer.is_none() && again {
                    let (found, looked_at) = self.in_two_stages(now, flown.map(|(flown, _)| flown));
                    answer = found;
                    candidates += looked_at;
                }
                (answer, candidates)
            }
            _ => (None, candidates),
        }
    }

    /// A manoeuvre of two turns or climbs that stays clear of the expected motion if no single one does:
    /// between a floor and a ceiling the aircraft can hold no climb angle. If none does, the one with the largest margin
    /// against the expected motion, clearly larger than that of the present one: in the worst case all are lost alike.
    /// It may take the rest of the step's work.
    fn in_two_stages(
        &mut self,
        now: &MotionState,
        flown: Option<&Maneuver>,
    ) -> (Option<Answer>, u32) {
        let demand = self.least_demand();
        self.withstand(Freedom::Share(0.0), now.position_m, (0.0, demand.margin_m));
        let kept_m = flown.map_or(f64::MIN, |flown| {
            self.margin_of(flown, now, (demand.horizon_s, f64::MIN, ENOUGH_M))
        });
        let variety = self.cycle;
        let (answer, looked_at, _) = self.search(&Maneuver::hold(), now, &demand, |search| {
            let (found, proof) = search.best(flown, Effort::WHOLE, variety)?;
            Some(Answer::new(search, found, proof, demand))
        });
        let answer = answer.and_then(|answer| {
            if answer.proof.is_certified() {
                return Some(answer);
            }
            let flown = flown.map(|flown| (flown, kept_m + EXPECTED_FARTHER_M));
            let (found, maneuver) =
                self.least_deep(&(answer.found, answer.maneuver), flown, now, &demand)?;
            Some(Answer {
                found,
                maneuver,
                ..answer
            })
        });
        (answer, looked_at)
    }

    /// A manoeuvre that departs clearly less from the mission than the present one, if it withstands as
    /// much: a course in between.
    fn improved(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        plan: &Plan,
    ) -> Option<Plan> {
        if !self.cycle.is_multiple_of(LOOK_FOR_LESS) {
            return None;
        }
        let flown = plan.remaining(situation.time_s);
        let last = *flown.stages().last()?;
        let leg = self.progress.leg(now);
        let mission_rad = now.course_rad + leg.turn_onto_rad(now);
        let away_rad = last.course_rad - mission_rad;
        let step_rad = libm::copysign(CLEARLY_LESS_RAD, away_rad);
        let (low, high) = self.climb_limits_rad();
        let level_rad = leg.climb_rad.limited(low, high);
        // No turn remains in reserve on the way between a small manoeuvre and the mission.
        let share = if plan.is_small {
            plan.resilience.max(WANTED_SHARE)
        } else {
            plan.resilience.min(WANTED_SHARE)
        };
        let target_m = self.wanted_m;
        self.withstand(Freedom::Share(share), now.position_m, (BEYOND_M, target_m));
        // If the work ended before all were examined, the next look continues from there.
        let from = core::mem::take(&mut self.improved_to);
        for k in from..12 {
            let offset_rad = f64::from(k) * step_rad;
            if offset_rad.abs() > away_rad.abs() - CLEARLY_LESS_RAD {
                return None;
            }
            if self.meter.is_met() {
                self.improved_to = k.saturating_sub(1).max(from);
                return None;
            }
            for climb_rad in [level_rad, last.climb_rad] {
                let maneuver = Maneuver::turn(0.0, mission_rad + offset_rad, climb_rad);
                let asked = (self.settings.horizon_s, target_m, ENOUGH_M);
                if let Some(certified) = self.certified(&maneuver, now, asked) {
                    return Some(Plan {
                        maneuver,
                        decided_s: situation.time_s,
                        proof: Proof::Certified(certified),
                        margin_m: certified.margin_m(),
                        resilience: share,
                        ..*plan
                    });
                }
            }
        }
        None
    }

    /// The least that is asked of a manoeuvre: the expected motion and the margin of the settings.
    const fn least_demand(&self) -> Demand {
        Demand {
            share: 0.0,
            margin_m: self.settings.margin_m,
            ..self.demand()
        }
    }

    /// Replaces the hazards by the possible motions of aircraft, with a distance beyond their volumes and the margin that is
    /// asked for, metres.
    pub(super) fn withstand(
        &mut self,
        freedom: Freedom,
        own_m: Vec3,
        (beyond_m, margin_m): (f64, f64),
    ) {
        let clearance = Clearance {
            beyond_m,
            margin_m,
            by_depth: false,
        };
        self.tracks
            .withstand(|_| freedom, own_m, clearance, &self.meter);
    }

    /// Whether a way back withstands, for a time, all motions of the aircraft that do not move away from it.
    pub(super) fn is_robust_back(
        &mut self,
        back: &Maneuver,
        now: &MotionState,
        target_m: f64,
    ) -> bool {
        if !self.tracks.has_aircraft() {
            return true;
        }
        if self.meter.is_met() {
            return false;
        }
        let own_m = now.position_m;
        let mission_rad = now.course_rad + self.progress.leg(now).turn_onto_rad(now);
        let first_rad = back.stages().first().map(|stage| stage.course_rad);
        // An aircraft moves away if it does so now, on the way back and on the mission.
        let ours_mps = [Some(now.course_rad), first_rad, Some(mission_rad)].map(|course_rad| {
            let course_rad = course_rad.unwrap_or(now.course_rad);
            self.flyer.velocity_mps(&MotionState { course_rad, ..*now })
        });
        let leaves = |hazard: &Hazard| {
            let offset_m = hazard.position_m - own_m;
            // What is above or below is clear by its height alone, and may change that.
            let is_beside = libm::hypot(offset_m.x, offset_m.y) > hazard.volume.radius_m();
            let mut ours_mps = ours_mps.iter();
            is_beside && ours_mps.all(|own_mps| offset_m.dot(hazard.velocity_mps - own_mps) > 0.0)
        };
        let freedom = |hazard: &Hazard| {
            if leaves(hazard) {
                Freedom::Expected
            } else {
                Freedom::Brief
            }
        };
        let clearance = Clearance {
            beyond_m: 0.0,
            by_depth: false,
            margin_m: target_m,
        };
        self.tracks
            .withstand(freedom, own_m, clearance, &self.meter);
        self.margin_of(back, now, (BACK_WITHSTANDS_S, target_m, target_m)) >= target_m
    }

    /// Whether a way back is kept: it is clear of the expected motion, or a manoeuvre that begins later still suffices.
    pub(super) fn is_kept_back(
        &mut self,
        plan: &Plan,
        situation: &Situation<'_>,
        now: &MotionState,
    ) -> bool {
        let keep_m = super::holding::KEEP_SHARE * plan.target_m;
        let back = plan.remaining(situation.time_s);
        self.withstand(Freedom::Expected, now.position_m, (0.0, self.wanted_m));
        if self.margin_of(&back, now, (self.settings.horizon_s, keep_m, keep_m)) >= keep_m {
            return true;
        }
        self.may_wait(&back, now, WAIT_FOR_TURN_RAD, &self.demand())
            .0
    }

    /// The largest share that a manoeuvre planned with the margin `of_m` withstands, if any, and its certificate.
    fn resilience_of(
        &mut self,
        maneuver: &Maneuver,
        now: &MotionState,
        of_m: f64,
    ) -> Option<(f64, Certified)> {
        let target_m = super::holding::KEEP_SHARE * of_m;
        SHARES.into_iter().find_map(|share| {
            if self.meter.is_met() {
                return None;
            }
            self.withstand(Freedom::Share(share), now.position_m, (0.0, self.wanted_m));
            let asked = (self.settings.horizon_s, target_m, target_m);
            Some((share, self.certified(maneuver, now, asked)?))
        })
    }

    /// The manoeuvre that withstands the largest share within a range, above the first and up to the second,
    /// the cheapest of those, on its side if there is one there.
    pub(super) fn cheapest_within(
        &mut self,
        now: &MotionState,
        side: Option<Side>,
        (above, most): (f64, f64),
        mut demand: Demand,
    ) -> (Option<Answer>, u32) {
        let hold = Maneuver::hold();
        let mut candidates = 0;
        let shares = SHARES.into_iter();
        for share in shares.filter(|share| *share > above && *share <= most) {
            if self.meter.is_met() {
                break;
            }
            demand.share = share;
            let clearance_m = (BEYOND_M, demand.margin_m);
            self.withstand(Freedom::Share(share), now.position_m, clearance_m);
            let (answer, looked_at, _) = self.search(&hold, now, &demand, |search| {
                search.share_work(SEARCHES);
                let found = side
                    .and_then(|side| search.cheapest_to(&[side], 0.0))
                    .or_else(|| search.cheapest(0.0))?;
                let (found, proof) = search.proven(found)?;
                Some(Answer::new(search, found, proof, demand))
            });
            candidates += looked_at;
            if answer.is_some() {
                return (answer, candidates);
            }
        }
        (None, candidates)
    }
}

impl Plan {
    /// The plan with another manoeuvre; it keeps the side of the first one.
    pub(super) fn replaced_by(&self, answer: &Answer, time_s: f64) -> Self {
        Self {
            target_m: answer.demand.margin_m,
            resilience: answer.demand.share,
            side: self.side.or_else(|| side_of(&answer.found)),
            ..self.with(&answer.maneuver, (&answer.found, answer.proof), time_s)
        }
    }
}

/// A manoeuvre and what was asked of it.
pub(super) struct Answer {
    pub(super) found: Found,
    pub(super) maneuver: Maneuver,
    pub(super) proof: Proof,
    pub(super) demand: Demand,
}

impl Answer {
    fn new(search: &Search<'_>, found: Found, proof: Proof, demand: Demand) -> Self {
        Self {
            maneuver: as_maneuver(search, &found),
            found,
            proof,
            demand,
        }
    }
}

/// The side of a manoeuvre's turn, if it has one.
pub(super) fn side_of(found: &Found) -> Option<Side> {
    (found.turns.turn_rad != 0.0).then(|| Side::of(found.turns.turn_rad))
}
