//! Which column of a `.daa` file holds what.

use super::columns::DaaColumn;
use super::report::{DaaMotion, DaaReport, EarthPlace, Place};
use crate::error::shown;
use crate::units::{Dimension, Unit};
use fga_alerts::Deviation;
use glam::DVec3;

/// The columns of a file.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    /// Number of columns in the header.
    pub(super) width: usize,
    pub(super) name: usize,
    /// Whether positions are latitude, longitude, altitude, not east, north, up.
    pub(super) is_geodetic: bool,
    pub(super) position: [DaaColumn; 3],
    /// Whether velocities are true track, ground speed, vertical speed, not east, north, up.
    pub(super) is_track: bool,
    pub(super) velocity: [DaaColumn; 3],
    pub(super) time: DaaColumn,
    alerter: Option<usize>,
    /// The optional columns with a quantity.
    extras: Vec<DaaColumn>,
}

/// The optional columns with a quantity, and their units where the file gives none.
const EXTRAS: [(&str, Dimension, Option<Unit>); 4] = [
    ("heading", Dimension::Angle, Some(Unit::DEGREE)),
    ("airspeed", Dimension::Speed, Some(Unit::KNOT)),
    ("air_vx", Dimension::Speed, Some(Unit::KNOT)),
    ("air_vy", Dimension::Speed, Some(Unit::KNOT)),
];
/// The columns of deviations, in the order of [`Deviation`].
const DEVIATIONS: [(&str, Dimension); 8] = [
    ("s_ew_std", Dimension::Length),
    ("s_ns_std", Dimension::Length),
    ("s_en_std", Dimension::Length),
    ("sz_std", Dimension::Length),
    ("v_ew_std", Dimension::Speed),
    ("v_ns_std", Dimension::Speed),
    ("v_en_std", Dimension::Speed),
    ("vz_std", Dimension::Speed),
];

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
        let name = header.find(NAME)?.0;
        let is_geodetic = !kind(&[EAST, NORTH].concat(), &[LATITUDE, LONGITUDE].concat());
        let position = if is_geodetic {
            header.columns([LATITUDE, LONGITUDE, ALTITUDE], Unit::DEGREE, Unit::FOOT)?
        } else {
            header.columns([EAST, NORTH, UP], Unit::NAUTICAL_MILE, Unit::FOOT)?
        };
        let is_track = !kind(&["vx", "vy", "vz"], &[TRACK, GROUND_SPEED].concat());
        let velocity = if is_track {
            [
                header.column(TRACK, Unit::DEGREE)?,
                header.column(GROUND_SPEED, Unit::KNOT)?,
                header.column(VERTICAL_SPEED, Unit::FOOT_PER_MINUTE)?,
            ]
        } else {
            let names: [&[&str]; 3] = [&["vx"], &["vy"], &["vz"]];
            header.columns(names, Unit::KNOT, Unit::FOOT_PER_MINUTE)?
        };
        Ok(Self {
            width: names.len(),
            name,
            is_geodetic,
            position,
            is_track,
            velocity,
            time: header.column(TIME, Unit::SECOND)?,
            alerter: names.iter().position(|name| name == "alerter"),
            extras: EXTRAS
                .into_iter()
                .chain(DEVIATIONS.map(|(name, dimension)| (name, dimension, None)))
                .filter_map(|(name, dimension, unit)| {
                    DaaColumn::optional(&names, name, dimension, unit)
                })
                .collect(),
        })
    }

    /// Every column of every file with a quantity.
    fn quantities(&self) -> impl Iterator<Item = &DaaColumn> {
        let columns = self.position.iter().chain(&self.velocity);
        columns.chain([&self.time])
    }

    /// Whether a line holds units: no quantity in it is a number or a clock time.
    pub(super) fn is_unit_line(&self, line: &str) -> bool {
        let fields = fields(line, Some(self.width));
        self.quantities().all(|column| {
            column.field(&fields).is_none_or(|field| {
                !field.starts_with(|c: char| {
                    c.is_ascii_digit() || "+-.".contains(c) && field.len() > 1
                }) && field.parse::<f64>().is_err()
            })
        })
    }

    /// Takes the units of a line of units.
    pub(super) fn take_units(&mut self, line: &str) -> Result<(), String> {
        let units = fields(line, Some(self.width));
        if units.len() != self.width {
            let (found, expected) = (units.len(), self.width);
            return Err(format!(
                "has {found} units, expected {expected}, one for each column"
            ));
        }
        let columns = self.position.iter_mut().chain(&mut self.velocity);
        let columns = columns.chain([&mut self.time]);
        columns
            .chain(&mut self.extras)
            .try_for_each(|column| column.take_unit(&units))
    }

    /// The fields of a row.
    pub(super) fn row<'a>(&self, line: &'a str) -> Result<Vec<&'a str>, String> {
        let fields = fields(line, Some(self.width));
        if fields.len() != self.width {
            let (found, expected) = (fields.len(), self.width);
            return Err(format!(
                "has {found} fields, expected {expected} as in the line of column names"
            ));
        }
        Ok(fields)
    }

    /// What a row says about an aircraft, as it says it.
    pub(super) fn report(&self, fields: &[&str]) -> Result<DaaReport, String> {
        let values = |columns: &[DaaColumn; 3]| -> Result<[f64; 3], String> {
            let [first, second, third] = columns;
            Ok([
                first.value(fields)?,
                second.value(fields)?,
                third.value(fields)?,
            ])
        };
        let position = values(&self.position)?;
        let velocity = values(&self.velocity)?;
        Ok(DaaReport {
            aircraft: 0,
            place: if self.is_geodetic {
                let [latitude_rad, longitude_rad, altitude_m] = position;
                Place::Geodetic(EarthPlace {
                    latitude_rad,
                    longitude_rad,
                    altitude_m,
                })
            } else {
                Place::Local(DVec3::from_array(position))
            },
            ground: if self.is_track {
                let [track_rad, speed_mps, climb_mps] = velocity;
                DaaMotion::from_track(track_rad, speed_mps, climb_mps)
            } else {
                DaaMotion::from_velocity(DVec3::from_array(velocity))
            },
            air: self.air(fields)?,
            alerter: self.alerter(fields)?,
            deviation: self.deviation(fields)?,
        })
    }

    /// The value of an optional column; `None` without it and for an empty field.
    fn extra(&self, name: &str, fields: &[&str]) -> Result<Option<f64>, String> {
        let column = self.extras.iter().find(|column| column.name == name);
        column.map_or(Ok(None), |column| column.given(fields))
    }

    /// Velocity through the air to the east and north, metres per second.
    pub(super) fn air_mps(&self, fields: &[&str]) -> Result<Option<(f64, f64)>, String> {
        Ok(self
            .extra("air_vx", fields)?
            .zip(self.extra("air_vy", fields)?))
    }

    /// Compass direction (radians) and speed (metres per second) through the air.
    fn air(&self, fields: &[&str]) -> Result<Option<(f64, f64)>, String> {
        let (heading, airspeed) = (
            self.extra("heading", fields)?,
            self.extra("airspeed", fields)?,
        );
        if airspeed.is_some_and(|speed_mps| speed_mps < 0.0) {
            return Err("column airspeed is negative, expected 0 or more".into());
        }
        Ok(heading.zip(airspeed))
    }

    fn alerter(&self, fields: &[&str]) -> Result<Option<u32>, String> {
        let text = self.alerter.and_then(|place| fields.get(place).copied());
        let Some(text) = text.filter(|text| !["", "-"].contains(text)) else {
            return Ok(None);
        };
        text.parse().map(Some).map_err(|_| {
            let found = shown(text);
            format!("column alerter holds {found}, expected a number of 0 or more")
        })
    }

    /// The uncertainty of a row's state; zero without these columns.
    fn deviation(&self, fields: &[&str]) -> Result<Deviation, String> {
        let mut values = [0.0; 8];
        for (value, (name, _)) in values.iter_mut().zip(DEVIATIONS) {
            *value = self.extra(name, fields)?.unwrap_or(0.0);
            let signed = name.contains("_en_");
            if *value < 0.0 && !signed {
                return Err(format!(
                    "column {name} is negative, expected a deviation of 0 or more"
                ));
            }
        }
        Ok(Deviation::from_array(values))
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

    fn column(&self, names: &[&'static str], unit: Unit) -> Result<DaaColumn, String> {
        let (place, name) = self.find(names)?;
        Ok(DaaColumn::new(place, name, unit))
    }

    /// Three columns, the first two in one unit.
    fn columns(
        &self,
        [first, second, third]: [&[&'static str]; 3],
        unit: Unit,
        last: Unit,
    ) -> Result<[DaaColumn; 3], String> {
        let first = self.column(first, unit)?;
        Ok([first, self.column(second, unit)?, self.column(third, last)?])
    }
}

/// The fields of a line, separated by commas or semicolons, or by blanks and tabs alone.
///
/// If commas alone give `expected` fields, only commas separate, so that a name may contain blanks.
/// An empty field at the very end does not count.
fn fields(line: &str, expected: Option<usize>) -> Vec<&str> {
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
