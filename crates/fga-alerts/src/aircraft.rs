//! The state of an aircraft and its uncertainty.

use glam::{DVec2, DVec3};

/// Position and velocity in the local frame: x east, y north, z up from the datum of the
/// altitudes in the settings.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AircraftState {
    /// Position, metres.
    pub position_m: DVec3,
    /// Velocity through the air, metres per second.
    pub velocity_mps: DVec3,
}

impl AircraftState {
    /// Horizontal speed, metres per second.
    pub fn speed_mps(&self) -> f64 {
        let v = self.velocity_mps;
        libm::sqrt(v.x * v.x + v.y * v.y)
    }

    /// Direction of the horizontal velocity, radians clockwise from north, in `[0, 2π)`; zero
    /// without horizontal velocity.
    pub fn direction_rad(&self) -> f64 {
        let v = self.velocity_mps;
        crate::almost::wrapped(libm::atan2(v.x, v.y), core::f64::consts::TAU)
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        self.position_m.is_finite() && self.velocity_mps.is_finite()
    }
}

/// Standard deviations of a reported state.
///
/// The covariance has the form of DAIDALUS files: the square root of its size with its sign.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation {
    /// East position, metres.
    pub east_m: f64,
    /// North position, metres.
    pub north_m: f64,
    /// East–north position, metres, signed.
    pub east_north_m: f64,
    /// Altitude, metres.
    pub up_m: f64,
    /// East velocity, metres per second.
    pub east_mps: f64,
    /// North velocity, metres per second.
    pub north_mps: f64,
    /// East–north velocity, metres per second, signed.
    pub east_north_mps: f64,
    /// Climb, metres per second.
    pub up_mps: f64,
}

impl Deviation {
    /// From the values in the order of the fields.
    pub const fn from_array(values: [f64; 8]) -> Self {
        let [
            east_m,
            north_m,
            east_north_m,
            up_m,
            east_mps,
            north_mps,
            east_north_mps,
            up_mps,
        ] = values;
        Self {
            east_m,
            north_m,
            east_north_m,
            up_m,
            east_mps,
            north_mps,
            east_north_mps,
            up_mps,
        }
    }

    /// The values in the order of the fields.
    pub const fn to_array(self) -> [f64; 8] {
        [
            self.east_m,
            self.north_m,
            self.east_north_m,
            self.up_m,
            self.east_mps,
            self.north_mps,
            self.east_north_mps,
            self.up_mps,
        ]
    }

    /// The largest standard deviation of the position in any direction, metres.
    pub fn largest_m(&self) -> f64 {
        self.horizontal_m().max(self.up_m)
    }

    /// The largest standard deviation of the velocity in any direction, metres per second.
    pub fn largest_mps(&self) -> f64 {
        self.horizontal_mps().max(self.up_mps)
    }

    /// The largest standard deviation of the horizontal position in any direction, metres.
    pub(crate) fn horizontal_m(&self) -> f64 {
        largest_deviation(self.east_m, self.north_m, self.east_north_m)
    }

    /// The largest standard deviation of the horizontal velocity in any direction, metres per
    /// second.
    pub(crate) fn horizontal_mps(&self) -> f64 {
        largest_deviation(self.east_mps, self.north_mps, self.east_north_mps)
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        self.to_array().iter().all(|value| value.is_finite())
    }
}

/// Root of the larger eigenvalue of a covariance matrix.
fn largest_deviation(east: f64, north: f64, east_north: f64) -> f64 {
    if east == 0.0 && north == 0.0 && east_north == 0.0 {
        return 0.0;
    }
    let (first, second) = (east * east, north * north);
    let sign = if east_north >= 0.0 { 1.0 } else { -1.0 };
    let covariance = sign * (east_north * east_north);
    let mean = f64::midpoint(first, second);
    let determinant = first * second - covariance * covariance;
    let spread = libm::sqrt((mean * mean - determinant).max(0.0));
    libm::sqrt((mean + spread).max(0.0))
}

/// Identifies an aircraft; the caller gives an aircraft the same number at every time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AircraftId(pub u64);

/// One aircraft at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aircraft {
    /// Its identifier.
    pub id: AircraftId,
    /// Its position and velocity.
    pub state: AircraftState,
    /// The alerter of the settings that judges it, counted from 0; `None` for no alerter.
    pub alerter: Option<usize>,
    /// The uncertainty of its state.
    pub deviation: Deviation,
    /// Distance from the center of the terminal area, metres; `None` without one.
    pub terminal_distance_m: Option<f64>,
}

impl Aircraft {
    /// An aircraft that the first alerter judges, without deviations.
    pub const fn new(id: AircraftId, state: AircraftState) -> Self {
        Self {
            id,
            state,
            alerter: Some(0),
            deviation: Deviation::from_array([0.0; 8]),
            terminal_distance_m: None,
        }
    }
}

/// Two aircraft as input of a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// The ownship.
    pub ownship: AircraftState,
    /// The other aircraft.
    pub intruder: AircraftState,
    /// Standard deviations of the relative state, the sums of both aircraft.
    pub deviation: PairDeviation,
}

/// Sums of the standard deviations of two aircraft.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PairDeviation {
    /// Horizontal position, metres.
    pub horizontal_m: f64,
    /// Altitude, metres.
    pub vertical_m: f64,
    /// Horizontal velocity, metres per second.
    pub horizontal_mps: f64,
    /// Climb, metres per second.
    pub vertical_mps: f64,
}

impl PairDeviation {
    /// The sums for two aircraft.
    pub fn of(ownship: &Deviation, intruder: &Deviation) -> Self {
        Self {
            horizontal_m: ownship.horizontal_m() + intruder.horizontal_m(),
            vertical_m: ownship.up_m + intruder.up_m,
            horizontal_mps: ownship.horizontal_mps() + intruder.horizontal_mps(),
            vertical_mps: ownship.up_mps + intruder.up_mps,
        }
    }
}

impl Pair {
    /// Two aircraft with certain states.
    pub const fn exact(ownship: AircraftState, intruder: AircraftState) -> Self {
        Self {
            ownship,
            intruder,
            deviation: PairDeviation {
                horizontal_m: 0.0,
                vertical_m: 0.0,
                horizontal_mps: 0.0,
                vertical_mps: 0.0,
            },
        }
    }

    /// Ownship relative to intruder in the plane: position, metres, and velocity, m/s.
    pub(crate) fn plane(&self) -> (DVec2, DVec2) {
        (
            (self.ownship.position_m - self.intruder.position_m).truncate(),
            (self.ownship.velocity_mps - self.intruder.velocity_mps).truncate(),
        )
    }

    /// Ownship relative to intruder along the vertical: height, metres, and climb, m/s.
    pub(crate) fn vertical(&self) -> (f64, f64) {
        (
            self.ownship.position_m.z - self.intruder.position_m.z,
            self.ownship.velocity_mps.z - self.intruder.velocity_mps.z,
        )
    }
}
