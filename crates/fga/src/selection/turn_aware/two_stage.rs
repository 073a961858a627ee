//! The search for the largest margin, over single turns and then over two of them.
//!
//! Sweeps over a coarse grid give one seed for each combination of sides and climb targets; each
//! seed then climbs by small linear programs: the margin of every obstacle is linear in the
//! parameters nearby, and the step in a box that lifts the least of them most is taken.

use crate::angle::Side;
use crate::maneuver::{Maneuver, MotionState, certify_all, whole};

use super::ascent::Ascent;
use super::sweep::Leave;
use super::{ENOUGH_M, Found, MAX_TURN_RAD, Search, SecondTurn, Turns};

/// Straight times between two turns that are searched, seconds from the end of the first.
const GAPS_S: [f64; 6] = [0.0, 0.7, 1.5, 2.5, 4.0, 6.5];

/// The same in the plane, where there are fewer manoeuvres to look at.
const PLANAR_GAPS_S: [f64; 11] = [0.0, 0.3, 0.6, 1.0, 1.4, 1.9, 2.5, 3.2, 4.2, 5.5, 7.5];

/// Steps of the first turn between two departures to the second.
const STRIDE: usize = 2;

/// Most departures of an arc.
const DEPARTURES: usize = 20;

/// Widest range of first turns of which one seed is kept, radians.
const BIN_RAD: f64 = 0.6;

/// Such ranges.
const BINS: usize = 6;

/// Largest first turn of a two-stage manoeuvre, radians.
const MAX_FIRST_TURN_RAD: f64 = 3.4;

/// Most climb targets of a stage.
const CLIMBS: usize = 3;

/// Combinations of sides and climb targets of one stage.
const KINDS_OF_ONE: usize = 2 * CLIMBS;

/// Those of one stage, of two in each range of first turns, and the manoeuvre under way.
const KINDS: usize = KINDS_OF_ONE + KINDS_OF_ONE * KINDS_OF_ONE * BINS + 1;

/// Seeds that lie this far below the best one are not worth a look, metres.
const WORTH_M: f64 = 8.0;

/// A second turn never gains more than about 9 m: where the best single one lacks more than this,
/// none is looked for, metres.
const MOST_GAIN_M: f64 = 14.0;

/// Groups of seeds that climb in successive searches.
const VARIETIES: usize = 4;

/// Seeds that climb.
const CLIMBERS: usize = 24;

/// How hard to look for the largest margin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Single turns, and what is near the manoeuvre under way.
    Quick,
    /// All two-stage manoeuvres of a grid too.
    Full,
}

/// Whether both turns have one climb target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Climbs {
    Same,
    Different,
}

/// The best manoeuvre of each kind.
struct Seeds {
    found: [Option<Found>; KINDS],
    best_m: f64,
}

impl Seeds {
    const fn new() -> Self {
        Self {
            found: [None; KINDS],
            best_m: f64::MIN,
        }
    }

    fn floor_m(&self) -> f64 {
        self.best_m - WORTH_M
    }

    fn floor_of_m(&self, kind: usize) -> f64 {
        let held = self.found.get(kind).copied().flatten();
        held.map_or(f64::MIN, |held| held.margin_m)
            .max(self.floor_m())
    }

    fn take(&mut self, kind: usize, found: Found) {
        self.best_m = self.best_m.max(found.margin_m);
        if let Some(slot) = self.found.get_mut(kind)
            && slot.is_none_or(|held| found.margin_m > held.margin_m)
        {
            *slot = Some(found);
        }
    }

    /// Takes out the best one that is left.
    fn pop(&mut self) -> Option<Found> {
        let best = self
            .found
            .iter_mut()
            .filter(|slot| slot.is_some())
            .max_by(|a, b| margin(a.as_ref()).total_cmp(&margin(b.as_ref())))?;
        best.take()
    }
}

fn margin(slot: Option<&Found>) -> f64 {
    slot.map_or(f64::MIN, |found| found.margin_m)
}

impl Search<'_> {
    /// The manoeuvre with the largest margin, single or two-stage; ends as soon as one is
    /// certified. `flown` is the one under way, from which it climbs too; with `effort`
    /// [`Effort::Quick`] two-stage manoeuvres are looked for near that one only.
    /// Successive searches with another `variety` climb from other seeds.
    pub fn best(
        &mut self,
        flown: Option<&Maneuver>,
        effort: Effort,
        variety: u32,
    ) -> Option<Found> {
        let target_m = self.scene.target_m;
        let mut best: Option<Found> = None;
        let mut seeds = Seeds::new();
        let start = self.scene.start;
        if let Some(found) = flown.and_then(|flown| self.in_terms_of_search(flown)) {
            seeds.take(KINDS - 1, found);
        }
        self.collect_single(&start, &mut seeds);
        self.climb(&mut seeds, KINDS_OF_ONE, &mut best);
        let decided = best.is_some_and(|best| {
            best.margin_m >= target_m || best.margin_m < target_m - MOST_GAIN_M
        });
        if effort == Effort::Quick || decided {
            return best;
        }
        self.collect_double(&start, &mut seeds);
        for _ in 0..(variety as usize % VARIETIES) * CLIMBERS / VARIETIES {
            seeds.pop();
        }
        self.climb(&mut seeds, CLIMBERS, &mut best);
        best
    }

    /// The manoeuvre under way in the terms of the search.
    fn in_terms_of_search(&mut self, flown: &Maneuver) -> Option<Found> {
        let start = self.scene.start;
        let (first, second) = match flown.stages() {
            [first] => (first, None),
            [first, second] => (first, Some(second)),
            _ => return None,
        };
        let turns = Turns {
            wait_s: first.start_s,
            turn_rad: first.course_rad - start.course_rad,
            climb_rad: first.climb_rad,
            second: second.map(|second| SecondTurn {
                after_s: second.start_s - first.start_s,
                turn_rad: second.course_rad - first.course_rad,
                climb_rad: second.climb_rad,
            }),
        };
        let margin_m = self.certify(&turns, &start, f64::MIN).margin_m;
        let cost = self.cost(&turns, &start);
        Some(Found {
            turns,
            margin_m,
            cost,
        })
    }

    /// Lets the best seeds climb; ends at the first that is certified.
    fn climb(&mut self, seeds: &mut Seeds, count: usize, best: &mut Option<Found>) {
        for _ in 0..count {
            let Some(seed) = seeds.pop() else { return };
            let found = Ascent::new(seed).run(self);
            if best.is_none_or(|best| found.margin_m > best.margin_m) {
                *best = Some(found);
            }
            if found.margin_m >= self.scene.target_m || self.limit_met() {
                return;
            }
        }
    }

    fn collect_single(&mut self, start: &MotionState, seeds: &mut Seeds) {
        let kinds = self
            .scene
            .extreme_climbs()
            .flat_map(|climb| Side::BOTH.map(|side| (climb, side)));
        for (kind, (climb_rad, side)) in kinds.enumerate() {
            let mut best: Option<Leave> = None;
            self.sweep(
                start,
                ENOUGH_M,
                side,
                climb_rad,
                MAX_TURN_RAD,
                f64::MIN,
                |leave| {
                    if best.is_none_or(|best| leave.margin_m > best.margin_m) {
                        best = Some(leave);
                    }
                    false
                },
            );
            if let Some(leave) = best {
                let turns = Turns {
                    wait_s: 0.0,
                    turn_rad: leave.turn_rad,
                    climb_rad,
                    second: None,
                };
                let cost = self.cost(&turns, start);
                seeds.take(
                    kind,
                    Found {
                        turns,
                        margin_m: leave.margin_m,
                        cost,
                    },
                );
            }
        }
    }

    fn collect_double(&mut self, start: &MotionState, seeds: &mut Seeds) {
        let mut departures = [[None; DEPARTURES]; KINDS_OF_ONE];
        let kinds = self
            .scene
            .extreme_climbs()
            .flat_map(|climb| Side::BOTH.map(|side| (climb, side)));
        let floor_m = seeds.floor_m();
        for ((climb_rad, side), row) in kinds.zip(&mut departures) {
            let mut index = 0;
            self.sweep(
                start,
                ENOUGH_M,
                side,
                climb_rad,
                MAX_FIRST_TURN_RAD,
                floor_m,
                |leave| {
                    if index % STRIDE == 0
                        && let Some(slot) = row.get_mut(index / STRIDE)
                    {
                        *slot = Some((leave, climb_rad));
                    }
                    index += 1;
                    false
                },
            );
        }
        // What most often does comes first, so that what is left out when the work is used up is
        // the rest: one climb target for both turns, coarsely, then finely, then two of them.
        let passes = [
            (0, Climbs::Same),
            (1, Climbs::Same),
            (0, Climbs::Different),
            (1, Climbs::Different),
        ];
        for (parity, climbs) in passes {
            for place in (parity..DEPARTURES).step_by(2) {
                for (kind, row) in departures.iter().enumerate() {
                    let Some((leave, climb_rad)) = row.get(place).copied().flatten() else {
                        continue;
                    };
                    self.second_turns(start, (kind, climb_rad), &leave, climbs, seeds);
                    if self.sweeps_done() || seeds.best_m >= self.scene.target_m {
                        return;
                    }
                }
            }
        }
    }

    /// All second turns after the first one, over the gaps between them.
    fn second_turns(
        &mut self,
        start: &MotionState,
        (first_kind, first_climb): (usize, f64),
        leave: &Leave,
        climbs: Climbs,
        seeds: &mut Seeds,
    ) {
        let scene = self.scene;
        if climbs == Climbs::Different && scene.is_planar() {
            return;
        }
        let gaps: &[f64] = if scene.is_planar() {
            &PLANAR_GAPS_S
        } else {
            &GAPS_S
        };
        let bin = BINS.min(whole(leave.turn_rad.abs() / BIN_RAD, BINS)) - 1;
        for gap_s in gaps.iter().copied() {
            let at_s = leave.state.time_s + gap_s;
            let first = Turns {
                wait_s: start.time_s,
                turn_rad: leave.turn_rad,
                climb_rad: first_climb,
                second: None,
            };
            let maneuver = self.maneuver(&first, start);
            self.path
                .predict(scene.flyer, &scene.start, &maneuver, scene.horizon_s);
            let floor_m = seeds.floor_m();
            let before = certify_all(
                scene.flyer,
                self.path,
                scene.hazards,
                at_s,
                floor_m,
                ENOUGH_M,
            );
            self.count_work(self.path.nodes().len());
            let before_m = before.margin_m;
            if before_m <= floor_m {
                return;
            }
            let Some(from) = self.path.state_at(scene.flyer, at_s) else {
                return;
            };
            let kinds = scene
                .extreme_climbs()
                .flat_map(|climb| Side::BOTH.map(|side| (climb, side)));
            for (kind, (climb_rad, side)) in kinds.enumerate() {
                if (climb_rad == first_climb) != (climbs == Climbs::Same) {
                    continue;
                }
                let kind = KINDS_OF_ONE + (first_kind * KINDS_OF_ONE + kind) * BINS + bin;
                let floor_m = seeds.floor_of_m(kind);
                let mut best: Option<Leave> = None;
                self.sweep(
                    &from,
                    before_m,
                    side,
                    climb_rad,
                    MAX_FIRST_TURN_RAD,
                    floor_m,
                    |leave| {
                        if best.is_none_or(|best| leave.margin_m > best.margin_m) {
                            best = Some(leave);
                        }
                        leave.margin_m >= scene.target_m
                    },
                );
                let Some(last) = best.filter(|best| best.margin_m > floor_m) else {
                    continue;
                };
                let after_s = at_s - start.time_s;
                let second = SecondTurn {
                    after_s,
                    turn_rad: last.turn_rad,
                    climb_rad,
                };
                let turns = Turns {
                    second: Some(second),
                    ..first
                };
                let cost = self.cost(&turns, start);
                seeds.take(
                    kind,
                    Found {
                        turns,
                        margin_m: last.margin_m,
                        cost,
                    },
                );
                if last.margin_m >= scene.target_m {
                    return;
                }
            }
        }
    }
}
