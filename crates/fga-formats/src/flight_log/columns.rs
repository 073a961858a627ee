//! Logs in CSV: a head with the names of the columns, others are ignored.

use std::path::Path;

use super::series::Signals;
use crate::encounters::places_of;
use crate::error::{InputError, shown};
use crate::number::finite;
use crate::tally::Tally;

/// The columns of a log in CSV.
pub const COLUMNS: [&str; 6] = [
    "t_s",
    "airspeed_mps",
    "bank_command_rad",
    "bank_rad",
    "course_rad",
    "climb_rad",
];

const FEWEST_ROWS: usize = 50;

/// The signals of a text.
pub(super) fn signals(bytes: &[u8], path: &Path) -> Result<Signals, InputError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.iter().all(u8::is_ascii_whitespace) {
        let message = format!("is empty, expected the columns {}", COLUMNS.join(","));
        return Err(InputError::in_file(path, message));
    }
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(bytes);
    let unreadable = |error| InputError::csv(path, "log", &error);
    let head = reader.headers().map_err(unreadable)?.clone();
    let places = places_of(head.as_byte_record(), COLUMNS)
        .map_err(|message| InputError::at_line(path, 1, message))?;
    let mut columns: [Vec<f64>; 6] = Default::default();
    for record in reader.records() {
        let record = record.map_err(unreadable)?;
        let line = record.position().map_or(0, csv::Position::line);
        for ((place, name), column) in places.iter().zip(COLUMNS).zip(&mut columns) {
            let field = record.get(*place).unwrap_or("");
            let value = finite(field).ok_or_else(|| {
                let found = shown(field);
                let message = format!("column {name} holds {found}, expected a finite number");
                InputError::at_line(path, line, message)
            })?;
            column.push(value);
        }
    }
    of(&columns).map_err(|message| InputError::in_file(path, message))
}

/// The signals of columns.
pub(super) fn of(columns: &[Vec<f64>; 6]) -> Result<Signals, String> {
    let [time_s, rest @ ..] = columns;
    let count = time_s.len();
    for (column, name) in columns.iter().zip(COLUMNS) {
        if column.len() != count {
            return Err(format!(
                "column {name} has {} rows where t_s has {count}, expected one length",
                column.len()
            ));
        }
        if let Some(place) = column.iter().position(|value| !value.is_finite()) {
            return Err(format!(
                "column {name} is not finite in row {place}, expected numbers"
            ));
        }
    }
    if count < FEWEST_ROWS {
        return Err(format!("has {count} rows, expected at least {FEWEST_ROWS}"));
    }
    if let Some((before, after)) = time_s
        .iter()
        .zip(time_s.iter().skip(1))
        .find(|(a, b)| b <= a)
    {
        return Err(format!(
            "has the time {after} s after {before} s, expected times that grow"
        ));
    }
    let mut signals = Signals {
        sources: ["a column"; 5],
        tally: Tally::all_used(count as u64),
        ..Signals::default()
    };
    for (series, column) in signals.each().into_iter().zip(rest) {
        for (time_s, value) in time_s.iter().zip(column) {
            series.push(*time_s, *value);
        }
    }
    Ok(signals)
}
