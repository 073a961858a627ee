//! Joining a leg: turn to an intercept course, fly straight, turn onto the leg, at its height.
//!
//! In the plane and in still air this is the shortest Dubins path of its kind (a turn, a straight
//! piece, a turn) onto a line. It also holds in wind and for a vehicle with lag: shooting with the predicted
//! flight finds the moment of the second turn and of levelling off.

use crate::angle::wrap_pi;
use crate::limit::Limit as _;
use crate::maneuver::{Maneuver, Stage};
use crate::meter::{Meter, SETUP};
use crate::mission::leg::Leg;
use crate::prediction::{Flyer, MotionState, flown};

/// Largest cross-track and height error on the leg, metres.
const ON_LEG_M: f64 = 0.05;

/// Largest course error on the leg, radians.
const ON_COURSE_RAD: f64 = 1e-3;

/// A way onto a leg is corrected until no more than this is left, metres: without bank lag and with it.
const EXACT_M: f64 = 1e-6;
const LAGGED_M: f64 = 1e-3;

/// A way that ends farther aside is none, metres.
const JOINED_WITHIN_M: f64 = 1.0;

/// Corrections of the two moments with the predicted flight.
const CORRECTIONS: u32 = 3;

/// A way onto a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Join {
    /// The manoeuvre.
    pub maneuver: Maneuver,
    /// Arrival on the leg, seconds from the decision.
    pub joined_s: f64,
    /// Distance along the leg at that time, metres.
    pub along_m: f64,
    /// Remaining cross-track distance at that time, metres.
    pub cross_m: f64,
    /// Remaining height above the leg at that time, metres.
    pub above_m: f64,
}

impl Join {
    /// Whether it ends on the leg: in strong wind the corrections of a turn of half a circle may fail.
    pub const fn is_on_leg(&self) -> bool {
        self.cross_m.abs() < JOINED_WITHIN_M
    }
}

/// Limits that a way back keeps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JoinLimits {
    /// Intercept angle, radians, in (0, π/2].
    pub intercept_rad: f64,
    /// Steepest descent and climb, radians.
    pub climb_limits_rad: (f64, f64),
}

/// Whether the aircraft flies along the leg, on it.
pub fn is_on_leg(leg: &Leg, state: &MotionState) -> bool {
    let position = leg.position(state.position_m, state.time_s);
    position.cross_m.abs() < ON_LEG_M
        && position.above_m.abs() < ON_LEG_M
        && leg.turn_onto_rad(state).abs() < ON_COURSE_RAD
        && (leg.climb_rad - state.climb_rad).abs() < ON_COURSE_RAD
}

/// The two channels of a join before their moments are corrected.
struct Shot {
    intercept_course: f64,
    course: f64,
    turn_at_s: f64,
    climb: f64,
    final_climb: f64,
    level_at_s: f64,
}

impl Shot {
    fn maneuver(&self, start_s: f64) -> Maneuver {
        let mut maneuver = Maneuver::hold();
        let mut push = |at_s: f64| {
            let turned = at_s >= self.turn_at_s;
            let levelled = at_s >= self.level_at_s;
            maneuver.push(Stage {
                start_s: at_s,
                course_rad: if turned {
                    self.course
                } else {
                    self.intercept_course
                },
                climb_rad: if levelled {
                    self.final_climb
                } else {
                    self.climb
                },
                rate_share: 1.0,
            });
        };
        push(start_s);
        let (first, second) = if self.turn_at_s <= self.level_at_s {
            (self.turn_at_s, self.level_at_s)
        } else {
            (self.level_at_s, self.turn_at_s)
        };
        if first > start_s {
            push(first);
        }
        if second > first {
            push(second);
        }
        maneuver
    }
}

/// The way onto a leg from a state, at an intercept angle or a smaller one if the leg is near.
pub(crate) fn join(
    flyer: &Flyer,
    leg: &Leg,
    state: &MotionState,
    limits: &JoinLimits,
    meter: &Meter,
) -> Join {
    meter.count(SETUP);
    let mut shot = aim(flyer, leg, state, limits);
    let mut join = fly(flyer, leg, state, &shot, meter);
    let near_m = if flyer.is_ideal() { EXACT_M } else { LAGGED_M };
    for _ in 0..CORRECTIONS {
        if join.cross_m.abs() < near_m && join.above_m.abs() < near_m {
            break;
        }
        let closing = leg.cross_speed_mps(
            flyer.airspeed_mps() * libm::cos(shot.climb),
            shot.intercept_course,
        );
        if closing.abs() > 1e-3 * flyer.airspeed_mps() {
            shot.turn_at_s = (shot.turn_at_s - join.cross_m / closing).max(state.time_s);
        }
        let climbing = flyer.airspeed_mps() * (libm::sin(shot.climb) - libm::sin(shot.final_climb));
        if climbing.abs() > 1e-3 * flyer.airspeed_mps() {
            shot.level_at_s = (shot.level_at_s - join.above_m / climbing).max(state.time_s);
        }
        join = fly(flyer, leg, state, &shot, meter);
    }
    join
}

fn fly(flyer: &Flyer, leg: &Leg, state: &MotionState, shot: &Shot, meter: &Meter) -> Join {
    let maneuver = shot.maneuver(state.time_s);
    let end = flown(flyer, state, &maneuver, f64::INFINITY, meter);
    let position = leg.position(end.position_m, end.time_s);
    Join {
        maneuver,
        joined_s: end.time_s,
        along_m: position.along_m,
        cross_m: position.cross_m,
        above_m: position.above_m,
    }
}

/// First guess of the moments, exact for level flight without lag in still air.
fn aim(flyer: &Flyer, leg: &Leg, state: &MotionState, limits: &JoinLimits) -> Shot {
    let position = leg.position(state.position_m, state.time_s);
    let (low, high) = limits.climb_limits_rad;
    let final_climb = leg.climb_rad.limited(low, high);
    let onto = leg.turn_onto_rad(state);
    let course = state.course_rad + onto;
    // Cross-track distance after a turn to `offset` from the leg's course, and from there onto it.
    let rate = flyer.course_rate_radps();
    let radius = flyer.airspeed_mps() / rate;
    let drift = leg.cross_speed_mps(flyer.airspeed_mps(), leg.course_rad);
    let arc = |from: f64, to: f64| {
        let turn = wrap_pi(to - from);
        let side = if turn < 0.0 { -1.0 } else { 1.0 };
        let cosines = libm::cos(from - leg.course_rad) - libm::cos(to - leg.course_rad);
        side * radius * cosines + drift * turn.abs() / rate
    };
    let after_turns = |offset: f64| {
        let intercept = leg.air_course_rad + offset;
        position.cross_m + arc(state.course_rad, intercept) + arc(intercept, leg.air_course_rad)
    };
    let mut offset = 0.0;
    let mut straight_s = 0.0;
    if (position.cross_m + arc(state.course_rad, leg.air_course_rad)).abs() >= ON_LEG_M {
        let cross_direct = position.cross_m + arc(state.course_rad, leg.air_course_rad);
        let side = if cross_direct > 0.0 { -1.0 } else { 1.0 };
        let steepest = side * limits.intercept_rad;
        let left = after_turns(steepest);
        if left * cross_direct > 0.0 {
            offset = steepest;
            let closing = leg.cross_speed_mps(flyer.airspeed_mps(), leg.air_course_rad + offset);
            straight_s = if closing * side > 0.0 {
                (-left / closing).max(0.0)
            } else {
                0.0
            };
        } else {
            // The leg is near: the intercept angle that needs no straight piece.
            offset = root(after_turns, (0.0, cross_direct), (steepest, left));
        }
    }
    let intercept_turn = wrap_pi(leg.air_course_rad + offset - state.course_rad);
    let intercept_course = state.course_rad + intercept_turn;
    let course = if offset == 0.0 {
        course
    } else {
        intercept_course + wrap_pi(leg.air_course_rad - intercept_course)
    };
    let turn_s = intercept_turn.abs() / rate;
    let turn_at_s = state.time_s + turn_s + straight_s;
    let total_s = turn_s + straight_s + offset.abs() / rate;
    let (climb, climb_s) = climb_back(
        flyer,
        state.climb_rad,
        final_climb,
        -position.above_m,
        limits,
        total_s,
    );
    Shot {
        intercept_course,
        course,
        turn_at_s,
        climb,
        final_climb,
        level_at_s: state.time_s + climb_s,
    }
}

/// Climb angle to hold, and its duration from now, to gain `gain_m` relative to the leg.
fn climb_back(
    flyer: &Flyer,
    now_rad: f64,
    final_rad: f64,
    gain_m: f64,
    limits: &JoinLimits,
    within_s: f64,
) -> (f64, f64) {
    let (low, high) = limits.climb_limits_rad;
    let speed = flyer.airspeed_mps();
    let rate = flyer.climb_rate_radps();
    if rate <= 0.0 || high <= low {
        return (final_rad, 0.0);
    }
    // Height gained relative to the leg while the climb angle moves from one value to another.
    let ramp = |from: f64, to: f64| {
        let turn = to - from;
        if turn.abs() < 1e-9 {
            return 0.0;
        }
        let seconds = turn.abs() / rate;
        speed * ((libm::cos(from) - libm::cos(to)) / turn - libm::sin(final_rad)) * seconds
    };
    let ramps = |climb: f64| ramp(now_rad, climb) + ramp(climb, final_rad);
    if (ramp(now_rad, final_rad) - gain_m).abs() < ON_LEG_M {
        return (final_rad, 0.0);
    }
    let limit = if gain_m > ramp(now_rad, final_rad) {
        high
    } else {
        low
    };
    let side = if limit == high { 1.0 } else { -1.0 };
    for share in [0.25, 0.5, 1.0] {
        let climb = final_rad + share * (limit - final_rad);
        let left = gain_m - ramps(climb);
        let climbing = speed * (libm::sin(climb) - libm::sin(final_rad));
        if left * side < 0.0 {
            break;
        }
        let hold_s = if climbing.abs() > 1e-6 {
            left / climbing
        } else {
            0.0
        };
        let ramp_s = (climb - now_rad).abs() / rate;
        if share == 1.0 || hold_s + ramp_s + (climb - final_rad).abs() / rate <= within_s {
            return (climb, ramp_s + hold_s);
        }
    }
    // Close to the height: the climb angle whose two ramps alone gain it.
    let left = |climb: f64| gain_m - ramps(climb);
    let climb = root(left, (final_rad, left(final_rad)), (limit, left(limit)));
    (climb, (climb - now_rad).abs() / rate)
}

/// The zero of a function with opposite signs at two points (the Illinois method).
fn root(function: impl Fn(f64) -> f64, low: (f64, f64), high: (f64, f64)) -> f64 {
    let ((mut a, mut at_a), (mut b, mut at_b)) = (low, high);
    for _ in 0..24 {
        let step = at_b - at_a;
        if at_b.abs() < 1e-9 || step == 0.0 {
            break;
        }
        let c = b - at_b * (b - a) / step;
        let at_c = function(c);
        if at_c * at_b < 0.0 {
            (a, at_a) = (b, at_b);
        } else {
            at_a *= 0.5;
        }
        (b, at_b) = (c, at_c);
    }
    b
}
