//! The vehicle's response, estimated in flight: turn-rate factor and bank lag.
//!
//! The factor is the measured rate of turn over g·tan φ/V while the bank is steady. Dead time and
//! lag come from the rate at which the bank approaches the commands: of several dead times the estimate
//! takes the one with which a first-order lag explains the rolling best. All start from the
//! configuration's conservative figures and move to the estimate with the evidence; the plan keeps a small
//! reserve of the factor.

use fga::vehicle::{Response, STANDARD_GRAVITY_MPS2};

use crate::config::ResponseConfig;
use crate::ownship::FLYING_SPEED_MPS;

/// Smallest bank that the estimate of the turn rate uses, radians.
const LEAST_BANK_RAD: f64 = 0.15;
/// The bank is steady when it changes slower than this, radians per second.
const STEADY_RADPS: f64 = 0.08;
/// Seconds in a bank after which the estimate weighs as much as the starting value.
const FACTOR_EVIDENCE_S: f64 = 4.0;
/// Share of the estimated factor in the plan.
const IN_HAND: f64 = 0.97;
/// Before a steep bank was flown: the share of the normal bank's factor that it is expected to reach, and its
/// additional lag, seconds. Flight at 45° and less does not show either.
const STEEP_SHARE: f64 = 0.9;
const STEEP_LAG_S: f64 = 0.1;
/// Share of a steep bank's factor in the plan, expected or estimated. A steep turn does not settle in its few seconds: `ArduPlane` at 63°
/// turned with 1.3 of its steady rate for half a second, then with a quarter of it for half a second (the wing unloads while the
/// pitch is corrected), and from there to the end of the turn, 2.9 s, with 0.78 of it. A plan made in the turn meets that part alone.
const STEEP_IN_HAND: f64 = 0.78;
/// Ratios of the flown rate of turn to the ideal one that the estimate uses. The rate of a turn that settles swings about the
/// steady one: a range that leaves out its low half shows a tighter turn than was flown.
const RATIO_RANGE: (f64, f64) = (-0.5, 2.0);
const FACTOR_RANGE: (f64, f64) = (0.4, 1.05);
const LAG_RANGE_S: (f64, f64) = (0.1, 2.5);
/// The candidate dead times, seconds.
const DEAD_TIMES_S: [f64; 10] = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6];
/// Smallest error of the bank that the estimate of the lag uses, radians.
const LEAST_ERROR_RAD: f64 = 0.08;
/// Enough rolling for a dead time: error squared by time, rad² s.
const DEAD_TIME_EVIDENCE: f64 = 0.5;
/// Rolling is forgotten beyond this, rad² s.
const ROLLING_MEMORY: f64 = 5.0;
/// Longest usable gap between attitudes, seconds.
const LONGEST_GAP_S: f64 = 0.35;

/// The present knowledge of the response.
#[derive(Debug, Clone)]
pub struct ResponseEstimate {
    start: Response,
    enabled: bool,
    last: Option<(f64, f64)>,
    /// Σ dt, Σ dt · ratio over steady turns.
    factor_weight_s: f64,
    factor_sum_s: f64,
    /// For each dead time Σ e·φ̇ and Σ e² of φ̇ = e/τ.
    rolling: [(f64, f64); DEAD_TIMES_S.len()],
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
            last: None,
            factor_weight_s: 0.0,
            factor_sum_s: 0.0,
            rolling: [(0.0, 0.0); DEAD_TIMES_S.len()],
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
        let last = self.last.replace((measured_s, bank_rad));
        let Some((last_s, last_bank_rad)) = last else {
            return;
        };
        let gap_s = measured_s - last_s;
        if !(0.005..LONGEST_GAP_S).contains(&gap_s) || airspeed_mps < FLYING_SPEED_MPS {
            return;
        }
        let bank_rate = (bank_rad - last_bank_rad) / gap_s;
        if bank_rad.abs() > LEAST_BANK_RAD && bank_rate.abs() < STEADY_RADPS {
            let ideal = STANDARD_GRAVITY_MPS2 * libm::tan(bank_rad) / airspeed_mps;
            let ratio = course_rate_radps / ideal;
            if (RATIO_RANGE.0..RATIO_RANGE.1).contains(&ratio) {
                self.factor_weight_s += gap_s;
                self.factor_sum_s += gap_s * ratio;
                // A memory of two minutes of turning.
                if self.factor_weight_s > 120.0 {
                    self.factor_weight_s *= 0.5;
                    self.factor_sum_s *= 0.5;
                }
            }
        }
        self.observe_rolling(
            gap_s,
            0.5 * (bank_rad + last_bank_rad),
            bank_rate,
            commanded_before,
        );
    }

    fn observe_rolling(
        &mut self,
        gap_s: f64,
        bank_rad: f64,
        bank_rate: f64,
        commanded_before: impl Fn(f64) -> Option<f64>,
    ) {
        let mut errors = [0.0; DEAD_TIMES_S.len()];
        for (error, dead_s) in errors.iter_mut().zip(DEAD_TIMES_S) {
            // Either all of them or nothing, because they are compared.
            let Some(commanded_rad) = commanded_before(dead_s) else {
                return;
            };
            *error = commanded_rad - bank_rad;
        }
        if errors.iter().all(|error| error.abs() < LEAST_ERROR_RAD) {
            return;
        }
        for ((cross, square), error) in self.rolling.iter_mut().zip(errors) {
            *cross += gap_s * error * bank_rate;
            *square += gap_s * error * error;
        }
        if self.rolling.iter().any(|row| row.1 > ROLLING_MEMORY) {
            for (cross, square) in &mut self.rolling {
                *cross *= 0.5;
                *square *= 0.5;
            }
        }
    }

    /// The dead time that explains the rolling best, with its sums.
    fn best_rolling(&self) -> (f64, (f64, f64)) {
        // The part of Σ φ̇² that the fit φ̇ = e/τ explains.
        let explained = |row: &(f64, f64)| row.0.max(0.0) * row.0 / row.1.max(1e-9);
        DEAD_TIMES_S
            .into_iter()
            .zip(self.rolling)
            .filter(|(_, row)| row.1 > DEAD_TIME_EVIDENCE)
            .max_by(|a, b| explained(&a.1).total_cmp(&explained(&b.1)))
            .unwrap_or((self.start.dead_time_s, (0.0, 0.0)))
    }

    /// The response for the plan.
    pub fn response(&self) -> Response {
        self.response_from(self.start, IN_HAND)
    }

    /// The response of banks steeper than the normal one, of which this is the estimate; `normal` is the one
    /// of banks up to that. Unknown parts are assumed worse: a turn that is tighter than planned
    /// passes farther off. The dead time is the same.
    pub fn steep_response(&self, normal: Response) -> Response {
        let expected = STEEP_SHARE * STEEP_IN_HAND * normal.turn_rate_factor;
        let start = Response {
            turn_rate_factor: expected.max(FACTOR_RANGE.0),
            bank_time_constant_s: normal.bank_time_constant_s + STEEP_LAG_S,
            ..normal
        };
        Response {
            dead_time_s: normal.dead_time_s,
            ..self.response_from(start, STEEP_IN_HAND)
        }
    }

    fn response_from(&self, start: Response, in_hand: f64) -> Response {
        if !self.enabled {
            return start;
        }
        let mut response = start;
        if self.factor_weight_s > 0.5 {
            let seen = in_hand * self.factor_sum_s / self.factor_weight_s;
            let trust = self.factor_weight_s / (self.factor_weight_s + FACTOR_EVIDENCE_S);
            let factor = start.turn_rate_factor + trust * (seen - start.turn_rate_factor);
            response.turn_rate_factor = factor.clamp(FACTOR_RANGE.0, FACTOR_RANGE.1);
        }
        let (dead_time_s, rolling) = self.best_rolling();
        response.dead_time_s = dead_time_s;
        // As if a second of rolling at half a radian of error had shown the starting lag.
        let weight = 0.25;
        let cross = rolling.0 + weight / start.bank_time_constant_s.max(0.1);
        if cross > 1e-3 {
            let lag_s = (rolling.1 + weight) / cross;
            response.bank_time_constant_s = lag_s.clamp(LAG_RANGE_S.0, LAG_RANGE_S.1);
        }
        response
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
