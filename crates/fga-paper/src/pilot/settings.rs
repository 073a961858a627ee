//! Settings of the paper's pilot.

use fga::avoider::{SettingsError, Start};

/// The rule of the paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// Algorithms 1–3 with the errata applied; a free start counts as `t_0`.
    Corrected(Start),
    /// Algorithms 1–3 as printed, for the errata page.
    AsPrinted,
    /// Round a static obstacle as in Fig. 8 and Algorithm 4.
    Circle,
}

/// The grid of directions of Algorithm 2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridSteps {
    /// Largest change of course, radians (Table 7).
    pub heading_range_rad: f64,
    /// Step in course, radians.
    pub heading_step_rad: f64,
    /// Step in climb angle, radians; its range is the vehicle's.
    pub pitch_step_rad: f64,
}

impl Default for GridSteps {
    fn default() -> Self {
        Self {
            heading_range_rad: 135.0_f64.to_radians(),
            heading_step_rad: 0.1,
            pitch_step_rad: 0.03,
        }
    }
}

/// Settings of a [`PaperPilot`](super::PaperPilot).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaperSettings {
    /// The rule.
    pub rule: Rule,
    /// Time from one step to the next, seconds; manoeuvres begin at steps.
    pub decision_period_s: f64,
    /// Surveillance radius R, metres: obstacles farther away are not considered; infinity allowed.
    pub surveillance_radius_m: f64,
    /// How far ahead the mission's corners are seen and obstacles are kept, seconds.
    pub horizon_s: f64,
    /// Distance kept beyond the protected volume, metres.
    pub margin_m: f64,
    /// Standard deviations of an obstacle's uncertainty that the way back keeps clear of.
    pub confidence_sigmas: f64,
    /// Factor by which the vehicle may turn faster than planned, 1 for a known turn rate. A plan uses a slightly low
    /// turn rate, which would make the circle round an obstacle too tight.
    pub turn_rate_excess: f64,
    /// Cost of a change of course `η_ψ`, per radian (Table 4).
    pub heading_cost: f64,
    /// Cost of a change of climb angle `η_θ`, per radian (Table 4).
    pub pitch_cost: f64,
    /// The directions that Algorithm 2 compares.
    pub grid: GridSteps,
}

impl PaperSettings {
    /// The settings of Table 4.
    pub fn new(rule: Rule) -> Self {
        let core = fga::avoider::Settings::default();
        Self {
            rule,
            decision_period_s: core.decision_period_s,
            surveillance_radius_m: 300.0,
            horizon_s: core.horizon_s,
            margin_m: core.margin_m,
            confidence_sigmas: core.confidence_sigmas,
            turn_rate_excess: 1.0,
            heading_cost: core.heading_cost,
            pitch_cost: core.pitch_cost,
            grid: GridSteps::default(),
        }
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// The first setting that is not finite or out of range.
    pub fn check(&self) -> Result<(), SettingsError> {
        let (positive, not_negative) = ("a positive number", "a number that is not negative");
        let grid = &self.grid;
        let above_zero = [
            ("decision_period_s", self.decision_period_s),
            ("horizon_s", self.horizon_s),
            ("turn_rate_excess", self.turn_rate_excess),
            ("grid_heading_range_rad", grid.heading_range_rad),
            ("grid_heading_step_rad", grid.heading_step_rad),
            ("grid_pitch_step_rad", grid.pitch_step_rad),
        ];
        for (name, value) in above_zero {
            SettingsError::unless(value > 0.0 && value.is_finite(), name, value, positive)?;
        }
        let from_zero = [
            ("margin_m", self.margin_m),
            ("confidence_sigmas", self.confidence_sigmas),
            ("heading_cost", self.heading_cost),
            ("pitch_cost", self.pitch_cost),
        ];
        for (name, value) in from_zero {
            SettingsError::unless(value >= 0.0 && value.is_finite(), name, value, not_negative)?;
        }
        let radius_m = self.surveillance_radius_m;
        SettingsError::unless(radius_m > 0.0, "surveillance_radius_m", radius_m, positive)?;
        match self.rule {
            Rule::Corrected(start) => start.check(),
            Rule::AsPrinted | Rule::Circle => Ok(()),
        }
    }
}
