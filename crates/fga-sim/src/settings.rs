//! What a vehicle file says about deciding.

use fga::avoider::Settings;
use fga_paper::pilot::{GridSteps, PaperSettings, Rule};

/// What a vehicle file says about deciding; every policy takes what it uses.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PolicySettings {
    /// Settings of the avoider, and of what the others have in common with it; the start is the
    /// policy's.
    pub avoider: Settings,
    /// The grid of the paper's Algorithm 2.
    pub grid: GridSteps,
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
