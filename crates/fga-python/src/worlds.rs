//! Many worlds side by side, for `fga.gym`, and the shield alone.

use std::sync::{Mutex, MutexGuard, TryLockError};

use fga::maneuver::Maneuver;
use fga_campaign::encounters::EncounterSource;
use fga_campaign::worlds::{Stepped, Worlds, WorldsSettings};
use fga_sim::shield::Shield;
use fga_sim::vehicle_file::VehicleModel;
use numpy::{PyArray1, PyArray2, PyArrayMethods as _, PyReadonlyArray2};
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::decision::PyDecision;
use crate::failure::input;
use crate::pilot::model_of;
use crate::settings::PySettings;
use crate::situation::PySituation;
use crate::value::{PyVehicle, refused};

/// Most obstacles seen in all worlds together: 360 MB of observations.
const MOST_SEEN: usize = 10_000_000;

/// The result of a step, one row per world: observations, rewards, terminated, truncated, engaged.
type StepArrays<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
);

/// Worlds side by side, stepped without the interpreter's lock; `fga.gym` makes environments of them.
#[pyclass(name = "Worlds", frozen, module = "fga")]
pub(crate) struct PyWorlds(Mutex<Worlds>);

impl PyWorlds {
    fn worlds(&self) -> PyResult<MutexGuard<'_, Worlds>> {
        match self.0.try_lock() {
            Ok(guard) => Ok(guard),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "another thread steps these worlds now, expected one for each thread",
            )),
        }
    }
}

#[pymethods]
impl PyWorlds {
    #[new]
    #[pyo3(signature = (cell, count, seed = 0, vehicle = None, horizon_s = 60.0, seen = 4, shielded = false))]
    fn new(
        cell: &str,
        count: usize,
        seed: u64,
        vehicle: Option<&Bound<'_, PyAny>>,
        horizon_s: f64,
        seen: usize,
        shielded: bool,
    ) -> PyResult<Self> {
        for (name, value, most) in [("count", count, 100_000), ("seen", seen, 1000)] {
            if !(1..=most).contains(&value) {
                return Err(PyValueError::new_err(format!(
                    "{name} is {value}, expected 1 to {most}"
                )));
            }
        }
        // Their observations are one array.
        if count * seen > MOST_SEEN {
            return Err(PyValueError::new_err(format!(
                "count is {count} and seen {seen}, expected a product of at most {MOST_SEEN}"
            )));
        }
        if !(horizon_s > 0.0 && horizon_s <= 86_400.0) {
            return Err(PyValueError::new_err(format!(
                "horizon_s is {horizon_s}, expected a positive number of seconds, at most 86400"
            )));
        }
        let settings = WorldsSettings {
            source: EncounterSource::parse(cell, seed).map_err(PyValueError::new_err)?,
            model: model_of(vehicle)?
                .map_or_else(VehicleModel::built_in, Ok)
                .map_err(input)?,
            horizon_s,
            seen,
            shielded,
        };
        Worlds::new(settings, count)
            .map(|worlds| Self(Mutex::new(worlds)))
            .map_err(|error| PyValueError::new_err(error.to_string()))
    }

    fn __len__(&self) -> PyResult<usize> {
        Ok(self.worlds()?.len())
    }

    /// Length of an observation.
    #[getter]
    fn observed(&self) -> PyResult<usize> {
        Ok(self.worlds()?.observed())
    }

    /// Loads encounters by their numbers into worlds by their indices.
    fn reset(&self, py: Python<'_>, places: Vec<usize>, numbers: Vec<u64>) -> PyResult<()> {
        let mut guard = self.worlds()?;
        let worlds = &mut *guard;
        if places.len() != numbers.len() {
            return Err(PyValueError::new_err(format!(
                "places has {} values and numbers {}, expected as many",
                places.len(),
                numbers.len()
            )));
        }
        let count = worlds.len();
        if let Some(place) = places.iter().find(|place| **place >= count) {
            return Err(PyValueError::new_err(format!(
                "places names world {place}, expected 0 to {}",
                count - 1
            )));
        }
        py.detach(|| {
            let mut pairs = places.into_iter().zip(numbers);
            pairs.try_for_each(|(place, number)| worlds.reset(place, number))
        })
        .map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// The observations of the worlds, one row each.
    fn observe<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let mut guard = self.worlds()?;
        let worlds = &mut *guard;
        let (count, width) = (worlds.len(), worlds.observed());
        let values = py.detach(|| observed(worlds));
        PyArray1::from_vec(py, values).reshape([count, width])
    }

    /// Flies one action in each world, an array of shape (worlds, 2), until the next decision; worlds in
    /// `held` stand still.
    #[pyo3(signature = (actions, held = None))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        actions: &Bound<'py, PyAny>,
        held: Option<Vec<bool>>,
    ) -> PyResult<StepArrays<'py>> {
        let mut guard = self.worlds()?;
        let worlds = &mut *guard;
        let (count, width) = (worlds.len(), worlds.observed());
        let actions: PyReadonlyArray2<'py, f64> = actions.extract().map_err(|_| {
            PyTypeError::new_err("actions is no array of float64 with 2 dimensions")
        })?;
        let actions = actions.as_array();
        if actions.dim() != (count, 2) {
            return Err(PyValueError::new_err(format!(
                "actions is of shape {:?}, expected ({count}, 2)",
                actions.dim()
            )));
        }
        let actions: Vec<(f64, f64)> = actions
            .rows()
            .into_iter()
            .map(|row| (row[0], row[1]))
            .collect();
        let held = held.unwrap_or_else(|| vec![false; count]);
        if held.len() != count {
            return Err(PyValueError::new_err(format!(
                "held has {} values, expected {count}",
                held.len()
            )));
        }
        let (steps, values) = py.detach(|| {
            let steps: Vec<_> = actions
                .into_iter()
                .zip(held)
                .enumerate()
                .map(|(index, ((turn, climb), held))| {
                    if held {
                        Stepped::STILL
                    } else {
                        worlds.step(index, turn, climb)
                    }
                })
                .collect();
            let values = observed(worlds);
            (steps, values)
        });
        let flags =
            |get: fn(&Stepped) -> bool| PyArray1::from_vec(py, steps.iter().map(get).collect());
        Ok((
            PyArray1::from_vec(py, values).reshape([count, width])?,
            PyArray1::from_vec(py, steps.iter().map(|step| step.reward).collect()),
            flags(|step| step.terminated),
            flags(|step| step.truncated),
            flags(|step| step.engaged),
        ))
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "Worlds cannot be pickled: make them in each process from their cell and seed",
        ))
    }
}

fn observed(worlds: &mut Worlds) -> Vec<f32> {
    let width = worlds.observed();
    let mut values = vec![0.0; worlds.len() * width];
    for (index, row) in values.chunks_exact_mut(width).enumerate() {
        worlds.observe(index, row);
    }
    values
}

/// Run-time assurance: any policy may fly as long as a certified way out remains.
///
/// `step(situation, stages)` gives the decision to fly and whether it is the shield's own. It passes the
/// stages while a certified manoeuvre exists at the end of their path to the next decision, and flies
/// the avoider instead otherwise.
#[pyclass(name = "Shield", frozen, module = "fga")]
pub(crate) struct PyShield(Mutex<Shield>);

impl PyShield {
    fn shield(&self) -> PyResult<MutexGuard<'_, Shield>> {
        match self.0.try_lock() {
            Ok(guard) => Ok(guard),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "another thread steps it now, expected one for each thread",
            )),
        }
    }
}

#[pymethods]
impl PyShield {
    #[new]
    #[pyo3(signature = (settings = None, vehicle = None))]
    fn new(
        settings: Option<&Bound<'_, PySettings>>,
        vehicle: Option<&Bound<'_, PyVehicle>>,
    ) -> PyResult<Self> {
        let settings = settings.map_or_else(Default::default, |settings| settings.get().0);
        let vehicle =
            vehicle.map_or_else(fga::vehicle::Vehicle::table_4, |vehicle| vehicle.get().0);
        Shield::new(settings, vehicle)
            .map(|shield| Self(Mutex::new(shield)))
            .map_err(refused)
    }

    /// Passes the wish of a policy, or decides instead.
    fn step(
        &self,
        py: Python<'_>,
        situation: &Bound<'_, PySituation>,
        wish: &Bound<'_, PyDecision>,
    ) -> PyResult<(PyDecision, bool)> {
        let mut guard = self.shield()?;
        let shield = &mut *guard;
        let situation = situation.get();
        let wish: Maneuver = *wish.get().decision.command;
        let shielded = py.detach(|| situation.with(|situation| shield.step(situation, &wish)));
        Ok((
            PyDecision::of(&shielded.decision, situation.ownship),
            shielded.engaged,
        ))
    }

    /// Forgets the last flight.
    fn restart(&self) -> PyResult<()> {
        self.shield()?.restart();
        Ok(())
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "a Shield cannot be pickled: make one in each process from its settings and vehicle",
        ))
    }
}
