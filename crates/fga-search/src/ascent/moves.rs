//! How the parameters of a manoeuvre move the aircraft, in closed form.
//!
//! Turns and changes of climb have constant rates. A larger turn therefore turns all that follows about the point where the
//! turn ended, and a later start moves the whole flight in time. With bank lag this is nearly true if the turns begin later:
//! good enough for a slope, because each step is flown before it counts.

use crate::Turns;
use crate::climbs::PARAMETERS;
use fga_proof::Vec3;
use fga_proof::prediction::{Flyer, MotionState, Piece};

/// Displacements of the aircraft, metres per unit of each parameter.
pub(super) type Moves = [Vec3; PARAMETERS];

/// Most pieces of constant rates: two turns and two changes of climb, each with its beginning and its end.
const MOST_PIECES: usize = 12;

/// Moments closer than this are the same, seconds.
const SAME_S: f64 = 1e-9;

/// A smaller angle than this is none, radians.
const REACHED_RAD: f64 = 1e-9;

/// An angle that follows two commands one after the other at a constant rate.
#[derive(Clone, Copy)]
struct Followed {
    rate_radps: f64,
    /// The commands and when they begin, seconds.
    commands: [(f64, f64); 2],
    /// How many have begun.
    begun: usize,
    /// Its rate if the second command came a little later; none if the first one was done by then.
    before_radps: f64,
}

impl Followed {
    const fn new(rate_radps: f64, commands: [(f64, f64); 2]) -> Self {
        Self {
            rate_radps,
            commands,
            begun: 0,
            before_radps: 0.0,
        }
    }

    fn towards(&self, from_rad: f64, to_rad: f64) -> f64 {
        let left_rad = to_rad - from_rad;
        if left_rad.abs() < REACHED_RAD || self.rate_radps <= 0.0 {
            0.0
        } else {
            libm::copysign(self.rate_radps, left_rad)
        }
    }

    /// The rate from a moment on, and how long it lasts, seconds.
    #[inline(never)]
    fn next(&mut self, now_s: f64, angle_rad: f64) -> (f64, f64) {
        let [first, second] = self.commands;
        let begins = |at_s: f64| at_s <= now_s + SAME_S;
        while self
            .commands
            .get(self.begun)
            .is_some_and(|(at_s, _)| begins(*at_s))
        {
            self.begun += 1;
            if self.begun == 2 {
                self.before_radps = self.towards(angle_rad, first.1);
            }
        }
        let (to_rad, until_s) = match self.begun {
            0 => return (0.0, first.0 - now_s),
            1 => (first.1, second.0),
            _ => (second.1, f64::INFINITY),
        };
        let rate_radps = self.towards(angle_rad, to_rad);
        let left_s = until_s - now_s;
        if rate_radps == 0.0 {
            (0.0, left_s)
        } else {
            (rate_radps, left_s.min((to_rad - angle_rad) / rate_radps))
        }
    }

    /// How much the angle in this piece grows with the first angle, with the second one, and with the time of the second
    /// command. A second turn adds to the first one; a second climb angle takes its place.
    fn grows(&self, rate_radps: f64, is_relative: bool) -> [f64; 3] {
        let still = rate_radps == 0.0;
        match (self.begun, still) {
            (1, true) => [1.0, 0.0, 0.0],
            (2, _) => {
                let is_done = self.before_radps == 0.0;
                let first = if is_relative {
                    still || is_done
                } else {
                    !still && is_done
                };
                let later = if still {
                    0.0
                } else {
                    self.before_radps - rate_radps
                };
                [f64::from(first), f64::from(still), later]
            }
            _ => [0.0; 3],
        }
    }
}

/// A piece of a flight of constant rates, and what precedes it.
pub(super) struct Part<'a> {
    flyer: &'a Flyer,
    state: MotionState,
    piece: Piece,
    /// How much course and climb angle in it grow with each parameter.
    grows: [(f64, f64); PARAMETERS],
    /// The moves at its beginning.
    moved: Moves,
}

impl Part<'_> {
    /// The moves a time after its beginning, seconds.
    #[inline(never)]
    pub(super) fn moves_at(&self, after_s: f64) -> Moves {
        let Self { flyer, state, .. } = self;
        let flown_m = flyer.advance(state, &self.piece, after_s).position_m - state.position_m;
        let level_m = flyer.airspeed_mps() * libm::cos(state.climb_rad) * after_s;
        let slope = if level_m > 0.0 {
            flown_m.z / level_m
        } else {
            0.0
        };
        let mut moves = self.moved;
        for (move_m, (course, climb)) in moves.iter_mut().zip(self.grows) {
            *move_m += Vec3::new(
                -course * flown_m.y - climb * slope * flown_m.x,
                course * flown_m.x - climb * slope * flown_m.y,
                climb * level_m,
            );
        }
        moves
    }
}

/// Shows the parts of the flight of some turns from their departure until a moment: from and until when each lasts, seconds.
#[inline(never)]
pub(super) fn moves(
    flyer: &Flyer,
    departure: &MotionState,
    turns: &Turns,
    until_s: f64,
    visit: &mut dyn FnMut(f64, f64, &Part<'_>),
) {
    let later_s = flyer.turns_later_s();
    let second = turns.second;
    let start_s = turns.wait_s;
    let again_s = second.map_or(f64::INFINITY, |second| start_s + second.after_s);
    let first_rad = departure.course_rad + turns.turn_rad;
    let second_rad = second.map_or(first_rad, |second| first_rad + second.turn_rad);
    let mut course = Followed::new(
        flyer.course_rate_radps(),
        [
            (start_s + later_s, first_rad),
            (again_s + later_s, second_rad),
        ],
    );
    let second_climb = second.map_or(turns.climb_rad, |second| second.climb_rad);
    let mut climb = Followed::new(
        flyer.climb_rate_radps(),
        [(start_s, turns.climb_rad), (again_s, second_climb)],
    );
    let mut part = Part {
        flyer,
        state: MotionState {
            time_s: start_s,
            position_m: Vec3::ZERO,
            course_rad: departure.course_rad + flyer.rollout_rad(departure.bank_rad),
            climb_rad: departure.climb_rad,
            bank_rad: 0.0,
        },
        piece: Piece::steady(0.0, 0.0, 0.0, 0.0),
        grows: [(0.0, 0.0); PARAMETERS],
        moved: [Vec3::ZERO; PARAMETERS],
    };
    for _ in 0..MOST_PIECES {
        let now = &part.state;
        let (now_s, left_s) = (now.time_s, until_s - now.time_s);
        if left_s <= 0.0 {
            return;
        }
        let (turning_radps, turns_s) = course.next(now_s, now.course_rad);
        let (climbing_radps, climbs_s) = climb.next(now_s, now.climb_rad);
        let lasts_s = turns_s.min(climbs_s).min(left_s);
        let [turn, second_turn, turn_later] = course.grows(turning_radps, true);
        let [up, second_up, up_later] = climb.grows(climbing_radps, false);
        part.piece = Piece::steady(lasts_s, turning_radps, climbing_radps, 0.0);
        part.grows = [
            (-turning_radps, -climbing_radps),
            (turn, 0.0),
            (0.0, up),
            (turn_later, up_later),
            (second_turn, 0.0),
            (0.0, second_up),
        ];
        visit(now_s, now_s + lasts_s, &part);
        part.moved = part.moves_at(lasts_s);
        part.state = flyer.advance(&part.state, &part.piece, lasts_s);
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;
    use crate::SecondTurn;
    use fga_proof::maneuver::Stage;
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

    /// Where a manoeuvre leads by a moment, straight from its definition.
    fn place(flyer: &Flyer, at: &[f64; PARAMETERS], at_s: f64) -> Vec3 {
        let first = to_turns(at);
        let second = first.second.unwrap();
        let again_s = first.wait_s + second.after_s;
        let again_rad = first.turn_rad + second.turn_rad;
        let stages = [
            Stage::turn(first.wait_s, first.turn_rad, first.climb_rad),
            Stage::turn(again_s, again_rad, second.climb_rad),
        ];
        let start = MotionState::ahead(0.0);
        flown(flyer, &start, &stages, at_s, &Meter::unlimited()).position_m
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
        let departure = flown(
            flyer,
            &MotionState::ahead(0.0),
            &[],
            at[0],
            &Meter::unlimited(),
        );
        let mut closed = None;
        moves(
            flyer,
            &departure,
            &to_turns(at),
            at_s,
            &mut |from_s, until_s, part| {
                if until_s >= at_s {
                    closed = Some(part.moves_at(at_s - from_s));
                }
            },
        );
        (flights, closed.unwrap_or([Vec3::ZERO; PARAMETERS]))
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
