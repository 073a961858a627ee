//! The rows of a `.daa` file.

use super::columns::{DaaColumn, Layout, PositionColumns, VelocityColumns, fields};
use super::extras::Extras;
use super::{Track, TrackSample};
use crate::error::shown;
use crate::geodesy::{Earth, Geodetic, LocalFrame, course_from_compass_rad};
use crate::tally::{LeftOut, Tally};
use crate::units::DEGREE_RAD;
use glam::DVec3;
use std::collections::HashMap;

/// The largest plausible altitude and Cartesian coordinate, metres.
const LARGEST_ALTITUDE_M: f64 = 1e5;
const LARGEST_POSITION_M: f64 = 1e7;
/// The largest plausible speed, metres per second.
const LARGEST_SPEED_MPS: f64 = 5000.0;
/// The largest plausible time, seconds: some thousand years.
const LARGEST_TIME_S: f64 = 1e11;

/// The rows read so far.
pub(super) struct DaaRows<'a> {
    layout: &'a Layout,
    extras: &'a Extras,
    pub(super) aircraft: Vec<Track>,
    pub(super) frame: Option<LocalFrame>,
    index_of: HashMap<String, usize>,
    pub(super) last: Option<usize>,
    pub(super) tally: Tally,
}

impl<'a> DaaRows<'a> {
    pub(super) fn new(layout: &'a Layout, extras: &'a Extras) -> Self {
        Self {
            layout,
            extras,
            aircraft: Vec::new(),
            frame: None,
            index_of: HashMap::new(),
            last: None,
            tally: Tally::default(),
        }
    }

    /// Takes one row.
    pub(super) fn push(&mut self, line: &str) -> Result<(), String> {
        let layout = self.layout;
        let fields = fields(line, Some(layout.width));
        if fields.len() != layout.width {
            let (found, expected) = (fields.len(), layout.width);
            return Err(format!(
                "has {found} fields, expected {expected} as in the line of column names"
            ));
        }
        let time_s = layout.time.clock_s(&fields)?;
        limit(time_s, LARGEST_TIME_S, &layout.time, "s")?;
        let (position_m, place) = self.position(&fields)?;
        let velocity_mps = self.velocity(&fields, place)?;
        let turned = self.extras.air(&fields)?.map(|(compass_rad, speed_mps)| {
            let (east, north) = libm::sincos(compass_rad);
            DVec3::new(east, north, 0.0) * speed_mps
        });
        let exact = self.extras.air_mps(&fields)?;
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
        let deviation = self.extras.deviation(&fields)?;
        let index = self.aircraft_index(&fields)?;
        let Some(track) = self.aircraft.get_mut(index) else {
            return Ok(());
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
            deviation,
        });
        Ok(())
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
            if let Some(index) = self.index_of.get(name) {
                *index
            } else {
                self.aircraft.push(Track {
                    name: name.to_owned(),
                    samples: Vec::new(),
                });
                let index = self.aircraft.len() - 1;
                self.index_of.insert(name.to_owned(), index);
                index
            }
        };
        self.last = Some(index);
        Ok(index)
    }

    /// Position in the local frame, and the geodetic position if the file has latitudes; the first row
    /// sets the frame.
    fn position(&mut self, fields: &[&str]) -> Result<(DVec3, Option<Geodetic>), String> {
        match &self.layout.position {
            PositionColumns::Geodetic([latitude, longitude, altitude]) => {
                let latitude_deg = latitude.value(fields)? / DEGREE_RAD;
                let longitude_deg = longitude.value(fields)? / DEGREE_RAD;
                let altitude_m = altitude.value(fields)?;
                limit(latitude_deg, 90.0, latitude, "deg")?;
                limit(longitude_deg, 360.0, longitude, "deg")?;
                limit(altitude_m, LARGEST_ALTITUDE_M, altitude, "m")?;
                let place = Geodetic {
                    latitude_deg,
                    longitude_deg,
                    altitude_m,
                };
                let frame = *self
                    .frame
                    .get_or_insert_with(|| LocalFrame::new(place, Earth::Daidalus));
                Ok((frame.to_local_m(place), Some(place)))
            }
            PositionColumns::Cartesian(columns) => {
                let mut position_m = [0.0; 3];
                for (axis_m, column) in position_m.iter_mut().zip(columns) {
                    *axis_m = column.value(fields)?;
                    limit(*axis_m, LARGEST_POSITION_M, column, "m")?;
                }
                Ok((DVec3::from_array(position_m), None))
            }
        }
    }

    fn velocity(&self, fields: &[&str], place: Option<Geodetic>) -> Result<DVec3, String> {
        let own_axes_mps = match &self.layout.velocity {
            VelocityColumns::Track([track, ground_speed, vertical_speed]) => {
                let compass_deg = track.value(fields)? / DEGREE_RAD;
                let speed_mps = ground_speed.value(fields)?;
                let climb_mps = vertical_speed.value(fields)?;
                limit(compass_deg, 720.0, track, "deg")?;
                limit(speed_mps, LARGEST_SPEED_MPS, ground_speed, "m/s")?;
                limit(climb_mps, LARGEST_SPEED_MPS, vertical_speed, "m/s")?;
                if speed_mps < 0.0 {
                    return Err(format!(
                        "column {} is negative, expected a ground speed of 0 or more",
                        ground_speed.name()
                    ));
                }
                let (sin, cos) = libm::sincos(course_from_compass_rad(compass_deg));
                DVec3::new(speed_mps * cos, speed_mps * sin, climb_mps)
            }
            VelocityColumns::Cartesian(columns) => {
                let mut velocity_mps = [0.0; 3];
                for (axis_mps, column) in velocity_mps.iter_mut().zip(columns) {
                    *axis_mps = column.value(fields)?;
                    limit(*axis_mps, LARGEST_SPEED_MPS, column, "m/s")?;
                }
                DVec3::from_array(velocity_mps)
            }
        };
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
        column.name()
    ))
}
