//! Which single turn can be cheapest, told from the lines on which turns end: branch and bound.
//!
//! Turns to one side at one climb target are a *front*: those up to some turn are ruled out, and what is left of it costs
//! at least as much as the turn it begins with. The front that could be cheapest is looked at next. On the line on which
//! its first turn ends an obstacle comes too close, and turns that go on by too little to have moved the aircraft out of
//! its way by then are ruled out with it; or none does, and the front is swept from there.

use crate::Vec3;
use crate::angle::Side;
use crate::certificate::{Certificate, Line};
use crate::limit::Limit as _;
use crate::prediction::{Bend, Exit, MotionState, whole};

use super::sweep::{LONGEST_STEP_RAD, Sweep};
use super::{BEND, Found, MAX_TURN_RAD, Objective, Search, Turns};

/// Most climb targets.
const MOST_CLIMBS: usize = 129;

/// Most fronts: climb targets to either side.
const MOST_FRONTS: usize = 2 * MOST_CLIMBS;

/// Where no more than this can be ruled out at once, the rest is swept, radians.
const LEAST_STEP_RAD: f64 = 0.01;

/// What the line of the smallest turn keeps beyond the target, turn radii.
const NEAR: f64 = 0.005;

/// Metres that a turn moves the aircraft away from a hazard, as a share of those that it moves it by.
const USUAL: f64 = 0.7;

/// Most lines on the way to the smallest turn that does.
const LINES: usize = 3;

/// It is no farther from the first one that may do, radians.
const MOST_BY_LINES_RAD: f64 = 0.04;

/// Chords of an arc, radians, and how many at most.
const ARC_STEP_RAD: f64 = 0.35;
const MOST_ARC_STEPS: usize = 20;

/// What a line takes to be set up, in units of work.
const LINE: usize = 4;

/// Turns to one side at one climb target.
#[derive(Debug, Clone, Copy)]
struct Front {
    climb_rad: f64,
    side: Side,
    /// Smaller turns are ruled out, radians; infinite where all are.
    least_rad: f64,
    /// The least that a turn can cost that is not.
    cost: f64,
    /// Whether its first turn may do, as far as lines tell.
    is_ready: bool,
}

impl Front {
    const NONE: Self = Self {
        climb_rad: 0.0,
        side: Side::Left,
        least_rad: f64::INFINITY,
        cost: f64::INFINITY,
        is_ready: false,
    };

    const fn is_closed(&self) -> bool {
        self.least_rad == f64::INFINITY
    }

    const fn close(&mut self) {
        (self.least_rad, self.cost) = (f64::INFINITY, f64::INFINITY);
    }
}

/// Where a turn begins, and the margin up to there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    from: MotionState,
    before_m: f64,
    /// Cosine and sine of the course and of the climb angle.
    course: (f64, f64),
    climb: (f64, f64),
}

impl Entry {
    /// When it is, seconds.
    pub(super) const fn wait_s(&self) -> f64 {
        self.from.time_s
    }

    /// Where a turn's roll-out begins, metres.
    fn place_m(&self, exit: &Exit, side: Side, climbing: &Climbing) -> Vec3 {
        let Climbing {
            climbs_s,
            level,
            along_m,
            ..
        } = *climbing;
        let share = if exit.begins_s < climbs_s {
            exit.begins_s / climbs_s
        } else {
            1.0
        };
        let ahead_m = level * exit.at_m.0 + share * along_m;
        let left_m = level * side.sign() * exit.at_m.1;
        let (cos, sin) = self.course;
        // While it climbs, by the angle halfway.
        let path_m = exit.path_m;
        let up_m = if share < 1.0 {
            path_m * (self.climb.1 + 0.5 * share * (climbing.up - self.climb.1))
        } else {
            path_m * climbing.up + climbing.up_m
        };
        self.from.position_m
            + Vec3::new(
                ahead_m * cos - left_m * sin,
                ahead_m * sin + left_m * cos,
                up_m,
            )
    }

    const fn turns(&self, turn_rad: f64, climb_rad: f64) -> Turns {
        Turns {
            wait_s: self.from.time_s,
            turn_rad,
            climb_rad,
            second: None,
        }
    }
}

/// A change of climb angle, and what it moves the aircraft by beyond flying at its target at once.
#[derive(Debug, Clone, Copy)]
struct Climbing {
    /// Sine and cosine of the target.
    up: f64,
    level: f64,
    /// How long it takes, seconds.
    climbs_s: f64,
    /// Along the course and up, metres.
    along_m: f64,
    up_m: f64,
}

/// The straight line on which a turn ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tangent {
    /// The aircraft on it, all of its turn and climb over.
    pub state: MotionState,
    pub velocity_mps: Vec3,
    /// When turns that go on leave this one, seconds.
    parts_s: f64,
    /// How far the line may be from the true one, metres.
    inexact_m: f64,
}

/// What the line on which a turn ends tells.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::struct_field_names, reason = "the postfix is the unit")]
struct Look {
    margin_m: f64,
    /// How far turning on by a radian moves the aircraft at most by the closest approach, metres.
    lever_m: f64,
    inexact_m: f64,
}

/// The fronts of a search.
pub(super) struct Fronts {
    all: [Front; MOST_FRONTS],
    count: usize,
}

impl Fronts {
    /// None yet.
    pub(super) const fn new() -> Self {
        Self {
            all: [Front::NONE; MOST_FRONTS],
            count: 0,
        }
    }

    fn all_mut(&mut self) -> &mut [Front] {
        self.all.get_mut(..self.count).unwrap_or(&mut [])
    }

    fn push(&mut self, front: Front) {
        if let Some(slot) = self.all.get_mut(self.count) {
            *slot = front;
            self.count += 1;
        }
    }

    /// The front that could be cheapest, if any is left.
    fn next_mut(&mut self) -> Option<&mut Front> {
        let mut least = f64::INFINITY;
        let mut place = 0;
        for (k, front) in self.all_mut().iter().enumerate() {
            if front.cost < least {
                (least, place) = (front.cost, k);
            }
        }
        self.all_mut()
            .get_mut(place)
            .filter(|front| !front.is_closed())
    }
}

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

    /// Where turns begin after a wait; `None` where that comes too close before.
    pub(super) fn entry(&mut self, wait_s: f64) -> Option<Entry> {
        let before_m = self.margin_before(wait_s);
        if before_m < self.scene.target_m {
            return None;
        }
        let from = self.departure(wait_s);
        let any = Turns {
            wait_s,
            turn_rad: 0.0,
            climb_rad: 0.0,
            second: None,
        };
        // The corners before it may leave no room for the turn.
        let is_whole = self.maneuver(&any, &from).is_whole();
        is_whole.then(|| Self::entry_at(&from, before_m))
    }

    fn entry_at(from: &MotionState, before_m: f64) -> Entry {
        let unit = |angle_rad| {
            let (sin, cos) = libm::sincos(angle_rad);
            (cos, sin)
        };
        Entry {
            from: *from,
            before_m,
            course: unit(from.course_rad),
            climb: unit(from.climb_rad),
        }
    }

    /// Fills in the fronts of all climb targets to some sides; false where no turn at the original climb angle, the
    /// steepest climb or descent may do: hardly ever does one in between.
    pub(super) fn open(&mut self, entry: &Entry, sides: &[Side], fronts: &mut Fronts) -> bool {
        let scene = self.scene;
        fronts.count = 0;
        for climb_rad in scene.climb_targets() {
            for side in sides {
                let cost = self.least_cost(&entry.from, (climb_rad, *side), 0.0);
                fronts.push(Front {
                    climb_rad,
                    side: *side,
                    least_rad: f64::MIN,
                    cost,
                    is_ready: false,
                });
            }
        }
        let mut may_do = false;
        let (low, high) = scene.climb_limits_rad;
        for (place, front) in fronts.all_mut().iter_mut().enumerate() {
            let is_original = place < sides.len();
            let is_steepest = front.climb_rad == low || front.climb_rad == high;
            if is_original || (!may_do && is_steepest) {
                while !front.is_closed() && !front.is_ready {
                    self.advance(entry, front);
                }
                may_do |= front.is_ready;
            }
        }
        may_do
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

    /// The least that a turn of at least `least_rad` can cost.
    fn least_cost(
        &self,
        from: &MotionState,
        (climb_rad, side): (f64, Side),
        least_rad: f64,
    ) -> f64 {
        let scene = &self.scene;
        if scene.objective != Objective::PaperCost {
            return f64::MIN;
        }
        let offset = (scene.original.0 - from.course_rad) * side.sign();
        scene.costs.0 * (least_rad - offset).max(0.0)
            + scene.costs.1 * (climb_rad - scene.original.1).abs()
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

    /// The least turn to a side at a climb target that may do as far as lines tell, radians.
    pub(super) fn first_turn_rad(
        &mut self,
        from: &MotionState,
        side: Side,
        climb_rad: f64,
    ) -> Option<f64> {
        let entry = Self::entry_at(from, f64::INFINITY);
        let mut front = Front {
            climb_rad,
            side,
            least_rad: f64::MIN,
            ..Front::NONE
        };
        while !front.is_ready {
            if front.is_closed() {
                return None;
            }
            self.advance(&entry, &mut front);
        }
        Some(front.least_rad)
    }

    /// Whether a turn may do as far as the line tells on which it ends.
    pub(super) fn may_do(
        &mut self,
        from: &MotionState,
        (climb_rad, side): (f64, Side),
        turn_rad: f64,
    ) -> bool {
        let entry = Self::entry_at(from, f64::INFINITY);
        let target_m = self.scene.target_m;
        self.look(&entry, (climb_rad, side), turn_rad, target_m)
            .is_none_or(|look| look.margin_m + look.inexact_m >= target_m)
    }

    /// Looks at the line on which the first turn of a front ends: rules out what that tells, or makes it ready.
    fn advance(&mut self, entry: &Entry, front: &mut Front) {
        let ruled_out = self
            .rules_out_rad(entry, front)
            .or_else(|| self.way_rules_out_rad(entry, front));
        match ruled_out {
            Some(until_rad) if until_rad <= MAX_TURN_RAD => {
                front.least_rad = until_rad;
                let what = (front.climb_rad, front.side);
                front.cost = self.least_cost(&entry.from, what, until_rad);
            }
            Some(_) => front.close(),
            None => front.is_ready = true,
        }
    }

    /// The turn up to which those of a front are ruled out by the way to the line on which its first one ends, radians;
    /// `None` where that tells too little. What comes too close on the arc does so however far it is followed.
    fn way_rules_out_rad(&mut self, entry: &Entry, front: &Front) -> Option<f64> {
        if self.limit_met() {
            return None;
        }
        let (from, side) = (entry.from, front.side);
        let what = (front.climb_rad, side);
        let tangent = self.tangent(entry, what, front.least_rad)?;
        let bend = *self.bend(side.sign() * from.bank_rad, side)?;
        let climbing = self.climbing(entry, front.climb_rad);
        let target_m = self.scene.target_m;
        let clear = Certificate::clear(target_m);
        let least_rad = bend.least_rad();
        let turn_rad = front.least_rad.max(least_rad);
        let steps = whole((turn_rad - least_rad) / ARC_STEP_RAD, MOST_ARC_STEPS);
        let step_rad = (turn_rad - least_rad) / steps as f64;
        let mut here = (from.time_s, from.position_m);
        for step in 1..=steps + 1 {
            let exit = bend.exit(turn_rad.min(least_rad + step_rad * step as f64))?;
            let is_arc = step <= steps;
            let there = if is_arc {
                let place_m = entry.place_m(&exit, side, &climbing);
                (from.time_s + exit.begins_s, place_m)
            } else {
                (tangent.state.time_s, tangent.state.position_m)
            };
            let lasts_s = there.0 - here.0;
            if lasts_s <= 0.0 {
                continue;
            }
            let flyer = self.scene.flyer;
            let turns_radps = if is_arc {
                flyer.course_rate_radps()
            } else {
                0.0
            };
            let rates_radps = turns_radps + flyer.climb_rate_radps();
            let bow_m = flyer.airspeed_mps() * rates_radps * lasts_s * lasts_s / 8.0;
            let rolls_m = if is_arc { 0.0 } else { exit.rolls_out_m() };
            let floor_m = target_m - bow_m - rolls_m - tangent.inexact_m;
            let line = Line {
                from_m: here.1,
                velocity_mps: (there.1 - here.1) / lasts_s,
                at_s: here.0,
                duration_s: lasts_s,
            };
            let found = self.on_line(&line, &clear, floor_m);
            if found.margin_m < floor_m {
                if is_arc {
                    return Some(f64::INFINITY);
                }
                let lever_m = flyer.airspeed_mps() * (found.at_s - tangent.parts_s);
                let step_rad = (floor_m - found.margin_m) / lever_m.max(f64::MIN_POSITIVE);
                return Some(turn_rad + step_rad.max(LEAST_STEP_RAD));
            }
            here = there;
        }
        None
    }

    /// The turn up to which those of a front are ruled out by the line on which its first one ends, radians; `None`
    /// where that tells too little.
    ///
    /// A turn that goes on by Δψ has moved the aircraft by less than V Δψ (t − t₀) at the moment t of the closest
    /// approach, where t₀ is when the roll-out of the first one begins.
    fn rules_out_rad(&mut self, entry: &Entry, front: &Front) -> Option<f64> {
        if self.limit_met() {
            return None;
        }
        let what = (front.climb_rad, front.side);
        let bank_rad = front.side.sign() * entry.from.bank_rad;
        let turn_rad = front
            .least_rad
            .max(self.bend(bank_rad, front.side)?.least_rad());
        let target_m = self.scene.target_m;
        let look = self.look(entry, what, turn_rad, target_m)?;
        let short_m = target_m - look.margin_m - look.inexact_m;
        if short_m <= 0.0 {
            return None;
        }
        if look.lever_m <= 0.0 {
            return Some(f64::INFINITY);
        }
        let step_rad = short_m / look.lever_m;
        (step_rad > LEAST_STEP_RAD).then_some(turn_rad + step_rad)
    }

    /// The margin on the line on which a turn ends, up to `enough_m`; once it is below the target it may be that of any
    /// hazard. `None` where the turn is not over before the horizon.
    fn look(
        &mut self,
        entry: &Entry,
        what: (f64, Side),
        turn_rad: f64,
        enough_m: f64,
    ) -> Option<Look> {
        let tangent = self.tangent(entry, what, turn_rad)?;
        if tangent.state.time_s >= self.scene.horizon_s {
            return None;
        }
        let clear = Certificate::clear(enough_m);
        let (state, velocity_mps) = (&tangent.state, tangent.velocity_mps);
        let line = self.straight_on(state, velocity_mps, &clear, self.scene.target_m);
        Some(Look {
            margin_m: line.margin_m,
            lever_m: self.scene.flyer.airspeed_mps() * (line.at_s - tangent.parts_s),
            inexact_m: tangent.inexact_m,
        })
    }

    /// The line on which a turn to a side at a climb target ends.
    fn tangent(
        &mut self,
        entry: &Entry,
        (climb_rad, side): (f64, Side),
        turn_rad: f64,
    ) -> Option<Tangent> {
        self.meter.count(LINE);
        let Entry { from, course, .. } = entry;
        let sign = side.sign();
        let bend = self.bend(sign * from.bank_rad, side)?;
        let turn_rad = turn_rad.max(bend.least_rad());
        let exit = bend.exit(turn_rad)?;
        let inexact_m = bend.inexact_m();
        let Climbing {
            up,
            level,
            climbs_s,
            along_m,
            up_m,
        } = self.climbing(entry, climb_rad);
        let speed_mps = self.scene.flyer.airspeed_mps();
        let turned = (exit.turned.0, sign * exit.turned.1);
        let end = (
            course.0 * turned.0 - course.1 * turned.1,
            course.1 * turned.0 + course.0 * turned.1,
        );
        let after_s = exit.over_s.max(climbs_s);
        let straight_m = level * speed_mps * (after_s - exit.begins_s);
        // On which course it climbs is not told: half on either.
        let half_m = 0.5 * along_m;
        let (ahead_m, left_m) = (level * exit.from_m.0 + half_m, level * sign * exit.from_m.1);
        let end_m = straight_m + half_m;
        let moved_m = Vec3::new(
            ahead_m * course.0 - left_m * course.1 + end_m * end.0,
            ahead_m * course.1 + left_m * course.0 + end_m * end.1,
            up * speed_mps * after_s + up_m,
        );
        Some(Tangent {
            state: MotionState {
                time_s: from.time_s + after_s,
                position_m: from.position_m + moved_m,
                course_rad: from.course_rad + sign * turn_rad,
                climb_rad,
                bank_rad: 0.0,
            },
            velocity_mps: Vec3::new(level * end.0, level * end.1, up) * speed_mps,
            parts_s: from.time_s + exit.begins_s,
            inexact_m: inexact_m + along_m.abs(),
        })
    }

    /// What changing the climb angle moves the aircraft by, by the means of cos θ and sin θ while θ changes.
    fn climbing(&self, entry: &Entry, climb_rad: f64) -> Climbing {
        let flyer = self.scene.flyer;
        let (low, high) = self.scene.climb_limits_rad;
        let climb_rad = climb_rad.limited(low, high);
        let change_rad = climb_rad - entry.from.climb_rad;
        let (level_now, up_now) = entry.climb;
        let mut climbing = Climbing {
            up: up_now,
            level: level_now,
            climbs_s: 0.0,
            along_m: 0.0,
            up_m: 0.0,
        };
        if change_rad.abs() > 1e-9 && flyer.climb_rate_radps() > 0.0 {
            let (up, level) = libm::sincos(climb_rad);
            let climbs_s = change_rad.abs() / flyer.climb_rate_radps();
            let path_m = flyer.airspeed_mps() * climbs_s;
            climbing = Climbing {
                up,
                level,
                climbs_s,
                along_m: path_m * ((up - up_now) / change_rad - level),
                up_m: path_m * ((level_now - level) / change_rad - up),
            };
        }
        climbing
    }

    /// Turns to a side from a bank that is positive towards it.
    fn bend(&mut self, bank_rad: f64, side: Side) -> Option<&Bend> {
        let known = |bend: &Option<Bend>| bend.as_ref().is_some_and(|bend| bend.is_from(bank_rad));
        let place = self.bends.iter().position(known).unwrap_or_else(|| {
            let place = usize::from(side == Side::Right);
            if let Some(slot) = self.bends.get_mut(place) {
                self.meter.count(BEND);
                *slot = Bend::new(self.scene.flyer, bank_rad);
            }
            place
        });
        self.bends.get(place)?.as_ref()
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
    use crate::certificate::{Hazard, Hazards};
    use crate::maneuver::Maneuver;
    use crate::prediction::{FlightPath, Flyer};
    use crate::search::Scene;
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
            let start = MotionState {
                time_s: 0.0,
                position_m: Vec3::ZERO,
                course_rad: 0.0,
                climb_rad: 0.0,
                bank_rad: if lagged { bank_rad } else { 0.0 },
            };
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
