//! Turning round to the beginning of a leg: teardrop, bulb, race-track.
//!
//! The shortest path of at most three full-rate turns and straights from the aircraft to a position on a course (L. E. Dubins,
//! 1957). In a wind the path is laid in the air mass, where the position drifts: an iteration finds the time of arrival and
//! the path to the position at that time together.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::join::Join;
use crate::leg::{Leg, NEAR_M};
use crate::route::Route;
use fga_proof::angle::wrap_pi;
use fga_proof::limit::Limit as _;
use fga_proof::maneuver::Stage;
use fga_proof::prediction::MotionState;

/// Iterations of the time of arrival and the drift until then.
const DRIFT_STEPS: u32 = 40;

/// Work for a trial of a path.
const WORD: usize = 12;

/// Turns within this of a full circle count as none, radians: a rounded angle just below zero costs no circle.
const NO_TURN_RAD: f64 = 1e-9;

/// Sides of the first and the last turn, 1 to the left and -1 to the right, and whether straight flight is between them.
fn words() -> impl Iterator<Item = (f64, f64, bool)> {
    let sides = [(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)];
    let words = sides.map(|(first, last)| (first, last, true));
    words
        .into_iter()
        .chain([(1.0, 1.0, false), (-1.0, -1.0, false)])
}

/// Three turns, left positive, radians, and the straight flight before the last one, turn radii.
#[derive(Debug, Clone, Copy)]
struct Path {
    turns_rad: [f64; 3],
    straight: f64,
}

impl Path {
    /// Of a word to a place, turn radii ahead and to the left, and a course, radians; `None` where the word does not
    /// lead there.
    #[inline(never)]
    fn new(
        (first, last, is_straight): (f64, f64, bool),
        (x, y, course_rad): (f64, f64, f64),
    ) -> Option<Self> {
        let (sin, cos) = libm::sincos(course_rad);
        // From the centre of the first circle to that of the last one.
        let (dx, dy) = (x - last * sin, y + last * cos - first);
        let apart = libm::hypot(dx, dy);
        // Where both circles are one, one turn leads there.
        let is_one = apart < NO_TURN_RAD;
        let between_rad = if is_one { 0.0 } else { libm::atan2(dy, dx) };
        let turn_rad = |side: f64, by_rad: f64| {
            let turn_rad = wrap_pi(side * by_rad);
            let turn_rad = if turn_rad < 0.0 {
                turn_rad + TAU
            } else {
                turn_rad
            };
            if turn_rad > TAU - NO_TURN_RAD {
                0.0
            } else {
                side * turn_rad
            }
        };
        let (onto_rad, middle_rad, straight) = if is_straight {
            // The tangent of both circles.
            let straight = libm::sqrt(apart * apart - (first - last) * (first - last));
            (
                between_rad + libm::atan2(first - last, straight),
                0.0,
                straight,
            )
        } else {
            // The middle circle touches both; of the two that do, the longer turn is the shorter way.
            let lean_rad = libm::acos(apart / 4.0);
            let onto_rad = between_rad + first * (lean_rad + FRAC_PI_2);
            (onto_rad, -first * (PI + 2.0 * lean_rad), 0.0)
        };
        let first_rad = turn_rad(first, onto_rad);
        let turns_rad = [
            first_rad,
            middle_rad,
            turn_rad(last, course_rad - onto_rad - middle_rad),
        ];
        // Circles too near or too far apart have no tangent and no circle between them.
        let is_path = turns_rad.iter().all(|turn_rad| turn_rad.is_finite()) && straight.is_finite();
        is_path.then_some(Self {
            turns_rad,
            straight,
        })
    }

    /// Its length, turn radii.
    fn length(&self) -> f64 {
        self.turns_rad
            .iter()
            .map(|turn_rad| turn_rad.abs())
            .sum::<f64>()
            + self.straight
    }
}

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
    let turn_rad = leg.air_course_rad - state.course_rad;
    let mut best: Option<(f64, Path)> = None;
    for word in words() {
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
            let Some(path) = Path::new(word, (x, y, turn_rad)) else {
                break;
            };
            let needed_s = path.length() / rate_radps;
            let drift_m = wind_mps.length() * (needed_s - taken_s).abs();
            taken_s = needed_s;
            if drift_m < NEAR_M {
                if best.is_none_or(|(least_s, _)| needed_s < least_s) {
                    best = Some((needed_s, path));
                }
                break;
            }
        }
    }
    let (needed_s, path) = best?;
    let rise_m = to_m.z - state.position_m.z - wind_mps.z * needed_s;
    let way_m = airspeed_mps * needed_s.max(f64::MIN_POSITIVE);
    let (low, high) = route.climb_limits_rad;
    let climb_rad = libm::asin((rise_m / way_m).limited(-1.0, 1.0)).limited(low, high);
    let (mut course_rad, mut start_s) = (state.course_rad, state.time_s);
    let [first_rad, middle_rad, last_rad] = path.turns_rad;
    let mut join = Join::new(index, along_m);
    for (turn_rad, before) in [
        (first_rad, 0.0),
        (middle_rad, 0.0),
        (last_rad, path.straight),
    ] {
        start_s += before / rate_radps;
        if turn_rad != 0.0 {
            course_rad += turn_rad;
            join.stages
                .push(Stage::turn(start_s, course_rad, climb_rad));
            start_s += turn_rad.abs() / rate_radps;
        }
    }
    join.stages.push(route.stage(start_s, course_rad, leg));
    join.joined_s = start_s;
    Some(join)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::along;
    use dubins_paths::PathType;
    use dubins_paths::f64::{Intermediate, PosRot};
    use fga_proof::Vec3;
    use fga_proof::angle::wrap_pi;
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
                join.stages(),
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

        /// The shortest of the words is as long as that of the crate `dubins_paths`.
        #[test]
        fn no_path_is_shorter(x in -8.0..8.0f64, y in -8.0..8.0f64, course_rad in -3.1..3.1f64) {
            let ours = words().filter_map(|word| Some(Path::new(word, (x, y, course_rad))?.length()));
            let ends = [(0.0, 0.0, 0.0), (x, y, course_rad)];
            let [from, to] = ends.map(|(x, y, rad)| PosRot::from_floats(x, y, rad));
            let between = Intermediate::new(from, to, 1.0);
            let theirs = PathType::ALL.iter().filter_map(|word| between.word(*word).ok());
            let theirs = theirs.map(|parts| parts.iter().sum::<f64>()).fold(f64::INFINITY, f64::min);
            let ours = ours.fold(f64::INFINITY, f64::min);
            prop_assert!(ours < theirs + 1e-6, "{ours} {theirs}");
        }
    }
}
