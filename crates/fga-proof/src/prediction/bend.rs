//! Where a turn leads once it is over, without flying it.
//!
//! A turn ends on a straight line. Without lag that is the tangent of a circle; with a bank lag it is still close to
//! one: rolling in delays the turn and shifts the circle, rolling out shifts the tangent, by what both move the aircraft
//! however far it turns in between. Only turns that end while the aircraft still rolls in are looked up in a table.

use crate::Vec3;
use crate::prediction::motion::arc::unit;
use crate::prediction::motion::{Bend, End, Ends, FIRST, Flyer, MotionState, NODES, Target};

/// Most turn between two pieces of a roll-in, radians.
const NODE_RAD: f64 = 0.35;

/// Ends nearer than this to each other tell nothing of how the turns between them bend, radians.
const APART_RAD: f64 = 1e-3;

/// A roll-out is nearly over after this many time constants.
const ROLLS_OUT: f64 = 4.0;

/// How far the line at the end of a turn may be from the true one, between the ends of the pieces too, turn radii.
const INEXACT: f64 = 0.005;

impl End {
    /// Of a turn that begins to roll out now.
    fn now(flyer: &Flyer, state: &MotionState) -> Self {
        let (forward, left) = flyer.roll_out_m(state.bank_rad);
        let (sin, cos) = libm::sincos(state.course_rad);
        Self {
            turn_rad: state.course_rad + flyer.rollout_rad(state.bank_rad),
            time_s: state.time_s,
            at_m: (state.position_m.x, state.position_m.y),
            from_m: (
                state.position_m.x + cos * forward - sin * left,
                state.position_m.y + sin * forward + cos * left,
            ),
            bank_rad: state.bank_rad,
        }
    }
}

/// A vector turned to the right by an angle with this cosine and sine.
fn turned_back((cos, sin): (f64, f64), (forward, side): (f64, f64)) -> (f64, f64) {
    (forward * cos + side * sin, side * cos - forward * sin)
}

/// The line on which a turn ends: where the aircraft would have begun it when the roll-out began.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Exit {
    /// When the roll-out begins, seconds.
    pub begins_s: f64,
    /// When the roll-out is over, seconds.
    pub over_s: f64,
    /// Where the aircraft is when it begins, forward and to the side of the turn, metres.
    pub at_m: (f64, f64),
    /// From where it seems to have flown straight since then, once it has rolled out.
    pub from_m: (f64, f64),
    /// Cosine and sine of the turn.
    pub turned: (f64, f64),
    /// What the aircraft has flown by then, metres.
    pub path_m: f64,
}

impl<const MOST: usize> Ends<MOST> {
    fn all(&self) -> &[End] {
        self.kept.get(..self.len).unwrap_or(&[])
    }

    /// Adds the end of a turn that begins to roll out at a state.
    fn push(&mut self, end: End, state: &MotionState) {
        if let Some(slot) = self.kept.get_mut(self.len) {
            *slot = end;
            self.len += 1;
            self.rolled_in = *state;
        }
    }

    /// The place of the first end beyond a bank, and the aircraft at that bank: rolling in does not depend on where it began.
    fn at(&self, flyer: &Flyer, bank_rad: f64) -> Option<(usize, MotionState)> {
        let next = self.all().iter().position(|end| end.bank_rad > bank_rad)?;
        let before = self.all().get(next.checked_sub(1)?)?;
        let state = MotionState {
            time_s: before.time_s,
            position_m: Vec3::new(before.at_m.0, before.at_m.1, 0.0),
            course_rad: before.turn_rad - flyer.rollout_rad(before.bank_rad),
            ..MotionState::ahead(before.bank_rad)
        };
        let full_rad = flyer.full_bank_rad();
        let off = (full_rad - bank_rad) / (full_rad - before.bank_rad);
        let after_s = -flyer.bank_time_constant_s() * libm::log(off);
        let piece = flyer.next_piece_within(&state, &Target::TURNING_LEFT, after_s);
        let here = flyer.advance(&state, &piece, after_s.min(piece.duration_s));
        Some((next, here))
    }
}

impl Flyer {
    /// Keeps the roll-in from the largest bank to that of the other side.
    pub(super) fn keep_roll_in(&mut self) {
        let mut state = MotionState::ahead(-self.full_bank_rad());
        self.roll_in.len = 0;
        for _ in 0..NODES {
            let end = End::now(self, &state);
            self.roll_in.push(end, &state);
            let Some(next) = self.rolls_in(&state) else {
                break;
            };
            state = next;
        }
    }

    /// The aircraft after the next piece of a roll-in to the left; `None` once that is over.
    fn rolls_in(&self, state: &MotionState) -> Option<MotionState> {
        let piece = self.next_piece(state, &Target::TURNING_LEFT);
        let for_s = piece.duration_s.min(NODE_RAD / self.course_rate_radps());
        let is_over = piece.bank_command_rad == state.bank_rad;
        (!is_over).then(|| self.advance(state, &piece, for_s))
    }
}

impl Bend {
    /// No turns: zeros, which are written without a copy.
    pub const NONE: Self = Self {
        bank_rad: 0.0,
        first: Ends::NONE,
        next: 0,
        joins: {
            let here = (MotionState::ahead(0.0), (0.0, 0.0));
            [here, here]
        },
        last: End::NONE,
        rolled_in: (0.0, 0.0),
        least_full: (0.0, 0.0),
        roll_out_m: (0.0, 0.0),
    };

    /// Becomes the turns from a bank towards their side.
    #[inline(never)]
    pub fn set(&mut self, flyer: &Flyer, bank_rad: f64) {
        (self.bank_rad, self.first.len, self.next) = (bank_rad, 0, NODES);
        (self.rolled_in, self.least_full, self.roll_out_m) = ((1.0, 0.0), (1.0, 0.0), (0.0, 0.0));
        self.joins = [(MotionState::ahead(0.0), (1.0, 0.0)); 2];
        let mut state = MotionState::ahead(bank_rad);
        if flyer.is_ideal() {
            self.last = End::NONE;
            return self.first.push(End::NONE, &state);
        }
        let (roll_in, mut joined) = (&flyer.roll_in, None);
        for _ in 0..FIRST {
            self.first.push(End::now(flyer, &state), &state);
            let Some(next) = flyer.rolls_in(&state) else {
                break;
            };
            joined = roll_in.at(flyer, state.bank_rad);
            if joined.is_some() {
                break;
            }
            state = next;
        }
        let mut end = self.first.rolled_in;
        let last = match joined {
            Some((next, there)) => {
                self.next = next;
                self.joins = [there, end].map(|state| (state, unit(state.course_rad)));
                end = roll_in.rolled_in;
                roll_in.all().last().map(|last| self.placed(last))
            }
            None => self.first.all().last().copied(),
        };
        self.last = last.unwrap_or(End::NONE);
        self.rolled_in = self.turned(unit(end.course_rad));
        self.least_full = self.turned(unit(end.course_rad + flyer.rollout_rad(end.bank_rad)));
        self.roll_out_m = flyer.roll_out_m(end.bank_rad);
    }

    /// Has no turns any more.
    pub const fn clear(&mut self) {
        self.first.len = 0;
    }

    /// A vector of the flyer's roll-in, as it is here.
    fn turned(&self, vector: (f64, f64)) -> (f64, f64) {
        let [(_, there), (_, (cos, sin))] = self.joins;
        turned_back((cos, -sin), turned_back(there, vector))
    }

    /// An end of the flyer's roll-in, as it is here.
    fn placed(&self, end: &End) -> End {
        let [(there, _), (here, _)] = &self.joins;
        let place = |at_m: (f64, f64)| {
            let from_m = (at_m.0 - there.position_m.x, at_m.1 - there.position_m.y);
            let (x, y) = self.turned(from_m);
            (here.position_m.x + x, here.position_m.y + y)
        };
        End {
            turn_rad: self.placed_turn_rad(end.turn_rad),
            time_s: self.placed_time_s(end.time_s),
            at_m: place(end.at_m),
            from_m: place(end.from_m),
            bank_rad: end.bank_rad,
        }
    }

    fn end(&self, flyer: &Flyer, place: usize) -> Option<End> {
        if let Some(end) = self.first.all().get(place) {
            return Some(*end);
        }
        let rest = flyer.roll_in.all().get(self.next..)?;
        rest.get(place - self.first.len).map(|end| self.placed(end))
    }

    /// The place of the first end at which something is beyond a value; `placed` turns its value in the flyer's roll-in to that here.
    fn first_end(
        &self,
        flyer: &Flyer,
        (of, value): (fn(&End) -> f64, f64),
        placed: impl Fn(f64) -> f64,
    ) -> Option<usize> {
        let (first, rest) = (self.first.all(), flyer.roll_in.all().get(self.next..));
        let place = first.iter().position(|end| of(end) > value);
        place.or_else(|| {
            let place = rest?.iter().position(|end| placed(of(end)) > value)?;
            Some(first.len() + place)
        })
    }

    fn placed_turn_rad(&self, turn_rad: f64) -> f64 {
        let [(there, _), (here, _)] = &self.joins;
        here.course_rad + (turn_rad - there.course_rad)
    }

    fn placed_time_s(&self, time_s: f64) -> f64 {
        let [(there, _), (here, _)] = &self.joins;
        here.time_s + (time_s - there.time_s).max(0.0)
    }

    /// Whether it holds for a bank.
    pub fn is_from(&self, bank_rad: f64) -> bool {
        self.bank_rad == bank_rad && self.first.len > 0
    }

    /// The least turn: rolling out at once, radians.
    #[inline]
    pub fn least_rad(&self) -> f64 {
        self.first.all().first().map_or(0.0, |end| end.turn_rad)
    }

    /// Where the aircraft is at a moment of a turn that goes on, forward and to the side of the turn, metres.
    pub fn place_m(&self, flyer: &Flyer, at_s: f64) -> Option<(f64, f64)> {
        let last = &self.last;
        let turn_rad = if at_s >= last.time_s {
            last.turn_rad + flyer.course_rate_radps() * (at_s - last.time_s)
        } else {
            let next = self.first_end(flyer, (|end| end.time_s, at_s), |time_s| {
                self.placed_time_s(time_s)
            })?;
            let after = self.end(flyer, next)?;
            let before = self.end(flyer, next.saturating_sub(1))?;
            let span = (after.time_s - before.time_s).max(f64::MIN_POSITIVE);
            let share = ((at_s - before.time_s) / span).max(0.0);
            before.turn_rad + share * (after.turn_rad - before.turn_rad)
        };
        self.exit(flyer, turn_rad).map(|exit| exit.at_m)
    }

    /// How far its lines may be from the true ones, metres.
    #[inline]
    pub fn inexact_m(flyer: &Flyer) -> f64 {
        if flyer.is_ideal() {
            0.0
        } else {
            INEXACT * flyer.turn_radius_m()
        }
    }

    /// The line on which a turn ends.
    pub fn exit(&self, flyer: &Flyer, turn_rad: f64) -> Option<Exit> {
        let (rate_radps, radius_m) = (flyer.course_rate_radps(), flyer.turn_radius_m());
        let last = &self.last;
        let (begins_s, at_m, from_m, turned) = if turn_rad >= last.turn_rad {
            let beyond_rad = turn_rad - last.turn_rad;
            let (sin, cos) = libm::sincos(beyond_rad);
            // Along the circle, with what rolling out adds turned with it.
            let (cos_in, sin_in) = self.rolled_in;
            let (cos_end, sin_end) = (cos_in * cos - sin_in * sin, sin_in * cos + cos_in * sin);
            let (more_cos, more_sin) = (cos_end - cos_in, sin_end - sin_in);
            let (forward, side) = self.roll_out_m;
            let (cos_full, sin_full) = self.least_full;
            (
                last.time_s + beyond_rad / rate_radps,
                (
                    last.at_m.0 + more_sin * radius_m,
                    last.at_m.1 - more_cos * radius_m,
                ),
                (
                    last.from_m.0 + more_sin * (radius_m - side) + more_cos * forward,
                    last.from_m.1 - more_cos * (radius_m - side) + more_sin * forward,
                ),
                (
                    cos_full * cos - sin_full * sin,
                    sin_full * cos + cos_full * sin,
                ),
            )
        } else {
            let next = self.first_end(flyer, (|end| end.turn_rad, turn_rad), |turn_rad| {
                self.placed_turn_rad(turn_rad)
            })?;
            let after = self.end(flyer, next)?;
            let before = self.end(flyer, next.saturating_sub(1))?;
            let span = (after.turn_rad - before.turn_rad).max(f64::MIN_POSITIVE);
            let share = ((turn_rad - before.turn_rad) / span).max(0.0);
            // The parabola through a third one beside them.
            let third = self
                .end(flyer, next + 1)
                .or_else(|| self.end(flyer, next.checked_sub(2)?));
            let is_apart = |third: &End| {
                let apart_rad = |end: &End| (third.turn_rad - end.turn_rad).abs();
                span.min(apart_rad(&before)).min(apart_rad(&after)) > APART_RAD
            };
            let (third, at, bent) = third.filter(is_apart).map_or((after, 1.0, 0.0), |third| {
                let at = (third.turn_rad - before.turn_rad) / span;
                (third, at, share * (share - 1.0) / (at * (at - 1.0)))
            });
            let between = |of: fn(&End) -> f64| {
                let (from, to) = (of(&before), of(&after));
                from + share * (to - from) + bent * (of(&third) - from - at * (to - from))
            };
            let (sin, cos) = libm::sincos(turn_rad);
            (
                between(|end| end.time_s),
                (between(|end| end.at_m.0), between(|end| end.at_m.1)),
                (between(|end| end.from_m.0), between(|end| end.from_m.1)),
                (cos, sin),
            )
        };
        Some(Exit {
            begins_s,
            over_s: begins_s + ROLLS_OUT * flyer.bank_time_constant_s(),
            at_m,
            from_m,
            turned,
            path_m: rate_radps * radius_m * begins_s,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maneuver::Maneuver;
    use crate::prediction::FlightPath;
    use crate::vehicle::Vehicle;

    fn bend(flyer: &Flyer, bank_rad: f64) -> Bend {
        let mut bend = Bend::NONE;
        bend.set(flyer, bank_rad);
        bend
    }

    #[test]
    fn a_roll_in_with_more_ends_than_there_is_room_for_is_nearly_over() {
        for (turn_radius_m, airspeed_mps, lag_s) in
            [(22.0, 15.2, 1.0), (22.0, 15.0, 1.5), (40.0, 20.0, 2.0)]
        {
            let vehicle = Vehicle {
                airspeed_mps,
                turn_radius_m,
                ..Vehicle::lagged(lag_s)
            };
            let flyer = Flyer::new(&vehicle);
            let bend = bend(&flyer, 0.0);
            let last = bend.last;
            let exit = bend.exit(&flyer, last.turn_rad + 1.0).unwrap();
            assert!(flyer.full_bank_rad() - last.bank_rad < 1e-5, "{last:?}");
            assert!(exit.begins_s > last.time_s);
        }
    }

    #[test]
    fn a_turn_shorter_than_the_least_one_ends_where_that_does() {
        for bank in [0.0, 0.3, 0.99, 1.0] {
            let flyer = Flyer::new(&Vehicle::lagged(0.6));
            let bend = bend(&flyer, bank * flyer.full_bank_rad());
            let (least, less) = (bend.least_rad(), bend.least_rad() - 0.1);
            let at = |turn_rad: f64| bend.exit(&flyer, turn_rad).unwrap().from_m;
            assert_eq!(at(less), at(least), "{bank}");
        }
    }

    #[test]
    fn a_turn_ends_on_the_line_that_was_told() {
        for (lag_s, speed_mps, radius_m) in [
            (0.0, 15.0, 30.0),
            (0.25, 12.0, 20.0),
            (0.6, 15.0, 30.0),
            (1.0, 22.0, 60.0),
            (1.2, 50.0, 400.0),
        ] {
            let vehicle = Vehicle {
                airspeed_mps: speed_mps,
                turn_radius_m: radius_m,
                ..Vehicle::lagged(lag_s)
            };
            let flyer = Flyer::new(&vehicle);
            let full_rad = if lag_s > 0.0 {
                flyer.bank_rad(flyer.course_rate_radps())
            } else {
                0.0
            };
            for share in [0.0, 0.4, -0.6, 1.0, 1.4, -1.4] {
                let bank_rad = share * full_rad;
                let bend = bend(&flyer, bank_rad);
                for k in 0..40 {
                    let turn_rad = bend.least_rad() + 0.1 * f64::from(k);
                    let exit = bend.exit(&flyer, turn_rad).unwrap();
                    let start = MotionState::ahead(bank_rad);
                    let mut path = FlightPath::new();
                    path.predict(&flyer, &start, &Maneuver::turn(0.0, turn_rad, 0.0), 200.0);
                    for after_s in [0.0, 2.0, 30.0] {
                        let at_s = exit.over_s + after_s;
                        let there = path.state_at(&flyer, at_s).unwrap();
                        let straight_m = speed_mps * (at_s - exit.begins_s);
                        let told = Vec3::new(
                            exit.from_m.0 + straight_m * exit.turned.0,
                            exit.from_m.1 + straight_m * exit.turned.1,
                            0.0,
                        );
                        let off_m = (told - there.position_m).length();
                        let most_m = Bend::inexact_m(&flyer) + 1e-6;
                        assert!(
                            off_m <= most_m,
                            "lag {lag_s}, bank {bank_rad}, turn {turn_rad}: {off_m} of {most_m}"
                        );
                    }
                }
            }
        }
    }
}
