//! Flight with a first-order bank response or under the PI autopilot, by Runge–Kutta steps.

use fga::Vec3;
use fga::angle::direction;
use fga::vehicle::{PiController, PiGains, STANDARD_GRAVITY_MPS2, Vehicle};

use super::{Arc, Autopilot, Plant};

/// Longest integration step, seconds (50 Hz).
const LONGEST_STEP_S: f64 = 0.02;

/// The controllers of the PI autopilot (Eq. 13, 14); none under the direct one.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Controllers {
    course: Option<PiController>,
    climb: Option<PiController>,
}

impl Controllers {
    /// Controllers at rest.
    pub(super) fn new(autopilot: Autopilot, vehicle: &Vehicle) -> Self {
        let Autopilot::ProportionalIntegral {
            proportional_per_s,
            integral_per_s2,
        } = autopilot
        else {
            return Self::default();
        };
        let controller = |rate_limit_radps| {
            PiController::new(PiGains {
                proportional: proportional_per_s,
                integral: integral_per_s2,
                rate_limit_radps,
            })
        };
        Self {
            course: controller(vehicle.course_rate_radps()),
            climb: controller(vehicle.climb_rate_radps),
        }
    }
}

/// What is integrated: position, course and bank.
#[derive(Clone, Copy)]
struct Flight {
    position_m: Vec3,
    course_rad: f64,
    bank_rad: f64,
}

impl Flight {
    fn plus(self, rate: Self, by_s: f64) -> Self {
        Self {
            position_m: self.position_m + rate.position_m * by_s,
            course_rad: self.course_rad + rate.course_rad * by_s,
            bank_rad: self.bank_rad + rate.bank_rad * by_s,
        }
    }
}

/// Course change while the bank decays from `bank_rad` to level, per second of time constant and
/// per g/V: ∫₀^φ tan(u)/u du by its series (error below 0.5 % up to 55°).
fn roll_out_integral(bank_rad: f64) -> f64 {
    let square = bank_rad * bank_rad;
    bank_rad
        * (1.0
            + square
                * (1.0 / 9.0
                    + square
                        * (2.0 / 75.0 + square * (17.0 / 2205.0 + square * (62.0 / 25_515.0)))))
}

impl Plant {
    /// Flies Runge–Kutta steps until `until_s`.
    pub(super) fn fly_lagged(&mut self, until_s: f64, flown: &mut impl FnMut(&Arc, Vec3)) {
        let span_s = until_s - self.time_s;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a count of steps: positive and small"
        )]
        let steps = (libm::ceil(span_s / LONGEST_STEP_S - 1e-9) as u32).max(1);
        let step_s = span_s / f64::from(steps);
        let start_s = self.time_s;
        for k in 1..=steps {
            self.step_lagged(step_s, flown);
            self.time_s = start_s + span_s * f64::from(k) / f64::from(steps);
        }
        self.time_s = until_s;
    }

    fn step_lagged(&mut self, step_s: f64, flown: &mut impl FnMut(&Arc, Vec3)) {
        let bank_command = self.bank_command_rad(step_s);
        let climb_rate = self.climb_rate_command_radps(step_s);
        let time_constant_s = self.vehicle.response.bank_time_constant_s;
        let (factor, speed) = (self.vehicle.response.turn_rate_factor, self.airspeed_mps);
        let before = Flight {
            position_m: self.position_m,
            course_rad: self.course_rad,
            bank_rad: if time_constant_s > 0.0 {
                self.bank_rad
            } else {
                bank_command
            },
        };
        let (wind, climb) = (self.wind_mps, self.climb_rad);
        let rate = |state: Flight, after_s: f64| Flight {
            position_m: direction(state.course_rad, climb + climb_rate * after_s) * speed + wind,
            course_rad: factor * STANDARD_GRAVITY_MPS2 * libm::tan(state.bank_rad) / speed,
            bank_rad: if time_constant_s > 0.0 {
                (bank_command - state.bank_rad) / time_constant_s
            } else {
                0.0
            },
        };
        let half = step_s / 2.0;
        let k1 = rate(before, 0.0);
        let k2 = rate(before.plus(k1, half), half);
        let k3 = rate(before.plus(k2, half), half);
        let k4 = rate(before.plus(k3, step_s), step_s);
        let after = before
            .plus(k1, step_s / 6.0)
            .plus(k2, step_s / 3.0)
            .plus(k3, step_s / 3.0)
            .plus(k4, step_s / 6.0);
        let arc = Arc {
            start_s: self.time_s,
            duration_s: step_s,
            position_m: before.position_m,
            course_rad: before.course_rad,
            climb_rad: climb,
            course_rate_radps: (after.course_rad - before.course_rad) / step_s,
            climb_rate_radps: climb_rate,
            airspeed_mps: speed,
            wind_mps: wind,
        };
        flown(&arc, after.position_m);
        self.position_m = after.position_m;
        self.course_rad = after.course_rad;
        self.bank_rad = after.bank_rad;
        self.climb_rad = climb + climb_rate * step_s;
    }

    /// Bank asked for: the turn at the commanded rate, rolled out in time to meet the course.
    ///
    /// With e the course still to turn and `e_r` the course that rolling out from the present bank
    /// adds, σ = e − `e_r` shrinks at just the commanded rate, so that a rate proportional to σ
    /// brings the aircraft onto its course without overshoot.
    fn bank_command_rad(&mut self, step_s: f64) -> f64 {
        let Some(stage) = self.active else {
            return 0.0;
        };
        let limit = self.course_rate_limit_radps() * stage.rate_share;
        let remaining = stage.course_rad - self.course_rad;
        let rate = if let Some(controller) = &mut self.controllers.course {
            controller.step(remaining, step_s)
        } else {
            let response = self.vehicle.response;
            let roll_out = response.turn_rate_factor * STANDARD_GRAVITY_MPS2 / self.airspeed_mps
                * response.bank_time_constant_s
                * roll_out_integral(self.bank_rad);
            // σ closes well within the bank's own time.
            (remaining - roll_out) / (0.2 * response.bank_time_constant_s).max(step_s)
        };
        self.bank_of(rate.clamp(-limit, limit))
    }

    fn climb_rate_command_radps(&mut self, step_s: f64) -> f64 {
        let limit = self.vehicle.climb_rate_radps;
        let remaining = self.climb_target_rad() - self.climb_rad;
        let rate = match &mut self.controllers.climb {
            Some(controller) => controller.step(remaining, step_s),
            None => remaining / step_s,
        };
        rate.clamp(-limit, limit)
    }
}
