//! Turning round to the beginning of a leg: teardrop, bulb, race-track.
//!
//! The shortest path of at most three full-rate turns and straights from the aircraft to a position on a course (L. E. Dubins,
//! 1957; the crate `dubins_paths` gives its six words). In a wind the path is laid in the air mass, where the position drifts: an iteration finds the time of arrival and
//! the path to the position at that time together.

use core::f64::consts::TAU;

use crate::join::{Join, NEAR_M};
use crate::leg::Leg;
use crate::route::Route;
use dubins_paths::f64::{Intermediate, PosRot};
use dubins_paths::{PathType, SegmentType};
use fga_proof::angle::wrap_pi;
use fga_proof::limit::Limit as _;
use fga_proof::maneuver::Stage;
use fga_proof::meter::WORD;
use fga_proof::prediction::MotionState;

/// Iterations of the time of arrival and the drift until then.
const DRIFT_STEPS: u32 = 40;

/// Turns within this of a full circle count as none, radians: a rounded angle just below zero costs no circle.
const NO_TURN_RAD: f64 = 1e-9;

/// The quickest turn round from a state to the beginning of a leg, or some way before it with bank lag; `None` where the wind
/// prevents every one.
pub(crate) fn turn_round(
    route: &Route<'_>,
    (index, leg): (usize, &Leg),
    state: &MotionState,
) -> Option<Join> {
    let (airspeed_mps, wind_mps) = route.air();
    let rate_radps = route.flyer.course_rate_radps();
    let radius_m = airspeed_mps / rate_radps;
    let along_m = -route.settling_m();
    let to_m = leg.level_point_m(along_m);
    let (sin, cos) = libm::sincos(state.course_rad);
    let turn_rad = wrap_pi(leg.air_course_rad - state.course_rad);
    let mut best: Option<(f64, PathType, [f64; 3])> = None;
    for word in PathType::ALL {
        let mut taken_s = 0.0;
        for _ in 0..DRIFT_STEPS {
            let offset = (to_m - state.position_m - wind_mps * (state.time_s + taken_s)) / radius_m;
            let (x, y) = (
                cos * offset.x + sin * offset.y,
                cos * offset.y - sin * offset.x,
            );
            if !route.meter.take(WORD) {
                return None;
            }
            let pose = PosRot::from_floats(x, y, turn_rad);
            let Ok(mut parts) = Intermediate::new(PosRot::default(), pose, 1.0).word(word) else {
                break;
            };
            for (kind, part) in word.to_segment_types().iter().zip(&mut parts) {
                if *kind != SegmentType::S && *part > TAU - NO_TURN_RAD {
                    *part = 0.0;
                }
            }
            let needed_s = parts.iter().sum::<f64>() / rate_radps;
            let drift_m = wind_mps.length() * (needed_s - taken_s).abs();
            taken_s = needed_s;
            if drift_m < NEAR_M {
                if best.is_none_or(|(least_s, ..)| needed_s < least_s) {
                    best = Some((needed_s, word, parts));
                }
                break;
            }
        }
    }
    let (needed_s, word, parts) = best?;
    let rise_m = to_m.z - state.position_m.z - wind_mps.z * needed_s;
    let way_m = airspeed_mps * needed_s.max(f64::MIN_POSITIVE);
    let (low, high) = route.climb_limits_rad;
    let climb_rad = libm::asin((rise_m / way_m).limited(-1.0, 1.0)).limited(low, high);
    let (mut course_rad, mut start_s) = (state.course_rad, state.time_s);
    let mut join = Join::new(index, along_m);
    for (kind, part) in word.to_segment_types().into_iter().zip(parts) {
        let side = match kind {
            SegmentType::L => 1.0,
            SegmentType::S => 0.0,
            SegmentType::R => -1.0,
        };
        if side * part != 0.0 {
            course_rad += side * part;
            join.push(Stage {
                start_s,
                course_rad,
                climb_rad,
                rate_share: 1.0,
            });
        }
        start_s += part / rate_radps;
    }
    join.push(route.stage(start_s, course_rad, leg));
    join.joined_s = start_s;
    Some(join)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::along;
    use core::f64::consts::PI;
    use fga_proof::Vec3;
    use fga_proof::prediction::flown;
    use fga_proof::situation::Mission;
    use fga_proof::vehicle::Vehicle;
    use proptest::prelude::*;

    fn at(course_rad: f64) -> MotionState {
        MotionState {
            course_rad,
            ..MotionState::ahead(0.0)
        }
    }

    /// The turn round from the origin, and where it ends over the ground.
    fn found(
        start_rad: f64,
        to_m: Vec3,
        course_rad: f64,
        wind_mps: Vec3,
    ) -> Option<(Join, MotionState)> {
        let mission = Mission::new(&[]);
        along(&Vehicle::table_4(), wind_mps, &mission, |route| {
            // The leg whose course through the air is that one.
            let ground_mps =
                wind_mps + 15.0 * Vec3::new(libm::cos(course_rad), libm::sin(course_rad), 0.0);
            let leg = Leg::endless(to_m, fga_proof::angle::course_of(ground_mps), route.air());
            let join = turn_round(route, (0, &leg), &at(start_rad))?;
            let mut end = flown(
                route.flyer,
                &at(start_rad),
                &join.maneuver(),
                join.joined_s,
                route.meter,
            );
            end.position_m += wind_mps * join.joined_s;
            Some((join, end))
        })
    }

    /// Lines 20 m apart: a bulb of three turns, whose centres are the corners of a triangle of sides 2 r, 2 r and 2 r + 20 m.
    #[test]
    fn a_bulb_turns_back_onto_a_near_line() {
        let to_m = Vec3::new(0.0, 20.0, 0.0);
        let (join, end) = found(0.0, to_m, PI, Vec3::ZERO).unwrap();
        assert!(end.position_m.distance(to_m) < 1e-6, "{end:?}");
        let shortest_s = (PI + 4.0 * libm::acos((60.0 + 20.0) / 120.0)) * 2.0;
        assert!((join.joined_s - shortest_s).abs() < 1e-6, "{join:?}");
    }

    /// Lines two radii apart, on every course: half a circle, whatever is rounded.
    #[test]
    fn half_a_circle_turns_back_onto_a_line_two_radii_aside() {
        for step in -31..=31 {
            let course_rad = 0.1 * f64::from(step);
            let aside = Vec3::new(-libm::sin(course_rad), libm::cos(course_rad), 0.0);
            for side in [-1.0, 1.0] {
                let to_m = aside * (60.0 * side);
                let (join, _) = found(course_rad, to_m, course_rad + PI, Vec3::ZERO).unwrap();
                assert!((join.joined_s - 2.0 * PI).abs() < 1e-6, "{join:?}");
            }
        }
    }

    /// Straight ahead, on every course: no turn, whatever is rounded.
    #[test]
    fn a_place_straight_ahead_needs_no_turn() {
        for step in -31..=31 {
            let course_rad = 0.1 * f64::from(step);
            let to_m = fga_proof::angle::direction(course_rad, 0.0) * 150.0;
            let (join, _) = found(course_rad, to_m, course_rad, Vec3::ZERO).unwrap();
            assert!((join.joined_s - 10.0).abs() < 1e-6, "{join:?}");
        }
    }

    #[test]
    fn it_climbs_to_the_beginning_of_the_leg_on_the_way() {
        let to_m = Vec3::new(0.0, 60.0, 5.0);
        let (join, _) = found(0.0, to_m, PI, Vec3::ZERO).unwrap();
        let [turn, level] = join.stages() else {
            panic!("{join:?}");
        };
        assert!((turn.climb_rad - libm::asin(5.0 / (30.0 * PI))).abs() < 1e-9);
        assert_eq!(level.climb_rad, 0.0);
    }

    proptest! {
        /// Flown with the predicted motion it arrives, also in wind.
        #[test]
        fn it_arrives(
            (x, y) in (-200.0..200.0f64, -200.0..200.0f64),
            course_rad in -3.1..3.1f64,
            start_rad in -3.1..3.1f64,
            (wx, wy) in (-7.0..7.0f64, -7.0..7.0f64),
        ) {
            let (to_m, wind_mps) = (Vec3::new(x, y, 0.0), Vec3::new(wx, wy, 0.0));
            if let Some((_, end)) = found(start_rad, to_m, course_rad, wind_mps) {
                prop_assert!(end.position_m.distance(to_m) < 0.05, "{end:?}");
                prop_assert!(wrap_pi(end.course_rad - course_rad).abs() < 1e-6);
            } else {
                prop_assert!(wind_mps.length() > 3.0);
            }
        }
    }
}
