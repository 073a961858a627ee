//! How the parameters of a manoeuvre move the aircraft.
//!
//! A larger turn turns all that follows about the place where the turn ends, and a later start turns all turns back: each parameter
//! turns parts of the flight. Course and climb angle change at constant rates. With bank lag this is nearly true if the turns begin
//! later: good enough for a slope, because each step is flown before it counts.

use crate::Turns;
use crate::climbs::PARAMETERS;
use fga_proof::Vec3;
use fga_proof::prediction::{FlightPath, Flyer, MotionState};

/// Displacements of the aircraft, metres per unit of each parameter.
pub(super) type Moves = [Vec3; PARAMETERS];

/// A smaller angle than this is none, radians.
const REACHED_RAD: f64 = 1e-9;

/// A part of the flight from one moment to another, seconds, and by how much a parameter turns it, radians per unit.
struct Part {
    parameter: usize,
    turns: f64,
    window_s: (f64, f64),
}

/// The parts of the flight that the wait (parameter 0), a first angle, the time from the first command to the second one (parameter 3)
/// and a second angle turn.
///
/// The angle follows the two commands, each with its moment, seconds, and its parameter. A second turn adds to the first one; a second climb
/// angle takes its place.
fn parts(
    (from_rad, rate_radps): (f64, f64),
    [(begins_s, first_rad, first), (again_s, second_rad, second)]: [(f64, f64, usize); 2],
    is_relative: bool,
) -> [Part; 6] {
    let towards = |left_rad: f64| {
        if left_rad.abs() < REACHED_RAD || rate_radps <= 0.0 {
            return (0.0, 0.0);
        }
        let radps = libm::copysign(rate_radps, left_rad);
        (radps, left_rad / radps)
    };
    let (first_radps, takes_s) = towards(first_rad - from_rad);
    let reached_s = begins_s + takes_s;
    let is_reached = reached_s <= again_s;
    let (before_radps, at_rad) = if is_reached {
        (0.0, first_rad)
    } else {
        (first_radps, from_rad + first_radps * (again_s - begins_s))
    };
    let (second_radps, takes_s) = towards(second_rad - at_rad);
    let over_s = again_s + takes_s;
    let first_s = if is_reached { reached_s } else { over_s };
    let until_s = if is_relative { f64::INFINITY } else { over_s };
    let moves = (again_s, over_s);
    let part = |parameter, turns, window_s| Part {
        parameter,
        turns,
        window_s,
    };
    [
        part(0, -first_radps, (begins_s, reached_s.min(again_s))),
        part(0, -second_radps, moves),
        part(first, 1.0, (first_s, again_s)),
        part(first, 1.0, (first_s.max(again_s), until_s)),
        part(3, before_radps - second_radps, moves),
        part(second, 1.0, (over_s, f64::INFINITY)),
    ]
}

/// The moves at a moment of the flight of some turns, which the path is.
pub(super) fn moves(
    flyer: &Flyer,
    path: &FlightPath,
    (departure, turns): (&MotionState, &Turns),
    at_s: f64,
) -> Moves {
    let later_s = flyer.turns_later_s();
    let begins_s = turns.wait_s;
    let first_rad = departure.course_rad + turns.turn_rad;
    let (again_s, second_rad, second_climb) = match turns.second {
        Some(second) => (
            begins_s + second.after_s,
            first_rad + second.turn_rad,
            second.climb_rad,
        ),
        None => (f64::INFINITY, first_rad, turns.climb_rad),
    };
    let course_rad = departure.course_rad + flyer.rollout_rad(departure.bank_rad);
    let courses = [
        (begins_s + later_s, first_rad, 1),
        (again_s + later_s, second_rad, 4),
    ];
    let climbs = [(begins_s, turns.climb_rad, 2), (again_s, second_climb, 5)];
    let climbed = (departure.climb_rad, flyer.climb_rate_radps());
    let place_m = |time_s: f64| {
        let there = path.state_at(flyer, time_s);
        there.map_or(Vec3::ZERO, |there| there.position_m)
    };
    let mut moves = [Vec3::ZERO; PARAMETERS];
    let mut turn = |part: &Part, turned: &dyn Fn(Vec3, f64) -> Vec3| {
        let [from_s, until_s] = [part.window_s.0, part.window_s.1].map(|time_s| time_s.min(at_s));
        if part.turns != 0.0
            && from_s < until_s
            && let Some(move_m) = moves.get_mut(part.parameter)
        {
            let flown_m = place_m(until_s) - place_m(from_s);
            *move_m += turned(flown_m, until_s - from_s) * part.turns;
        }
    };
    for part in parts((course_rad, flyer.course_rate_radps()), courses, true) {
        turn(&part, &|flown_m, _| Vec3::new(-flown_m.y, flown_m.x, 0.0));
    }
    for part in parts(climbed, climbs, false) {
        turn(&part, &|flown_m, for_s| {
            let path_m = flyer.airspeed_mps() * for_s;
            let level_m = libm::sqrt((path_m * path_m - flown_m.z * flown_m.z).max(0.0));
            let slope = flown_m.z / level_m.max(f64::MIN_POSITIVE);
            Vec3::new(-slope * flown_m.x, -slope * flown_m.y, level_m)
        });
    }
    moves
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;
    use crate::SecondTurn;
    use fga_proof::maneuver::{Maneuver, Stage};
    use fga_proof::meter::Meter;
    use fga_proof::prediction::flown;
    use fga_proof::vehicle::Vehicle;
    use proptest::prelude::*;

    /// Steps of the differences: seconds and radians.
    const STEP: f64 = 1e-5;

    fn to_turns(at: &[f64; PARAMETERS]) -> Turns {
        let [
            wait_s,
            turn_rad,
            climb_rad,
            after_s,
            second_rad,
            second_climb,
        ] = *at;
        Turns {
            wait_s,
            turn_rad,
            climb_rad,
            second: Some(SecondTurn {
                after_s,
                turn_rad: second_rad,
                climb_rad: second_climb,
            }),
        }
    }

    /// A manoeuvre from its parameters.
    fn maneuver(at: &[f64; PARAMETERS]) -> Maneuver {
        let first = to_turns(at);
        let second = first.second.unwrap();
        let again_s = first.wait_s + second.after_s;
        let again_rad = first.turn_rad + second.turn_rad;
        let mut maneuver = Maneuver::turn(first.wait_s, first.turn_rad, first.climb_rad);
        maneuver.push(Stage::turn(again_s, again_rad, second.climb_rad));
        maneuver
    }

    /// Where a manoeuvre leads by a moment, straight from its definition.
    fn place(flyer: &Flyer, at: &[f64; PARAMETERS], at_s: f64) -> Vec3 {
        let start = MotionState::ahead(0.0);
        let meter = Meter::unlimited();
        flown(flyer, &start, maneuver(at).stages(), at_s, &meter).position_m
    }

    /// Displacements by differences of flights, and in closed form.
    fn both(flyer: &Flyer, at: &[f64; PARAMETERS], at_s: f64) -> (Moves, Moves) {
        let mut flights = [Vec3::ZERO; PARAMETERS];
        for (parameter, slot) in flights.iter_mut().enumerate() {
            let (mut less, mut more) = (*at, *at);
            less[parameter] -= STEP;
            more[parameter] += STEP;
            *slot = (place(flyer, &more, at_s) - place(flyer, &less, at_s)) / (2.0 * STEP);
        }
        let (start, turns) = (MotionState::ahead(0.0), to_turns(at));
        let mut path = FlightPath::new();
        let departure = flown(flyer, &start, &[], at[0], &Meter::unlimited());
        path.predict(flyer, &start, &maneuver(at), 30.0);
        (flights, moves(flyer, &path, (&departure, &turns), at_s))
    }

    fn flyer(lag_s: f64) -> Flyer {
        Flyer::new(&Vehicle::lagged(lag_s))
    }

    proptest! {
        #[test]
        fn without_lag_flights_that_differ_a_little_part_as_the_moves_say(
            (wait_s, after_s, at_s) in (0.1..2.0f64, 0.1..5.0f64, 0.5..12.0f64),
            (turn_rad, second_rad) in (-2.5..2.5f64, -2.5..2.5f64),
            (climb_rad, second_climb) in (-0.25..0.25f64, -0.25..0.25f64),
        ) {
            let at = [wait_s, turn_rad, climb_rad, after_s, second_rad, second_climb];
            let (flights, closed) = both(&flyer(0.0), &at, at_s);
            for (parameter, (flight, closed)) in flights.iter().zip(closed).enumerate() {
                // The climb during a piece is taken as that at its beginning: up to 3 % of 180 m.
                let apart_m = (*flight - closed).length();
                prop_assert!(
                    apart_m < 0.5 + 0.03 * flight.length(),
                    "parameter {parameter}: {flight} m, {closed} m"
                );
            }
        }
    }

    #[test]
    fn with_lag_most_moves_are_nearly_right() {
        let flyer = flyer(0.6);
        let mut apart = Vec::new();
        for turn in -4..=4 {
            for second in -4..=4 {
                for at_s in [3.0, 5.0, 8.0] {
                    let (turn_rad, second_rad) =
                        (0.35 * f64::from(turn) + 0.1, 0.35 * f64::from(second) - 0.1);
                    let at = [0.3, turn_rad, 0.15, 1.8, second_rad, -0.1];
                    let (flights, closed) = both(&flyer, &at, at_s);
                    for (flight, closed) in flights.iter().zip(closed) {
                        if flight.length() > 1.0 {
                            apart.push((*flight - closed).length() / flight.length());
                        }
                    }
                }
            }
        }
        apart.sort_by(f64::total_cmp);
        assert!(apart[apart.len() / 2] < 0.02, "{}", apart[apart.len() / 2]);
        assert!(apart[apart.len() * 9 / 10] < 0.15);
    }
}
