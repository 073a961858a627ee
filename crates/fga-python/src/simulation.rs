//! Flights decision by decision, and flights at once.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, TryLockError};

use fga::situation::Situation;
use fga_campaign::campaign::{FlownPath, metrics_of};
use fga_results::{flight, flight_files, provenance, replay_page};
use fga_sim::engine::{Outcome, SteppedFlight};
use fga_sim::run::{Plan, RunLog};
use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::airspace::{PyGround, PyZone};
use crate::decision::PyDecision;
use crate::failure::{input, output};
use crate::own::{LIMIT_S, Policy, choice, warn_of_failures};
use crate::pilot::{PyVehicleModel, model_of, with_pilot};
use crate::situation::{ObstacleForm, PyMission, PySituation};
use crate::table::{ArrayColumn, PyTable};
use crate::value::{PyOwnship, PyVehicle, properties, refused};

/// The result of a flight, by the names of the columns of `results.csv`.
pub(crate) fn outcome_dict<'py>(
    py: Python<'py>,
    outcome: &Outcome,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("separated", outcome.separated())?;
    dict.set_item("min_separation_m", outcome.min_separation_m)?;
    dict.set_item("min_margin_m", outcome.min_margin_m)?;
    dict.set_item("threat_s", outcome.threat_s)?;
    dict.set_item("start_s", outcome.start_s)?;
    dict.set_item("clear_s", outcome.clear_s)?;
    dict.set_item("rejoined_s", outcome.rejoined_s)?;
    dict.set_item("max_cross_track_m", outcome.max_cross_track_m)?;
    dict.set_item("extra_path_m", outcome.extra_path_m)?;
    dict.set_item("end_s", outcome.end_s)?;
    dict.set_item("mission_flown", outcome.mission_flown)?;
    dict.set_item("waypoints_missed", outcome.waypoints_missed)?;
    Ok(dict)
}

/// The plan of a file, and its bytes.
fn read_plan(
    path: &Path,
    vehicle: Option<&Bound<'_, PyAny>>,
    ownship: Option<&str>,
) -> PyResult<(Plan, Vec<u8>)> {
    let read = Plan::read_once(path, model_of(vehicle)?, ownship, &[]);
    let (plan, source) = read.map_err(input)?;
    Ok((plan, source.bytes))
}

/// A scenario (.toml) or recording (.daa) that waits for each decision.
///
/// `step(pilot)` lets a pilot decide and flies on; `situation` and `advance(decision)` are for a policy of
/// your own. Flown with the same policy, it is the flight of `fga run`, bit for bit.
#[pyclass(name = "Simulation", frozen, module = "fga")]
pub(crate) struct PySimulation {
    flight: Mutex<FlyingWorld>,
    mission: Py<PyMission>,
    plan: Plan,
}

/// A flight and its path.
struct FlyingWorld {
    flight: SteppedFlight,
    path: FlownPath,
}

impl PySimulation {
    fn flight(&self) -> PyResult<MutexGuard<'_, FlyingWorld>> {
        match self.flight.try_lock() {
            Ok(guard) => Ok(guard),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "another thread flies this simulation now, expected one for each thread",
            )),
        }
    }

    fn of(&self, py: Python<'_>, situation: &Situation<'_>) -> PySituation {
        PySituation {
            time_s: situation.time_s,
            ownship: situation.ownship,
            around: ObstacleForm::Rows(situation.obstacles.iter().collect()),
            mission: self.mission.clone_ref(py),
            wind_mps: situation.wind_mps,
        }
    }
}

#[pymethods]
impl PySimulation {
    #[new]
    #[pyo3(signature = (file, vehicle = None, ownship = None))]
    fn new(
        py: Python<'_>,
        file: PathBuf,
        vehicle: Option<&Bound<'_, PyAny>>,
        ownship: Option<&str>,
    ) -> PyResult<Self> {
        let (plan, _) = read_plan(&file, vehicle, ownship)?;
        let world = plan.world.clone();
        let mission = PyMission::of(
            world.mission_m.clone(),
            world.passing.clone(),
            world.limits_m,
            (
                world.zones.iter().cloned().map(PyZone).collect(),
                world.ground.clone().map(PyGround),
            ),
        );
        Ok(Self {
            mission: Py::new(py, mission)?,
            flight: Mutex::new(FlyingWorld {
                flight: SteppedFlight::new(world),
                path: FlownPath::default(),
            }),
            plan,
        })
    }

    /// The present situation; None once the flight has ended.
    #[getter]
    fn situation(&self, py: Python<'_>) -> PyResult<Option<PySituation>> {
        let flying = self.flight()?;
        Ok(flying
            .flight
            .situation()
            .map(|situation| self.of(py, &situation)))
    }

    /// Changed limits of the vehicle since the last decision, once; a pilot applies them by `retune`
    /// before it decides.
    fn take_retuned(&self) -> PyResult<Option<PyVehicle>> {
        Ok(self.flight()?.flight.take_retuned().map(PyVehicle))
    }

    /// Flies a decision until the next one is due. Returns whether the flight goes on.
    fn advance(&self, py: Python<'_>, decision: &Bound<'_, PyDecision>) -> PyResult<bool> {
        let mut guard = self.flight()?;
        let FlyingWorld { flight, path } = &mut *guard;
        let decision = decision.get();
        Ok(py.detach(|| flight.advance(&decision.decision, path)))
    }

    /// Lets a pilot decide and flies on. Returns its decision; None once the flight has ended.
    fn step(&self, pilot: &Bound<'_, PyAny>) -> PyResult<Option<PyDecision>> {
        let mut guard = self.flight()?;
        let FlyingWorld { flight, path } = &mut *guard;
        let retuned = flight.take_retuned();
        let decision = with_pilot(pilot, |pilot| {
            if let Some(vehicle) = &retuned {
                pilot.retune(vehicle);
            }
            flight.show(|situation| (pilot.step(situation), situation.ownship))
        })?;
        let Some((decision, ownship)) = decision else {
            return Ok(None);
        };
        flight.advance(&decision, path);
        Ok(Some(PyDecision::of(&decision, ownship)))
    }

    /// The result of the flight so far, by the names of the columns of results.csv, with `min_terrain_clearance_m` and
    /// `min_zone_margin_m`, None without ground or zones; of a recording also what the standards count
    /// (`standards`: near mid-air collision, well clear, severity, alerts), by the names of the columns of results.parquet.
    fn outcome<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mut guard = self.flight()?;
        let FlyingWorld { flight, path } = &mut *guard;
        let outcome = flight.outcome();
        let dict = outcome_dict(py, &outcome)?;
        dict.set_item("min_terrain_clearance_m", outcome.min_terrain_clearance_m)?;
        dict.set_item("min_zone_margin_m", outcome.min_zone_margin_m)?;
        if let Some(metrics) = metrics_of(&self.plan.world, path, &outcome) {
            let text = flight::standards(&metrics).to_string();
            let standards = py.import("json")?.call_method1("loads", (text,))?;
            dict.set_item("standards", standards)?;
        }
        Ok(dict)
    }

    /// Back to the start.
    fn restart(&self) -> PyResult<()> {
        let mut flying = self.flight()?;
        flying.flight.restart(self.plan.world.clone());
        flying.path.clear();
        Ok(())
    }

    fn __repr__(&self) -> PyResult<String> {
        Ok(format!(
            "Simulation({:?}, at {:.1} s)",
            self.plan.name,
            self.flight()?.flight.time_s()
        ))
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "a Simulation cannot be pickled: make one in each process from its file",
        ))
    }
}

properties! { PySimulation, this,
    /// Its name.
    name: &str = &this.plan.name;
    /// Its aircraft.
    model: PyVehicleModel = PyVehicleModel(this.plan.model.clone());
    /// Names of the obstacles.
    names: Vec<String> = this.plan.names.clone();
    /// Time of the next decision, seconds; at the end the time of the end.
    time_s: PyResult<f64> = Ok(this.flight()?.flight.time_s());
    /// The aircraft now.
    ownship: PyResult<PyOwnship> = Ok(PyOwnship(*this.flight()?.flight.ownship()));
}

/// One flight with everything logged, as in the files of `fga run`.
#[pyclass(name = "Run", frozen, module = "fga")]
pub(crate) struct PyRun {
    log: RunLog,
    overlaid: Vec<RunLog>,
    input: PathBuf,
    input_sha256: String,
}

#[pymethods]
impl PyRun {
    /// The summary, as `fga run --json` prints it.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = flight::summary(&self.log).to_string();
        py.import("json")?.call_method1("loads", (text,))
    }

    /// Whether the flight entered no protected volume.
    #[getter]
    fn separated(&self) -> bool {
        self.log.outcome.separated()
    }

    /// The flown states, at most 0.1 s apart: the columns of track.csv, to full precision.
    #[getter]
    fn track(&self) -> PyResult<PyTable> {
        let samples = &self.log.samples;
        let real = |name, get: fn(&fga_sim::engine::Sample) -> f64| {
            (name, ArrayColumn::Real(samples.iter().map(get).collect()))
        };
        PyTable::of(vec![
            real("t_s", |sample| sample.time_s),
            real("x_m", |sample| sample.position_m.x),
            real("y_m", |sample| sample.position_m.y),
            real("z_m", |sample| sample.position_m.z),
            real("course_rad", |sample| sample.course_rad),
            real("climb_rad", |sample| sample.climb_rad),
            real("bank_rad", |sample| sample.bank_rad),
            (
                "state",
                ArrayColumn::Text(
                    samples
                        .iter()
                        .map(|sample| sample.state.name().into())
                        .collect(),
                ),
            ),
        ])
    }

    /// Every decision, in order.
    #[getter]
    fn decisions(&self) -> Vec<PyDecision> {
        let decisions = self.log.decisions.iter();
        decisions
            .map(|log| PyDecision::of(&log.decision, log.ownship))
            .collect()
    }

    /// The bytes of track.csv.
    fn track_csv<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &flight_files::track_csv(&self.log))
    }

    /// The text of events.jsonl.
    fn events_jsonl(&self) -> String {
        flight_files::events_jsonl(&flight_files::events(&self.log))
    }

    /// The replay page.
    fn replay_html(&self) -> String {
        replay_page::page(core::iter::once(&self.log).chain(&self.overlaid))
    }

    /// Writes the files of `fga run` into a folder.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let source = (self.input.as_path(), self.input_sha256.as_str());
        py.detach(|| flight::write(&folder, source, &self.log, &self.overlaid))
            .map_err(output)
    }

    fn __repr__(&self) -> String {
        let outcome = &self.log.outcome;
        format!(
            "Run({:?}, policy={:?}, separated={}, min_margin_m={:.2}, end_s={:.1})",
            self.log.plan.name,
            self.log.policy,
            if outcome.separated() { "True" } else { "False" },
            outcome.min_margin_m,
            outcome.end_s
        )
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "a Run cannot be pickled: send its summary or its tables",
        ))
    }
}

/// Flies a scenario (.toml) or a recording (.daa) to its end: `fga run`.
///
/// `overlay` names further policies whose flights the replay page shows too.
#[pyfunction]
#[pyo3(signature = (
    file, policy = Policy::Default, vehicle = None, ownship = None, overlay = Vec::new(), time_limit_s = LIMIT_S,
))]
pub(crate) fn run(
    py: Python<'_>,
    file: PathBuf,
    policy: Policy<'_>,
    vehicle: Option<&Bound<'_, PyAny>>,
    ownship: Option<&str>,
    overlay: Vec<Bound<'_, PyAny>>,
    time_limit_s: f64,
) -> PyResult<PyRun> {
    let (plan, read) = read_plan(&file, vehicle, ownship)?;
    let policy = policy.choice(time_limit_s)?;
    let others = overlay
        .iter()
        .map(|policy| choice(policy, time_limit_s))
        .collect::<PyResult<Vec<_>>>()?;
    let (log, overlaid) = py
        .detach(|| {
            let fly = |policy| fga_sim::run::fly(plan.clone(), policy, &mut |_| ());
            let overlaid = others.iter().map(fly).collect::<Result<Vec<_>, _>>()?;
            Ok((fly(&policy)?, overlaid))
        })
        .map_err(refused)?;
    warn_of_failures(py, core::iter::once(&policy).chain(&others))?;
    Ok(PyRun {
        log,
        overlaid,
        input: file,
        input_sha256: provenance::fingerprint(&read),
    })
}
