//! Algorithm 4 as functions: the emergency manoeuvre round a static obstacle, in the plane.
//!
//! [`Plan::of`] decides whether and how (lines 6–21), [`Execution`] when and in which phase (lines
//! 22–47); the caller sets the autopilot's modes. Left is anticlockwise from above; a bank angle is
//! positive in a left turn; the PWM value is above 1500 in a right turn (Eq. 59).

use crate::conflict::Relative;
use crate::paths::RoundObstacle;
use crate::timing::{Geometry, avoidance_time_s};
use crate::turn::bank_for_radius_rad;
use fga::limit::Limit as _;
use fga::search::Side;
use fga::situation::Ownship;
use fga::vehicle::turn_radius_m;
use fga::{Vec3, angle::wrap_pi};

/// PWM value of a bank angle of 0, microseconds.
pub const PWM_NEUTRAL_US: f64 = 1500.0;
/// PWM value of the largest bank angle to the right less [`PWM_NEUTRAL_US`], microseconds.
pub const PWM_RANGE_US: f64 = 500.0;

/// PWM value for a bank angle, microseconds, 1000 to 2000: 1500 + 500 dir φ/`φ_max` with dir = +1
/// for a right turn (Eq. 59, corrected).
///
/// A bank angle beyond the largest one gives an end of the range. `None` for a bank angle that is
/// not finite or a largest one that is not positive.
pub fn pwm_us(bank_rad: f64, bank_max_rad: f64) -> Option<f64> {
    let usable = bank_rad.is_finite() && bank_max_rad.is_finite() && bank_max_rad > 0.0;
    usable.then(|| PWM_NEUTRAL_US - PWM_RANGE_US * (bank_rad / bank_max_rad).limited(-1.0, 1.0))
}

/// The constant 11.26 of Eq. 60: g in knots² per foot, as FAA handbooks round it (exactly 11.294).
pub const FAA_TURN_CONSTANT: f64 = 11.26;

/// Eq. 60 as printed, which is the FAA's form: airspeed in knots, radius in feet.
///
/// `None` unless both are positive.
pub fn bank_for_radius_faa_rad(airspeed_kt: f64, radius_ft: f64) -> Option<f64> {
    let squared = airspeed_kt * airspeed_kt;
    let positive = |value: f64| value.is_finite() && value > 0.0;
    let usable = positive(airspeed_kt) && positive(radius_ft) && positive(squared);
    usable.then(|| libm::atan2(squared, FAA_TURN_CONSTANT * radius_ft))
}

/// The plan to avoid the obstacle (Alg. 4 lines 6–21).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Side of the first turn: away from the obstacle.
    pub side: Side,
    /// `θ_i`, the course before, radians.
    pub initial_course_rad: f64,
    /// `d_m`, the protected radius, metres.
    pub radius_m: f64,
    /// ρ, the turn radius at the largest bank angle, metres.
    pub turn_radius_m: f64,
    /// The three arcs; the first one's angle is α.
    pub round: RoundObstacle,
    /// `d_c`, along-track distance to abeam at which it must begin, metres (line 17, corrected).
    pub critical_along_m: f64,
    /// `r_c` = √(`d_c²` + (r sin θ)²), the range at which it must begin, metres (lines 24, 25).
    pub critical_range_m: f64,
    /// `t_c` = (r cos θ − `d_c`)/V, seconds from now; negative if it is late (line 19, corrected).
    pub critical_s: f64,
    /// Largest bank angle, radians.
    pub bank_max_rad: f64,
    /// Bank angle of the second arc, radians, a magnitude (Eq. 60).
    pub round_bank_rad: f64,
}

impl Plan {
    /// The plan for an obstacle at `obstacle_m` with a protected radius `d_m`, for an aircraft with
    /// the largest bank angle `bank_max_rad`.
    ///
    /// Dead ahead the turn goes to the right, by the rules of the air. `None` if no collision is projected
    /// (line 12, and ahead), if the aircraft is already inside, or if a number is out of range.
    pub fn of(
        ownship: &Ownship,
        obstacle_m: Vec3,
        radius_m: f64,
        bank_max_rad: f64,
    ) -> Option<Self> {
        if !ownship.is_valid() {
            return None;
        }
        let level_mps = ownship.airspeed_mps * libm::cos(ownship.climb_rad);
        let turn_radius_m = turn_radius_m(level_mps, bank_max_rad)?;
        let relative = Relative::new(obstacle_m - ownship.position_m, ownship.velocity_mps())?;
        let encounter = Geometry::horizontal(&relative, radius_m)?;
        let range_m = libm::hypot(encounter.along_m, encounter.across_m);
        if !encounter.is_threat() || range_m <= radius_m {
            return None;
        }
        let offset = relative.position_m();
        // θ_t0 = bearing − course, wrapped (line 7): positive where the obstacle is to the left.
        let bias_rad = wrap_pi(libm::atan2(offset.y, offset.x) - ownship.course_rad);
        let side = if bias_rad < 0.0 {
            Side::Left
        } else {
            Side::Right
        };
        let round = RoundObstacle::new(turn_radius_m, radius_m, encounter.across_m)?;
        let critical_s = avoidance_time_s(&encounter, turn_radius_m)?;
        Some(Self {
            side,
            initial_course_rad: ownship.course_rad,
            radius_m,
            turn_radius_m,
            round,
            critical_along_m: round.before_m,
            critical_range_m: libm::hypot(round.before_m, encounter.across_m),
            critical_s,
            bank_max_rad,
            round_bank_rad: bank_for_radius_rad(level_mps, round.around.radius_m)?
                .min(bank_max_rad),
        })
    }
}

/// The phase of the manoeuvre (Fig. 24).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Phase {
    /// Neither trigger has fired (lines 24–28).
    Waiting,
    /// First turn, away, until the course deviates by α (line 33).
    TurningAway,
    /// Second turn, to the other side, round the obstacle (lines 35, 36).
    RoundObstacle,
    /// Third turn, back to the initial course (line 38).
    TurningBack,
    /// On the initial course with the wings level (lines 40–42).
    Done,
}

/// The command for now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BankCommand {
    /// The phase.
    pub phase: Phase,
    /// Bank angle, radians, positive to the left.
    pub bank_rad: f64,
    /// The same as a PWM value, microseconds.
    pub pwm_us: f64,
}

/// A plan in execution: call it each cycle with the aircraft's state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Execution {
    plan: Plan,
    phase: Phase,
}

impl Execution {
    /// A plan that waits for its trigger.
    pub const fn new(plan: Plan) -> Self {
        Self {
            plan,
            phase: Phase::Waiting,
        }
    }

    /// The plan.
    pub const fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The phase.
    pub const fn phase(&self) -> Phase {
        self.phase
    }

    /// Advances the phase and returns the commanded bank angle, `elapsed_s` seconds after the plan, at a
    /// horizontal `range_m` from the obstacle, on `course_rad` (wrapped or not).
    ///
    /// The first of two triggers starts the turn: the range `r_c`, or the timer `t_c` (Fig. 23). A number
    /// that is not finite fires no trigger and ends no phase.
    pub fn step(&mut self, elapsed_s: f64, range_m: f64, course_rad: f64) -> BankCommand {
        let plan = &self.plan;
        if self.phase == Phase::Waiting
            && (range_m <= plan.critical_range_m || elapsed_s >= plan.critical_s)
        {
            self.phase = Phase::TurningAway;
        }
        if course_rad.is_finite() {
            // Positive to the side of the first turn.
            let deviation_rad = plan.side.sign() * wrap_pi(course_rad - plan.initial_course_rad);
            if self.phase == Phase::TurningAway && deviation_rad >= plan.round.away.angle_rad {
                self.phase = Phase::RoundObstacle;
            }
            if self.phase == Phase::RoundObstacle && deviation_rad <= -plan.round.back.angle_rad {
                self.phase = Phase::TurningBack;
            }
            if self.phase == Phase::TurningBack && deviation_rad >= 0.0 {
                self.phase = Phase::Done;
            }
        }
        let sign = plan.side.sign();
        let bank_rad = match self.phase {
            Phase::Waiting | Phase::Done => 0.0,
            Phase::TurningAway | Phase::TurningBack => sign * plan.bank_max_rad,
            Phase::RoundObstacle => -sign * plan.round_bank_rad,
        };
        BankCommand {
            phase: self.phase,
            bank_rad,
            pwm_us: pwm_us(bank_rad, plan.bank_max_rad).unwrap_or(PWM_NEUTRAL_US),
        }
    }
}

#[cfg(test)]
mod tests;
