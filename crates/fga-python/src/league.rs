//! Every policy over sets of encounters: `fga league`.

use core::sync::atomic::Ordering;
use std::path::PathBuf;

use fga_results::league::{Terms, checked_data, data_of_environment, run as fly};
use fga_sim::own::OwnPolicy;
use pyo3::prelude::*;

use crate::failure::{campaign as failed, input};
use crate::own::{LIMIT_S, own, warn_of_failures};
use crate::work::interruptible;

/// Flies policies over sets of encounters and writes one page: `fga league`.
///
/// `policies` are names, or policies of your own as in `fga.campaign`; without any, all built-in ones. `sets` are names of shipped
/// sets or campaign files; without any, all shipped ones whose data are in the folder `data` (without it `FGA_DATA`).
/// `intruders` are policies by which intruders with tracks react, each a set of its own beside the one without reactions. The folder
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
    let mut terms = Terms {
        sets,
        data: data
            .or_else(data_of_environment)
            .map(checked_data)
            .transpose()
            .map_err(input)?,
        encounters,
        worst,
        ..Terms::default()
    };
    let own_ones = &mut terms.own;
    let names = |given: &[Bound<'py, PyAny>], own_ones: &mut Vec<OwnPolicy>| {
        let names = given
            .iter()
            .map(|policy| named(policy, time_limit_s, own_ones));
        names.collect::<PyResult<Vec<String>>>()
    };
    let names_of_both = (names(&policies, own_ones)?, names(&intruders, own_ones)?);
    (terms.policies, terms.intruders) = names_of_both;
    let flown = interruptible(py, threads, progress, |shared| {
        fly(&terms, &out, &|| shared.goes_on(), &mut |_, _, progress| {
            shared.total.store(progress.total, Ordering::Relaxed);
            shared.done.store(progress.done, Ordering::Relaxed);
        })
    })?
    .map_err(failed)?;
    warn_of_failures(py, &flown.policies)?;
    py.import("json")?
        .call_method1("loads", (flown.rows.to_string(),))
}

/// The name of a policy; one of one's own joins the others once, for it may fly on both sides.
fn named(
    policy: &Bound<'_, PyAny>,
    time_limit_s: f64,
    own_ones: &mut Vec<OwnPolicy>,
) -> PyResult<String> {
    if let Ok(name) = policy.extract::<String>() {
        return Ok(name);
    }
    let own = own(policy, time_limit_s)?;
    let name = own.name().to_owned();
    if !own_ones.iter().any(|known| known.name() == name) {
        own_ones.push(own);
    }
    Ok(name)
}
