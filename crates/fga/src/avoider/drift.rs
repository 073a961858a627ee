//! Drift: the velocity with which gusts, an error of the wind or the autopilot carry the aircraft off
//! its prediction.

use crate::Vec3;

/// Window of one measurement, seconds. Faster changes move the aircraft little.
const WINDOW_S: f64 = 1.0;

/// Longest step that is measured, seconds: a turn that begins within a longer one looks like drift.
const LONGEST_STEP_S: f64 = 0.15;

/// Time over which its variance is averaged, seconds.
const AVERAGED_S: f64 = 10.0;

/// Error of the measurement itself, metres per second.
const STILL_MPS: f64 = 0.1;

/// A drift above this share of the airspeed is a jump of the position.
const JUMP_SHARE: f64 = 0.5;

/// In these last seconds before the closest approach no turn makes up for drift: a turn with 30° of bank
/// moves the aircraft aside by 25 m in 3 s.
const TOO_LATE_S: f64 = 3.0;

/// Standard deviations of the drift that are kept clear.
const SIGMAS: f64 = 3.0;

/// The drift of the aircraft, measured in flight.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Drift {
    /// Time, position and velocity over the ground at the last step.
    last: Option<(f64, Vec3, Vec3)>,
    /// Drift of this window so far, metres.
    carried_m: Vec3,
    /// Length of this window so far, seconds.
    for_s: f64,
    /// Average of the square of each horizontal component, m²/s².
    variance: f64,
}

impl Drift {
    /// Measures the drift since the last step; `velocity_mps` is the predicted velocity over the ground.
    pub(super) fn observe(&mut self, time_s: f64, position_m: Vec3, velocity_mps: Vec3) {
        let last = self.last.replace((time_s, position_m, velocity_mps));
        let Some((last_s, last_m, last_mps)) = last else {
            return;
        };
        let passed_s = time_s - last_s;
        if passed_s <= 0.0 || passed_s > LONGEST_STEP_S {
            (self.carried_m, self.for_s) = (Vec3::ZERO, 0.0);
            return;
        }
        self.carried_m += position_m - last_m - (last_mps + velocity_mps) * (0.5 * passed_s);
        self.for_s += passed_s;
        if self.for_s < WINDOW_S {
            return;
        }
        let drift_mps = self.carried_m / self.for_s;
        if drift_mps.length() < JUMP_SHARE * velocity_mps.length() {
            let gain = 1.0 - libm::exp(-self.for_s / AVERAGED_S);
            self.variance += gain * (0.5 * drift_mps.length_squared() - self.variance);
        }
        (self.carried_m, self.for_s) = (Vec3::ZERO, 0.0);
    }

    /// Distance kept clear for it, metres: at least for the drift known beforehand, at most `most_m`.
    pub(super) fn margin_m(&self, known_mps: f64, most_m: f64) -> f64 {
        let measured_mps = libm::sqrt(self.variance);
        let drift_mps = if measured_mps < STILL_MPS {
            known_mps
        } else {
            measured_mps.max(known_mps)
        };
        (SIGMAS * TOO_LATE_S * drift_mps).min(most_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flight with 15 m/s and turns of 0.5 rad/s that begin and end within steps, with this drift.
    fn after(seconds: u32, carried: impl Fn(f64) -> Vec3) -> Drift {
        let mut drift = Drift::default();
        let (mut place, mut course, steps) = (Vec3::ZERO, 0.0_f64, 100);
        for k in 0..seconds * 10 {
            let time_s = 0.1 * f64::from(k);
            let velocity = Vec3::new(course.cos(), course.sin(), 0.0) * 15.0;
            drift.observe(time_s, place, velocity);
            for step in 0..steps {
                let at_s = time_s + 0.001 * f64::from(step);
                let turns = (at_s + 0.04).rem_euclid(8.0) < 2.0;
                course += if turns { 0.5e-3 } else { 0.0 };
                place += Vec3::new(course.cos(), course.sin(), 0.0) * 15e-3 + carried(at_s) * 1e-3;
            }
        }
        drift
    }

    #[test]
    fn an_aircraft_that_flies_as_predicted_keeps_no_margin_for_drift() {
        let drift = after(60, |_| Vec3::ZERO);
        assert_eq!(drift.margin_m(0.0, 30.0), 0.0);
        assert!((drift.margin_m(0.3, 30.0) - 2.7).abs() < 1e-9);
    }

    #[test]
    fn drift_is_measured_and_bounded() {
        let drift = after(60, |_| Vec3::new(0.6, -0.8, 0.0));
        let margin_m = drift.margin_m(0.0, 30.0);
        let expected_m = 9.0 * 0.5_f64.sqrt();
        assert!(
            (margin_m - expected_m).abs() < 0.1 * expected_m,
            "{margin_m}"
        );
        assert_eq!(drift.margin_m(9.0, 30.0), 30.0);
    }

    #[test]
    fn a_position_that_jumps_is_no_drift() {
        let mut drift = Drift::default();
        for k in 0..100_u32 {
            let jump_m = if k < 50 { 0.0 } else { 500.0 };
            let place = Vec3::X * (1.5 * f64::from(k) + jump_m);
            drift.observe(0.1 * f64::from(k), place, Vec3::X * 15.0);
        }
        assert_eq!(drift.margin_m(0.0, 30.0), 0.0);
    }
}
