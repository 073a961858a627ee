//! The rows of a `.daa` file.

use super::columns::DaaColumn;
use super::layout::Layout;
use super::report::{DaaMotion, DaaReport, Place};
use super::{Track, TrackSample};
use crate::error::{InputError, shown};
use crate::geodesy::{Earth, Geodetic, LocalFrame, velocity_from_compass};
use crate::tally::{LeftOut, Tally};
use crate::units::DEGREE_RAD;
use glam::DVec3;
use std::collections::HashMap;
use std::path::Path;

/// The largest plausible altitude and Cartesian coordinate, metres.
const LARGEST_ALTITUDE_M: f64 = 1e5;
const LARGEST_POSITION_M: f64 = 1e7;
/// The largest plausible speed, metres per second.
const LARGEST_SPEED_MPS: f64 = 5000.0;
/// The largest plausible time, seconds: some thousand years.
const LARGEST_TIME_S: f64 = 1e11;

/// The numbered lines that are neither blank nor a comment, trimmed.
fn meaningful_lines(text: &str) -> impl Iterator<Item = (u64, &str)> {
    text.split('\n').zip(1_u64..).filter_map(|(line, number)| {
        let line = line.split('#').next().unwrap_or_default().trim();
        (!line.is_empty()).then_some((number, line))
    })
}

/// The lines `key = value` before the column names, keys in lower case, and the rows, of which at least one is there; `each`
/// gets the time of each row and what it says.
pub(super) fn rows_of(
    text: &str,
    path: &Path,
    mut each: impl FnMut(f64, DaaReport),
) -> Result<(Vec<(String, String)>, DaaRows), InputError> {
    let at = |number: u64| move |message: String| InputError::at_line(path, number, message);
    let mut lines = meaningful_lines(text).peekable();
    let mut parameters = Vec::new();
    let mut layout = loop {
        let Some((number, line)) = lines.next() else {
            let message = "is empty, expected a line of column names";
            return Err(InputError::in_file(path, message));
        };
        match line.split_once('=') {
            Some((key, value)) => {
                parameters.push((key.trim().to_ascii_lowercase(), value.trim().to_owned()));
            }
            None => break Layout::from_header(line).map_err(at(number))?,
        }
    };
    if let Some((number, line)) = lines.next_if(|(_, line)| layout.is_unit_line(line)) {
        layout.take_units(line).map_err(at(number))?;
    }
    let mut rows = DaaRows::new(layout);
    for (number, line) in lines {
        let (time_s, report) = rows.push(line).map_err(at(number))?;
        each(time_s, report);
    }
    if rows.aircraft.is_empty() {
        let message = "holds no rows, expected at least one below the column names";
        return Err(InputError::in_file(path, message));
    }
    Ok((parameters, rows))
}

/// The rows read so far.
pub(super) struct DaaRows {
    pub(super) layout: Layout,
    pub(super) aircraft: Vec<Track>,
    pub(super) frame: Option<LocalFrame>,
    index_of: HashMap<String, usize>,
    last: Option<usize>,
    pub(super) tally: Tally,
}

impl DaaRows {
    pub(super) fn new(layout: Layout) -> Self {
        Self {
            layout,
            aircraft: Vec::new(),
            frame: None,
            index_of: HashMap::new(),
            last: None,
            tally: Tally::default(),
        }
    }

    /// Takes one row, and gives its time and what it says.
    pub(super) fn push(&mut self, line: &str) -> Result<(f64, DaaReport), String> {
        let fields = self.layout.row(line)?;
        let time_s = self.layout.time.clock_s(&fields)?;
        limit(time_s, LARGEST_TIME_S, &self.layout.time, "s")?;
        let mut report = self.layout.report(&fields)?;
        let (position_m, place) = self.position(&report.place)?;
        let velocity_mps = self.velocity(&report.ground, place)?;
        let turned = report.air.map(|(compass_rad, speed_mps)| {
            let (east, north) = libm::sincos(compass_rad);
            DVec3::new(east, north, 0.0) * speed_mps
        });
        let exact = self.layout.air_mps(&fields)?;
        let exact = exact.map(|(east_mps, north_mps)| DVec3::new(east_mps, north_mps, 0.0));
        if let Some(velocity_mps) = exact
            && velocity_mps.length() > LARGEST_SPEED_MPS
        {
            return Err(format!(
                "columns air_vx and air_vy are {} m/s, expected at most {LARGEST_SPEED_MPS} m/s",
                velocity_mps.length()
            ));
        }
        let air_mps = exact
            .or(turned)
            .map(|velocity_mps| self.in_frame(velocity_mps, place));
        report.aircraft = self.aircraft_index(&fields)?;
        let Some(track) = self.aircraft.get_mut(report.aircraft) else {
            return Ok((time_s, report));
        };
        self.tally.used += 1;
        if let Some(last) = track.samples.last() {
            if time_s < last.time_s {
                return Err(format!(
                    "the time of aircraft {} goes back from {} s to {time_s} s, expected it to grow",
                    shown(&track.name),
                    last.time_s
                ));
            }
            if time_s == last.time_s {
                track.samples.pop();
                self.tally.refuse(LeftOut::SameTime);
            }
        }
        track.samples.push(TrackSample {
            time_s,
            position_m,
            velocity_mps,
            place,
            air_mps,
            deviation: report.deviation,
        });
        Ok((time_s, report))
    }

    /// The aircraft of a row; `"` repeats the previous row's.
    fn aircraft_index(&mut self, fields: &[&str]) -> Result<usize, String> {
        let name = fields.get(self.layout.name).copied().unwrap_or_default();
        let index = if name == "\"" {
            self.last
                .ok_or("the first row repeats a name (\"), expected a name")?
        } else {
            let name = name.trim_matches('"').trim();
            if name.is_empty() {
                return Err("the aircraft has no name, expected one".into());
            }
            let (name, next) = (name.to_owned(), self.aircraft.len());
            let index = *self.index_of.entry(name.clone()).or_insert(next);
            if index == next {
                let samples = Vec::new();
                self.aircraft.push(Track { name, samples });
            }
            index
        };
        self.last = Some(index);
        Ok(index)
    }

    /// Position in the local frame, and the geodetic position if the file has latitudes; the first row
    /// sets the frame.
    fn position(&mut self, place: &Place) -> Result<(DVec3, Option<Geodetic>), String> {
        let columns = &self.layout.position;
        match *place {
            Place::Geodetic(at) => {
                let place = Geodetic {
                    latitude_deg: at.latitude_rad / DEGREE_RAD,
                    longitude_deg: at.longitude_rad / DEGREE_RAD,
                    altitude_m: at.altitude_m,
                };
                limit(place.latitude_deg, 90.0, &columns[0], "deg")?;
                limit(place.longitude_deg, 360.0, &columns[1], "deg")?;
                limit(at.altitude_m, LARGEST_ALTITUDE_M, &columns[2], "m")?;
                let frame = *self
                    .frame
                    .get_or_insert_with(|| LocalFrame::new(place, Earth::Daidalus));
                Ok((frame.to_local_m(place), Some(place)))
            }
            Place::Local(position_m) => {
                for (axis_m, column) in position_m.to_array().into_iter().zip(columns) {
                    limit(axis_m, LARGEST_POSITION_M, column, "m")?;
                }
                Ok((position_m, None))
            }
        }
    }

    fn velocity(&self, ground: &DaaMotion, place: Option<Geodetic>) -> Result<DVec3, String> {
        let columns = &self.layout.velocity;
        if !self.layout.is_track {
            for (axis_mps, column) in ground.velocity_mps.to_array().into_iter().zip(columns) {
                limit(axis_mps, LARGEST_SPEED_MPS, column, "m/s")?;
            }
            return Ok(self.in_frame(ground.velocity_mps, place));
        }
        let compass_deg = ground.track_rad / DEGREE_RAD;
        let (speed_mps, climb_mps) = (ground.speed_mps, ground.velocity_mps.z);
        limit(compass_deg, 720.0, &columns[0], "deg")?;
        limit(speed_mps, LARGEST_SPEED_MPS, &columns[1], "m/s")?;
        limit(climb_mps, LARGEST_SPEED_MPS, &columns[2], "m/s")?;
        if speed_mps < 0.0 {
            return Err(format!(
                "column {} is negative, expected a ground speed of 0 or more",
                columns[1].name
            ));
        }
        let own_axes_mps = velocity_from_compass(compass_deg, speed_mps, climb_mps);
        Ok(self.in_frame(own_axes_mps, place))
    }

    /// A velocity along east, north and up at a place, in the local frame.
    fn in_frame(&self, velocity_mps: DVec3, place: Option<Geodetic>) -> DVec3 {
        match (self.frame, place) {
            (Some(frame), Some(place)) => frame.velocity_mps(place, velocity_mps),
            _ => velocity_mps,
        }
    }
}

/// Refuses an implausible value (SI units, or degrees).
fn limit(value: f64, largest: f64, column: &DaaColumn, unit: &str) -> Result<(), String> {
    // Degrees pass through radians: rounding must not refuse the poles.
    if value.abs() <= largest * (1.0 + 1e-12) {
        return Ok(());
    }
    Err(format!(
        "column {} is {value} {unit}, expected at most {largest} {unit} either way",
        column.name
    ))
}
