//! The likeliest failures of a policy: `fga stress`.

use std::path::PathBuf;

use fga::situation::Movement;
use fga_results::stress::write;
use fga_sim::stress::{Stress, search};
use fga_sim::vehicle_file::VehicleModel;
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;

use crate::failure::{campaign as failed, input};
use crate::own::{LIMIT_S, Policy, warn_of_failures};
use crate::pilot::model_of;
use crate::value::movement_of;
use crate::work::interruptible;

/// Searches the likeliest motions of an intruder in which a policy fails: `fga stress`.
///
/// `policy` is a name or a policy of your own; `kind` is `uas` or `aircraft`. The folder `out` gets stress.html, failures.csv,
/// stress.json and the replays. Returns the content of stress.json.
#[pyfunction]
#[pyo3(signature = (
    out, policy = Policy::Default, vehicle = None, kind = "uas", flights = 2000, seed = 0, threads = None,
    time_limit_s = LIMIT_S,
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
    let stress = Stress {
        model: model_of(vehicle)?
            .map_or_else(VehicleModel::built_in, Ok)
            .map_err(input)?,
        policy: policy.choice(time_limit_s)?,
        bounds,
        flights,
        seed,
    };
    let document = interruptible(py, threads, None, |shared| {
        let found =
            search(&stress, &|| shared.goes_on(), &mut |_| ()).map_err(PyValueError::new_err)?;
        if !shared.goes_on() {
            return Err(PyKeyboardInterrupt::new_err("stopped"));
        }
        Ok(write(&stress, &found, &out).map_err(failed)?.document)
    })??;
    warn_of_failures(py, [&stress.policy])?;
    py.import("json")?
        .call_method1("loads", (document.to_string(),))
}
