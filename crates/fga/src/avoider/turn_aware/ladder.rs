//! The highest rung of the ladder on which a manoeuvre is certified; below the last one, the manoeuvre with the largest margin.

use core::f64::consts::TAU;
use core::ops::Range;

use crate::avoider::demand::{BEYOND_M, Demand, RUNGS, WANTED};
use crate::avoider::intruders::{Clearance, Freedom};
use crate::avoider::{Avoider, Now, Places, Plan};
use crate::limit::Limit as _;
use crate::maneuver::Maneuver;
use crate::prediction::MotionState;
use crate::search::Side;
use crate::search::{Found, GRIDS_A_SEARCH, Outcome, Search, Turns};
use crate::situation::Situation;

use super::{Answer, ENOUGH_M, LOOK_EVERY};

/// Part of a step's work for the search on one rung, one in this many: the rest is for those below it.
pub(super) const RUNG_SHARE: u32 = 4;

/// Another uncertified manoeuvre must be better by this, metres.
const CLEARLY_BETTER_M: f64 = 0.5;

/// A manoeuvre of the same demand replaces the flown one if its course departs less from the mission by this, radians (15°).
const CLEARLY_LESS_RAD: f64 = 0.26;

/// Most steps of that size: half a turn.
const MOST_STEPS: u32 = 12;

/// With less of a step's work left the depth in cylinders is not searched.
const DEPTH_WORK: u32 = 4000;

impl Avoider<dyn Places + '_> {
    /// A manoeuvre on a higher rung, or one on the same, nearer to the mission's course than the present one.
    #[inline(never)]
    pub(super) fn better(
        &mut self,
        plan: &Plan,
        flown: &Maneuver,
        situation: &Situation<'_>,
        now: &Now<'_>,
    ) -> Option<Answer> {
        let has_aircraft = self.tracks.has_aircraft();
        if has_aircraft && plan.rung == WANTED + 1 {
            // An intruder may answer each change.
            return None;
        }
        let (hold, variety) = (&Maneuver::HOLD, self.cycle / LOOK_EVERY);
        let flown = Turns::of(flown, now.course_rad);
        let higher = self.highest_beside(0..plan.rung, now).or_else(|| {
            let rungs = 0..if has_aircraft { 0 } else { plan.rung };
            self.highest(rungs, hold, now, &mut |search| {
                let (found, outcome) = search.best(flown, GRIDS_A_SEARCH, variety)?;
                (outcome == Outcome::Proven).then_some(found)
            })
        });
        if higher.is_some() || !has_aircraft || plan.rung > WANTED {
            // Among zones, what turns back is for where nothing else is certified: turning round again takes room.
            let turns_on_rad = self.progress.leg(now).turn_onto_rad(now);
            let has_zones = self.tracks.has_zones();
            let goes_back = |answer: &Answer| {
                let turns = &answer.found.turns;
                let course_rad =
                    turns.turn_rad + turns.second.map_or(0.0, |second| second.turn_rad);
                libm::cos(course_rad - turns_on_rad) < 0.0
            };
            return higher.filter(|answer| !(has_zones && has_aircraft && goes_back(answer)));
        }
        // A course nearer to the mission uses up what was kept for the aircraft.
        if !self.tracks.all_pass(&situation.ownship, &plan.against) && !self.is_free(now) {
            return None;
        }
        let rung = plan.rung.min(WANTED);
        // Steps away from the mission's course, not the least certified turn: what is found keeps some room to spare.
        let (leg, away_rad) = (self.progress.leg(now), self.away_rad(now));
        let last_rad = self.flown.stages().last()?.climb_rad;
        let (low, high) = self.maneuver_climbs_rad();
        let climbs_rad = [leg.climb_rad.limited(low, high), last_rad];
        let steps = (0..MOST_STEPS).map(|k| f64::from(k) * CLEARLY_LESS_RAD);
        let nearer = steps.take_while(|aside_rad| *aside_rad <= away_rad.abs() - CLEARLY_LESS_RAD);
        let demand = self.demand_of(rung);
        self.ask(&demand, BEYOND_M);
        self.search(&Maneuver::HOLD, now, &demand, |search| {
            let mut courses =
                nearer.flat_map(|aside_rad| climbs_rad.map(|climb_rad| (aside_rad, climb_rad)));
            courses.find_map(|(aside_rad, climb_rad)| {
                let turns = Turns {
                    wait_s: 0.0,
                    turn_rad: leg.turn_onto_rad(now) + libm::copysign(aside_rad, away_rad),
                    climb_rad,
                    second: None,
                };
                let found = Found {
                    turns,
                    margin_m: demand.margin_m,
                    cost: plan.cost,
                };
                let proven = search.proven(found)?;
                Some(Answer::new(search, proven, rung))
            })
        })
    }

    /// A proven circle, once what is flown has been flown for the time of one.
    pub(super) fn circle(&mut self, plan: &Plan, now: &Now<'_>) -> Option<Answer> {
        if self.last_time_s - plan.decided_s < self.tracks.walls_s() {
            return None;
        }
        let wanted = self.demand_of(WANTED);
        self.search(&Maneuver::HOLD, now, &wanted, |search| {
            [TAU, -TAU].into_iter().find_map(|turn_rad| {
                let turns = Turns {
                    wait_s: 0.0,
                    turn_rad,
                    climb_rad: 0.0,
                    second: None,
                };
                let found = Found {
                    turns,
                    margin_m: wanted.margin_m,
                    cost: 0.0,
                };
                let proven = search.proven(found)?;
                Some(Answer::new(search, proven, WANTED))
            })
        })
    }

    /// The course of a plan, radians from that of the mission.
    pub(super) fn away_rad(&self, now: &MotionState) -> f64 {
        let course_rad =
            (self.flown.stages().last()).map_or(now.course_rad, |last| last.course_rad);
        course_rad - now.course_rad - self.progress.leg(now).turn_onto_rad(now)
    }

    /// The certified manoeuvre on the highest of some rungs that has one, on the side of the present manoeuvre.
    #[inline(never)]
    pub(super) fn highest_beside(&mut self, rungs: Range<usize>, now: &Now<'_>) -> Option<Answer> {
        let side = [Side::of(self.away_rad(now))];
        self.highest(rungs, &Maneuver::HOLD, now, &mut |search| {
            let beside = search.cheapest_to(&side, 0.0);
            beside.or_else(|| search.cheapest(0.0))
        })
    }

    /// The certified manoeuvre on the highest of some rungs that has one.
    #[inline(never)]
    pub(super) fn highest(
        &mut self,
        rungs: impl IntoIterator<Item = usize>,
        nominal: &Maneuver,
        now: &Now<'_>,
        look: &mut dyn FnMut(&mut Search<'_>) -> Option<Found>,
    ) -> Option<Answer> {
        for rung in rungs {
            let Some(demand) = self.distinct_demand(rung) else {
                continue;
            };
            if self.meter.is_met() {
                return None;
            }
            self.ask(&demand, BEYOND_M);
            let answer = self.search(nominal, now, &demand, |search| {
                search.share_work(RUNG_SHARE);
                let found = look(search)?;
                let proven = search.proven(found)?;
                Some(Answer::new(search, proven, rung))
            });
            if answer.is_some() {
                return answer;
            }
        }
        None
    }

    /// The manoeuvre with the largest margin on the lowest rung, beside the flown one only if it is clearly better. A manoeuvre
    /// that enters a cylinder gives way to the manoeuvre that comes least deep.
    pub(super) fn best(
        &mut self,
        flown: Option<(&mut Plan, &Maneuver)>,
        nominal: &Maneuver,
        now: &Now<'_>,
    ) -> Option<Answer> {
        let lowest = RUNGS - if self.in_need.is_some() { 1 } else { 2 };
        let demand = self.demand_of(lowest);
        self.ask(&demand, 0.0);
        let variety = self.grids;
        let grids = match GRIDS_A_SEARCH.saturating_sub(self.grids) {
            left if left > 0 && flown.is_some() => left,
            _ => GRIDS_A_SEARCH,
        };
        let from = (flown.as_ref()).and_then(|(_, flown)| Turns::of(flown, now.course_rad));
        let best = self.search(nominal, now, &demand, |search| {
            let best = search.best(from, grids, variety)?;
            Some(Answer::new(search, best, lowest))
        })?;
        if best.outcome == Outcome::Proven {
            return Some(best);
        }
        if best.outcome == Outcome::Hopeless {
            self.grids = GRIDS_A_SEARCH;
        }
        let deepest = self.least_deep(&best, &demand, now, variety);
        let Some((plan, flown)) = flown else {
            return deepest;
        };
        let asked = (demand.horizon_s, f64::MIN, ENOUGH_M);
        plan.rung = lowest;
        plan.margin_m = self.within_limits(&demand, |avoider| avoider.margin_of(flown, now, asked));
        deepest.filter(|deepest| deepest.found.margin_m > plan.margin_m + CLEARLY_BETTER_M)
    }

    /// In place of a manoeuvre that enters a volume one that comes less deep, from it on.
    #[inline(never)]
    fn least_deep(
        &mut self,
        best: &Answer,
        demand: &Demand,
        now: &Now<'_>,
        variety: u32,
    ) -> Option<Answer> {
        let cylinders = self.tracks.rows().iter().any(|row| row.is_cylinder());
        let differs = cylinders || self.tracks.uncertain;
        if best.found.margin_m >= 0.0 || !differs || self.meter.left() < DEPTH_WORK {
            return Some(*best);
        }
        self.by_depth();
        let from = Turns::of(&self.tables.answer, now.course_rad);
        self.search(&Maneuver::HOLD, now, demand, |search| {
            let (found, _) = search.best(from, 0, variety)?;
            Some(Answer::new(search, (found, best.outcome), best.rung))
        })
    }

    /// Takes the expected motions of all obstacles as hazards, without uncertainty, with margins by depth.
    fn by_depth(&mut self) {
        let clearance = Clearance {
            beyond_m: 0.0,
            margin_m: 0.0,
            is_unproven: true,
        };
        self.tracks
            .withstand(&|_| Freedom::Share(0.0, 0.0), clearance, &self.meter);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{aircraft, among, plan, sphere};
    use super::*;
    use crate::situation::{Obstacle, ProtectedVolume, Uncertainty};

    /// The rung of the cheapest manoeuvre, and its turn, radians.
    fn highest(rows: &[Obstacle], drift_m: f64) -> Option<(usize, f64)> {
        among(rows, |avoider, _, now| {
            avoider.drift_m = drift_m;
            let look = &mut |search: &mut Search<'_>| search.cheapest(0.0);
            let answer = avoider.highest(0..RUNGS, &Maneuver::HOLD, now, look)?;
            assert!(avoider.tables.answer.certified().is_some());
            Some((answer.rung, answer.found.turns.turn_rad))
        })
    }

    /// A ring of masts with gaps of 20 m between them, one of them ahead: room for 10 m to each side.
    #[test]
    fn the_highest_rung_that_has_a_manoeuvre_is_taken() {
        let ring: alloc::vec::Vec<Obstacle> = (0..12)
            .map(|k| {
                let (sin, cos) = f64::to_radians(15.0 + 30.0 * f64::from(k)).sin_cos();
                let from_m = 40.0 / f64::to_radians(15.0).sin();
                Obstacle {
                    volume: ProtectedVolume::Cylinder {
                        radius_m: 30.0,
                        half_height_m: 1000.0,
                    },
                    ..sphere(k, (from_m * cos, from_m * sin), (0.0, 0.0))
                }
            })
            .collect();
        let rung = |drift_m| highest(&ring, drift_m).map(|(rung, _)| rung);
        assert_eq!(rung(8.0), Some(0));
        assert_eq!(rung(16.0), Some(WANTED + 1));
        assert_eq!(rung(60.0), Some(WANTED + 2));
        assert_eq!(highest(&[sphere(1, (31.0, 0.0), (0.0, 0.0))], 0.0), None);
    }

    /// The later the turn begins, the less of an aircraft's bounds it withstands.
    #[test]
    fn the_share_of_the_bounds_falls_with_the_time_that_is_left() {
        let rungs: alloc::vec::Vec<usize> = (40..400)
            .step_by(5)
            .map(|ahead_m| {
                let row = aircraft(1, (f64::from(ahead_m), 0.0), (-20.0, 0.0));
                highest(&[row], 0.0).map_or(RUNGS, |(rung, _)| rung)
            })
            .collect();
        assert!(rungs.iter().rev().is_sorted(), "{rungs:?}");
        for rung in [0, WANTED + 1, WANTED + 2, RUNGS] {
            assert!(rungs.contains(&rung), "{rung}: {rungs:?}");
        }
    }

    /// Nearer to the mission's course while a turn still withstands all that an aircraft does, and once it has passed.
    #[test]
    fn a_plan_turns_back_to_the_mission_while_the_aircraft_is_free_to_turn_away() {
        let mut counts = [0; 2];
        for ahead_m in (-200..600).step_by(5) {
            let row = aircraft(1, (f64::from(ahead_m), -50.0), (-60.0, 0.0));
            let (is_free, better) = among(&[row], |avoider, situation, now| {
                let plan = plan(avoider, situation, (1.4, 0));
                let is_free = avoider.is_free(now)
                    || (avoider.tracks).all_pass(&situation.ownship, &plan.against);
                let flown = avoider.flown;
                (is_free, avoider.better(&plan, &flown, situation, now))
            });
            let turn_rad = better.map(|better| better.found.turns.turn_rad);
            assert!(is_free || turn_rad.is_none(), "{ahead_m} m");
            assert!(ahead_m > -100 || turn_rad == Some(0.0), "{ahead_m} m");
            counts[usize::from(is_free)] += 1;
        }
        assert!(counts.iter().all(|count| *count > 0), "{counts:?}");
    }

    /// A report of which nobody knows whether it is true, so widened that nothing keeps clear of it, does not lead into the
    /// intruder whose place is known.
    #[test]
    fn a_volume_widened_beyond_all_sense_does_not_hide_a_known_one() {
        let known = sphere(1, (150.0, 0.0), (-20.0, 0.0));
        for aside_m in [-60.0, -20.0, 20.0, 60.0] {
            let forged = Obstacle {
                uncertainty: Uncertainty {
                    position_m: 100.0,
                    velocity_mps: 5.0,
                },
                ..sphere(2, (330.0, aside_m), (-100.0, 0.0))
            };
            let rows = [known, forged];
            let (best, clear_m) = among(&rows, |avoider, _, now| {
                let best = avoider.best(None, &Maneuver::HOLD, now).unwrap();
                let (exact, flown) = ([known], avoider.tables.answer);
                let clear_m = among(&exact, |avoider, _, now| {
                    avoider.margin_of(&flown, now, (60.0, f64::MIN, ENOUGH_M))
                });
                (best, clear_m)
            });
            assert!(best.outcome != Outcome::Proven);
            assert!(clear_m > 0.0, "{aside_m} m: {clear_m} m");
        }
    }
}
