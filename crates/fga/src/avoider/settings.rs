//! How the avoider is set up.

use core::f64::consts::FRAC_PI_2;

use crate::search::Objective;
use crate::vehicle::Vehicle;

/// When a certified or chosen manoeuvre begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// Chosen with the manoeuvre for the least departure from the mission (`turn-aware` only).
    Free,
    /// At once, when the threat is first seen: `t_0`.
    AtDetection,
    /// At the critical time: `t_c` of the paper, or the latest certified start of `turn-aware`.
    Latest,
    /// At `C_s` times that, `C_s` in [0, 1] (§3.3).
    Score(f64),
}

/// Which rule decides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Policy {
    /// Fly the mission, whatever comes.
    None,
    /// Algorithms 1–3 with the errata applied.
    Published(Start),
    /// Algorithms 1–3 as printed, for the errata page.
    PublishedLiteral,
    /// Round a static obstacle as in Fig. 8 and Algorithm 4.
    Circle,
    /// Predicts the turn that will be flown and certifies the separation.
    TurnAware(Start),
}

/// Settings of an [`Avoider`](super::Avoider).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The rule.
    pub policy: Policy,
    /// Time from one step to the next, seconds; manoeuvres begin at steps.
    pub decision_period_s: f64,
    /// Surveillance radius R, metres: obstacles farther away are not considered; infinity allowed.
    pub surveillance_radius_m: f64,
    /// How far ahead separation is certified, seconds.
    pub horizon_s: f64,
    /// Kept beyond the protected volume, metres.
    pub margin_m: f64,
    /// How many standard deviations of an obstacle's uncertainty widen its volume.
    pub confidence_sigmas: f64,
    /// Cost of a change of course `η_ψ`, per radian (Table 4).
    pub heading_cost: f64,
    /// Cost of a change of climb angle `η_θ`, per radian (Table 4).
    pub pitch_cost: f64,
    /// What the cheapest manoeuvre is.
    pub objective: Objective,
    /// Largest change of course of the published grid, radians (Table 7).
    pub grid_heading_range_rad: f64,
    /// Step of the published grid in course, radians.
    pub grid_heading_step_rad: f64,
    /// Step of the published grid in climb angle, radians; its range is the vehicle's.
    pub grid_pitch_step_rad: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            policy: Policy::TurnAware(Start::Free),
            decision_period_s: 0.1,
            surveillance_radius_m: 300.0,
            horizon_s: 60.0,
            margin_m: 0.05,
            confidence_sigmas: 3.0,
            heading_cost: 0.2,
            pitch_cost: 0.5,
            objective: Objective::PaperCost,
            grid_heading_range_rad: 135.0_f64.to_radians(),
            grid_heading_step_rad: 0.1,
            grid_pitch_step_rad: 0.03,
        }
    }
}

/// A setting that cannot be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettingsError {
    /// Name of the setting or limit.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// What was expected, in words.
    pub expected: &'static str,
}

impl core::fmt::Display for SettingsError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "{} is {}, expected {}",
            self.name, self.value, self.expected
        )
    }
}

impl core::error::Error for SettingsError {}

impl Settings {
    /// Checks every setting.
    ///
    /// # Errors
    /// The first setting that is not finite or out of range.
    pub fn check(&self) -> Result<(), SettingsError> {
        let positive = "a positive number";
        let not_negative = "a number that is not negative";
        let rows = [
            ("decision_period_s", self.decision_period_s, true, positive),
            ("horizon_s", self.horizon_s, true, positive),
            ("margin_m", self.margin_m, false, not_negative),
            (
                "confidence_sigmas",
                self.confidence_sigmas,
                false,
                not_negative,
            ),
            ("heading_cost", self.heading_cost, false, not_negative),
            ("pitch_cost", self.pitch_cost, false, not_negative),
            (
                "grid_heading_range_rad",
                self.grid_heading_range_rad,
                true,
                positive,
            ),
            (
                "grid_heading_step_rad",
                self.grid_heading_step_rad,
                true,
                positive,
            ),
            (
                "grid_pitch_step_rad",
                self.grid_pitch_step_rad,
                true,
                positive,
            ),
        ];
        for (name, value, strictly, expected) in rows {
            if !value.is_finite() || value < 0.0 || (strictly && value == 0.0) {
                return Err(SettingsError {
                    name,
                    value,
                    expected,
                });
            }
        }
        if self.surveillance_radius_m.is_nan() || self.surveillance_radius_m <= 0.0 {
            return Err(SettingsError {
                name: "surveillance_radius_m",
                value: self.surveillance_radius_m,
                expected: positive,
            });
        }
        if let Policy::Published(Start::Score(score)) | Policy::TurnAware(Start::Score(score)) =
            self.policy
            && !(0.0..=1.0).contains(&score)
        {
            return Err(SettingsError {
                name: "C_s",
                value: score,
                expected: "0 to 1",
            });
        }
        Ok(())
    }
}

/// Checks a vehicle's limits.
pub(super) fn check_vehicle(vehicle: &Vehicle) -> Result<(), SettingsError> {
    let response = vehicle.response;
    let positive = "a positive number";
    let rows = [
        (
            "airspeed_mps",
            vehicle.airspeed_mps,
            vehicle.airspeed_mps > 0.0,
            positive,
        ),
        (
            "turn_radius_m",
            vehicle.turn_radius_m,
            vehicle.turn_radius_m > 0.0,
            positive,
        ),
        (
            "climb_min_rad",
            vehicle.climb_min_rad,
            vehicle.climb_min_rad > -FRAC_PI_2 && vehicle.climb_min_rad <= 0.0,
            "an angle from -pi/2 to 0",
        ),
        (
            "climb_max_rad",
            vehicle.climb_max_rad,
            vehicle.climb_max_rad < FRAC_PI_2 && vehicle.climb_max_rad >= 0.0,
            "an angle from 0 to pi/2",
        ),
        (
            "climb_rate_radps",
            vehicle.climb_rate_radps,
            vehicle.climb_rate_radps >= 0.0,
            "a number that is not negative",
        ),
        (
            "dead_time_s",
            response.dead_time_s,
            response.dead_time_s >= 0.0,
            "a number that is not negative",
        ),
        (
            "bank_time_constant_s",
            response.bank_time_constant_s,
            response.bank_time_constant_s >= 0.0,
            "a number that is not negative",
        ),
        (
            "turn_rate_factor",
            response.turn_rate_factor,
            response.turn_rate_factor > 0.0,
            positive,
        ),
    ];
    for (name, value, in_range, expected) in rows {
        if !in_range || !value.is_finite() {
            return Err(SettingsError {
                name,
                value,
                expected,
            });
        }
    }
    Ok(())
}
