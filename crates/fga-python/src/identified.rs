//! Which aircraft a flight log shows: `fga identify`.

use std::path::PathBuf;

use fga_formats::InputError;
use fga_formats::flight_log::{self, COLUMNS};
use fga_sim::identification::{self, Identified};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::failure::input;
use crate::situation::numbers;
use crate::value::{properties, remade};

/// A figure with its interval: the middle 90 % of what windows of the log give.
#[pyclass(name = "Estimate", frozen, eq, module = "fga")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PyEstimate(identification::FigureEstimate);

#[pymethods]
impl PyEstimate {
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (f64, f64, f64))> {
        let identification::FigureEstimate { value, low, high } = self.0;
        Ok((remade(py, "_estimate")?, (value, low, high)))
    }

    fn __repr__(&self) -> String {
        let identification::FigureEstimate { value, low, high } = self.0;
        format!("Estimate({value:.4}, {low:.4} to {high:.4})")
    }
}

properties! { PyEstimate, this,
    /// The median.
    value: f64 = this.0.value;
    /// 5 % of the windows give less.
    low: f64 = this.0.low;
    /// 5 % of the windows give more.
    high: f64 = this.0.high;
}

/// What a flight log says about its aircraft.
#[pyclass(name = "Identified", frozen, eq, module = "fga")]
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PyIdentified(Identified);

#[pymethods]
impl PyIdentified {
    /// The text of a vehicle file. The protected volume is no property of the log.
    ///
    /// Raises ValueError for a radius or a half height that is not positive.
    #[pyo3(signature = (name, radius_m, half_height_m = None))]
    fn to_toml(&self, name: &str, radius_m: f64, half_height_m: Option<f64>) -> PyResult<String> {
        self.0
            .to_toml(name, radius_m, half_height_m)
            .map_err(PyValueError::new_err)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, IdentifiedParts)> {
        let estimates = [
            self.airspeed_mps(),
            self.max_bank_deg(),
            self.dead_time_s(),
            self.bank_time_constant_s(),
            self.turn_rate_factor(),
            self.climb_min_deg(),
            self.climb_max_deg(),
            self.climb_rate_radps(),
            self.position_error_m(),
        ];
        let parts = (estimates, self.windows(), self.windows_left_out());
        Ok((remade(py, "_identified")?, parts))
    }

    fn __repr__(&self) -> String {
        let figures: Vec<String> = self
            .0
            .figures()
            .iter()
            .map(|(key, estimate, decimals)| {
                let identification::FigureEstimate { value, low, high } = estimate;
                format!("{key}={value:.decimals$} ({low:.decimals$} to {high:.decimals$})")
            })
            .collect();
        format!("Identified({})", figures.join(", "))
    }
}

properties! { PyIdentified, this,
    /// Airspeed, metres per second.
    airspeed_mps: PyEstimate = PyEstimate(this.0.airspeed_mps);
    /// Steepest bank that is held, or mean bank of 3 s where none is held, degrees.
    max_bank_deg: PyEstimate = PyEstimate(this.0.max_bank_deg);
    /// Time before a command has any effect, seconds.
    dead_time_s: PyEstimate = PyEstimate(this.0.dead_time_s);
    /// Time constant of the first-order bank response, seconds.
    bank_time_constant_s: PyEstimate = PyEstimate(this.0.bank_time_constant_s);
    /// Course rate over that of the ideal coordinated turn.
    turn_rate_factor: PyEstimate = PyEstimate(this.0.turn_rate_factor);
    /// Steepest descent, degrees.
    climb_min_deg: PyEstimate = PyEstimate(this.0.climb_min_deg);
    /// Steepest climb, degrees.
    climb_max_deg: PyEstimate = PyEstimate(this.0.climb_max_deg);
    /// Rate at which the climb angle changes, radians per second.
    climb_rate_radps: PyEstimate = PyEstimate(this.0.climb_rate_radps);
    /// Horizontal distance from where the figures put the aircraft after 5 s, metres.
    position_error_m: PyEstimate = PyEstimate(this.0.position_error_m);
    /// Windows of the log in which the command moves and the bank follows it.
    windows: usize = this.0.windows;
    /// Windows in which the bank does not follow, which are left out.
    windows_left_out: usize = this.0.windows_left_out;
}

type IdentifiedParts = ([PyEstimate; 9], usize, usize);

/// The estimate that was pickled.
#[pyfunction]
pub(crate) fn _estimate(value: f64, low: f64, high: f64) -> PyEstimate {
    PyEstimate(identification::FigureEstimate { value, low, high })
}

/// What was pickled of a flight log.
#[pyfunction]
pub(crate) fn _identified(
    estimates: [PyRef<'_, PyEstimate>; 9],
    windows: usize,
    windows_left_out: usize,
) -> PyIdentified {
    let [
        airspeed_mps,
        max_bank_deg,
        dead_time_s,
        bank_time_constant_s,
        turn_rate_factor,
        climb_min_deg,
        climb_max_deg,
        climb_rate_radps,
        position_error_m,
    ] = estimates.map(|estimate| estimate.0);
    PyIdentified(Identified {
        airspeed_mps,
        max_bank_deg,
        dead_time_s,
        bank_time_constant_s,
        turn_rate_factor,
        climb_min_deg,
        climb_max_deg,
        climb_rate_radps,
        position_error_m,
        windows,
        windows_left_out,
    })
}

/// Says which aircraft a flight log shows: `fga identify`.
///
/// `log` is the path of a log (CSV, .tlog, .bin), or a mapping of its columns `t_s, airspeed_mps,
/// bank_command_rad, bank_rad, course_rad, climb_rad`. Raises ValueError for a log that cannot be used.
#[pyfunction]
pub(crate) fn identify(log: &Bound<'_, PyAny>) -> PyResult<PyIdentified> {
    let py = log.py();
    if let Ok(path) = log.extract::<PathBuf>() {
        return py
            .detach(|| {
                let log = flight_log::read(&path)?;
                identification::identify(&log)
                    .map_err(|message| InputError::in_file(&path, message))
            })
            .map(PyIdentified)
            .map_err(input);
    }
    if !log.hasattr("keys")? {
        return Err(PyTypeError::new_err(format!(
            "log is {}, expected the path of a log or a mapping of its columns",
            log.get_type()
        )));
    }
    let mut columns: [Vec<f64>; 6] = Default::default();
    for (column, name) in columns.iter_mut().zip(COLUMNS) {
        if !log.contains(name)? {
            return Err(PyValueError::new_err(format!(
                "the column {name} is missing, expected the columns {}",
                COLUMNS.join(",")
            )));
        }
        *column = numbers(name, &log.get_item(name)?)?;
    }
    py.detach(|| flight_log::from_columns(&columns).and_then(|log| identification::identify(&log)))
        .map(PyIdentified)
        .map_err(|message| PyValueError::new_err(format!("the log {message}")))
}
