//! What a manoeuvre changes.

use crate::aircraft::AircraftState;
use core::f64::consts::TAU;

/// The quantity that a manoeuvre changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Direction of flight, radians clockwise from north.
    Direction,
    /// Horizontal speed, metres per second.
    HorizontalSpeed,
    /// Vertical speed, metres per second.
    VerticalSpeed,
    /// Altitude, metres.
    Altitude,
}

impl Quantity {
    /// All four, in the order of tables.
    pub const ALL: [Self; 4] = [
        Self::Direction,
        Self::HorizontalSpeed,
        Self::VerticalSpeed,
        Self::Altitude,
    ];

    /// The quantity's value of an aircraft.
    pub fn of(self, state: &AircraftState) -> f64 {
        match self {
            Self::Direction => state.direction_rad(),
            Self::HorizontalSpeed => state.speed_mps(),
            Self::VerticalSpeed => state.velocity_mps.z,
            Self::Altitude => state.position_m.z,
        }
    }

    pub(crate) const fn modulus(self) -> f64 {
        match self {
            Self::Direction => TAU,
            _ => 0.0,
        }
    }
}

/// One value for each kind of manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PerManeuver<T> {
    /// Direction over ground.
    pub direction: T,
    /// Horizontal speed.
    pub horizontal_speed: T,
    /// Vertical speed.
    pub vertical_speed: T,
    /// Altitude.
    pub altitude: T,
}

impl<T: Copy> PerManeuver<T> {
    /// The value for a quantity.
    pub fn get(&self, quantity: Quantity) -> T {
        match quantity {
            Quantity::Direction => self.direction,
            Quantity::HorizontalSpeed => self.horizontal_speed,
            Quantity::VerticalSpeed => self.vertical_speed,
            Quantity::Altitude => self.altitude,
        }
    }
}
