//! What the standards say of a recording or a situation: `fga alerts` and `fga bands`.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, TryLockError};

use fga::Vec3;
use fga::situation::Ownship;
use fga_alerts::{
    Aircraft, AircraftId, AircraftState, ManeuverSide, Monitor, Quantity, Region, Resolution,
    StepError,
};
use fga_formats::InputError;
use fga_formats::conf::{self, Configuration};
use fga_formats::daa::instants::{self, Instants};
use fga_formats::daa::tables::{DaaTables, watch};
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::input;
use crate::situation::PySituation;
use crate::table::{ArrayColumn, PyTable};

/// What a band or a value of it meets, as files say it.
const fn region_word(region: Option<Region>) -> &'static str {
    match region {
        None => "unknown",
        Some(Region::None) => "none",
        Some(Region::Far) => "far",
        Some(Region::Mid) => "mid",
        Some(Region::Near) => "near",
        Some(Region::Recovery) => "recovery",
    }
}

/// The quantity's name, with the unit of its values.
const fn quantity_word(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Direction => "direction_rad",
        Quantity::HorizontalSpeed => "horizontal_speed_mps",
        Quantity::VerticalSpeed => "vertical_speed_mps",
        Quantity::Altitude => "altitude_m",
    }
}

fn read(recording: &Path, config: &Path) -> Result<(Instants, Configuration), InputError> {
    let (recorded, configuration) = (instants::read(recording)?, conf::read(config)?);
    if recorded.names.len() < 2 {
        return Err(InputError::in_file(
            recording,
            "holds one aircraft only, expected the ownship and at least one more",
        ));
    }
    Ok((recorded, configuration))
}

/// Says which alert levels a DAIDALUS configuration gives a recording: `fga alerts`.
///
/// One row for each time and intruder: `time_s, ownship, traffic, alerter, level`, and `violation_s`, when the
/// volume of the level begins. `to_csv` gives the bytes of alerts.csv. Raises ValueError with the program's sentence.
#[pyfunction]
pub(crate) fn alerts(py: Python<'_>, recording: PathBuf, config: PathBuf) -> PyResult<PyTable> {
    #[derive(Default)]
    struct Rows {
        time_s: Vec<f64>,
        ownship: Vec<String>,
        traffic: Vec<String>,
        alerter: Vec<u64>,
        level: Vec<u64>,
        violation_s: Vec<Option<f64>>,
    }
    let (rows, csv) = py
        .detach(|| {
            let (recorded, configuration) = read(&recording, &config)?;
            let tables = DaaTables {
                recording: &recorded,
                configuration: &configuration,
            };
            let mut csv = tables.alerts_head();
            let mut rows = Rows::default();
            let name = |aircraft: usize| recorded.names.get(aircraft).cloned().unwrap_or_default();
            watch(&recorded, &configuration, |monitor, scene| {
                tables.alerts_rows(monitor, scene, &mut csv);
                for (index, (seen, alert)) in scene.traffic.iter().zip(monitor.alerts()).enumerate()
                {
                    let Some(alerter) = alert.alerter else {
                        continue;
                    };
                    let level = alert.level.unwrap_or(0);
                    rows.time_s.push(scene.time_s);
                    rows.ownship.push(name(scene.ownship.aircraft));
                    rows.traffic.push(name(seen.aircraft));
                    rows.alerter.push(alerter as u64 + 1);
                    rows.level.push(level as u64);
                    let violation = (level > 0)
                        .then(|| monitor.violation(index, level))
                        .flatten();
                    rows.violation_s.push(violation.map(|loss| loss.entry_s));
                }
            })
            .map_err(|message| InputError::in_file(&recording, message))?;
            Ok::<_, InputError>((rows, csv))
        })
        .map_err(input)?;
    let table = PyTable::of(vec![
        ("time_s", ArrayColumn::Real(rows.time_s)),
        ("ownship", ArrayColumn::Text(rows.ownship)),
        ("traffic", ArrayColumn::Text(rows.traffic)),
        ("alerter", ArrayColumn::Whole(rows.alerter)),
        ("level", ArrayColumn::Whole(rows.level)),
        ("violation_s", ArrayColumn::MaybeReal(rows.violation_s)),
    ])?;
    Ok(table.with_csv(csv.into_bytes()))
}

/// Says which maneuvers meet a conflict in a recording, as bands: `fga bands`.
///
/// One row for each time, quantity and band: `time_s, quantity, low, high, region`, in the unit that the quantity
/// names; directions are clockwise from north. `to_csv` gives the bytes of bands.out.
#[pyfunction]
pub(crate) fn bands(py: Python<'_>, recording: PathBuf, config: PathBuf) -> PyResult<PyTable> {
    let (rows, text) = py
        .detach(|| {
            let (recorded, configuration) = read(&recording, &config)?;
            let tables = DaaTables {
                recording: &recorded,
                configuration: &configuration,
            };
            let mut text = DaaTables::bands_head(&recording.display().to_string());
            let mut rows = Vec::new();
            watch(&recorded, &configuration, |monitor, scene| {
                tables.bands_text(monitor, scene, &mut text);
                for quantity in Quantity::ALL {
                    let bands = monitor.bands(quantity).bands();
                    rows.extend(bands.iter().map(|band| (scene.time_s, quantity, *band)));
                }
            })
            .map_err(|message| InputError::in_file(&recording, message))?;
            Ok::<_, InputError>((rows, text))
        })
        .map_err(input)?;
    let table = PyTable::of(vec![
        (
            "time_s",
            ArrayColumn::Real(rows.iter().map(|row| row.0).collect()),
        ),
        (
            "quantity",
            ArrayColumn::Text(rows.iter().map(|row| quantity_word(row.1).into()).collect()),
        ),
        (
            "low",
            ArrayColumn::Real(rows.iter().map(|row| row.2.low).collect()),
        ),
        (
            "high",
            ArrayColumn::Real(rows.iter().map(|row| row.2.high).collect()),
        ),
        (
            "region",
            ArrayColumn::Text(
                rows.iter()
                    .map(|row| region_word(row.2.region).into())
                    .collect(),
            ),
        ),
    ])?;
    Ok(table.with_csv(text.into_bytes()))
}

/// Alert levels and bands over time, as a DAIDALUS configuration defines them.
///
/// `step` takes the situations that an `Avoider` takes. Wind is taken out; directions are clockwise from north.
/// One monitor serves one aircraft and one thread at a time.
#[pyclass(name = "Monitor", frozen, module = "fga")]
pub(crate) struct PyMonitor(Mutex<Monitor>);

/// A state as the standards' side takes it: through the air.
fn state(position_m: Vec3, velocity_mps: Vec3) -> AircraftState {
    AircraftState {
        position_m,
        velocity_mps,
    }
}

fn through_the_air(own: &Ownship) -> Vec3 {
    let level_mps = own.airspeed_mps * own.climb_rad.cos();
    Vec3::new(
        level_mps * own.course_rad.cos(),
        level_mps * own.course_rad.sin(),
        own.airspeed_mps * own.climb_rad.sin(),
    )
}

#[pymethods]
impl PyMonitor {
    #[new]
    fn new(py: Python<'_>, config: PathBuf) -> PyResult<Self> {
        let configuration = py.detach(|| conf::read(&config)).map_err(input)?;
        Ok(Self(Mutex::new(Monitor::new(configuration.settings))))
    }

    /// Takes the aircraft of one time; the alert level of each obstacle by its identifier, 0 for none.
    ///
    /// Raises ValueError for an identifier that is there twice.
    fn step<'py>(
        &self,
        py: Python<'py>,
        situation: &Bound<'py, PySituation>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let situation = situation.get();
        let levels = py.detach(|| -> PyResult<Vec<_>> {
            let mut monitor = self.locked()?;
            situation.with(|situation| {
                let own = &situation.ownship;
                // The ownship has an identifier that no obstacle can have.
                let ownship = Aircraft::new(
                    AircraftId(u64::MAX),
                    state(own.position_m, through_the_air(own)),
                );
                let traffic: Vec<Aircraft> = situation
                    .obstacles
                    .iter()
                    .map(|obstacle| {
                        let velocity_mps = obstacle.velocity_mps - situation.wind_mps;
                        let state = state(obstacle.position_m, velocity_mps);
                        Aircraft::new(AircraftId(u64::from(obstacle.id)), state)
                    })
                    .collect();
                monitor
                    .step(situation.time_s, &ownship, &traffic)
                    .map_err(|error: StepError| PyValueError::new_err(error.to_string()))?;
                let levels = traffic.iter().zip(monitor.alerts());
                Ok(levels
                    .map(|(aircraft, alert)| (aircraft.id.0, alert.level.unwrap_or(0)))
                    .collect::<Vec<_>>())
            })
        })?;
        let shown = PyDict::new(py);
        for (id, level) in levels {
            shown.set_item(id, level)?;
        }
        Ok(shown)
    }

    /// The highest level of the last step.
    #[getter]
    fn highest_level(&self) -> PyResult<usize> {
        Ok(self.locked()?.highest_level())
    }

    /// The bands of the last step, in growing order: (low, high, region). `quantity` is direction_rad,
    /// horizontal_speed_mps, vertical_speed_mps or altitude_m.
    #[pyo3(signature = (quantity = "direction_rad"))]
    fn bands(&self, quantity: &str) -> PyResult<Vec<(f64, f64, &'static str)>> {
        let quantity = quantity_of(quantity)?;
        let monitor = self.locked()?;
        let bands = monitor.bands(quantity).bands().iter();
        Ok(bands
            .map(|band| (band.low, band.high, region_word(band.region)))
            .collect())
    }

    /// The nearest values of a quantity without conflict, to the left or below and to the right or above; None
    /// where none is needed or there is none.
    #[pyo3(signature = (quantity = "direction_rad"))]
    fn resolutions(&self, quantity: &str) -> PyResult<(Option<f64>, Option<f64>)> {
        let quantity = quantity_of(quantity)?;
        let monitor = self.locked()?;
        let of = |way| match monitor.bands(quantity).resolution(way) {
            Resolution::Value(value) => Some(value),
            Resolution::Unneeded | Resolution::Unavailable => None,
        };
        Ok((of(ManeuverSide::Low), of(ManeuverSide::High)))
    }

    fn __repr__(&self) -> &'static str {
        "Monitor()"
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "a Monitor cannot be pickled: make one in each process from its configuration",
        ))
    }
}

impl PyMonitor {
    fn locked(&self) -> PyResult<MutexGuard<'_, Monitor>> {
        match self.0.try_lock() {
            Ok(guard) => Ok(guard),
            // It is whole: the monitor does not panic.
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "another thread steps it now, expected one for each thread",
            )),
        }
    }
}

fn quantity_of(word: &str) -> PyResult<Quantity> {
    let found = Quantity::ALL
        .into_iter()
        .find(|quantity| quantity_word(*quantity) == word);
    found.ok_or_else(|| {
        let words = Quantity::ALL.map(quantity_word).join(", ");
        PyValueError::new_err(format!("quantity is {word:?}, expected one of {words}"))
    })
}
