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
mod configuration;
mod entries;
mod keys;

use crate::error::{InputError, read_text};
pub use configuration::{Configuration, ShownUnit, ShownUnits};
use entries::Entries;
use fga_alerts::AlertSettings;
use std::path::Path;

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
        settings: AlertSettings::default(),
        units: ShownUnits::default(),
    };
    keys::read(&mut entries, &mut configuration)?;
    alerters::read(&mut entries, &mut configuration.settings)?;
    entries.nothing_left()?;
    Ok(configuration)
}
