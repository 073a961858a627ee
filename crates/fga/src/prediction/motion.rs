//! How the vehicle moves under one command: Eq. 10–12 with its limits and its response.
//!
//! Without lag the motion is exact: course ψ and climb angle θ move linearly in time to their
//! targets, and cos θ cos ψ = ½ [cos(ψ+θ) + cos(ψ−θ)] makes Eq. 10–12 integrals of cosines of
//! linear functions. With a bank lag the bank follows its command exponentially; over a short step
//! the course rate is taken as constant, at its mean, so that the course at the end is right.

use core::f64::consts::FRAC_PI_2;

use crate::Vec3;
use crate::angle::direction;
use crate::limit::Limit as _;
use crate::situation::Ownship;
use crate::vehicle::{STANDARD_GRAVITY_MPS2, Vehicle};

/// Longest step, in bank time constants, over which the course rate is taken as constant.
const LAG_STEP: f64 = 0.2;

/// A bank, or a change of bank, over which the course rate is as good as linear, radians.
const LITTLE_RAD: f64 = 0.15;

/// An angle closer to its target than this has reached it, radians.
const REACHED_RAD: f64 = 1e-11;

/// A bank below this is wings level, radians.
const LEVEL_BANK_RAD: f64 = 1e-3;

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

/// What is commanded: see [`Stage`](crate::maneuver::Stage) for the meaning of the fields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Course to turn to, radians, not wrapped.
    pub course_rad: f64,
    /// Climb angle to take up, radians.
    pub climb_rad: f64,
    /// Share of the largest course rate.
    pub rate_share: f64,
}

/// One piece of flight at constant course rate and climb rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// How long, seconds; infinite when the aircraft flies straight on.
    pub duration_s: f64,
    /// Course rate, radians per second, positive to the left.
    pub course_rate_radps: f64,
    /// Rate of the climb angle, radians per second.
    pub climb_rate_radps: f64,
    /// Bank at the end of the piece, radians.
    pub bank_end_rad: f64,
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
}

impl Flyer {
    /// The motion of a vehicle at its airspeed.
    pub fn new(vehicle: &Vehicle) -> Self {
        Self {
            airspeed_mps: vehicle.airspeed_mps,
            course_rate_radps: vehicle.course_rate_radps(),
            climb_rate_radps: vehicle.climb_rate_radps,
            climb_min_rad: vehicle.climb_min_rad,
            climb_max_rad: vehicle.climb_max_rad,
            bank_time_constant_s: vehicle.response.bank_time_constant_s,
            turn_rate_factor: vehicle.response.turn_rate_factor,
        }
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

    /// Whether the wings are level.
    pub fn is_level_at(&self, state: &MotionState) -> bool {
        self.is_ideal() || state.bank_rad.abs() < LEVEL_BANK_RAD
    }

    /// Velocity at a state, metres per second (Eq. 10–12).
    pub fn velocity_mps(&self, state: &MotionState) -> Vec3 {
        direction(state.course_rad, state.climb_rad) * self.airspeed_mps
    }

    /// The piece of constant rates that comes next under a command.
    ///
    /// It ends where a target is reached, or after a short step while the bank still changes; it is
    /// infinite once both targets are met.
    pub fn next_piece(&self, state: &MotionState, target: &Target) -> Piece {
        self.next_piece_within(state, target, f64::INFINITY)
    }

    /// The same, where a new command comes after `limit_s` seconds: a piece in which the bank
    /// changes ends there, with the rate and the bank that belong to it.
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
            return Piece {
                duration_s: climb_s.min(turn_s),
                course_rate_radps: rate,
                climb_rate_radps: climb_rate,
                bank_end_rad: 0.0,
            };
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
        // The bank that would just turn the rest while it decays to level.
        let left_after_rollout = turn_left - self.rollout_rad(state.bank_rad);
        let full = self.bank_rad(self.course_rate_radps * rate_share);
        let step_s = LAG_STEP * tau;
        let wanted_rate = left_after_rollout / step_s;
        let saturated = self.rate_radps(full) <= wanted_rate.abs();
        let commanded = if saturated {
            libm::copysign(full, left_after_rollout)
        } else {
            self.bank_rad(wanted_rate)
        };
        let level = state.bank_rad.abs() < LEVEL_BANK_RAD;
        if level && (left_after_rollout.abs() < LEVEL_BANK_RAD || full <= 0.0) {
            // The last thousandth of the turn, so that no bias in course is left to fly on with.
            let (rate, turn_s) = if turn_left.abs() < REACHED_RAD || full <= 0.0 {
                (0.0, f64::INFINITY)
            } else {
                (turn_left / step_s, step_s)
            };
            return Piece {
                duration_s: climb_s.min(turn_s),
                course_rate_radps: rate,
                climb_rate_radps: climb_rate,
                bank_end_rad: 0.0,
            };
        }
        let to_go = commanded - state.bank_rad;
        let nearly = to_go.abs() < LITTLE_RAD;
        let longest_s = if saturated && to_go.abs() < 1e-3 {
            f64::INFINITY
        } else if nearly && (saturated || state.bank_rad.abs() < LITTLE_RAD) {
            2.5 * step_s
        } else if !saturated && commanded.abs() > LITTLE_RAD {
            // The easing command is exponential in the rate, not quite in the bank.
            0.4 * step_s
        } else {
            step_s
        };
        // The full command begins to ease off here: what is left to turn after a roll-out falls at
        // the commanded rate, whatever the bank.
        let eases_off = if saturated {
            (wanted_rate.abs() / self.rate_radps(full) - 1.0) * step_s
        } else {
            f64::INFINITY
        };
        let duration_s = eases_off
            .max(0.1 * step_s)
            .min(longest_s)
            .min(climb_s)
            .min(limit_s);
        // φ' = (φ_c − φ)/τ with φ_c constant, or falling as e^(−t/step) while the command eases off.
        let bank_after = |share: f64| {
            let held = libm::exp(-share * duration_s / tau);
            if saturated {
                return commanded - to_go * held;
            }
            let lag = commanded * LAG_STEP / (1.0 - LAG_STEP);
            let eased = libm::exp(-share * duration_s / step_s);
            (state.bank_rad + lag) * held - lag * eased
        };
        let bank_end_rad = bank_after(1.0);
        // Mean over the step by Simpson's rule.
        let rate = (self.rate_radps(state.bank_rad)
            + 4.0 * self.rate_radps(bank_after(0.5))
            + self.rate_radps(bank_end_rad))
            / 6.0;
        Piece {
            duration_s,
            course_rate_radps: rate,
            climb_rate_radps: climb_rate,
            bank_end_rad,
        }
    }

    /// Change of course while the bank decays to level, radians.
    ///
    /// ∫ f g tan(φ e^(−t/τ)) / V dt = f g τ / V · (φ + φ³/9 + 2φ⁵/75 + …).
    pub fn rollout_rad(&self, bank_rad: f64) -> f64 {
        let square = bank_rad * bank_rad;
        let series = bank_rad * (1.0 + square * (1.0 / 9.0 + square * (2.0 / 75.0)));
        self.turn_rate_factor * STANDARD_GRAVITY_MPS2 * self.bank_time_constant_s * series
            / self.airspeed_mps
    }

    /// Course rate flown at a bank, radians per second (Eq. 9 with the turn-rate factor).
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
        let ends = after_s >= piece.duration_s;
        MotionState {
            time_s: state.time_s + after_s,
            position_m: state.position_m
                + self.displacement_m(
                    state.course_rad,
                    state.climb_rad,
                    piece.course_rate_radps,
                    piece.climb_rate_radps,
                    after_s,
                ),
            course_rad: state.course_rad + piece.course_rate_radps * after_s,
            climb_rad: state.climb_rad + piece.climb_rate_radps * after_s,
            bank_rad: if ends {
                piece.bank_end_rad
            } else {
                state.bank_rad
            },
        }
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
        let half_course = 0.5 * course_rate_radps * after_s;
        let half_climb = 0.5 * climb_rate_radps * after_s;
        let scale = self.airspeed_mps * after_s;
        let course = unit(course_rad + half_course);
        let climb = unit(climb_rad + half_climb);
        let course_half = unit(half_course);
        if climb_rate_radps == 0.0 {
            let chord = scale * sinc(half_course, course_half);
            return Vec3::new(
                chord * climb.0 * course.0,
                chord * climb.0 * course.1,
                scale * climb.1,
            );
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
        Vec3::new(
            scale * (sum_chord * sum.0 + difference_chord * difference.0),
            scale * (sum_chord * sum.1 + difference_chord * difference.1),
            scale * sinc(half_climb, climb_half) * climb.1,
        )
    }

    /// Bound of the acceleration of a piece, metres per second squared: V √(ψ̇² + θ̇²).
    pub fn acceleration_mps2(&self, piece: &Piece) -> f64 {
        let rates = piece.course_rate_radps * piece.course_rate_radps
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
