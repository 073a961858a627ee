//! The columns of a `.daa` file and their units.

use crate::error::shown;
use crate::units::Unit;

/// A column of every file, under one of several names.
#[derive(Debug, Clone, Copy)]
pub(super) struct DaaColumn {
    /// Its index in a row.
    pub(super) place: usize,
    /// Its name in the file.
    name: &'static str,
    /// Its unit.
    pub(super) unit: Unit,
}

/// Three related columns.
pub(super) type ColumnTriple = [DaaColumn; 3];

/// The form of positions.
#[derive(Debug, Clone, Copy)]
pub(super) enum PositionColumns {
    /// Latitude, longitude, altitude.
    Geodetic(ColumnTriple),
    /// East, north, up.
    Cartesian(ColumnTriple),
}

/// The form of velocities.
#[derive(Debug, Clone, Copy)]
pub(super) enum VelocityColumns {
    /// True track, ground speed, vertical speed.
    Track(ColumnTriple),
    /// East, north, up.
    Cartesian(ColumnTriple),
}

/// The columns of a file.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    /// Number of columns in the header.
    pub(super) width: usize,
    pub(super) name: usize,
    pub(super) position: PositionColumns,
    pub(super) velocity: VelocityColumns,
    pub(super) time: DaaColumn,
}

const NAME: &[&str] = &["name", "aircraft", "id"];
const LATITUDE: &[&str] = &["lat", "latitude"];
const LONGITUDE: &[&str] = &["lon", "long", "longitude"];
const ALTITUDE: &[&str] = &["alt", "altitude"];
const EAST: &[&str] = &["sx", "east"];
const NORTH: &[&str] = &["sy", "north"];
const UP: &[&str] = &["sz", "alt", "altitude"];
const TRACK: &[&str] = &["trk", "track"];
const GROUND_SPEED: &[&str] = &["gs", "groundspeed", "groundspd"];
const VERTICAL_SPEED: &[&str] = &["vs", "verticalspeed", "hdot"];
const TIME: &[&str] = &["time", "tm", "st", "clock"];

impl Layout {
    /// The layout that a line of column names gives, with the default units.
    pub(super) fn from_header(header: &str) -> Result<Self, String> {
        let names: Vec<String> = fields(header, None)
            .into_iter()
            .map(str::to_ascii_lowercase)
            .collect();
        let header = Header { names: &names };
        let kind = |first: &[&str], second: &[&str]| header.has(first) && !header.has(second);

        let name = header.place(NAME)?;
        let cartesian = [EAST, NORTH].concat();
        let position = if kind(&cartesian, &[LATITUDE, LONGITUDE].concat()) {
            PositionColumns::Cartesian([
                header.column(EAST, Unit::NAUTICAL_MILE)?,
                header.column(NORTH, Unit::NAUTICAL_MILE)?,
                header.column(UP, Unit::FOOT)?,
            ])
        } else {
            PositionColumns::Geodetic([
                header.column(LATITUDE, Unit::DEGREE)?,
                header.column(LONGITUDE, Unit::DEGREE)?,
                header.column(ALTITUDE, Unit::FOOT)?,
            ])
        };
        let velocity = if kind(&["vx", "vy", "vz"], &[TRACK, GROUND_SPEED].concat()) {
            VelocityColumns::Cartesian([
                header.column(&["vx"], Unit::KNOT)?,
                header.column(&["vy"], Unit::KNOT)?,
                header.column(&["vz"], Unit::FOOT_PER_MINUTE)?,
            ])
        } else {
            VelocityColumns::Track([
                header.column(TRACK, Unit::DEGREE)?,
                header.column(GROUND_SPEED, Unit::KNOT)?,
                header.column(VERTICAL_SPEED, Unit::FOOT_PER_MINUTE)?,
            ])
        };
        Ok(Self {
            width: names.len(),
            name,
            position,
            velocity,
            time: header.column(TIME, Unit::SECOND)?,
        })
    }

    /// Every column with a quantity.
    fn quantities(&mut self) -> impl Iterator<Item = &mut DaaColumn> {
        let (PositionColumns::Geodetic(position) | PositionColumns::Cartesian(position)) =
            &mut self.position;
        let (VelocityColumns::Track(velocity) | VelocityColumns::Cartesian(velocity)) =
            &mut self.velocity;
        position.iter_mut().chain(velocity).chain([&mut self.time])
    }

    /// Whether a line holds units: no quantity in it is a number or a clock time.
    pub(super) fn is_unit_line(&self, line: &str) -> bool {
        let fields = fields(line, Some(self.width));
        self.clone().quantities().all(|column| {
            fields.get(column.place).is_none_or(|field| {
                !field.starts_with(|c: char| {
                    c.is_ascii_digit() || "+-.".contains(c) && field.len() > 1
                }) && field.parse::<f64>().is_err()
            })
        })
    }

    /// Takes the units of a line of units.
    pub(super) fn take_units(&mut self, line: &str) -> Result<(), String> {
        let fields = fields(line, Some(self.width));
        if fields.len() != self.width {
            let (found, expected) = (fields.len(), self.width);
            return Err(format!(
                "has {found} units, expected {expected}, one for each column"
            ));
        }
        for column in self.quantities() {
            let text = fields.get(column.place).copied().unwrap_or_default();
            if Unit::is_unspecified(text) {
                continue;
            }
            let name = column.name;
            let expected = column.unit.dimension.with_article();
            let unit = Unit::parse(text).ok_or_else(|| {
                let example = column.unit.dimension.examples();
                format!(
                    "column {name} has the unknown unit {}, expected {expected} unit such as {example}",
                    shown(text)
                )
            })?;
            if unit.dimension != column.unit.dimension {
                let found = unit.dimension.with_article();
                return Err(format!(
                    "column {name} has the unit {} of {found}, expected that of {expected}",
                    shown(text)
                ));
            }
            column.unit = unit;
        }
        Ok(())
    }
}

impl DaaColumn {
    /// The number in this column of a row, in SI units.
    pub(super) fn value(&self, fields: &[&str]) -> Result<f64, String> {
        let text = fields.get(self.place).copied().unwrap_or_default();
        let name = self.name;
        let number: f64 = text
            .parse()
            .map_err(|_| format!("column {name} holds {}, expected a number", shown(text)))?;
        if !number.is_finite() {
            return Err(format!(
                "column {name} holds {}, expected a finite number",
                shown(text)
            ));
        }
        Ok(self.unit.to_si(number))
    }

    /// The time in this column, s: a number, or `hours:minutes:seconds`, or `minutes:seconds`.
    pub(super) fn clock_s(&self, fields: &[&str]) -> Result<f64, String> {
        let text = fields.get(self.place).copied().unwrap_or_default();
        if !text.contains(':') {
            return self.value(fields);
        }
        let parts: Option<Vec<f64>> = text.split(':').map(|part| part.parse().ok()).collect();
        let valid = |parts: &Vec<f64>| {
            parts.len() <= 3
                && parts.iter().all(|part| part.is_finite() && *part >= 0.0)
                && parts.iter().skip(1).all(|part| *part < 60.0)
        };
        match parts.filter(valid) {
            Some(parts) => Ok(parts.iter().fold(0.0, |sum, part| sum * 60.0 + part)),
            None => Err(format!(
                "column {} holds {}, expected seconds or hours:minutes:seconds",
                self.name,
                shown(text)
            )),
        }
    }

    /// The column's name in the file.
    pub(super) const fn name(&self) -> &'static str {
        self.name
    }
}

/// The names of the columns in lower case.
struct Header<'a> {
    names: &'a [String],
}

impl Header<'_> {
    fn has(&self, names: &[&str]) -> bool {
        self.names.iter().any(|name| names.contains(&name.as_str()))
    }

    /// The index of the column with one of these names, and that name.
    fn find(&self, names: &[&'static str]) -> Result<(usize, &'static str), String> {
        let mut found = None;
        for (place, name) in self.names.iter().enumerate() {
            if let Some(known) = names.iter().find(|known| *known == name)
                && found.replace((place, *known)).is_some()
            {
                return Err(format!(
                    "the column {} appears twice, expected it once",
                    names.join("|")
                ));
            }
        }
        found.ok_or_else(|| {
            format!(
                "the column {} is missing, expected name|aircraft|id, lat lon alt or sx sy sz, \
                 trk gs vs or vx vy vz, time|tm|st|clock",
                names.join("|")
            )
        })
    }

    fn place(&self, names: &[&'static str]) -> Result<usize, String> {
        Ok(self.find(names)?.0)
    }

    fn column(&self, names: &[&'static str], unit: Unit) -> Result<DaaColumn, String> {
        let (place, name) = self.find(names)?;
        Ok(DaaColumn { place, name, unit })
    }
}

/// The fields of a line, separated by commas or semicolons, or by blanks and tabs alone.
///
/// If commas alone give `expected` fields, only commas separate, so that a name may contain blanks.
/// An empty field at the very end does not count.
pub(super) fn fields(line: &str, expected: Option<usize>) -> Vec<&str> {
    let is_comma = |c: char| c == ',' || c == ';';
    let mut by_comma: Vec<&str> = line.split(is_comma).map(str::trim).collect();
    if by_comma.len() > 1 && by_comma.last().is_some_and(|last| last.is_empty()) {
        by_comma.pop();
    }
    if expected == Some(by_comma.len()) {
        return by_comma;
    }
    by_comma
        .into_iter()
        .flat_map(|field| {
            let empty = field.is_empty().then_some("");
            empty.into_iter().chain(field.split_whitespace())
        })
        .collect()
}
