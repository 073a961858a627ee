//! How the parameters of a manoeuvre move the aircraft, in closed form.
//!
//! A larger turn turns all that follows about the place where the turn ended, a steeper climb lifts it, and a later command
//! delays it: each is the way flown between two moments, turned or raised. With bank lag this is nearly true if the turns
//! begin later: good enough for a slope, because each step is flown before it counts.

use crate::Turns;
use crate::climbs::PARAMETERS;
use fga_proof::Vec3;
use fga_proof::prediction::{FlightPath, Flyer, MotionState};

/// An angle that follows two commands one after the other at a constant rate.
struct Followed {
    /// The aircraft where the angle begins and ends to change after the first command, then after the second one.
    changes: [MotionState; 4],
    /// The rates of the changes, radians per second.
    rates_radps: [f64; 2],
    /// Whether the second command comes before the end of the first change.
    is_cut: bool,
}

impl Followed {
    /// From an angle, radians, at a rate, radians per second: the commands and when they begin, seconds.
    fn new(
        (from_rad, limit_radps): (f64, f64),
        [first, second]: [(f64, f64); 2],
        at: impl Fn(f64) -> MotionState,
    ) -> Self {
        let change = |from_rad: f64, (begins_s, to_rad): (f64, f64)| {
            let left_rad = to_rad - from_rad;
            let rate_radps = libm::copysign(limit_radps, left_rad);
            let is_changed = limit_radps > 0.0;
            let lasts_s = if is_changed {
                left_rad / rate_radps
            } else {
                0.0
            };
            (rate_radps, begins_s + lasts_s)
        };
        let (first_radps, ends_s) = change(from_rad, first);
        let is_cut = second.0 < ends_s;
        let between_rad = if is_cut {
            from_rad + first_radps * (second.0 - first.0)
        } else {
            first.1
        };
        let (second_radps, over_s) = change(between_rad, second);
        Self {
            changes: [first.0, ends_s.min(second.0), second.0, over_s].map(at),
            rates_radps: [first_radps, second_radps],
            is_cut,
        }
    }

    /// How the aircraft moves by a state with the time of both commands, the first angle, the time of the second command, and the
    /// second angle. `moved` is how it moves with the angle from one state to another. A second turn adds to the first one; a
    /// second climb angle takes its place.
    fn moves(
        &self,
        now: &MotionState,
        is_relative: bool,
        moved: impl Fn(&MotionState, &MotionState) -> Vec3,
    ) -> [Vec3; 4] {
        let by_now = |state: MotionState| {
            if state.time_s < now.time_s {
                state
            } else {
                *now
            }
        };
        let [begins, ends, again, over] = self.changes.map(by_now);
        let [first_radps, second_radps] = self.rates_radps;
        let changing = moved(&again, &over);
        let second = moved(&over, now);
        let first = match (self.is_cut, is_relative) {
            (true, true) => second,
            (true, false) => Vec3::ZERO,
            (false, true) => moved(&ends, now),
            (false, false) => moved(&ends, &again) + changing,
        };
        let goes_on_radps = if self.is_cut { first_radps } else { 0.0 };
        [
            -first_radps * moved(&begins, &ends) - second_radps * changing,
            first,
            (goes_on_radps - second_radps) * changing,
            second,
        ]
    }
}

/// How the parameters of some turns move the aircraft.
pub(super) struct Moves<'a> {
    flyer: &'a Flyer,
    course: Followed,
    climb: Followed,
}

impl<'a> Moves<'a> {
    /// Of turns that depart from the mission at a state, and their path.
    pub(super) fn new(
        flyer: &'a Flyer,
        departure: &MotionState,
        turns: &Turns,
        path: &FlightPath,
    ) -> Self {
        let at = |time_s| path.state_at(flyer, time_s).unwrap_or(*departure);
        // So much later a turn without bank lag would begin to lead to about the same places.
        let later_s = flyer.rollout_rad(flyer.full_bank_rad()) / flyer.course_rate_radps();
        let start_s = turns.wait_s;
        let again_s = turns
            .second
            .map_or(f64::INFINITY, |second| start_s + second.after_s);
        let second = turns.second.unwrap_or_default();
        let from_rad = departure.course_rad + flyer.rollout_rad(departure.bank_rad);
        let first_rad = departure.course_rad + turns.turn_rad;
        let courses = [
            (start_s + later_s, first_rad),
            (again_s + later_s, first_rad + second.turn_rad),
        ];
        let climbs = [(start_s, turns.climb_rad), (again_s, second.climb_rad)];
        let climb = (departure.climb_rad, flyer.climb_rate_radps());
        Self {
            flyer,
            course: Followed::new((from_rad, flyer.course_rate_radps()), courses, at),
            climb: Followed::new(climb, climbs, at),
        }
    }

    /// Displacements of the aircraft at a state of the flight, metres per unit of each parameter.
    #[inline(never)]
    pub(super) fn at(&self, now: &MotionState) -> [Vec3; PARAMETERS] {
        let [wait, turn, turn_later, second_turn] = self.course.moves(now, true, |from, to| {
            let flown_m = to.position_m - from.position_m;
            Vec3::new(-flown_m.y, flown_m.x, 0.0)
        });
        let [climb_wait, up, up_later, second_up] = self.climb.moves(now, false, |from, to| {
            let flown_m = to.position_m - from.position_m;
            let path_m = self.flyer.airspeed_mps() * (to.time_s - from.time_s);
            let level_m = libm::sqrt((path_m * path_m - flown_m.z * flown_m.z).max(0.0));
            let slope = flown_m.z / level_m.max(f64::MIN_POSITIVE);
            (-slope * flown_m).with_z(level_m)
        });
        [
            wait + climb_wait,
            turn,
            up,
            turn_later + up_later,
            second_turn,
            second_up,
        ]
    }
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

    /// The commands of a manoeuvre, straight from its definition.
    fn stages(at: &[f64; PARAMETERS]) -> [Stage; 2] {
        let first = to_turns(at);
        let second = first.second.unwrap();
        let again_s = first.wait_s + second.after_s;
        let again_rad = first.turn_rad + second.turn_rad;
        [
            Stage::turn(first.wait_s, first.turn_rad, first.climb_rad),
            Stage::turn(again_s, again_rad, second.climb_rad),
        ]
    }

    /// Where a manoeuvre leads by a moment.
    fn place(flyer: &Flyer, at: &[f64; PARAMETERS], at_s: f64) -> Vec3 {
        let start = MotionState::ahead(0.0);
        flown(flyer, &start, &stages(at), at_s, &Meter::unlimited()).position_m
    }

    /// Displacements by differences of flights, and in closed form.
    fn both(
        flyer: &Flyer,
        at: &[f64; PARAMETERS],
        at_s: f64,
    ) -> ([Vec3; PARAMETERS], [Vec3; PARAMETERS]) {
        let mut flights = [Vec3::ZERO; PARAMETERS];
        for (parameter, slot) in flights.iter_mut().enumerate() {
            let (mut less, mut more) = (*at, *at);
            less[parameter] -= STEP;
            more[parameter] += STEP;
            *slot = (place(flyer, &more, at_s) - place(flyer, &less, at_s)) / (2.0 * STEP);
        }
        let departure = flown(
            flyer,
            &MotionState::ahead(0.0),
            &[],
            at[0],
            &Meter::unlimited(),
        );
        let (turns, mut path) = (to_turns(at), FlightPath::new());
        let mut maneuver = Maneuver::hold();
        maneuver.set(stages(at));
        path.predict(flyer, &MotionState::ahead(0.0), &maneuver, 20.0);
        let now = path.state_at(flyer, at_s).unwrap();
        (
            flights,
            Moves::new(flyer, &departure, &turns, &path).at(&now),
        )
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
