//! Policies of one's own in Python: each flight asks an object on a thread of its own, with a time limit.

use core::sync::atomic::{AtomicU64, Ordering};
use core::time::Duration;
use std::sync::Arc;

use fga::Vec3;
use fga::avoider::Decision;
use fga::avoider::{Reason, State};
use fga::maneuver::Maneuver;
use fga::situation::{Obstacle, Passing, Situation};
use fga::vehicle::Vehicle;
use fga_campaign::campaign::parse_policy;
use fga_sim::own::{FailureKind, Outside, OwnPolicy, PolicyAnswer, PolicyFailure, Silence, Worker};
use fga_sim::policy::{PYTHON, PolicyChoice, PolicySettings};
use fga_sim::world::{WorldGround, WorldZone};
use pyo3::exceptions::{PyRuntimeWarning, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::airspace::{PyGround, PyZone};
use crate::decision::{PyDecision, PyStage};
use crate::settings::PySettings;
use crate::situation::{ObstacleForm, PyMission, PySituation};
use crate::value::PyVehicle;

/// Time limit of a step without another one, seconds.
pub(crate) const LIMIT_S: f64 = 1.0;

/// The first step of a flight may import modules and read files.
const START_LIMIT_S: f64 = 10.0;

/// What a policy is called with at every step.
const STEP: &str = "step";

/// What a policy for many flights at once is called with.
pub(crate) const STEP_ALL: &str = "step_all";

fn helper<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("fga._own")?.getattr(name)
}

/// A time limit of a step.
pub(crate) fn checked_limit(limit_s: f64) -> PyResult<f64> {
    if limit_s > 0.0 && limit_s <= 3600.0 {
        return Ok(limit_s);
    }
    Err(PyValueError::new_err(format!(
        "time_limit_s is {limit_s}, expected seconds above 0, at most 3600"
    )))
}

/// A policy by its name, or one of one's own.
pub(crate) fn choice(policy: &Bound<'_, PyAny>, limit_s: f64) -> PyResult<PolicyChoice> {
    if let Ok(name) = policy.extract::<String>() {
        return parse_policy(&name).map_err(PyValueError::new_err);
    }
    one_by_one(policy, limit_s).map(PolicyChoice::Own)
}

/// A policy that flies each flight by itself.
fn one_by_one(policy: &Bound<'_, PyAny>, limit_s: f64) -> PyResult<OwnPolicy> {
    let answers = policy.is_callable() && !policy.is_instance_of::<PyType>();
    if is_for_all(policy)? && !policy.hasattr(STEP)? && !answers {
        return Err(PyTypeError::new_err(format!(
            "policy is {policy} with {STEP_ALL} alone, which fga.batch takes; expected step(situation)"
        )));
    }
    own(policy, limit_s, None)
}

/// The argument `policy`.
pub(crate) enum Policy<'py> {
    /// The default policy.
    Default,
    /// A name, or one of one's own.
    Given(Bound<'py, PyAny>),
}

impl<'py> FromPyObject<'_, 'py> for Policy<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self::Given(object.to_owned()))
    }
}

impl Policy<'_> {
    /// The policy, which may answer for all flights at once.
    pub(crate) fn for_all(&self, limit_s: f64) -> PyResult<PolicyChoice> {
        match self {
            Self::Given(policy) if is_for_all(policy)? => {
                own(policy, limit_s, None).map(PolicyChoice::Own)
            }
            _ => self.choice(limit_s),
        }
    }

    /// The policy.
    pub(crate) fn choice(&self, limit_s: f64) -> PyResult<PolicyChoice> {
        match self {
            Self::Default => Ok(PolicyChoice::default()),
            Self::Given(policy) => choice(policy, limit_s),
        }
    }
}

/// Whether a policy answers for many flights at once.
pub(crate) fn is_for_all(policy: &Bound<'_, PyAny>) -> PyResult<bool> {
    policy.hasattr(STEP_ALL)
}

/// A policy of one's own: a class that is made of settings and vehicle, an object, or a function; with the fingerprint that it was
/// pickled with.
pub(crate) fn own(
    policy: &Bound<'_, PyAny>,
    limit_s: f64,
    carried: Option<&str>,
) -> PyResult<OwnPolicy> {
    let py = policy.py();
    let limit_s = checked_limit(limit_s)?;
    // To call a class makes an object, not a step.
    let answers = policy.is_callable() && !policy.is_instance_of::<PyType>();
    if !(policy.hasattr(STEP)? || is_for_all(policy)? || answers) {
        return Err(PyTypeError::new_err(format!(
            "policy is {}, expected a name, a class or an object with step(situation), or a function of the situation",
            if policy.is_instance_of::<PyType>() {
                format!("{policy} without step")
            } else {
                policy.get_type().to_string()
            }
        )));
    }
    let name: String = helper(py, "name")?.call1((policy,))?.extract()?;
    let sha256: String = helper(py, "fingerprint")?
        .call1((policy, carried))?
        .extract()?;
    let name = if limit_s == LIMIT_S {
        format!("{PYTHON}{name}")
    } else {
        format!("{}@{limit_s}:{name}", PYTHON.trim_end_matches(':'))
    };
    let policy = Arc::new(policy.clone().unbind());
    Ok(OwnPolicy::new(
        name,
        sha256,
        Box::new(move |settings, vehicle| {
            Box::new(AskedObject {
                policy: Arc::clone(&policy),
                limit_s,
                settings: *settings,
                made_for: *vehicle,
                retuned: None,
                begins: true,
                thread: None,
            })
        }),
    ))
}

/// A policy of one's own, and the fingerprint that it is pickled with.
pub(crate) type Pickled = (Py<PyAny>, String);

/// The same policies once more.
pub(crate) fn cloned(py: Python<'_>, pickled: &[Pickled]) -> Vec<Pickled> {
    let each = pickled.iter();
    each.map(|(policy, sha256)| (policy.clone_ref(py), sha256.clone()))
        .collect()
}

/// The policies of one's own in a list of policies, each once, for one may fly on both sides.
#[derive(Default)]
pub(crate) struct Owns {
    pub(crate) policies: Vec<OwnPolicy>,
    pub(crate) pickled: Vec<Pickled>,
}

impl Owns {
    /// The name of a policy, which joins the others if it is one of one's own.
    pub(crate) fn named(&mut self, policy: &Bound<'_, PyAny>, limit_s: f64) -> PyResult<String> {
        if let Ok(name) = policy.extract::<String>() {
            return Ok(name);
        }
        let own = one_by_one(policy, limit_s)?;
        let name = own.name().to_owned();
        match self.policies.iter().find(|known| known.name() == name) {
            Some(known) if *known != own => {
                return Err(PyValueError::new_err(format!(
                    "two policies are called {name}, expected another name for one of them"
                )));
            }
            Some(_) => {}
            None => {
                let sha256 = own.sha256().to_owned();
                self.pickled.push((policy.clone().unbind(), sha256));
                self.policies.push(own);
            }
        }
        Ok(name)
    }
}

/// Warns of the flights in which policies of one's own failed.
pub(crate) fn warn_of_failures<'a>(
    py: Python<'_>,
    policies: impl IntoIterator<Item = &'a PolicyChoice>,
) -> PyResult<()> {
    for sentence in policies
        .into_iter()
        .filter_map(|policy| policy.own()?.failures_in_words())
    {
        let message = std::ffi::CString::new(sentence.replace('\0', " "))?;
        PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), &message, 2)?;
    }
    Ok(())
}

/// A situation for another thread.
struct Question {
    /// What the first step of a flight needs.
    begins: Option<Begins>,
    retuned: Option<Vehicle>,
    time_s: f64,
    ownship: fga::situation::Ownship,
    obstacles: Vec<Obstacle>,
    wind_mps: Vec3,
}

struct Begins {
    settings: PolicySettings,
    vehicle: Vehicle,
    waypoints_m: Vec<Vec3>,
    passing: Vec<Passing>,
    limits_m: (f64, f64),
    zones: Vec<PyZone>,
    ground: Option<PyGround>,
}

/// Asks an object in one flight after the other.
struct AskedObject {
    policy: Arc<Py<PyAny>>,
    limit_s: f64,
    settings: PolicySettings,
    made_for: Vehicle,
    retuned: Option<Vehicle>,
    begins: bool,
    thread: Option<Thread<Question, PolicyAnswer>>,
}

impl Outside for AskedObject {
    fn answer(&mut self, situation: &Situation<'_>) -> Result<PolicyAnswer, PolicyFailure> {
        let mission = &situation.mission;
        let question = Question {
            begins: self.begins.then(|| Begins {
                settings: self.settings,
                vehicle: self.made_for,
                waypoints_m: mission.waypoints_m.to_vec(),
                passing: mission.passing.to_vec(),
                limits_m: mission.limits_m,
                zones: mission
                    .zones
                    .iter()
                    .map(|zone| PyZone(WorldZone::of(zone)))
                    .collect(),
                ground: mission
                    .ground
                    .and_then(WorldGround::of)
                    .map(|ground| PyGround(Arc::new(ground))),
            }),
            retuned: self.retuned.take(),
            time_s: situation.time_s,
            ownship: situation.ownship,
            obstacles: situation.obstacles.iter().collect(),
            wind_mps: situation.wind_mps,
        };
        let limit_s = if self.begins {
            self.limit_s.max(START_LIMIT_S)
        } else {
            self.limit_s
        };
        self.begins = false;
        let thread = if let Some(thread) = self.thread.take() {
            thread
        } else {
            let mut flown = FlownObject::of(Arc::clone(&self.policy));
            Thread::start(move |py, question| flown.answer(py, question))?
        };
        let answer = thread.ask(question, limit_s)?;
        self.thread = Some(thread);
        answer
    }

    fn retune(&mut self, vehicle: &Vehicle) {
        self.retuned = Some(*vehicle);
    }

    fn restart(&mut self) {
        self.retuned = None;
        self.begins = true;
    }
}

/// A thread that runs Python code for each question.
pub(crate) struct Thread<Q, A> {
    worker: Worker<Q, Result<A, PolicyFailure>>,
    ident: Arc<AtomicU64>,
}

impl<Q: Send + 'static, A: Send + 'static> Thread<Q, A> {
    /// A thread that answers with `answer`.
    pub(crate) fn start(
        mut answer: impl FnMut(Python<'_>, Q) -> Result<A, PolicyFailure> + Send + 'static,
    ) -> Result<Self, PolicyFailure> {
        let ident = Arc::new(AtomicU64::new(0));
        let noted = Arc::clone(&ident);
        let worker = Worker::start(move |question| {
            Python::attach(|py| {
                if noted.load(Ordering::Relaxed) == 0 {
                    let ident = py.import("threading").and_then(|threading| {
                        threading.call_method0("get_ident")?.extract::<u64>()
                    });
                    noted.store(ident.unwrap_or_default(), Ordering::Relaxed);
                }
                answer(py, question)
            })
        })
        .map_err(|error| {
            PolicyFailure::new(
                FailureKind::Ended,
                format!("no thread can be started for it: {error}"),
            )
        })?;
        Ok(Self { worker, ident })
    }

    /// The answer within the limit; without one the thread is given up, and its Python code interrupted.
    pub(crate) fn ask(
        &self,
        question: Q,
        limit_s: f64,
    ) -> Result<Result<A, PolicyFailure>, PolicyFailure> {
        let silence = match self.worker.ask(question, Duration::from_secs_f64(limit_s)) {
            Ok(answer) => return Ok(answer),
            Err(silence) => silence,
        };
        if silence == Silence::Ended {
            return Err(PolicyFailure::new(FailureKind::Ended, "its thread ended"));
        }
        let ident = self.ident.load(Ordering::Relaxed);
        Python::attach(|py| {
            // What cannot be interrupted goes on, and nobody waits for it.
            let _ = helper(py, "interrupt").and_then(|interrupt| interrupt.call1((ident,)));
        });
        Err(PolicyFailure::new(
            FailureKind::TimedOut,
            format!("no answer within {limit_s} s"),
        ))
    }
}

/// An exception of a policy.
pub(crate) fn raised(py: Python<'_>, error: &PyErr) -> PolicyFailure {
    let said = helper(py, "said")
        .and_then(|said| said.call1((error.value(py),))?.extract::<String>())
        .unwrap_or_else(|_| format!("raised {error}"));
    PolicyFailure::new(FailureKind::Raised, said)
}

/// The calls of a policy made for a flight: a step, and changed limits.
pub(crate) fn made(
    py: Python<'_>,
    policy: &Py<PyAny>,
    method: &str,
    settings: &PolicySettings,
    vehicle: &Vehicle,
) -> PyResult<(Py<PyAny>, Option<Py<PyAny>>)> {
    let arguments = (
        policy,
        method,
        PySettings(settings.avoider),
        PyVehicle(*vehicle),
    );
    helper(py, "made")?.call1(arguments)?.extract()
}

/// The object of a flight.
struct FlownObject {
    policy: Arc<Py<PyAny>>,
    step: Option<Py<PyAny>>,
    retune: Option<Py<PyAny>>,
    mission: Option<Py<PyMission>>,
}

impl FlownObject {
    const fn of(policy: Arc<Py<PyAny>>) -> Self {
        Self {
            policy,
            step: None,
            retune: None,
            mission: None,
        }
    }

    fn answer(
        &mut self,
        py: Python<'_>,
        question: Question,
    ) -> Result<PolicyAnswer, PolicyFailure> {
        let answer = self.ask(py, question).map_err(|error| raised(py, &error))?;
        answer_of(answer.bind(py))
    }

    fn ask(&mut self, py: Python<'_>, question: Question) -> PyResult<Py<PyAny>> {
        if let Some(begins) = question.begins {
            let around = (begins.zones, begins.ground);
            let mission =
                PyMission::of(begins.waypoints_m, begins.passing, begins.limits_m, around);
            self.mission = Some(Py::new(py, mission)?);
            let (step, retune) = made(py, &self.policy, STEP, &begins.settings, &begins.vehicle)?;
            (self.step, self.retune) = (Some(step), retune);
        }
        if let (Some(vehicle), Some(retune)) = (question.retuned, &self.retune) {
            retune.call1(py, (PyVehicle(vehicle),))?;
        }
        let (Some(step), Some(mission)) = (&self.step, &self.mission) else {
            return Err(PyValueError::new_err("the policy was not made"));
        };
        let situation = PySituation {
            time_s: question.time_s,
            ownship: question.ownship,
            around: ObstacleForm::Rows(question.obstacles),
            mission: mission.clone_ref(py),
            wind_mps: question.wind_mps,
        };
        step.call1(py, (situation,))
    }
}

/// What an object that a policy returned says.
fn answer_of(answer: &Bound<'_, PyAny>) -> Result<PolicyAnswer, PolicyFailure> {
    let wrong = || {
        let kind = answer.get_type();
        PolicyFailure::new(
            FailureKind::WrongShape,
            format!(
                "returned {kind}, expected None, a pair (course_rad, climb_rad), a Stage, a list of them, or a Decision"
            ),
        )
    };
    let flies = |maneuver: &Maneuver| {
        let decision = Decision::new(State::Avoiding, maneuver, Reason::ManeuverKept);
        PolicyAnswer::Decided(Box::new(decision))
    };
    if answer.is_none() {
        return Ok(PolicyAnswer::Mission);
    }
    if let Ok(decision) = answer.cast::<PyDecision>() {
        return Ok(PolicyAnswer::Decided(Box::new(decision.get().decision)));
    }
    if let Ok(stage) = answer.cast::<PyStage>() {
        let mut maneuver = Maneuver::hold();
        maneuver.push(stage.get().0);
        return Ok(flies(&maneuver));
    }
    let items = answer
        .try_iter()
        .and_then(Iterator::collect::<PyResult<Vec<_>>>);
    let items = items.map_err(|_| wrong())?;
    let numbers = items.iter().map(PyAnyMethods::extract::<f64>);
    if let Ok([course_rad, climb_rad]) = numbers.collect::<PyResult<Vec<f64>>>().as_deref() {
        return Ok(PolicyAnswer::Heading {
            course_rad: *course_rad,
            climb_rad: *climb_rad,
        });
    }
    let mut maneuver = Maneuver::hold();
    for item in &items {
        let stage = item.cast::<PyStage>().map_err(|_| wrong())?;
        if !maneuver.push(stage.get().0) {
            return Err(PolicyFailure::new(
                FailureKind::WrongShape,
                format!(
                    "returned {} stages, expected at most {} in the order of their start_s",
                    items.len(),
                    fga::maneuver::MAX_STAGES
                ),
            ));
        }
    }
    if items.is_empty() {
        Err(wrong())
    } else {
        Ok(flies(&maneuver))
    }
}
