//! The motion of the vehicle under one command: Eq. 10–12 with its limits and its response.
//!
//! Without lag the motion is exact: course ψ and climb angle θ move linearly in time to their targets, and
//! cos θ cos ψ = ½ [cos(ψ+θ) + cos(ψ−θ)] makes Eq. 10–12 integrals of cosines of linear functions. With a bank lag (proof.md §1) the
//! command is the bank of the largest course rate until the remaining turn equals that of rolling out to level, then level.

use core::f64::consts::FRAC_PI_2;

use crate::Vec3;
use crate::angle::direction;
use crate::limit::Limit as _;
use crate::maneuver::Stage;
use crate::meter::{LAGGED_NODE, LAGGED_PIECE, NODE, PIECE};
use crate::situation::Ownship;
use crate::vehicle::{STANDARD_GRAVITY_MPS2, Vehicle};

mod arc;
mod lagged;

/// An angle closer to its target than this has reached it, radians.
const REACHED_RAD: f64 = 1e-11;

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
    /// At the origin along +x, level, with a bank angle in radians.
    pub const fn ahead(bank_rad: f64) -> Self {
        Self {
            time_s: 0.0,
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad,
        }
    }

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

/// One piece of flight: a constant climb rate, and a course rate that is quadratic in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Duration, seconds; infinite for straight flight.
    pub duration_s: f64,
    /// Course rate at its beginning, radians per second, positive to the left.
    pub course_rate_radps: f64,
    /// Slope of the course rate at its beginning, radians per second squared; 0 unless the bank changes.
    pub course_growth_radps2: f64,
    /// Slope of that slope, radians per second cubed.
    pub course_curve_radps3: f64,
    /// Rate of the climb angle, radians per second.
    pub climb_rate_radps: f64,
    /// Bank that the aircraft rolls to, radians.
    pub bank_command_rad: f64,
    /// Bank at the end of the piece, radians.
    pub bank_end_rad: f64,
    /// Bound of the course rate within it, radians per second.
    pub fastest_radps: f64,
    /// Bound of the distance of the flight from that with this course rate, metres, if both begin alike (proof.md §4, §5).
    pub remainder_m: f64,
    /// Bound of the error of its turn, radians.
    pub course_error_rad: f64,
    /// Bound of the error of the bank at its end, radians.
    pub bank_error_rad: f64,
    /// The remaining turn beyond the roll-out's at its beginning, radians, without a sign.
    pub beyond_rad: f64,
    /// Whether the turn is over, on its course, at its end.
    pub ends_turn: bool,
}

impl Piece {
    /// At constant rates, without a roll.
    pub const fn steady(
        duration_s: f64,
        course_rate_radps: f64,
        climb_rate_radps: f64,
        bank_rad: f64,
    ) -> Self {
        Self {
            duration_s,
            course_rate_radps,
            course_growth_radps2: 0.0,
            course_curve_radps3: 0.0,
            climb_rate_radps,
            bank_command_rad: bank_rad,
            bank_end_rad: bank_rad,
            fastest_radps: course_rate_radps,
            remainder_m: 0.0,
            course_error_rad: 0.0,
            bank_error_rad: 0.0,
            beyond_rad: 0.0,
            ends_turn: false,
        }
    }

    /// Change of course after a time, radians.
    pub(crate) fn turn_rad(&self, after_s: f64) -> f64 {
        self.mean_radps(after_s) * after_s
    }

    /// Mean course rate up to a time, radians per second.
    fn mean_radps(&self, after_s: f64) -> f64 {
        let growth = self.course_growth_radps2 + self.course_curve_radps3 * after_s / 3.0;
        self.course_rate_radps + 0.5 * growth * after_s
    }

    /// Whether the course rate changes.
    pub fn is_rolling(&self) -> bool {
        self.course_growth_radps2 != 0.0 || self.course_curve_radps3 != 0.0
    }
}

/// The rate towards a target that is an angle away, radians per second, at most a limit, and how long it lasts, seconds.
fn towards(left_rad: f64, limit_radps: f64) -> (f64, f64) {
    if left_rad.abs() < REACHED_RAD || limit_radps <= 0.0 {
        return (0.0, f64::INFINITY);
    }
    let rate = libm::copysign(limit_radps, left_rad);
    (rate, left_rad / rate)
}

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
    /// The error that a piece of a roll may have, as a share of the usual one.
    pace: f64,
}

impl Flyer {
    /// The motion of a vehicle at its airspeed.
    pub fn new(vehicle: &Vehicle) -> Self {
        let mut flyer = Self::NONE;
        flyer.set(vehicle);
        flyer
    }

    /// Of no use before [`Self::set`]: zeros, which are written without a copy.
    pub const NONE: Self = Self {
        airspeed_mps: 0.0,
        course_rate_radps: 0.0,
        climb_rate_radps: 0.0,
        climb_min_rad: 0.0,
        climb_max_rad: 0.0,
        bank_time_constant_s: 0.0,
        turn_rate_factor: 0.0,
        gain_radps: 0.0,
        full_bank_rad: 0.0,
        full_roll_out_rad: 0.0,
        pace: 0.0,
    };

    /// Takes the motion of a vehicle.
    pub fn set(&mut self, vehicle: &Vehicle) {
        let response = vehicle.response;
        self.airspeed_mps = vehicle.airspeed_mps;
        self.course_rate_radps = vehicle.course_rate_radps();
        self.climb_rate_radps = vehicle.climb_rate_radps;
        self.climb_min_rad = vehicle.climb_min_rad;
        self.climb_max_rad = vehicle.climb_max_rad;
        self.bank_time_constant_s = response.bank_time_constant_s;
        self.turn_rate_factor = response.turn_rate_factor;
        self.gain_radps = response.turn_rate_factor * STANDARD_GRAVITY_MPS2 / vehicle.airspeed_mps;
        (self.full_bank_rad, self.full_roll_out_rad) = (0.0, 0.0);
        if !self.is_ideal() {
            self.prepare_rolls();
        }
    }

    /// Time constant of the bank, seconds.
    pub const fn bank_time_constant_s(&self) -> f64 {
        self.bank_time_constant_s
    }

    /// Total airspeed, metres per second.
    #[inline]
    pub const fn airspeed_mps(&self) -> f64 {
        self.airspeed_mps
    }

    /// Largest course rate, radians per second.
    #[inline]
    pub const fn course_rate_radps(&self) -> f64 {
        self.course_rate_radps
    }

    /// Radius of the tightest turn, metres.
    #[inline]
    pub fn turn_radius_m(&self) -> f64 {
        self.airspeed_mps / self.course_rate_radps
    }

    /// Rate of the climb angle, radians per second.
    #[inline]
    pub const fn climb_rate_radps(&self) -> f64 {
        self.climb_rate_radps
    }

    /// The turn at a bank of 45° in a time constant of the bank, radians.
    pub(crate) fn turn_at_45_rad(&self) -> f64 {
        self.gain_radps * self.bank_time_constant_s
    }

    /// Whether the bank follows its command at once.
    pub fn is_ideal(&self) -> bool {
        self.bank_time_constant_s <= 0.0
    }

    /// What a piece of a predicted flight takes, in units of work.
    #[inline]
    pub fn piece_work(&self) -> usize {
        if self.is_ideal() { PIECE } else { LAGGED_PIECE }
    }

    /// What a node of a path takes, in units of work.
    pub(crate) fn node_work(&self) -> usize {
        if self.is_ideal() { NODE } else { LAGGED_NODE }
    }

    /// Velocity at a state, metres per second (Eq. 10–12).
    #[inline]
    pub fn velocity_mps(&self, state: &MotionState) -> Vec3 {
        direction(state.course_rad, state.climb_rad) * self.airspeed_mps
    }

    /// The piece that comes next under a command, with a new command after `limit_s` seconds.
    ///
    /// It ends where a target is reached, or after a part of a roll; it is infinite once both targets are met. One with a changing
    /// bank ends at the new command, with the rate and the bank of that moment.
    pub fn next_piece(&self, state: &MotionState, command: &Stage, limit_s: f64) -> Piece {
        let (low_rad, high_rad) = (self.climb_min_rad, self.climb_max_rad);
        let climb_left = command.climb_rad.limited(low_rad, high_rad) - state.climb_rad;
        let climb @ (climb_rate, climb_s) = towards(climb_left, self.climb_rate_radps);
        let turn_left = command.course_rad - state.course_rad;
        if self.is_ideal() {
            let limit = self.course_rate_radps * command.rate_share;
            let (rate, turn_s) = towards(turn_left, limit);
            return Piece::steady(climb_s.min(turn_s), rate, climb_rate, 0.0);
        }
        self.lagged_piece(state, turn_left, command.rate_share, climb, limit_s)
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

    /// Bound of the acceleration of a piece, metres per second squared: V √(ψ̇² + θ̇²).
    pub fn acceleration_mps2(&self, piece: &Piece) -> f64 {
        let (turning, climbing) = (piece.fastest_radps, piece.climb_rate_radps);
        let rate = if climbing == 0.0 {
            turning.abs()
        } else {
            libm::sqrt(turning * turning + climbing * climbing)
        };
        self.airspeed_mps * rate
    }
}
