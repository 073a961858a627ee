//! Encounters of some cells flown by some policies, in memory.

use std::path::Path;

use fga_report::interval::Estimate;
use fga_sim::campaign::{Campaign, Configuration, Flyer, Summary, Totals};
use rayon::prelude::*;

use super::Setting;
use crate::common::interrupted;
use crate::failure::Failure;

/// What came of them.
pub(super) struct Flights {
    /// Counts.
    pub(super) summary: Summary,
    /// Mean time of a whole flight of each policy, seconds.
    pub(super) mean_s: Vec<f64>,
    cells: Vec<String>,
}

/// Flies `setting.encounters` encounters of each cell by each policy.
pub(super) fn fly(
    setting: &Setting<'_>,
    cells: &[String],
    policies: &[&str],
    oracle: bool,
) -> Result<Flights, Failure> {
    let configuration = Configuration {
        name: "reproduce".into(),
        version: env!("CARGO_PKG_VERSION").into(),
        encounters: setting.encounters * cells.len() as u64,
        block: 256,
        seeds: vec![setting.seed],
        policies: policies.iter().map(|&policy| policy.to_owned()).collect(),
        horizon_s: 60.0,
        oracle,
        cells: cells.to_vec(),
        files: Vec::new(),
        vehicle: None,
        vehicle_sha256: String::new(),
    };
    let campaign = Campaign::new(configuration, Path::new("reproduce"))?;
    let flown = (0..campaign.configuration.encounters)
        .into_par_iter()
        .map_init(
            || Flyer::new(&campaign),
            |flyer, number| {
                let mut rows = Vec::with_capacity(policies.len());
                if interrupted() {
                    return Err(Failure::Interrupted);
                }
                match flyer {
                    Ok(flyer) => flyer.fly(number, &mut rows)?,
                    Err(error) => return Err(Failure::Input(error.to_string())),
                }
                Ok(rows)
            },
        )
        .collect::<Result<Vec<_>, Failure>>()?;
    let mut summary = Summary::default();
    let mut mean_s = vec![0.0; policies.len()];
    for row in flown.iter().flatten() {
        summary.take(&row.row);
        if let Some(mean_s) = mean_s.get_mut(row.row.policy as usize) {
            *mean_s += row.flight_ns as f64 * 1e-9 / flown.len() as f64;
        }
    }
    Ok(Flights {
        summary,
        mean_s,
        cells: cells.to_vec(),
    })
}

impl Flights {
    /// Totals of a policy in a cell.
    pub(super) fn totals(&self, policy: usize, cell: usize) -> Option<&Totals> {
        self.summary
            .sources()
            .find(|(p, source, _)| *p as usize == policy && *source as usize == cell)
            .map(|(_, _, totals)| totals)
    }

    /// Share kept separated by a policy in a cell.
    pub(super) fn separated(&self, policy: usize, cell: usize) -> Option<Estimate> {
        let totals = self.totals(policy, cell)?;
        Estimate::wilson(totals.separated, totals.encounters)
    }

    /// Share that the oracle keeps separated in a cell.
    pub(super) fn avoidable(&self, cell: usize) -> Option<Estimate> {
        let totals = self.totals(0, cell)?;
        Estimate::wilson(totals.avoidable, totals.asked)
    }

    /// The cells.
    pub(super) fn cells(&self) -> &[String] {
        &self.cells
    }
}
