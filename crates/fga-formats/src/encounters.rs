//! Encounters as CSV: the batch file and its writer.
//!
//! A comma-separated file with the columns `encounter`, `obstacle`, `x_m`, `y_m`, `z_m`,
//! `vx_mps`, `vy_mps`, `vz_mps`, `radius_m`, found by name in any order. Other columns are
//! ignored, except the optional `kind`. Each row is one obstacle of one encounter: a sphere that
//! flies straight. Positions and velocities are in the local frame, in which the aircraft starts at
//! the origin along +x.
//!
//! `kind` says how the policy expects an obstacle to move: `still` (at rest), `straight` (it
//! keeps its velocity), `aircraft` (crewed: it may turn, climb and change its speed) or `uas` (the
//! same for a small unmanned one). Without the column, and in an empty field, it is `straight`.
//! Lines that begin with `#` and blank lines are skipped. The rows of an encounter need not stand
//! together.

use crate::atomic;
use crate::error::{InputError, OutputError, shown};
use core::str::{FromStr, from_utf8};
use fga::situation::{Movement, Obstacle, ProtectedVolume};
use glam::DVec3;
use std::collections::{HashMap, HashSet};
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

/// The columns of the file, in the order in which they are written.
pub const COLUMNS: [&str; 9] = [
    "encounter",
    "obstacle",
    "x_m",
    "y_m",
    "z_m",
    "vx_mps",
    "vy_mps",
    "vz_mps",
    "radius_m",
];

/// The optional column that says how an obstacle may move.
pub const KIND_COLUMN: &str = "kind";

/// Its words.
const KINDS: [(&str, Movement); 4] = [
    ("still", Movement::AtRest),
    ("straight", Movement::Straight),
    ("aircraft", Movement::CREWED),
    ("uas", Movement::SMALL_UAS),
];

/// The largest plausible position or radius, metres.
const LARGEST_LENGTH_M: f64 = 1e8;
/// The largest plausible component of a velocity, metres per second.
const LARGEST_SPEED_MPS: f64 = 1e5;

/// One encounter: the obstacles around the aircraft at the start. The aircraft is at the origin and
/// flies along +x.
#[derive(Debug, Clone, PartialEq)]
pub struct Encounter {
    /// Identifier, unique within the file or source.
    pub id: u64,
    /// The obstacles, at least one, each in a protected sphere; identifiers are unique within the
    /// encounter.
    pub obstacles: Vec<Obstacle>,
}

/// Reads a batch file; the encounters come in the order of their first rows.
///
/// # Errors
/// An unreadable file, a missing or doubled column, a field that is not a number,
/// not finite or out of range, a negative radius, a doubled obstacle number, no encounter.
pub fn read(path: &Path) -> Result<Vec<Encounter>, InputError> {
    let file = File::open(path).map_err(|error| InputError::unreadable(path, &error))?;
    parse(file, path)
}

/// Reads encounters from `input`; errors name it `path`. See [`read`].
///
/// # Errors
/// As [`read`].
pub fn parse(input: impl Read, path: &Path) -> Result<Vec<Encounter>, InputError> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .has_headers(false)
        .buffer_capacity(1 << 16)
        .from_reader(input);
    let mut record = csv::ByteRecord::new();
    let next = |reader: &mut csv::Reader<_>, record: &mut csv::ByteRecord| {
        let read = reader.read_byte_record(record);
        read.map_err(|error| InputError::csv(path, "comma-separated file", &error))
    };
    let line_of = |record: &csv::ByteRecord| record.position().map_or(0, csv::Position::line);

    if !next(&mut reader, &mut record)? {
        let message = format!("is empty, expected the columns {}", COLUMNS.join(","));
        return Err(InputError::in_file(path, message));
    }
    let first_line = line_of(&record);
    let wrong = |message: String| InputError::at_line(path, first_line, message);
    let columns = places_of(&record, COLUMNS).map_err(wrong)?;
    let kind_column = place_of(&record, KIND_COLUMN).map_err(wrong)?;
    let width = record.len();

    let mut grouped = Grouped::default();
    while next(&mut reader, &mut record)? {
        let line = line_of(&record);
        let wrong = |message: String| InputError::at_line(path, line, message);
        if record.len() == 1 && record.get(0).is_none_or(<[u8]>::is_empty) {
            continue;
        }
        if record.len() != width {
            let found = record.len();
            return Err(wrong(format!(
                "has {found} columns, expected {width} as in the first line"
            )));
        }
        let row = EncounterRow {
            record: &record,
            columns: &columns,
            kind_column,
        };
        let push = |id| grouped.push(id, row.obstacle()?);
        let id = row.parsed(0, "a whole number from 0");
        id.and_then(push).map_err(wrong)?;
    }
    if grouped.encounters.is_empty() {
        let message = "holds no encounter, expected at least one row below the column names";
        return Err(InputError::in_file(path, message));
    }
    Ok(grouped.encounters)
}

/// The indices of columns in a file that has to have all of them.
pub(crate) fn places_of<const N: usize>(
    header: &csv::ByteRecord,
    names: [&str; N],
) -> Result<[usize; N], String> {
    let mut places = [0; N];
    for (place, name) in places.iter_mut().zip(names) {
        *place = place_of(header, name)?.ok_or_else(|| {
            let all = names.join(",");
            format!("the column {name} is missing, expected the columns {all}")
        })?;
    }
    Ok(places)
}

/// The index of a column in a file, if present.
fn place_of(header: &csv::ByteRecord, name: &str) -> Result<Option<usize>, String> {
    let mut places = header.iter().enumerate().filter_map(|(place, field)| {
        let field = field.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(field);
        field.eq_ignore_ascii_case(name.as_bytes()).then_some(place)
    });
    let first = places.next();
    match places.next() {
        None => Ok(first),
        Some(_) => Err(format!("the column {name} appears twice, expected it once")),
    }
}

/// Encounters in the order of their first rows.
#[derive(Default)]
struct Grouped {
    encounters: Vec<Encounter>,
    index_of: HashMap<u64, usize>,
    seen: HashSet<(usize, u32)>,
}

impl Grouped {
    /// Adds an obstacle to the encounter of this number.
    fn push(&mut self, id: u64, obstacle: Obstacle) -> Result<(), String> {
        if obstacle.movement == Movement::AtRest && obstacle.velocity_mps != DVec3::ZERO {
            let [x, y, z] = obstacle.velocity_mps.to_array();
            return Err(format!(
                "obstacle {} of {KIND_COLUMN} still moves at {x}, {y}, {z} m/s, expected a velocity of 0 or another {KIND_COLUMN}",
                obstacle.id
            ));
        }
        let count = self.encounters.len();
        let index = match self.encounters.last() {
            Some(last) if last.id == id => count - 1,
            _ => *self.index_of.entry(id).or_insert(count),
        };
        if !self.seen.insert((index, obstacle.id)) {
            return Err(format!(
                "encounter {id} has a second obstacle {}, expected each number once",
                obstacle.id
            ));
        }
        match self.encounters.get_mut(index) {
            Some(encounter) => encounter.obstacles.push(obstacle),
            None => self.encounters.push(Encounter {
                id,
                obstacles: vec![obstacle],
            }),
        }
        Ok(())
    }
}

/// The numbers of an obstacle in the order of [`COLUMNS`], from the third one on.
fn numbers_of(obstacle: &Obstacle) -> impl Iterator<Item = f64> {
    let position_m = obstacle.position_m.to_array().into_iter();
    let velocity_mps = obstacle.velocity_mps.to_array();
    position_m
        .chain(velocity_mps)
        .chain([obstacle.volume.radius_m()])
}

/// What a column expects where a number does not fit in it.
fn misfit(name: &str, value: f64) -> Option<String> {
    let (largest, unit) = if name.ends_with("_mps") {
        (LARGEST_SPEED_MPS, "metres per second")
    } else {
        (LARGEST_LENGTH_M, "metres")
    };
    if !value.is_finite() || value.abs() > largest {
        return Some(format!(
            "a finite number of at most {largest:e} {unit} either way"
        ));
    }
    (name == "radius_m" && value < 0.0).then(|| "a radius of 0 metres or more".into())
}

/// Groups obstacles from another source than a file into encounters, in the order of their first
/// rows. Each row is the number of its encounter and an obstacle.
///
/// # Errors
/// One sentence about a number that is not finite or out of range, a negative radius, a doubled
/// obstacle number, no encounter; rows are counted from 0.
pub fn from_rows(
    rows: impl IntoIterator<Item = (u64, Obstacle)>,
) -> Result<Vec<Encounter>, String> {
    let mut grouped = Grouped::default();
    for (row, (id, obstacle)) in rows.into_iter().enumerate() {
        let names = COLUMNS.iter().skip(2);
        let wrong = numbers_of(&obstacle).zip(names).find_map(|(value, name)| {
            let expected = misfit(name, value)?;
            Some(format!("column {name} holds {value}, expected {expected}"))
        });
        wrong
            .map_or_else(|| grouped.push(id, obstacle), Err)
            .map_err(|message| format!("row {row}: {message}"))?;
    }
    if grouped.encounters.is_empty() {
        return Err("there is no encounter, expected at least one row".to_owned());
    }
    Ok(grouped.encounters)
}

/// The movement for a word of the column [`KIND_COLUMN`]; `None` for an unknown word.
pub fn movement_of(word: &[u8]) -> Option<Movement> {
    let word = if word.is_empty() { b"straight" } else { word };
    let known = KINDS.iter().find(|(kind, _)| kind.as_bytes() == word);
    known.map(|(_, movement)| *movement)
}

/// One row.
struct EncounterRow<'a> {
    record: &'a csv::ByteRecord,
    columns: &'a [usize; COLUMNS.len()],
    /// The index of `kind` in the file, if present.
    kind_column: Option<usize>,
}

impl EncounterRow<'_> {
    fn field(&self, column: usize) -> &[u8] {
        let place = self.columns.get(column).copied().unwrap_or(usize::MAX);
        self.record.get(place).unwrap_or_default()
    }

    fn wrong(&self, column: usize, expected: &str) -> String {
        let name = COLUMNS.get(column).copied().unwrap_or_default();
        let found = shown(&String::from_utf8_lossy(self.field(column)));
        format!("column {name} holds {found}, expected {expected}")
    }

    fn parsed<T: FromStr>(&self, column: usize, expected: &str) -> Result<T, String> {
        let text = from_utf8(self.field(column)).ok();
        text.and_then(|text| text.parse().ok())
            .ok_or_else(|| self.wrong(column, expected))
    }

    fn number(&self, column: usize) -> Result<f64, String> {
        let name = COLUMNS.get(column).copied().unwrap_or_default();
        let value = self.parsed(column, "").unwrap_or(f64::NAN);
        misfit(name, value).map_or(Ok(value), |expected| Err(self.wrong(column, &expected)))
    }

    fn obstacle(&self) -> Result<Obstacle, String> {
        let number = |column| self.number(column);
        let radius_m = number(8)?;
        let id = self.parsed(1, "a whole number from 0 to 4294967295")?;
        let position_m = DVec3::new(number(2)?, number(3)?, number(4)?);
        let velocity_mps = DVec3::new(number(5)?, number(6)?, number(7)?);
        let volume = ProtectedVolume::Sphere { radius_m };
        Ok(Obstacle {
            movement: self.movement()?,
            ..Obstacle::straight(id, position_m, velocity_mps, volume)
        })
    }

    fn movement(&self) -> Result<Movement, String> {
        let field = self.kind_column.and_then(|place| self.record.get(place));
        let field = field.unwrap_or_default();
        movement_of(field).ok_or_else(|| {
            let found = shown(&String::from_utf8_lossy(field));
            format!("column {KIND_COLUMN} holds {found}, expected still, straight, aircraft or uas")
        })
    }
}

/// Writes encounters as a batch file, with the column `kind` if any obstacle does not fly straight.
///
/// # Errors
/// Errors of `out`; an obstacle's bounds that are not those of a kind.
pub fn write_to<'a>(
    out: &mut impl Write,
    encounters: impl IntoIterator<Item = &'a Encounter, IntoIter: Clone>,
) -> io::Result<()> {
    let encounters = encounters.into_iter();
    let is_straight = |obstacle: &Obstacle| obstacle.movement == Movement::Straight;
    let mut all = encounters.clone();
    let has_kinds = !all.all(|encounter| encounter.obstacles.iter().all(is_straight));
    let kind = if has_kinds { ",kind" } else { "" };
    writeln!(out, "{}{kind}", COLUMNS.join(","))?;
    for encounter in encounters {
        for obstacle in &encounter.obstacles {
            write!(out, "{},{}", encounter.id, obstacle.id)?;
            for value in numbers_of(obstacle) {
                // As many digits as it takes to read the same number back.
                write!(out, ",{value}")?;
            }
            if has_kinds {
                let kind = kind_of(obstacle.movement).ok_or_else(|| {
                    let message = "an obstacle's bounds are not those of a kind, expected still, straight, aircraft or uas";
                    io::Error::new(io::ErrorKind::InvalidData, message)
                })?;
                write!(out, ",{kind}")?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

/// The word of the column [`KIND_COLUMN`] for a movement; `None` for bounds that have no word.
pub fn kind_of(movement: Movement) -> Option<&'static str> {
    let known = KINDS.iter().find(|(_, known)| *known == movement);
    known.map(|(kind, _)| *kind)
}

/// Writes a batch file, completely or not at all; see [`write_to`].
///
/// # Errors
/// A file that cannot be written.
pub fn write<'a>(
    path: &Path,
    encounters: impl IntoIterator<Item = &'a Encounter, IntoIter: Clone>,
) -> Result<(), OutputError> {
    atomic::write_with(path, |file| write_to(file, encounters))
}
