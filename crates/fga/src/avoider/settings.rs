//! Settings of the avoider.

use crate::limit::SettingsError;
use crate::search::Objective;

/// The start of a certified or chosen manoeuvre.
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
    /// The start of a manoeuvre.
    pub start: Start,
    /// Time from one step to the next, seconds; manoeuvres begin at steps.
    pub decision_period_s: f64,
    /// Surveillance radius R, metres: obstacles farther away are not considered; infinity, the default, considers all.
    pub surveillance_radius_m: f64,
    /// Horizon of the certificate, seconds.
    pub horizon_s: f64,
    /// Distance kept beyond the protected volume, metres.
    pub margin_m: f64,
    /// Standard deviation of the velocity with which gusts and the autopilot carry the aircraft off its prediction,
    /// as known beforehand, metres per second; 0 for an ideal aircraft. The avoider measures it in flight too, takes the
    /// larger one, and keeps more clear for it where there is room.
    pub drift_mps: f64,
    /// Standard deviations of an obstacle's uncertainty that widen its volume.
    pub confidence_sigmas: f64,
    /// Cost of a change of course `η_ψ`, per radian (Table 4).
    pub heading_cost: f64,
    /// Cost of a change of climb angle `η_θ`, per radian (Table 4).
    pub pitch_cost: f64,
    /// What the cheapest manoeuvre is.
    pub objective: Objective,
    /// Price of a loss of a protected volume, in metres of departure from the mission, where a [`BeliefAvoider`](super::belief::BeliefAvoider) weighs
    /// chances.
    pub loss_price_m: f64,
    /// Most work of one step, in tests of a line against four obstacles, some 12 to 25 ns each on a
    /// desktop processor. The unit covers everything whose length depends on the input, and no step exceeds the limit:
    /// a step near it answers with the best that it found, and the next one continues with other manoeuvres. Work is refused
    /// rather than done beyond the limit, and nothing is certified that lacks refused work.
    /// Only reading obstacles is never refused: half a unit for each, up to nine for each that replaces one of 128 tracked ones,
    /// nothing in a step whose way ahead is clear at once. Half of the limit is kept for it, so only thousands of obstacles may
    /// exceed the default limit, and hundreds the least one.
    pub work_limit: u32,
}

/// Least [`Settings::work_limit`]: a corner of the mission, reading 128 obstacles, and one short search among a few.
pub const LEAST_WORK: u32 = 10_000;

impl Default for Settings {
    fn default() -> Self {
        Self {
            start: Start::Free,
            decision_period_s: 0.1,
            surveillance_radius_m: f64::INFINITY,
            horizon_s: 60.0,
            margin_m: 0.05,
            drift_mps: 0.0,
            confidence_sigmas: 3.0,
            heading_cost: 0.2,
            pitch_cost: 0.5,
            objective: Objective::PaperCost,
            loss_price_m: fga_choice::price::LOSS_M,
            work_limit: 100_000,
        }
    }
}

impl Settings {
    /// Checks every setting.
    ///
    /// Ranges: decision period 1 ms to 10 s, horizon 1 s to 600 s, margin up to 10 km, drift up to 100 m/s, confidence up to 10
    /// standard deviations, costs up to 10⁶ per radian, price of a loss 100 m to 10,000 km, work limit from [`LEAST_WORK`].
    ///
    /// # Errors
    /// The first setting that is not finite or out of range.
    pub fn check(&self) -> Result<(), SettingsError> {
        let cost = (0.0, 1e6, "0 to a million");
        let rows = [
            (
                "decision_period_s",
                self.decision_period_s,
                (1e-3, 10.0, "0.001 to 10"),
            ),
            ("horizon_s", self.horizon_s, (1.0, 600.0, "1 to 600")),
            ("margin_m", self.margin_m, (0.0, 1e4, "0 to 10,000")),
            ("drift_mps", self.drift_mps, (0.0, 100.0, "0 to 100")),
            (
                "confidence_sigmas",
                self.confidence_sigmas,
                (0.0, 10.0, "0 to 10"),
            ),
            ("heading_cost", self.heading_cost, cost),
            ("pitch_cost", self.pitch_cost, cost),
            (
                "loss_price_m",
                self.loss_price_m,
                (100.0, 1e7, "100 to 10,000,000"),
            ),
            (
                "work_limit",
                f64::from(self.work_limit),
                (f64::from(LEAST_WORK), 1e9, "10,000 or more"),
            ),
        ];
        for (name, value, (low, high, expected)) in rows {
            SettingsError::unless((low..=high).contains(&value), name, value, expected)?;
        }
        let (radius_m, positive) = (self.surveillance_radius_m, "a positive number");
        SettingsError::unless(radius_m > 0.0, "surveillance_radius_m", radius_m, positive)?;
        self.start.check()
    }
}
