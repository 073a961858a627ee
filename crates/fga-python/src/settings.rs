//! The settings of decisions, as a frozen Python class.

use fga::avoider::{Settings, Start};
use fga::search::Objective;
use fga_sim::policy::PolicyChoice;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::value::{frozen, properties, refused};

/// Settings of the avoider.
///
/// `start` is `free`, `t0`, `latest` or `Cs=0` to `Cs=1`; `objective` is `paper-cost`, `least-deviation` or
/// `shortest-path`. The pages of the crate `fga` have their meanings and ranges.
///
/// Raises ValueError, with the sentence of the program, for a setting out of range.
#[pyclass(name = "Settings", frozen, eq, module = "fga")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PySettings(pub(crate) Settings);

#[pymethods]
impl PySettings {
    #[new]
    #[pyo3(signature = (
        *, start = "free", decision_period_s = 0.1, surveillance_radius_m = f64::INFINITY, horizon_s = 60.0,
        margin_m = 0.05, confidence_sigmas = 3.0, heading_cost = 0.2, pitch_cost = 0.5,
        objective = "paper-cost", work_limit = 100_000, drift_mps = 0.0,
        loss_price_m = 42_000.0,
    ))]
    #[expect(
        clippy::too_many_arguments,
        reason = "one for each setting, by name in Python"
    )]
    fn new(
        start: &str,
        decision_period_s: f64,
        surveillance_radius_m: f64,
        horizon_s: f64,
        margin_m: f64,
        confidence_sigmas: f64,
        heading_cost: f64,
        pitch_cost: f64,
        objective: &str,
        work_limit: i64,
        drift_mps: f64,
        loss_price_m: f64,
    ) -> PyResult<Self> {
        let settings = Settings {
            start: match PolicyChoice::parse("turn-aware", Some(start)) {
                Ok(PolicyChoice::Avoider(start)) => start,
                Ok(_) => Start::Free,
                Err(message) => return Err(PyValueError::new_err(message)),
            },
            decision_period_s,
            surveillance_radius_m,
            horizon_s,
            margin_m,
            drift_mps,
            confidence_sigmas,
            heading_cost,
            pitch_cost,
            loss_price_m,
            objective: match objective {
                "paper-cost" => Objective::PaperCost,
                "least-deviation" => Objective::LeastDeviation,
                "shortest-path" => Objective::ShortestPath,
                other => {
                    return Err(PyValueError::new_err(format!(
                        "objective is {other:?}, expected paper-cost, least-deviation or shortest-path"
                    )));
                }
            },
            work_limit: u32::try_from(work_limit).map_err(|_| {
                PyValueError::new_err(format!(
                    "work_limit is {work_limit}, expected 10,000 to 4,294,967,295"
                ))
            })?,
        };
        settings.check().map_err(refused)?;
        Ok(Self(settings))
    }

    /// The start of a manoeuvre.
    #[getter]
    fn start(&self) -> String {
        match self.0.start {
            Start::Free => "free".into(),
            Start::AtDetection => "t0".into(),
            Start::Latest => "latest".into(),
            Start::Score(score) => format!("Cs={score}"),
        }
    }

    /// The measure of the cheapest manoeuvre.
    #[getter]
    fn objective(&self) -> &'static str {
        match self.0.objective {
            Objective::PaperCost => "paper-cost",
            Objective::LeastDeviation => "least-deviation",
            Objective::ShortestPath => "shortest-path",
        }
    }
}

properties! { PySettings, this,
    /// Time from one step to the next, seconds.
    decision_period_s: f64 = this.0.decision_period_s;
    /// Obstacles farther away do not count, metres.
    surveillance_radius_m: f64 = this.0.surveillance_radius_m;
    /// Horizon of the certificate, seconds.
    horizon_s: f64 = this.0.horizon_s;
    /// Distance kept beyond the protected volume, metres.
    margin_m: f64 = this.0.margin_m;
    /// Standard deviation of the velocity that carries the aircraft off its prediction, m/s.
    drift_mps: f64 = this.0.drift_mps;
    /// Standard deviations that widen an obstacle's volume.
    confidence_sigmas: f64 = this.0.confidence_sigmas;
    /// Cost of a change of course, per radian.
    heading_cost: f64 = this.0.heading_cost;
    /// Cost of a change of climb angle, per radian.
    pitch_cost: f64 = this.0.pitch_cost;
    /// Price of a loss of a protected volume, metres of departure, where chances decide.
    loss_price_m: f64 = this.0.loss_price_m;
    /// Most work of one step.
    work_limit: u32 = this.0.work_limit;
}

frozen! { PySettings, this,
    start, decision_period_s, surveillance_radius_m, horizon_s, margin_m, drift_mps,
    confidence_sigmas, heading_cost, pitch_cost, objective, loss_price_m, work_limit,
}
