//! Turning round to the beginning of a leg: teardrop, bulb, race-track.
//!
//! The shortest path of at most three full-rate turns and straights (Dubins) from the aircraft
//! to a position on a course. In a wind the plan is in the air mass, where the position drifts: an iteration
//! finds the time of arrival and the path to the position at that time together.

use core::f64::consts::{PI, TAU};

use crate::corner::Air;
use fga_proof::Vec3;
use fga_proof::limit::Limit as _;
use fga_proof::maneuver::{Maneuver, Stage};
use fga_proof::meter::WORD;
use fga_proof::prediction::{Flyer, MotionState};

/// Iterations of the time of arrival and the drift until then.
const DRIFT_STEPS: u32 = 40;

/// Accepted remaining drift, metres.
const DRIFT_LEFT_M: f64 = 1e-3;

/// Turns within this of a full circle count as none, radians.
const NO_TURN_RAD: f64 = 1e-9;

/// A target pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arrival {
    /// Position over the ground, metres.
    pub(crate) position_m: Vec3,
    /// Course through the air on arrival, radians.
    pub(crate) course_rad: f64,
    /// Climb angle on arrival, radians.
    pub(crate) climb_rad: f64,
}

/// A turn round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Turnaround {
    /// The manoeuvre, in time from its first state.
    pub(crate) maneuver: Maneuver,
    /// Its arrival, seconds from the decision.
    pub(crate) arrives_s: f64,
}

/// Turn angles, left positive, and the straight flight between the first two, in turn radii.
#[derive(Debug, Clone, Copy)]
struct Word {
    turns_rad: [f64; 3],
    straight: f64,
}

impl Word {
    fn length(&self) -> f64 {
        self.turns_rad.iter().map(|turn| turn.abs()).sum::<f64>() + self.straight
    }

    const fn mirrored(self) -> Self {
        let [a, b, c] = self.turns_rad;
        Self {
            turns_rad: [-a, -b, -c],
            straight: self.straight,
        }
    }
}

/// A full circle or less, from 0 on.
fn positive(angle_rad: f64) -> f64 {
    let turn = libm::fmod(angle_rad, TAU);
    let turn = if turn < 0.0 { turn + TAU } else { turn };
    if turn > TAU - NO_TURN_RAD { 0.0 } else { turn }
}

/// Left, straight, left.
fn same_side(x: f64, y: f64, turn: f64) -> Word {
    // Centers of the two circles: (0, 1) and (x - sin, y + cos).
    let (sin, cos) = libm::sincos(turn);
    let (dx, dy) = (x - sin, y + cos - 1.0);
    let straight = libm::hypot(dx, dy);
    let course = if straight < 1e-12 {
        0.0
    } else {
        libm::atan2(dy, dx)
    };
    Word {
        turns_rad: [positive(course), 0.0, positive(turn - course)],
        straight,
    }
}

/// Left, straight, right.
fn other_side(x: f64, y: f64, turn: f64) -> Option<Word> {
    // Centers: (0, 1) and (x + sin, y - cos).
    let (sin, cos) = libm::sincos(turn);
    let (dx, dy) = (x + sin, y - cos - 1.0);
    let square = dx * dx + dy * dy - 4.0;
    if square < 0.0 {
        return None;
    }
    let straight = libm::sqrt(square);
    let course = libm::atan2(dy, dx) + libm::atan2(2.0, straight);
    Some(Word {
        turns_rad: [positive(course), 0.0, -positive(course - turn)],
        straight,
    })
}

/// Left, right, left; the middle turn is the longer one.
fn three_turns(x: f64, y: f64, turn: f64) -> Option<Word> {
    let (sin, cos) = libm::sincos(turn);
    let (dx, dy) = (x - sin, y + cos - 1.0);
    let apart = libm::hypot(dx, dy);
    if apart > 4.0 {
        return None;
    }
    // The middle circle touches both: it lies at 2 from either center, and the shortest way takes
    // more than half of it.
    let between = libm::atan2(dy, dx);
    let lean = libm::acos((apart / 4.0).limited(-1.0, 1.0));
    let first = positive(between + lean + 0.5 * PI);
    let middle = PI + 2.0 * lean;
    let last = positive(turn - first + middle);
    Some(Word {
        turns_rad: [first, -middle, last],
        straight: 0.0,
    })
}

/// Number of kinds of words.
const KINDS: usize = 6;

/// The word of a kind to a pose in turn radii, relative to the start, whose course is 0.
fn word(kind: usize, x: f64, y: f64, turn: f64) -> Option<Word> {
    let mirror = |word: Word| word.mirrored();
    match kind {
        0 => Some(same_side(x, y, turn)),
        1 => Some(same_side(x, -y, -turn).mirrored()),
        2 => other_side(x, y, turn),
        3 => other_side(x, -y, -turn).map(mirror),
        4 => three_turns(x, y, turn),
        _ => three_turns(x, -y, -turn).map(mirror),
    }
}

/// The quickest turn round from a state to a pose; `None` if the wind prevents every one.
pub(crate) fn turnaround(air: &Air<'_>, state: &MotionState, to: &Arrival) -> Option<Turnaround> {
    let (flyer, wind_mps) = (air.flyer, air.wind_mps);
    let rate = flyer.course_rate_radps();
    let radius_m = flyer.airspeed_mps() / rate;
    let (sin, cos) = libm::sincos(state.course_rad);
    let turn = to.course_rad - state.course_rad;
    let mut best: Option<(f64, Word)> = None;
    for kind in 0..KINDS {
        let mut taken_s = 0.0;
        for _ in 0..DRIFT_STEPS {
            let offset = to.position_m - state.position_m - wind_mps * (state.time_s + taken_s);
            let x = (cos * offset.x + sin * offset.y) / radius_m;
            let y = (cos * offset.y - sin * offset.x) / radius_m;
            if !air.meter.take(WORD) {
                return None;
            }
            let Some(word) = word(kind, x, y, turn) else {
                break;
            };
            let needed_s = word.length() / rate;
            let drift_m = wind_mps.length() * (needed_s - taken_s).abs();
            if drift_m < DRIFT_LEFT_M {
                if best.is_none_or(|(least_s, _)| needed_s < least_s) {
                    best = Some((needed_s, word));
                }
                break;
            }
            taken_s = needed_s;
        }
    }
    let (needed_s, word) = best?;
    let mut maneuver = Maneuver::hold();
    let (low, high) = air.climb_limits_rad;
    let climb_rad = climb_over(flyer, state, to, wind_mps, needed_s).limited(low, high);
    let mut course_rad = state.course_rad;
    let mut at_s = state.time_s;
    for (place, turn_rad) in word.turns_rad.iter().enumerate() {
        if place == 2 {
            at_s += word.straight / rate;
        }
        if *turn_rad != 0.0 {
            course_rad += turn_rad;
            maneuver.push(Stage {
                start_s: at_s,
                course_rad,
                climb_rad,
                rate_share: 1.0,
            });
            at_s += turn_rad.abs() / rate;
        }
    }
    // On arrival: the leg's own climb angle.
    maneuver.push(Stage {
        start_s: at_s,
        course_rad,
        climb_rad: to.climb_rad,
        rate_share: 1.0,
    });
    Some(Turnaround {
        maneuver,
        arrives_s: at_s,
    })
}

/// The climb angle that brings the aircraft to the height of a pose in a time, radians.
fn climb_over(
    flyer: &Flyer,
    state: &MotionState,
    to: &Arrival,
    wind_mps: Vec3,
    within_s: f64,
) -> f64 {
    let rise_m = to.position_m.z - state.position_m.z - wind_mps.z * within_s;
    let way_m = flyer.airspeed_mps() * within_s;
    if way_m <= 0.0 || rise_m.abs() < 0.01 {
        return 0.0;
    }
    libm::asin((rise_m / way_m).limited(-1.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga_proof::meter::Meter;
    use fga_proof::prediction::for_each_piece;
    use fga_proof::vehicle::{Response, Vehicle};
    use proptest::prelude::*;

    fn flyer() -> Flyer {
        Flyer::new(&Vehicle {
            airspeed_mps: 15.0,
            turn_radius_m: 30.0,
            climb_min_rad: -0.26,
            climb_max_rad: 0.26,
            climb_rate_radps: 0.2,
            response: Response::default(),
        })
    }

    fn found(state: &MotionState, to: &Arrival, wind_mps: Vec3) -> Option<Turnaround> {
        let air = Air {
            flyer: &flyer(),
            wind_mps,
            climb_limits_rad: (-0.26, 0.26),
            meter: &Meter::unlimited(),
        };
        turnaround(&air, state, to)
    }

    fn at(course_rad: f64) -> MotionState {
        MotionState {
            course_rad,
            ..MotionState::ahead(0.0)
        }
    }

    /// Lines 20 m apart: a bulb, some 3.9 radii beyond the half circle's pi.
    #[test]
    fn a_bulb_turns_back_onto_a_near_line() {
        let to = Arrival {
            position_m: Vec3::new(0.0, 20.0, 0.0),
            course_rad: PI,
            climb_rad: 0.0,
        };
        let found = found(&at(0.0), &to, Vec3::ZERO).unwrap();
        let end = for_each_piece(
            &flyer(),
            &at(0.0),
            &found.maneuver,
            found.arrives_s,
            |_, _, _| (),
        );
        assert!(end.position_m.distance(to.position_m) < 1e-6, "{end:?}");
        // Three turns with centers at the corners of a triangle of sides 2r, 2r and 2r + d.
        let shortest_s = (PI + 4.0 * libm::acos((60.0 + 20.0) / 120.0)) * 2.0;
        assert!(
            (found.arrives_s - shortest_s).abs() < 1e-6,
            "{}",
            found.arrives_s
        );
    }

    proptest! {
        /// Flown with the predicted motion it arrives, also in wind.
        #[test]
        fn it_arrives(x in -200.0..200.0f64, y in -200.0..200.0f64, course in -3.1..3.1f64, start in -3.1..3.1f64, wx in -7.0..7.0f64, wy in -7.0..7.0f64) {
            let to = Arrival { position_m: Vec3::new(x, y, 0.0), course_rad: course, climb_rad: 0.0 };
            let wind = Vec3::new(wx, wy, 0.0);
            if let Some(found) = found(&at(start), &to, wind) {
                let end = for_each_piece(&flyer(), &at(start), &found.maneuver, found.arrives_s, |_, _, _| ());
                let ground = end.position_m + wind * found.arrives_s;
                prop_assert!(ground.distance(to.position_m) < 0.05, "{} {}", ground, to.position_m);
                prop_assert!(fga_proof::angle::wrap_pi(end.course_rad - course).abs() < 1e-6);
            } else {
                prop_assert!(wind.length() > 3.0);
            }
        }
    }
}
