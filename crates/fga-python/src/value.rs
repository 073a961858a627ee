//! The input of a decision, as frozen Python classes.

use fga::Vec3;
use fga::avoider::SettingsError;
use fga::situation::{Movement, ObstacleKind, ProtectedVolume};
use fga::vehicle::{Response, Vehicle};
use fga_paper::turn::bank_for_radius_rad;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Three numbers: east, north, up.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Triple(pub(crate) Vec3);

impl<'py> FromPyObject<'_, 'py> for Triple {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok((x, y, z)) = object.extract::<(f64, f64, f64)>() {
            return Ok(Self(Vec3::new(x, y, z)));
        }
        let wrong = || PyTypeError::new_err("expected three numbers: east, north, up");
        let mut values = [0.0; 3];
        let mut count = 0;
        for item in object.try_iter().map_err(|_| wrong())? {
            let value: f64 = item?.extract().map_err(|_| wrong())?;
            *values.get_mut(count).ok_or_else(wrong)? = value;
            count += 1;
        }
        (count == 3)
            .then_some(Self(Vec3::from_array(values)))
            .ok_or_else(wrong)
    }
}

/// East, north, up as a tuple.
pub(crate) fn tuple(vector: Vec3) -> (f64, f64, f64) {
    (vector.x, vector.y, vector.z)
}

/// A wrong value, in the words of the core.
pub(crate) fn refused(error: SettingsError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Refuses a number that differs from the expectation.
pub(crate) fn expect(holds: bool, name: &str, found: f64, expected: &str) -> PyResult<()> {
    if holds {
        return Ok(());
    }
    Err(PyValueError::new_err(format!(
        "{name} is {found}, expected {expected}"
    )))
}

/// Refuses a vector with a number that is not finite.
pub(crate) fn expect_finite(name: &str, vector: Vec3) -> PyResult<()> {
    if vector.is_finite() {
        return Ok(());
    }
    let (x, y, z) = tuple(vector);
    Err(PyValueError::new_err(format!(
        "{name} is ({x}, {y}, {z}), expected finite numbers"
    )))
}

/// `Name(key=value, …)`.
pub(crate) fn shown(name: &str, arguments: &Bound<'_, PyDict>) -> PyResult<String> {
    let mut parts = Vec::with_capacity(arguments.len());
    for (key, value) in arguments.iter() {
        parts.push(format!("{key}={}", value.repr()?));
    }
    Ok(format!("{name}({})", parts.join(", ")))
}

/// The arguments of the class for pickling.
pub(crate) type NewArguments<'py> = ((), Bound<'py, PyDict>);

/// The function of the compiled part that makes a pickled value again.
pub(crate) fn remade<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("fga._fga")?.getattr(name)
}

/// Properties of a class, each with its sentence in Python, its type and its value.
macro_rules! properties {
    ($class:ident, $this:ident, $($(#[$doc:meta])+ $name:ident: $type:ty = $value:expr;)+) => {
        #[pymethods]
        impl $class {
            $($(#[$doc])+
            #[getter]
            fn $name(&self) -> $type {
                let $this = self;
                $value
            })+
        }
    };
}
pub(crate) use properties;

/// How a frozen class is printed and pickled: by the arguments that make it again, which are properties of the same name unless
/// another value is given.
macro_rules! frozen {
    (@value $this:ident $name:ident) => { $this.$name() };
    (@value $this:ident $name:ident $value:expr) => { $value };
    ($class:ident, $this:ident, $($name:ident $(= $value:expr)?),+ $(,)?) => {
        #[pymethods]
        impl $class {
            fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
                let name = stringify!($class).trim_start_matches("Py");
                $crate::value::shown(name, &self.arguments(py)?)
            }

            fn __getnewargs_ex__<'py>(
                &self,
                py: Python<'py>,
            ) -> PyResult<$crate::value::NewArguments<'py>> {
                Ok(((), self.arguments(py)?))
            }
        }

        impl $class {
            fn arguments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, pyo3::types::PyDict>> {
                let $this = self;
                let arguments = pyo3::types::PyDict::new(py);
                $(
                    let value = $crate::value::frozen!(@value $this $name $($value)?);
                    arguments.set_item(stringify!($name), value)?;
                )+
                Ok(arguments)
            }
        }
    };
}
pub(crate) use frozen;

/// State of the aircraft: position over the ground, motion through the air.
///
/// Frame: x east, y north, z up, metres. Courses are radians from +x towards +y (a left turn increases the
/// course), climb angles positive upwards, bank angles positive in a left turn.
///
/// Raises ValueError for a number that is not finite or an airspeed that is not positive.
#[pyclass(name = "Ownship", frozen, eq, module = "fga")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PyOwnship(pub(crate) fga::situation::Ownship);

#[pymethods]
impl PyOwnship {
    #[new]
    #[pyo3(signature = (position_m, course_rad, airspeed_mps, climb_rad = 0.0, bank_rad = 0.0))]
    fn new(
        position_m: Triple,
        course_rad: f64,
        airspeed_mps: f64,
        climb_rad: f64,
        bank_rad: f64,
    ) -> PyResult<Self> {
        expect_finite("position_m", position_m.0)?;
        for (name, angle) in [
            ("course_rad", course_rad),
            ("climb_rad", climb_rad),
            ("bank_rad", bank_rad),
        ] {
            expect(angle.is_finite(), name, angle, "a finite number")?;
        }
        let flies = airspeed_mps.is_finite() && airspeed_mps > 0.0;
        expect(flies, "airspeed_mps", airspeed_mps, "a positive number")?;
        Ok(Self(fga::situation::Ownship {
            position_m: position_m.0,
            course_rad,
            climb_rad,
            bank_rad,
            airspeed_mps,
        }))
    }
}

properties! { PyOwnship, this,
    /// Position, metres, local frame.
    position_m: (f64, f64, f64) = tuple(this.0.position_m);
    /// Course through the air, radians.
    course_rad: f64 = this.0.course_rad;
    /// Climb angle, radians.
    climb_rad: f64 = this.0.climb_rad;
    /// Bank angle, radians, positive in a left turn.
    bank_rad: f64 = this.0.bank_rad;
    /// Total airspeed, metres per second.
    airspeed_mps: f64 = this.0.airspeed_mps;
}

frozen! { PyOwnship, this,
    position_m, course_rad, airspeed_mps, climb_rad, bank_rad,
}

/// The possible motion of an obstacle for a word of a batch file.
pub(crate) fn movement_of(word: &str) -> PyResult<Movement> {
    match word {
        "straight" => Ok(Movement::Straight),
        "still" => Ok(Movement::AtRest),
        "aircraft" => Ok(Movement::CREWED),
        "uas" => Ok(Movement::SMALL_UAS),
        other => Err(PyValueError::new_err(format!(
            "kind is {other:?}, expected still, straight, aircraft or uas"
        ))),
    }
}

/// The word for the possible motion of an obstacle.
pub(crate) fn movement_word(movement: Movement) -> &'static str {
    match movement {
        Movement::Straight => "straight",
        Movement::AtRest => "still",
        movement if movement == Movement::CREWED => "aircraft",
        Movement::Aircraft(_) => "uas",
    }
}

/// The nature of an obstacle for a word of a scenario file.
fn nature_of(word: &str) -> PyResult<ObstacleKind> {
    match word {
        "unknown" => Ok(ObstacleKind::Unknown),
        "passengers" => Ok(ObstacleKind::Passengers),
        "natural-barrier" => Ok(ObstacleKind::NaturalBarrier),
        other => Err(PyValueError::new_err(format!(
            "nature is {other:?}, expected unknown, passengers or natural-barrier"
        ))),
    }
}

/// The volume of a radius and, for a cylinder, a half height.
pub(crate) fn volume_of(radius_m: f64, half_height_m: Option<f64>) -> ProtectedVolume {
    half_height_m.map_or(ProtectedVolume::Sphere { radius_m }, |half_height_m| {
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        }
    })
}

/// One obstacle: a protected volume, its position and its velocity over the ground.
///
/// Without `half_height_m` the volume is a sphere, with it an upright cylinder. `kind` says how it may move:
/// `still`, `straight`, `aircraft` (crewed) or `uas`. The sigmas are standard deviations along an axis. `nature` is
/// `unknown`, `passengers` or `natural-barrier`: only the published rules ask for it.
///
/// Raises ValueError for a number that is not finite, a length that is negative, or a velocity of kind `still` without a
/// `velocity_sigma_mps`: where it is measured it may be noise.
#[pyclass(name = "Obstacle", frozen, eq, module = "fga")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PyObstacle(pub(crate) fga::situation::Obstacle);

#[pymethods]
impl PyObstacle {
    #[new]
    #[pyo3(signature = (
        id, position_m, radius_m, velocity_mps = Triple(Vec3::ZERO), half_height_m = None,
        position_sigma_m = 0.0, velocity_sigma_mps = 0.0, kind = "straight", nature = "unknown",
    ))]
    #[expect(
        clippy::too_many_arguments,
        reason = "one for each property, by name in Python"
    )]
    fn new(
        id: u32,
        position_m: Triple,
        radius_m: f64,
        velocity_mps: Triple,
        half_height_m: Option<f64>,
        position_sigma_m: f64,
        velocity_sigma_mps: f64,
        kind: &str,
        nature: &str,
    ) -> PyResult<Self> {
        expect_finite("position_m", position_m.0)?;
        expect_finite("velocity_mps", velocity_mps.0)?;
        for (name, length) in [
            ("radius_m", radius_m),
            ("half_height_m", half_height_m.unwrap_or(0.0)),
            ("position_sigma_m", position_sigma_m),
            ("velocity_sigma_mps", velocity_sigma_mps),
        ] {
            let holds = length.is_finite() && length >= 0.0;
            expect(holds, name, length, "a number of 0 or more")?;
        }
        let volume = volume_of(radius_m, half_height_m);
        let mut obstacle =
            fga::situation::Obstacle::straight(id, position_m.0, velocity_mps.0, volume);
        obstacle.uncertainty.position_m = position_sigma_m;
        obstacle.uncertainty.velocity_mps = velocity_sigma_mps;
        obstacle.movement = movement_of(kind)?;
        if obstacle.moves_at_rest() {
            return Err(PyValueError::new_err(format!(
                "velocity_mps is {:?} of kind still, expected zeros, a velocity_sigma_mps above 0, or another kind",
                tuple(velocity_mps.0)
            )));
        }
        obstacle.kind = nature_of(nature)?;
        Ok(Self(obstacle))
    }

    /// Half height of a cylinder, metres; None for a sphere.
    #[getter]
    fn half_height_m(&self) -> Option<f64> {
        match self.0.volume {
            ProtectedVolume::Sphere { .. } => None,
            ProtectedVolume::Cylinder { half_height_m, .. } => Some(half_height_m),
        }
    }

    /// Its nature: unknown, passengers or natural-barrier.
    #[getter]
    fn nature(&self) -> &'static str {
        match self.0.kind {
            ObstacleKind::Unknown => "unknown",
            ObstacleKind::Passengers => "passengers",
            ObstacleKind::NaturalBarrier => "natural-barrier",
        }
    }
}

properties! { PyObstacle, this,
    /// Identifier, unique among the obstacles of a situation.
    id: u32 = this.0.id;
    /// Centre of the volume, metres, local frame.
    position_m: (f64, f64, f64) = tuple(this.0.position_m);
    /// Velocity over the ground, metres per second.
    velocity_mps: (f64, f64, f64) = tuple(this.0.velocity_mps);
    /// Radius of the volume, metres.
    radius_m: f64 = this.0.volume.radius_m();
    /// Standard deviation of the position along an axis, metres.
    position_sigma_m: f64 = this.0.uncertainty.position_m;
    /// Standard deviation of the velocity along an axis, metres per second.
    velocity_sigma_mps: f64 = this.0.uncertainty.velocity_mps;
    /// Its possible motion: still, straight, aircraft or uas.
    kind: &'static str = movement_word(this.0.movement);
}

frozen! { PyObstacle, this,
    id, position_m, radius_m, velocity_mps, half_height_m, position_sigma_m, velocity_sigma_mps,
    kind, nature,
}

/// Limits of an aircraft at its airspeed, and its response to commands.
///
/// Raises ValueError, with the sentence of the program, for a limit out of range.
#[pyclass(name = "Vehicle", frozen, eq, module = "fga")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PyVehicle(pub(crate) Vehicle);

#[pymethods]
impl PyVehicle {
    #[new]
    #[pyo3(signature = (
        airspeed_mps, turn_radius_m, climb_min_rad = -core::f64::consts::PI / 12.0,
        climb_max_rad = core::f64::consts::PI / 12.0, climb_rate_radps = 0.2, dead_time_s = 0.0,
        bank_time_constant_s = 0.0, turn_rate_factor = 1.0,
    ))]
    #[expect(
        clippy::too_many_arguments,
        reason = "one for each limit, by name in Python"
    )]
    fn new(
        airspeed_mps: f64,
        turn_radius_m: f64,
        climb_min_rad: f64,
        climb_max_rad: f64,
        climb_rate_radps: f64,
        dead_time_s: f64,
        bank_time_constant_s: f64,
        turn_rate_factor: f64,
    ) -> PyResult<Self> {
        let vehicle = Vehicle {
            airspeed_mps,
            turn_radius_m,
            climb_min_rad,
            climb_max_rad,
            climb_rate_radps,
            response: Response {
                dead_time_s,
                bank_time_constant_s,
                turn_rate_factor,
            },
        };
        vehicle.check().map_err(refused)?;
        Ok(Self(vehicle))
    }
}

properties! { PyVehicle, this,
    /// Constant total airspeed, metres per second.
    airspeed_mps: f64 = this.0.airspeed_mps;
    /// Least radius of the ideal coordinated turn, metres.
    turn_radius_m: f64 = this.0.turn_radius_m;
    /// Steepest descent, radians, at most 0.
    climb_min_rad: f64 = this.0.climb_min_rad;
    /// Steepest climb, radians, at least 0.
    climb_max_rad: f64 = this.0.climb_max_rad;
    /// Rate limit of the climb angle, radians per second.
    climb_rate_radps: f64 = this.0.climb_rate_radps;
    /// Time before a command has any effect, seconds.
    dead_time_s: f64 = this.0.response.dead_time_s;
    /// Time constant of the first-order bank response, seconds; 0 for none.
    bank_time_constant_s: f64 = this.0.response.bank_time_constant_s;
    /// Flown course rate over the ideal coordinated turn's.
    turn_rate_factor: f64 = this.0.response.turn_rate_factor;
    /// Largest bank angle, radians.
    bank_max_rad: Option<f64> = bank_for_radius_rad(this.0.airspeed_mps, this.0.turn_radius_m);
    /// Largest real course rate, radians per second.
    course_rate_radps: f64 = this.0.course_rate_radps();
}

frozen! { PyVehicle, this,
    airspeed_mps, turn_radius_m, climb_min_rad, climb_max_rad, climb_rate_radps, dead_time_s,
    bank_time_constant_s, turn_rate_factor,
}
