//! Which single turn can be cheapest, told from the lines on which turns end: branch and bound.
//!
//! The front that could be cheapest is looked at next, until its first turn may do; then it is swept from there.

use crate::angle::Side;
use crate::prediction::MotionState;

use super::front::Fronts;
use super::line::{Entry, Tangent};
use super::sweep::{LONGEST_STEP_RAD, Sweep};
use super::{Found, MAX_TURN_RAD, Objective, Search};

/// What the line of the smallest turn keeps beyond the target, turn radii.
const NEAR: f64 = 0.005;

/// Metres that a turn moves the aircraft away from a hazard, as a share of those that it moves it by.
const USUAL: f64 = 0.7;

/// Most lines on the way to the smallest turn that does.
const LINES: usize = 3;

/// It is no farther from the first one that may do, radians.
const MOST_BY_LINES_RAD: f64 = 0.04;

impl Search<'_> {
    /// The cheapest certified single turn to one of some sides, as in [`Self::cheapest`].
    pub fn cheapest_to(&mut self, sides: &[Side], wait_s: f64) -> Option<Found> {
        let entry = self.entry(wait_s)?;
        let mut fronts = Fronts::new();
        if !self.open(&entry, sides, &mut fronts) {
            return None;
        }
        self.cheapest_of(&entry, &mut fronts, sides)
    }

    /// The climb angle and the turn of the cheapest one that may do, as far as lines tell.
    pub(super) fn likely(&mut self, entry: &Entry, fronts: &mut Fronts) -> Option<Tangent> {
        loop {
            self.meter.count(1);
            let next = fronts.next_mut()?;
            if next.is_ready || self.limit_met() {
                let (what, from_rad) = ((next.climb_rad, next.side), next.least_rad);
                let turn_rad = self.by_lines(entry, what, from_rad)?;
                return self.tangent(entry, what, turn_rad);
            }
            self.advance(entry, next);
        }
    }

    /// The cheapest of some fronts that is certified.
    fn cheapest_of(&mut self, entry: &Entry, fronts: &mut Fronts, sides: &[Side]) -> Option<Found> {
        let scene = self.scene;
        let from = entry.from;
        let mut best: Option<Found> = None;
        let mut has_failed = false;
        while let Some(next) = fronts.next_mut() {
            let most = best.map_or(f64::INFINITY, |found| found.cost);
            if next.cost >= most || self.limit_met() {
                break;
            }
            self.meter.count(1);
            if !next.is_ready {
                self.advance(entry, next);
                continue;
            }
            let (climb_rad, side, from_rad) = (next.climb_rad, next.side, next.least_rad);
            next.close();
            let max_turn_rad = self.room_rad(&from, (climb_rad, side), most);
            let leave = self.smallest(&Sweep {
                from,
                first: None,
                before_m: entry.before_m,
                side,
                climb_rad,
                from_rad,
                max_turn_rad,
                floor_m: scene.target_m,
                enough_m: scene.target_m,
            });
            let Some(leave) = leave else {
                if best.is_none() && !has_failed {
                    has_failed = true;
                    if !self.has_extreme_turn(&from, entry.before_m, sides) {
                        return None;
                    }
                }
                continue;
            };
            let turns = entry.turns(leave.turn_rad, leave.climb_rad);
            let cost = self.cost(&turns, &from);
            if cost < most {
                best = Some(Found {
                    turns,
                    margin_m: leave.margin_m,
                    cost,
                });
            }
        }
        best
    }

    /// About the least turn of a front that does on the line on which it ends, from one that may, radians.
    fn by_lines(
        &mut self,
        entry: &Entry,
        (climb_rad, side): (f64, Side),
        from_rad: f64,
    ) -> Option<f64> {
        let scene = self.scene;
        let radius_m = scene.turn_radius_m();
        let bank_rad = side.sign() * entry.from.bank_rad;
        let least_rad = from_rad.max(self.bend(bank_rad, side)?.least_rad());
        let mut turn_rad = least_rad;
        let mut before: Option<(f64, f64)> = None;
        for _ in 0..LINES {
            let enough_m = scene.target_m + radius_m;
            let look = self.look(entry, (climb_rad, side), turn_rad, enough_m)?;
            let usual = USUAL * look.lever_m;
            let slope = secant(before, (turn_rad, look.margin_m))
                .unwrap_or(usual)
                .max(0.2 * usual);
            if look.margin_m >= scene.target_m {
                break;
            }
            before = Some((turn_rad, look.margin_m));
            turn_rad += (scene.target_m + NEAR * radius_m - look.margin_m) / slope;
        }
        // Rather too small than too large: what departs more than it seems is found out later.
        Some(turn_rad.min(least_rad + MOST_BY_LINES_RAD))
    }

    /// The largest turn that costs less than `most`, and a step more: its last part may be taken back again.
    fn room_rad(&self, from: &MotionState, (climb_rad, side): (f64, Side), most: f64) -> f64 {
        let scene = &self.scene;
        let room = if scene.costs.0 > 0.0 && scene.objective == Objective::PaperCost {
            let climb_cost = scene.costs.1 * (climb_rad - scene.original.1).abs();
            (most - climb_cost) / scene.costs.0
        } else {
            MAX_TURN_RAD
        };
        let offset = (scene.original.0 - from.course_rad) * side.sign();
        (room + offset + LONGEST_STEP_RAD).min(MAX_TURN_RAD)
    }
}

/// The slope between two points, where it is known.
fn secant(before: Option<(f64, f64)>, now: (f64, f64)) -> Option<f64> {
    let (at, value) = before?;
    let slope = (now.1 - value) / (now.0 - at);
    (slope > 0.0 && slope.is_finite()).then_some(slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::certificate::{Hazard, Hazards};
    use crate::maneuver::Maneuver;
    use crate::prediction::{FlightPath, Flyer};
    use crate::search::{Scene, Turns};
    use crate::situation::ProtectedVolume;
    use crate::vehicle::{Response, Vehicle};
    use proptest::prelude::*;

    fn vehicle(lag_s: f64) -> Vehicle {
        Vehicle {
            response: Response {
                dead_time_s: 0.0,
                bank_time_constant_s: lag_s,
                turn_rate_factor: 0.8,
            },
            ..Vehicle::table_4()
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        /// No turn of a grid that is certified is cheaper than what branch and bound finds, and there is none where
        /// it finds none.
        #[test]
        fn branch_and_bound_finds_what_trying_every_turn_finds(
            lagged in any::<bool>(),
            bank_rad in -0.6..0.6f64,
            threats in proptest::collection::vec(
                (6.0..14.0f64, -20.0..20.0f64, -8.0..8.0f64, -3.1..3.1f64, 0.0..40.0f64),
                1..4,
            ),
        ) {
            let vehicle = vehicle(if lagged { 0.6 } else { 0.0 });
            let flyer = Flyer::new(&vehicle);
            let mut hazards = Hazards::new();
            for (place, (meets_s, aside_m, above_m, course_rad, speed_mps)) in
                threats.iter().enumerate()
            {
                let (sin, cos) = course_rad.sin_cos();
                let velocity_mps = Vec3::new(cos, sin, 0.0) * *speed_mps;
                let meets_m = Vec3::new(15.0 * meets_s, *aside_m, *above_m);
                let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
                let id = u32::try_from(place).unwrap();
                let hazard =
                    Hazard::exact(id, meets_m - velocity_mps * *meets_s, velocity_mps, volume);
                hazards.put(place, Hazard { index: id, ..hazard });
            }
            let nominal = Maneuver::hold();
            let start = MotionState::ahead(if lagged { bank_rad } else { 0.0 });
            let scene = Scene {
                flyer: &flyer,
                start,
                nominal: &nominal,
                original: (0.0, 0.0),
                hazards: &hazards,
                horizon_s: 60.0,
                target_m: 0.05,
                climb_limits_rad: (vehicle.climb_min_rad, vehicle.climb_max_rad),
                costs: (0.2, 0.5),
                objective: Objective::PaperCost,
            };
            let mut path = FlightPath::new();
            let mut search = Search::new(scene, &mut path, u32::MAX, u32::MAX);
            let found = search.cheapest(0.0);
            let mut least = f64::INFINITY;
            for climb_rad in scene.climb_targets() {
                for k in -200..=200 {
                    let turns = Turns {
                        wait_s: 0.0,
                        turn_rad: 0.03 * f64::from(k),
                        climb_rad,
                        second: None,
                    };
                    // The search ends turns to the side that it begins them to.
                    let rolls_out_rad = flyer.rollout_rad(start.bank_rad);
                    if (turns.turn_rad - rolls_out_rad) * start.bank_rad < 0.0 {
                        continue;
                    }
                    let cost = search.paper_cost(&turns, &start);
                    if cost < least && search.certify(&turns, &start, 0.05).holds(0.06) {
                        least = cost;
                    }
                }
            }
            if let Some(found) = found {
                let exact = search.certify(&found.turns, &start, f64::MIN);
                prop_assert!(exact.holds(0.05), "{found:?} {exact:?}");
                prop_assert!(found.cost < least + 0.01, "{} {least}", found.cost);
            } else {
                // Only at the original climb angle and the steepest ones is everything looked at.
                prop_assert!(least > 0.5, "nothing found, but a turn at {least}");
            }
        }
    }
}
