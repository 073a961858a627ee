//! The pilots: they decide step by step.

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, TryLockError};

use fga::vehicle::Vehicle;
use fga_campaign::campaign::parse_policy;
use fga_sim::policy::{Pilot, PolicyChoice, PolicySettings};
use fga_sim::vehicle_file::VehicleModel;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::decision::PyDecision;
use crate::failure::input;
use crate::settings::PySettings;
use crate::situation::{PyMission, PySituation};
use crate::value::{PyVehicle, properties, refused, tuple, volume_of};

/// An aircraft from its TOML file: limits, settings, protected volume, wind.
///
/// `VehicleModel.read(path)` reads a file as the program does, `VehicleModel()` is the aircraft of the
/// paper's Table 4. Raises ValueError with the sentence of the program.
#[pyclass(name = "VehicleModel", frozen, module = "fga")]
#[derive(Debug, Clone)]
pub(crate) struct PyVehicleModel(pub(crate) VehicleModel);

#[pymethods]
impl PyVehicleModel {
    #[new]
    fn new() -> PyResult<Self> {
        VehicleModel::built_in().map(Self).map_err(input)
    }

    /// Reads a vehicle file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        py.detach(|| VehicleModel::read(&path))
            .map(Self)
            .map_err(input)
    }

    /// Half height of the volume, metres; None for a sphere.
    #[getter]
    fn half_height_m(&self) -> Option<f64> {
        let half_height_m = self.0.protection.half_height_m();
        let cylinder = volume_of(self.0.protection.radius_m(), Some(half_height_m));
        (self.0.protection == cylinder).then_some(half_height_m)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let vehicle = Bound::new(py, self.vehicle())?;
        Ok(format!(
            "VehicleModel({:?}, {})",
            self.0.name,
            vehicle.repr()?
        ))
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "a VehicleModel cannot be pickled: send the path of its file, or its vehicle and settings",
        ))
    }
}

properties! { PyVehicleModel, this,
    /// Its name for people.
    name: &str = &this.0.name;
    /// Its limits.
    vehicle: PyVehicle = PyVehicle(this.0.vehicle);
    /// The decision settings.
    settings: PySettings = PySettings(this.0.settings.avoider);
    /// Radius of the volume about each obstacle, metres.
    radius_m: f64 = this.0.protection.radius_m();
    /// Velocity of the air over the ground, metres per second.
    wind_mps: (f64, f64, f64) = tuple(this.0.wind_mps);
}

/// A vehicle model: a model, the path of a file, or None for the built-in one.
pub(crate) fn model_of(model: Option<&Bound<'_, PyAny>>) -> PyResult<Option<VehicleModel>> {
    let Some(object) = model else {
        return Ok(None);
    };
    if let Ok(model) = object.cast::<PyVehicleModel>() {
        return Ok(Some(model.get().0.clone()));
    }
    let path: PathBuf = object.extract().map_err(|_| {
        PyTypeError::new_err("vehicle is neither a path nor a VehicleModel, expected one of them")
    })?;
    VehicleModel::read(&path).map(Some).map_err(input)
}

/// A pilot, and the mission of its last step.
pub(crate) struct Flying {
    pilot: Box<dyn Pilot + Send>,
    mission: Option<Py<PyMission>>,
}

/// A pilot for one thread at a time.
pub(crate) type SharedPilot = Mutex<Flying>;

fn shared(pilot: Box<dyn Pilot + Send>) -> SharedPilot {
    Mutex::new(Flying {
        pilot,
        mission: None,
    })
}

fn locked(decider: &SharedPilot) -> PyResult<MutexGuard<'_, Flying>> {
    match decider.try_lock() {
        Ok(guard) => Ok(guard),
        // It is complete: the core does not panic.
        Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
        Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
            "another thread steps it now, expected one for each thread",
        )),
    }
}

fn step(
    py: Python<'_>,
    decider: &SharedPilot,
    situation: &Bound<'_, PySituation>,
) -> PyResult<PyDecision> {
    let mut guard = locked(decider)?;
    let situation = situation.get();
    let last = guard.mission.replace(situation.mission.clone_ref(py));
    let kept = last.and_then(|last| last.get().kept_of(situation.mission.get()));
    let pilot = guard.pilot.as_mut();
    if let Some(kept) = kept {
        pilot.replace_mission(kept);
    }
    let decision = py.detach(|| situation.with(|situation| pilot.step(situation)));
    Ok(PyDecision::of(&decision, situation.ownship))
}

/// Gives a situation of the simulator to a pilot.
pub(crate) fn with_pilot<T>(
    object: &Bound<'_, PyAny>,
    work: impl FnOnce(&mut dyn Pilot) -> T,
) -> PyResult<T> {
    if let Ok(avoider) = object.cast::<PyAvoider>() {
        return Ok(work(locked(&avoider.get().0)?.pilot.as_mut()));
    }
    if let Ok(pilot) = object.cast::<PyPilot>() {
        return Ok(work(locked(&pilot.get().decider)?.pilot.as_mut()));
    }
    Err(PyTypeError::new_err(format!(
        "pilot is {}, expected an Avoider or a Pilot",
        object.get_type()
    )))
}

/// Collision avoidance for one aircraft: call it each cycle with a Situation and fly its Decision.
///
/// Call `step` every `settings.decision_period_s` seconds. It remembers its present manoeuvre, so one
/// aircraft needs one avoider. A situation may have another mission than the last one: it begins at its first leg, or goes on
/// where both have the same waypoints up to the end of the present leg. A step releases the interpreter's lock; a second thread that steps the same
/// avoider meanwhile gets RuntimeError. It cannot be pickled; after a fork each process has its own copy.
#[pyclass(name = "Avoider", frozen, module = "fga")]
pub(crate) struct PyAvoider(SharedPilot);

#[pymethods]
impl PyAvoider {
    #[new]
    #[pyo3(signature = (settings = None, vehicle = None))]
    fn new(
        settings: Option<&Bound<'_, PySettings>>,
        vehicle: Option<&Bound<'_, PyVehicle>>,
    ) -> PyResult<Self> {
        let settings = settings.map_or_else(Default::default, |settings| settings.get().0);
        let vehicle = vehicle.map_or_else(Vehicle::table_4, |vehicle| vehicle.get().0);
        // As the program makes it: for a vehicle with a dead time it looks as far ahead.
        let policy = PolicyChoice::Avoider(settings.start);
        let settings = PolicySettings {
            avoider: settings,
            ..PolicySettings::default()
        };
        let avoider = policy.pilot(&settings, &vehicle).map_err(refused)?;
        Ok(Self(shared(avoider)))
    }

    /// Decides the command until the next step.
    fn step(&self, py: Python<'_>, situation: &Bound<'_, PySituation>) -> PyResult<PyDecision> {
        step(py, &self.0, situation)
    }

    /// Applies changed limits of the vehicle.
    fn retune(&self, vehicle: &Bound<'_, PyVehicle>) -> PyResult<()> {
        locked(&self.0)?.pilot.retune(&vehicle.get().0);
        Ok(())
    }

    /// Forgets the last flight.
    fn restart(&self) -> PyResult<()> {
        locked(&self.0)?.pilot.restart();
        Ok(())
    }

    fn __repr__(&self) -> &'static str {
        "Avoider()"
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "an Avoider cannot be pickled: make one in each process from its settings and vehicle",
        ))
    }
}

/// Any policy of the program by its name, as in `Pilot("published --start t0", model)`.
///
/// The same rules hold as for `Avoider`; with another mission a policy that is not fga's own begins another flight.
#[pyclass(name = "Pilot", frozen, module = "fga")]
pub(crate) struct PyPilot {
    name: String,
    decider: SharedPilot,
}

#[pymethods]
impl PyPilot {
    #[new]
    #[pyo3(signature = (policy = "turn-aware", model = None))]
    fn new(policy: &str, model: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let model = model_of(model)?
            .map_or_else(VehicleModel::built_in, Ok)
            .map_err(input)?;
        let choice = parse_policy(policy).map_err(PyValueError::new_err)?;
        let pilot = choice
            .pilot(&model.settings, &model.vehicle)
            .map_err(refused)?;
        Ok(Self {
            name: choice.name(),
            decider: shared(pilot),
        })
    }

    /// The policy's name.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Decides the command until the next step.
    fn step(&self, py: Python<'_>, situation: &Bound<'_, PySituation>) -> PyResult<PyDecision> {
        step(py, &self.decider, situation)
    }

    /// Applies changed limits of the vehicle.
    fn retune(&self, vehicle: &Bound<'_, PyVehicle>) -> PyResult<()> {
        locked(&self.decider)?.pilot.retune(&vehicle.get().0);
        Ok(())
    }

    /// Forgets the last flight.
    fn restart(&self) -> PyResult<()> {
        locked(&self.decider)?.pilot.restart();
        Ok(())
    }

    fn __repr__(&self) -> String {
        format!("Pilot({:?})", self.name)
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "a Pilot cannot be pickled: make one in each process from its name and model",
        ))
    }
}
