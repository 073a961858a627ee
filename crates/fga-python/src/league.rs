//! Every policy over sets of encounters: `fga league`.

use core::sync::atomic::Ordering;
use std::path::PathBuf;

use fga_results::league::{Terms, campaigns, checked_data, data_of_environment, run as fly};
use pyo3::prelude::*;

use crate::campaign::PyCampaign;
use crate::failure::{campaign as failed, input};
use crate::own::{LIMIT_S, Owns, Pickled, cloned, warn_of_failures};
use crate::work::interruptible;

/// Flies policies over sets of encounters and writes one page: `fga league`.
///
/// `policies` are names, or policies of your own as in `fga.campaign`; without any, all built-in ones. `sets` are names of shipped
/// sets or campaign files; without any, all shipped ones whose data are in the folder `data` (without it `FGA_DATA`).
/// `intruders` are policies by which intruders with tracks react, each a set of its own beside the one without reactions; `itself` stands
/// for the policy of the ownship. The folder
/// `out` gets league.html, league.parquet, league.csv, and the campaign of each set and policy. What is complete there is not
/// flown again. Returns the standings, one dict for each set and policy.
#[pyfunction]
#[pyo3(signature = (
    out, policies = Vec::new(), sets = Vec::new(), data = None, encounters = None, worst = 3, threads = None,
    progress = None, time_limit_s = LIMIT_S, intruders = Vec::new(),
))]
#[expect(
    clippy::too_many_arguments,
    reason = "the options of the program, by name in Python"
)]
pub(crate) fn league<'py>(
    py: Python<'py>,
    out: PathBuf,
    policies: Vec<Bound<'py, PyAny>>,
    sets: Vec<String>,
    data: Option<PathBuf>,
    encounters: Option<u64>,
    worst: usize,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
    time_limit_s: f64,
    intruders: Vec<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let (mut terms, _) = told(&policies, sets, data, encounters, &intruders, time_limit_s)?;
    terms.worst = worst;
    let flown = interruptible(py, threads, progress, |shared| {
        fly(&terms, &out, &|| shared.goes_on(), &mut |_, _, progress| {
            shared.total.store(progress.total, Ordering::Relaxed);
            shared.done.store(progress.done, Ordering::Relaxed);
        })
    })?
    .map_err(failed)?;
    warn_of_failures(py, &flown.own)?;
    py.import("json")?
        .call_method1("loads", (flown.rows.to_string(),))
}

/// The campaigns of a league for `fga.ray`: the folder of each below `out`, and the campaign.
#[pyfunction]
#[pyo3(signature = (
    out, policies = Vec::new(), sets = Vec::new(), data = None, encounters = None, time_limit_s = LIMIT_S,
    intruders = Vec::new(),
))]
#[expect(
    clippy::too_many_arguments,
    reason = "the options of the program, by name in Python"
)]
pub(crate) fn _league_campaigns<'py>(
    py: Python<'py>,
    out: PathBuf,
    policies: Vec<Bound<'py, PyAny>>,
    sets: Vec<String>,
    data: Option<PathBuf>,
    encounters: Option<u64>,
    time_limit_s: f64,
    intruders: Vec<Bound<'py, PyAny>>,
) -> PyResult<Vec<(String, PyCampaign)>> {
    let (terms, pickled) = told(&policies, sets, data, encounters, &intruders, time_limit_s)?;
    let found = py
        .detach(|| campaigns(&terms, &out))
        .map_err(failed)?
        .into_iter();
    Ok(found
        .map(|one| {
            let own = cloned(py, &pickled);
            (one.place, PyCampaign::of(one.campaign, own, time_limit_s))
        })
        .collect())
}

/// The terms, and the policies of one's own.
fn told(
    policies: &[Bound<'_, PyAny>],
    sets: Vec<String>,
    data: Option<PathBuf>,
    encounters: Option<u64>,
    intruders: &[Bound<'_, PyAny>],
    time_limit_s: f64,
) -> PyResult<(Terms, Vec<Pickled>)> {
    let mut terms = Terms {
        sets,
        data: data
            .or_else(data_of_environment)
            .map(checked_data)
            .transpose()
            .map_err(input)?,
        encounters,
        ..Terms::default()
    };
    let mut owns = Owns::default();
    for policy in policies {
        terms.policies.push(owns.named(policy, time_limit_s)?);
    }
    for policy in intruders {
        terms.intruders.push(owns.named(policy, time_limit_s)?);
    }
    terms.own = owns.policies;
    Ok((terms, owns.pickled))
}
