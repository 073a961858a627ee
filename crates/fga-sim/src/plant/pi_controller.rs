//! The PI controller of course and climb angle (Eq. 13, 14), with a rate limit and anti-windup.

use fga::limit::Limit as _;

/// Turns the error of an angle into its commanded rate: ψ̇ = `K_p` e + `K_i` ∫ e dt, limited.
///
/// At the limit of the rate the integral only moves back from it (conditional integration),
/// so a long turn at full rate does not overshoot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PiController {
    /// Proportional gain `K_p`, per second.
    proportional: f64,
    /// Integral gain `K_i`, per second squared.
    integral: f64,
    /// Largest commanded rate to either side, radians per second.
    limit_radps: f64,
    integral_rads: f64,
}

impl PiController {
    /// A controller at rest; `None` for gains or a limit that are negative or not finite.
    pub(super) fn new(proportional: f64, integral: f64, limit_radps: f64) -> Option<Self> {
        let mut all = [proportional, integral, limit_radps].into_iter();
        let is_valid = all.all(|value| value.is_finite() && value >= 0.0);
        is_valid.then_some(Self {
            proportional,
            integral,
            limit_radps,
            integral_rads: 0.0,
        })
    }

    /// Commanded rate, radians per second, for an error (commanded − flown, wrapped by the caller
    /// if it is a course) over `step_s` seconds.
    ///
    /// An error or a time that is not finite, or a negative time, changes nothing and commands the
    /// rate of the integral alone.
    pub(super) fn step(&mut self, error_rad: f64, step_s: f64) -> f64 {
        let usable = error_rad.is_finite() && step_s.is_finite() && step_s >= 0.0;
        let error_rad = if usable { error_rad } else { 0.0 };
        let integral = if usable {
            self.integral_rads + error_rad * step_s
        } else {
            self.integral_rads
        };
        let limit = self.limit_radps;
        let proportional = self.proportional * error_rad;
        let wanted = proportional + self.integral * integral;
        let winds_up = (wanted > limit && error_rad > 0.0) || (wanted < -limit && error_rad < 0.0);
        if !winds_up && integral.is_finite() {
            self.integral_rads = integral;
        }
        let rate = proportional + self.integral * self.integral_rads;
        if rate.is_nan() {
            0.0
        } else {
            rate.limited(-limit, limit)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn controller(proportional: f64, integral: f64, limit: f64) -> PiController {
        PiController::new(proportional, integral, limit).unwrap()
    }

    /// Closed loop ψ' = `K_p` e + `K_i` ∫e: e'' + `K_p` e' + `K_i` e = 0 with e(0) = `e_0`, e'(0) = −`K_p` `e_0`.
    /// For `K_p` = 1.2, `K_i` = 0.2 the roots are −1 and −0.2: e = `e_0` (1.25 e^(−t) − 0.25 e^(−t/5)).
    #[test]
    fn the_loop_follows_the_solution_of_its_differential_equation() {
        let mut pi = controller(1.2, 0.2, 100.0);
        let (mut angle, command, step) = (0.0, 0.5, 1e-4);
        for _ in 0..30_000 {
            angle += pi.step(command - angle, step) * step;
        }
        let exact = 0.5 * (1.25 * f64::exp(-3.0) - 0.25 * f64::exp(-0.6));
        assert!((command - angle - exact).abs() < 1e-4);
    }

    #[test]
    fn a_long_turn_at_the_limit_does_not_wind_up() {
        let run = |integral: f64| {
            let mut pi = controller(1.0, integral, 0.5);
            let (mut angle, mut most) = (0.0f64, 0.0f64);
            for _ in 0..4000 {
                let rate = pi.step(3.0 - angle, 0.01);
                assert!(rate.abs() <= 0.5);
                angle += rate * 0.01;
                most = most.max(angle);
            }
            most
        };
        assert!(run(0.0) <= 3.0);
        // Without anti-windup the integral would hold about 7.5 rad·s at the end of the turn.
        assert!(run(0.05) < 3.0 + 0.05);
    }

    #[test]
    fn gains_out_of_range_are_refused() {
        for bad in [f64::NAN, f64::INFINITY, -1.0] {
            assert!(PiController::new(1.0, bad, 1.0).is_none());
        }
    }

    proptest! {
        #[test]
        fn the_rate_is_always_within_its_limit(errors in proptest::collection::vec(any::<f64>(), 1..20), step: f64) {
            let mut pi = controller(2.0, 0.5, 0.7);
            for error in errors {
                let rate = pi.step(error, step);
                prop_assert!(rate.is_finite() && rate.abs() <= 0.7);
            }
        }

        #[test]
        fn mirrored_errors_give_mirrored_rates(errors in proptest::collection::vec(-4.0..4.0f64, 1..20)) {
            let mut one = controller(1.0, 0.3, 0.5);
            let mut other = one;
            for error in errors {
                prop_assert_eq!(one.step(error, 0.1), -other.step(-error, 0.1));
            }
        }
    }
}
