//! Fronts: turns to one side at one climb target, of which lines rule out the smaller ones.
//!
//! On the line on which a front's first turn ends an obstacle comes too close, and turns that go on by too little to
//! have moved the aircraft out of its way by then are ruled out with it, as are those at a climb target near by; or none
//! does, and the front is ready.

use fga_proof::Vec3;
use fga_proof::angle::Side;
use fga_proof::certificate::{Certificate, Line};
use fga_proof::meter::COMPARED;
use fga_proof::prediction::{Bend, MotionState, whole};

use super::line::{Climbing, Entry, Tangent, Way};
use super::{MAX_TURN_RAD, Objective, Search};

/// Most climb targets: steps of [`CLIMB_STEP_RAD`](super::CLIMB_STEP_RAD) from straight down to straight up, 107 of them, in whole
/// vectors.
const MOST_CLIMBS: usize = 108;

/// Costs that are compared at once.
const LANES: usize = 4;

/// Fronts that one unit of work fills in.
const FILLED: usize = 8;

/// Climb targets that one unit of work prepares.
const PREPARED: usize = 2;

/// Where no more than this can be ruled out at once, the rest is swept, radians.
const LEAST_STEP_RAD: f64 = 0.01;

/// Chords of an arc, radians, and how many at most.
const ARC_STEP_RAD: f64 = 0.35;
const MOST_ARC_STEPS: usize = 20;

/// So much of where a roll-out begins aside of the line on which it ends is left a time constant later, e to the minus one, and
/// so much is how far its way bows from one line up to then and another one to the end.
const LEFT_ASIDE: f64 = 0.367_880;
const BOWS_ASIDE: f64 = 0.12;

/// After lines for one in this many climb targets without a front that is ready, the original climb angle and the steepest
/// ones tell whether there is one: hardly ever is one only in between.
const PATIENCE: usize = 2;

/// The climb targets of a search, steepest climb first, and what taking them up from a climb angle moves the aircraft by.
#[derive(Debug)]
pub(super) struct Climbs {
    all: [Climbing; MOST_CLIMBS],
    /// What each of them costs.
    costs: [f64; MOST_CLIMBS],
    count: usize,
    /// Which one is the original climb angle.
    original: usize,
    /// Climb angle before, radians.
    from_rad: f64,
}

impl Climbs {
    /// None yet.
    pub(super) const fn new() -> Self {
        Self {
            all: [Climbing::NONE; MOST_CLIMBS],
            costs: [f64::INFINITY; MOST_CLIMBS],
            count: 0,
            original: 0,
            from_rad: 0.0,
        }
    }
}

/// The fronts to one side from where turns begin: one for each climb target.
pub(super) struct Fronts {
    pub entry: Entry,
    pub side: Side,
    /// Smaller turns are ruled out, radians; infinite where all are.
    least_rad: [f64; MOST_CLIMBS],
    /// The least that a turn can cost that is not.
    costs: [f64; MOST_CLIMBS],
    /// Whether the first turn may do, as far as lines tell.
    is_ready: [bool; MOST_CLIMBS],
    count: usize,
    /// What a turn costs per radian, and up to which one none costs anything, radians.
    cost: f64,
    free_rad: f64,
    /// Lines that were looked at, and whether a front was ready.
    looked_at: usize,
    had_ready: bool,
    /// Whether a turn failed that lines had not ruled out.
    pub has_failed: bool,
}

impl Fronts {
    /// None yet.
    pub(super) const NONE: Self = Self {
        entry: Entry::NONE,
        side: Side::Left,
        least_rad: [f64::INFINITY; MOST_CLIMBS],
        costs: [f64::INFINITY; MOST_CLIMBS],
        is_ready: [false; MOST_CLIMBS],
        count: 0,
        cost: 0.0,
        free_rad: 0.0,
        looked_at: 0,
        had_ready: false,
        has_failed: false,
    };

    /// The front that could be cheapest, and its cost; infinite where none is left.
    fn cheapest(&self) -> (usize, f64) {
        // Four at once, in the order in which a vector holds them: there is one least cost.
        let mut lanes = [f64::INFINITY; LANES];
        let (fours, _) = self.costs.as_chunks::<LANES>();
        for four in fours.iter().take(self.count.div_ceil(LANES)) {
            for (least, cost) in lanes.iter_mut().zip(four) {
                *least = if *cost < *least { *cost } else { *least };
            }
        }
        let least = lanes.into_iter().fold(f64::INFINITY, f64::min);
        let place = self.costs.iter().position(|cost| *cost == least);
        (place.unwrap_or(0), least)
    }

    /// What the cheapest of the others than one could cost; infinite where none is left.
    fn cost_of_others(&self, place: usize) -> f64 {
        let others = self.costs.iter().take(self.count).enumerate();
        let costs = others.filter_map(|(other, cost)| (other != place).then_some(*cost));
        costs.fold(f64::INFINITY, f64::min)
    }

    /// The least that a turn of at least `least_rad` can cost at a climb target that costs `climb_cost`.
    const fn cost(&self, least_rad: f64, climb_cost: f64) -> f64 {
        self.cost * (least_rad - self.free_rad).max(0.0) + climb_cost
    }

    fn put(&mut self, place: usize, least_rad: f64, cost: f64) {
        let slots = (self.least_rad.get_mut(place), self.costs.get_mut(place));
        if let (Some(least), Some(least_cost)) = slots {
            (*least, *least_cost) = (least_rad, cost);
        }
    }

    fn close(&mut self, place: usize) {
        self.put(place, f64::INFINITY, f64::INFINITY);
    }
}

/// A turn of a front that may be the cheapest one.
pub(super) struct Ready {
    /// Whose it is.
    pub set: usize,
    pub way: Way,
    /// Smaller turns are ruled out, radians.
    pub least_rad: f64,
    /// A turn beyond this may cost more than one of another front to the same side, radians. What the other side costs must
    /// not count: left and right are alike.
    pub next_rad: f64,
    place: usize,
}

/// What a turn, or the line on which it ends, rules out.
pub(super) struct RuledOut {
    /// The turn, and the one up to which those at its climb target are, radians.
    pub turn_rad: f64,
    pub until_rad: f64,
    /// What another one has to move the aircraft by, metres, ...
    pub short_m: f64,
    /// ... how long that turn goes on, and the time from then to the closest approach, seconds.
    pub turns_s: f64,
    pub left_s: f64,
}

impl Search<'_> {
    /// Opens the fronts of all climb targets to a side.
    pub(super) fn open(&mut self, fronts: &mut Fronts, entry: &Entry, side: Side) {
        self.prepare_climbs(entry);
        if !self.meter.take(self.climbs.count.div_ceil(FILLED)) {
            return;
        }
        let bend = self.bend(side.sign() * entry.from.bank_rad, side);
        let least_rad = bend.map_or(f64::MIN, Bend::least_rad);
        let scene = &self.scene;
        (fronts.entry, fronts.side, fronts.count) = (*entry, side, self.climbs.count);
        // Objectives other than the paper's cost no front tells.
        fronts.cost = if scene.objective == Objective::PaperCost {
            scene.costs.0
        } else {
            0.0
        };
        fronts.free_rad = self.ahead_rad(&entry.from, side);
        for (place, climb_cost) in self.climbs.costs.iter().take(fronts.count).enumerate() {
            let cost = fronts.cost(least_rad, *climb_cost);
            fronts.put(place, least_rad, cost);
        }
    }

    /// Makes the climb targets those from the climb angle of an entry.
    fn prepare_climbs(&mut self, entry: &Entry) {
        let from_rad = entry.from.climb_rad;
        if self.climbs.count > 0 && self.climbs.from_rad == from_rad {
            return;
        }
        self.climbs.count = 0;
        let count = self.scene.climb_targets().count();
        if !self.meter.take(count.div_ceil(PREPARED)) {
            return;
        }
        let (mut count, mut original) = (0, 0);
        let has_costs = self.scene.objective == Objective::PaperCost;
        for (climb_rad, is_original) in self.scene.climb_targets() {
            let climbing = self.climbing(entry, climb_rad);
            let cost = self.climb_cost(climb_rad);
            let (all, costs) = (&mut self.climbs.all, &mut self.climbs.costs);
            if let (Some(slot), Some(slot_cost)) = (all.get_mut(count), costs.get_mut(count)) {
                *slot = climbing;
                *slot_cost = if has_costs { cost } else { f64::MIN };
                if is_original {
                    original = count;
                }
                count += 1;
            }
        }
        self.climbs.count = count;
        self.climbs.original = original;
        self.climbs.from_rad = from_rad;
    }

    /// The next turn that could be cheapest and cost less than `most`, of some sets of fronts, as far as lines tell: of a
    /// front that is ready.
    pub(super) fn next_ready(&mut self, sets: &mut [Fronts], most: f64) -> Option<Ready> {
        loop {
            let all: usize = sets.iter().map(|fronts| fronts.count).sum();
            if !self.meter.take(1 + all / COMPARED) {
                return None;
            }
            let (mut set, mut place, mut cost) = (0, 0, most);
            for (k, fronts) in sets.iter().enumerate() {
                let (cheapest, its_cost) = fronts.cheapest();
                if its_cost < cost {
                    (set, place, cost) = (k, cheapest, its_cost);
                }
            }
            if cost >= most {
                return None;
            }
            let fronts = sets.get_mut(set)?;
            self.prepare_climbs(&fronts.entry);
            if *fronts.is_ready.get(place)? || self.limit_met() {
                fronts.had_ready = true;
                let climb_cost = *self.climbs.costs.get(place)?;
                let next_cost = fronts.cost_of_others(place);
                return Some(Ready {
                    set,
                    way: self.way_of(fronts.side, place)?,
                    least_rad: *fronts.least_rad.get(place)?,
                    next_rad: fronts.free_rad + (next_cost - climb_cost) / fronts.cost,
                    place,
                });
            }
            self.advance(fronts, place);
            let is_open = sets.iter().any(|fronts| fronts.had_ready);
            let looked_at: usize = sets.iter().map(|fronts| fronts.looked_at).sum();
            if !is_open && looked_at >= all / PATIENCE && !self.may_be_ready(sets) {
                return None;
            }
        }
    }

    /// Whether lines leave a turn at the original climb angle or the steepest ones; without one, nothing is left.
    fn may_be_ready(&mut self, sets: &mut [Fronts]) -> bool {
        for fronts in &mut *sets {
            self.prepare_climbs(&fronts.entry);
            let steepest = self.climbs.count.saturating_sub(1);
            for place in [self.climbs.original, 0, steepest] {
                while let Some(least_rad) = fronts.least_rad.get(place)
                    && *least_rad < f64::INFINITY
                {
                    if fronts.is_ready.get(place).is_some_and(|ready| *ready) {
                        fronts.had_ready = true;
                        return true;
                    }
                    self.advance(fronts, place);
                }
            }
        }
        for fronts in sets {
            fronts.count = 0;
        }
        false
    }

    /// Takes the front of a turn out, or leaves it for turns from one on; rules out what a flight does beside it.
    pub(super) fn leave(
        &self,
        sets: &mut [Fronts],
        ready: &Ready,
        from_rad: f64,
        flight: Option<&RuledOut>,
    ) {
        let climb_cost = self.climbs.costs.get(ready.place);
        if let (Some(fronts), Some(climb_cost)) = (sets.get_mut(ready.set), climb_cost) {
            let cost = fronts.cost(from_rad, *climb_cost);
            fronts.put(ready.place, from_rad, cost);
            if let Some(flight) = flight
                && self.meter.take(fronts.count.div_ceil(FILLED))
            {
                self.rule_out_beside(fronts, ready.place, flight);
            }
        }
    }

    fn way_of(&self, side: Side, place: usize) -> Option<Way> {
        let climbing = *self.climbs.all.get(place)?;
        Some(Way { side, climbing })
    }

    /// The least turn to a side at a climb target that may do as far as lines tell, radians.
    pub(super) fn first_turn_rad(
        &mut self,
        from: &MotionState,
        side: Side,
        climb_rad: f64,
    ) -> Option<f64> {
        let entry = Self::entry_at(from, f64::INFINITY);
        let way = self.way(&entry, climb_rad, side);
        self.turn_rad(&entry, &way, (f64::MIN, MAX_TURN_RAD))
    }

    /// The least turn between two that may do as far as lines tell, radians.
    pub(super) fn turn_rad(
        &mut self,
        entry: &Entry,
        way: &Way,
        (least_rad, most_rad): (f64, f64),
    ) -> Option<f64> {
        let mut turn_rad = least_rad;
        while turn_rad <= most_rad.min(MAX_TURN_RAD) {
            let Some(ruled_out) = self.look_on(entry, way, turn_rad) else {
                return Some(turn_rad);
            };
            turn_rad = ruled_out.until_rad;
        }
        None
    }

    /// Looks at the line on which the first turn of a front ends: rules out what that tells, or makes it ready.
    fn advance(&mut self, fronts: &mut Fronts, place: usize) {
        fronts.looked_at += 1;
        let (Some(way), Some(least_rad), Some(climb_cost)) = (
            self.way_of(fronts.side, place),
            fronts.least_rad.get(place),
            self.climbs.costs.get(place).copied(),
        ) else {
            return;
        };
        let Some(ruled_out) = self.look_on(&fronts.entry, &way, *least_rad) else {
            if let Some(is_ready) = fronts.is_ready.get_mut(place) {
                *is_ready = true;
            }
            return;
        };
        let until_rad = ruled_out.until_rad;
        if until_rad <= MAX_TURN_RAD {
            fronts.put(place, until_rad, fronts.cost(until_rad, climb_cost));
        } else {
            fronts.close(place);
        }
        if self.meter.take(fronts.count.div_ceil(FILLED)) {
            self.rule_out_beside(fronts, place, &ruled_out);
        }
    }

    /// Rules out turns at climb targets next to that of a front.
    ///
    /// Another climb angle moves the aircraft by V Δθ t at most until the turn parts from that of the front, and by
    /// V √(Δψ² + Δθ²) t then, or by V Δθ t and V ω t² / 2 however far it turns on.
    fn rule_out_beside(&self, fronts: &mut Fronts, place: usize, ruled_out: &RuledOut) {
        let flyer = self.scene.flyer;
        let short_s = ruled_out.short_m / flyer.airspeed_mps();
        let turns_on_s = 0.5 * flyer.course_rate_radps() * ruled_out.left_s * ruled_out.left_s;
        let climbs = &self.climbs;
        let Some(here) = climbs.all.get(place) else {
            return;
        };
        let mut beside = |place: usize| {
            let (Some(climb), Some(climb_cost), Some(least_rad)) = (
                climbs.all.get(place),
                climbs.costs.get(place),
                fronts.least_rad.get(place),
            ) else {
                return false;
            };
            let beyond_rad = (climb.climb_rad - here.climb_rad).abs();
            let reach_rad = (short_s - beyond_rad * ruled_out.turns_s) / ruled_out.left_s;
            let half_rad = if ruled_out.left_s > 0.0 && reach_rad > beyond_rad {
                libm::sqrt(reach_rad * reach_rad - beyond_rad * beyond_rad)
            } else {
                0.0
            };
            // However far it turns on, it moves the aircraft by no more than this.
            let until_s = ruled_out.turns_s + ruled_out.left_s;
            let is_last = short_s > beyond_rad * until_s + turns_on_s;
            if half_rad <= 0.0 && !is_last {
                return false;
            }
            let until_rad = if is_last {
                f64::INFINITY
            } else {
                ruled_out.turn_rad + half_rad
            };
            let is_next = *least_rad >= ruled_out.turn_rad - half_rad;
            if is_next && until_rad > *least_rad {
                fronts.put(place, until_rad, fronts.cost(until_rad, *climb_cost));
            }
            true
        };
        let mut ups = (0..place).rev();
        let mut downs = place + 1..climbs.count;
        while ups.next().is_some_and(&mut beside) {}
        while downs.next().is_some_and(&mut beside) {}
    }

    /// What the line on which a turn ends and the way to it rule out; `None` where they tell too little.
    fn look_on(&mut self, entry: &Entry, way: &Way, least_rad: f64) -> Option<RuledOut> {
        if self.limit_met() {
            return None;
        }
        let tangent = self.tangent(entry, way, least_rad)?;
        let ruled_out = self.rules_out(entry, &tangent);
        ruled_out.or_else(|| self.way_rules_out(entry, way, &tangent))
    }

    /// What the way to the line on which a turn ends rules out; `None` where that tells too little. What comes too close on
    /// the arc does so however far it is followed.
    fn way_rules_out(&mut self, entry: &Entry, way: &Way, tangent: &Tangent) -> Option<RuledOut> {
        let (from, side) = (entry.from, way.side);
        let flyer = self.scene.flyer;
        let bank_rad = side.sign() * from.bank_rad;
        let target_m = self.scene.target_m;
        let turn_rad = tangent.turn_rad;
        let clear = Certificate::clear(target_m);
        let line = |(from_s, from_m): (f64, Vec3), (to_s, to_m): (f64, Vec3)| {
            let duration_s = to_s - from_s;
            Line {
                from_m,
                velocity_mps: (to_m - from_m) / duration_s,
                at_s: from_s,
                duration_s,
            }
        };
        let rates_radps = flyer.course_rate_radps() + flyer.climb_rate_radps();
        let bow_m = |lasts_s: f64, rates_radps: f64| {
            flyer.airspeed_mps() * rates_radps * lasts_s * lasts_s / 8.0
        };
        let mut here = (from.time_s, from.position_m);
        let end = (tangent.state.time_s, tangent.state.position_m);
        let whole_s = end.0 - here.0;
        if whole_s <= 0.0 {
            return None;
        }
        // Mostly one line shows that the whole way is clear.
        let enough_m = target_m + bow_m(whole_s, rates_radps);
        let one = self.on_line(&line(here, end), &Certificate::clear(enough_m), enough_m);
        if one.margin_m >= enough_m {
            return None;
        }
        let least_rad = self.bend(bank_rad, side)?.least_rad();
        let steps = whole((turn_rad - least_rad) / ARC_STEP_RAD, MOST_ARC_STEPS);
        let step_rad = (turn_rad - least_rad) / steps as f64;
        let climbs_until_s = from.time_s + way.climbing.climbs_s;
        // How far aside of that line the roll-out begins, metres.
        let on_line_m = |at_s: f64| end.1 - tangent.velocity_mps * (end.0 - at_s);
        let mut aside_m = Vec3::ZERO;
        let half_out_s = tangent.parts_s + flyer.bank_time_constant_s();
        for step in 1..=steps + 2 {
            let is_arc = step <= steps;
            let at_rad = turn_rad.min(least_rad + step_rad * step as f64);
            let there = if is_arc {
                let exit = self.bend(bank_rad, side)?.exit(at_rad)?;
                let there = (from.time_s + exit.begins_s, entry.place_m(&exit, way));
                aside_m = there.1 - on_line_m(there.0);
                there
            } else if step == steps + 1 {
                (half_out_s, on_line_m(half_out_s) + aside_m * LEFT_ASIDE)
            } else {
                end
            };
            let lasts_s = there.0 - here.0;
            if lasts_s <= 0.0 {
                continue;
            }
            let climbs_radps = f64::from(here.0 < climbs_until_s) * flyer.climb_rate_radps();
            let bow_m = if is_arc {
                bow_m(lasts_s, flyer.course_rate_radps() + climbs_radps)
            } else {
                bow_m(lasts_s, climbs_radps) + BOWS_ASIDE * aside_m.length()
            };
            let floor_m = target_m - bow_m - tangent.inexact_m;
            let found = self.on_line(&line(here, there), &clear, floor_m);
            if found.margin_m < floor_m {
                let short_m = floor_m - found.margin_m;
                let left_s = (found.at_s - tangent.parts_s).max(0.0);
                let step_rad = self.least_more_rad(short_m, left_s);
                return Some(RuledOut {
                    turn_rad: at_rad,
                    until_rad: turn_rad + step_rad.max(LEAST_STEP_RAD),
                    short_m,
                    turns_s: found.at_s - left_s - entry.wait_s(),
                    left_s,
                });
            }
            here = there;
        }
        None
    }

    /// What the line on which a turn ends rules out; `None` where that tells too little.
    ///
    /// A turn that goes on has moved the aircraft only so far by the moment of the closest approach
    /// ([`Self::least_more_rad`]).
    fn rules_out(&mut self, entry: &Entry, tangent: &Tangent) -> Option<RuledOut> {
        let target_m = self.scene.target_m;
        let look = self.look_along(tangent, target_m)?;
        let short_m = target_m - look.margin_m - look.inexact_m;
        if short_m <= 0.0 {
            return None;
        }
        let turn_rad = tangent.turn_rad;
        let step_rad = self.least_more_rad(short_m, look.left_s);
        (step_rad > LEAST_STEP_RAD).then_some(RuledOut {
            turn_rad,
            until_rad: turn_rad + step_rad,
            short_m,
            turns_s: tangent.parts_s - entry.wait_s(),
            left_s: look.left_s,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga_proof::maneuver::Maneuver;
    use fga_proof::prediction::{FlightPath, Flyer};
    use fga_proof::vehicle::Vehicle;

    /// Nearer to a hazard than the two lines less this, a turn is ruled out.
    #[test]
    fn a_roll_out_keeps_near_two_lines() {
        for (lag_s, speed_mps, radius_m) in [
            (0.25, 12.0, 20.0),
            (0.6, 15.0, 30.0),
            (0.6, 22.0, 66.7),
            (1.2, 50.0, 400.0),
        ] {
            let flyer = Flyer::new(&Vehicle {
                airspeed_mps: speed_mps,
                turn_radius_m: radius_m,
                ..Vehicle::lagged(lag_s)
            });
            for share in [0.2, 0.6, 1.0] {
                let bank_rad = share * flyer.full_bank_rad();
                let start = MotionState::ahead(bank_rad);
                let turn = Maneuver::turn(0.0, flyer.rollout_rad(bank_rad), 0.0);
                let mut path = FlightPath::new();
                path.predict(&flyer, &start, &turn, 60.0);
                let end_s = 4.0 * lag_s;
                let at_m = |at_s| path.state_at(&flyer, at_s).unwrap().position_m;
                let velocity_mps = path.end_velocity_mps();
                let aside_m = |at_s: f64| at_m(at_s) - at_m(end_s) + velocity_mps * (end_s - at_s);
                let begins_m = aside_m(0.0);
                let near_m = BOWS_ASIDE * begins_m.length() + 1e-3 * radius_m;
                for k in 0..=40 {
                    let at_s = 0.1 * f64::from(k) * lag_s;
                    let left = if at_s < lag_s {
                        1.0 + (LEFT_ASIDE - 1.0) * at_s / lag_s
                    } else {
                        LEFT_ASIDE * (end_s - at_s) / (end_s - lag_s)
                    };
                    let off_m = aside_m(at_s).distance(begins_m * left);
                    assert!(
                        off_m < near_m,
                        "{lag_s} {share} {at_s}: {off_m} of {near_m}"
                    );
                }
            }
        }
    }
}
