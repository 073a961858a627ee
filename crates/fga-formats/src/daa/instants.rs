//! A recording time by time, with every column that alerts and bands need.

use super::columns::{Layout, PositionColumns, VelocityColumns, fields};
use super::extras::Extras;
use super::rows::DaaRows;
use crate::error::InputError;
use crate::tally::Tally;
use fga_alerts::Deviation;
use glam::DVec3;
use std::path::Path;

/// The position of an aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// On the earth.
    Geodetic {
        /// Latitude, radians, north positive.
        latitude_rad: f64,
        /// Longitude, radians, east positive.
        longitude_rad: f64,
        /// Altitude, metres.
        altitude_m: f64,
    },
    /// In the plane: east, north, up, metres.
    Local(DVec3),
}

impl Place {
    /// Altitude, metres.
    pub const fn altitude_m(&self) -> f64 {
        match self {
            Self::Geodetic { altitude_m, .. } => *altitude_m,
            Self::Local(position_m) => position_m.z,
        }
    }
}

/// A velocity with its direction and speed as given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DaaMotion {
    /// Direction, radians clockwise from north.
    pub track_rad: f64,
    /// Horizontal speed, metres per second.
    pub speed_mps: f64,
    /// Velocity: east, north, up, metres per second.
    pub velocity_mps: DVec3,
}

impl DaaMotion {
    /// From direction, speed and climb.
    pub fn from_track(track_rad: f64, speed_mps: f64, climb_mps: f64) -> Self {
        let (sin, cos) = libm::sincos(track_rad);
        Self {
            track_rad,
            speed_mps,
            velocity_mps: DVec3::new(speed_mps * sin, speed_mps * cos, climb_mps),
        }
    }

    /// From a vector.
    pub fn from_velocity(velocity_mps: DVec3) -> Self {
        let DVec3 { x, y, .. } = velocity_mps;
        Self {
            track_rad: libm::atan2(x, y),
            speed_mps: libm::sqrt(x * x + y * y),
            velocity_mps,
        }
    }
}

/// The content of a row about an aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DaaReport {
    /// The aircraft: its index in [`Instants::names`].
    pub aircraft: usize,
    /// Its position.
    pub place: Place,
    /// Its velocity over the ground.
    pub ground: DaaMotion,
    /// Direction (radians clockwise from north) and speed (metres per second) through the air.
    pub air: Option<(f64, f64)>,
    /// The alerter that judges it, counted from 1; 0 for none.
    pub alerter: Option<u32>,
    /// The uncertainty of the state.
    pub deviation: Deviation,
}

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
    parse(&super::text(path)?, path)
}

/// Reads a recording from `text`; errors name it `path`. See [`read`].
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, path: &Path) -> Result<Instants, InputError> {
    let mut lines = super::meaningful_lines(text).peekable();
    let (header_line, header) = loop {
        match lines.next() {
            None => {
                return Err(InputError::in_file(
                    path,
                    "is empty, expected a line of column names",
                ));
            }
            Some((_, line)) if line.contains('=') => {}
            Some(header) => break header,
        }
    };
    let at = |number, message| InputError::at_line(path, number, message);
    let mut layout = Layout::from_header(header).map_err(|message| at(header_line, message))?;
    let mut extras = Extras::from_header(header);
    if let Some(&(number, line)) = lines.peek()
        && layout.is_unit_line(line)
    {
        layout
            .take_units(line)
            .and_then(|()| extras.take_units(line, layout.width))
            .map_err(|message| at(number, message))?;
        lines.next();
    }
    let mut rows = DaaRows::new(&layout, &extras);
    let mut found: Vec<(f64, DaaReport)> = Vec::new();
    for (number, line) in lines {
        let report = rows
            .push(line)
            .and_then(|()| report(&layout, &extras, line, rows.last.unwrap_or(0)))
            .map_err(|message| at(number, message))?;
        found.push(report);
    }
    if found.is_empty() {
        return Err(InputError::in_file(
            path,
            "holds no rows, expected at least one below the column names",
        ));
    }
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
        is_geodetic: matches!(layout.position, PositionColumns::Geodetic(_)),
        instants,
    })
}

/// The report of an accepted row.
fn report(
    layout: &Layout,
    extras: &Extras,
    line: &str,
    aircraft: usize,
) -> Result<(f64, DaaReport), String> {
    let fields = fields(line, Some(layout.width));
    let place = match &layout.position {
        PositionColumns::Geodetic([latitude, longitude, altitude]) => Place::Geodetic {
            latitude_rad: latitude.value(&fields)?,
            longitude_rad: longitude.value(&fields)?,
            altitude_m: altitude.value(&fields)?,
        },
        PositionColumns::Cartesian([east, north, up]) => Place::Local(DVec3::new(
            east.value(&fields)?,
            north.value(&fields)?,
            up.value(&fields)?,
        )),
    };
    let ground = match &layout.velocity {
        VelocityColumns::Track([track, speed, climb]) => DaaMotion::from_track(
            track.value(&fields)?,
            speed.value(&fields)?,
            climb.value(&fields)?,
        ),
        VelocityColumns::Cartesian([east, north, up]) => DaaMotion::from_velocity(DVec3::new(
            east.value(&fields)?,
            north.value(&fields)?,
            up.value(&fields)?,
        )),
    };
    let report = DaaReport {
        aircraft,
        place,
        ground,
        air: extras.air(&fields)?,
        alerter: extras.alerter(&fields)?,
        deviation: extras.deviation(&fields)?,
    };
    Ok((layout.time.clock_s(&fields)?, report))
}
