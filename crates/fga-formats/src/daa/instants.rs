//! A recording time by time, with every column that alerts and bands need.

use super::rows::rows_of;
use crate::error::InputError;
use crate::gzip::read_packed_text;
use crate::tally::Tally;
use std::path::Path;

pub use super::report::{DaaMotion, DaaReport, EarthPlace, Place};

/// All aircraft of one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Instant {
    /// Time, seconds.
    pub time_s: f64,
    /// The aircraft that have a row, in the order of their first rows.
    pub reports: Vec<DaaReport>,
}

/// A recording time by time.
#[derive(Debug, Clone, PartialEq)]
pub struct Instants {
    /// Names of the aircraft in the order of their first rows; the first is the ownship.
    pub names: Vec<String>,
    /// Whether places are latitudes and longitudes.
    pub is_geodetic: bool,
    /// The times, increasing.
    pub instants: Vec<Instant>,
    /// What became of the rows of the file.
    pub tally: Tally,
}

/// Reads a recording time by time.
///
/// # Errors
/// As [`crate::daa::read`]; a unit of a deviation or of the air velocity that is missing, unknown
/// or of another quantity; a deviation or airspeed that is negative or no number.
pub fn read(path: &Path) -> Result<Instants, InputError> {
    parse(&read_packed_text(path)?, path)
}

/// Reads a recording from `text`; errors name it `path`. See [`read`].
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, path: &Path) -> Result<Instants, InputError> {
    let mut found: Vec<(f64, DaaReport)> = Vec::new();
    let (_, rows) = rows_of(text, path, |time_s, report| found.push((time_s, report)))?;
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.aircraft.cmp(&b.1.aircraft)));
    let mut instants: Vec<Instant> = Vec::new();
    for (time_s, report) in found {
        match instants.last_mut() {
            Some(instant) if instant.time_s == time_s => match instant.reports.last_mut() {
                // The last row of a time stands.
                Some(before) if before.aircraft == report.aircraft => *before = report,
                _ => instant.reports.push(report),
            },
            _ => instants.push(Instant {
                time_s,
                reports: vec![report],
            }),
        }
    }
    Ok(Instants {
        tally: rows.tally,
        names: rows.aircraft.into_iter().map(|track| track.name).collect(),
        is_geodetic: rows.layout.is_geodetic,
        instants,
    })
}
