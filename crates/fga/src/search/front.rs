//! Fronts: turns to one side at one climb target, of which lines rule out the smaller ones.
//!
//! On the line on which a front's first turn ends an obstacle comes too close, and turns that go on by too little to
//! have moved the aircraft out of its way by then are ruled out with it; or none does, and the front is ready.

use crate::angle::Side;
use crate::certificate::{Certificate, Line};
use crate::meter::COMPARED;
use crate::prediction::{MotionState, whole};

use super::line::Entry;
use super::{MAX_TURN_RAD, Objective, Search};

/// Most climb targets.
const MOST_CLIMBS: usize = 129;

/// Most fronts: climb targets to either side.
const MOST_FRONTS: usize = 2 * MOST_CLIMBS;

/// Fronts that one unit of work fills in.
const FILLED: usize = 8;

/// Where no more than this can be ruled out at once, the rest is swept, radians.
const LEAST_STEP_RAD: f64 = 0.01;

/// Chords of an arc, radians, and how many at most.
const ARC_STEP_RAD: f64 = 0.35;
const MOST_ARC_STEPS: usize = 20;

/// Turns to one side at one climb target.
#[derive(Debug, Clone, Copy)]
pub(super) struct Front {
    pub climb_rad: f64,
    pub side: Side,
    /// Smaller turns are ruled out, radians; infinite where all are.
    pub least_rad: f64,
    /// The least that a turn can cost that is not.
    pub cost: f64,
    /// Whether its first turn may do, as far as lines tell.
    pub is_ready: bool,
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

    pub(super) const fn close(&mut self) {
        (self.least_rad, self.cost) = (f64::INFINITY, f64::INFINITY);
    }
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

    /// What looking for the next one takes, in units of work.
    pub(super) const fn work_of_next(&self) -> usize {
        1 + self.count / COMPARED
    }

    /// The front that could be cheapest, if any is left.
    pub(super) fn next_mut(&mut self) -> Option<&mut Front> {
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
    /// Fills in the fronts of all climb targets to some sides; false where no turn at the original climb angle, the
    /// steepest climb or descent may do: hardly ever does one in between.
    pub(super) fn open(&mut self, entry: &Entry, sides: &[Side], fronts: &mut Fronts) -> bool {
        let scene = self.scene;
        fronts.count = 0;
        let count = scene.climb_targets().count() * sides.len();
        if !self.meter.take(count.div_ceil(FILLED)) {
            return false;
        }
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

    /// The least turn to a side at a climb target that may do as far as lines tell, radians.
    pub(super) fn first_turn_rad(
        &mut self,
        from: &MotionState,
        side: Side,
        climb_rad: f64,
    ) -> Option<f64> {
        let entry = Self::entry_at(from, f64::INFINITY);
        self.turn_rad(&entry, (climb_rad, side), (f64::MIN, MAX_TURN_RAD))
    }

    /// The least turn between two that may do as far as lines tell, radians.
    pub(super) fn turn_rad(
        &mut self,
        entry: &Entry,
        (climb_rad, side): (f64, Side),
        (least_rad, most_rad): (f64, f64),
    ) -> Option<f64> {
        let mut front = Front {
            climb_rad,
            side,
            least_rad,
            ..Front::NONE
        };
        while !front.is_ready {
            if front.least_rad > most_rad {
                return None;
            }
            self.advance(entry, &mut front);
        }
        Some(front.least_rad)
    }

    /// Looks at the line on which the first turn of a front ends: rules out what that tells, or makes it ready.
    pub(super) fn advance(&mut self, entry: &Entry, front: &mut Front) {
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
                let left_s = found.at_s - tangent.parts_s;
                let step_rad = self.least_more_rad(floor_m - found.margin_m, left_s);
                return Some(turn_rad + step_rad.max(LEAST_STEP_RAD));
            }
            here = there;
        }
        None
    }

    /// The turn up to which those of a front are ruled out by the line on which its first one ends, radians; `None`
    /// where that tells too little.
    ///
    /// A turn that goes on has moved the aircraft only so far by the moment of the closest approach
    /// ([`Self::least_more_rad`]).
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
        let step_rad = self.least_more_rad(short_m, look.left_s);
        (step_rad > LEAST_STEP_RAD).then_some(turn_rad + step_rad)
    }
}
