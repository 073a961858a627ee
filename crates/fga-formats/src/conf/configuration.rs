//! What a configuration says.

use fga_alerts::AlertSettings;

/// A unit in which tables show a quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct ShownUnit {
    /// Its symbol in the file.
    pub symbol: String,
    /// SI units in one of it.
    pub factor: f64,
}

impl ShownUnit {
    pub(crate) fn new(symbol: &str, factor: f64) -> Self {
        Self {
            symbol: symbol.to_owned(),
            factor,
        }
    }

    /// Converts a value in SI units to this unit.
    pub fn of_si(&self, value: f64) -> f64 {
        value / self.factor
    }
}

/// The units in which tables show quantities, as the file gives steps and recovery distances.
#[derive(Debug, Clone, PartialEq)]
pub struct ShownUnits {
    /// Directions.
    pub direction: ShownUnit,
    /// Horizontal speeds.
    pub horizontal_speed: ShownUnit,
    /// Vertical speeds.
    pub vertical_speed: ShownUnit,
    /// Altitudes.
    pub altitude: ShownUnit,
    /// Horizontal distances.
    pub horizontal_distance: ShownUnit,
    /// Vertical distances.
    pub vertical_distance: ShownUnit,
}

impl Default for ShownUnits {
    fn default() -> Self {
        use crate::units::{DEGREE_RAD, FOOT_M, FOOT_PER_MINUTE_MPS, KNOT_MPS, NAUTICAL_MILE_M};
        Self {
            direction: ShownUnit::new("deg", DEGREE_RAD),
            horizontal_speed: ShownUnit::new("knot", KNOT_MPS),
            vertical_speed: ShownUnit::new("fpm", FOOT_PER_MINUTE_MPS),
            altitude: ShownUnit::new("ft", FOOT_M),
            horizontal_distance: ShownUnit::new("nmi", NAUTICAL_MILE_M),
            vertical_distance: ShownUnit::new("ft", FOOT_M),
        }
    }
}

/// A configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    /// The settings.
    pub settings: AlertSettings,
    /// The units in which tables show it.
    pub units: ShownUnits,
}
