//! The motion of the vehicle under one command: Eq. 10–12 with its limits and its response.
//!
//! Without lag the motion is exact: course ψ and climb angle θ move linearly in time to their
//! targets, and cos θ cos ψ = ½ [cos(ψ+θ) + cos(ψ−θ)] makes Eq. 10–12 integrals of cosines of
//! linear functions. With a bank lag the bank follows its command exponentially: the command is the
//! bank of the largest course rate until the remaining turn equals the turn made while rolling out to level,
//! then level. A roll is a few pieces of linear course rate, with an exact course at their ends.

use core::f64::consts::FRAC_PI_2;

use crate::Vec3;
use crate::angle::direction;
use crate::limit::Limit as _;
use crate::meter::{LAGGED_PIECE, PIECE};
use crate::prediction::roll::{Roll, roll_out};
use crate::situation::Ownship;
use crate::vehicle::{STANDARD_GRAVITY_MPS2, Vehicle};

/// An angle closer to its target than this has reached it, radians.
const REACHED_RAD: f64 = 1e-11;

/// A smaller bank counts as wings level for callers, radians.
const LEVEL_BANK_RAD: f64 = 1e-3;

/// A smaller bank has no roll-out left, radians.
const ROLLED_OUT_RAD: f64 = 1e-9;

/// The roll-out begins when the remaining turn beyond the roll-out's is at most this, radians.
const ROLL_OUT_BEGINS_RAD: f64 = 1e-7;

/// Iterations for the start of the roll-out.
const STEPS_TO_ROLL_OUT: u32 = 12;

/// A remaining turn with the wings level takes this share of the time constant.
const LEVEL_TURN: f64 = 0.1;

/// Sideways distance of a roll to 45° at which its pieces have their usual length, metres.
const USUAL_SCALE_M: f64 = 1.5;

/// Most pieces of a roll that a [`Flyer`] keeps.
const KEPT_ROLLS: usize = 16;

/// The aircraft at a moment of a predicted flight, in the air mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionState {
    /// Time from the decision, seconds.
    pub time_s: f64,
    /// Position, metres.
    pub position_m: Vec3,
    /// Course ψ, radians, not wrapped.
    pub course_rad: f64,
    /// Climb angle θ, radians.
    pub climb_rad: f64,
    /// Bank angle φ, radians, positive in a left turn; followed only for vehicles with bank lag.
    pub bank_rad: f64,
}

impl MotionState {
    /// The aircraft at the moment of the decision.
    pub const fn of(ownship: &Ownship) -> Self {
        Self {
            time_s: 0.0,
            position_m: ownship.position_m,
            course_rad: ownship.course_rad,
            climb_rad: ownship.climb_rad,
            bank_rad: ownship.bank_rad,
        }
    }
}

/// A command: see [`Stage`](crate::maneuver::Stage) for the meaning of the fields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Course to turn to, radians, not wrapped.
    pub course_rad: f64,
    /// Climb angle to take up, radians.
    pub climb_rad: f64,
    /// Share of the largest course rate.
    pub rate_share: f64,
}

/// One piece of flight: a constant climb rate, and a course rate that is linear in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Duration, seconds; infinite for straight flight.
    pub duration_s: f64,
    /// Course rate at its beginning, radians per second, positive to the left.
    pub course_rate_radps: f64,
    /// Slope of the course rate, radians per second squared; 0 unless the bank changes.
    pub course_growth_radps2: f64,
    /// Rate of the climb angle, radians per second.
    pub climb_rate_radps: f64,
    /// Bank that the aircraft rolls to, radians.
    pub bank_command_rad: f64,
    /// Bank at the end of the piece, radians.
    pub bank_end_rad: f64,
    /// Bound of the course rate within it, radians per second.
    pub fastest_radps: f64,
    /// Bound of the distance from the flight with a linear course rate, metres.
    pub remainder_m: f64,
}

impl Piece {
    /// At constant rates, without a roll.
    const fn steady(
        duration_s: f64,
        course_rate_radps: f64,
        climb_rate_radps: f64,
        bank_rad: f64,
    ) -> Self {
        Self {
            duration_s,
            course_rate_radps,
            course_growth_radps2: 0.0,
            climb_rate_radps,
            bank_command_rad: bank_rad,
            bank_end_rad: bank_rad,
            fastest_radps: course_rate_radps,
            remainder_m: 0.0,
        }
    }

    /// Change of course after a time, radians.
    pub(crate) fn turn_rad(&self, after_s: f64) -> f64 {
        (self.course_rate_radps + 0.5 * self.course_growth_radps2 * after_s) * after_s
    }
}

/// The pieces of a common roll.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rolls {
    rolls: [Roll; KEPT_ROLLS],
    len: usize,
}

impl Rolls {
    const NONE: Self = Self {
        rolls: [Roll::NONE; KEPT_ROLLS],
        len: 0,
    };

    fn new(from_rad: f64, to_rad: f64, pace: f64) -> Self {
        let mut kept = Self::NONE;
        let mut bank_rad = from_rad;
        for slot in &mut kept.rolls {
            if bank_rad == to_rad {
                break;
            }
            *slot = Roll::new(bank_rad, to_rad, f64::INFINITY, pace);
            bank_rad = slot.to_rad;
            kept.len += 1;
        }
        kept
    }

    fn begin_at(&self, bank_rad: f64) -> bool {
        self.len > 0
            && self
                .rolls
                .first()
                .is_some_and(|roll| roll.from_rad == bank_rad)
    }

    fn from(&self, bank_rad: f64) -> Option<&Roll> {
        self.rolls
            .iter()
            .take(self.len)
            .find(|roll| roll.from_rad == bank_rad)
    }
}

/// Banks with a tabulated roll-out, from level to the largest.
const SETTLES: usize = 33;

/// A roll-out is over after this many time constants: thousandths of the bank are left.
const SETTLED_AFTER: f64 = 6.0;

/// Most pieces of a roll-out.
const MOST_PIECES: usize = 64;

/// The vehicle's motion under commands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flyer {
    airspeed_mps: f64,
    course_rate_radps: f64,
    climb_rate_radps: f64,
    climb_min_rad: f64,
    climb_max_rad: f64,
    bank_time_constant_s: f64,
    turn_rate_factor: f64,
    /// Course rate at a bank of 45°, radians per second.
    gain_radps: f64,
    /// Bank of the largest course rate, radians, and the turn made while rolling out from it.
    full_bank_rad: f64,
    full_roll_out_rad: f64,
    /// Stretches the pieces of a roll.
    pace: f64,
    rolling_in: Rolls,
    rolling_out: Rolls,
    /// Rolls from the bank of now: to level, and to the largest to the left and to the right.
    rolling_now: [Rolls; 3],
    /// Displacement of a roll-out from a bank, beyond straight flight on its final course: forward and left of
    /// the course at its start, metres.
    settles_m: [(f64, f64); SETTLES],
}

impl Flyer {
    /// The motion of a vehicle at its airspeed.
    pub fn new(vehicle: &Vehicle) -> Self {
        let response = vehicle.response;
        let mut flyer = Self {
            airspeed_mps: vehicle.airspeed_mps,
            course_rate_radps: vehicle.course_rate_radps(),
            climb_rate_radps: vehicle.climb_rate_radps,
            climb_min_rad: vehicle.climb_min_rad,
            climb_max_rad: vehicle.climb_max_rad,
            bank_time_constant_s: response.bank_time_constant_s,
            turn_rate_factor: response.turn_rate_factor,
            gain_radps: response.turn_rate_factor * STANDARD_GRAVITY_MPS2 / vehicle.airspeed_mps,
            full_bank_rad: 0.0,
            full_roll_out_rad: 0.0,
            pace: 1.0,
            rolling_in: Rolls::NONE,
            rolling_out: Rolls::NONE,
            rolling_now: [Rolls::NONE; 3],
            settles_m: [(0.0, 0.0); SETTLES],
        };
        if !flyer.is_ideal() {
            let full_rad = flyer.bank_rad(flyer.course_rate_radps);
            flyer.full_roll_out_rad = flyer.rollout_rad(full_rad);
            flyer.full_bank_rad = full_rad;
            // The error of a piece grows as the fifth power of its length.
            let time = flyer.bank_time_constant_s;
            let scale_m = flyer.airspeed_mps * flyer.gain_radps * time * time;
            flyer.pace = libm::pow(USUAL_SCALE_M / scale_m, 0.2).limited(0.3, 1.0);
            flyer.rolling_in = Rolls::new(0.0, full_rad, flyer.pace);
            flyer.rolling_out = Rolls::new(full_rad, 0.0, flyer.pace);
            let step_rad = full_rad / (SETTLES - 1) as f64;
            let mut settles_m = [(0.0, 0.0); SETTLES];
            for (place, settles) in settles_m.iter_mut().enumerate() {
                *settles = flyer.settles_m(place as f64 * step_rad);
            }
            flyer.settles_m = settles_m;
        }
        flyer
    }

    /// Displacement of a roll-out from a bank, as in the table, from its pieces.
    fn settles_m(&self, bank_rad: f64) -> (f64, f64) {
        let mut state = MotionState {
            time_s: 0.0,
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad,
        };
        let target = Target {
            course_rad: self.rollout_rad(bank_rad),
            climb_rad: 0.0,
            rate_share: 1.0,
        };
        for _ in 0..MOST_PIECES {
            let piece = self.next_piece(&state, &target);
            if piece.duration_s == f64::INFINITY {
                break;
            }
            state = self.advance(&state, &piece, piece.duration_s);
        }
        let straight_m = direction(target.course_rad, 0.0) * self.airspeed_mps * state.time_s;
        let settles = state.position_m - straight_m;
        (settles.x, settles.y)
    }

    /// Displacement of a roll-out from a bank, beyond straight flight on its final course: forward and left of the
    /// course at its start, metres, to decimetres. `None` for banks beyond its largest.
    pub(crate) fn roll_out_m(&self, bank_rad: f64) -> Option<(f64, f64)> {
        let place = bank_rad.abs() / self.full_bank_rad * (SETTLES - 1) as f64;
        if self.is_ideal() || place.is_nan() || place > (SETTLES - 1) as f64 {
            return None;
        }
        let above = super::whole(place, SETTLES - 1);
        let below = above - 1;
        let (low, high) = (self.settles_m.get(below)?, self.settles_m.get(above)?);
        let share = place - below as f64;
        let left = low.1 + share * (high.1 - low.1);
        Some((
            low.0 + share * (high.0 - low.0),
            libm::copysign(1.0, bank_rad) * left,
        ))
    }

    /// Time constant of the bank, seconds.
    pub(crate) const fn bank_time_constant_s(&self) -> f64 {
        self.bank_time_constant_s
    }

    /// The approximate state after rolling out from a state and taking up a climb angle: to decimetres, only
    /// for skipping. `None` for banks beyond its largest.
    pub(crate) fn settled(&self, state: &MotionState, climb_rad: f64) -> Option<MotionState> {
        let (forward, left) = self.roll_out_m(state.bank_rad)?;
        let change_rad = climb_rad - state.climb_rad;
        let climbs_s = if change_rad.abs() < REACHED_RAD {
            0.0
        } else {
            change_rad.abs() / self.climb_rate_radps
        };
        let after_s = climbs_s.max(SETTLED_AFTER * self.bank_time_constant_s);
        // The means of cos θ and sin θ while θ changes.
        let (sin, cos) = libm::sincos(climb_rad);
        let (mean_cos, mean_sin) = if climbs_s > 0.0 {
            let (sin_now, cos_now) = libm::sincos(state.climb_rad);
            ((sin - sin_now) / change_rad, (cos_now - cos) / change_rad)
        } else {
            (cos, sin)
        };
        let level_s = mean_cos * climbs_s + cos * (after_s - climbs_s);
        let up_s = mean_sin * climbs_s + sin * (after_s - climbs_s);
        let course_rad = state.course_rad + self.rollout_rad(state.bank_rad);
        let (across, along) = libm::sincos(course_rad);
        let (side, ahead) = libm::sincos(state.course_rad);
        let aside = Vec3::new(
            ahead * forward - side * left,
            side * forward + ahead * left,
            0.0,
        );
        let straight = Vec3::new(along * level_s, across * level_s, up_s);
        Some(MotionState {
            time_s: state.time_s + after_s,
            position_m: state.position_m + aside * mean_cos + straight * self.airspeed_mps,
            course_rad,
            climb_rad,
            bank_rad: 0.0,
        })
    }

    /// Total airspeed, metres per second.
    pub const fn airspeed_mps(&self) -> f64 {
        self.airspeed_mps
    }

    /// Largest course rate, radians per second.
    pub const fn course_rate_radps(&self) -> f64 {
        self.course_rate_radps
    }

    /// Rate of the climb angle, radians per second.
    pub const fn climb_rate_radps(&self) -> f64 {
        self.climb_rate_radps
    }

    /// Whether the bank follows its command at once.
    pub fn is_ideal(&self) -> bool {
        self.bank_time_constant_s <= 0.0
    }

    /// What a piece of a predicted flight takes, in units of work.
    pub(crate) fn piece_work(&self) -> usize {
        if self.is_ideal() { PIECE } else { LAGGED_PIECE }
    }

    /// Whether the wings are level.
    pub fn is_level_at(&self, state: &MotionState) -> bool {
        self.is_ideal() || state.bank_rad.abs() < LEVEL_BANK_RAD
    }

    /// Velocity at a state, metres per second (Eq. 10–12).
    pub fn velocity_mps(&self, state: &MotionState) -> Vec3 {
        direction(state.course_rad, state.climb_rad) * self.airspeed_mps
    }

    /// The piece that comes next under a command.
    ///
    /// It ends where a target is reached, or after a part of a roll; it is infinite once both targets
    /// are met.
    pub fn next_piece(&self, state: &MotionState, target: &Target) -> Piece {
        self.next_piece_within(state, target, f64::INFINITY)
    }

    /// The same, with a new command after `limit_s` seconds: a piece with a changing bank ends there, with the
    /// rate and the bank of that moment.
    pub(crate) fn next_piece_within(
        &self,
        state: &MotionState,
        target: &Target,
        limit_s: f64,
    ) -> Piece {
        let climb_target = target
            .climb_rad
            .limited(self.climb_min_rad, self.climb_max_rad);
        let climb_left = climb_target - state.climb_rad;
        let (climb_rate, climb_s) =
            if climb_left.abs() < REACHED_RAD || self.climb_rate_radps <= 0.0 {
                (0.0, f64::INFINITY)
            } else {
                let rate = libm::copysign(self.climb_rate_radps, climb_left);
                (rate, climb_left / rate)
            };
        let turn_left = target.course_rad - state.course_rad;
        if self.is_ideal() {
            let limit = self.course_rate_radps * target.rate_share;
            let (rate, turn_s) = if turn_left.abs() < REACHED_RAD || limit <= 0.0 {
                (0.0, f64::INFINITY)
            } else {
                let rate = libm::copysign(limit, turn_left);
                (rate, turn_left / rate)
            };
            return Piece::steady(climb_s.min(turn_s), rate, climb_rate, 0.0);
        }
        let climb = (climb_rate, climb_s);
        self.lagged_piece(state, turn_left, target.rate_share, climb, limit_s)
    }

    fn lagged_piece(
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
        let beyond = turn_left - self.rollout_rad(state.bank_rad);
        if full > 0.0 && beyond.abs() > ROLL_OUT_BEGINS_RAD {
            let command = libm::copysign(full, beyond);
            if state.bank_rad == command {
                let rate = libm::copysign(limit, beyond);
                return Piece::steady(climb_s.min(beyond / rate), rate, climb_rate, command);
            }
            let roll = self.roll(state.bank_rad, command, most);
            let left = self.beyond_after(&roll, turn_left);
            let roll = if left * beyond > 0.0 {
                roll
            } else {
                self.roll_to_roll_out(&roll, turn_left, (beyond, left))
            };
            return self.piece_of(&roll, climb_rate);
        }
        if state.bank_rad.abs() > ROLLED_OUT_RAD {
            let mut roll = self.roll(state.bank_rad, 0.0, most);
            if roll.to_rad == 0.0 && full > 0.0 {
                // Rounding leaves a rest: it ends on its course.
                let turn = turn_left / (self.gain_radps * tau);
                roll.rate += (turn - roll.turn) / roll.lasts;
            }
            return self.piece_of(&roll, climb_rate);
        }
        if turn_left.abs() < REACHED_RAD || full <= 0.0 {
            return Piece::steady(climb_s, 0.0, climb_rate, 0.0);
        }
        let step_s = LEVEL_TURN * tau;
        Piece::steady(climb_s.min(step_s), turn_left / step_s, climb_rate, 0.0)
    }

    /// Keeps the rolls from a bank at which many predictions are about to begin.
    pub(crate) fn keep_rolls_from(&mut self, bank_rad: f64) {
        let is_kept = self.is_ideal()
            || bank_rad == 0.0
            || self
                .rolling_now
                .iter()
                .any(|rolls| rolls.begin_at(bank_rad));
        if !is_kept {
            let full_rad = self.full_bank_rad;
            self.rolling_now =
                [0.0, full_rad, -full_rad].map(|to_rad| Rolls::new(bank_rad, to_rad, self.pace));
        }
    }

    /// The next piece of a roll, at most `most` time constants long.
    fn roll(&self, from_rad: f64, command_rad: f64, most: f64) -> Roll {
        let (kept, side) = if command_rad == 0.0 {
            (&self.rolling_out, from_rad)
        } else {
            (&self.rolling_in, command_rad)
        };
        let sign = libm::copysign(1.0, side);
        let is_kept = command_rad == 0.0 || command_rad.abs() == self.full_bank_rad;
        match kept.from(sign * from_rad) {
            Some(roll) if is_kept && roll.lasts <= most => Roll {
                from_rad,
                command_rad,
                turn: sign * roll.turn,
                rate: sign * roll.rate,
                growth: sign * roll.growth,
                to_rad: sign * roll.to_rad,
                ..*roll
            },
            _ => {
                let mut now = self.rolling_now.iter();
                now.find_map(|rolls| {
                    rolls
                        .from(from_rad)
                        .filter(|r| r.command_rad == command_rad)
                })
                .filter(|roll| roll.lasts <= most)
                .copied()
                .unwrap_or_else(|| Roll::new(from_rad, command_rad, most, self.pace))
            }
        }
    }

    /// The remaining turn after a piece of a roll, beyond the roll-out's, radians.
    fn beyond_after(&self, roll: &Roll, turn_left: f64) -> f64 {
        let turned = self.gain_radps * self.bank_time_constant_s * roll.turn;
        turn_left - turned - self.rollout_rad(roll.to_rad)
    }

    /// The part of a piece of a roll after which the roll-out begins: the zero of the remaining turn beyond the
    /// roll-out's, known at both ends.
    ///
    /// It falls at the rate c tan(φ)/φ, where c is the bank commanded: Newton's steps, kept between the ends.
    fn roll_to_roll_out(&self, roll: &Roll, turn_left: f64, ends: (f64, f64)) -> Roll {
        let ((mut a, at_a), (mut b, at_b)) = ((0.0, ends.0), (roll.lasts, ends.1));
        let gain = self.gain_radps * self.bank_time_constant_s;
        let mut at = b - at_b * (b - a) / (at_b - at_a);
        let mut part = *roll;
        for _ in 0..STEPS_TO_ROLL_OUT {
            part = Roll::part(roll.from_rad, roll.command_rad, at);
            let left = self.beyond_after(&part, turn_left);
            if left.abs() < 0.01 * ROLL_OUT_BEGINS_RAD {
                break;
            }
            if left * at_b < 0.0 {
                a = at;
            } else {
                b = at;
            }
            let bank = part.to_rad;
            let share = if bank == 0.0 {
                1.0
            } else {
                libm::tan(bank) / bank
            };
            let next = at + left / (gain * part.command_rad * share);
            at = if next > a && next < b {
                next
            } else {
                0.5 * (a + b)
            };
        }
        part
    }

    fn piece_of(&self, roll: &Roll, climb_rate_radps: f64) -> Piece {
        let tau = self.bank_time_constant_s;
        Piece {
            duration_s: roll.lasts * tau,
            course_rate_radps: self.gain_radps * roll.rate,
            course_growth_radps2: self.gain_radps * roll.growth / tau,
            climb_rate_radps,
            bank_command_rad: roll.command_rad,
            bank_end_rad: roll.to_rad,
            fastest_radps: self.gain_radps * roll.fastest,
            remainder_m: self.airspeed_mps * self.gain_radps * tau * tau * roll.bow,
        }
    }

    /// Change of course while the bank decays to level, radians.
    pub fn rollout_rad(&self, bank_rad: f64) -> f64 {
        if bank_rad.abs() == self.full_bank_rad {
            return libm::copysign(self.full_roll_out_rad, bank_rad);
        }
        let bank_rad = bank_rad.limited(-FRAC_PI_2 + 0.01, FRAC_PI_2 - 0.01);
        self.gain_radps * self.bank_time_constant_s * roll_out(bank_rad)
    }

    /// Course rate at a bank, radians per second (Eq. 9 with the turn-rate factor).
    pub fn rate_radps(&self, bank_rad: f64) -> f64 {
        let bank_rad = bank_rad.limited(-FRAC_PI_2 + 0.01, FRAC_PI_2 - 0.01);
        self.turn_rate_factor * STANDARD_GRAVITY_MPS2 * libm::tan(bank_rad) / self.airspeed_mps
    }

    /// Bank that gives a course rate, radians: the inverse of [`Self::rate_radps`].
    pub fn bank_rad(&self, rate_radps: f64) -> f64 {
        let ideal = rate_radps / self.turn_rate_factor;
        libm::atan(ideal * self.airspeed_mps / STANDARD_GRAVITY_MPS2)
    }

    /// The state `after_s` seconds into a piece, `after_s` at most its duration.
    pub fn advance(&self, state: &MotionState, piece: &Piece, after_s: f64) -> MotionState {
        MotionState {
            time_s: state.time_s + after_s,
            position_m: state.position_m + self.moved_m(state, piece, after_s),
            course_rad: state.course_rad + piece.turn_rad(after_s),
            climb_rad: state.climb_rad + piece.climb_rate_radps * after_s,
            bank_rad: if after_s >= piece.duration_s {
                piece.bank_end_rad
            } else if self.is_ideal() || state.bank_rad == piece.bank_command_rad {
                state.bank_rad
            } else {
                let off_rad = state.bank_rad - piece.bank_command_rad;
                piece.bank_command_rad + off_rad * libm::exp(-after_s / self.bank_time_constant_s)
            },
        }
    }

    /// Displacement `after_s` seconds into a piece, metres.
    ///
    /// With a course rate linear in time the course follows its mean rate plus a parabola
    /// e(t) = a t (t − T) / 2; this counts its first two orders.
    fn moved_m(&self, state: &MotionState, piece: &Piece, after_s: f64) -> Vec3 {
        let growth = piece.course_growth_radps2;
        let mean_radps = piece.course_rate_radps + 0.5 * growth * after_s;
        let climb_radps = piece.climb_rate_radps;
        let (course_rad, climb_rad) = (state.course_rad, state.climb_rad);
        let rates_radps = (mean_radps, climb_radps);
        let (chord_m, course, climb) = self.chord(course_rad, climb_rad, rates_radps, after_s);
        if growth == 0.0 {
            return chord_m;
        }
        let turn_rad = mean_radps * after_s;
        let square = after_s * after_s;
        let speed_mps = self.airspeed_mps * climb.0;
        let left_m =
            -speed_mps * growth * square * after_s / 12.0 * (1.0 - turn_rad * turn_rad / 40.0);
        let behind_m = speed_mps * growth * growth * square * square * after_s / 240.0;
        let (cos, sin) = course;
        chord_m
            + Vec3::new(
                -left_m * sin - behind_m * cos,
                left_m * cos - behind_m * sin,
                0.0,
            )
    }

    /// Displacement over `after_s` seconds at constant rates, metres: Eq. 10–12 integrated exactly.
    pub fn displacement_m(
        &self,
        course_rad: f64,
        climb_rad: f64,
        course_rate_radps: f64,
        climb_rate_radps: f64,
        after_s: f64,
    ) -> Vec3 {
        let rates_radps = (course_rate_radps, climb_rate_radps);
        self.chord(course_rad, climb_rad, rates_radps, after_s).0
    }

    /// The same, with course and climb angle halfway as unit complex numbers.
    fn chord(
        &self,
        course_rad: f64,
        climb_rad: f64,
        (course_rate_radps, climb_rate_radps): (f64, f64),
        after_s: f64,
    ) -> (Vec3, Complex, Complex) {
        let half_course = 0.5 * course_rate_radps * after_s;
        let half_climb = 0.5 * climb_rate_radps * after_s;
        let scale = self.airspeed_mps * after_s;
        let course = unit(course_rad + half_course);
        let climb = unit(climb_rad + half_climb);
        let course_half = unit(half_course);
        if climb_rate_radps == 0.0 {
            let chord = scale * sinc(half_course, course_half);
            let moved_m = Vec3::new(
                chord * climb.0 * course.0,
                chord * climb.0 * course.1,
                scale * climb.1,
            );
            return (moved_m, course, climb);
        }
        let climb_half = unit(half_climb);
        let sum = times(course, climb);
        let difference = times(course, conjugate(climb));
        let sum_chord = 0.5 * sinc(half_course + half_climb, times(course_half, climb_half));
        let difference_chord = 0.5
            * sinc(
                half_course - half_climb,
                times(course_half, conjugate(climb_half)),
            );
        let moved_m = Vec3::new(
            scale * (sum_chord * sum.0 + difference_chord * difference.0),
            scale * (sum_chord * sum.1 + difference_chord * difference.1),
            scale * sinc(half_climb, climb_half) * climb.1,
        );
        (moved_m, course, climb)
    }

    /// Bound of the acceleration of a piece, metres per second squared: V √(ψ̇² + θ̇²).
    pub fn acceleration_mps2(&self, piece: &Piece) -> f64 {
        let rates = piece.fastest_radps * piece.fastest_radps
            + piece.climb_rate_radps * piece.climb_rate_radps;
        self.airspeed_mps * libm::sqrt(rates)
    }
}

/// Steps of equal length along an arc of constant rates, without a transcendental call a step.
///
/// ψ+θ, ψ−θ and θ are unit complex numbers that turn by a constant angle each step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ArcSteps {
    state: MotionState,
    step_s: f64,
    course_step_rad: f64,
    climb_step_rad: f64,
    airspeed_mps: f64,
    sum: Complex,
    difference: Complex,
    climb: Complex,
    turn: [Complex; 3],
    shift: [Complex; 3],
}

type Complex = (f64, f64);

fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

const fn conjugate(a: Complex) -> Complex {
    (a.0, -a.1)
}

/// e^(i angle); free for level flight.
fn unit(angle_rad: f64) -> Complex {
    if angle_rad == 0.0 {
        return (1.0, 0.0);
    }
    let (sin, cos) = libm::sincos(angle_rad);
    (cos, sin)
}

/// scale · sinc(half) · e^(i half): the mean of a unit complex number that turns by 2 · half, from
/// e^(i half).
fn mean(half_rad: f64, half: Complex, scale: f64) -> Complex {
    let chord = scale * sinc(half_rad, half);
    (chord * half.0, chord * half.1)
}

impl ArcSteps {
    /// Steps of `step_s` seconds along `piece` from `state`.
    pub(crate) fn new(flyer: &Flyer, state: &MotionState, piece: &Piece, step_s: f64) -> Self {
        let half_course = 0.5 * piece.course_rate_radps * step_s;
        let half_climb = 0.5 * piece.climb_rate_radps * step_s;
        let scale = flyer.airspeed_mps * step_s;
        let (course, climb) = (unit(state.course_rad), unit(state.climb_rad));
        let (course_half, climb_half) = (unit(half_course), unit(half_climb));
        let sum_half = times(course_half, climb_half);
        let difference_half = times(course_half, conjugate(climb_half));
        Self {
            state: *state,
            step_s,
            course_step_rad: 2.0 * half_course,
            climb_step_rad: 2.0 * half_climb,
            airspeed_mps: flyer.airspeed_mps,
            sum: times(course, climb),
            difference: times(course, conjugate(climb)),
            climb,
            turn: [
                times(sum_half, sum_half),
                times(difference_half, difference_half),
                times(climb_half, climb_half),
            ],
            shift: [
                mean(half_course + half_climb, sum_half, 0.5 * scale),
                mean(half_course - half_climb, difference_half, 0.5 * scale),
                mean(half_climb, climb_half, scale),
            ],
        }
    }

    /// The state now.
    pub(crate) const fn state(&self) -> &MotionState {
        &self.state
    }

    /// The velocity now, metres per second.
    pub(crate) fn velocity_mps(&self) -> Vec3 {
        let half = 0.5 * self.airspeed_mps;
        Vec3::new(
            half * (self.sum.0 + self.difference.0),
            half * (self.sum.1 + self.difference.1),
            self.airspeed_mps * self.climb.1,
        )
    }

    /// Goes one step on.
    pub(crate) fn advance(&mut self) {
        let [sum_shift, difference_shift, climb_shift] = self.shift;
        let sum = times(self.sum, sum_shift);
        let difference = times(self.difference, difference_shift);
        let climb = times(self.climb, climb_shift);
        self.state.position_m += Vec3::new(sum.0 + difference.0, sum.1 + difference.1, climb.1);
        let [sum_turn, difference_turn, climb_turn] = self.turn;
        self.sum = times(self.sum, sum_turn);
        self.difference = times(self.difference, difference_turn);
        self.climb = times(self.climb, climb_turn);
        self.state.time_s += self.step_s;
        self.state.course_rad += self.course_step_rad;
        self.state.climb_rad += self.climb_step_rad;
    }
}

/// sin(x) / x, from e^(i x).
fn sinc(x: f64, unit: Complex) -> f64 {
    if x.abs() < 1e-4 {
        1.0 - x * x / 6.0
    } else {
        unit.1 / x
    }
}
