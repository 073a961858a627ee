//! The result of one flown encounter.

use super::metrics::Metrics;
use crate::oracle::AVOIDABLE_MARGIN_M;

/// The result of one encounter under one policy. Lengths are rounded to a micrometre.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Row {
    /// Number of the encounter in the campaign.
    pub encounter: u64,
    /// Number in its file, else the same.
    pub source_encounter: u64,
    /// Master seed.
    pub seed: u64,
    /// Index of the source.
    pub source: u32,
    /// Index of the policy.
    pub policy: u32,
    /// Number of obstacles.
    pub obstacles: u32,
    /// Least margin with course and altitude held, metres.
    pub held_margin_m: f64,
    /// Whether the flight entered no volume.
    pub separated: bool,
    /// Whether the flight entered a volume that holding the course would not have entered.
    pub caused: bool,
    /// Least distance to the centre of an obstacle, metres.
    pub min_separation_m: f64,
    /// Least signed distance to a protected volume, metres.
    pub min_margin_m: f64,
    /// Start of the first manoeuvre, seconds.
    pub start_s: Option<f64>,
    /// End of the last manoeuvre, seconds.
    pub clear_s: Option<f64>,
    /// Time at which the aircraft was back on its line, seconds.
    pub rejoined_s: Option<f64>,
    /// End of the flight, seconds.
    pub end_s: f64,
    /// Largest distance from the line, metres.
    pub max_cross_track_m: f64,
    /// Path flown less progress along the line, metres.
    pub extra_path_m: f64,
    /// A margin that the oracle keeps, metres; its search ends when one is enough.
    pub oracle_margin_m: Option<f64>,
    /// Index of its name, if it has one.
    pub name: Option<u32>,
    /// Number of encounters of its source that it represents.
    pub weight: f64,
    /// Metrics of the standards.
    pub metrics: Metrics,
}

impl Row {
    /// Whether holding the course would have entered a volume.
    pub fn threatened(&self) -> bool {
        self.held_margin_m < 0.0
    }

    /// Whether the oracle saves it, if it was asked.
    pub fn avoidable(&self) -> Option<bool> {
        self.oracle_margin_m.map(|m| m >= AVOIDABLE_MARGIN_M)
    }

    /// Whether there was a manoeuvre although holding the course would have stayed clear.
    pub fn needless(&self) -> bool {
        self.start_s.is_some() && !self.threatened()
    }

    /// Time from the start of the first manoeuvre until the aircraft is back, or to the end, seconds.
    pub fn time_away_s(&self) -> Option<f64> {
        Some(self.rejoined_s.unwrap_or(self.end_s) - self.start_s?)
    }
}
