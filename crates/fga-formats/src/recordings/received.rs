//! Tracks of many aircraft from the log of a receiver.

use crate::error::{InputError, shown};
use crate::geodesy::{Geodetic, course_from_compass_rad};
use crate::traffic::{TrafficReport, sbs};
use crate::units::{Feet, FeetPerMinute, Knots};
use alloc::collections::BTreeMap;
use glam::DVec3;
use serde_json::{Map, Value};
use std::path::Path;

/// One aircraft, times strictly increasing.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ReceivedTrack {
    pub(super) name: String,
    pub(super) heard: Vec<Heard>,
}

/// One report with a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Heard {
    pub(super) time_s: f64,
    pub(super) place: Geodetic,
    /// East, north, up at that place, metres per second; `None` if not received.
    pub(super) velocity_mps: Option<DVec3>,
}

/// Sorts reports by time; of several at one time the first stays.
fn tracks_of(reports: BTreeMap<String, Vec<Heard>>) -> Vec<ReceivedTrack> {
    reports
        .into_iter()
        .map(|(name, mut heard)| {
            heard.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
            heard.dedup_by(|later, earlier| later.time_s <= earlier.time_s);
            ReceivedTrack { name, heard }
        })
        .collect()
}

/// Whether a line is a message of a BaseStation log.
pub(super) fn is_message(line: &str) -> bool {
    line.starts_with("MSG,")
        || line
            .split_once(',')
            .is_some_and(|(time, rest)| time.parse::<u64>().is_ok() && rest.starts_with("MSG,"))
}

/// The tracks of a BaseStation log. Times are a recorder's nanoseconds where each line has them,
/// else the message's own date and time. Skips aircraft on the ground and damaged lines.
pub(super) fn from_sbs(text: &str) -> Vec<ReceivedTrack> {
    let mut reports: BTreeMap<String, Vec<Heard>> = BTreeMap::new();
    let mut latest: BTreeMap<u32, TrafficReport> = BTreeMap::new();
    for line in text.lines() {
        let Some(time_s) = time_of(line) else {
            continue;
        };
        let Some(report) = sbs::parse_line(line.as_bytes()) else {
            continue;
        };
        let known = latest.entry(report.address).or_default();
        known.altitude = report.altitude.or(known.altitude);
        known.ground_speed_mps = report.ground_speed_mps.or(known.ground_speed_mps);
        known.course_rad = report.course_rad.or(known.course_rad);
        known.climb_mps = report.climb_mps.or(known.climb_mps);
        let (Some([latitude_deg, longitude_deg]), Some(altitude)) =
            (report.place_deg, known.altitude)
        else {
            continue;
        };
        if report.on_ground == Some(true) {
            continue;
        }
        let Some(place) = Geodetic::new(latitude_deg, longitude_deg, altitude.metres()) else {
            continue;
        };
        let velocity_mps = known
            .ground_velocity_mps()
            .map(|[east, north]| DVec3::new(east, north, known.climb_mps.unwrap_or(0.0)));
        let name = format!("{:06X}", report.address);
        reports.entry(name).or_default().push(Heard {
            time_s,
            place,
            velocity_mps,
        });
    }
    tracks_of(reports)
}

/// The time of a line, seconds.
fn time_of(line: &str) -> Option<f64> {
    let (first, rest) = line.split_once(',')?;
    if let Ok(nanoseconds) = first.parse::<u64>() {
        return rest.starts_with("MSG,").then_some(nanoseconds as f64 / 1e9);
    }
    let mut fields = line.split(',');
    let (date, time) = (fields.nth(6)?, fields.next()?);
    let mut parts = date.split('/').map(str::parse::<f64>);
    let (Some(Ok(year)), Some(Ok(month)), Some(Ok(day))) =
        (parts.next(), parts.next(), parts.next())
    else {
        return None;
    };
    let clock: Option<Vec<f64>> = time.split(':').map(|part| part.parse().ok()).collect();
    let [hours, minutes, seconds] = *<&[f64; 3]>::try_from(clock?.as_slice()).ok()?;
    // Days from a fixed day: no month needs more than 31.
    let day = (year * 12.0 + month) * 31.0 + day;
    Some(day * 86_400.0 + hours * 3600.0 + minutes * 60.0 + seconds)
}

/// The tracks of state vectors in JSON: a list of objects, or an object of columns.
pub(super) fn from_json(text: &str, path: &Path) -> Result<Vec<ReceivedTrack>, InputError> {
    let wrong = |message: String| InputError::in_file(path, message);
    let document: Value = serde_json::from_str(text)
        .map_err(|error| wrong(format!("is no JSON that can be read: {error}")))?;
    let rows = match document {
        Value::Array(rows) => rows,
        Value::Object(columns) => rows_of(&columns)
            .ok_or_else(|| wrong("is a JSON object of something else than columns, expected a list of state vectors or columns of them".into()))?,
        _ => return Err(wrong("is no list, expected a list of state vectors".into())),
    };
    let mut reports: BTreeMap<String, Vec<Heard>> = BTreeMap::new();
    for (index, row) in rows.iter().enumerate() {
        let name = ["flight_id", "icao24", "callsign"]
            .iter()
            .find_map(|key| row.get(key)?.as_str())
            .ok_or_else(|| {
                wrong(format!(
                    "state vector {index} has no icao24, callsign or flight_id, expected one"
                ))
            })?;
        let time_s = time_of_row(row).ok_or_else(|| {
            wrong(format!(
                "state vector {index} has the timestamp {}, expected milliseconds or seconds since 1970",
                row.get("timestamp").map_or_else(|| "none".into(), |v| shown(&v.to_string()))
            ))
        })?;
        let number = |key: &str| {
            row.get(key)
                .and_then(Value::as_f64)
                .filter(|v| v.is_finite())
        };
        let altitude = number("altitude").or_else(|| number("geoaltitude"));
        // Receivers omit fields that they did not hear.
        let (Some(latitude), Some(longitude), Some(feet)) =
            (number("latitude"), number("longitude"), altitude)
        else {
            continue;
        };
        let place = Geodetic::new(latitude, longitude, Feet(feet).to_m()).ok_or_else(|| {
            wrong(format!(
                "state vector {index} is at {latitude}, {longitude}, {feet} ft, expected a place on the earth"
            ))
        })?;
        let velocity_mps = number("groundspeed")
            .zip(number("track"))
            .map(|(knots, track)| {
                let (sin, cos) = libm::sincos(course_from_compass_rad(track));
                let speed_mps = Knots(knots).to_mps();
                let climb_fpm = number("vertical_rate").unwrap_or(0.0);
                DVec3::new(
                    speed_mps * cos,
                    speed_mps * sin,
                    FeetPerMinute(climb_fpm).to_mps(),
                )
            });
        reports.entry(name.to_owned()).or_default().push(Heard {
            time_s,
            place,
            velocity_mps,
        });
    }
    Ok(tracks_of(reports))
}

/// The time of a state vector, seconds: epoch milliseconds, or seconds where they are small.
fn time_of_row(row: &Value) -> Option<f64> {
    let value = row.get("timestamp")?.as_f64().filter(|v| v.is_finite())?;
    Some(if value.abs() > 1e11 {
        value / 1e3
    } else {
        value
    })
}

/// Rows of columns, each a list or an object by row number.
fn rows_of(columns: &Map<String, Value>) -> Option<Vec<Value>> {
    let mut rows: BTreeMap<usize, Map<String, Value>> = BTreeMap::new();
    for (name, column) in columns {
        let mut put = |index: usize, value: &Value| {
            rows.entry(index)
                .or_default()
                .insert(name.clone(), value.clone());
        };
        match column {
            Value::Array(values) => values.iter().enumerate().for_each(|(i, v)| put(i, v)),
            Value::Object(values) => {
                for (index, value) in values {
                    put(index.parse().ok()?, value);
                }
            }
            _ => return None,
        }
    }
    Some(rows.into_values().map(Value::Object).collect())
}
