//! Flies encounters from files or tables: `fga batch` and `fga oracle`.

use core::sync::atomic::Ordering;
use std::path::PathBuf;

use arrow_array::cast::AsArray as _;
use arrow_array::types::{Float32Type, Float64Type, Int32Type, Int64Type, UInt32Type, UInt64Type};
use arrow_array::{Array, RecordBatch};
use arrow_schema::DataType;
use fga::Vec3;
use fga::situation::{Obstacle, ProtectedVolume};
use fga_campaign::batch::{
    BatchError, BatchRow, BatchSettings, FAILURE_COLUMN, MoreColumns, fly_all, result_columns,
};
use fga_campaign::drawn::{self, RowTable};
use fga_campaign::oracle::{AVOIDABLE_MARGIN_M, Judge};
use fga_formats::InputError;
use fga_formats::encounters::{self, COLUMNS, Encounter, KIND_COLUMN, movement_of};
use fga_formats::number::push_fixed;
use fga_sim::vehicle_file::VehicleModel;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::failure::input;
use crate::own::{LIMIT_S, Policy, is_for_all, warn_of_failures};
use crate::pilot::model_of;
use crate::table::{ArrayColumn, PyTable, batches_of};
use crate::together;
use crate::work::interruptible;

/// Encounters searched between two checks of Ctrl-C.
const BLOCK: usize = 64;

/// A column of whole numbers from 0.
fn whole(batch: &RecordBatch, name: &str) -> PyResult<Vec<u64>> {
    fn of<T: TryInto<u64>>(values: impl Iterator<Item = T>) -> Option<Vec<u64>> {
        values.map(|value| value.try_into().ok()).collect()
    }
    let array = column(batch, name)?;
    let wrong = || {
        PyValueError::new_err(format!(
            "column {name} is of type {}, expected whole numbers from 0",
            array.data_type()
        ))
    };
    match array.data_type() {
        DataType::UInt64 => Some(array.as_primitive::<UInt64Type>().values().to_vec()),
        DataType::UInt32 => of(array.as_primitive::<UInt32Type>().values().iter().copied()),
        DataType::Int64 => of(array.as_primitive::<Int64Type>().values().iter().copied()),
        DataType::Int32 => of(array.as_primitive::<Int32Type>().values().iter().copied()),
        _ => None,
    }
    .ok_or_else(wrong)
}

/// A column of numbers.
fn real(batch: &RecordBatch, name: &str) -> PyResult<Vec<f64>> {
    let array = column(batch, name)?;
    match array.data_type() {
        DataType::Float64 => Ok(array.as_primitive::<Float64Type>().values().to_vec()),
        DataType::Float32 => Ok(widened(array.as_primitive::<Float32Type>().values())),
        DataType::Int32 => Ok(widened(array.as_primitive::<Int32Type>().values())),
        #[expect(
            clippy::cast_precision_loss,
            reason = "a whole number of metres is far below 2^53"
        )]
        DataType::Int64 => {
            let values = array.as_primitive::<Int64Type>().values();
            Ok(values.iter().map(|value| *value as f64).collect())
        }
        other => Err(PyValueError::new_err(format!(
            "column {name} is of type {other}, expected numbers"
        ))),
    }
}

fn widened<T: Copy + Into<f64>>(values: &[T]) -> Vec<f64> {
    values.iter().map(|value| (*value).into()).collect()
}

/// A column without gaps.
fn column<'a>(batch: &'a RecordBatch, name: &str) -> PyResult<&'a dyn Array> {
    let array = batch.column_by_name(name).ok_or_else(|| {
        PyValueError::new_err(format!(
            "the column {name} is missing, expected the columns {}",
            COLUMNS.join(",")
        ))
    })?;
    if array.null_count() > 0 {
        return Err(PyValueError::new_err(format!(
            "column {name} has {} empty fields, expected none",
            array.null_count()
        )));
    }
    Ok(array.as_ref())
}

/// The words of the column `kind`, if it exists.
fn kinds(batch: &RecordBatch) -> PyResult<Option<Vec<String>>> {
    let Some(array) = batch.column_by_name(KIND_COLUMN) else {
        return Ok(None);
    };
    let word = |word: Option<&str>| word.unwrap_or_default().to_owned();
    Ok(Some(match array.data_type() {
        DataType::Utf8 => array.as_string::<i32>().iter().map(word).collect(),
        DataType::LargeUtf8 => array.as_string::<i64>().iter().map(word).collect(),
        DataType::Utf8View => array.as_string_view().iter().map(word).collect(),
        other => {
            return Err(PyValueError::new_err(format!(
                "column {KIND_COLUMN} is of type {other}, expected text"
            )));
        }
    }))
}

/// The rows of one batch.
fn rows_of(batch: &RecordBatch, rows: &mut Vec<(u64, Obstacle)>) -> PyResult<()> {
    let [encounter, obstacle, names @ ..] = COLUMNS;
    let (encounter, obstacle) = (whole(batch, encounter)?, whole(batch, obstacle)?);
    let mut values = Vec::with_capacity(names.len());
    for name in names {
        values.push(real(batch, name)?);
    }
    let kinds = kinds(batch)?;
    for row in 0..batch.num_rows() {
        let at = |index: usize| values[index][row];
        let word = kinds.as_ref().map_or("", |kinds| kinds[row].as_str());
        let movement = movement_of(word.as_bytes()).ok_or_else(|| {
            PyValueError::new_err(format!(
                "column {KIND_COLUMN} holds {word:?}, expected still, straight, aircraft or uas"
            ))
        })?;
        let id = u32::try_from(obstacle[row]).map_err(|_| {
            PyValueError::new_err(format!(
                "column obstacle holds {}, expected a whole number from 0 to {}",
                obstacle[row],
                u32::MAX
            ))
        })?;
        let volume = ProtectedVolume::Sphere { radius_m: at(6) };
        let place_m = Vec3::new(at(0), at(1), at(2));
        let velocity_mps = Vec3::new(at(3), at(4), at(5));
        let obstacle = Obstacle {
            movement,
            ..Obstacle::straight(id, place_m, velocity_mps, volume)
        };
        rows.push((encounter[row], obstacle));
    }
    Ok(())
}

/// Encounters from a file of `fga batch`, or from a table with its columns.
fn encounters_of(object: &Bound<'_, PyAny>) -> PyResult<RowTable> {
    if object.hasattr("__arrow_c_stream__")? {
        let mut rows = Vec::new();
        for batch in batches_of(object)? {
            rows_of(&batch, &mut rows)?;
        }
        let rows = encounters::from_rows(rows).map_err(PyValueError::new_err)?;
        return Ok(rows.into());
    }
    let path: PathBuf = object.extract().map_err(|_| {
        PyTypeError::new_err(format!(
            "encounters is {}, expected the path of a file or a table with the Arrow PyCapsule interface",
            object.get_type()
        ))
    })?;
    object
        .py()
        .detach(|| drawn::read_rows(&path))
        .map_err(input)
}

fn model_or_built_in(vehicle: Option<&Bound<'_, PyAny>>) -> PyResult<VehicleModel> {
    model_of(vehicle)?
        .map_or_else(VehicleModel::built_in, Ok)
        .map_err(input)
}

/// A positive number of seconds, at most a day, as in the program.
fn checked_horizon(horizon_s: f64) -> PyResult<f64> {
    if horizon_s > 0.0 && horizon_s <= 86_400.0 {
        return Ok(horizon_s);
    }
    Err(PyValueError::new_err(format!(
        "horizon_s is {horizon_s}, expected a positive number of seconds, at most 86400"
    )))
}

/// As written, with six decimals.
fn written(value: f64) -> f64 {
    (value * 1e6).round_ties_even() / 1e6 + 0.0
}

/// Flies many encounters: `fga batch`.
///
/// `encounters` is the path of a CSV file or of a folder that `fga campaign draw` wrote, or a table with the columns of the CSV file. `policy` is a name, or one of your own: a class or an
/// object with `step(situation)`, with `step_all(flights, obstacles)` for many flights at once, or a function of the
/// situation; `time_limit_s` is its time for a step. The table has the numbers of results.csv, whose bytes `to_csv` gives. `progress(done, total)` is called during the work.
#[pyfunction]
#[pyo3(signature = (
    encounters, policy = Policy::Default, vehicle = None, horizon_s = 60.0, seed = 0, threads = None,
    progress = None, time_limit_s = LIMIT_S,
))]
#[expect(
    clippy::too_many_arguments,
    reason = "the options of the program, by name in Python"
)]
pub(crate) fn batch(
    py: Python<'_>,
    encounters: &Bound<'_, PyAny>,
    policy: Policy<'_>,
    vehicle: Option<&Bound<'_, PyAny>>,
    horizon_s: f64,
    seed: u64,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
    time_limit_s: f64,
) -> PyResult<PyTable> {
    let settings = BatchSettings {
        model: model_or_built_in(vehicle)?,
        policy: policy.for_all(time_limit_s)?,
        horizon_s: checked_horizon(horizon_s)?,
        seed,
        tracks: false,
    };
    let encounters = encounters_of(encounters)?;
    let more = MoreColumns {
        is_bounded: encounters.surroundings.exist(),
        is_own: settings.policy.own().is_some(),
        is_named: false,
    };
    let for_all = match &policy {
        Policy::Given(policy) if is_for_all(policy)? => Some(policy.clone().unbind()),
        _ => None,
    };
    let flown = interruptible(py, threads, progress, |shared| {
        shared
            .total
            .store(encounters.encounters.len() as u64, Ordering::Relaxed);
        let mut csv = (result_columns(more) + "\n").into_bytes();
        let mut rows = Vec::with_capacity(encounters.encounters.len());
        let take = |row: &BatchRow| {
            if !shared.goes_on() {
                return Err("interrupted");
            }
            row.push_result(&mut csv, more, None);
            rows.push((row.encounter, row.separated(), row.outcome, row.failure));
            shared.done.fetch_add(1, Ordering::Relaxed);
            Ok(())
        };
        match for_all {
            Some(policy) => {
                together::fly(policy, time_limit_s, (&encounters, &settings), shared, take)
            }
            None => fly_all(&encounters, &settings, take),
        }
        .map(|()| (csv, rows))
    })?;
    let (csv, rows) = flown.map_err(|error| match error {
        BatchError::Sink(message) => PyValueError::new_err(message),
        other => PyValueError::new_err(other.to_string()),
    })?;
    let real = |name, get: fn(&fga_sim::engine::Outcome) -> f64| {
        (
            name,
            ArrayColumn::Real(rows.iter().map(|row| written(get(&row.2))).collect()),
        )
    };
    let maybe = |name, get: fn(&fga_sim::engine::Outcome) -> Option<f64>| {
        (
            name,
            ArrayColumn::MaybeReal(rows.iter().map(|row| get(&row.2).map(written)).collect()),
        )
    };
    warn_of_failures(py, [&settings.policy])?;
    let mut columns = vec![
        (
            "encounter",
            ArrayColumn::Whole(rows.iter().map(|row| row.0).collect()),
        ),
        (
            "separated",
            ArrayColumn::Flag(rows.iter().map(|row| row.1).collect()),
        ),
        real("min_separation_m", |outcome| outcome.min_separation_m),
        real("min_margin_m", |outcome| outcome.min_margin_m),
        maybe("start_s", |outcome| outcome.start_s),
        maybe("clear_s", |outcome| outcome.clear_s),
        real("max_cross_track_m", |outcome| outcome.max_cross_track_m),
        real("extra_path_m", |outcome| outcome.extra_path_m),
        (
            "waypoints_missed",
            ArrayColumn::Whole(
                rows.iter()
                    .map(|row| row.2.waypoints_missed as u64)
                    .collect(),
            ),
        ),
    ];
    if more.is_bounded {
        columns.push(maybe("min_terrain_clearance_m", |outcome| {
            let above_m = outcome.min_terrain_clearance_m;
            above_m.filter(|above_m| above_m.is_finite())
        }));
        columns.push(maybe("min_zone_margin_m", |outcome| {
            outcome.min_zone_margin_m
        }));
    }
    if more.is_own {
        let words = rows.iter().map(|row| Some(row.3?.name().to_owned()));
        columns.push((FAILURE_COLUMN, ArrayColumn::MaybeText(words.collect())));
    }
    Ok(PyTable::of(columns)?.with_csv(csv))
}

/// Finds for each encounter whether any manoeuvre could save it: `fga oracle`.
#[pyfunction]
#[pyo3(signature = (encounters, vehicle = None, horizon_s = 60.0, threads = None, progress = None))]
pub(crate) fn oracle(
    py: Python<'_>,
    encounters: &Bound<'_, PyAny>,
    vehicle: Option<&Bound<'_, PyAny>>,
    horizon_s: f64,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyTable> {
    let model = model_or_built_in(vehicle)?;
    let judge = Judge::new(&model, checked_horizon(horizon_s)?).map_err(PyValueError::new_err)?;
    let rows = encounters_of(encounters)?;
    let encounters = &rows.encounters;
    let margins = interruptible(py, threads, progress, |shared| {
        shared
            .total
            .store(encounters.len() as u64, Ordering::Relaxed);
        let mut margins: Vec<f64> = Vec::with_capacity(encounters.len());
        for block in encounters.chunks(BLOCK) {
            if !shared.goes_on() {
                break;
            }
            let of = |encounter: &Encounter| {
                let scenery = rows.surroundings.scenery(encounter.id)?;
                Ok(judge.best_margin_among_m(encounter, &scenery))
            };
            let found: Result<Vec<f64>, InputError> = block.par_iter().map(of).collect();
            margins.extend(found?);
            shared.done.fetch_add(block.len() as u64, Ordering::Relaxed);
        }
        Ok(margins)
    })?
    .map_err(input)?;
    let mut csv = b"encounter,avoidable,best_margin_m\n".to_vec();
    for (encounter, margin_m) in encounters.iter().zip(&margins) {
        let avoidable = *margin_m >= AVOIDABLE_MARGIN_M;
        csv.extend_from_slice(format!("{},{avoidable},", encounter.id).as_bytes());
        push_fixed(&mut csv, *margin_m, 6);
        csv.push(b'\n');
    }
    let avoidable = margins
        .iter()
        .map(|margin_m| *margin_m >= AVOIDABLE_MARGIN_M)
        .collect();
    let table = PyTable::of(vec![
        (
            "encounter",
            ArrayColumn::Whole(encounters.iter().map(|encounter| encounter.id).collect()),
        ),
        ("avoidable", ArrayColumn::Flag(avoidable)),
        ("best_margin_m", ArrayColumn::Real(margins)),
    ])?;
    Ok(table.with_csv(csv))
}
