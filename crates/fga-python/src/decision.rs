//! A decision and its reasons.

use fga::avoider::{
    Candidate as CoreCandidate, Decision as CoreDecision, Reason, State, Threat as CoreThreat,
    Verdict,
};
use fga::maneuver::{Maneuver, Stage as CoreStage};
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga_formats::words::{decision_words, reason_key};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::value::{Ownship, Vehicle, expect, frozen};

/// A command from a moment on, until the next stage begins.
///
/// `course_rad` is not wrapped: the aircraft turns by the plain difference to its own course.
#[pyclass(frozen, eq, module = "fga")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stage(pub(crate) CoreStage);

#[pymethods]
impl Stage {
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
        Ok(Self(CoreStage {
            start_s,
            course_rad,
            climb_rad,
            rate_share,
        }))
    }

    /// Its start, seconds from the moment of the decision.
    #[getter]
    fn start_s(&self) -> f64 {
        self.0.start_s
    }

    /// Course to turn to, radians.
    #[getter]
    fn course_rad(&self) -> f64 {
        self.0.course_rad
    }

    /// Climb angle to take up, radians.
    #[getter]
    fn climb_rad(&self) -> f64 {
        self.0.climb_rad
    }

    /// Share of the largest course rate to turn with.
    #[getter]
    fn rate_share(&self) -> f64 {
        self.0.rate_share
    }
}

frozen! { Stage, this,
    "course_rad": this.0.course_rad,
    "climb_rad": this.0.climb_rad,
    "start_s": this.0.start_s,
    "rate_share": this.0.rate_share,
}

/// The obstacle that a decision is about.
#[pyclass(frozen, eq, module = "fga")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Threat(CoreThreat);

#[pymethods]
impl Threat {
    /// The obstacle's identifier.
    #[getter]
    fn id(&self) -> u32 {
        self.0.id
    }

    /// Time of the entry into its volume on the mission, seconds from now.
    #[getter]
    fn entry_s(&self) -> f64 {
        self.0.entry_s
    }

    /// Time of the closest approach, seconds from now.
    #[getter]
    fn closest_s(&self) -> f64 {
        self.0.closest_s
    }

    /// Separation from its volume at that time, metres; negative inside.
    #[getter]
    fn margin_m(&self) -> f64 {
        self.0.margin_m
    }

    fn __repr__(&self) -> String {
        let Self(threat) = self;
        format!(
            "Threat(id={}, entry_s={:?}, closest_s={:?}, margin_m={:?})",
            threat.id, threat.entry_s, threat.closest_s, threat.margin_m
        )
    }
}

/// An examined manoeuvre.
#[pyclass(frozen, eq, module = "fga")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Candidate(CoreCandidate);

#[pymethods]
impl Candidate {
    /// Its commands.
    #[getter]
    fn stages(&self) -> Vec<Stage> {
        stages(&self.0.maneuver)
    }

    /// Certified lower bound of the separation beyond every volume, metres.
    #[getter]
    fn margin_m(&self) -> f64 {
        self.0.margin_m
    }

    /// Its cost.
    #[getter]
    fn cost(&self) -> f64 {
        self.0.cost
    }

    /// certified, rejected or chosen.
    #[getter]
    fn verdict(&self) -> &'static str {
        match self.0.verdict {
            Verdict::Certified => "certified",
            Verdict::Rejected => "rejected",
            Verdict::Chosen => "chosen",
        }
    }

    fn __repr__(&self) -> String {
        format!(
            "Candidate({} stages, margin_m={:?}, cost={:?}, verdict={:?})",
            self.0.maneuver.stages().len(),
            self.0.margin_m,
            self.0.cost,
            self.verdict()
        )
    }
}

fn stages(maneuver: &Maneuver) -> Vec<Stage> {
    maneuver.stages().iter().copied().map(Stage).collect()
}

/// The command until the next step, and its reasons.
///
/// `Decision(stages, state)` makes one, for a policy of your own. It does not pickle; `to_dict` does.
#[pyclass(frozen, module = "fga")]
#[derive(Debug)]
pub(crate) struct Decision {
    pub(crate) decision: CoreDecision,
    /// The aircraft of the decision.
    ownship: Option<fga::situation::Ownship>,
}

impl Decision {
    pub(crate) const fn of(decision: CoreDecision, ownship: fga::situation::Ownship) -> Self {
        Self {
            decision,
            ownship: Some(ownship),
        }
    }
}

#[pymethods]
impl Decision {
    #[new]
    #[pyo3(signature = (stages, state = "avoiding"))]
    fn new(stages: Vec<PyRef<'_, Stage>>, state: &str) -> PyResult<Self> {
        let state = match state {
            "cruise" => State::Cruise,
            "threatened" => State::Threatened,
            "avoiding" => State::Avoiding,
            "recovering" => State::Recovering,
            other => {
                return Err(PyValueError::new_err(format!(
                    "state is {other:?}, expected cruise, threatened, avoiding or recovering"
                )));
            }
        };
        let mut maneuver = Maneuver::hold();
        for stage in &stages {
            if !maneuver.push(stage.0) {
                return Err(PyValueError::new_err(format!(
                    "stages holds {} stages, expected at most {} in order of their start_s",
                    stages.len(),
                    fga::maneuver::MAX_STAGES
                )));
            }
        }
        let reason = match state {
            State::Cruise | State::Threatened => Reason::Clear,
            State::Avoiding => Reason::ManeuverKept,
            State::Recovering => Reason::RejoinKept,
        };
        Ok(Self {
            decision: CoreDecision::new(state, &maneuver, reason),
            ownship: None,
        })
    }

    /// State of the avoider: cruise, threatened, avoiding or recovering.
    #[getter]
    fn state(&self) -> &'static str {
        self.decision.state.name()
    }

    /// The reason, by its key in files.
    #[getter]
    fn reason(&self) -> &'static str {
        reason_key(self.decision.record.reason)
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

    /// The command: stages in order of their start; without any: hold course and climb angle.
    #[getter]
    fn command(&self) -> Vec<Stage> {
        stages(&self.decision.command)
    }

    /// The commanded stage this long after the decision, seconds; None before the first one.
    #[pyo3(signature = (after_s = 0.0))]
    fn stage_at(&self, after_s: f64) -> Option<Stage> {
        self.decision.command.stage_at(after_s).copied().map(Stage)
    }

    /// The predicted state of an aircraft with these limits some seconds after the decision, if nothing new
    /// happens, in still air.
    ///
    /// Raises ValueError for a decision of your own, which knows no aircraft, or a time that is not from 0 to
    /// 600.
    fn predicted(&self, vehicle: &Bound<'_, Vehicle>, after_s: f64) -> PyResult<Ownship> {
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
        Ok(Ownship(fga::situation::Ownship {
            position_m: state.position_m,
            course_rad: state.course_rad,
            climb_rad: state.climb_rad,
            bank_rad: state.bank_rad,
            ..own
        }))
    }

    /// The most urgent threat.
    #[getter]
    fn threat(&self) -> Option<Threat> {
        self.decision.record.threat.map(Threat)
    }

    /// Latest start of a certified manoeuvre, seconds from now; None where none exists.
    #[getter]
    fn latest_start_s(&self) -> Option<f64> {
        self.decision.record.latest_start_s
    }

    /// Start of the chosen manoeuvre, seconds from now.
    #[getter]
    fn start_s(&self) -> Option<f64> {
        self.decision.record.start_s
    }

    /// The manoeuvre, flown or awaited.
    #[getter]
    fn chosen(&self) -> Option<Candidate> {
        self.decision.record.chosen.map(Candidate)
    }

    /// The best manoeuvre to the other side, if there was a search for it.
    #[getter]
    fn alternative(&self) -> Option<Candidate> {
        self.decision.record.alternative.map(Candidate)
    }

    /// Share of the bounds of aircraft that the manoeuvre withstands.
    #[getter]
    fn resilience(&self) -> Option<f64> {
        self.decision.record.resilience
    }

    /// Obstacles within the surveillance radius.
    #[getter]
    fn tracked(&self) -> u32 {
        self.decision.record.work.tracked
    }

    /// Of these, those that threaten the mission.
    #[getter]
    fn threats(&self) -> u32 {
        self.decision.record.work.threats
    }

    /// Manoeuvres evaluated.
    #[getter]
    fn candidates(&self) -> u32 {
        self.decision.record.work.candidates
    }

    /// Work done, in the unit of `Settings.work_limit`.
    #[getter]
    fn work(&self) -> u32 {
        self.decision.record.work.work
    }

    /// Whether the step met its limit of work before the search ended.
    #[getter]
    fn limit_met(&self) -> bool {
        self.decision.record.work.limit_met
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.decision == other.decision
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
        dict.set_item("resilience", self.resilience())?;
        dict.set_item("limit_met", self.limit_met())?;
        Ok(dict)
    }
}
