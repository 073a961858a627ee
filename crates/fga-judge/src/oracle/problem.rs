//! What the oracle is asked, and what it answers.

use fga_proof::Vec3;
use fga_proof::situation::{Obstacle, Ownship, ProtectedVolume};
use fga_proof::vehicle::{STANDARD_GRAVITY_MPS2, Vehicle};

/// An encounter counts as avoidable from this margin on, metres.
pub const AVOIDABLE_MARGIN_M: f64 = 0.1;

/// The vehicle's limits for the oracle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OracleVehicle {
    /// Constant total airspeed, metres per second.
    pub airspeed_mps: f64,
    /// Largest course rate in flight, radians per second.
    pub course_rate_radps: f64,
    /// Steepest descent, radians, at most 0.
    pub climb_min_rad: f64,
    /// Steepest climb, radians, at least 0.
    pub climb_max_rad: f64,
    /// Rate limit of the climb angle, radians per second; 0 holds the climb angle.
    pub climb_rate_radps: f64,
    /// Time before the first command has any effect, seconds.
    pub dead_time_s: f64,
    /// Time constant of the first-order bank response, seconds; 0 turns at the full rate at once.
    pub bank_time_constant_s: f64,
    /// Bank angle of the tightest turn, radians (Eq. 8); used only with a bank response.
    pub bank_max_rad: f64,
    /// Flown course rate over g·tan φ / V; used only with a bank response.
    pub turn_rate_factor: f64,
}

impl From<&Vehicle> for OracleVehicle {
    fn from(vehicle: &Vehicle) -> Self {
        let speed = vehicle.airspeed_mps;
        Self {
            airspeed_mps: speed,
            course_rate_radps: vehicle.response.turn_rate_factor * speed / vehicle.turn_radius_m,
            climb_min_rad: vehicle.climb_min_rad,
            climb_max_rad: vehicle.climb_max_rad,
            climb_rate_radps: vehicle.climb_rate_radps,
            dead_time_s: vehicle.response.dead_time_s,
            bank_time_constant_s: vehicle.response.bank_time_constant_s,
            bank_max_rad: libm::atan2(speed * speed, STANDARD_GRAVITY_MPS2 * vehicle.turn_radius_m),
            turn_rate_factor: vehicle.response.turn_rate_factor,
        }
    }
}

impl OracleVehicle {
    /// The aircraft of Table 4: 15 m/s, turn radius 30 m, climb ±15° at 0.2 rad/s, no lag.
    pub fn table_4() -> Self {
        Self::from(&Vehicle {
            airspeed_mps: 15.0,
            turn_radius_m: 30.0,
            climb_min_rad: -15.0_f64.to_radians(),
            climb_max_rad: 15.0_f64.to_radians(),
            climb_rate_radps: 0.2,
            response: fga_proof::vehicle::Response::default(),
        })
    }

    /// The same vehicle held in the plane.
    #[must_use]
    pub fn planar(self) -> Self {
        Self {
            climb_min_rad: 0.0,
            climb_max_rad: 0.0,
            climb_rate_radps: 0.0,
            ..self
        }
    }

    pub(crate) fn can_climb(&self) -> bool {
        self.climb_rate_radps > 0.0 && self.climb_max_rad > self.climb_min_rad
    }
}

/// The aircraft's state at which the search begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OracleStart {
    /// Position, metres.
    pub position_m: Vec3,
    /// Course, radians.
    pub course_rad: f64,
    /// Climb angle, radians.
    pub climb_rad: f64,
    /// Bank angle, radians, positive in a left turn; used only with a bank response.
    pub bank_rad: f64,
}

impl OracleStart {
    /// At the origin, level, along +x: where an encounter of `fga batch` begins.
    pub const ORIGIN: Self = Self {
        position_m: Vec3::ZERO,
        course_rad: 0.0,
        climb_rad: 0.0,
        bank_rad: 0.0,
    };
}

impl From<&Ownship> for OracleStart {
    fn from(own: &Ownship) -> Self {
        Self {
            position_m: own.position_m,
            course_rad: own.course_rad,
            climb_rad: own.climb_rad,
            bank_rad: own.bank_rad,
        }
    }
}

/// An obstacle in straight uniform motion with its protected volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OracleObstacle {
    /// Centre of the volume at the start, metres.
    pub position_m: Vec3,
    /// Velocity in the air mass, metres per second.
    pub velocity_mps: Vec3,
    /// The protected volume.
    pub volume: ProtectedVolume,
}

impl From<&Obstacle> for OracleObstacle {
    fn from(obstacle: &Obstacle) -> Self {
        Self {
            position_m: obstacle.position_m,
            velocity_mps: obstacle.velocity_mps,
            volume: obstacle.volume,
        }
    }
}

impl OracleObstacle {
    /// A sphere of `radius_m` at `position_m`, moving with `velocity_mps`.
    pub const fn sphere(position_m: Vec3, velocity_mps: Vec3, radius_m: f64) -> Self {
        Self {
            position_m,
            velocity_mps,
            volume: ProtectedVolume::Sphere { radius_m },
        }
    }

    /// The same obstacle, with its velocity in an air mass that moves with `wind_mps`.
    #[must_use]
    pub fn in_wind(self, wind_mps: Vec3) -> Self {
        Self {
            velocity_mps: self.velocity_mps - wind_mps,
            ..self
        }
    }
}

/// An aircraft on a known track: straight from point to point, absent before and after.
#[derive(Debug, Clone, PartialEq)]
pub struct OracleTrack {
    /// Times, seconds from the start of the search, strictly increasing, and positions in the air mass,
    /// metres.
    pub points_m: Vec<(f64, Vec3)>,
    /// The protected volume.
    pub volume: ProtectedVolume,
}

/// Wait, turn, fly straight, turn again, and straight on from there.
///
/// The turns are at the full rate; each climb change begins with its turn, at the climb rate.
/// With a bank response a turn is the bank commanded for
/// |turn| / course rate seconds, whatever the resulting angle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OracleManeuver {
    /// Course and climb angle held before the first turn, seconds (after the dead time).
    pub wait_s: f64,
    /// First turn, radians, left positive; more than 2π is circling.
    pub turn1_rad: f64,
    /// Climb angle from the first turn on, radians.
    pub climb1_rad: f64,
    /// Time between the turns, seconds.
    pub straight_s: f64,
    /// Second turn, radians, left positive.
    pub turn2_rad: f64,
    /// Climb angle from the second turn on, radians.
    pub climb2_rad: f64,
}

impl OracleManeuver {
    /// The parameters in the order of their declaration.
    pub(super) const fn to_array(self) -> [f64; 6] {
        [
            self.wait_s,
            self.turn1_rad,
            self.climb1_rad,
            self.straight_s,
            self.turn2_rad,
            self.climb2_rad,
        ]
    }

    /// The manoeuvre of such parameters.
    pub(super) const fn from_array(parameters: [f64; 6]) -> Self {
        let [
            wait_s,
            turn1_rad,
            climb1_rad,
            straight_s,
            turn2_rad,
            climb2_rad,
        ] = parameters;
        Self {
            wait_s,
            turn1_rad,
            climb1_rad,
            straight_s,
            turn2_rad,
            climb2_rad,
        }
    }
}

/// The family of manoeuvres.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stages {
    /// Wait, one turn with one change of climb angle, straight on.
    One,
    /// A second turn with its own climb angle as well.
    #[default]
    Two,
}

/// The settings of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OracleSettings {
    /// Time over which the margin counts, seconds.
    pub horizon_s: f64,
    /// A margin that is enough: the search ends there and the answer is a lower bound. `None`
    /// searches everything.
    pub enough_m: Option<f64>,
    /// The family of manoeuvres.
    pub stages: Stages,
}

impl Default for OracleSettings {
    fn default() -> Self {
        Self {
            horizon_s: 60.0,
            enough_m: None,
            stages: Stages::Two,
        }
    }
}

/// The result of the oracle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OracleAnswer {
    /// Largest margin found, metres: the least signed distance to any protected volume over the
    /// horizon. Infinite without obstacles.
    pub best_margin_m: f64,
    /// Margin with course and climb angle held, metres.
    pub do_nothing_margin_m: f64,
    /// The manoeuvre that keeps `best_margin_m`.
    pub maneuver: OracleManeuver,
}

impl OracleAnswer {
    /// Whether the encounter is avoidable: a margin of at least [`AVOIDABLE_MARGIN_M`].
    pub fn avoidable(&self) -> bool {
        self.best_margin_m >= AVOIDABLE_MARGIN_M
    }
}
