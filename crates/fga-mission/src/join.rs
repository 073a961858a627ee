//! Joining a leg: turn to an intercept course, fly straight, turn onto the leg, at its height.
//!
//! In the plane and in still air this is the shortest Dubins path of its kind (a turn, a straight
//! piece, a turn) onto a line. It also holds in wind and for a vehicle with lag: shooting with the predicted
//! flight finds the moment of the second turn and of levelling off.

use crate::aim::{Shot, Turns, with_turns};
use crate::corner::LONG_RADII;
use crate::leg::Leg;
use fga_proof::maneuver::Maneuver;
use fga_proof::meter::Meter;
use fga_proof::prediction::{Flyer, MotionState, while_flown};

/// Largest cross-track and height error on the leg, metres: far below the metres to which positions are known.
pub(super) const ON_LEG_M: f64 = 0.05;

/// Largest course error on the leg, radians.
const ON_COURSE_RAD: f64 = 1e-3;

/// An aircraft that flies along a leg, past its beginning, within this distance and angle, has entered it, whoever flew it
/// there: turn radii and radians (11°, a turn of 0.2 radii onto the leg). The larger distance holds near the beginning without a turn
/// round in progress: an obstacle may stand there, and from 1.5 radii aside two turns lead onto the leg in 2.6 radii, where a circle takes 6.3.
const ENTERED_RADII: [f64; 2] = [0.3, 1.5];
const ENTERED_RAD: f64 = 0.2;

/// A way onto a leg is corrected until no more than this is left, metres: without bank lag and with it.
const EXACT_M: f64 = 1e-6;
const LAGGED_M: f64 = 1e-3;

/// A way ends at most this far beside the leg, metres: in wind, half circles ended up to 60 m beside it where the corrections failed.
const JOINED_WITHIN_M: f64 = 1.0;

/// Corrections of the two moments with the predicted flight.
const CORRECTIONS: u32 = 3;

/// A second turn that begins by less than this sooner or later ends where straight flight moves it, to [`LAGGED_M`]: that
/// needs no other flight. Time constants of the bank; `a_join_ends_where_it_is_told_to` flies it.
const SURELY: f64 = 0.01;

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

/// Whether the aircraft flies along the leg, past its beginning and near it.
pub(super) fn has_entered(leg: &Leg, state: &MotionState, radius_m: f64, turns: bool) -> bool {
    let position = leg.position(state.position_m, state.time_s);
    let [beside, alone] = ENTERED_RADII;
    let is_begun = position.along_m > LONG_RADII * radius_m;
    let within = if turns || is_begun { beside } else { alone };
    position.along_m > 0.0
        && position.cross_m.abs() < within * radius_m
        && leg.turn_onto_rad(state).abs() < ENTERED_RAD
}

/// Whether the aircraft flies along the leg, on it.
pub(crate) fn is_on_leg(leg: &Leg, state: &MotionState) -> bool {
    let position = leg.position(state.position_m, state.time_s);
    position.along_m <= leg.length_m
        && position.cross_m.abs() < ON_LEG_M
        && position.above_m.abs() < ON_LEG_M
        && leg.turn_onto_rad(state).abs() < ON_COURSE_RAD
        && (leg.climb_rad - state.climb_rad).abs() < ON_COURSE_RAD
}

/// How near a way onto a leg must end, metres.
pub(super) fn near_m(flyer: &Flyer) -> f64 {
    if flyer.is_ideal() { EXACT_M } else { LAGGED_M }
}

/// The way onto a leg from a state, at an intercept angle or a smaller one if the leg is near.
pub(crate) fn join(
    flyer: &Flyer,
    leg: &Leg,
    state: &MotionState,
    limits: &JoinLimits,
    meter: &Meter,
) -> Join {
    let aim = |turns: &Turns<'_>| turns.aim(leg, state, limits).0;
    let mut shot = with_turns(flyer, state, meter, aim);
    // The last piece of the same flight before the next command begins here.
    let mut same = (None, *state);
    let mut fly = |shot: &Shot| {
        let maneuver = shot.maneuver(state.time_s);
        let stages = maneuver.stages();
        let next_s = stages.get(1).map_or(f64::INFINITY, |next| next.start_s);
        if same.0 != stages.first().copied() || same.1.time_s >= next_s {
            same = (stages.first().copied(), *state);
        }
        let from = same.1;
        let end = while_flown(flyer, &from, &maneuver, f64::INFINITY, |at, _, _| {
            if at.time_s < next_s {
                same.1 = *at;
            }
            meter.take(flyer.piece_work())
        });
        (maneuver, end, leg.position(end.position_m, end.time_s))
    };
    let (mut maneuver, mut end, mut at) = fly(&shot);
    let near_m = near_m(flyer);
    for _ in 0..CORRECTIONS {
        let is_level = at.above_m.abs() < near_m;
        if at.cross_m.abs() < near_m && is_level {
            break;
        }
        let closing = leg.cross_speed_mps(
            flyer.airspeed_mps() * libm::cos(shot.climb),
            shot.intercept_course,
        );
        let before_s = shot.turn_at_s;
        if closing.abs() > 1e-3 * flyer.airspeed_mps() {
            shot.turn_at_s = (before_s - at.cross_m / closing).max(state.time_s);
        }
        let climbing = flyer.airspeed_mps() * (libm::sin(shot.climb) - libm::sin(shot.final_climb));
        if climbing.abs() > 1e-3 * flyer.airspeed_mps() {
            shot.level_at_s = (shot.level_at_s - at.above_m / climbing).max(state.time_s);
        }
        let later_s = shot.turn_at_s - before_s;
        if is_level && later_s.abs() < SURELY * flyer.bank_time_constant_s() {
            let intercepts = MotionState {
                course_rad: shot.intercept_course,
                climb_rad: shot.final_climb,
                ..end
            };
            maneuver = shot.maneuver(state.time_s);
            end.position_m += flyer.velocity_mps(&intercepts) * later_s;
            end.time_s += later_s;
            at = leg.position(end.position_m, end.time_s);
            break;
        }
        (maneuver, end, at) = fly(&shot);
    }
    Join {
        maneuver,
        joined_s: end.time_s,
        along_m: at.along_m,
        cross_m: at.cross_m,
        above_m: at.above_m,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga_proof::Vec3;
    use fga_proof::prediction::flown;
    use fga_proof::vehicle::Vehicle;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        /// A join ends on the leg, where it is told to, also where its last correction was not flown.
        #[test]
        fn a_join_ends_where_it_is_told_to(
            lag_s in prop_oneof![Just(0.0), 0.2..1.0f64],
            bank in -1.0..1.0f64,
            (cross_m, course_rad) in (-300.0..300.0f64, -2.6..2.6f64),
            intercept_rad in 0.3..1.2f64,
            wind_mps in -6.0..6.0f64,
            (above_m, climb_rad) in prop_oneof![
                Just((0.0, 0.0)),
                (-40.0..40.0f64, -0.2..0.2f64),
            ],
            // Where more is allowed than the aircraft can climb, its height is off, and corrected.
            steeper in prop_oneof![Just(1.0), Just(1.5)],
        ) {
            let vehicle = Vehicle::lagged(lag_s);
            let flyer = Flyer::new(&vehicle);
            let state = MotionState {
                time_s: 0.0,
                position_m: Vec3::new(0.0, cross_m, above_m),
                course_rad,
                climb_rad,
                bank_rad: bank * flyer.full_bank_rad(),
            };
            let wind_mps = Vec3::new(0.0, wind_mps, 0.0);
            let leg = Leg::endless(Vec3::ZERO, 0.0, vehicle.airspeed_mps, wind_mps);
            let climb_limits_rad = (vehicle.climb_min_rad * steeper, vehicle.climb_max_rad * steeper);
            let limits = JoinLimits { intercept_rad, climb_limits_rad };
            let meter = Meter::unlimited();
            let told = join(&flyer, &leg, &state, &limits, &meter);
            let end = flown(&flyer, &state, &told.maneuver, f64::INFINITY, &meter);
            let at = leg.position(end.position_m, end.time_s);
            let off_m = libm::hypot(at.cross_m - told.cross_m, at.above_m - told.above_m);
            prop_assert!(off_m < 5.0 * LAGGED_M, "{off_m} m off the end of {told:?}");
            let later_s = end.time_s - told.joined_s;
            let on_m = at.along_m - leg.ground_speed_mps * later_s - told.along_m;
            prop_assert!(on_m.abs() < 0.01, "{on_m} m along from the end of {told:?}");
            prop_assert!(later_s.abs() < 0.05, "{later_s} s after the end of {told:?}");
        }
    }
}
