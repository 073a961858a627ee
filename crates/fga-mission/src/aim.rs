//! Aiming at a leg: when the turns of a join begin, from where each would end.
//!
//! The first turn ends on a straight line, on which the second one begins: both in closed form, with bank lag too.

use crate::bend::Bend;
use crate::leg::{Leg, NEAR_M, ON_LEG_M};
use crate::route::Route;
use fga_proof::angle::wrap_pi;
use fga_proof::limit::{Limit as _, root};
use fga_proof::maneuver::Stage;
use fga_proof::meter::SETUP;
use fga_proof::prediction::MotionState;

/// A turn onto a leg begins at least this many time constants after the roll-out of the one before began: e^-2, 14 %, of the bank is left.
const SETTLES: f64 = 2.0;

/// The two channels of a join before the predicted flight corrects their moments.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shot {
    pub(crate) intercept_course_rad: f64,
    course_rad: f64,
    pub(crate) turn_at_s: f64,
    pub(crate) climb_rad: f64,
    pub(crate) final_climb_rad: f64,
    pub(crate) level_at_s: f64,
}

impl Shot {
    /// Its commands from a moment on, seconds.
    pub(crate) fn stages(&self, start_s: f64) -> impl Iterator<Item = Stage> {
        let (turn_s, level_s) = (self.turn_at_s, self.level_at_s);
        let turns = (turn_s, self.intercept_course_rad, self.course_rad);
        let levels = (level_s, self.climb_rad, self.final_climb_rad);
        let mut before_s = f64::NEG_INFINITY;
        let moments_s = [start_s, turn_s.min(level_s), turn_s.max(level_s)];
        moments_s.into_iter().filter_map(move |at_s| {
            let is_later = at_s > before_s;
            before_s = before_s.max(at_s);
            let [course_rad, climb_rad] = [turns, levels]
                .map(|(from_s, before, after)| if at_s < from_s { before } else { after });
            is_later.then(|| Stage::turn(at_s, course_rad, climb_rad))
        })
    }
}

/// The turns of a join: off the present course, and back by an angle onto the course of the leg.
struct Turns<'a> {
    route: &'a Route<'a>,
    leg: &'a Leg,
    state: &'a MotionState,
    /// Present cross-track distance, metres.
    cross_m: f64,
    /// Turns to the left and to the right from the present bank.
    bends: &'a [Bend; 2],
}

impl Turns<'_> {
    /// By how much a turn moves the aircraft to the left of the leg until its roll-out begins, as if it flew straight on from
    /// there, metres, and when the roll-out begins, seconds.
    fn turned(&self, bend: &Bend, course_rad: f64, (side, by_rad): (f64, f64)) -> (f64, f64) {
        let exit = bend
            .exit(self.route.flyer, side * by_rad)
            .unwrap_or_default();
        let (sin, cos) = libm::sincos(course_rad - self.leg.course_rad);
        let (forward_m, aside_m) = exit.from_m.into();
        let drift_mps = self.leg.cross_speed_mps(self.leg.course_rad);
        let left_m = forward_m * sin + side * aside_m * cos + drift_mps * exit.begins_s;
        (left_m, exit.begins_s)
    }

    /// The cross-track distance after a turn to a course off the leg's by an angle, and a turn back onto it, metres; when the
    /// second turn begins and when its roll-out does, seconds.
    fn after(&self, (off_rad, by_rad): (f64, f64)) -> (f64, f64, f64) {
        let Self {
            route, leg, state, ..
        } = self;
        let flyer = route.flyer;
        let [left, right] = self.bends;
        let first = if by_rad < left.least_rad() {
            self.turned(right, state.course_rad, (-1.0, by_rad))
        } else {
            self.turned(left, state.course_rad, (1.0, by_rad))
        };
        let intercept_rad = leg.air_course_rad + off_rad;
        let side = libm::copysign(1.0, -off_rad);
        let second = self.turned(flyer.level(), intercept_rad, (side, -off_rad));
        // The bank has mostly gone before it turns again.
        let settles_s = SETTLES * flyer.bank_time_constant_s();
        let settled_m = leg.cross_speed_mps(intercept_rad) * settles_s;
        let turn_s = first.1 + settles_s;
        let cross_m = self.cross_m + first.0 + settled_m + second.0;
        (cross_m, turn_s, turn_s + second.1)
    }

    /// The angle off the leg's course on which the aircraft flies towards it, the turn to there, radians, and the straight
    /// flight before the second turn, seconds.
    fn intercept(&self, steepest_rad: f64) -> (f64, f64, f64) {
        let leg = self.leg;
        let onto_rad = leg.turn_onto_rad(self.state);
        let cross_m = |off_rad: f64, by_rad: f64| self.after((off_rad, by_rad)).0;
        let direct_m = cross_m(0.0, onto_rad);
        if direct_m.abs() < ON_LEG_M {
            return (0.0, onto_rad, 0.0);
        }
        let side = -libm::copysign(1.0, direct_m);
        let steepest_rad = leg.air_turn_rad(side * steepest_rad);
        // The shorter way round, unless the leg is near on that side.
        let mut by_rad = wrap_pi(onto_rad + steepest_rad);
        let mut left_m = cross_m(steepest_rad, by_rad);
        if left_m * direct_m <= 0.0 {
            by_rad = onto_rad + steepest_rad;
            left_m = cross_m(steepest_rad, by_rad);
        }
        if left_m * direct_m > 0.0 {
            let closing_mps = side * leg.cross_speed_mps(leg.air_course_rad + steepest_rad);
            let straight_s = if closing_mps > 0.0 {
                left_m.abs() / closing_mps
            } else {
                0.0
            };
            return (steepest_rad, by_rad, straight_s);
        }
        // The leg is near: the intercept angle that needs no straight piece. Between two turns of one radius the distance is
        // linear in its versed sine.
        let off_rad = |versine: f64| side * 2.0 * libm::asin(libm::sqrt(0.5 * versine));
        let near_m = |versine: f64| cross_m(off_rad(versine), onto_rad + off_rad(versine));
        let steepest = (1.0 - libm::cos(steepest_rad), left_m);
        let off_rad = off_rad(root(near_m, [(0.0, direct_m), steepest], NEAR_M));
        (off_rad, onto_rad + off_rad, 0.0)
    }
}

/// The join of a leg at an intercept angle, exact for level flight without lag; without work left there are no turns.
#[inline(never)]
pub(crate) fn aim(route: &Route<'_>, leg: &Leg, state: &MotionState, intercept_rad: f64) -> Shot {
    let final_climb_rad = route.climb_rad(leg);
    let mut shot = Shot {
        intercept_course_rad: state.course_rad,
        course_rad: state.course_rad,
        turn_at_s: state.time_s,
        climb_rad: final_climb_rad,
        final_climb_rad,
        level_at_s: state.time_s,
    };
    let mut bends = [Bend::NONE; 2];
    if !route.meter.take(SETUP + Bend::WORK * bends.len()) {
        return shot;
    }
    let most_rad = route.flyer.full_bank_rad();
    let bank_rad = state.bank_rad.limited(-most_rad, most_rad);
    let [left, right] = &mut bends;
    left.set(route.flyer, bank_rad);
    right.set(route.flyer, -bank_rad);
    let position = leg.position(state.position_m, state.time_s);
    let turns = Turns {
        route,
        leg,
        state,
        cross_m: position.cross_m,
        bends: &bends,
    };
    let (off_rad, by_rad, straight_s) = turns.intercept(intercept_rad);
    let (_, turn_s, over_s) = turns.after((off_rad, by_rad));
    shot.intercept_course_rad = state.course_rad + by_rad;
    shot.course_rad = shot.intercept_course_rad - off_rad;
    shot.turn_at_s += turn_s + straight_s;
    let climbs_rad = [state.climb_rad, final_climb_rad];
    let gain_m = -position.above_m;
    let (climb_rad, climb_s) = climb_back(route, climbs_rad, gain_m, over_s + straight_s);
    shot.climb_rad = climb_rad;
    shot.level_at_s += climb_s;
    shot
}

/// The climb angle to hold, and for how long from now, to gain a height relative to the leg: the gentlest one that gains it
/// within a time, and the quickest where none does.
fn climb_back(
    route: &Route<'_>,
    [now_rad, final_rad]: [f64; 2],
    gain_m: f64,
    within_s: f64,
) -> (f64, f64) {
    let (low, high) = route.climb_limits_rad;
    let speed_mps = route.flyer.airspeed_mps();
    let rate_radps = route.flyer.climb_rate_radps();
    // Height gained relative to the leg while the climb angle moves from one value to another.
    let ramp_m = |from: f64, to: f64| {
        let turn = to - from;
        if turn.abs() < 1e-9 {
            return 0.0;
        }
        let mean = (libm::cos(from) - libm::cos(to)) / turn - libm::sin(final_rad);
        speed_mps * mean * turn.abs() / rate_radps
    };
    if rate_radps <= 0.0 || high <= low {
        return (final_rad, 0.0);
    }
    let more_m = gain_m - ramp_m(now_rad, final_rad);
    if more_m.abs() < ON_LEG_M {
        return (final_rad, 0.0);
    }
    // A climb by δ off the leg's for T, with its ramps, gains V (δ T - δ² / rate), about.
    let gain_rad_s = more_m.abs() / speed_mps;
    let square = within_s * within_s - 4.0 * gain_rad_s / rate_radps;
    let off_rad = if square > 0.0 {
        2.0 * gain_rad_s / (within_s + libm::sqrt(square))
    } else {
        libm::sqrt(gain_rad_s * rate_radps)
    };
    let climb_rad = (final_rad + libm::copysign(off_rad, more_m)).limited(low, high);
    let climbing_mps = speed_mps * (libm::sin(climb_rad) - libm::sin(final_rad));
    let ramps_m = ramp_m(now_rad, climb_rad) + ramp_m(climb_rad, final_rad);
    let ramp_s = (climb_rad - now_rad).abs() / rate_radps;
    let hold_s = if climbing_mps.abs() > 1e-6 {
        (gain_m - ramps_m) / climbing_mps
    } else {
        0.0
    };
    (climb_rad, (ramp_s + hold_s).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::table_4;
    use core::f64::consts::{FRAC_PI_2, FRAC_PI_3};
    use fga_proof::Vec3;

    /// The join of a leg along +x from beside it, flown along it, by the vehicle of Table 4 (30 m, 0.5 rad/s).
    fn aimed(cross_m: f64, above_m: f64, intercept_rad: f64) -> Shot {
        table_4(&[], |route| {
            let leg = Leg::endless(Vec3::ZERO, 0.0, route.air());
            let state = MotionState {
                position_m: Vec3::new(0.0, cross_m, above_m),
                ..MotionState::ahead(0.0)
            };
            aim(route, &leg, &state, intercept_rad)
        })
    }

    /// Two quarter circles of 30 m and 40 m straight lead 100 m aside.
    #[test]
    fn a_far_leg_is_intercepted_after_a_straight_piece() {
        for side in [-1.0, 1.0] {
            let shot = aimed(side * 100.0, 0.0, FRAC_PI_2);
            assert!((shot.intercept_course_rad + side * FRAC_PI_2).abs() < 1e-9);
            let turn_s = 0.5 * core::f64::consts::PI / 0.5 + 40.0 / 15.0;
            assert!((shot.turn_at_s - turn_s).abs() < 1e-9, "{shot:?}");
            assert!(shot.course_rad.abs() < 1e-9);
        }
    }

    /// Two turns by 60° lead 2 · 30 m · (1 - cos 60°) = 30 m aside.
    #[test]
    fn a_near_leg_is_intercepted_at_the_angle_that_needs_no_straight_piece() {
        let shot = aimed(30.0, 0.0, FRAC_PI_2);
        assert!(
            (shot.intercept_course_rad + FRAC_PI_3).abs() < 1e-3,
            "{shot:?}"
        );
        assert!((shot.turn_at_s - FRAC_PI_3 / 0.5).abs() < 1e-2);
        // On the leg nothing turns.
        assert_eq!(aimed(0.0, 0.0, FRAC_PI_2).intercept_course_rad, 0.0);
    }

    /// The way takes two turns of π/2 at 0.5 rad/s and 40 m: it climbs as gently as that allows.
    #[test]
    fn height_is_regained_by_the_end_of_the_way() {
        let shot = aimed(100.0, -10.0, FRAC_PI_2);
        let within_s = 2.0 * core::f64::consts::PI + 40.0 / 15.0;
        let about_rad = 10.0 / (15.0 * within_s);
        assert!(shot.climb_rad > about_rad && shot.climb_rad < 1.4 * about_rad);
        assert!(shot.level_at_s > 0.5 * within_s && shot.level_at_s <= within_s);
        // As steeply as it can where the way is too short.
        let steep = aimed(0.0, -100.0, FRAC_PI_2);
        assert!((steep.climb_rad - core::f64::consts::PI / 12.0).abs() < 1e-9);
        assert!(steep.level_at_s > 100.0 / 15.0);
        assert!(aimed(0.0, 100.0, FRAC_PI_2).climb_rad < 0.0);
    }
}
