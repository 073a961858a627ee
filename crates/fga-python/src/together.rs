//! Policies that answer for many flights at once: tables in, a table out.

use arrow_array::cast::AsArray as _;
use arrow_array::types::Float64Type;
use arrow_array::{Array as _, RecordBatch};
use arrow_schema::DataType;
use fga::situation::ProtectedVolume;
use fga_campaign::batch::{
    BatchError, BatchRow, BatchSettings, Questions, empty_world, fly_together,
};
use fga_campaign::drawn::RowTable;
use fga_sim::own::{FailureKind, PolicyAnswer, PolicyFailure};
use fga_sim::policy::PolicySettings;
use pyo3::prelude::*;

use crate::own::{STEP_ALL, Thread, made, raised};
use crate::table::{ArrayColumn, PyTable, batches_of};
use crate::value::movement_word;
use crate::work::SharedWork;

/// The columns of two tables: flights and obstacles.
type ColumnTables = [Vec<(&'static str, ArrayColumn)>; 2];

/// A question to the thread of the policy.
enum ThreadQuestion {
    /// Make the policy for the flights that begin.
    Begin,
    /// Answer for flights.
    Step(ColumnTables),
}

/// Flies encounters side by side, by one call of the policy for each step of all flights.
pub(crate) fn fly(
    policy: Py<PyAny>,
    limit_s: f64,
    (rows, settings): (&RowTable, &BatchSettings),
    shared: &SharedWork,
    take: impl FnMut(&BatchRow) -> Result<(), &'static str>,
) -> Result<(), BatchError<&'static str>> {
    let of_flights: PolicySettings = match empty_world(settings) {
        Some(world) => world.settings,
        None => settings.model.settings,
    };
    let vehicle = settings.model.vehicle;
    let policy = std::sync::Arc::new(policy);
    let mut thread: Result<Thread<ThreadQuestion, Vec<PolicyAnswer>>, PolicyFailure> = Err(
        PolicyFailure::new(FailureKind::Ended, "the policy has not begun"),
    );
    let thread = std::cell::RefCell::new(&mut thread);
    let begin = || {
        let policy = std::sync::Arc::clone(&policy);
        let mut step = None;
        let started = Thread::start(move |py, question| {
            let tables = match question {
                ThreadQuestion::Begin => {
                    let calls = made(py, &policy, STEP_ALL, &of_flights, &vehicle);
                    step = Some(calls.map_err(|error| raised(py, &error))?.0);
                    return Ok(Vec::new());
                }
                ThreadQuestion::Step(tables) => tables,
            };
            let Some(step) = &step else {
                return Err(PolicyFailure::new(
                    FailureKind::Ended,
                    "the policy was not made",
                ));
            };
            answers(py, step, tables)
        });
        **thread.borrow_mut() = started.and_then(|thread| {
            thread.ask(ThreadQuestion::Begin, limit_s.max(10.0))??;
            Ok(thread)
        });
    };
    let answer = |questions: &Questions<'_>| {
        if !shared.goes_on() {
            return Err(PolicyFailure::new(FailureKind::Ended, "interrupted"));
        }
        let mut thread = thread.borrow_mut();
        let answer = match &**thread {
            Ok(thread) => thread.ask(ThreadQuestion::Step(tables(questions)), limit_s),
            Err(failure) => return Err(failure.clone()),
        };
        answer.and_then(|answer| answer).inspect_err(|failure| {
            // The flights of this group fly on without it.
            **thread = Err(failure.clone());
        })
    };
    fly_together(rows, settings, begin, answer, take)
}

fn tables(questions: &Questions<'_>) -> ColumnTables {
    let real = |get: fn(&fga::situation::Ownship) -> f64| {
        ArrayColumn::Real(questions.iter().map(|(_, _, s)| get(&s.ownship)).collect())
    };
    let encounters = questions.iter().map(|(encounter, _, _)| *encounter);
    let flights = vec![
        ("encounter", ArrayColumn::Whole(encounters.collect())),
        (
            "begins",
            ArrayColumn::Flag(questions.iter().map(|(_, begins, _)| *begins).collect()),
        ),
        (
            "time_s",
            ArrayColumn::Real(questions.iter().map(|(_, _, s)| s.time_s).collect()),
        ),
        ("x_m", real(|own| own.position_m.x)),
        ("y_m", real(|own| own.position_m.y)),
        ("z_m", real(|own| own.position_m.z)),
        ("course_rad", real(|own| own.course_rad)),
        ("climb_rad", real(|own| own.climb_rad)),
        ("bank_rad", real(|own| own.bank_rad)),
        ("airspeed_mps", real(|own| own.airspeed_mps)),
    ];
    let rows: Vec<_> = questions
        .iter()
        .enumerate()
        .flat_map(|(flight, (_, _, s))| s.obstacles.iter().map(move |o| (flight as u64, o)))
        .collect();
    let real = |get: fn(&fga::situation::Obstacle) -> f64| {
        ArrayColumn::Real(rows.iter().map(|(_, obstacle)| get(obstacle)).collect())
    };
    let half_height_m = |obstacle: &fga::situation::Obstacle| match obstacle.volume {
        ProtectedVolume::Sphere { .. } => None,
        ProtectedVolume::Cylinder { half_height_m, .. } => Some(half_height_m),
    };
    let obstacles = vec![
        (
            "flight",
            ArrayColumn::Whole(rows.iter().map(|(flight, _)| *flight).collect()),
        ),
        (
            "obstacle",
            ArrayColumn::Whole(rows.iter().map(|(_, o)| o.id.into()).collect()),
        ),
        ("x_m", real(|o| o.position_m.x)),
        ("y_m", real(|o| o.position_m.y)),
        ("z_m", real(|o| o.position_m.z)),
        ("vx_mps", real(|o| o.velocity_mps.x)),
        ("vy_mps", real(|o| o.velocity_mps.y)),
        ("vz_mps", real(|o| o.velocity_mps.z)),
        ("radius_m", real(|o| o.volume.radius_m())),
        (
            "half_height_m",
            ArrayColumn::MaybeReal(rows.iter().map(|(_, o)| half_height_m(o)).collect()),
        ),
        (
            "kind",
            ArrayColumn::Text(
                rows.iter()
                    .map(|(_, o)| movement_word(o.movement).into())
                    .collect(),
            ),
        ),
    ];
    [flights, obstacles]
}

/// The answers of the policy, one for each flight.
fn answers(
    py: Python<'_>,
    step: &Py<PyAny>,
    tables: ColumnTables,
) -> Result<Vec<PolicyAnswer>, PolicyFailure> {
    let wrong = |message: String| PolicyFailure::new(FailureKind::WrongShape, message);
    let [flights, obstacles] = tables.map(PyTable::of);
    let call = || -> PyResult<Py<PyAny>> { step.call1(py, (flights?, obstacles?)) };
    let answer = call().map_err(|error| raised(py, &error))?;
    let batches = batches_of(answer.bind(py)).map_err(|_| {
        let kind = answer.bind(py).get_type();
        wrong(format!(
            "returned {kind}, expected a table with the columns course_rad and climb_rad"
        ))
    })?;
    let mut answers = Vec::new();
    for batch in &batches {
        let (course_rad, climb_rad) = (reals(batch, "course_rad")?, reals(batch, "climb_rad")?);
        answers.extend(
            course_rad
                .into_iter()
                .zip(climb_rad)
                .map(|(course_rad, climb_rad)| match course_rad {
                    None => PolicyAnswer::Mission,
                    Some(course_rad) => PolicyAnswer::Heading {
                        course_rad,
                        climb_rad: climb_rad.unwrap_or(0.0),
                    },
                }),
        );
    }
    Ok(answers)
}

/// A column of numbers with gaps.
fn reals(batch: &RecordBatch, name: &str) -> Result<Vec<Option<f64>>, PolicyFailure> {
    let wrong = |message: String| PolicyFailure::new(FailureKind::WrongShape, message);
    let column = batch.column_by_name(name).ok_or_else(|| {
        wrong(format!(
            "returned a table without the column {name}, expected the columns course_rad and climb_rad"
        ))
    })?;
    match column.data_type() {
        DataType::Float64 => Ok(column.as_primitive::<Float64Type>().iter().collect()),
        DataType::Null => Ok(vec![None; column.len()]),
        other => Err(wrong(format!(
            "returned a column {name} of type {other}, expected double numbers"
        ))),
    }
}
