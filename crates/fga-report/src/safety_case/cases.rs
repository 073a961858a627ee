//! The counted results on the page, and the thresholds beside them.

use crate::interval::Estimate;

/// A quoted threshold for a loss.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Threshold {
    /// Largest risk ratio.
    pub ratio: f64,
    /// The intruders that it applies to.
    pub intruders: &'static str,
}

/// Quoted thresholds for NMAC, cooperative and non-cooperative.
pub const NMAC_THRESHOLDS: [Threshold; 2] = [
    Threshold {
        ratio: 0.18,
        intruders: "cooperative",
    },
    Threshold {
        ratio: 0.30,
        intruders: "non-cooperative",
    },
];

/// Quoted thresholds for loss of well clear.
pub const LOWC_THRESHOLDS: [Threshold; 2] = [
    Threshold {
        ratio: 0.40,
        intruders: "cooperative",
    },
    Threshold {
        ratio: 0.50,
        intruders: "non-cooperative",
    },
];

/// How often a loss happens.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Lost {
    /// Encounters with the loss without avoidance.
    pub nominal: u64,
    /// Encounters with the loss as flown.
    pub flown: u64,
    /// Encounters with the loss only as flown.
    pub induced: u64,
    /// Weighted share of all encounters without avoidance.
    pub nominal_rate: f64,
    /// Weighted share as flown.
    pub rate: f64,
    /// Risk ratio; `None` without any loss in the flights without avoidance.
    pub ratio: Option<Estimate>,
    /// Encounters in the tail, and the ratio extrapolated from them.
    pub tail: Option<(u64, Estimate)>,
    /// The ratio after growing numbers of encounters.
    pub convergence: Vec<(u64, Estimate)>,
}

/// The results of one policy.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PolicyCase {
    /// Its name.
    pub policy: String,
    /// Near mid-air collisions.
    pub nmac: Lost,
    /// Losses of well clear of ASTM F3442.
    pub lowc: Lost,
    /// Losses of well clear of DO-365B en route.
    pub do365: Lost,
    /// Encounters with a manoeuvre, and how many of them stay well clear without it.
    pub acted: u64,
    /// Acted although nominally well clear.
    pub needless: u64,
    /// Nominally well clear.
    pub clear: u64,
    /// The track turned from going away to coming back, or the reverse, more than three times.
    pub restless: u64,
    /// Acted, and not back on its mission at the end.
    pub not_back: u64,
    /// Encounters in which a policy of one's own failed.
    pub failed: u64,
    /// Largest distances from the mission in encounters with a manoeuvre, metres.
    pub departures_m: Vec<f64>,
    /// Times off the mission in encounters with a manoeuvre, seconds.
    pub away_s: Vec<f64>,
    /// Leads of the first manoeuvre before the closest approach, seconds.
    pub action_leads_s: Vec<f64>,
    /// Severities of losses of well clear (DO-365B) as flown.
    pub severities: Vec<f64>,
    /// Least horizontal separations as flown, metres.
    pub horizontal_m: Vec<f64>,
}

/// A risk ratio of a class of encounters.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassCase {
    /// The policy.
    pub policy: String,
    /// The class.
    pub class: String,
    /// Encounters.
    pub encounters: u64,
    /// Near mid-air collisions.
    pub nmac: Lost,
    /// Losses of well clear.
    pub lowc: Lost,
}

/// An encounter to look at.
#[derive(Debug, Clone, PartialEq)]
pub struct WorstCase {
    /// The policy.
    pub policy: String,
    /// Number and name of the encounter.
    pub encounter: String,
    /// The fault.
    pub what: String,
    /// Least horizontal separation and the vertical one at that time, metres: without avoidance, as flown.
    pub separation_m: [Option<(f64, f64)>; 2],
    /// Path of its replay page.
    pub href: String,
}

/// The assumptions: names and values.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Assumed {
    /// Aircraft, volume, wind.
    pub conditions: Vec<(String, String)>,
    /// The sources of what the ownship knows.
    pub sensors: Vec<(String, String)>,
    /// The encounters and how they are judged.
    pub encounters: Vec<(String, String)>,
}

impl Assumed {
    /// All of them, in their order.
    pub fn all(&self) -> impl Iterator<Item = &(String, String)> {
        let [a, b, c] = [&self.conditions, &self.sensors, &self.encounters];
        a.iter().chain(b).chain(c)
    }
}
