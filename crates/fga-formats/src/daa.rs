//! Recordings of flights in the `.daa` format of NASA's DAIDALUS.
//!
//! Lines that begin with `#` and blank lines are skipped. Optional lines `key = value` come
//! first, then a line of column names in any case, an optional line of units, and the rows.
//! Fields are separated by commas, semicolons, blanks or tabs. Columns:
//!
//! | column | names | unit without a unit line |
//! |---|---|---|
//! | name | `name`, `aircraft`, `id` | |
//! | position | `lat`, `lon`, `alt` (or long forms) | deg, deg, ft |
//! | | or `sx`, `sy`, `sz`: east, north, up; also `east`, `north`, `alt`, as MIT-LL pairing files name them | nmi, nmi, ft |
//! | velocity | `trk`, `gs`, `vs` (or long forms): true track from north, ground speed, climb | deg, kn, fpm |
//! | | or `vx`, `vy`, `vz`: east, north, up | kn, kn, fpm |
//! | time | `time`, `tm`, `st`, or `clock` as `hours:minutes:seconds` | s |
//!
//! Optional columns, in any order and any case; an empty field or `-` is no value:
//!
//! | column | what | unit without a unit line |
//! |---|---|---|
//! | `heading`, `airspeed` | direction and speed through the air; on the ownship they give the wind | deg, kn |
//! | `air_vx`, `air_vy` | the same as a velocity, east and north; preferred where a row has both | kn |
//! | `alerter` | which alerter judges the aircraft, counted from 1; 0 for none | |
//! | `s_EW_std`, `s_NS_std`, `s_EN_std`, `sz_std` | standard deviations of the position | none: a unit is required |
//! | `v_EW_std`, `v_NS_std`, `v_EN_std`, `vz_std` | standard deviations of the velocity | none: a unit is required |
//!
//! Other columns are ignored. A name `"` repeats the previous one. The first aircraft of the file is
//! the ownship; any aircraft may be missing at some times. Rows of one aircraft are in time order;
//! rows of different aircraft may come in any order. Of several rows of one aircraft and time the last stands, as in
//! DAIDALUS; the others are left out and counted.
//!
//! [`Earth::Daidalus`](crate::geodesy::Earth::Daidalus) maps latitudes and longitudes to the local frame, from the ownship's first
//! position (altitude included), because DAIDALUS measures separations that way. The frame is fixed, so
//! separations between aircraft d metres from the origin are too short by at most a share d²/2R²
//! (13 parts per million at 33 km). [`Recording::separation`] measures at the ownship's position
//! instead, exactly as DAIDALUS.

mod columns;
pub mod instants;
mod layout;
mod recording;
mod report;
mod rows;
pub mod scene;
pub mod tables;
mod write;

use crate::error::InputError;
use crate::gzip::read_packed_text;
use rows::rows_of;
use std::path::Path;

pub use recording::{DaaSeparation, Recording, Track, TrackSample};
pub use write::write;

/// Reads a recording.
///
/// # Errors
/// An unreadable file; a missing or doubled column; an unknown unit or a unit of another quantity; a
/// row with too few or too many fields; a field that is not a finite number or far out of range; a deviation
/// without a unit; a deviation or airspeed that is negative; a time that goes back for one aircraft;
/// no rows.
pub fn read(path: &Path) -> Result<Recording, InputError> {
    parse(&read_packed_text(path)?, path)
}

/// Reads a recording from `text`; errors name it `path`. See [`read`].
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, path: &Path) -> Result<Recording, InputError> {
    let (parameters, rows) = rows_of(text, path, |_, _| ())?;
    Ok(Recording {
        aircraft: rows.aircraft,
        frame: rows.frame,
        parameters,
        tally: rows.tally,
    })
}
