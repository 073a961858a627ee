//! Flight logs: what an aircraft did with the bank that was commanded.
//!
//! Which logs, and what is read of each: `docs/how-to-identify.md`.
//!
//! A file that is compressed with gzip is read as what it holds. The signals of a log have rates of their
//! own; they are brought to one steady rate, and split where one of them has a gap or the aircraft does not fly. Where a
//! log has modes and commands of the mission, only what an avoider would fly is kept: neither take-off nor landing,
//! nor a pilot's own turns. Readings that the log itself calls unused or unhealthy are left out.
//!
//! Frame: banks positive in a left turn; courses through the air, from east towards north, so that a left turn
//! makes them grow; climb angles positive upwards. Radians, seconds, metres per second.

mod columns;
mod dataflash;
mod phases;
mod series;
mod tlog;
pub(crate) mod ulog;

use std::path::Path;

use crate::error::{InputError, read_bytes};
use crate::gzip;
pub use columns::COLUMNS;
pub use phases::Limits;
pub use series::{FlightLog, SeriesPiece};

/// Reads a log.
///
/// # Errors
/// A file that cannot be read, is no log, or lacks a signal, as one sentence.
pub fn read(path: &Path) -> Result<FlightLog, InputError> {
    let bytes = read_bytes(path)?;
    let bytes = gzip::unpacked(&bytes, path)?;
    parse(&bytes, path)
}

/// Reads the bytes of a log; `path` is named in errors.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path) -> Result<FlightLog, InputError> {
    let signals = if dataflash::is_one(bytes) {
        dataflash::signals(bytes)
    } else if ulog::is_one(bytes) {
        ulog::signals(bytes)
    } else if tlog::is_one(bytes) {
        tlog::signals(bytes)
    } else {
        columns::signals(bytes, path)?
    };
    signals
        .log()
        .map_err(|message| InputError::in_file(path, message))
}

/// A log from its columns, in the order of [`COLUMNS`].
///
/// # Errors
/// Columns of different lengths, a number that is not finite, a time that does not grow or too low a rate.
pub fn from_columns(columns: &[Vec<f64>; 6]) -> Result<FlightLog, String> {
    columns::of(columns)?.log()
}
