//! Flies encounters of some cells under some policies, in memory.

use std::path::Path;

use fga_campaign::campaign::{
    Campaign, CampaignConfiguration, CampaignFlyer, Row, Summary, TimedRow, Totals,
};
use fga_report::interval::Estimate;
use rayon::prelude::*;

use crate::ReproduceError;
use crate::Setting;

/// The end of the name of a cell whose obstacles all stay at the aircraft's altitude.
pub(crate) const PLANAR: &str = ",planar";

/// Table 4's aircraft without climb.
const PLANAR_VEHICLE: &str = include_str!("../vehicles/paper-planar.toml");

/// The results.
pub(crate) struct Flights {
    /// The encounters.
    pub(crate) campaign: Campaign,
    /// Rows of each encounter, one for each policy.
    pub(crate) rows: Vec<Vec<Row>>,
    /// Counts.
    pub(crate) summary: Summary,
    /// Times of each policy.
    pub(crate) times: Vec<FlightTimes>,
}

/// The duration of the flights of one policy, means over the flights.
#[expect(
    clippy::struct_field_names,
    reason = "the unit, as everywhere in this project"
)]
#[derive(Clone, Copy, Default)]
pub(crate) struct FlightTimes {
    /// Of the whole flight, seconds.
    pub(crate) flight_s: f64,
    /// Of its median decision, seconds.
    pub(crate) median_s: f64,
    /// Of its longest decision, seconds.
    pub(crate) longest_s: f64,
}

/// Flies `setting.encounters` encounters of each cell under each policy, and asks the oracle. Either
/// all cells end in `,planar` or none; if all, the aircraft may not climb.
pub(crate) fn fly(
    setting: &Setting<'_>,
    cells: &[String],
    policies: &[&str],
) -> Result<Flights, ReproduceError> {
    let planar = cells.iter().any(|cell| cell.ends_with(PLANAR));
    let configuration = CampaignConfiguration {
        name: "reproduce".into(),
        version: env!("CARGO_PKG_VERSION").into(),
        encounters: setting.encounters * cells.len() as u64,
        block: 256,
        seeds: vec![setting.seed],
        policies: policies.iter().map(|&policy| policy.to_owned()).collect(),
        intruders: None,
        own_sha256: Vec::new(),
        horizon_s: 60.0,
        oracle: true,
        cells: cells.to_vec(),
        files: Vec::new(),
        recordings: Vec::new(),
        models: Vec::new(),
        damaged: Vec::new(),
        tally: fga_formats::tally::Tally::default(),
        sensors: Vec::new(),
        plant: fga_sim::plant::PlantDifference::NONE,
        vehicle: planar.then(|| PLANAR_VEHICLE.into()),
        vehicle_sha256: String::new(),
        events: Vec::new(),
    };
    let campaign = Campaign::new(configuration, Path::new("reproduce"))?;
    let flown = (0..campaign.configuration.encounters)
        .into_par_iter()
        .map_init(
            || CampaignFlyer::new(&campaign),
            |flyer, number| {
                let mut rows = Vec::with_capacity(policies.len());
                if !(setting.goes_on)() {
                    return Err(ReproduceError::Stopped);
                }
                match flyer {
                    Ok(flyer) => flyer.fly(number, &mut rows)?,
                    Err(error) => return Err(ReproduceError::of(&error)),
                }
                Ok(rows)
            },
        )
        .collect::<Result<Vec<_>, ReproduceError>>()?;
    let mut summary = Summary::default();
    let mut times = vec![FlightTimes::default(); policies.len()];
    let share_s = 1e-9 / flown.len() as f64;
    for flown in flown.iter().flatten() {
        summary.take(&flown.row);
        if let Some(times) = times.get_mut(flown.row.policy as usize) {
            times.flight_s += flown.flight_ns as f64 * share_s;
            times.median_s += flown.decision_median_ns as f64 * share_s;
            times.longest_s += flown.decision_max_ns as f64 * share_s;
        }
    }
    let only_rows = |flown: &Vec<TimedRow>| flown.iter().map(|flown| flown.row).collect();
    Ok(Flights {
        rows: flown.iter().map(only_rows).collect(),
        campaign,
        summary,
        times,
    })
}

impl Flights {
    /// Totals of a policy in a cell.
    pub(crate) fn totals(&self, policy: usize, cell: usize) -> Option<&Totals> {
        self.summary
            .sources()
            .find(|(p, source, _)| *p as usize == policy && *source as usize == cell)
            .map(|(_, _, totals)| totals)
    }

    /// Share kept separated by a policy in a cell.
    pub(crate) fn separated(&self, policy: usize, cell: usize) -> Option<Estimate> {
        let totals = self.totals(policy, cell)?;
        Estimate::wilson(totals.separated, totals.encounters)
    }

    /// Share that the oracle keeps separated in a cell.
    pub(crate) fn avoidable(&self, cell: usize) -> Option<Estimate> {
        let totals = self.totals(0, cell)?;
        Estimate::wilson(totals.avoidable, totals.asked)
    }

    /// The cells.
    pub(crate) fn cells(&self) -> &[String] {
        &self.campaign.configuration.cells
    }
}

/// Every method; the first one measures the cost of plant and measurement alone.
pub(crate) const METHODS: [&str; 10] = [
    "none",
    "published --start tc",
    "published --start t0",
    "turn-aware",
    "potential-field",
    "waypoint-greedy",
    "waypoint-optimal",
    "orca",
    "mvp",
    "velocity-obstacles",
];

/// Index of a method.
pub(crate) fn method(name: &str) -> usize {
    METHODS.iter().position(|m| *m == name).unwrap_or(0)
}
