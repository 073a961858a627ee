//! The likeliest failures of a policy: `fga stress`.

use std::path::PathBuf;

use fga::situation::Movement;
use fga_campaign::stress::{MOST_INTRUDERS, Stress};
use fga_results::stress::run as fly;
use fga_sim::vehicle_file::VehicleModel;
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;

use crate::failure::{campaign as failed, input};
use crate::own::{LIMIT_S, Policy, warn_of_failures};
use crate::pilot::model_of;
use crate::value::movement_of;
use crate::work::interruptible;

/// Searches the likeliest motions of intruders, and gusts, in which a policy fails: `fga stress`.
///
/// `policy` is a name or a policy of your own; `kind` is `uas` or `aircraft`; `gust_mps` is the standard deviation of each component
/// of a gust, without it the vehicle's `drift_mps`. The folder `out` gets stress.html, failures.csv,
/// stress.json and the replays; after Ctrl-C the same call goes on. Returns the content of stress.json.
#[pyfunction]
#[pyo3(signature = (
    out, policy = Policy::Default, vehicle = None, kind = "uas", flights = 2000, seed = 0, threads = None,
    time_limit_s = LIMIT_S, intruders = 1, gust_mps = None,
))]
#[expect(
    clippy::too_many_arguments,
    reason = "the options of the program, by name in Python"
)]
pub(crate) fn stress<'py>(
    py: Python<'py>,
    out: PathBuf,
    policy: Policy<'py>,
    vehicle: Option<&Bound<'py, PyAny>>,
    kind: &str,
    flights: usize,
    seed: u64,
    threads: Option<usize>,
    time_limit_s: f64,
    intruders: usize,
    gust_mps: Option<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let Movement::Aircraft(bounds) = movement_of(kind)? else {
        return Err(PyValueError::new_err(format!(
            "kind is {kind:?}, expected uas or aircraft"
        )));
    };
    if !(1..=1_000_000).contains(&flights) {
        return Err(PyValueError::new_err(format!(
            "flights is {flights}, expected 1 to 1000000"
        )));
    }
    if !(1..=MOST_INTRUDERS).contains(&intruders) {
        return Err(PyValueError::new_err(format!(
            "intruders is {intruders}, expected 1 to {MOST_INTRUDERS}"
        )));
    }
    if let Some(mps) = gust_mps.filter(|mps| !(0.0..=20.0).contains(mps)) {
        return Err(PyValueError::new_err(format!(
            "gust_mps is {mps}, expected 0 to 20"
        )));
    }
    let model = model_of(vehicle)?
        .map_or_else(VehicleModel::built_in, Ok)
        .map_err(input)?;
    let usual = Stress::of(model, policy.choice(time_limit_s)?, bounds);
    let stress = Stress {
        intruders,
        gust_mps: gust_mps.unwrap_or(usual.gust_mps),
        flights,
        seed,
        ..usual
    };
    let written = interruptible(py, threads, None, |shared| {
        fly(&stress, &out, &|| shared.goes_on(), &mut |_| ()).map_err(failed)
    })??;
    let document = written
        .ok_or_else(|| PyKeyboardInterrupt::new_err("stopped; the same call goes on"))?
        .document;
    warn_of_failures(py, [&stress.policy])?;
    py.import("json")?
        .call_method1("loads", (document.to_string(),))
}
