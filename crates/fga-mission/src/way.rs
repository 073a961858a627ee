//! Where a join leads, about, without flying it: its places in time.

use super::aim::{Shot, Turning, Turns};
use fga_proof::Vec3;
use fga_proof::certificate::Line;
use fga_proof::prediction::{Bend, Flyer, MotionState};

/// Places on each of the two turns.
const ARC_PLACES: usize = 4;

/// Moments at which a climb changes: the end of a change to a climb angle, and both ends of the change to that of the leg.
const CHANGES: usize = 3;

/// Places of a way: its beginning, two turns and the straight flight after each, and where its climb changes.
const PLACES: usize = 2 * ARC_PLACES + 3 + CHANGES;

/// Where the aircraft is at a moment of a way.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Place {
    /// In the air, metres.
    pub at_m: Vec3,
    /// Seconds from the decision.
    pub at_s: f64,
    /// How far the flight bows from the line that leads here, metres.
    bow_m: f64,
}

/// Where a join leads, about.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Way {
    places: [Place; PLACES],
    len: usize,
    /// The join.
    pub shot: Shot,
}

impl Way {
    /// Begins anew at a state.
    fn begin(&mut self, state: &MotionState, shot: &Shot) {
        (self.len, self.shot) = (0, *shot);
        self.push(Place {
            at_m: state.position_m,
            at_s: state.time_s,
            bow_m: 0.0,
        });
    }

    fn push(&mut self, place: Place) {
        if let Some(slot) = self.places.get_mut(self.len) {
            *slot = place;
            self.len += 1;
        }
    }

    /// The places, in the order of their times.
    pub(crate) fn places(&self) -> &[Place] {
        self.places.get(..self.len).unwrap_or(&[])
    }

    /// The last place.
    pub fn end(&self) -> Option<&Place> {
        self.places().last()
    }

    /// The lines between the places, and how far the flight bows from each, metres.
    pub fn lines(&self) -> impl Iterator<Item = (Line, f64)> {
        self.places().windows(2).filter_map(|pair| {
            let [from, to] = pair else { return None };
            let duration_s = to.at_s - from.at_s;
            let line = Line {
                from_m: from.at_m,
                velocity_mps: (to.at_m - from.at_m) / duration_s,
                at_s: from.at_s,
                duration_s,
            };
            (duration_s > 0.0).then_some((line, to.bow_m))
        })
    }
}

impl Turns<'_> {
    /// Lays out where a join with two turns leads.
    pub(super) fn lay(
        &self,
        way: &mut Way,
        state: &MotionState,
        (shot, [first, second]): &(Shot, [Turning; 2]),
    ) {
        way.begin(state, shot);
        let mut walk = Walk::new(way, self.flyer, state, shot);
        walk.turn(first, (self.flyer, self.bend(first.side)));
        walk.on(first, shot.turn_at_s - state.time_s);
        walk.turn(second, (self.flyer, self.level));
        walk.on(second, second.exit.over_s);
        walk.climb_on(second);
    }
}

/// A way from place to place.
struct Walk<'a> {
    way: &'a mut Way,
    airspeed_mps: f64,
    course_rate_radps: f64,
    climb: Climb,
    begins_s: f64,
    place_m: Vec3,
    /// Seconds of flight, and what the climb has done in it.
    since_s: f64,
    climbed: Climbed,
    /// The same time at the beginning of the present turn, and where level flight would have led since, metres.
    turn_s: f64,
    turned_m: Vec3,
}

impl<'a> Walk<'a> {
    fn new(way: &'a mut Way, flyer: &Flyer, state: &MotionState, shot: &Shot) -> Self {
        let climb = Climb::new(flyer, state, shot);
        Self {
            way,
            airspeed_mps: flyer.airspeed_mps(),
            course_rate_radps: flyer.course_rate_radps(),
            climbed: climb.after(0.0),
            climb,
            begins_s: state.time_s,
            place_m: state.position_m,
            since_s: 0.0,
            turn_s: 0.0,
            turned_m: Vec3::ZERO,
        }
    }

    /// On for a time, by what level flight would move the aircraft; a climb shortens it.
    fn go(&mut self, level_m: Vec3, for_s: f64, turn_radps: f64) {
        if for_s <= 0.0 {
            return;
        }
        self.since_s += for_s;
        let before = self.climbed;
        self.climbed = self.climb.after(self.since_s);
        let by_m = self.climbed.by_m - before.by_m;
        let share = by_m.x / (self.airspeed_mps * for_s);
        self.place_m += level_m * share + Vec3::new(0.0, 0.0, by_m.z);
        let bends_rad = turn_radps * for_s + (self.climbed.climb_rad - before.climb_rad).abs();
        self.way.push(Place {
            at_m: self.place_m,
            at_s: self.begins_s + self.since_s,
            bow_m: self.airspeed_mps * for_s * bends_rad / 8.0,
        });
    }

    /// Round a turn, until the aircraft begins to roll out.
    fn turn(&mut self, turning: &Turning, (flyer, bend): (&Flyer, Option<&Bend>)) {
        (self.turn_s, self.turned_m) = (self.since_s, Vec3::ZERO);
        let step_s = turning.exit.begins_s / ARC_PLACES as f64;
        if step_s <= 0.0 {
            return;
        }
        for place in 1..=ARC_PLACES {
            let turned = bend.and_then(|bend| bend.place_m(flyer, step_s * place as f64));
            let there_m = turning.turned_m(turned.unwrap_or_default());
            self.go(there_m - self.turned_m, step_s, self.course_rate_radps);
            self.turned_m = there_m;
        }
    }

    /// Straight on after a turn, until a time after its beginning.
    fn on(&mut self, turning: &Turning, until_s: f64) {
        let exit = &turning.exit;
        let straight_m = self.airspeed_mps * (until_s - exit.begins_s);
        let there_m = turning.turned_m(exit.from_m) + turning.turned_m(exit.turned) * straight_m;
        let until_s = self.turn_s + until_s;
        let level_mps = (there_m - self.turned_m) / (until_s - self.since_s);
        self.straight(level_mps, until_s);
    }

    /// Along the leg until the climb is over.
    fn climb_on(&mut self, last: &Turning) {
        let [.., over_s] = self.climb.changes_s();
        if over_s.is_finite() {
            let level_mps = last.turned_m(last.exit.turned) * self.airspeed_mps;
            self.straight(level_mps, over_s);
        }
    }

    /// Straight on, with a place wherever the climb changes.
    fn straight(&mut self, level_mps: Vec3, until_s: f64) {
        for change_s in self.climb.changes_s() {
            let for_s = change_s.min(until_s) - self.since_s;
            self.go(level_mps * for_s, for_s, 0.0);
        }
        let for_s = until_s - self.since_s;
        self.go(level_mps * for_s, for_s, 0.0);
    }
}

/// What a climb has done in a time.
#[derive(Clone, Copy)]
struct Climbed {
    /// Forward, none to the side, and up, metres.
    by_m: Vec3,
    climb_rad: f64,
}

/// The climb of a join: to one climb angle, and from a moment on to that of the leg.
struct Climb {
    first: Ramp,
    level: Ramp,
    /// When the second change begins, seconds from now; infinite where there is none.
    level_s: f64,
}

impl Climb {
    fn new(flyer: &Flyer, state: &MotionState, shot: &Shot) -> Self {
        Self {
            first: Ramp::new(flyer, state.climb_rad, shot.climb),
            level: Ramp::new(flyer, shot.climb, shot.final_climb),
            level_s: if shot.climb == shot.final_climb {
                f64::INFINITY
            } else {
                shot.level_at_s - state.time_s
            },
        }
    }

    /// When it changes, seconds from now.
    fn changes_s(&self) -> [f64; CHANGES] {
        let over_s = self.level_s + self.level.lasts_s;
        [self.first.lasts_s, self.level_s, over_s]
    }

    /// What it has done after a time.
    fn after(&self, since_s: f64) -> Climbed {
        let levelled_s = since_s - self.level_s;
        let first = self.first.after(since_s.min(self.level_s));
        if levelled_s <= 0.0 {
            return first;
        }
        let level = self.level.after(levelled_s);
        Climbed {
            by_m: first.by_m + level.by_m,
            ..level
        }
    }
}

/// A change of climb angle and the flight after it.
struct Ramp {
    airspeed_mps: f64,
    from_rad: f64,
    rate_radps: f64,
    lasts_s: f64,
    /// Unit vectors along the flight before it and after it.
    along: [Vec3; 2],
}

impl Ramp {
    fn new(flyer: &Flyer, from_rad: f64, to_rad: f64) -> Self {
        let rate_radps = flyer.climb_rate_radps();
        let by_rad = if rate_radps > 0.0 {
            to_rad - from_rad
        } else {
            0.0
        };
        Self {
            airspeed_mps: flyer.airspeed_mps(),
            from_rad,
            rate_radps: libm::copysign(rate_radps, by_rad),
            lasts_s: by_rad.abs() / rate_radps.max(f64::MIN_POSITIVE),
            along: [from_rad, from_rad + by_rad].map(ahead_and_up),
        }
    }

    /// What it has done after a time.
    fn after(&self, after_s: f64) -> Climbed {
        let ramp_s = self.lasts_s.min(after_s);
        let climb_rad = self.from_rad + self.rate_radps * ramp_s;
        let [before, after] = self.along;
        let now = if after_s < self.lasts_s {
            ahead_and_up(climb_rad)
        } else {
            after
        };
        // Along an arc of a circle.
        let arc = if ramp_s > 0.0 {
            Vec3::new(now.z - before.z, 0.0, before.x - now.x) / self.rate_radps
        } else {
            Vec3::ZERO
        };
        Climbed {
            by_m: (arc + now * (after_s - ramp_s)) * self.airspeed_mps,
            climb_rad,
        }
    }
}

/// Unit vector along a climb angle, forward and up.
fn ahead_and_up(climb_rad: f64) -> Vec3 {
    let (sin, cos) = libm::sincos(climb_rad);
    Vec3::new(cos, 0.0, sin)
}
