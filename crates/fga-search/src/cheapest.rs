//! Which single turn can be cheapest, told from the lines on which turns end: branch and bound.
//!
//! The front that could be cheapest is looked at next, until its first turn may do; then flights close in on its least turn,
//! while no other front could be cheaper.

use fga_proof::angle::Side;
use fga_proof::certificate::{ALWAYS, Certificate, Hazard};
use fga_proof::prediction::{CHORD_BOW_M, MotionState, Target};

use super::front::{Fronts, Ready, RuledOut};
use super::line::{Entry, Tangent, Way};
use super::sweep::{LONGEST_STEP_RAD, Leave, Sweep};
use super::{CLIMB_STEP_RAD, Found, MAX_TURN_RAD, Objective, Search};

/// What the line of the smallest turn keeps beyond the target, turn radii.
const NEAR: f64 = 0.005;

/// Metres that a turn moves the aircraft away from a hazard, as a share of those that it moves it by.
const USUAL: f64 = 0.7;

/// Most lines on the way to the smallest turn that does.
const LINES: usize = 3;

/// Most flights on the way to the least turn that is certified.
const FLIGHTS: usize = 6;

/// A turn or climb that keeps at most this many times as much beyond the target is the least one.
const MOST_NEAR: f64 = 3.0;

/// The least certified turn is known to this, radians.
const FINEST_RAD: f64 = 1.0 / 1280.0;

/// A turn moves what happens sooner after it as if it happened this long after it, seconds.
const LEAST_LEVER_S: f64 = 0.5;

/// It is no farther from the first one that may do, radians.
const MOST_BY_LINES_RAD: f64 = 0.04;

/// What flights tell about the least certified turn of a front.
enum Closed {
    /// It is this one.
    At(Leave),
    /// There is none.
    None,
    /// It is about this one or larger, radians: another front may be cheaper.
    Later(f64),
    /// Nothing, but that none up to a turn is, radians.
    Open(f64),
}

impl Search<'_> {
    /// The cheapest certified single turn to one of some sides, as in [`Self::cheapest`].
    pub fn cheapest_to(&mut self, sides: &[Side], wait_s: f64) -> Option<Found> {
        let entry = self.entry(wait_s)?;
        if !self.meter.take_table::<[Fronts; 2]>() {
            return None;
        }
        let mut fronts = [Fronts::NONE; 2];
        let opened = fronts.get_mut(..sides.len())?;
        for (fronts, side) in opened.iter_mut().zip(sides) {
            self.open(fronts, &entry, *side);
        }
        self.cheapest_of(opened, |_, _| true)
    }

    /// The line on which the cheapest turn that may do ends, as far as lines tell.
    pub(super) fn likely(&mut self, entry: &Entry, next: &Ready) -> Option<Tangent> {
        // Rather too small than too large: what departs more than it seems is found out later.
        let room = (next.least_rad, MOST_BY_LINES_RAD);
        let turn_rad = self.by_lines(entry, &next.way, room)?;
        self.tangent(entry, &next.way, turn_rad)
    }

    /// The cheapest of some fronts that is certified. Each time that turns are put off for others while nothing is found yet,
    /// `goes_on` says whether to look on.
    pub(super) fn cheapest_of(
        &mut self,
        sets: &mut [Fronts],
        mut goes_on: impl FnMut(&mut Self, &mut [Fronts]) -> bool,
    ) -> Option<Found> {
        let scene = self.scene;
        let mut best: Option<Found> = None;
        loop {
            let most = best.map_or(f64::INFINITY, |found| found.cost);
            if best.is_some() && self.is_good_enough() {
                break;
            }
            let Some(next) = self.next_ready(sets, most).filter(|_| !self.limit_met()) else {
                break;
            };
            let Some(Fronts { entry, .. }) = sets.get(next.set) else {
                break;
            };
            let (entry, way) = (*entry, next.way);
            let (from, side, climb_rad) = (entry.from, way.side, way.climbing.climb_rad);
            let (least_turn_rad, max_turn_rad) = self.room_rad(&from, (climb_rad, side), most);
            let sweep = Sweep {
                from,
                first: None,
                before_m: entry.before_m,
                side,
                climb_rad,
                from_rad: next.least_rad.max(least_turn_rad),
                max_turn_rad,
                floor_m: scene.target_m,
                enough_m: scene.target_m,
            };
            let mut failed = None;
            let closed_in = match self.ahead(&entry, &way, &sweep) {
                Some(leave) => Closed::At(leave),
                None => self.closed_in(&entry, &way, (&sweep, next.next_rad), &mut failed),
            };
            let left_rad = if let Closed::Later(from_rad) = closed_in {
                from_rad
            } else {
                f64::INFINITY
            };
            self.leave(sets, &next, left_rad, failed.as_ref());
            let leave = match closed_in {
                Closed::Later(_) => {
                    if best.is_none() && !goes_on(self, sets) {
                        return None;
                    }
                    continue;
                }
                Closed::None => None,
                Closed::At(leave) => Some(leave)
                    .filter(|_| !self.limit_met())
                    .or_else(|| self.smallest(&sweep)),
                Closed::Open(from_rad) => self.smallest(&Sweep { from_rad, ..sweep }),
            };
            let Some(leave) = leave else {
                let has_failed = sets.iter().any(|set| set.has_failed);
                if let Some(set) = sets.get_mut(next.set) {
                    set.has_failed = true;
                }
                if best.is_none() && !has_failed {
                    let mut has_turn =
                        |set: &Fronts| self.has_extreme_turn(&from, entry.before_m, &[set.side]);
                    if !sets.iter().any(&mut has_turn) {
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

    /// The least certified turn of a sweep, closed in on by flights, unless it is beyond `next_rad`. Tells what the last of
    /// them that failed rules out.
    fn closed_in(
        &mut self,
        entry: &Entry,
        way: &Way,
        (sweep, next_rad): (&Sweep, f64),
        failed: &mut Option<RuledOut>,
    ) -> Closed {
        let scene = self.scene;
        let is_steady = |hazard: &Hazard| hazard.window_s == ALWAYS;
        // What may happen at some times only makes margins that jump.
        if !scene.hazards.rows().iter().all(is_steady) {
            return Closed::Open(sweep.from_rad);
        }
        let near_m = NEAR * scene.turn_radius_m();
        let mut fails_rad = sweep.from_rad;
        let mut best: Option<Leave> = None;
        let mut before: Option<(f64, f64)> = None;
        let begun = self.by_lines(entry, way, (sweep.from_rad, MAX_TURN_RAD));
        let (Some(mut turn_rad), Some(least_rad)) = (begun, self.least_rad(entry, sweep)) else {
            return Closed::Open(fails_rad);
        };
        if turn_rad > sweep.from_rad && turn_rad > next_rad {
            return Closed::Later(turn_rad);
        }
        let least_rad = least_rad.min(turn_rad);
        for _ in 0..FLIGHTS {
            if self.limit_met() {
                break;
            }
            if turn_rad > sweep.max_turn_rad && best.is_none() {
                return Closed::None;
            }
            let (leave, certificate) = self.flown_at(entry, sweep, turn_rad);
            let Some(tangent) = self.tangent(entry, way, turn_rad) else {
                return Closed::Open(fails_rad);
            };
            let lacks_m = sweep.enough_m - leave.margin_m;
            let left_s = certificate.at_s - tangent.parts_s;
            let mut more_rad = f64::NEG_INFINITY;
            if lacks_m <= 0.0 {
                best = Some(leave);
                if turn_rad <= least_rad {
                    let leave = self.nearer(entry, way, (sweep, leave));
                    let left_s = certificate.at_s - entry.wait_s();
                    return Closed::At(self.less_climb(entry, sweep, (leave, left_s)));
                }
                if self.is_near(&leave, sweep) || turn_rad - fails_rad <= FINEST_RAD {
                    return Closed::At(self.nearer(entry, way, (sweep, leave)));
                }
            } else {
                fails_rad = fails_rad.max(turn_rad);
                // The margin is that of chords.
                let short_m = lacks_m - CHORD_BOW_M;
                more_rad = self.least_more_rad(short_m, left_s);
                let left_s = left_s.max(0.0);
                *failed = (short_m > 0.0).then_some(RuledOut {
                    turn_rad,
                    until_rad: turn_rad + more_rad,
                    short_m,
                    turns_s: certificate.at_s - left_s - entry.wait_s(),
                    left_s,
                });
                if more_rad == f64::INFINITY && best.is_none() {
                    return Closed::None;
                }
                if left_s <= 0.0 {
                    break;
                }
            }
            let here = (turn_rad, leave.margin_m);
            let usual = self.usual_m(left_s);
            let step_rad = match (before, secant(before, here)) {
                // A little more of a turn only brings it closer.
                (Some(_), None) if best.is_none() => LONGEST_STEP_RAD,
                (_, slope) => (lacks_m + near_m) / slope.unwrap_or(usual),
            };
            let step_rad = step_rad.min(LONGEST_STEP_RAD);
            before = Some(here);
            let does_rad = best.map_or(f64::INFINITY, |best| best.turn_rad.abs());
            turn_rad += step_rad.max(more_rad);
            if turn_rad <= fails_rad.max(least_rad) || turn_rad >= does_rad {
                turn_rad = 0.5 * (fails_rad.max(least_rad) + does_rad);
            }
            // Lines are cheaper than flights with bank lag.
            if best.is_none() && !scene.flyer.is_ideal() {
                let room = (turn_rad, sweep.max_turn_rad);
                let Some(more_rad) = self.turn_rad(entry, way, room) else {
                    return Closed::None;
                };
                turn_rad = more_rad;
            }
            if best.is_none() && turn_rad > next_rad {
                return Closed::Later(turn_rad);
            }
        }
        best.map_or(Closed::Open(fails_rad), Closed::At)
    }

    /// The turn onto the original course, if it does and smaller ones may do too: it costs least.
    fn ahead(&mut self, entry: &Entry, way: &Way, sweep: &Sweep) -> Option<Leave> {
        let ahead_rad = self.ahead_rad(&entry.from, way.side);
        if sweep.from_rad >= ahead_rad || ahead_rad > sweep.max_turn_rad {
            return None;
        }
        let does = self.does_at(entry, way, (sweep, ahead_rad))?;
        Some(self.less_climb(entry, sweep, does))
    }

    /// The turn onto the original course, radians towards a side.
    pub(super) fn ahead_rad(&self, from: &MotionState, side: Side) -> f64 {
        side.sign() * (self.scene.original.0 - from.course_rad)
    }

    /// Whether a turn or climb keeps hardly more than enough: it is the least one.
    fn is_near(&self, leave: &Leave, sweep: &Sweep) -> bool {
        let near_m = NEAR * self.scene.turn_radius_m();
        leave.margin_m - sweep.enough_m <= MOST_NEAR * near_m
    }

    /// A turn, if it does as far as lines tell and as it is flown, and the time from its beginning to the closest approach, seconds.
    fn does_at(
        &mut self,
        entry: &Entry,
        way: &Way,
        (sweep, turn_rad): (&Sweep, f64),
    ) -> Option<(Leave, f64)> {
        self.turn_rad(entry, way, (turn_rad, turn_rad))?;
        let (leave, certificate) = self.flown_at(entry, sweep, turn_rad);
        let does = leave.margin_m >= sweep.enough_m;
        does.then_some((leave, certificate.at_s - entry.wait_s()))
    }

    /// A turn that does, as near to the original course as lines and a few flights tell.
    fn nearer(&mut self, entry: &Entry, way: &Way, (sweep, does): (&Sweep, Leave)) -> Leave {
        let (mut best, mut fails_rad) = (does, self.ahead_rad(&entry.from, way.side));
        for _ in 0..LINES {
            let does_rad = way.side.sign() * best.turn_rad;
            if self.is_near(&best, sweep) || fails_rad - does_rad <= FINEST_RAD || self.limit_met()
            {
                break;
            }
            let turn_rad = 0.5 * (does_rad + fails_rad);
            match self.does_at(entry, way, (sweep, turn_rad)) {
                Some((leave, _)) => best = leave,
                None => fails_rad = turn_rad,
            }
        }
        best
    }

    /// A change of climb without a turn that keeps more than the wanted margin `left_s` after it begins, with less of a climb.
    fn less_climb(&mut self, entry: &Entry, sweep: &Sweep, (most, left_s): (Leave, f64)) -> Leave {
        let scene = self.scene;
        let near_m = NEAR * scene.turn_radius_m();
        let beyond_rad = sweep.climb_rad - scene.original.1;
        let back_rad = CLIMB_STEP_RAD.min(beyond_rad.abs());
        let sign = libm::copysign(1.0, beyond_rad);
        let turn_rad = sweep.side.sign() * most.turn_rad;
        let usual = USUAL * scene.flyer.airspeed_mps() * left_s.max(LEAST_LEVER_S);
        let (mut best, mut at, mut before) = (most, (0.0, most.margin_m), None);
        let mut fails_rad = back_rad;
        for _ in 0..LINES {
            // Less of a climb keeps less.
            let slope = secant(before, (-at.0, at.1)).unwrap_or(usual);
            let spare_m = at.1 - sweep.enough_m - near_m;
            let least_rad = sign * (sweep.climb_rad - best.climb_rad);
            let mut less_rad = at.0 + spare_m / slope;
            if less_rad <= least_rad || less_rad > fails_rad {
                less_rad = 0.5 * (least_rad + fails_rad);
            }
            if self.is_near(&best, sweep) || less_rad - least_rad < FINEST_RAD || self.limit_met() {
                break;
            }
            let climb_rad = sweep.climb_rad - sign * less_rad;
            if !self.may_do(&sweep.from, (climb_rad, sweep.side), turn_rad) {
                fails_rad = less_rad;
                continue;
            }
            let less = Sweep {
                climb_rad,
                ..*sweep
            };
            let (leave, _) = self.flown_at(entry, &less, turn_rad);
            before = Some((-at.0, at.1));
            at = (less_rad, leave.margin_m);
            if leave.margin_m >= sweep.enough_m {
                best = leave;
            } else {
                fails_rad = less_rad;
            }
        }
        best
    }

    /// The least turn of a sweep: rolling out at once, radians.
    fn least_rad(&mut self, entry: &Entry, sweep: &Sweep) -> Option<f64> {
        let bank_rad = sweep.side.sign() * entry.from.bank_rad;
        Some(self.bend(bank_rad, sweep.side)?.least_rad())
    }

    /// A turn of a sweep, and the margin of its flight as far as it is enough.
    fn flown_at(&mut self, entry: &Entry, sweep: &Sweep, turn_rad: f64) -> (Leave, Certificate) {
        let scene = self.scene;
        let turn_rad = sweep.side.sign() * turn_rad;
        let (from, floor_m) = (entry.from, sweep.enough_m);
        let mut worst = Certificate::clear(entry.before_m);
        if scene.flyer.is_ideal() {
            let target = Target {
                course_rad: from.course_rad + turn_rad,
                climb_rad: sweep.climb_rad,
                rate_share: 1.0,
            };
            let end = self.glide(&from, &target, scene.horizon_s, floor_m, &mut worst);
            if worst.margin_m >= floor_m {
                worst = self.straight_on(&end, scene.flyer.velocity_mps(&end), &worst, floor_m);
            }
        } else {
            // What is found is certified with it, exactly as it is flown.
            worst = self.certify(&entry.turns(turn_rad, sweep.climb_rad), &from, floor_m);
            worst.margin_m = worst.proven_m();
        }
        let leave = Leave {
            turn_rad,
            climb_rad: sweep.climb_rad,
            margin_m: worst.margin_m,
            state: from,
            before_m: entry.before_m,
        };
        (leave, worst)
    }

    /// About the least turn of a front that does on the line on which it ends, from one that may, radians.
    fn by_lines(
        &mut self,
        entry: &Entry,
        way: &Way,
        (from_rad, step_rad): (f64, f64),
    ) -> Option<f64> {
        let scene = self.scene;
        let radius_m = scene.turn_radius_m();
        let bank_rad = way.side.sign() * entry.from.bank_rad;
        let least_rad = from_rad.max(self.bend(bank_rad, way.side)?.least_rad());
        let mut turn_rad = least_rad;
        let mut before: Option<(f64, f64)> = None;
        for _ in 0..LINES {
            let enough_m = scene.target_m + radius_m;
            let look = self.look(entry, way, turn_rad, enough_m)?;
            let usual = USUAL * look.lever_m;
            let slope = secant(before, (turn_rad, look.margin_m))
                .unwrap_or(usual)
                .max(0.2 * usual);
            if look.margin_m >= scene.target_m {
                break;
            }
            before = Some((turn_rad, look.margin_m));
            let more_m = scene.target_m + NEAR * radius_m - look.margin_m;
            turn_rad += (more_m / slope).min(LONGEST_STEP_RAD);
            if turn_rad > least_rad + step_rad {
                return Some(least_rad + step_rad);
            }
        }
        Some(turn_rad)
    }

    /// How far turning on by a radian usually moves the aircraft away from a hazard until some time after it, metres: its course
    /// follows with the bank.
    fn usual_m(&self, left_s: f64) -> f64 {
        let flyer = self.scene.flyer;
        let lag_s = flyer.bank_time_constant_s();
        let lags_s = if lag_s > 0.0 && left_s > 0.0 {
            lag_s * (1.0 - libm::exp(-left_s / lag_s))
        } else {
            0.0
        };
        USUAL * flyer.airspeed_mps() * (left_s - lags_s).max(LEAST_LEVER_S)
    }

    /// What a climb angle costs.
    pub(super) fn climb_cost(&self, climb_rad: f64) -> f64 {
        self.scene.costs.1 * (climb_rad - self.scene.original.1).abs()
    }

    /// The least and the largest turn that cost less than `most`, and a step more: the last part of a climb or turn may be taken
    /// back again.
    fn room_rad(
        &self,
        from: &MotionState,
        (climb_rad, side): (f64, Side),
        most: f64,
    ) -> (f64, f64) {
        let scene = &self.scene;
        let room = if scene.costs.0 > 0.0 && scene.objective == Objective::PaperCost {
            (most - self.climb_cost(climb_rad)) / scene.costs.0
        } else {
            f64::INFINITY
        };
        let (ahead_rad, room) = (self.ahead_rad(from, side), room + LONGEST_STEP_RAD);
        (ahead_rad - room, (ahead_rad + room).min(MAX_TURN_RAD))
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
    use crate::tests::scene;
    use crate::{Scene, Turns};
    use fga_proof::Vec3;
    use fga_proof::certificate::{Hazard, Hazards};
    use fga_proof::maneuver::Maneuver;
    use fga_proof::prediction::{FlightPath, Flyer};
    use fga_proof::situation::ProtectedVolume;
    use fga_proof::vehicle::Vehicle;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        /// No turn of a grid that is certified is cheaper than what branch and bound finds, and there is none where
        /// it finds none.
        #[test]
        fn branch_and_bound_finds_what_trying_every_turn_finds(
            lagged in any::<bool>(),
            bank_rad in -0.6..0.6f64,
            original_rad in prop_oneof![Just(0.0), -0.6..0.6f64],
            threats in proptest::collection::vec(
                (6.0..14.0f64, -20.0..20.0f64, -8.0..8.0f64, -3.1..3.1f64, 0.0..40.0f64),
                1..4,
            ),
        ) {
            let vehicle = Vehicle::lagged(if lagged { 0.6 } else { 0.0 });
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
                original: (original_rad, 0.0),
                ..scene(&flyer, &vehicle, (start, &nominal), &hazards)
            };
            let mut path = FlightPath::new();
            let mut search = Search::new(scene, &mut path, u32::MAX);
            let found = search.cheapest(0.0);
            let mut least = f64::INFINITY;
            for (climb_rad, _) in scene.climb_targets() {
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
