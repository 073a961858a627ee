//! Configurations of alerts and bands in the `.conf` format of NASA's DAIDALUS.
//!
//! Lines are `key = value` or `key = value [unit]`; `#` begins a comment. The key
//! `alerters` lists names; the keys of an alerter begin with its name and `_`:
//!
//! | key after the alerter's name | value |
//! |---|---|
//! | `alert_N_region` | `NONE`, `FAR`, `MID` or `NEAR`; N counts from 1 |
//! | `alert_N_alerting_time`, `alert_N_early_alerting_time` | a time |
//! | `alert_N_spread_hdir`, `_hs`, `_vs`, `_alt` | manoeuvres of the ownship that also raise the alert |
//! | `alert_N_detector` | the name of a detector |
//! | `load_core_detection_NAME` | the class of the detector NAME |
//! | `NAME_KEY` | a value of the detector, see below |
//!
//! | class, its part after the last dot | keys |
//! |---|---|
//! | `WCV_TAUMOD`, `WCV_TCPA`, `WCV_TEP`, `WCV_HZ` | `WCV_DTHR`, `WCV_ZTHR`, `WCV_TTHR`, `WCV_TCOA` |
//! | `WCV_TAUMOD_SUM` | the same and the z-scores of the file's top level |
//! | `CDCylinder` | `D`, `H` |
//! | `TCAS3D` | `TCAS_HMDFilter`, `TCAS_level_N`, `TCAS_TAU_N`, `TCAS_TCOA_N`, `TCAS_DMOD_N`, `TCAS_HMD_N`, `TCAS_ZTHR_N` |
//!
//! Files of DAIDALUS 1 name no alerters: the keys of their single alerter have no prefix, and
//! `conflict_level` names the corrective level. An unknown key, an unknown unit, a unit of another
//! quantity, and a value out of range are errors with file, line and key.

mod alerters;
mod entries;
mod keys;

use crate::error::{InputError, read_text};
use entries::Entries;
use fga_alerts::Settings;
use std::path::Path;

/// A unit in which tables show a quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct ShownUnit {
    /// Its symbol in the file.
    pub symbol: String,
    /// SI units in one of it.
    pub factor: f64,
}

impl ShownUnit {
    fn new(symbol: &str, factor: f64) -> Self {
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
    pub settings: Settings,
    /// The units in which tables show it.
    pub units: ShownUnits,
}

/// Reads a configuration.
///
/// # Errors
/// An unreadable or empty file; a line that is no `key = value`; a doubled or unknown key; a unit
/// that is unknown, missing or of another quantity; a value out of range; an alerter or a detector
/// with a name but no description.
pub fn read(path: &Path) -> Result<Configuration, InputError> {
    parse(&read_text(path)?, path)
}

/// Reads a configuration from `text`; errors name it `path`. See [`read`].
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, path: &Path) -> Result<Configuration, InputError> {
    let mut entries = Entries::parse(text, path)?;
    let mut configuration = Configuration {
        settings: Settings::default(),
        units: ShownUnits::default(),
    };
    keys::read(&mut entries, &mut configuration)?;
    alerters::read(&mut entries, &mut configuration.settings)?;
    entries.nothing_left()?;
    Ok(configuration)
}
