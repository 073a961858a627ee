//! The cheapest certified manoeuvre, best first over rows.
//!
//! The row that may cost least is next. Its lines rule out turns up to about the first that may stay clear; if the row may still cost
//! least, that turn is flown. Where the flight is not certified, it rules out more of the row. The search ends once no row may cost
//! less than the best manoeuvre so far.

use core::f64::consts::FRAC_PI_2;

use crate::Side;
use fga_proof::assumptions::Assumptions;
use fga_proof::certificate::{STEEPEST, certify_set};
use fga_proof::meter::COMPARED;
use fga_proof::prediction::{CHORD_BOW_M, MotionState};

use super::lattice::{Lattice, Prefix, ROWS, Row};
use super::line::Tangent;
use super::tuned::{
    ASIDE_RAD, BEYOND_RAD, CLIMBS_A_SIDE, LEVEL_AFTER, NEAR, STARTS, STEP_RAD, WORTH,
};
use super::{Departure, Found, MAX_TURN_RAD, Objective, Search};

/// Improving a certified manoeuvre may take one part in this many of the work that is left.
const IMPROVES: u32 = 32;

/// The work of filling a lattice.
const LATTICE_WORK: usize = 33;

/// Halvings of the latest start.
const HALVINGS: u32 = 6;

/// The manoeuvre that a search looks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Aim {
    /// Any certified manoeuvre.
    Any,
    /// The cheapest one.
    Cheapest,
    /// The one that departs least, to each side.
    LeastDeparture,
}

impl Search<'_> {
    /// The cheapest certified single turn that begins after `wait_s`.
    pub fn cheapest(&mut self, wait_s: f64) -> Option<Found> {
        self.cheapest_to(&Side::BOTH, wait_s)
    }

    /// The cheapest certified single turn to one of some sides.
    pub fn cheapest_to(&mut self, sides: &[Side], wait_s: f64) -> Option<Found> {
        self.in_lattice(|search, lattice| {
            let climbs = &mut search.scene.climbs(CLIMBS_A_SIDE);
            search.turns_after(lattice, wait_s, sides, climbs, MAX_TURN_RAD);
            let [found, other] = search.best_first(lattice, Aim::Cheapest);
            found.or(other)
        })
    }

    /// Looks for something in an empty lattice; finds none if the meter refuses it.
    fn in_lattice<T: Default>(&mut self, look: impl FnOnce(&mut Self, &mut Lattice) -> T) -> T {
        self.on_board(LATTICE_WORK, |search, board| {
            let Some(lattice) = board.lattice() else {
                return T::default();
            };
            lattice.clear();
            look(search, lattice)
        })
    }

    /// Whether a certified single turn of at most `max_turn_rad` exists after a wait, at the original climb angle or at the
    /// steepest climb or descent.
    pub fn is_avoidable_within(&mut self, wait_s: f64, max_turn_rad: f64) -> bool {
        self.in_lattice(|search, lattice| {
            let climbs = &mut search.scene.extreme_climbs();
            search.turns_after(lattice, wait_s, &Side::BOTH, climbs, max_turn_rad);
            let found = search.best_first(lattice, Aim::Any);
            found.iter().any(Option::is_some)
        })
    }

    /// Latest wait, seconds, at most `until_s`, after which a certified single turn exists: the exact counterpart of `t_c`.
    ///
    /// `until_s` is the time of the entry into a volume on the mission.
    pub fn latest_start_s(&mut self, until_s: f64) -> Option<f64> {
        let (mut width_s, mut latest_s) = (until_s.max(0.0), None);
        let mut wait_s = width_s;
        for _ in 0..=HALVINGS {
            if self.is_avoidable_within(wait_s, MAX_TURN_RAD) {
                latest_s = Some(wait_s);
                if wait_s == until_s.max(0.0) {
                    return latest_s;
                }
            }
            width_s *= 0.5;
            wait_s = latest_s.unwrap_or(0.0) + width_s;
        }
        latest_s.or_else(|| self.is_avoidable_within(0.0, MAX_TURN_RAD).then_some(0.0))
    }

    /// The certified manoeuvre to each side that departs least from the mission; the side that departs least first.
    ///
    /// It is a single turn that begins up to a first entry, or one of two stages that begins now where that departs clearly
    /// less: two opposite turns let crossing traffic pass, a climb or descent that levels off leads above or below.
    pub fn least_departure(&mut self, entry_s: f64) -> [Option<Found>; 2] {
        self.in_lattice(|search, lattice| {
            for share in STARTS {
                let climbs = &mut search.scene.climbs(CLIMBS_A_SIDE);
                let wait_s = share * entry_s;
                search.turns_after(lattice, wait_s, &Side::BOTH, climbs, MAX_TURN_RAD);
            }
            search.two_stages(lattice);
            search.best_first(lattice, Aim::LeastDeparture)
        })
    }

    /// Adds the rows of single turns after a wait: from the mission's direction on away from it, and from there back.
    #[inline(never)]
    fn turns_after(
        &mut self,
        lattice: &mut Lattice,
        wait_s: f64,
        sides: &[Side],
        climbs: &mut dyn Iterator<Item = f64>,
        max_turn_rad: f64,
    ) {
        let prefix = self.after_wait(wait_s);
        lattice.begin(&prefix);
        for climb_rad in climbs {
            for side in sides.iter().copied() {
                let Some(row) = self.row(&prefix, climb_rad, side) else {
                    continue;
                };
                let (least_rad, to_rad) = (row.at_rad, row.to_rad.min(max_turn_rad));
                let ahead_rad = self.ahead_rad(&prefix.entry, side);
                let from_rad = ahead_rad.max(least_rad);
                let mut put = |at_rad, to_rad| {
                    let mut row = Row {
                        at_rad,
                        to_rad,
                        ..row
                    };
                    row.cost = self.least_cost(&prefix, &row);
                    lattice.put(&row);
                };
                if from_rad <= to_rad {
                    put(from_rad, to_rad);
                }
                if ahead_rad > least_rad && least_rad < to_rad {
                    put(ahead_rad.min(to_rad), least_rad);
                }
            }
        }
    }

    /// Adds the rows of two opposite turns, and of climbs and descents that level off.
    #[inline(never)]
    fn two_stages(&mut self, lattice: &mut Lattice) {
        let scene = self.scene;
        let level_rad = scene.original.1;
        let rate_radps = scene.flyer.course_rate_radps();
        let radius_m = scene.turn_radius_m();
        let least = |aside_m: f64, behind_m: f64| {
            Departure { aside_m, behind_m }.length_m(scene.objective) / WORTH
        };
        let between_rad = Side::BOTH.map(|side| self.widest_rad(side));
        let asides_rad = ASIDE_RAD.map(|first_rad| [Some(first_rad); 2]);
        for aside_rad in asides_rad.into_iter().chain([between_rad]) {
            for (side, first_rad) in Side::BOTH.into_iter().zip(aside_rad) {
                let Some(first_rad) = first_rad else {
                    continue;
                };
                let (sin, cos) = libm::sincos(first_rad);
                // With tightest turns, and back at once.
                let cost = least(
                    2.0 * radius_m * (1.0 - cos),
                    2.0 * radius_m * (first_rad - sin),
                );
                let turn_rad = side.sign() * first_rad;
                let prefix = self.after_first((turn_rad, level_rad), first_rad / rate_radps);
                let back_rad = self.ahead_rad(&prefix.entry, side.other());
                let row = self.row(&prefix, level_rad, side.other());
                if let Some(row) = row.filter(|row| row.at_rad <= back_rad) {
                    lattice.begin(&prefix);
                    let to_rad = back_rad + BEYOND_RAD;
                    lattice.put(&Row {
                        at_rad: back_rad,
                        to_rad,
                        cost,
                        ..row
                    });
                }
            }
        }
        for climb_rad in scene.extreme_climbs().skip(1) {
            let rises_mps = scene.flyer.airspeed_mps() * libm::sin(climb_rad - level_rad).abs();
            let mut fails_s = None;
            for radii in LEVEL_AFTER {
                let mut after_s = radii / rate_radps;
                let Some(mut levels) = self.levels(climb_rad, after_s) else {
                    fails_s = Some(after_s);
                    continue;
                };
                if let Some(mut fails_s) = fails_s.take() {
                    for _ in 0..HALVINGS {
                        let sooner_s = 0.5 * (fails_s + after_s);
                        match self.levels(climb_rad, sooner_s) {
                            Some(sooner) => (levels, after_s) = (sooner, sooner_s),
                            None => fails_s = sooner_s,
                        }
                    }
                }
                let (prefix, row) = levels;
                lattice.begin(&prefix);
                let cost = least(rises_mps * after_s, 0.0);
                lattice.put(&Row { cost, ..row });
            }
        }
    }

    /// Between walls, the largest first turn to a side after which a turn back into the mission's direction still stays between them, radians.
    #[inline(never)]
    fn widest_rad(&mut self, side: Side) -> Option<f64> {
        let scene = self.scene;
        if scene.around.fixed.is_empty() {
            return None;
        }
        let walls = Assumptions {
            rows: &[],
            ..scene.around
        };
        let (level_rad, target_m) = (scene.original.1, scene.target_m);
        let asked = (scene.horizon_s, target_m, target_m);
        let (mut widest_rad, mut most_rad) = (0.0, FRAC_PI_2);
        for _ in 0..=HALVINGS {
            let first_rad = 0.5 * (widest_rad + most_rad);
            let after_s = first_rad / scene.flyer.course_rate_radps();
            let prefix = self.after_first((side.sign() * first_rad, level_rad), after_s);
            let mut row = self.row(&prefix, level_rad, side.other())?;
            row.at_rad = row.at_rad.max(self.ahead_rad(&prefix.entry, side.other()));
            self.predict(&prefix.turns(&row), prefix.from_rad);
            let holds =
                certify_set(scene.flyer, self.path, &walls, asked, &self.meter).holds(target_m);
            *(if holds {
                &mut widest_rad
            } else {
                &mut most_rad
            }) = first_rad;
        }
        (widest_rad > 0.0).then_some(widest_rad)
    }

    /// The row of one member, a climb or descent straight ahead that levels off, if its line stays clear.
    #[inline(never)]
    fn levels(&mut self, climb_rad: f64, after_s: f64) -> Option<(Prefix, Row)> {
        let prefix = self.after_first((0.0, climb_rad), after_s);
        let mut row = self.row(&prefix, self.scene.original.1, Side::Left)?;
        (row.at_rad, row.to_rad) = (0.0, 0.0);
        let tangent = self.line(&prefix, &row)?;
        let clear_m = self.scene.target_m + tangent.inexact_m;
        let look = self.look(&tangent, (clear_m, clear_m))?;
        if look.margin_m < clear_m {
            return None;
        }
        Some((prefix, row))
    }

    /// The cheapest of the members of some rows, best first.
    #[inline(never)]
    fn best_first(&mut self, lattice: &mut Lattice, aim: Aim) -> [Option<Found>; 2] {
        let mut best: [Option<Found>; 2] = [None; 2];
        let least = |best: &Option<Found>| best.map_or(f64::INFINITY, |best| best.cost);
        let mut until = u32::MAX;
        if aim == Aim::LeastDeparture {
            // The cost of a single turn is known by its line alone.
            for row in lattice.rows.iter_mut() {
                if let Some(prefix) = lattice.prefixes.get(usize::from(row.prefix))
                    && prefix.first.is_none()
                {
                    self.look_for(prefix, row, aim);
                }
            }
        }
        while let Some((place, cost)) = lattice.next() {
            let is_done = self.limit_met() || self.meter.done() >= until;
            if is_done || !self.meter.take(ROWS / COMPARED) {
                break;
            }
            let Some(row) = lattice.rows.get_mut(place) else {
                break;
            };
            let Some(prefix) = lattice.prefixes.get(usize::from(row.prefix)) else {
                break;
            };
            let [left, right] = best.each_ref().map(least);
            let below = match (aim, row.first) {
                (Aim::LeastDeparture, Side::Left) => left - self.near_m(),
                (Aim::LeastDeparture, Side::Right) => right - self.near_m(),
                _ => left.min(right),
            };
            if aim != Aim::LeastDeparture && cost >= below || cost >= left.max(right) {
                break;
            }
            if cost >= below {
                row.close();
                continue;
            }
            let mut prefix_fails = false;
            if !row.is_ready {
                self.look_for(prefix, row, aim);
            } else if let Some(found) = self.fly(prefix, row, &mut prefix_fails) {
                if aim == Aim::Any {
                    return [Some(found), None];
                }
                let best = best.get_mut(usize::from(row.first == Side::Right));
                if let Some(best) = best.filter(|best| found.cost < least(best)) {
                    *best = Some(found);
                }
                until = until.min(
                    self.meter
                        .done()
                        .saturating_add(self.meter.left() / IMPROVES),
                );
                row.close();
            }
            if prefix_fails {
                let prefix = row.prefix;
                lattice.close(prefix);
            }
        }
        let [first, second] = &mut best;
        if least(second) < least(first) {
            core::mem::swap(first, second);
        }
        for found in best.iter_mut().flatten() {
            let from_rad = self.departure(found.turns.wait_s).course_rad;
            found.cost = self.cost(&found.turns, from_rad);
        }
        best
    }

    /// Advances a row to a turn that may stay clear, and estimates its cost.
    fn look_for(&mut self, prefix: &Prefix, row: &mut Row, aim: Aim) {
        row.cost = match self.advance(prefix, row) {
            Some(tangent) => self.cost_on(prefix, row, &tangent, aim),
            None => row.cost.max(self.least_cost(prefix, row)),
        };
    }

    /// Flies the next turn of a row. One that is not certified rules out more of the row, or all rows of its prefix.
    #[inline(never)]
    fn fly(&mut self, prefix: &Prefix, row: &mut Row, prefix_fails: &mut bool) -> Option<Found> {
        let target_m = self.scene.target_m;
        let turns = prefix.turns(row);
        let certificate = self.certify(&turns, prefix.from_rad, target_m);
        let margin_m = certificate.proven_m();
        if margin_m >= target_m {
            return Some(Found {
                turns,
                margin_m,
                cost: row.cost,
            });
        }
        *prefix_fails = certificate.at_s < prefix.entry.time_s;
        let tangent = self.line(prefix, row)?;
        let left_s = certificate.at_s - tangent.parts_s;
        if margin_m == f64::NEG_INFINITY || left_s <= 0.0 && row.direction() > 0.0 {
            // Longer turns share the arc.
            row.close();
        } else {
            row.least_step_rad = (2.0 * row.least_step_rad).min(0.5 * STEP_RAD);
            // The certificate measures chords, whose bow is not part of what the turn lacks, and how deep the ground is entered.
            let mut short_m = target_m - margin_m - 2.0 * CHORD_BOW_M;
            if certificate.id.is_none() {
                short_m /= STEEPEST;
            }
            self.rule_out(row, short_m, left_s);
            row.cost = row.cost.max(self.least_cost(prefix, row));
        }
        None
    }

    /// Differences of margin and departure below this do not matter, metres.
    pub(super) fn near_m(&self) -> f64 {
        NEAR * self.scene.turn_radius_m()
    }

    /// The turn onto the original course, radians towards a side.
    fn ahead_rad(&self, from: &MotionState, side: Side) -> f64 {
        side.sign() * (self.scene.original.0 - from.course_rad)
    }

    /// Lower bound of the cost of the rest of a row.
    fn least_cost(&self, prefix: &Prefix, row: &Row) -> f64 {
        if self.scene.objective != Objective::PaperCost {
            return 0.0;
        }
        if row.cost == f64::INFINITY {
            return row.cost;
        }
        self.paper_cost(&prefix.turns(row), prefix.from_rad)
    }

    /// The cost of the member of a row that ends on a line.
    fn cost_on(&mut self, prefix: &Prefix, row: &Row, tangent: &Tangent, aim: Aim) -> f64 {
        let objective = self.scene.objective;
        if aim != Aim::LeastDeparture && objective == Objective::PaperCost {
            return self.least_cost(prefix, row);
        }
        let wait_s = prefix.wait_s;
        let mut departure = self.departure_on(wait_s, &tangent.state, tangent.velocity_mps);
        let Some((first_rad, _)) = prefix.first else {
            return departure.length_m(objective);
        };
        // Two opposite turns lead farthest aside where the second one leads back to the mission's direction.
        let beyond_rad =
            -libm::copysign(1.0, first_rad) * (tangent.state.course_rad - self.scene.original.0);
        let bow_m = self.scene.turn_radius_m() * (1.0 - libm::cos(beyond_rad.max(0.0)));
        let there = self.departure_at(tangent.state.position_m, tangent.state.time_s);
        departure.aside_m = departure.aside_m.max(there.aside_m + bow_m);
        departure.length_m(objective) / WORTH
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tables;
    use crate::tests::scene;
    use fga_mission::Turner;
    use fga_proof::Vec3;
    use fga_proof::certificate::Hazard;
    use fga_proof::maneuver::Maneuver;
    use fga_proof::meter::Meter;
    use fga_proof::prediction::FlightPath;
    use fga_proof::situation::ProtectedVolume;
    use fga_proof::vehicle::Vehicle;

    /// A sphere of 30 m at rest ahead, to the left by some metres, and what is found of it.
    fn past<T>(ahead_m: f64, left_m: f64, look: impl Fn(&mut Search<'_>) -> T) -> T {
        let vehicle = Vehicle::lagged(0.0);
        let flyer = Turner::new(&vehicle);
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        let hazards = [Hazard::exact(
            0,
            Vec3::new(ahead_m, left_m, 0.0),
            Vec3::ZERO,
            volume,
        )];
        let nominal = Maneuver::hold();
        let scene = scene(
            &flyer,
            &vehicle,
            (MotionState::ahead(0.0), &nominal),
            &hazards,
        );
        let (mut path, mut tables) = (FlightPath::new(), Tables::NONE);
        look(&mut Search::new(
            &scene,
            (&mut path, &mut tables),
            Meter::new(100_000, u32::MAX),
        ))
    }

    #[test]
    fn the_latest_start_is_where_the_tightest_turn_still_passes() {
        // By hand: a turn of radius 37.5 m that begins d before the centre comes no nearer to it than hypot(d, 37.5) − 37.5.
        // That is 30.05 m at d = 56.2 m, after 9.59 s at 15 m/s.
        let (latest_s, work) = past(200.0, 0.0, |s| (s.latest_start_s(11.33), s.work()));
        assert!((9.4..9.6).contains(&latest_s.unwrap()), "{latest_s:?}");
        assert!(work < 5000, "{work}");
        let found = past(200.0, 0.0, |search| search.cheapest(9.5)).unwrap();
        assert!(
            found.margin_m >= 0.05 && found.turns.wait_s == 9.5,
            "{found:?}"
        );
    }

    #[test]
    fn a_sphere_off_the_mission_is_passed_on_its_far_side_by_the_least_turn() {
        // By hand: from far away, a line at the angle ψ passes the centre 20 m to the left at 400 sin ψ + 20 cos ψ to the
        // right: 30.05 m at ψ = 0.025 rad, and more as the turn begins only gradually.
        let found = past(400.0, 20.0, |search| search.cheapest(0.0)).unwrap();
        assert!(
            (-0.028..-0.025).contains(&found.turns.turn_rad),
            "{found:?}"
        );
    }

    #[test]
    fn where_nothing_is_in_the_way_no_turn_is_cheapest() {
        let found = past(400.0, 90.0, |search| search.cheapest(0.0)).unwrap();
        assert_eq!((found.turns.turn_rad, found.cost), (0.0, 0.0));
    }
}
