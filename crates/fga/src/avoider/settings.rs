//! How the avoider is set up.

use crate::limit::SettingsError;
use crate::search::Objective;

/// When a certified or chosen manoeuvre begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// Chosen with the manoeuvre for the least departure from the mission (turn-aware only).
    Free,
    /// At once, when the threat is first seen: `t_0`.
    AtDetection,
    /// At the critical time: `t_c` of the paper, or the latest certified start of `turn-aware`.
    Latest,
    /// At `C_s` times that, `C_s` in [0, 1] (§3.3).
    Score(f64),
}

impl Start {
    /// Checks the score.
    ///
    /// # Errors
    /// A score that is not in [0, 1].
    pub fn check(&self) -> Result<(), SettingsError> {
        match *self {
            Self::Free | Self::AtDetection | Self::Latest => Ok(()),
            Self::Score(score) => {
                SettingsError::unless((0.0..=1.0).contains(&score), "C_s", score, "0 to 1")
            }
        }
    }
}

/// Settings of an [`Avoider`](super::Avoider).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// When a maneuver begins.
    pub start: Start,
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
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            start: Start::Free,
            decision_period_s: 0.1,
            surveillance_radius_m: 300.0,
            horizon_s: 60.0,
            margin_m: 0.05,
            confidence_sigmas: 3.0,
            heading_cost: 0.2,
            pitch_cost: 0.5,
            objective: Objective::PaperCost,
        }
    }
}

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
        ];
        for (name, value, strictly, expected) in rows {
            let in_range = if strictly { value > 0.0 } else { value >= 0.0 };
            SettingsError::unless(in_range && value.is_finite(), name, value, expected)?;
        }
        let radius_m = self.surveillance_radius_m;
        SettingsError::unless(radius_m > 0.0, "surveillance_radius_m", radius_m, positive)?;
        self.start.check()
    }
}
