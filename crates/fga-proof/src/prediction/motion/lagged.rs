//! Flight with a bank that follows its command: the pieces of rolls, and where a roll-out begins.

use core::f64::consts::FRAC_PI_2;

use crate::limit::{Limit as _, root};
use crate::prediction::motion::{Flyer, MotionState, Piece, REACHED_RAD};
use crate::prediction::roll::{Roll, roll_out};

/// The roll-out begins when the remaining turn beyond the roll-out's is at most this, radians.
const ROLL_OUT_BEGINS_RAD: f64 = 1e-7;

/// A remaining turn with the wings level takes this share of the time constant.
const LEVEL_TURN: f64 = 0.1;

/// Sideways distance of a roll to 45° at which its pieces have their usual length, metres.
const USUAL_SCALE_M: f64 = 1.5;

/// Pieces may err by at least this share of the usual, so that slow rolls have few.
const LEAST_PACE: f64 = 0.0024;

impl Flyer {
    /// Computes what all rolls share.
    pub(super) fn prepare_rolls(&mut self) {
        let full_rad = self.bank_rad(self.course_rate_radps);
        self.full_roll_out_rad = self.rollout_rad(full_rad);
        self.full_bank_rad = full_rad;
        let time = self.bank_time_constant_s;
        let scale_m = self.airspeed_mps * self.gain_radps * time * time;
        self.pace = (USUAL_SCALE_M / scale_m).limited(LEAST_PACE, 1.0);
    }

    pub(super) fn lagged_piece(
        &self,
        state: &MotionState,
        turn_left: f64,
        rate_share: f64,
        (climb_rate, climb_s): (f64, f64),
        limit_s: f64,
    ) -> Piece {
        let tau = self.bank_time_constant_s;
        let most = climb_s.min(limit_s) / tau;
        let limit = self.course_rate_radps * rate_share;
        let full = if rate_share == 1.0 {
            self.full_bank_rad
        } else {
            self.bank_rad(limit)
        };
        let beyond = self.beyond(turn_left, state.bank_rad);
        let is_turn = full > 0.0;
        let mut piece = if is_turn && beyond.abs() > ROLL_OUT_BEGINS_RAD {
            let command = libm::copysign(full, beyond);
            if state.bank_rad == command {
                let rate = libm::copysign(limit, beyond);
                let turn_s = (turn_left - self.rollout_rad(command)) / rate;
                Piece::steady(climb_s.min(turn_s), rate, climb_rate, command)
            } else {
                let roll = Roll::new(state.bank_rad, command, most, self.pace);
                let left = self.beyond(self.left_after(&roll, turn_left), roll.to_rad);
                let roll = if left * beyond > 0.0 {
                    roll
                } else {
                    self.roll_to_roll_out(&roll, turn_left, left)
                };
                self.piece_of(&roll, climb_rate)
            }
        } else if state.bank_rad != 0.0 {
            let mut roll = Roll::new(state.bank_rad, 0.0, most, self.pace);
            let ends_turn = is_turn && roll.to_rad == 0.0;
            if ends_turn {
                // Errors and rounding leave a rest: it ends on its course.
                roll.turn_to(turn_left / (self.gain_radps * tau));
            }
            Piece {
                ends_turn,
                ..self.piece_of(&roll, climb_rate)
            }
        } else if turn_left.abs() < REACHED_RAD || !is_turn {
            Piece::steady(climb_s, 0.0, climb_rate, 0.0)
        } else {
            let step_s = LEVEL_TURN * tau;
            Piece {
                course_error_rad: turn_left.abs(),
                ends_turn: true,
                ..Piece::steady(climb_s.min(step_s), turn_left / step_s, climb_rate, 0.0)
            }
        };
        if is_turn {
            piece.beyond_rad = beyond.abs();
        }
        piece
    }

    /// The bank of the largest course rate, radians.
    pub const fn full_bank_rad(&self) -> f64 {
        self.full_bank_rad
    }

    /// The remaining turn after a piece of a roll, radians.
    fn left_after(&self, roll: &Roll, turn_left: f64) -> f64 {
        turn_left - self.gain_radps * self.bank_time_constant_s * roll.turn
    }

    /// The remaining turn beyond the roll-out's, radians; the whole remaining turn, which has the same sign, where no
    /// roll-out makes it.
    fn beyond(&self, turn_left: f64, bank_rad: f64) -> f64 {
        let is_more = turn_left.abs() > self.full_roll_out_rad + ROLL_OUT_BEGINS_RAD;
        if is_more && bank_rad.abs() <= self.full_bank_rad {
            turn_left
        } else {
            turn_left - self.rollout_rad(bank_rad)
        }
    }

    /// The part of a piece of a roll after which the roll-out begins: the zero of the remaining turn beyond the
    /// roll-out's, which is `at_end` at its end.
    fn roll_to_roll_out(&self, roll: &Roll, turn_left: f64, at_end: f64) -> Roll {
        let part = |lasts: f64| Roll::part(roll.from_rad, roll.command_rad, lasts);
        let beyond = |part: &Roll| self.left_after(part, turn_left) - self.rollout_rad(part.to_rad);
        let begins = (0.0, turn_left - self.rollout_rad(roll.from_rad));
        let near_rad = 0.1 * ROLL_OUT_BEGINS_RAD;
        part(root(
            |lasts| beyond(&part(lasts)),
            [begins, (roll.lasts, at_end)],
            near_rad,
        ))
    }

    /// The bank between two states of one piece, radians: what is left of a decay is the same share in equal times.
    pub(crate) fn bank_between_rad(
        &self,
        from: &MotionState,
        to: &MotionState,
        since_s: f64,
    ) -> f64 {
        let moved_rad = to.bank_rad - from.bank_rad;
        if moved_rad == 0.0 {
            return from.bank_rad;
        }
        let done = |after_s: f64| -libm::expm1(-after_s / self.bank_time_constant_s);
        let span_s = to.time_s - from.time_s;
        let share = if since_s >= span_s {
            1.0
        } else {
            done(since_s) / done(span_s)
        };
        from.bank_rad + moved_rad * share
    }

    fn piece_of(&self, roll: &Roll, climb_rate_radps: f64) -> Piece {
        let tau = self.bank_time_constant_s;
        let turn = self.gain_radps * tau;
        let duration_s = roll.lasts * tau;
        let scale_m = self.airspeed_mps * duration_s;
        let steepest = roll.fastest * roll.lasts;
        let turns_rad = turn * steepest + (climb_rate_radps * duration_s).abs();
        // From the roll to this course rate (proof.md §4).
        let (bow_rad, wave_rad) = (turn * roll.bow / roll.lasts, turn * roll.wave);
        let shape_m = scale_m * (bow_rad * (1.0 + turns_rad) + 0.5 * wave_rad * wave_rad);
        // What its displacement does not count (proof.md §5).
        let end_growth = roll.growth + roll.curve * roll.lasts;
        let square = turn * roll.lasts * roll.lasts;
        let a = square * roll.growth.abs().max(end_growth.abs());
        let b = square * roll.lasts * roll.curve.abs();
        let (k, third) = (turns_rad, a + b / 6.0);
        let uncounted = k * k * (k * (k * a / 4.0 + b / 3.0) + a * a)
            + b * (k * a * 4.0 / 3.0 + b / 4.0)
            + 2.0 * third * third * third;
        Piece {
            duration_s,
            course_rate_radps: self.gain_radps * roll.rate,
            course_growth_radps2: self.gain_radps * roll.growth / tau,
            course_curve_radps3: self.gain_radps * roll.curve / (tau * tau),
            climb_rate_radps,
            bank_command_rad: roll.command_rad,
            bank_end_rad: roll.to_rad,
            fastest_radps: self.gain_radps * roll.fastest,
            // At a node, and from it to a place between nodes.
            remainder_m: shape_m + 2.0 * scale_m * uncounted / 13_440.0,
            course_error_rad: turn * roll.turn_error,
            bank_error_rad: roll.left_rad,
            beyond_rad: 0.0,
            ends_turn: false,
        }
    }

    /// Change of course while the bank decays to level, radians.
    #[inline]
    pub fn rollout_rad(&self, bank_rad: f64) -> f64 {
        if bank_rad.abs() == self.full_bank_rad {
            return libm::copysign(self.full_roll_out_rad, bank_rad);
        }
        let bank_rad = bank_rad.limited(-FRAC_PI_2 + 0.01, FRAC_PI_2 - 0.01);
        self.gain_radps * self.bank_time_constant_s * roll_out(bank_rad)
    }
}
