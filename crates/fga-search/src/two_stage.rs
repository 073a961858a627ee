//! The search for the largest margin, over single turns and then over two of them.
//!
//! Sweeps over a coarse grid give one seed for each combination of sides and climb targets; each
//! seed then climbs by small linear programs: the margin of every obstacle is linear in the
//! parameters nearby, and the step in a box lifts the least of them most.

mod seeds;

use fga_proof::angle::Side;
use fga_proof::certificate::{Asked, Certificate, Hazard, Hazards, Status, certify_set};
use fga_proof::maneuver::Maneuver;
use fga_proof::meter::COMPARED;
use fga_proof::prediction::{Flyer, MotionState, Target, flown, whole};

use super::ascent::Ascent;
use super::sweep::{Leave, Sweep};
use super::{ENOUGH_M, Found, MAX_TURN_RAD, Proof, Scene, Search, SecondTurn, Turns};

use seeds::Seeds;

/// Straight flight between the two turns of a search, in turn radii.
const GAPS: [f64; 6] = [0.0, 0.35, 0.75, 1.25, 2.0, 3.25];

/// The same in the plane, with fewer manoeuvres.
const PLANAR_GAPS: [f64; 10] = [0.0, 0.25, 0.5, 0.75, 1.0, 1.3, 1.65, 2.1, 2.75, 3.75];

/// Steps of an arc between two ends of first turns.
const STRIDE: usize = 2;

/// Most ends of first turns on an arc.
const PLACES: usize = 20;

/// One grid has every n-th of them.
const COARSE: usize = 4;

/// One grid has every n-th of the straight times.
const GAP_SHIFTS: usize = 2;

/// Grids that interleave.
const GRIDS: usize = COARSE * GAP_SHIFTS;

/// Grids of a whole search. In 36,000 encounters of the campaigns the first one found 133 manoeuvres, the next two 17 and the
/// fourth none; in encounters that were lost once 37, 10 and 2.
pub const GRIDS_A_SEARCH: u32 = 4;

/// A search begins this many grids after the last one.
const STRIDE_OF_GRIDS: usize = 3;

/// When a climb or descent straight ahead levels off, in turn radii.
const LEVEL_AFTER: [f64; 10] = [0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0];

/// Widest range of first turns with one seed, radians.
const BIN_RAD: f64 = 0.6;

/// Number of such ranges.
const BINS: usize = 6;

/// Largest first turn of a two-stage manoeuvre, radians.
const MAX_FIRST_TURN_RAD: f64 = 3.4;

/// Most climb targets of a stage.
const CLIMBS: usize = 3;

/// Combinations of sides and climb targets of one stage.
const KINDS_OF_ONE: usize = 2 * CLIMBS;

/// Those of one stage, of two turns in each range of first turns, of a climb that levels off, and the manoeuvre under way.
const KINDS: usize = KINDS_OF_ONE + KINDS_OF_TWO + CLIMBS + 1;

/// Combinations of the first turn's side and climb target with the second turn's side, in each range of first turns. The second
/// turn keeps the climb target: 1,800 grids with another one found nothing, and climbing parts them where that helps.
const KINDS_OF_TWO: usize = 2 * KINDS_OF_ONE * BINS;

/// Seeds are turns this far apart, radians: climbing makes up for it.
const COARSE_RAD: f64 = 0.15;

/// Seeds this far below the best one are not worth a climb, turn radii.
const WORTH: f64 = 0.27;

/// If single turns stay this far short of clearing a lone obstacle, no manoeuvre clears it, turn
/// radii.
const ALONE: f64 = 0.0033;

/// If the first grid ends this far short, or one after it, turn radii, others hardly ever find something. In drawn encounters
/// those with which others did were within 0.14 and 0.04; with 0.2 and 0.1 one that was made to be hard is lost.
const FAR: (f64, f64) = (0.3, 0.2);

/// Seeds that climb a little; the best of them continue.
const CLIMBERS: usize = 16;

/// Number of seeds that continue in each round, and of steps.
const ROUNDS: [(usize, u32); 4] = [(CLIMBERS, 2), (CLIMBERS / 2, 4), (3, 8), (1, 16)];

/// Single turns that climb.
const SINGLES: usize = 5;

/// The same for single turns.
const SINGLE_ROUNDS: [(usize, u32); 3] = [(CLIMBERS, 2), (3, 4), (1, 16)];

/// Single turns that lack no more than this are looked for again with bank lag, turn radii.
const NEARLY: f64 = 0.05;

/// The effort for the largest margin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Single turns, and the surroundings of the present manoeuvre.
    Quick,
    /// Also the two-stage manoeuvres of some grids, at least one.
    Grids(u32),
}

impl Effort {
    /// A whole search.
    pub const WHOLE: Self = Self::Grids(GRIDS_A_SEARCH);
}

/// Ends of first turns with their climb targets, a row for each side and climb target.
type Departures = [[Option<Leave>; PLACES]; KINDS_OF_ONE];

fn height(climber: Option<&Ascent>) -> f64 {
    climber.map_or(f64::MIN, Ascent::least_m)
}

/// Removes climbers that have come to where a higher one is.
fn leave_one_of_each(climbers: &mut [Option<Ascent>; CLIMBERS]) {
    for place in 1..CLIMBERS {
        let (higher, rest) = climbers.split_at_mut(place);
        let Some(slot) = rest.first_mut() else { return };
        let meets = |lower: &Ascent| higher.iter().flatten().any(|one| one.meets(lower));
        if slot.as_ref().is_some_and(meets) {
            *slot = None;
        }
    }
}

/// The first or second turns of two from a state, with a climb angle and a side.
const fn outward(from: MotionState, (climb_rad, side): (f64, Side), floor_m: f64) -> Sweep {
    Sweep {
        from,
        first: None,
        before_m: ENOUGH_M,
        side,
        climb_rad,
        from_rad: f64::MIN,
        max_turn_rad: MAX_FIRST_TURN_RAD,
        floor_m,
        enough_m: ENOUGH_M,
    }
}

fn keep_larger(best: &mut Option<Found>, found: Found) {
    if best.is_none_or(|best| found.margin_m > best.margin_m) {
        *best = Some(found);
    }
}

impl Search<'_> {
    /// The manoeuvre with the largest margin, single or two-stage; ends as soon as one is
    /// certified. `flown` is the present one, from which it also climbs; with `effort`
    /// [`Effort::Quick`] it searches two-stage manoeuvres only near that one.
    /// Searches with another `variety` begin with another grid.
    pub fn best(
        &mut self,
        flown: Option<&Maneuver>,
        effort: Effort,
        variety: u32,
    ) -> Option<(Found, Proof)> {
        let target_m = self.scene.target_m;
        let mut best: Option<Found> = None;
        if !self.meter.take_table::<Seeds>() {
            return None;
        }
        let start = self.scene.start;
        self.coarse_rad = COARSE_RAD;
        let most = match effort {
            Effort::Quick => 0,
            Effort::Grids(most) => most.max(1),
        };
        self.grids = most.min(1);
        let mut seeds = Seeds::new(WORTH * self.scene.turn_radius_m());
        let has_layers = self.scene.hazards.rows().iter().any(Hazard::is_cylinder);
        if most > 0 && has_layers {
            // Few, and the only ones between layers: before the many, which may take all the work.
            self.collect_levelled(&start, &mut seeds);
            self.climb(&mut seeds, 2, &SINGLE_ROUNDS, &mut best);
            if let Some(found) = best.filter(|found| found.margin_m >= target_m) {
                return Some((found, self.prove(&found).into()));
            }
        }
        if let Some((turns, margin_m)) = flown.and_then(|flown| self.in_terms_of_search(flown)) {
            seeds.take(KINDS - 1, turns, margin_m);
        }
        let lags = !self.scene.flyer.is_ideal() && !self.limit_met();
        let without_lag = if lags && self.meter.take_table::<Flyer>() {
            self.scene.flyer.without_lag(&start)
        } else {
            None
        };
        let without_lag = without_lag.as_ref();
        self.without_lag(without_lag, |search| {
            search.collect_single(start.course_rad, &mut seeds);
        });
        self.climb(&mut seeds, SINGLES, &SINGLE_ROUNDS, &mut best);
        let short_m = target_m - best?.margin_m;
        if without_lag.is_some() && short_m > 0.0 && short_m < NEARLY * self.scene.turn_radius_m() {
            // Where so little is lacking, it matters from where they climb.
            self.collect_single(start.course_rad, &mut seeds);
            self.climb(&mut seeds, SINGLES, &SINGLE_ROUNDS, &mut best);
        }
        let found = best?;
        if found.margin_m >= target_m {
            return Some((found, self.prove(&found).into()));
        }
        if most == 0 || self.answering {
            return Some((found, Proof::Open));
        }
        // A volume that grows with uncertainty may be too large today and not tomorrow.
        let mut hazards = self.scene.hazards.rows().iter();
        let is_certain = hazards.all(|hazard| hazard.growth_mps == 0.0);
        if is_certain && (self.is_enclosed() || self.is_hopeless(&found, without_lag)) {
            return Some((found, Proof::Hopeless));
        }
        let departures = self.without_lag(without_lag, |search| search.departures(seeds.floor_m()));
        let mut far = FAR.0;
        for more in 0..most {
            self.grids = more + 1;
            let grid = (STRIDE_OF_GRIDS * variety as usize + more as usize) % GRIDS;
            self.without_lag(without_lag, |search| {
                search.collect_double(start.course_rad, &departures, grid, &mut seeds);
            });
            self.climb(&mut seeds, CLIMBERS, &ROUNDS, &mut best);
            let found = best?;
            if found.margin_m >= target_m {
                return Some((found, self.prove(&found).into()));
            }
            if is_certain && found.margin_m < target_m - far * self.scene.turn_radius_m() {
                return Some((found, Proof::Hopeless));
            }
            far = FAR.1;
            if self.limit_met() || self.answering {
                return Some((found, Proof::Open));
            }
        }
        best.map(|found| (found, Proof::Open))
    }

    /// Looks for seeds as an aircraft without bank lag would: with lag that takes several times the work, and climbing
    /// makes up for metres.
    fn without_lag<T>(
        &mut self,
        without_lag: Option<&(Flyer, MotionState)>,
        look: impl FnOnce(&mut Search<'_>) -> T,
    ) -> T {
        let Some((flyer, start)) = without_lag else {
            return look(self);
        };
        let scene = Scene {
            flyer,
            start: *start,
            ..self.scene
        };
        let mut search = Search::within(scene, self.path, self.meter.part(u32::MAX));
        search.coarse_rad = self.coarse_rad;
        let answer = look(&mut search);
        let (evaluated, work) = (search.evaluated, search.work());
        self.evaluated += evaluated;
        self.meter.count(work as usize);
        answer
    }

    /// Whether a lone obstacle defeats any second turn.
    ///
    /// From a lone obstacle the hardest turn and climb lead away farthest; a second turn helps
    /// only between several.
    fn is_hopeless(&mut self, found: &Found, without_lag: Option<&(Flyer, MotionState)>) -> bool {
        let scene = self.scene;
        let departure = self.departure(found.turns.wait_s);
        let maneuver = self.maneuver(&found.turns, &departure);
        scene.hazards.rows().iter().any(|hazard| {
            if self.limit_met() {
                return false;
            }
            self.predict(&maneuver);
            let asked = Asked {
                horizon_s: scene.horizon_s,
                floor_m: scene.target_m,
                enough_m: scene.target_m,
            };
            let one = core::slice::from_ref(hazard);
            let one = certify_set(scene.flyer, self.path, one, &asked, &self.meter);
            one.status == Status::BelowFloor && self.is_too_much(hazard, without_lag)
        })
    }

    /// Whether an obstacle would be unavoidable even if it were alone.
    fn is_too_much(&mut self, hazard: &Hazard, without_lag: Option<&(Flyer, MotionState)>) -> bool {
        let scene = self.scene;
        if !self.meter.take_table::<(Hazards, Seeds)>() {
            return false;
        }
        let mut alone = Hazards::new();
        alone.put(
            0,
            Hazard {
                index: 0,
                ..*hazard
            },
        );
        let scene_alone = Scene {
            hazards: &alone,
            ..scene
        };
        let meter = self.meter.part(u32::MAX);
        let mut search = Search::within(scene_alone, self.path, meter);
        search.coarse_rad = COARSE_RAD;
        let mut seeds = Seeds::new(WORTH * scene.turn_radius_m());
        let mut farthest = None;
        search.without_lag(without_lag, |search| {
            search.collect_single(scene.start.course_rad, &mut seeds);
        });
        search.climb(&mut seeds, 2, &SINGLE_ROUNDS, &mut farthest);
        let (evaluated, work) = (search.evaluated, search.work());
        let is_cut = search.limit_met();
        self.evaluated += evaluated;
        self.meter.count(work as usize);
        let short_m = ALONE * scene.turn_radius_m();
        !is_cut && farthest.is_some_and(|farthest| farthest.margin_m < scene.target_m - short_m)
    }

    /// The present manoeuvre in the terms of the search, and its margin, metres.
    fn in_terms_of_search(&mut self, flown: &Maneuver) -> Option<(Turns, f64)> {
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
        let margin_m = self.certify(&turns, &start, f64::MIN).proven_m();
        Some((turns, margin_m))
    }

    /// Climbs from the best seeds, a little from all and on from the best; ends with the round
    /// in which some are certified, with the cheapest of them.
    fn climb(
        &mut self,
        seeds: &mut Seeds,
        count: usize,
        rounds: &[(usize, u32)],
        best: &mut Option<Found>,
    ) {
        let mut climbers: [Option<Ascent>; CLIMBERS] = [None; CLIMBERS];
        for slot in climbers.iter_mut().take(count) {
            if !self.meter.take(KINDS / COMPARED) {
                break;
            }
            *slot = seeds.pop().map(|seed| Ascent::new(&seed, self.scene.flyer));
        }
        for (most, steps) in rounds.iter().copied() {
            let mut cheapest: Option<Found> = None;
            for climber in climbers.iter_mut().take(most).flatten() {
                if climber.is_done() {
                    continue;
                }
                if self.limit_met() {
                    break;
                }
                climber.climb(self, steps);
                if climber.least_m() >= self.scene.target_m {
                    let found = climber.certified(self);
                    if found.margin_m >= self.scene.target_m
                        && cheapest.is_none_or(|cheapest| found.cost < cheapest.cost)
                    {
                        cheapest = Some(found);
                    }
                }
            }
            if cheapest.is_some() {
                *best = cheapest;
                return;
            }
            climbers.sort_unstable_by(|a, b| height(b.as_ref()).total_cmp(&height(a.as_ref())));
            if self.meter.take(CLIMBERS * CLIMBERS / COMPARED) {
                leave_one_of_each(&mut climbers);
            }
        }
        if self.limit_met() {
            if best.is_some() {
                return;
            }
            self.answer();
        }
        if let Some(highest) = climbers.iter().flatten().next() {
            keep_larger(best, highest.certified(self));
        }
    }

    fn collect_single(&mut self, course_rad: f64, seeds: &mut Seeds) {
        for (kind, (climb_rad, side)) in self.scene.extreme_turns().enumerate() {
            if self.limit_met() && seeds.best_m > f64::MIN {
                return;
            }
            let from = self.at_first_turn(climb_rad);
            let floor_m = seeds.floor_m();
            let best = self.sweep(&Sweep {
                max_turn_rad: MAX_TURN_RAD,
                ..outward(from, (climb_rad, side), floor_m)
            });
            if let Some(leave) = best {
                let turns = Turns {
                    wait_s: 0.0,
                    turn_rad: from.course_rad + leave.turn_rad - course_rad,
                    climb_rad,
                    second: None,
                };
                seeds.take(kind, turns, leave.margin_m);
            }
        }
    }

    /// Climbs and descents straight ahead that level off again: for layers of airspace, where the aircraft can
    /// hold no climb angle.
    fn collect_levelled(&mut self, start: &MotionState, seeds: &mut Seeds) {
        let climbs = self.scene.extreme_climbs();
        let level_rad = self.scene.original.1;
        let rate_radps = self.scene.flyer.course_rate_radps();
        for (place, climb_rad) in climbs.enumerate().skip(1) {
            let kind = KINDS_OF_ONE + KINDS_OF_TWO + place;
            for radii in LEVEL_AFTER {
                if self.limit_met() {
                    return;
                }
                let turns = Turns {
                    wait_s: 0.0,
                    turn_rad: 0.0,
                    climb_rad,
                    second: Some(SecondTurn {
                        after_s: radii / rate_radps,
                        turn_rad: 0.0,
                        climb_rad: level_rad,
                    }),
                };
                let floor_m = seeds.floor_of_m(kind);
                let margin_m = self.certify(&turns, start, floor_m).proven_m();
                seeds.take(kind, turns, margin_m);
            }
        }
    }

    /// The aircraft at the start of the first turn, with the change of climb until then: only bank lag delays turns.
    fn at_first_turn(&self, climb_rad: f64) -> MotionState {
        let Scene { flyer, start, .. } = self.scene;
        if start.time_s == 0.0 {
            return start;
        }
        let flown_m = flyer.velocity_mps(&start) * start.time_s;
        let began = MotionState {
            time_s: 0.0,
            position_m: start.position_m - flown_m,
            ..start
        };
        let climb = Maneuver::turn(0.0, start.course_rad, climb_rad);
        flown(flyer, &began, &climb, start.time_s, &self.meter)
    }

    /// First turns and their ends, by side and climb target.
    fn departures(&mut self, floor_m: f64) -> Departures {
        let mut departures = [[None; PLACES]; KINDS_OF_ONE];
        if !self.meter.take_table::<Departures>() {
            return departures;
        }
        for ((climb_rad, side), row) in self.scene.extreme_turns().zip(&mut departures) {
            let mut places = row.iter_mut();
            let mut step = 0;
            let sweep = outward(self.at_first_turn(climb_rad), (climb_rad, side), floor_m);
            self.arc(&sweep, |leave| {
                // Without a turn both sides are the same.
                if step % STRIDE == 0
                    && let Some(place) = places.next()
                    && (step > 0 || side == Side::Left)
                {
                    *place = Some(leave);
                }
                step += 1;
            });
        }
        departures
    }

    fn collect_double(
        &mut self,
        course_rad: f64,
        departures: &Departures,
        grid: usize,
        seeds: &mut Seeds,
    ) {
        let (shift, gap_shift) = (grid % COARSE, grid / COARSE);
        for place in (shift..PLACES).step_by(COARSE) {
            for (kind, row) in departures.iter().enumerate() {
                let Some(leave) = row.get(place).copied().flatten() else {
                    continue;
                };
                self.second_turns(course_rad, &(kind, leave), gap_shift, seeds);
                if self.sweeps_done() {
                    return;
                }
            }
            // Both sides come first, so that neither is preferred.
            if seeds.best_m >= self.scene.target_m {
                return;
            }
        }
    }

    /// All second turns after the first one from a course, over the gaps between them.
    fn second_turns(
        &mut self,
        course_rad: f64,
        (first_kind, leave): &(usize, Leave),
        gap_shift: usize,
        seeds: &mut Seeds,
    ) {
        let scene = self.scene;
        let first_climb = leave.climb_rad;
        let gaps = if scene.is_planar() {
            &PLANAR_GAPS[..]
        } else {
            &GAPS
        };
        let bin = BINS.min(whole(leave.turn_rad.abs() / BIN_RAD, BINS)) - 1;
        let start = scene.start;
        let on = Target {
            course_rad: start.course_rad + leave.turn_rad,
            climb_rad: first_climb,
            rate_share: 1.0,
        };
        let first = Turns {
            wait_s: 0.0,
            turn_rad: on.course_rad - course_rad,
            climb_rad: first_climb,
            second: None,
        };
        let mut before = Certificate::clear(leave.before_m);
        let mut from = leave.state;
        for gap in gaps.iter().skip(gap_shift).step_by(GAP_SHIFTS) {
            let floor_m = seeds.floor_m();
            let at_s = leave.state.time_s + gap / scene.flyer.course_rate_radps();
            from = self.fly_until(&from, &on, at_s, floor_m, &mut before);
            let before_m = before.margin_m;
            if before_m <= floor_m {
                return;
            }
            for (second_kind, side) in Side::BOTH.into_iter().enumerate() {
                // To the same side without a gap it is a single turn.
                if *gap == 0.0 && side.sign() * leave.turn_rad >= 0.0 {
                    continue;
                }
                let kind = KINDS_OF_ONE + (2 * first_kind + second_kind) * BINS + bin;
                let floor_m = seeds.floor_of_m(kind);
                let last = self.sweep(&Sweep {
                    before_m,
                    enough_m: scene.target_m,
                    ..outward(from, (first_climb, side), floor_m)
                });
                // Without a second turn it is a single turn.
                let Some(last) = last.filter(|last| last.turn_rad != 0.0) else {
                    continue;
                };
                let mut turns = first;
                turns.second = Some(SecondTurn {
                    after_s: at_s - start.time_s,
                    turn_rad: last.turn_rad,
                    climb_rad: first_climb,
                });
                seeds.take(kind, turns, last.margin_m);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::scene;
    use fga_proof::Vec3;
    use fga_proof::prediction::FlightPath;
    use fga_proof::situation::ProtectedVolume;
    use fga_proof::vehicle::Vehicle;

    #[test]
    fn where_nothing_keeps_clear_single_turns_find_about_the_largest_margin() {
        for lag_s in [0.0, 0.6] {
            let vehicle = Vehicle::lagged(lag_s);
            let flyer = Flyer::new(&vehicle);
            let mut hazards = Hazards::new();
            let place_m = Vec3::new(vehicle.airspeed_mps, 6.0, 2.0);
            let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
            hazards.put(0, Hazard::exact(0, place_m, Vec3::ZERO, volume));
            let other_m = Vec3::new(8.0 * vehicle.airspeed_mps, 0.0, 0.0);
            hazards.put(1, Hazard::exact(1, other_m, Vec3::ZERO, volume));
            let nominal = Maneuver::hold();
            let start = MotionState::ahead(0.0);
            let scene = scene(&flyer, &vehicle, (start, &nominal), &hazards);
            let mut path = FlightPath::new();
            let mut search = Search::new(scene, &mut path, u32::MAX);
            let (found, proof) = search.best(None, Effort::WHOLE, 0).unwrap();
            assert_eq!(proof, Proof::Hopeless);
            // Without a grid of two turns.
            assert!(search.evaluated < 30, "{}", search.evaluated);
            for (climb_rad, side) in scene.extreme_turns() {
                for k in 0..30 {
                    let turns = Turns {
                        wait_s: 0.0,
                        turn_rad: side.sign() * 0.1 * f64::from(k),
                        climb_rad,
                        second: None,
                    };
                    let margin_m = search.certify(&turns, &start, f64::MIN).margin_m;
                    assert!(margin_m < found.margin_m + 0.3, "{margin_m} {found:?}");
                }
            }
        }
    }
}
