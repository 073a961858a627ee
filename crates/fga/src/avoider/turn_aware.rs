//! The turn-aware policy: look, plan, fly, return.

mod aircraft;
mod choice;
mod depth;
mod detour;
mod farther;
mod foresight;
mod holding;
mod need;
mod room;
mod small;
mod sooner;
mod threat;
mod way_back;

pub(super) use holding::Basis;

use crate::avoider::demand::Demand;
use crate::avoider::quiet::LineAhead;
use crate::avoider::{
    Against, Avoider, Candidate, Decision, Kept, Plan, Reason, Start, State, Threat, Verdict,
};
use crate::certificate::{Asked, Certificate, Certified, Status, certify_set, prove};
use crate::limit::Limit as _;
use crate::maneuver::Maneuver;
use crate::meter::BEND;
use crate::prediction::MotionState;
use crate::search::{Effort, Found, GRIDS_A_SEARCH, Proof, Scene, Search};
use crate::situation::Situation;
use choice::{Choice, as_maneuver, choose};
use holding::RENEWED_AFTER_S;

/// Part of a step's work for a search with more than the margin of the settings, one in this many.
const TARGETS: u32 = 4;

/// Work of a search over some grids among few obstacles, whatever one step may do of it, and the most of later searches. The
/// first search of an encounter, once it is close to a solution, may use all: the first turn decides which solutions later
/// searches can still reach.
const GRID_WORK: u32 = 80_000;

/// Another uncertified manoeuvre must be better by this, metres.
const CLEARLY_BETTER_M: f64 = 0.5;

/// Cycles between two searches once a whole search since the last news has found nothing. Until then each step searches over
/// the grids that the limit of work left.
const SEARCH_AGAIN: u32 = 10;

/// Cycles between two searches over all manoeuvres without a certificate among uncertain obstacles,
/// which move from cycle to cycle.
const LOOK_AT_NOISE: u32 = 2;

/// When the margin of the present manoeuvre changes by this, the obstacles have moved, metres.
const NEWS_M: f64 = 1.0;

/// Margins are capped at this value, m.
const ENOUGH_M: f64 = 1e3;

/// An obstacle whose entry is later than this after the first one belongs to another encounter,
/// seconds.
const NEXT_ENCOUNTER_S: f64 = 10.0;

/// The result of a search in place of the flown manoeuvre.
struct Replacement {
    /// The best one, if it is certified or clearly better than the flown one.
    better: Option<(Found, Maneuver)>,
    /// What is proven about the best one, if there is any.
    proof: Option<Proof>,
    /// The margin that it was asked for, metres.
    target_m: f64,
    /// Number of manoeuvres looked at.
    candidates: u32,
    /// Whether the work ran out.
    limit_met: bool,
}

impl Avoider {
    pub(super) fn step_turn_aware(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        start: Start,
        mut kept: Option<&mut Kept<'_>>,
    ) -> Decision {
        self.wanted_m = self.settings.margin_m + self.drift_m;
        if self.state == State::Cruise
            && let Some(decision) = self.quiet(situation, now, kept.as_deref_mut())
        {
            return decision;
        }
        self.load_tracks(situation, kept);
        self.decide_among_tracks(situation, now, start)
    }

    /// The decision about the obstacles that were loaded.
    fn decide_among_tracks(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        start: Start,
    ) -> Decision {
        self.far_s = self.far_horizon_s(now);
        match self.state {
            State::Cruise | State::Threatened => self.watch(situation, now, start),
            State::Avoiding if self.tracks.has_aircraft() => {
                self.avoid_aircraft(situation, now, start)
            }
            State::Avoiding => self.avoid(situation, now, start),
            State::Recovering => self.come_back(situation, now, start),
        }
    }

    /// The decision of the many cycles in which the leg ahead is straight and clear.
    fn quiet(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        kept: Option<&mut Kept<'_>>,
    ) -> Option<Decision> {
        let horizon_s = self.settings.horizon_s;
        let course_rad = self.progress.straight_on_rad(now, &self.flyer, horizon_s)?;
        let line = LineAhead {
            position_m: now.position_m,
            velocity_mps: self.ours_mps,
            surveillance_radius_m: self.settings.surveillance_radius_m,
            margin_m: self.wanted_m,
            sigmas: self.settings.confidence_sigmas,
            horizon_s,
        };
        let is_clear = match kept {
            None => line.is_clear_of(&situation.obstacles),
            Some(kept) => kept.is_clear_of(&line, situation),
        };
        is_clear.then(|| {
            let command = Maneuver::turn(0.0, course_rad, now.climb_rad);
            self.decision(&command, Reason::Clear)
        })
    }

    /// On the mission: is it clear, and if not, when and where should the aircraft turn?
    fn watch(&mut self, situation: &Situation<'_>, now: &MotionState, start: Start) -> Decision {
        if self.tracks.has_aircraft() {
            return self.watch_aircraft(situation, now, start);
        }
        if let Some(plan) = self.plan
            && self.state == State::Threatened
            && self.still_holds(&plan, situation, now)
        {
            if plan.start_s > situation.time_s {
                return self.report(&plan, situation.time_s, Reason::WaitingForStart);
            }
            self.state = State::Avoiding;
            return self.report(&plan, situation.time_s, Reason::ManeuverChosen);
        }
        let (nominal, _) = self.guidance(situation, now);
        let Some((threat, against)) = self.first_threat(&nominal, now, &self.demand()) else {
            self.state = State::Cruise;
            self.plan = None;
            return self.decision(&nominal, Reason::Clear);
        };
        self.plan_anew(situation, now, &nominal, threat, against, start)
    }

    /// Keeps the rolls from the bank of now, from which many predictions are about to begin.
    fn keep_rolls(&mut self, now: &MotionState) {
        let is_kept = self.flyer.keeps_rolls_from(now.bank_rad);
        if !is_kept && self.meter.take(2 * BEND) {
            self.flyer.keep_rolls_from(now.bank_rad);
        }
    }

    /// Runs a search in the present scene; returns its result, none if it met even the reserve for finishing, the number of
    /// examined manoeuvres, and whether it met its limit.
    fn search<T>(
        &mut self,
        nominal: &Maneuver,
        now: &MotionState,
        demand: &Demand,
        look: impl FnOnce(&mut Search<'_>) -> T,
    ) -> (T, u32, bool)
    where
        T: Default,
    {
        self.keep_rolls(now);
        let limit = self.settings.work_limit;
        let later = GRID_WORK.min(limit);
        let is_ideal = self.flyer.is_ideal();
        let most = if self.plan.is_none() || !is_ideal {
            limit
        } else {
            later
        };
        let leg = self.progress.leg(now);
        let (low, high) = self.climb_limits_rad();
        let scene = Scene {
            flyer: &self.flyer,
            start: *now,
            nominal,
            original: (
                now.course_rad + leg.turn_onto_rad(now),
                leg.climb_rad.limited(low, high),
            ),
            hazards: self.tracks.hazards(),
            horizon_s: demand.horizon_s,
            target_m: demand.margin_m,
            climb_limits_rad: (low, high),
            costs: (self.settings.heading_cost, self.settings.pitch_cost),
            objective: self.settings.objective,
        };
        let meter = self.meter.part(most);
        let mut search = Search::within(scene, &mut self.path, meter);
        let mut answer = look(&mut search);
        if search.is_spent() {
            // It may rest on pieces that were refused.
            answer = T::default();
        }
        let (evaluated, limit_met, grids) = (search.evaluated, search.limit_met(), search.grids);
        self.meter.count(search.work() as usize);
        self.grids = self.grids.saturating_add(grids);
        self.cut = if limit_met {
            self.cut.wrapping_add(1)
        } else {
            0
        };
        (answer, evaluated, limit_met)
    }

    /// Chooses a manoeuvre and its start.
    fn plan_anew(
        &mut self,
        situation: &Situation<'_>,
        now: &MotionState,
        nominal: &Maneuver,
        threat: Threat,
        against: Against,
        start: Start,
    ) -> Decision {
        let period_s = self.settings.decision_period_s;
        let (entry_s, cut) = (threat.entry_s, self.cut);
        self.grids = 0;
        let (mut candidates, mut limit_met) = (0, false);
        let mut choice = Choice::NONE;
        let mut demand = self.demand();
        for target_m in self.targets_m() {
            demand.margin_m = target_m;
            let is_last = target_m <= self.settings.margin_m;
            let (chosen, more, met) = self.search(nominal, now, &demand, |search| {
                if !is_last {
                    search.share_work(TARGETS);
                }
                choose(search, start, (entry_s, period_s), (cut, is_last))
            });
            (choice, candidates, limit_met) = (chosen, candidates + more, limit_met | met);
            if is_last || choice.is_certified() {
                break;
            }
        }
        let horizon_s = self.far_s;
        if horizon_s > demand.horizon_s && choice.is_certified() {
            let far = Demand {
                horizon_s,
                ..demand
            };
            let (farther, more, met) = self.search(nominal, now, &far, |search| {
                choose(search, start, (entry_s, period_s), (cut, true))
            });
            candidates += more;
            limit_met |= met;
            if farther.is_certified() {
                choice = farther;
            }
        }
        let chosen = choice.chosen.and_then(|(found, maneuver, proof)| {
            if proof.is_certified() {
                return choice.chosen;
            }
            let (found, maneuver) = self.least_deep(&(found, maneuver), None, now, &demand)?;
            Some((found, maneuver, proof))
        });
        let mut decision = match chosen {
            Some((found, maneuver, proof)) => {
                let plan = Plan {
                    maneuver,
                    decided_s: situation.time_s,
                    start_s: situation.time_s + found.turns.wait_s,
                    joined_s: f64::INFINITY,
                    proof,
                    picture: self.tracks.picture(),
                    margin_m: found.margin_m,
                    target_m: demand.margin_m,
                    cost: found.cost,
                    latest_start_s: choice.latest_s.map(|latest_s| situation.time_s + latest_s),
                    threat: Some(threat),
                    threat_found_s: situation.time_s,
                    against,
                    next_start_s: None,
                    basis: None,
                    resilience: 1.0,
                    side: None,
                    is_small: false,
                };
                self.plan = Some(plan);
                let (state, reason) = if !proof.is_certified() {
                    let inside = self.tracks.inside;
                    let reason = if inside {
                        Reason::InsideVolume
                    } else {
                        Reason::BestAvailable
                    };
                    (State::Avoiding, reason)
                } else if plan.start_s > situation.time_s {
                    (State::Threatened, Reason::WaitingForStart)
                } else {
                    (State::Avoiding, Reason::ManeuverChosen)
                };
                self.state = state;
                self.report(&plan, situation.time_s, reason)
            }
            None => self.decision(nominal, Reason::BestAvailable),
        };
        decision.record.alternative = choice.alternative;
        decision.record.work.candidates = candidates;
        decision.record.work.limit_met = limit_met || self.tracks.overflow;
        decision.record.work.threats = 1;
        decision
    }

    /// The margins of one search after the other, metres: all of the wanted one, half of what drift adds to it, then
    /// the margin of the settings. Without drift there is only the last.
    fn targets_m(&self) -> impl Iterator<Item = f64> + use<> {
        let (least_m, wanted_m) = (self.settings.margin_m, self.wanted_m);
        let drift_m = wanted_m - least_m;
        let wanted = (drift_m > 0.0).then_some([wanted_m, least_m + 0.5 * drift_m]);
        wanted.into_iter().flatten().chain([least_m])
    }

    /// Margin of a manoeuvre up to a horizon, between `floor_m`, below which it stops, and `enough_m`.
    fn margin_of(&mut self, maneuver: &Maneuver, now: &MotionState, asked: (f64, f64, f64)) -> f64 {
        self.predict(maneuver, now, asked.0);
        self.certificate_of_path(asked).proven_m()
    }

    /// The certificate of the manoeuvre predicted last, between the same limits.
    fn certificate_of_path(&self, (horizon_s, floor_m, enough_m): (f64, f64, f64)) -> Certificate {
        let asked = Asked {
            horizon_s,
            floor_m,
            enough_m,
        };
        let hazards = self.tracks.hazards();
        certify_set(&self.flyer, &self.path, hazards, &asked, &self.meter)
    }

    /// The certificate of a manoeuvre: that it keeps a target up to a horizon; its margin is capped.
    fn certified(
        &mut self,
        maneuver: &Maneuver,
        now: &MotionState,
        asked: (f64, f64, f64),
    ) -> Option<Certified> {
        self.predict(maneuver, now, asked.0);
        self.prove(asked)
    }

    /// The same of the manoeuvre predicted last.
    fn prove(&self, asked: (f64, f64, f64)) -> Option<Certified> {
        let hazards = self.tracks.hazards();
        prove(&self.flyer, &self.path, hazards, asked, &self.meter)
    }

    /// Grids that a whole search since the last news has left to look at.
    const fn grids_left(&self) -> u32 {
        GRIDS_A_SEARCH.saturating_sub(self.grids)
    }

    /// Flying the manoeuvre: keeps it, replaces it, or returns.
    fn avoid(&mut self, situation: &Situation<'_>, now: &MotionState, start: Start) -> Decision {
        let time_s = situation.time_s;
        let waits =
            |plan: &Plan| self.tracks.obstacle_count() > 0 || way_back::given_up(plan, time_s) == 0;
        let Some(mut plan) = self.plan.filter(waits) else {
            self.state = State::Cruise;
            return self.watch(situation, now, start);
        };
        if let Some(back) = self.way_back(situation, now, &plan, f64::INFINITY) {
            self.plan = Some(back);
            self.state = State::Recovering;
            return self.report(&back, time_s, Reason::RejoinChosen);
        }
        if self.still_holds(&plan, situation, now) {
            if let Some(farther) = self.farther(&plan, now, time_s) {
                self.plan = Some(farther);
                return self.report(&farther, time_s, Reason::ManeuverReplaced);
            }
            if let Some(roomier) = self.roomier(&plan, now, time_s) {
                let is_same = roomier.decided_s == plan.decided_s;
                self.plan = Some(roomier);
                let reason = if is_same {
                    Reason::ManeuverKept
                } else {
                    Reason::ManeuverReplaced
                };
                return self.report(&roomier, time_s, reason);
            }
            return self.report(&plan, time_s, Reason::ManeuverKept);
        }
        let flown = plan.remaining(time_s);
        // The volume around the aircraft shrinks with its depth.
        let inside = self.tracks.inside;
        let is_open = !plan.proof.is_certified();
        let expected = is_open.then(|| self.as_expected(&plan, situation, now));
        let kept_m = if let Some(basis) = expected.flatten() {
            basis.kept_m
        } else {
            let horizon_s = self.settings.horizon_s;
            self.predict(&flown, now, horizon_s);
            let kept = self.certificate_of_path((horizon_s, f64::MIN, ENOUGH_M));
            // The margin may change by itself once the closest approach is over.
            let lasts_s = kept.at_s.min(RENEWED_AFTER_S);
            let is_lasting = kept.status == Status::Proven && !inside && !self.tracks.uncertain;
            plan.basis = (is_open && is_lasting)
                .then(|| self.basis(&plan, situation, now, (kept.margin_m, lasts_s)));
            self.plan = Some(plan);
            kept.proven_m()
        };
        let picture = self.tracks.picture();
        let is_news = plan.proof.is_certified()
            || (!inside && (kept_m - plan.margin_m).abs() > NEWS_M)
            || picture.differs_from(&plan.picture)
            || (self.tracks.uncertain && self.cycle.is_multiple_of(LOOK_AT_NOISE));
        if is_news {
            self.grids = 0;
        }
        let is_searched = self.grids_left() == 0;
        let look_again = self.cycle.is_multiple_of(SEARCH_AGAIN);
        let rests = match plan.proof {
            Proof::Hopeless => !(is_news || inside && look_again),
            Proof::Open => is_searched && !look_again,
            Proof::Certified(_) => false,
        };
        if rests {
            return self.report(&plan, time_s, Reason::BestAvailable);
        }
        let replacement = self.replacement((&flown, kept_m), now);
        let proof = replacement.proof.unwrap_or(plan.proof);
        let mut decision = if let Some((found, maneuver)) = replacement.better {
            let plan = Plan {
                joined_s: f64::INFINITY,
                picture,
                target_m: replacement.target_m,
                against: self.also_against(&flown, now, plan.against, replacement.target_m),
                ..plan.with(&maneuver, (&found, proof), time_s)
            };
            self.plan = Some(plan);
            let reason = if proof.is_certified() {
                Reason::ManeuverReplaced
            } else {
                Reason::BestAvailable
            };
            self.report(&plan, time_s, reason)
        } else {
            let plan = Plan {
                proof,
                picture,
                margin_m: kept_m,
                ..plan
            };
            self.plan = Some(plan);
            self.report(&plan, time_s, Reason::BestAvailable)
        };
        decision.record.work.candidates = replacement.candidates;
        decision.record.work.limit_met = replacement.limit_met || self.tracks.overflow;
        decision
    }

    /// Searches at the wanted margin, else step by step down to the margin of the settings.
    fn replacement(&mut self, (flown, kept_m): (&Maneuver, f64), now: &MotionState) -> Replacement {
        let hold = Maneuver::hold();
        let variety = self.cycle;
        let effort = match self.grids_left() {
            0 => Effort::WHOLE,
            left => Effort::Grids(left),
        };
        let (mut found, mut candidates, mut limit_met) = (None, 0, false);
        let mut demand = self.demand();
        for target_m in self.targets_m() {
            demand.margin_m = target_m;
            let is_last = target_m <= self.settings.margin_m;
            let (answer, more, met) = self.search(&hold, now, &demand, |search| {
                if !is_last {
                    search.share_work(TARGETS);
                }
                let single = search.cheapest(0.0);
                let single = single.and_then(|found| search.proven(found));
                let (found, proof) = if is_last {
                    single.or_else(|| search.best(Some(flown), effort, variety))?
                } else {
                    single?
                };
                // A wait lets the bank roll out, which turns the aircraft.
                Some(((found, as_maneuver(search, &found)), proof))
            });
            (found, candidates, limit_met) = (answer, candidates + more, limit_met | met);
            if is_last || found.is_some() {
                break;
            }
        }
        let proof = found.map(|(_, proof)| proof);
        let better = match &found {
            Some((answer, Proof::Certified(_))) => Some(*answer),
            Some((answer, _)) => {
                let flown = Some((flown, kept_m + CLEARLY_BETTER_M));
                self.least_deep(answer, flown, now, &demand)
            }
            None => None,
        };
        Replacement {
            better,
            proof,
            target_m: demand.margin_m,
            candidates,
            limit_met,
        }
    }

    /// The decision to fly the rest of a plan.
    pub(super) fn report(&self, plan: &Plan, time_s: f64, reason: Reason) -> Decision {
        let elapsed_s = time_s - plan.threat_found_s;
        let command = plan.remaining(time_s);
        let mut decision = self.decision(&command, reason);
        let record = &mut decision.record;
        // After the predicted entry the threat is history.
        let ahead = plan.threat.filter(|threat| threat.entry_s >= elapsed_s);
        record.threat = ahead.map(|threat| Threat {
            entry_s: threat.entry_s - elapsed_s,
            closest_s: threat.closest_s - elapsed_s,
            ..threat
        });
        record.straight_aircraft = self.tracks.straight_aircraft(plan.resilience, &self.meter);
        let is_shown = self.state == State::Avoiding && plan.proof.is_certified();
        let is_all = self.tracks.has_aircraft() && record.straight_aircraft == 0;
        record.resilience = (is_shown && is_all).then_some(plan.resilience);
        record.start_s = Some(plan.start_s - time_s);
        record.latest_start_s = plan.latest_start_s.map(|latest_s| latest_s - time_s);
        record.certified = plan.proof.certified();
        record.chosen = Some(Candidate {
            maneuver: command,
            margin_m: plan.margin_m,
            cost: plan.cost,
            verdict: if plan.proof.is_certified() {
                Verdict::Chosen
            } else {
                Verdict::Rejected
            },
        });
        decision
    }
}
