//! The input of one decision.

use fga::Vec3;
use fga::situation::{Columns, Mission, Obstacle, Obstacles, Passing, Situation};
use numpy::{PyArray1, PyReadonlyArray1, PyUntypedArray, PyUntypedArrayMethods as _};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::airspace::{PyGround, PyZone};
use crate::value::{
    NewArguments, PyObstacle, PyOwnship, Triple, expect, expect_finite, frozen, properties, tuple,
};

/// A column of numbers: an array of float64, or any sequence of numbers. Copied, so that it cannot
/// change while a decision is made without the interpreter's lock.
pub(crate) fn numbers(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    if let Ok(array) = object.extract::<PyReadonlyArray1<'_, f64>>() {
        return Ok(array.as_array().to_vec());
    }
    let wrong = |found: String| {
        PyTypeError::new_err(format!(
            "column {name} is {found}, expected a one-dimensional array of float64"
        ))
    };
    if let Ok(array) = object.cast::<PyUntypedArray>() {
        let dimensions = array.ndim();
        let kind = array.dtype().to_string();
        if dimensions != 1 || !(kind.contains("int") || kind.contains("float")) {
            return Err(wrong(format!(
                "an array of {kind} with {dimensions} dimensions"
            )));
        }
    }
    object
        .try_iter()
        .and_then(|items| items.map(|item| item?.extract()).collect())
        .map_err(|_| wrong(object.get_type().to_string()))
}

/// A column of identifiers: an array of whole numbers, or any sequence of them.
fn identifiers(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Vec<u32>> {
    const EXPECTED: &str = "whole numbers from 0 to 4294967295";
    if let Ok(array) = object.extract::<PyReadonlyArray1<'_, u32>>() {
        return Ok(array.as_array().to_vec());
    }
    let outside = |found: &dyn core::fmt::Display, place: usize| {
        format!("column {name} holds {found} at {place}, expected {EXPECTED}")
    };
    if let Ok(array) = object.extract::<PyReadonlyArray1<'_, i64>>() {
        let ids = array.as_array();
        let ids = ids.iter().enumerate().map(|(place, id)| {
            u32::try_from(*id).map_err(|_| PyValueError::new_err(outside(id, place)))
        });
        return ids.collect();
    }
    if let Ok(array) = object.cast::<PyUntypedArray>() {
        let (kind, dimensions) = (array.dtype().to_string(), array.ndim());
        if dimensions != 1 || !kind.contains("int") {
            return Err(PyTypeError::new_err(format!(
                "column {name} is an array of {kind} with {dimensions} dimensions, expected one of {EXPECTED}"
            )));
        }
    }
    let items = object.try_iter().map_err(|_| {
        PyTypeError::new_err(format!(
            "column {name} is {}, expected {EXPECTED}",
            object.get_type()
        ))
    })?;
    items
        .enumerate()
        .map(|(place, item)| {
            let item = item?;
            item.extract().map_err(|_| {
                let found = outside(&item, place);
                if item.extract::<i128>().is_ok() {
                    PyValueError::new_err(found)
                } else {
                    PyTypeError::new_err(found)
                }
            })
        })
        .collect()
}

/// Many obstacles, one column per quantity: arrays of numpy, copied once.
///
/// Units as in `Obstacle`; every column has the length of `id`.
///
/// Raises ValueError for columns of different lengths, a number that is not finite, a length that is
/// negative or an identifier that is used twice; TypeError for a column of another type.
#[pyclass(name = "Obstacles", frozen, eq, module = "fga")]
#[derive(Debug, PartialEq)]
pub(crate) struct PyObstacles {
    id: Vec<u32>,
    columns: [Vec<f64>; 7],
    half_height_m: Option<Vec<f64>>,
    sigmas: Option<(Vec<f64>, Vec<f64>)>,
}

#[pymethods]
impl PyObstacles {
    #[new]
    #[pyo3(signature = (
        *, id, x_m, y_m, z_m, vx_mps, vy_mps, vz_mps, radius_m, half_height_m = None,
        position_sigma_m = None, velocity_sigma_mps = None,
    ))]
    #[expect(
        clippy::too_many_arguments,
        reason = "one for each column, by name in Python"
    )]
    fn new(
        id: &Bound<'_, PyAny>,
        x_m: &Bound<'_, PyAny>,
        y_m: &Bound<'_, PyAny>,
        z_m: &Bound<'_, PyAny>,
        vx_mps: &Bound<'_, PyAny>,
        vy_mps: &Bound<'_, PyAny>,
        vz_mps: &Bound<'_, PyAny>,
        radius_m: &Bound<'_, PyAny>,
        half_height_m: Option<&Bound<'_, PyAny>>,
        position_sigma_m: Option<&Bound<'_, PyAny>>,
        velocity_sigma_mps: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let ids = identifiers("id", id)?;
        let optional = |name: &str, column: Option<&Bound<'_, PyAny>>| {
            column.map(|column| numbers(name, column)).transpose()
        };
        let obstacles = Self {
            columns: [
                numbers("x_m", x_m)?,
                numbers("y_m", y_m)?,
                numbers("z_m", z_m)?,
                numbers("vx_mps", vx_mps)?,
                numbers("vy_mps", vy_mps)?,
                numbers("vz_mps", vz_mps)?,
                numbers("radius_m", radius_m)?,
            ],
            half_height_m: optional("half_height_m", half_height_m)?,
            sigmas: match (
                optional("position_sigma_m", position_sigma_m)?,
                optional("velocity_sigma_mps", velocity_sigma_mps)?,
            ) {
                (None, None) => None,
                (position, velocity) => Some((
                    position.unwrap_or_else(|| vec![0.0; ids.len()]),
                    velocity.unwrap_or_else(|| vec![0.0; ids.len()]),
                )),
            },
            id: ids,
        };
        obstacles.check()?;
        Ok(obstacles)
    }

    fn __len__(&self) -> usize {
        self.id.len()
    }

    fn __repr__(&self) -> String {
        format!("Obstacles({} obstacles)", self.id.len())
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py>> {
        let arguments = PyDict::new(py);
        let column = |values: &[f64]| PyArray1::from_slice(py, values);
        arguments.set_item("id", PyArray1::from_slice(py, &self.id))?;
        for (name, values) in NAMES.into_iter().zip(&self.columns) {
            arguments.set_item(name, column(values))?;
        }
        if let Some(values) = &self.half_height_m {
            arguments.set_item("half_height_m", column(values))?;
        }
        if let Some((position, velocity)) = &self.sigmas {
            arguments.set_item("position_sigma_m", column(position))?;
            arguments.set_item("velocity_sigma_mps", column(velocity))?;
        }
        Ok(((), arguments))
    }
}

/// The columns of numbers that every obstacle has.
const NAMES: [&str; 7] = [
    "x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps", "radius_m",
];

/// Refuses an identifier that is used twice, as the program does in its files: the core would learn one turn
/// of two obstacles.
fn expect_distinct(mut ids: Vec<u32>) -> PyResult<()> {
    ids.sort_unstable();
    let twice = ids
        .iter()
        .zip(ids.iter().skip(1))
        .find(|(one, next)| one == next);
    match twice {
        None => Ok(()),
        Some((id, _)) => Err(PyValueError::new_err(format!(
            "obstacle number {id} is used twice, expected a number of its own for each"
        ))),
    }
}

impl PyObstacles {
    fn check(&self) -> PyResult<()> {
        self.columns()
            .check()
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        let more = [
            ("half_height_m", self.half_height_m.as_ref()),
            (
                "position_sigma_m",
                self.sigmas.as_ref().map(|(position, _)| position),
            ),
            (
                "velocity_sigma_mps",
                self.sigmas.as_ref().map(|(_, velocity)| velocity),
            ),
        ];
        let all = NAMES
            .into_iter()
            .zip(self.columns.iter().map(Some))
            .chain(more);
        for (name, column) in all {
            let is_length = name == "radius_m" || !NAMES.contains(&name);
            for (place, value) in column.into_iter().flatten().enumerate() {
                if !value.is_finite() || (is_length && *value < 0.0) {
                    let expected = if is_length {
                        "0 or more"
                    } else {
                        "a finite number"
                    };
                    return Err(PyValueError::new_err(format!(
                        "column {name} holds {value} at {place}, expected {expected}"
                    )));
                }
            }
        }
        expect_distinct(self.id.clone())
    }

    fn columns(&self) -> Columns<'_> {
        let [x_m, y_m, z_m, vx_mps, vy_mps, vz_mps, radius_m] = &self.columns;
        Columns {
            id: &self.id,
            x_m,
            y_m,
            z_m,
            vx_mps,
            vy_mps,
            vz_mps,
            radius_m,
            half_height_m: self.half_height_m.as_deref(),
            uncertainty: self
                .sigmas
                .as_ref()
                .map(|(position, velocity)| (position.as_slice(), velocity.as_slice())),
            movement: None,
        }
    }
}

/// A mission: straight legs from waypoint to waypoint.
///
/// `waypoints_m` holds (east, north, up) triples or an array of shape (n, 3); `fly_over` the indices of the
/// waypoints that the aircraft passes over before the turn; `limits_m` the lowest and the highest altitude;
/// `zones` those of the airspace, `ground` the heights of the ground. No waypoint at all means: hold course and altitude.
///
/// Raises ValueError for a single waypoint or a number that is not finite.
#[pyclass(name = "Mission", frozen, eq, module = "fga")]
#[derive(Debug, PartialEq)]
pub(crate) struct PyMission {
    waypoints_m: Vec<Vec3>,
    passing: Vec<Passing>,
    limits_m: (f64, f64),
    zones: Vec<PyZone>,
    ground: Option<PyGround>,
}

#[pymethods]
impl PyMission {
    #[new]
    #[pyo3(signature = (waypoints_m, fly_over = Vec::new(), limits_m = (f64::NEG_INFINITY, f64::INFINITY), zones = Vec::new(), ground = None))]
    fn new(
        waypoints_m: &Bound<'_, PyAny>,
        fly_over: Vec<usize>,
        limits_m: (f64, f64),
        zones: Vec<PyZone>,
        ground: Option<PyGround>,
    ) -> PyResult<Self> {
        let waypoints_m: Vec<Vec3> = waypoints_m
            .try_iter()?
            .map(|item| Ok(item?.extract::<Triple>()?.0))
            .collect::<PyResult<_>>()?;
        let count = waypoints_m.len();
        if count == 1 {
            return Err(PyValueError::new_err(
                "waypoints_m holds 1 waypoint, expected at least 2, or none to hold course and altitude",
            ));
        }
        for waypoint in &waypoints_m {
            expect_finite("waypoints_m", *waypoint)?;
        }
        let mut passing = Vec::new();
        for index in fly_over {
            if index >= count {
                return Err(PyValueError::new_err(format!(
                    "fly_over names waypoint {index}, expected 0 to {}",
                    count.saturating_sub(1)
                )));
            }
            passing.resize(count, Passing::FlyBy);
            passing[index] = Passing::FlyOver;
        }
        Ok(Self {
            waypoints_m,
            passing,
            limits_m,
            zones,
            ground,
        })
    }

    /// Indices of the fly-over waypoints.
    #[getter]
    fn fly_over(&self) -> Vec<usize> {
        (0..)
            .zip(&self.passing)
            .filter_map(|(index, passing)| (*passing == Passing::FlyOver).then_some(index))
            .collect()
    }

    fn __len__(&self) -> usize {
        self.waypoints_m.len()
    }
}

properties! { PyMission, this,
    /// Waypoints, metres, local frame.
    waypoints_m: Vec<(f64, f64, f64)> = this.waypoints_m.iter().copied().map(tuple).collect();
    /// Lowest and highest altitude, metres.
    limits_m: (f64, f64) = this.limits_m;
    /// The zones.
    zones: Vec<PyZone> = this.zones.clone();
    /// The ground, if it is known.
    ground: Option<PyGround> = this.ground.clone();
}

impl PyMission {
    /// Number of the first waypoints that another mission has too; `None` where it has all of them and no other.
    pub(crate) fn kept_of(&self, other: &Self) -> Option<usize> {
        let of = |mission: &Self, index| {
            let passing = mission.passing.get(index).copied().unwrap_or_default();
            (mission.waypoints_m[index], passing)
        };
        let [count, others] = [self, other].map(|mission| mission.waypoints_m.len());
        let kept = (0..count.min(others))
            .take_while(|&index| of(self, index) == of(other, index))
            .count();
        ((count, others) != (kept, kept)).then_some(kept)
    }

    pub(crate) fn of(
        waypoints_m: Vec<Vec3>,
        mut passing: Vec<Passing>,
        limits_m: (f64, f64),
        (zones, ground): (Vec<PyZone>, Option<PyGround>),
    ) -> Self {
        // Beyond the end of the list a waypoint is fly-by, so that equal missions have equal lists.
        passing.truncate(waypoints_m.len());
        if passing.iter().all(|passing| *passing == Passing::FlyBy) {
            passing.clear();
        } else {
            passing.resize(waypoints_m.len(), Passing::FlyBy);
        }
        Self {
            waypoints_m,
            passing,
            limits_m,
            zones,
            ground,
        }
    }
}

frozen! { PyMission, this,
    waypoints_m, fly_over, limits_m, zones, ground,
}

/// The obstacles of a situation.
#[derive(Debug)]
pub(crate) enum ObstacleForm {
    Rows(Vec<Obstacle>),
    Columns(Py<PyObstacles>),
}

/// The input of one decision.
///
/// `time_s` is the time of the state on any clock that does not run backwards. `obstacles` are a sequence of
/// `Obstacle` or one `Obstacles`, over the ground. `wind_mps` is the velocity of the air over the ground.
///
/// Raises ValueError for a number that is not finite or too large, or two obstacles with the same `id`.
#[pyclass(name = "Situation", frozen, module = "fga")]
#[derive(Debug)]
pub(crate) struct PySituation {
    pub(crate) time_s: f64,
    pub(crate) ownship: fga::situation::Ownship,
    pub(crate) around: ObstacleForm,
    pub(crate) mission: Py<PyMission>,
    pub(crate) wind_mps: Vec3,
}

#[pymethods]
impl PySituation {
    #[new]
    #[pyo3(signature = (time_s, ownship, mission, obstacles = None, wind_mps = Triple(Vec3::ZERO)))]
    fn new(
        time_s: f64,
        ownship: &Bound<'_, PyOwnship>,
        mission: Py<PyMission>,
        obstacles: Option<&Bound<'_, PyAny>>,
        wind_mps: Triple,
    ) -> PyResult<Self> {
        expect(time_s.is_finite(), "time_s", time_s, "a finite number")?;
        expect_finite("wind_mps", wind_mps.0)?;
        let around = match obstacles {
            None => ObstacleForm::Rows(Vec::new()),
            Some(object) => match object.cast::<PyObstacles>() {
                Ok(columns) => ObstacleForm::Columns(columns.clone().unbind()),
                Err(_) => ObstacleForm::Rows(rows(object)?),
            },
        };
        let situation = Self {
            time_s,
            ownship: ownship.get().0,
            around,
            mission,
            wind_mps: wind_mps.0,
        };
        #[expect(
            clippy::redundant_closure_for_method_calls,
            reason = "the method holds for one lifetime only"
        )]
        let is_usable = situation.with(|situation| situation.is_usable());
        if !is_usable {
            return Err(PyValueError::new_err(
                "a number of the situation is too large, expected places up to 1e7 m, speeds up to 1e4 m/s, angles up to 1e4 rad, times up to 1e10 s",
            ));
        }
        Ok(situation)
    }

    /// The mission.
    #[getter]
    fn mission(&self, py: Python<'_>) -> Py<PyMission> {
        self.mission.clone_ref(py)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!(
            "Situation(time_s={}, ownship={}, {} obstacles, {} waypoints)",
            self.time_s.into_pyobject(py)?.repr()?,
            Bound::new(py, self.ownship())?.repr()?,
            self.with(|situation| situation.obstacles.len()),
            self.mission.get().waypoints_m.len()
        ))
    }

    fn __eq__(&self, other: &Self) -> bool {
        let same_obstacles = self.with(|one| {
            other.with(|two| {
                one.obstacles.len() == two.obstacles.len()
                    && one.obstacles.iter().eq(two.obstacles.iter())
            })
        });
        same_obstacles
            && self.time_s == other.time_s
            && self.ownship == other.ownship
            && self.mission.get() == other.mission.get()
            && self.wind_mps == other.wind_mps
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py>> {
        let arguments = PyDict::new(py);
        arguments.set_item("time_s", self.time_s)?;
        arguments.set_item("ownship", self.ownship())?;
        arguments.set_item("mission", self.mission(py))?;
        match &self.around {
            ObstacleForm::Rows(_) => arguments.set_item("obstacles", self.obstacles())?,
            ObstacleForm::Columns(columns) => arguments.set_item("obstacles", columns)?,
        }
        arguments.set_item("wind_mps", self.wind_mps())?;
        Ok(((), arguments))
    }
}

properties! { PySituation, this,
    /// Time of the state, seconds.
    time_s: f64 = this.time_s;
    /// The aircraft.
    ownship: PyOwnship = PyOwnship(this.ownship);
    /// The obstacles, one record each.
    obstacles: Vec<PyObstacle> = this.with(|situation| situation.obstacles.iter().map(PyObstacle).collect());
    /// Velocity of the air over the ground, metres per second.
    wind_mps: (f64, f64, f64) = tuple(this.wind_mps);
}

/// A sequence of obstacles with distinct identifiers.
fn rows(object: &Bound<'_, PyAny>) -> PyResult<Vec<Obstacle>> {
    let wrong = |found: &Bound<'_, PyAny>| {
        PyTypeError::new_err(format!(
            "obstacles holds {}, expected a sequence of Obstacle or one Obstacles",
            found.get_type()
        ))
    };
    let mut rows = Vec::new();
    for item in object.try_iter().map_err(|_| wrong(object))? {
        let item = item?;
        rows.push(item.cast::<PyObstacle>().map_err(|_| wrong(&item))?.get().0);
    }
    expect_distinct(rows.iter().map(|row| row.id).collect())?;
    Ok(rows)
}

impl PySituation {
    /// Passes the situation to the core.
    pub(crate) fn with<T>(&self, show: impl FnOnce(&Situation<'_>) -> T) -> T {
        let mission = self.mission.get();
        let zones: Vec<_> = mission.zones.iter().map(|zone| zone.0.zone()).collect();
        let ground = mission.ground.as_ref().and_then(|ground| ground.0.ground());
        show(&Situation {
            time_s: self.time_s,
            ownship: self.ownship,
            obstacles: match &self.around {
                ObstacleForm::Rows(rows) => Obstacles::Rows(rows),
                ObstacleForm::Columns(columns) => Obstacles::Columns(columns.get().columns()),
            },
            mission: Mission {
                waypoints_m: &mission.waypoints_m,
                passing: &mission.passing,
                limits_m: mission.limits_m,
                zones: &zones,
                ground: ground.as_ref(),
            },
            wind_mps: self.wind_mps,
        })
    }
}
