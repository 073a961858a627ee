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
use core::str::from_utf8;
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
        reader
            .read_byte_record(record)
            .map_err(|error| match error.into_kind() {
                csv::ErrorKind::Io(error) => InputError::unreadable(path, &error),
                _ => InputError::in_file(path, "is not a comma-separated file"),
            })
    };
    let line_of = |record: &csv::ByteRecord| record.position().map_or(0, csv::Position::line);

    if !next(&mut reader, &mut record)? {
        return Err(InputError::in_file(
            path,
            format!("is empty, expected the columns {}", COLUMNS.join(",")),
        ));
    }
    let columns = find_columns(&record, path, line_of(&record))?;
    let kind_column = find_kind(&record, path, line_of(&record))?;
    let width = record.len();

    let mut encounters: Vec<Encounter> = Vec::new();
    let mut index_of: HashMap<u64, usize> = HashMap::new();
    let mut seen: HashSet<(usize, u32)> = HashSet::new();
    while next(&mut reader, &mut record)? {
        let line = line_of(&record);
        if record.len() == 1 && record.get(0).is_none_or(<[u8]>::is_empty) {
            continue;
        }
        if record.len() != width {
            let found = record.len();
            return Err(InputError::at_line(
                path,
                line,
                format!("has {found} columns, expected {width} as in the first line"),
            ));
        }
        let row = Row {
            record: &record,
            columns: &columns,
            kind_column,
            path,
            line,
        };
        let id = row.identifier(0)?;
        let obstacle = row.obstacle()?;
        let index = match encounters.last() {
            Some(last) if last.id == id => encounters.len() - 1,
            _ => *index_of.entry(id).or_insert_with(|| {
                encounters.push(Encounter {
                    id,
                    obstacles: Vec::new(),
                });
                encounters.len() - 1
            }),
        };
        if !seen.insert((index, obstacle.id)) {
            return Err(InputError::at_line(
                path,
                line,
                format!(
                    "encounter {id} has a second obstacle {}, expected each number once",
                    obstacle.id
                ),
            ));
        }
        if let Some(encounter) = encounters.get_mut(index) {
            encounter.obstacles.push(obstacle);
        }
    }
    if encounters.is_empty() {
        return Err(InputError::in_file(
            path,
            "holds no encounter, expected at least one row below the column names",
        ));
    }
    Ok(encounters)
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
    let mut encounters: Vec<Encounter> = Vec::new();
    let mut index_of: HashMap<u64, usize> = HashMap::new();
    let mut seen: HashSet<(u64, u32)> = HashSet::new();
    for (row, (id, obstacle)) in rows.into_iter().enumerate() {
        let values = obstacle
            .position_m
            .to_array()
            .into_iter()
            .chain(obstacle.velocity_mps.to_array())
            .chain([obstacle.volume.radius_m()]);
        for (index, value) in values.enumerate() {
            let name = COLUMNS.get(index + 2).copied().unwrap_or_default();
            let largest = if (3..6).contains(&index) {
                LARGEST_SPEED_MPS
            } else {
                LARGEST_LENGTH_M
            };
            if !value.is_finite() || value.abs() > largest {
                return Err(format!(
                    "row {row}: column {name} holds {value}, expected a finite number of at most {largest:e} either way"
                ));
            }
        }
        if obstacle.volume.radius_m() < 0.0 {
            return Err(format!(
                "row {row}: column radius_m holds {}, expected a radius of 0 metres or more",
                obstacle.volume.radius_m()
            ));
        }
        if !seen.insert((id, obstacle.id)) {
            return Err(format!(
                "row {row}: encounter {id} has a second obstacle {}, expected each number once",
                obstacle.id
            ));
        }
        let index = *index_of.entry(id).or_insert_with(|| {
            encounters.push(Encounter {
                id,
                obstacles: Vec::new(),
            });
            encounters.len() - 1
        });
        if let Some(encounter) = encounters.get_mut(index) {
            encounter.obstacles.push(obstacle);
        }
    }
    if encounters.is_empty() {
        return Err("there is no encounter, expected at least one row".to_owned());
    }
    Ok(encounters)
}

/// The movement for a word of the column [`KIND_COLUMN`]; `None` for an unknown word.
pub const fn movement_of(word: &[u8]) -> Option<Movement> {
    match word {
        b"" | b"straight" => Some(Movement::Straight),
        b"still" => Some(Movement::AtRest),
        b"aircraft" => Some(Movement::CREWED),
        b"uas" => Some(Movement::SMALL_UAS),
        _ => None,
    }
}

/// The index of each of [`COLUMNS`] in the file.
fn find_columns(
    header: &csv::ByteRecord,
    path: &Path,
    line: u64,
) -> Result<[usize; 9], InputError> {
    let mut columns = [0; 9];
    for (column, name) in columns.iter_mut().zip(COLUMNS) {
        let mut places = header.iter().enumerate().filter_map(|(place, field)| {
            let field = field.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(field);
            field.eq_ignore_ascii_case(name.as_bytes()).then_some(place)
        });
        *column = places.next().ok_or_else(|| {
            InputError::at_line(
                path,
                line,
                format!(
                    "the column {name} is missing, expected the columns {}",
                    COLUMNS.join(",")
                ),
            )
        })?;
        if places.next().is_some() {
            return Err(InputError::at_line(
                path,
                line,
                format!("the column {name} appears twice, expected it once"),
            ));
        }
    }
    Ok(columns)
}

/// The index of [`KIND_COLUMN`] in the file, if present.
fn find_kind(
    header: &csv::ByteRecord,
    path: &Path,
    line: u64,
) -> Result<Option<usize>, InputError> {
    let mut places = header.iter().enumerate().filter_map(|(place, field)| {
        field
            .eq_ignore_ascii_case(KIND_COLUMN.as_bytes())
            .then_some(place)
    });
    let first = places.next();
    match places.next() {
        None => Ok(first),
        Some(_) => Err(InputError::at_line(
            path,
            line,
            format!("the column {KIND_COLUMN} appears twice, expected it at most once"),
        )),
    }
}

/// One row with the context for its errors.
struct Row<'a> {
    record: &'a csv::ByteRecord,
    columns: &'a [usize; 9],
    /// The index of `kind` in the file, if present.
    kind_column: Option<usize>,
    path: &'a Path,
    line: u64,
}

impl Row<'_> {
    fn field(&self, column: usize) -> &[u8] {
        let place = self.columns.get(column).copied().unwrap_or(usize::MAX);
        self.record.get(place).unwrap_or_default()
    }

    fn error(&self, column: usize, expected: &str) -> InputError {
        let name = COLUMNS.get(column).copied().unwrap_or_default();
        let found = shown(&String::from_utf8_lossy(self.field(column)));
        InputError::at_line(
            self.path,
            self.line,
            format!("column {name} holds {found}, expected {expected}"),
        )
    }

    fn identifier(&self, column: usize) -> Result<u64, InputError> {
        from_utf8(self.field(column))
            .ok()
            .and_then(|text| text.parse().ok())
            .ok_or_else(|| self.error(column, "a whole number from 0"))
    }

    fn number(&self, column: usize, largest: f64, unit: &str) -> Result<f64, InputError> {
        let value: f64 = from_utf8(self.field(column))
            .ok()
            .and_then(|text| text.parse().ok())
            .ok_or_else(|| self.error(column, &format!("a number of {unit}")))?;
        if !value.is_finite() {
            return Err(self.error(column, &format!("a finite number of {unit}")));
        }
        if value.abs() > largest {
            return Err(self.error(column, &format!("at most {largest:e} {unit} either way")));
        }
        Ok(value)
    }

    fn obstacle(&self) -> Result<Obstacle, InputError> {
        let length = |column| self.number(column, LARGEST_LENGTH_M, "metres");
        let speed = |column| self.number(column, LARGEST_SPEED_MPS, "metres per second");
        let radius_m = length(8)?;
        if radius_m < 0.0 {
            return Err(self.error(8, "a radius of 0 metres or more"));
        }
        let id = u32::try_from(self.identifier(1)?)
            .map_err(|_| self.error(1, "a whole number from 0 to 4294967295"))?;
        let position_m = DVec3::new(length(2)?, length(3)?, length(4)?);
        let velocity_mps = DVec3::new(speed(5)?, speed(6)?, speed(7)?);
        let volume = ProtectedVolume::Sphere { radius_m };
        Ok(Obstacle {
            movement: self.movement()?,
            ..Obstacle::straight(id, position_m, velocity_mps, volume)
        })
    }

    fn movement(&self) -> Result<Movement, InputError> {
        let field = self.kind_column.and_then(|place| self.record.get(place));
        let field = field.unwrap_or_default();
        movement_of(field).ok_or_else(|| {
            InputError::at_line(
                self.path,
                self.line,
                format!(
                    "column {KIND_COLUMN} holds {}, expected still, straight, aircraft or uas",
                    shown(&String::from_utf8_lossy(field))
                ),
            )
        })
    }
}

/// Writes encounters one by one; lengths and speeds with six decimals.
#[derive(Debug)]
pub struct EncounterWriter<W> {
    out: W,
    row: Vec<u8>,
    kinds: bool,
}

impl<W: Write> EncounterWriter<W> {
    /// Begins a file of obstacles that fly straight: writes the column names, without `kind`.
    ///
    /// # Errors
    /// Errors of `out`.
    pub fn new(mut out: W) -> io::Result<Self> {
        writeln!(out, "{}", COLUMNS.join(","))?;
        Ok(Self {
            out,
            row: Vec::new(),
            kinds: false,
        })
    }

    /// Begins a file with the column `kind`, the movement of every obstacle.
    ///
    /// # Errors
    /// Errors of `out`.
    pub fn with_kinds(mut out: W) -> io::Result<Self> {
        writeln!(out, "{},{KIND_COLUMN}", COLUMNS.join(","))?;
        Ok(Self {
            out,
            row: Vec::new(),
            kinds: true,
        })
    }

    /// Writes one encounter.
    ///
    /// # Errors
    /// Errors of the output.
    pub fn write(&mut self, encounter: &Encounter) -> io::Result<()> {
        for obstacle in &encounter.obstacles {
            self.row.clear();
            write!(self.row, "{},{}", encounter.id, obstacle.id)?;
            for value in obstacle
                .position_m
                .to_array()
                .into_iter()
                .chain(obstacle.velocity_mps.to_array())
                .chain([obstacle.volume.radius_m()])
            {
                // As many digits as it takes to read the same number back.
                write!(self.row, ",{value}")?;
            }
            if self.kinds {
                write!(self.row, ",{}", kind_name(obstacle.movement)?)?;
            }
            self.row.push(b'\n');
            self.out.write_all(&self.row)?;
        }
        Ok(())
    }

    /// Returns the output.
    pub fn into_inner(self) -> W {
        self.out
    }
}

/// The word of the column [`KIND_COLUMN`] for a movement; `None` for bounds that have no word.
pub fn kind_of(movement: Movement) -> Option<&'static str> {
    match movement {
        Movement::AtRest => Some("still"),
        Movement::Straight => Some("straight"),
        Movement::CREWED => Some("aircraft"),
        Movement::SMALL_UAS => Some("uas"),
        Movement::Aircraft(_) => None,
    }
}

fn kind_name(movement: Movement) -> io::Result<&'static str> {
    kind_of(movement).ok_or_else(|| {
        io::Error::new(
            io::ErrorKind::InvalidData,
            "an obstacle's bounds are not those of a kind, expected still, straight, aircraft or uas",
        )
    })
}

/// Writes a batch file, completely or not at all; with the column `kind` if any obstacle does not fly
/// straight.
///
/// # Errors
/// A file that cannot be written.
pub fn write<'a>(
    path: &Path,
    encounters: impl IntoIterator<Item = &'a Encounter, IntoIter: Clone>,
) -> Result<(), OutputError> {
    let mut encounters = encounters.into_iter();
    let is_straight = |obstacle: &Obstacle| obstacle.movement == Movement::Straight;
    let straight = encounters
        .clone()
        .all(|encounter| encounter.obstacles.iter().all(is_straight));
    atomic::write_with(path, |file| {
        let mut writer = if straight {
            EncounterWriter::new(file)?
        } else {
            EncounterWriter::with_kinds(file)?
        };
        encounters.try_for_each(|encounter| writer.write(encounter))
    })
}
