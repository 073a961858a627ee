//! The zones and the ground of a mission.

use std::sync::Arc;

use fga::Vec2;
use fga_sim::world::{WorldGround, WorldOutline, WorldZone};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::value::{frozen, properties};

/// A zone: a polygon or a circle, seen from above, between two altitudes.
///
/// `polygon_m` holds 3 to 256 corners (east, north) in order; `center_m` and `radius_m` make a circle instead. With `keep_in` the aircraft stays
/// within it, else out of it. Altitudes are metres, infinite without a limit.
///
/// Raises ValueError for a polygon that crosses itself, too many corners, a number that is not finite, or a floor above the ceiling.
#[pyclass(name = "Zone", frozen, eq, from_py_object, module = "fga")]
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PyZone(pub(crate) WorldZone);

#[pymethods]
impl PyZone {
    #[new]
    #[pyo3(signature = (
        *, keep_in = false, polygon_m = None, center_m = None, radius_m = None, floor_m = f64::NEG_INFINITY, ceiling_m = f64::INFINITY,
    ))]
    fn new(
        keep_in: bool,
        polygon_m: Option<&Bound<'_, PyAny>>,
        center_m: Option<(f64, f64)>,
        radius_m: Option<f64>,
        floor_m: f64,
        ceiling_m: f64,
    ) -> PyResult<Self> {
        let wrong = |message: String| PyValueError::new_err(message);
        let outline = match (polygon_m, center_m, radius_m) {
            (Some(corners), None, None) => {
                let corners = corners.try_iter()?.map(|corner| place(&corner?));
                let corners = corners.collect::<PyResult<Vec<Vec2>>>()?;
                let corners = fga_formats::zones::polygon(corners);
                WorldOutline::Polygon(corners.map_err(|error| wrong(error.to_string()))?)
            }
            (None, Some((x, y)), Some(radius_m))
                if radius_m > 0.0 && (x + y + radius_m).is_finite() =>
            {
                let center_m = Vec2::new(x, y);
                WorldOutline::Circle { center_m, radius_m }
            }
            _ => {
                return Err(wrong(
                    "a zone has no outline, expected polygon_m, or center_m with a positive radius_m".into(),
                ));
            }
        };
        let zone = WorldZone::new(String::new(), keep_in, outline, (floor_m, ceiling_m));
        zone.map(Self).map_err(|error| wrong(error.to_string()))
    }

    /// Corners of a polygon (east, north), metres; None for a circle.
    #[getter]
    fn polygon_m(&self) -> Option<Vec<(f64, f64)>> {
        match self.0.outline() {
            WorldOutline::Polygon(corners) => Some(corners.iter().map(|at| (at.x, at.y)).collect()),
            WorldOutline::Circle { .. } => None,
        }
    }

    /// Centre of a circle (east, north), metres; None for a polygon.
    #[getter]
    fn center_m(&self) -> Option<(f64, f64)> {
        match self.0.outline() {
            WorldOutline::Circle { center_m, .. } => Some((center_m.x, center_m.y)),
            WorldOutline::Polygon(_) => None,
        }
    }

    /// Radius of a circle, metres; None for a polygon.
    #[getter]
    fn radius_m(&self) -> Option<f64> {
        match self.0.outline() {
            WorldOutline::Circle { radius_m, .. } => Some(*radius_m),
            WorldOutline::Polygon(_) => None,
        }
    }
}

properties! { PyZone, this,
    /// Whether the aircraft stays within it, not out of it.
    keep_in: bool = this.0.keep_in();
    /// Lowest altitude, metres.
    floor_m: f64 = this.0.heights_m().0;
    /// Highest altitude, metres.
    ceiling_m: f64 = this.0.heights_m().1;
}

frozen! { PyZone, this,
    keep_in, polygon_m, center_m, radius_m, floor_m, ceiling_m,
}

/// East and north of a corner, metres.
fn place(corner: &Bound<'_, PyAny>) -> PyResult<Vec2> {
    let mut numbers = corner.try_iter()?.map(|number| number?.extract::<f64>());
    let mut next = || numbers.next().transpose();
    match (next()?, next()?, next()?) {
        (Some(x), Some(y), None) => Ok(Vec2::new(x, y)),
        _ => Err(PyTypeError::new_err(
            "expected corners of two numbers: east, north",
        )),
    }
}

/// Heights of the ground on a regular grid, bilinear in between.
///
/// `heights_m` is an array of shape (rows, columns): rows from the south, columns from the west, metres, NaN where unknown. `corner_m` is the
/// south-west post (east, north), `spacing_m` the distance between posts east and north. `error_m` is the vertical error of the heights,
/// `clearance_m` the height above them that is asked for. Copied once.
///
/// Raises ValueError for an array with less than 2 rows or columns, lengths that are not positive, or numbers that are not finite.
#[pyclass(name = "Ground", frozen, from_py_object, module = "fga")]
#[derive(Debug, Clone)]
pub(crate) struct PyGround(pub(crate) Arc<WorldGround>);

#[pymethods]
impl PyGround {
    #[new]
    #[pyo3(signature = (heights_m, corner_m, spacing_m, clearance_m, error_m = 0.0))]
    fn new(
        heights_m: &Bound<'_, PyAny>,
        corner_m: (f64, f64),
        spacing_m: (f64, f64),
        clearance_m: f64,
        error_m: f64,
    ) -> PyResult<Self> {
        let array = heights_m.call_method1("astype", ("float32",));
        let array: PyReadonlyArray2<'_, f32> =
            array.and_then(|array| array.extract()).map_err(|_| {
                PyTypeError::new_err(
                    "heights_m is no array of two dimensions, expected one of rows and columns",
                )
            })?;
        let array = array.as_array();
        let place = (corner_m.into(), spacing_m.into());
        let heights_m = array.iter().copied().collect();
        let ground = WorldGround::new(place, array.ncols(), heights_m, (error_m, clearance_m));
        ground
            .map(|ground| Self(Arc::new(ground)))
            .map_err(|error| PyValueError::new_err(format!("a ground whose {error}")))
    }

    /// The heights of the posts, metres: rows from the south, columns from the west; a copy.
    #[getter]
    fn heights_m<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let (_, columns, heights_m) = self.0.posts();
        let rows: Vec<Vec<f32>> = heights_m.chunks(columns).map(<[f32]>::to_vec).collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    /// Height of the ground at a place east and north, metres; None where it is not known.
    fn height_m(&self, east_m: f64, north_m: f64) -> Option<f64> {
        self.0.height_m(Vec2::new(east_m, north_m))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self == other
    }
}

properties! { PyGround, this,
    /// The south-west post (east, north), metres.
    corner_m: (f64, f64) = this.0.posts().0.0.into();
    /// Distance between posts east and north, metres.
    spacing_m: (f64, f64) = this.0.posts().0.1.into();
    /// The height above the ground that is asked for, metres.
    clearance_m: f64 = this.0.clearance_m();
    /// Vertical error of the heights, metres.
    error_m: f64 = this.0.error_m();
}

impl PartialEq for PyGround {
    fn eq(&self, other: &Self) -> bool {
        let of = |ground: &Self| {
            let (place, columns, heights_m) = ground.0.posts();
            let asked_m = (ground.0.error_m(), ground.0.clearance_m());
            // Unknown ground equals unknown ground.
            let bits: Vec<u32> = heights_m
                .iter()
                .map(|height_m| height_m.to_bits())
                .collect();
            (place, columns, asked_m, bits)
        };
        Arc::ptr_eq(&self.0, &other.0) || of(self) == of(other)
    }
}

frozen! { PyGround, this,
    heights_m = Python::attach(|py| Ok::<_, PyErr>(this.heights_m(py)?.unbind()))?, corner_m,
    spacing_m, clearance_m, error_m,
}
