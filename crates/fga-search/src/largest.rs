//! The manoeuvre with the largest margin: where none is certified yet.
//!
//! Rows yield seeds: single turns as flown, last turns of two by the lines on which they end. The best seeds climb by small
//! linear programs ([`super::ascent`]), a little from many and on from the best.

use crate::Side;
use fga_proof::maneuver::Stage;
use fga_proof::meter::COMPARED;

use super::climbs::{Ascent, Climbs, Seed, sort};
use super::lattice::{Prefix, Row};
use super::tuned::{FAR, GAPS, LEVEL_AFTER, PARTS, ROUNDS, SEEDS, STEP_RAD, WORTH_A_CLIMB};
use super::{ENOUGH_M, Found, MAX_TURN_RAD, Outcome, Search, SecondTurn, Turns};

/// The work of filling the seeds.
const SEEDS_WORK: usize = 8;

/// The largest first turn of two, in steps: a little more than half a turn.
const FIRST_STEPS: u32 = 17;

/// The same, radians.
const MOST_FIRST_RAD: f64 = FIRST_STEPS as f64 * STEP_RAD;

/// The margin of a seed, metres; without a seed the least number.
fn margin_m(slot: Option<&Seed>) -> f64 {
    slot.map_or(f64::MIN, |seed| seed.margin_m)
}

impl Search<'_> {
    /// The manoeuvre with the largest margin; ends as soon as one is certified. `flown` is the present one, from which it also
    /// climbs. The two-turn rows have [`GRIDS_A_SEARCH`](crate::GRIDS_A_SEARCH) parts, of which `most` are looked at; without any it is a
    /// single turn, or near `flown`. Searches with another `variety` begin with another part.
    pub fn best(
        &mut self,
        flown: Option<Turns>,
        most: u32,
        variety: u32,
    ) -> Option<(Found, Outcome)> {
        self.on_board(SEEDS_WORK, |search, board| {
            search.best_among(board.climbs()?, (flown, most, variety))
        })
    }

    fn best_among(
        &mut self,
        climbs: &mut Climbs,
        (flown, most, variety): (Option<Turns>, u32, u32),
    ) -> Option<(Found, Outcome)> {
        self.grids = most.min(1);
        let hazards = self.scene.around.rows;
        let target_m = self.scene.target_m;
        // A volume that grows with uncertainty may be too large today and not tomorrow.
        let is_certain = hazards.iter().all(|hazard| hazard.growth_mps == 0.0)
            && self.scene.around.fixed.is_empty();
        let (mut best, mut work) = (None::<Found>, 0);
        for round in 0..=most {
            // A part that may not be finished is left to the next search.
            if self.meter.left() < work {
                break;
            }
            let begin = self.meter.done();
            climbs.clear(0);
            if let Some(part) = round.checked_sub(1) {
                self.grids = round;
                let least_m = best.map_or(f64::MIN, |best| best.margin_m - self.far_m());
                self.two_turns((variety + part) % PARTS, least_m, climbs);
                self.fly_best(climbs);
            } else {
                if let Some(turns) = flown {
                    let margin_m = self.flown_m(&turns, f64::MIN);
                    climbs.take(Seed { turns, margin_m });
                }
                self.single_turns(climbs);
                if most > 0 && hazards.iter().any(|hazard| hazard.is_cylinder()) {
                    self.levelled(climbs);
                }
            }
            self.climb(climbs, &mut best);
            let found = best?;
            if found.margin_m >= target_m {
                let open = (found, Outcome::Open);
                return Some(self.proven(found).unwrap_or(open));
            }
            if round > 0 {
                work = self.meter.done() - begin;
                if is_certain && found.margin_m < target_m - FAR * self.scene.turn_radius_m() {
                    return Some((found, Outcome::Hopeless));
                }
            }
            if self.answering || round > 0 && self.limit_met() {
                break;
            }
        }
        best.map(|found| (found, Outcome::Open))
    }

    /// The margin of a manoeuvre as it is flown, metres.
    fn flown_m(&mut self, turns: &Turns, floor_m: f64) -> f64 {
        self.certify(turns, self.scene.start.course_rad, floor_m)
            .proven_m()
    }

    /// Flies a manoeuvre, which replaces the best one of its row if its margin is larger.
    fn fly_seed(&mut self, turns: Turns, best: &mut Option<Seed>) {
        let least_m = margin_m(best.as_ref());
        let margin_m = self.flown_m(&turns, least_m);
        if margin_m > least_m {
            *best = Some(Seed { turns, margin_m });
        }
    }

    /// The best single turn of each row, each with its share of the work.
    #[inline(never)]
    fn single_turns(&mut self, climbs: &mut Climbs) {
        let prefix = self.after_wait(0.0);
        let sides = |climb_rad| Side::BOTH.map(|side| (climb_rad, side));
        let rows = self.scene.extreme_climbs().flat_map(sides);
        let parts = u32::try_from(rows.clone().count()).unwrap_or(u32::MAX);
        for (parts, (climb_rad, side)) in (1..=parts).rev().zip(rows) {
            let until = self.meter.done() + self.meter.left().checked_div(parts).unwrap_or(0);
            let Some(row) = self.row(&prefix, climb_rad, side) else {
                continue;
            };
            let mut best: Option<Seed> = None;
            self.scan(
                &prefix,
                row,
                (MAX_TURN_RAD, f64::MIN, until),
                &mut |search, row, line_m| {
                    if line_m > margin_m(best.as_ref()) {
                        search.fly_seed(prefix.turns(row), &mut best);
                    }
                    margin_m(best.as_ref())
                },
            );
            if let Some(best) = best {
                climbs.take(best);
            }
        }
    }

    /// Climbs and descents straight ahead that level off again: between layers of airspace the aircraft can hold no climb angle.
    #[inline(never)]
    fn levelled(&mut self, climbs: &mut Climbs) {
        let level_rad = self.scene.original.1;
        for climb_rad in self.scene.extreme_climbs().skip(1) {
            let mut best: Option<Seed> = None;
            for radii in LEVEL_AFTER {
                if self.limit_met() {
                    return;
                }
                let turns = Turns {
                    wait_s: 0.0,
                    turn_rad: 0.0,
                    climb_rad,
                    second: Some(SecondTurn {
                        after_s: radii / self.scene.flyer.course_rate_radps(),
                        turn_rad: 0.0,
                        climb_rad: level_rad,
                    }),
                };
                self.fly_seed(turns, &mut best);
            }
            if let Some(best) = best {
                climbs.take(best);
            }
        }
    }

    /// Seeds this far below the best one are not worth a climb, metres.
    fn far_m(&self) -> f64 {
        WORTH_A_CLIMB * self.scene.turn_radius_m()
    }

    /// Second turns after a part of the first ones and some gaps, with a larger margin than `least_m`.
    #[inline(never)]
    fn two_turns(&mut self, part: u32, least_m: f64, climbs: &mut Climbs) {
        // A third is for flights and climbs.
        let until = self.meter.done() + self.meter.left() / 3 * 2;
        for place in (part..=FIRST_STEPS).step_by(PARTS as usize) {
            for climb_rad in self.scene.extreme_climbs() {
                for side in Side::BOTH {
                    let turn_rad = side.sign() * STEP_RAD * f64::from(place);
                    // Without a turn both sides are the same.
                    if (place > 0 || side == Side::Left) && self.meter.done() < until {
                        self.second_turns((turn_rad, climb_rad), side, least_m, climbs);
                    }
                }
            }
        }
    }

    /// The best second turn to each side after a first one, over the gaps between them.
    #[inline(never)]
    fn second_turns(&mut self, first: (f64, f64), side: Side, least_m: f64, climbs: &mut Climbs) {
        let scene = self.scene;
        let (turn_rad, climb_rad) = first;
        let bank_rad = side.sign() * scene.start.bank_rad;
        let exit = self
            .bend(bank_rad, side)
            .and_then(|bend| bend.exit(scene.flyer, turn_rad.abs().max(bend.least_rad())));
        let Some(exit) = exit else { return };
        let rate_radps = scene.flyer.course_rate_radps();
        let mut best: [Option<Seed>; 2] = [None; 2];
        let floor_m = climbs.floor_m().max(least_m);
        let longest_s = exit.begins_s + GAPS.last().unwrap_or(&0.0) / rate_radps;
        let (flyer, start, meter) = (scene.flyer, &scene.start, &self.meter);
        (self.maneuver.edit()).set([Stage::turn(0.0, start.course_rad + turn_rad, climb_rad)]);
        (self.path).predict_within(flyer, start, self.maneuver, longest_s + 1.0, meter);
        for gap in GAPS {
            let after_s = exit.begins_s + gap / rate_radps;
            let prefix = self.after_first(first, after_s);
            let before = self.certify_path(after_s, (floor_m, ENOUGH_M));
            let before_m = before.proven_m();
            if before_m <= floor_m {
                break;
            }
            for (other, best) in Side::BOTH.into_iter().zip(&mut best) {
                // To the same side without a gap it is a single turn.
                if gap == 0.0 && other == side {
                    continue;
                }
                let Some(row) = self.row(&prefix, climb_rad, other) else {
                    continue;
                };
                self.scan(
                    &prefix,
                    row,
                    (MOST_FIRST_RAD, floor_m, u32::MAX),
                    &mut |_, row, line_m| {
                        let margin_m = line_m.min(before_m);
                        let least_m = best.map_or(floor_m, |best| best.margin_m);
                        if margin_m > least_m && row.at_rad != 0.0 {
                            let turns = prefix.turns(row);
                            *best = Some(Seed { turns, margin_m });
                        }
                        best.map_or(floor_m, |best| best.margin_m)
                    },
                );
            }
        }
        for best in best.into_iter().flatten() {
            climbs.take(best);
        }
    }

    /// Visits turns of a row at moderate steps, until a margin reaches the target or the work `until`. `visit` gets the row at a turn and the
    /// margin of its line, and returns the margin that the next ones must exceed.
    #[inline(never)]
    fn scan(
        &mut self,
        prefix: &Prefix,
        mut row: Row,
        (most_rad, mut floor_m, until): (f64, f64, u32),
        visit: &mut dyn FnMut(&mut Self, &Row, f64) -> f64,
    ) {
        while row.at_rad <= most_rad && !self.limit_met() && self.meter.done() < until {
            let Some(tangent) = self.line(prefix, &row) else {
                return;
            };
            let Some(look) = self.look(&tangent, (floor_m, ENOUGH_M)) else {
                return;
            };
            floor_m = visit(self, &row, look.margin_m);
            let short_m = floor_m - look.margin_m;
            row.at_rad += (2.0 * STEP_RAD).max(self.least_more_rad(short_m, look.left_s));
            if floor_m >= self.scene.target_m {
                return;
            }
        }
    }

    /// Flies the best seeds and keeps those near the best, with the margins of their flights.
    #[inline(never)]
    fn fly_best(&mut self, climbs: &mut Climbs) {
        let far_m = self.far_m();
        let (mut best_m, mut flown) = (f64::MIN, 0);
        for _ in 0..SEEDS {
            let is_given = !self.limit_met() && self.meter.take(SEEDS / COMPARED);
            let Some(seed) = is_given.then(|| climbs.best_at(flown)).flatten() else {
                break;
            };
            seed.margin_m = self.flown_m(&seed.turns, best_m - far_m).max(f64::MIN);
            best_m = best_m.max(seed.margin_m);
            flown += 1;
        }
        climbs.clear(flown);
    }

    /// Climbs from the best seeds: a few steps from all, more from the best. The first round with certified ones ends the climb, with
    /// the cheapest of them.
    fn climb(&mut self, climbs: &mut Climbs, best: &mut Option<Found>) {
        climbs.begin(&self.meter);
        let Climbs { seeds, climbers } = climbs;
        let seed_of = |climber: &Ascent| {
            let seed = seeds.get(usize::from(climber.seed));
            seed.filter(|_| climber.is_some())
        };
        for (most, steps) in ROUNDS {
            let mut cheapest: Option<Found> = None;
            for climber in climbers.iter_mut().take(most) {
                let Some(seed) = seed_of(climber) else {
                    continue;
                };
                if self.limit_met() {
                    break;
                }
                climber.climb(self, steps);
                if climber.least_m() >= self.scene.target_m {
                    let found = climber.certified(self, seed);
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
            sort(climbers);
        }
        if self.limit_met() {
            if best.is_some() {
                return;
            }
            self.answer();
        }
        let highest = climbers
            .iter()
            .find_map(|it| seed_of(it).map(|of| (it, of)));
        if let Some((highest, seed)) = highest {
            let found = highest.certified(self, seed);
            if best.is_none_or(|best| found.margin_m > best.margin_m) {
                *best = Some(found);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tables;
    use crate::tests::scene;
    use fga_mission::Turner;
    use fga_proof::Vec3;
    use fga_proof::maneuver::Maneuver;
    use fga_proof::meter::Meter;
    use fga_proof::prediction::{FlightPath, MotionState};
    use fga_proof::situation::ProtectedVolume;
    use fga_proof::vehicle::Vehicle;

    #[test]
    fn where_nothing_keeps_clear_no_single_turn_keeps_clearly_more() {
        for lag_s in [0.0, 0.6] {
            let vehicle = Vehicle::lagged(lag_s);
            let flyer = Turner::new(&vehicle);
            let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
            let place_m = Vec3::new(vehicle.airspeed_mps, 6.0, 2.0);
            let hazards = [fga_proof::certificate::Hazard::exact(
                0,
                place_m,
                Vec3::ZERO,
                volume,
            )];
            let nominal = Maneuver::hold();
            let start = MotionState::ahead(0.0);
            let scene = scene(&flyer, &vehicle, (start, &nominal), &hazards);
            let (mut path, mut tables) = (FlightPath::new(), Tables::NONE);
            let mut search = Search::new(
                &scene,
                (&mut path, &mut tables),
                Meter::new(100_000, u32::MAX),
            );
            let (found, proof) = search.best(None, PARTS, 0).unwrap();
            assert_eq!(proof, Outcome::Hopeless);
            // The search may have used up its work.
            let (mut path, mut tables) = (FlightPath::new(), Tables::NONE);
            let mut judge = Search::new(
                &scene,
                (&mut path, &mut tables),
                Meter::new(1_000_000, u32::MAX),
            );
            for climb_rad in scene.extreme_climbs() {
                for k in -30..=30 {
                    let turns = Turns {
                        wait_s: 0.0,
                        turn_rad: 0.1 * f64::from(k),
                        climb_rad,
                        second: None,
                    };
                    let margin_m = judge.certify(&turns, start.course_rad, f64::MIN).margin_m;
                    assert!(margin_m < found.margin_m + 0.3, "{margin_m} {found:?}");
                }
            }
        }
    }
}
