//! What a row of a recording says about an aircraft.

use fga_alerts::Deviation;
use glam::DVec3;

/// A place on the earth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EarthPlace {
    /// Latitude, radians, north positive.
    pub latitude_rad: f64,
    /// Longitude, radians, east positive.
    pub longitude_rad: f64,
    /// Altitude, metres.
    pub altitude_m: f64,
}

/// The position of an aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// On the earth.
    Geodetic(EarthPlace),
    /// In the plane: east, north, up, metres.
    Local(DVec3),
}

impl Place {
    /// Altitude, metres.
    pub const fn altitude_m(&self) -> f64 {
        match self {
            Self::Geodetic(place) => place.altitude_m,
            Self::Local(position_m) => position_m.z,
        }
    }
}

/// A velocity with its direction and speed as given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DaaMotion {
    /// Direction, radians clockwise from north.
    pub track_rad: f64,
    /// Horizontal speed, metres per second.
    pub speed_mps: f64,
    /// Velocity: east, north, up, metres per second.
    pub velocity_mps: DVec3,
}

impl DaaMotion {
    /// From direction, speed and climb.
    pub fn from_track(track_rad: f64, speed_mps: f64, climb_mps: f64) -> Self {
        let (sin, cos) = libm::sincos(track_rad);
        Self {
            track_rad,
            speed_mps,
            velocity_mps: DVec3::new(speed_mps * sin, speed_mps * cos, climb_mps),
        }
    }

    /// From a vector.
    pub fn from_velocity(velocity_mps: DVec3) -> Self {
        let DVec3 { x, y, .. } = velocity_mps;
        Self {
            track_rad: libm::atan2(x, y),
            speed_mps: libm::sqrt(x * x + y * y),
            velocity_mps,
        }
    }
}

/// The content of a row about an aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DaaReport {
    /// The aircraft: its index in [`Instants::names`](super::instants::Instants::names).
    pub aircraft: usize,
    /// Its position.
    pub place: Place,
    /// Its velocity over the ground.
    pub ground: DaaMotion,
    /// Direction (radians clockwise from north) and speed (metres per second) through the air.
    pub air: Option<(f64, f64)>,
    /// The alerter that judges it, counted from 1; 0 for none.
    pub alerter: Option<u32>,
    /// The uncertainty of the state.
    pub deviation: Deviation,
}
