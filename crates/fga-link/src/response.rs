//! The vehicle's response, learned in flight: turn-rate factor, bank lag and dead time, each with an interval.
//!
//! [`Learned`] has the evidence; here are the configuration, which is believed before it, and the reserve that plans keep of the turn-rate
//! factor of steep banks.

use fga::vehicle::Response;
use fga_learned::{IN_HAND, KnownAircraft, Learned, SeenState};

use crate::config::ResponseConfig;
use crate::ownship::FLYING_SPEED_MPS;

/// Before a steep bank was flown: the share of the normal bank's factor that it is expected to reach, and its
/// additional lag, seconds. Flight at 45° and less does not show either.
const STEEP_SHARE: f64 = 0.9;
const STEEP_LAG_S: f64 = 0.1;
/// Share of a steep bank's factor in the plan, expected or estimated. A steep turn does not settle in its few seconds: `ArduPlane` at 63°
/// turned with 1.3 of its steady rate for half a second, then with a quarter of it for half a second (the wing unloads while the
/// pitch is corrected), and from there to the end of the turn, 2.9 s, with 0.78 of it. A plan made in the turn meets that part alone.
const STEEP_IN_HAND: f64 = 0.78;

/// The present knowledge of the response.
#[derive(Debug, Clone)]
pub struct ResponseEstimate {
    start: Response,
    enabled: bool,
    learned: Learned,
}

impl ResponseEstimate {
    /// Starts from the configuration.
    pub fn new(config: &ResponseConfig) -> Self {
        Self {
            start: Response {
                dead_time_s: config.dead_time_s,
                bank_time_constant_s: config.bank_time_constant_s,
                turn_rate_factor: config.turn_rate_factor,
            },
            enabled: config.estimate,
            learned: Learned::default(),
        }
    }

    /// Takes one attitude: bank and rate of turn (left positive), airspeed, and the bank command
    /// this many seconds before, if known.
    pub fn observe(
        &mut self,
        measured_s: f64,
        bank_rad: f64,
        course_rate_radps: f64,
        airspeed_mps: f64,
        commanded_before: impl Fn(f64) -> Option<f64>,
    ) {
        if !self.enabled || airspeed_mps < FLYING_SPEED_MPS {
            return;
        }
        let seen = SeenState {
            time_s: measured_s,
            bank_rad,
            turn_rate_radps: course_rate_radps,
            airspeed_mps,
            velocity_mps: None,
        };
        self.learned.see(&seen, commanded_before);
    }

    /// The aircraft did not fly as known.
    pub fn forget(&mut self) {
        self.learned.forget();
    }

    /// What is known of banks up to the normal one.
    pub fn known(&self) -> KnownAircraft {
        self.learned.planned(&self.start, IN_HAND)
    }

    /// Whether it learns.
    pub const fn is_enabled(&self) -> bool {
        self.enabled
    }

    /// The response for the plan.
    pub fn response(&self) -> Response {
        self.known().response()
    }

    /// The response of banks steeper than the normal one, of which this is the estimate; `normal` is the one
    /// of banks up to that. Unknown parts are assumed worse: a turn that is tighter than planned
    /// passes farther off. The dead time is the same.
    pub fn steep_response(&self, normal: Response) -> Response {
        let start = Response {
            turn_rate_factor: STEEP_SHARE * STEEP_IN_HAND * normal.turn_rate_factor,
            bank_time_constant_s: normal.bank_time_constant_s + STEEP_LAG_S,
            ..normal
        };
        Response {
            dead_time_s: normal.dead_time_s,
            ..self.learned.planned(&start, STEEP_IN_HAND).response()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A first-order bank (τ = 0.5 s) 0.15 s late and a factor of 0.74 are found from telemetry.
    #[test]
    fn factor_dead_time_and_lag_are_found() {
        let mut estimate = ResponseEstimate::new(&ResponseConfig::default());
        let (mut bank, mut time) = (0.0_f64, 0.0);
        let commanded = |time: f64| {
            if time.rem_euclid(10.0) < 5.0 {
                0.6
            } else {
                -0.6
            }
        };
        for _ in 0..4000_u32 {
            let target = commanded(time - 0.15);
            bank = target + (bank - target) * (-0.05_f64 / 0.5).exp();
            time += 0.05;
            let rate = 0.74 * 9.806_65 * bank.tan() / 25.0;
            estimate.observe(time, bank, rate, 25.0, |before_s| {
                Some(commanded(time - before_s))
            });
        }
        let response = estimate.response();
        assert!(
            (response.turn_rate_factor - 0.97 * 0.74).abs() < 0.005,
            "{response:?}"
        );
        assert!((response.dead_time_s - 0.15).abs() < 0.06, "{response:?}");
        assert!(
            (response.bank_time_constant_s - 0.5).abs() < 0.05,
            "{response:?}"
        );
    }

    #[test]
    fn a_steep_bank_is_taken_to_be_worse_until_it_was_flown() {
        let normal = Response {
            dead_time_s: 0.15,
            bank_time_constant_s: 0.4,
            turn_rate_factor: 0.7,
        };
        let mut steep = ResponseEstimate::new(&ResponseConfig::default());
        let unknown = steep.steep_response(normal);
        assert!((unknown.turn_rate_factor - 0.9 * 0.78 * 0.7).abs() < 1e-9);
        assert!((unknown.bank_time_constant_s - 0.5).abs() < 1e-9);
        // A minute at 60° with a factor of 0.66: the part of it that a turn which settles reaches.
        let rate = 0.66 * 9.806_65 * 60.0_f64.to_radians().tan() / 25.0;
        for n in 0..1200_u32 {
            let bank_rad = 60.0_f64.to_radians();
            steep.observe(f64::from(n) * 0.05, bank_rad, rate, 25.0, |_| None);
        }
        let known = steep.steep_response(normal);
        assert!(
            (known.turn_rate_factor - 0.78 * 0.66).abs() < 0.005,
            "{known:?}"
        );
        assert_eq!(known.dead_time_s, 0.15);
    }

    #[test]
    fn a_configuration_that_is_not_learned_from_is_planned_with_as_it_is() {
        let config = ResponseConfig {
            turn_rate_factor: 1.2,
            estimate: false,
            ..ResponseConfig::default()
        };
        let mut estimate = ResponseEstimate::new(&config);
        for n in 0..1000_u32 {
            estimate.observe(f64::from(n) * 0.05, 0.6, 0.1, 25.0, |_| Some(0.9));
        }
        let response = estimate.response();
        assert!((response.turn_rate_factor - 1.2).abs() < 1e-12);
        assert!((response.bank_time_constant_s - config.bank_time_constant_s).abs() < 1e-12);
    }

    #[test]
    fn without_evidence_it_stays_conservative() {
        let config = ResponseConfig::default();
        let mut estimate = ResponseEstimate::new(&config);
        for n in 0..100_u32 {
            estimate.observe(f64::from(n) * 0.05, 0.01, 0.0, 25.0, |_| None);
        }
        assert_eq!(
            estimate.response().turn_rate_factor,
            config.turn_rate_factor
        );
    }
}
