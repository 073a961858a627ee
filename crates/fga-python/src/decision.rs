//! A decision and its reasons.

use fga::avoider::{Candidate, Decision, Reason, Record, State, Threat, Verdict, Work};
use fga::maneuver::{Maneuver, Stage};
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga_formats::words::{decision_words, proof_key, reason_key};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::value::{PyOwnship, PyVehicle, expect, frozen, properties, remade};

/// A command from a moment on, until the next stage begins.
///
/// `course_rad` is not wrapped: the aircraft turns by the plain difference to its own course.
#[pyclass(name = "Stage", frozen, eq, module = "fga")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PyStage(pub(crate) Stage);

#[pymethods]
impl PyStage {
    #[new]
    #[pyo3(signature = (course_rad, climb_rad = 0.0, start_s = 0.0, rate_share = 1.0))]
    fn new(course_rad: f64, climb_rad: f64, start_s: f64, rate_share: f64) -> PyResult<Self> {
        expect(
            course_rad.is_finite(),
            "course_rad",
            course_rad,
            "a finite number",
        )?;
        expect(
            climb_rad.is_finite(),
            "climb_rad",
            climb_rad,
            "a finite number",
        )?;
        let holds = start_s.is_finite() && start_s >= 0.0;
        expect(holds, "start_s", start_s, "0 or more")?;
        let holds = rate_share > 0.0 && rate_share <= 1.0;
        expect(holds, "rate_share", rate_share, "more than 0, at most 1")?;
        Ok(Self(Stage {
            start_s,
            course_rad,
            climb_rad,
            rate_share,
        }))
    }
}

properties! { PyStage, this,
    /// Its start, seconds from the moment of the decision.
    start_s: f64 = this.0.start_s;
    /// Course to turn to, radians.
    course_rad: f64 = this.0.course_rad;
    /// Climb angle to take up, radians.
    climb_rad: f64 = this.0.climb_rad;
    /// Share of the largest course rate to turn with.
    rate_share: f64 = this.0.rate_share;
}

frozen! { PyStage, this,
    course_rad, climb_rad, start_s, rate_share,
}

/// The obstacle that a decision is about.
#[pyclass(name = "Threat", frozen, eq, module = "fga")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PyThreat(Threat);

#[pymethods]
impl PyThreat {
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, ThreatParts)> {
        let Self(threat) = self;
        let parts = (threat.id, threat.entry_s, threat.closest_s, threat.margin_m);
        Ok((remade(py, "_threat")?, parts))
    }

    fn __repr__(&self) -> String {
        let Self(threat) = self;
        format!(
            "Threat(id={}, entry_s={:?}, closest_s={:?}, margin_m={:?})",
            threat.id, threat.entry_s, threat.closest_s, threat.margin_m
        )
    }
}

properties! { PyThreat, this,
    /// The obstacle's identifier.
    id: u32 = this.0.id;
    /// Time of the entry into its volume on the mission, seconds from now.
    entry_s: f64 = this.0.entry_s;
    /// Time of the closest approach, seconds from now.
    closest_s: f64 = this.0.closest_s;
    /// Separation from its volume at that time, metres; negative inside.
    margin_m: f64 = this.0.margin_m;
}

/// An examined manoeuvre.
#[pyclass(name = "Candidate", frozen, eq, module = "fga")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PyCandidate(Maneuver, Candidate);

#[pymethods]
impl PyCandidate {
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, CandidateParts)> {
        let Self(maneuver, candidate) = self;
        let parts = (
            command_parts(maneuver),
            candidate.margin_m,
            candidate.cost,
            self.verdict(),
        );
        Ok((remade(py, "_candidate")?, parts))
    }

    fn __repr__(&self) -> String {
        format!(
            "Candidate({} stages, margin_m={:?}, cost={:?}, verdict={:?})",
            self.0.stages().len(),
            self.1.margin_m,
            self.1.cost,
            self.verdict()
        )
    }
}

properties! { PyCandidate, this,
    /// Its commands.
    stages: Vec<PyStage> = stages(&this.0);
    /// Certified lower bound of the separation beyond every volume, metres.
    margin_m: f64 = this.1.margin_m;
    /// Its cost.
    cost: f64 = this.1.cost;
    /// certified, rejected or chosen.
    verdict: &'static str = verdict_word(this.1.verdict);
}

const fn verdict_word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Certified => "certified",
        Verdict::Rejected => "rejected",
        Verdict::Chosen => "chosen",
    }
}

fn stages(maneuver: &Maneuver) -> Vec<PyStage> {
    maneuver.stages().iter().copied().map(PyStage).collect()
}

/// A manoeuvre of these stages.
fn maneuver_of(stages: &[PyRef<'_, PyStage>]) -> PyResult<Maneuver> {
    let mut maneuver = Maneuver::hold();
    for stage in stages {
        if !maneuver.push(stage.0) {
            return Err(PyValueError::new_err(format!(
                "stages holds {} stages, expected at most {} in order of their start_s",
                stages.len(),
                fga::maneuver::MAX_STAGES
            )));
        }
    }
    Ok(maneuver)
}

fn state_of(word: &str) -> PyResult<State> {
    let mut states = State::ALL.into_iter();
    states.find(|state| state.name() == word).ok_or_else(|| {
        PyValueError::new_err(format!(
            "state is {word:?}, expected cruise, threatened, avoiding or recovering"
        ))
    })
}

/// The command until the next step, and its reasons.
///
/// `Decision(stages, state)` makes one, for a policy of your own.
#[pyclass(name = "Decision", frozen, module = "fga")]
#[derive(Debug)]
pub(crate) struct PyDecision {
    pub(crate) decision: Decision,
    /// The aircraft of the decision.
    ownship: Option<fga::situation::Ownship>,
}

impl PyDecision {
    pub(crate) const fn of(decision: &Decision, ownship: fga::situation::Ownship) -> Self {
        Self {
            decision: *decision,
            ownship: Some(ownship),
        }
    }
}

#[pymethods]
impl PyDecision {
    #[new]
    #[pyo3(signature = (stages, state = "avoiding"))]
    fn new(stages: Vec<PyRef<'_, PyStage>>, state: &str) -> PyResult<Self> {
        let state = state_of(state)?;
        let maneuver = maneuver_of(&stages)?;
        let reason = match state {
            State::Cruise | State::Threatened => Reason::Clear,
            State::Avoiding => Reason::ManeuverKept,
            State::Recovering => Reason::RejoinKept,
        };
        Ok(Self {
            decision: Decision::new(state, &maneuver, reason),
            ownship: None,
        })
    }

    /// The decision as a sentence.
    #[getter]
    fn text(&self) -> String {
        let ownship = self.ownship.unwrap_or(fga::situation::Ownship {
            position_m: fga::Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: 1.0,
        });
        decision_words(&self.decision, &ownship, |id| format!("obstacle {id}"))
    }

    /// The commanded stage this long after the decision, seconds; None before the first one.
    #[pyo3(signature = (after_s = 0.0))]
    fn stage_at(&self, after_s: f64) -> Option<PyStage> {
        self.decision
            .command
            .stage_at(after_s)
            .copied()
            .map(PyStage)
    }

    /// The predicted state of an aircraft with these limits some seconds after the decision, if nothing new
    /// happens, in still air.
    ///
    /// Raises ValueError for a decision of your own, which knows no aircraft, or a time that is not from 0 to
    /// 600.
    fn predicted(&self, vehicle: &Bound<'_, PyVehicle>, after_s: f64) -> PyResult<PyOwnship> {
        expect(
            (0.0..=600.0).contains(&after_s),
            "after_s",
            after_s,
            "0 to 600",
        )?;
        let own = self.ownship.ok_or_else(|| {
            PyValueError::new_err("the decision was made for no aircraft, expected one of a pilot")
        })?;
        let flyer = Flyer::new(&vehicle.get().0);
        let mut path = Box::new(FlightPath::new());
        path.predict(
            &flyer,
            &MotionState::of(&own),
            &self.decision.command,
            after_s + 1.0,
        );
        let state = path.state_at(&flyer, after_s).ok_or_else(|| {
            PyValueError::new_err(format!(
                "after_s is {after_s}, expected a time within the prediction"
            ))
        })?;
        Ok(PyOwnship(fga::situation::Ownship {
            position_m: state.position_m,
            course_rad: state.course_rad,
            climb_rad: state.climb_rad,
            bank_rad: state.bank_rad,
            ..own
        }))
    }

    /// The manoeuvre, flown or awaited.
    #[getter]
    fn chosen(&self) -> Option<PyCandidate> {
        let chosen = self.decision.record.chosen?;
        Some(PyCandidate(*self.decision.command, chosen))
    }

    /// The best manoeuvre to the other side, if there was a search for it.
    #[getter]
    fn alternative(&self) -> Option<PyCandidate> {
        let (maneuver, worth) = self.decision.record.alternative?;
        Some(PyCandidate(maneuver.to(), worth))
    }

    fn __eq__(&self, other: &Self) -> bool {
        // A proof does not come back from a pickle.
        let shown = |decision: &Decision| {
            let mut shown = *decision;
            shown.command.edit();
            shown
        };
        shown(&self.decision) == shown(&other.decision)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, DecisionParts)> {
        let Decision {
            state,
            command,
            record,
        } = &self.decision;
        let work = &record.work;
        let parts = (
            state.name(),
            reason_key(record.reason),
            command_parts(command),
            record.threat.map(PyThreat),
            (self.chosen(), self.alternative()),
            (record.latest_start_s, record.start_s, record.resilience),
            (record.p_loss_hold, record.p_loss, record.proven_share),
            (record.in_need, record.clock_set_back, work.limit_met),
            (
                work.tracked,
                work.threats,
                work.candidates,
                work.work,
                record.straight_aircraft,
                work.unusable,
            ),
            self.ownship.map(PyOwnship),
        );
        Ok((remade(py, "_decision")?, parts))
    }

    fn __repr__(&self) -> String {
        format!("Decision(state={:?}, {:?})", self.state(), self.text())
    }

    /// State, reason, text, command and figures as plain values.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("state", self.state())?;
        dict.set_item("reason", self.reason())?;
        dict.set_item("text", self.text())?;
        let command: Vec<_> = self
            .decision
            .command
            .stages()
            .iter()
            .map(|stage| {
                (
                    stage.start_s,
                    stage.course_rad,
                    stage.climb_rad,
                    stage.rate_share,
                )
            })
            .collect();
        dict.set_item("command", command)?;
        dict.set_item("latest_start_s", self.latest_start_s())?;
        dict.set_item("start_s", self.start_s())?;
        dict.set_item("proof", self.proof())?;
        dict.set_item("resilience", self.resilience())?;
        dict.set_item("p_loss_hold", self.p_loss_hold())?;
        dict.set_item("p_loss", self.p_loss())?;
        dict.set_item("proven_share", self.proven_share())?;
        dict.set_item("limit_met", self.limit_met())?;
        Ok(dict)
    }
}

properties! { PyDecision, this,
    /// State of the avoider: cruise, threatened, avoiding or recovering.
    state: &'static str = this.decision.state.name();
    /// The reason, by its key in files.
    reason: &'static str = reason_key(this.decision.record.reason);
    /// The command: stages in order of their start; without any: hold course and climb angle.
    command: Vec<PyStage> = stages(&this.decision.command);
    /// The most urgent threat.
    threat: Option<PyThreat> = this.decision.record.threat.map(PyThreat);
    /// Latest start of a certified manoeuvre, seconds from now; None where none exists.
    latest_start_s: Option<f64> = this.decision.record.latest_start_s;
    /// Start of the chosen manoeuvre, seconds from now.
    start_s: Option<f64> = this.decision.record.start_s;
    /// What is proven about the command: "certified" if it keeps clear of everything that is assumed, "leaving" if the aircraft
    /// is already in a volume and it leads out, None if nothing is proven.
    proof: Option<&'static str> = proof_key(&this.decision.command);
    /// Share of the bounds of aircraft that the manoeuvre withstands.
    resilience: Option<f64> = this.decision.record.resilience;
    /// Chance to enter a protected volume within a minute on the mission, of decisions by beliefs.
    p_loss_hold: Option<f64> = this.decision.record.p_loss_hold;
    /// The same as it flies.
    p_loss: Option<f64> = this.decision.record.p_loss;
    /// Weight of the futures of the aircraft around of which the certificate keeps clear; None where reports count as exact.
    proven_share: Option<f64> = this.decision.record.proven_share;
    /// Obstacles within the surveillance radius.
    tracked: u32 = this.decision.record.work.tracked;
    /// Obstacles left out because a number of theirs is not finite.
    unusable: u32 = this.decision.record.work.unusable;
    /// Obstacles in sight that threaten the mission.
    threats: u32 = this.decision.record.work.threats;
    /// Manoeuvres evaluated.
    candidates: u32 = this.decision.record.work.candidates;
    /// Work done, in the unit of `Settings.work_limit`.
    work: u32 = this.decision.record.work.work;
    /// Whether the step met its limit of work before the search ended.
    limit_met: bool = this.decision.record.work.limit_met;
}

/// What a manoeuvre is pickled as: its stages, and whether it took every stage.
type CommandParts = (Vec<PyStage>, bool);
type ThreatParts = (u32, f64, f64, f64);
type CandidateParts = (CommandParts, f64, f64, &'static str);
type DecisionParts = (
    &'static str,
    &'static str,
    CommandParts,
    Option<PyThreat>,
    (Option<PyCandidate>, Option<PyCandidate>),
    (Option<f64>, Option<f64>, Option<f64>),
    (Option<f64>, Option<f64>, Option<f64>),
    (bool, bool, bool),
    (u32, u32, u32, u32, u32, u32),
    Option<PyOwnship>,
);

fn command_parts(maneuver: &Maneuver) -> CommandParts {
    (stages(maneuver), maneuver.is_whole())
}

fn command_of((stages, is_whole): (Vec<PyRef<'_, PyStage>>, bool)) -> PyResult<Maneuver> {
    let mut maneuver = maneuver_of(&stages)?;
    if !is_whole {
        // The core refuses it, and notes that a stage was lost.
        maneuver.push(Stage {
            start_s: f64::NAN,
            course_rad: 0.0,
            climb_rad: 0.0,
            rate_share: 1.0,
        });
    }
    Ok(maneuver)
}

/// The threat that was pickled.
#[pyfunction]
pub(crate) fn _threat(id: u32, entry_s: f64, closest_s: f64, margin_m: f64) -> PyThreat {
    PyThreat(Threat {
        id,
        entry_s,
        closest_s,
        margin_m,
    })
}

/// The candidate that was pickled.
#[pyfunction]
pub(crate) fn _candidate(
    command: (Vec<PyRef<'_, PyStage>>, bool),
    margin_m: f64,
    cost: f64,
    verdict: &str,
) -> PyResult<PyCandidate> {
    let mut verdicts = [Verdict::Certified, Verdict::Rejected, Verdict::Chosen].into_iter();
    let verdict = verdicts
        .find(|known| verdict_word(*known) == verdict)
        .ok_or_else(|| {
            PyValueError::new_err(format!(
                "verdict is {verdict:?}, expected certified, rejected or chosen"
            ))
        })?;
    let worth = Candidate {
        margin_m,
        cost,
        verdict,
    };
    Ok(PyCandidate(command_of(command)?, worth))
}

/// The decision that was pickled.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "the parts of its record, each a value that pickles"
)]
pub(crate) fn _decision(
    state: &str,
    reason: &str,
    command: (Vec<PyRef<'_, PyStage>>, bool),
    threat: Option<PyRef<'_, PyThreat>>,
    candidates: (
        Option<PyRef<'_, PyCandidate>>,
        Option<PyRef<'_, PyCandidate>>,
    ),
    figures: (Option<f64>, Option<f64>, Option<f64>),
    chances: (Option<f64>, Option<f64>, Option<f64>),
    flags: (bool, bool, bool),
    work: (u32, u32, u32, u32, u32, u32),
    ownship: Option<PyRef<'_, PyOwnship>>,
) -> PyResult<PyDecision> {
    let mut reasons = Reason::ALL.into_iter();
    let record = Record {
        reason: reasons
            .find(|known| reason_key(*known) == reason)
            .ok_or_else(|| {
                PyValueError::new_err(format!(
                    "reason is {reason:?}, expected one of this version"
                ))
            })?,
        threat: threat.map(|threat| threat.0),
        latest_start_s: figures.0,
        start_s: figures.1,
        chosen: candidates.0.map(|candidate| candidate.1),
        alternative: candidates.1.map(|it| (it.0.to(), it.1)),
        resilience: figures.2,
        p_loss_hold: chances.0,
        p_loss: chances.1,
        proven_share: chances.2,
        in_need: flags.0,
        clock_set_back: flags.1,
        work: Work {
            tracked: work.0,
            threats: work.1,
            candidates: work.2,
            work: work.3,
            unusable: work.5,
            limit_met: flags.2,
        },
        straight_aircraft: work.4,
    };
    Ok(PyDecision {
        decision: Decision {
            state: state_of(state)?,
            // Nothing is proven about it: only the core makes a proof.
            command: command_of(command)?.into(),
            record,
        },
        ownship: ownship.map(|ownship| ownship.0),
    })
}
