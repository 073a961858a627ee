//! The decision settings of a vehicle file.

use fga::avoider::Settings;
use fga_belief::Errors;
use fga_paper::pilot::{GridSteps, PaperSettings, Rule};

/// The decision settings of a vehicle file; every policy takes its part.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PolicySettings {
    /// Settings of the avoider, also used by the other policies; the policy sets the start.
    pub avoider: Settings,
    /// The grid of the paper's Algorithm 2.
    pub grid: GridSteps,
    /// Errors of the reports of other aircraft, for policies that take reports.
    pub errors: Errors,
}

impl PolicySettings {
    /// The settings of the paper's pilot.
    pub(crate) fn of_paper(&self, rule: Rule) -> PaperSettings {
        let avoider = &self.avoider;
        PaperSettings {
            rule,
            decision_period_s: avoider.decision_period_s,
            surveillance_radius_m: avoider.surveillance_radius_m,
            horizon_s: avoider.horizon_s,
            margin_m: avoider.margin_m,
            confidence_sigmas: avoider.confidence_sigmas,
            heading_cost: avoider.heading_cost,
            pitch_cost: avoider.pitch_cost,
            grid: self.grid,
            ..PaperSettings::new(rule)
        }
    }
}
