//! Plays traffic: the paper's third script, with more to play.
//!
//! | script | content |
//! |---|---|
//! | straight lines | from a place, on a track, at a speed |
//! | recorded tracks | JSON rows of state vectors (as those of the OpenSky network) |
//! | `.daa` recording | every aircraft, where the recording has latitudes and longitudes |
//! | BaseStation log | lines with a nanosecond offset before them, at their recorded pace |
//!
//! Everything is played as `ADSB_VEHICLE` messages, as BaseStation lines, or both.

use alloc::collections::BTreeMap;
use core::fmt::Write as _;
use core::str::FromStr;
use std::io::{self, BufRead};

use fga::Vec3;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::traffic::sbs;
use mavlink::dialects::ardupilotmega::{
    ADSB_VEHICLE_DATA, AdsbAltitudeType, AdsbEmitterType, AdsbFlags, MavMessage,
};

use crate::number::{degrees_to_e7, to_i16, to_i32, to_u16};
use crate::traffic::Source;
use crate::traffic::receiver::Joiner;

const FEET_M: f64 = 0.3048;
const KNOT_MPS: f64 = 1852.0 / 3600.0;

/// An aircraft at a moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Time from the start of the script, seconds.
    pub time_s: f64,
    /// Its position.
    pub place: Geodetic,
    /// Velocity east, north, up, metres per second.
    pub velocity_mps: Vec3,
}

/// An aircraft and its path.
#[derive(Debug, Clone, PartialEq)]
pub struct Played {
    /// ICAO address.
    pub icao: u32,
    /// Call sign.
    pub callsign: String,
    /// Its path, in order of time; a single sample is a straight line without end.
    pub samples: Vec<Sample>,
}

/// Longest gap between two samples that is played through, seconds.
const LONGEST_GAP_S: f64 = 30.0;

impl Played {
    /// Its state at a time; `None` before, after, and in long gaps.
    pub fn at(&self, time_s: f64) -> Option<Sample> {
        let after = self
            .samples
            .partition_point(|sample| sample.time_s <= time_s);
        let from = self.samples.get(after.checked_sub(1)?)?;
        let ahead_s = time_s - from.time_s;
        let moved = |velocity_mps: Vec3| {
            let frame = LocalFrame::new(from.place, Earth::Wgs84);
            Sample {
                time_s,
                place: frame.to_geodetic(velocity_mps * ahead_s),
                velocity_mps,
            }
        };
        match self.samples.get(after) {
            Some(to) if to.time_s - from.time_s <= LONGEST_GAP_S => {
                let share = ahead_s / (to.time_s - from.time_s);
                let between = |a: f64, b: f64| a + (b - a) * share;
                Some(Sample {
                    time_s,
                    place: Geodetic {
                        latitude_deg: between(from.place.latitude_deg, to.place.latitude_deg),
                        longitude_deg: between(from.place.longitude_deg, to.place.longitude_deg),
                        altitude_m: between(from.place.altitude_m, to.place.altitude_m),
                    },
                    velocity_mps: from.velocity_mps.lerp(to.velocity_mps, share),
                })
            }
            Some(_) => None,
            None if self.samples.len() == 1 => Some(moved(from.velocity_mps)),
            None => (ahead_s <= 0.0).then(|| moved(from.velocity_mps)),
        }
    }

    /// Time of its last report, seconds; infinite for a straight line.
    pub fn end_s(&self) -> f64 {
        match self.samples.as_slice() {
            [] => 0.0,
            [_] => f64::INFINITY,
            [.., last] => last.time_s,
        }
    }
}

/// A straight line: `ICAO,LATITUDE,LONGITUDE,ALTITUDE_M,TRACK_DEG,SPEED_MPS[,CLIMB_MPS[,AT_S]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Line(pub Played);

/// A text that is no line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "'{0}' is no line, expected ICAO,LATITUDE,LONGITUDE,ALTITUDE_M,TRACK_DEG,SPEED_MPS[,CLIMB_MPS[,AT_S]]"
)]
pub struct LineError(String);

impl FromStr for Line {
    type Err = LineError;

    fn from_str(text: &str) -> Result<Self, LineError> {
        let error = || LineError(text.to_owned());
        let (icao, rest) = text.split_once(',').ok_or_else(error)?;
        let icao = u32::from_str_radix(icao.trim(), 16).map_err(|_| error())?;
        let numbers: Vec<f64> = rest
            .split(',')
            .map(|field| field.trim().parse().map_err(|_| error()))
            .collect::<Result<_, _>>()?;
        let number = |index: usize| numbers.get(index).copied();
        let (Some(latitude), Some(longitude), Some(altitude), Some(track), Some(speed)) =
            (number(0), number(1), number(2), number(3), number(4))
        else {
            return Err(error());
        };
        let place = Geodetic::new(latitude, longitude, altitude).ok_or_else(error)?;
        let climb = number(5).unwrap_or(0.0);
        let at_s = number(6).unwrap_or(0.0);
        let usable = icao <= 0x00FF_FFFF
            && numbers.len() <= 7
            && track.is_finite()
            && (0.0..2000.0).contains(&speed)
            && climb.abs() < 500.0
            && (0.0..1e6).contains(&at_s);
        if !usable {
            return Err(error());
        }
        let track_rad = track.to_radians();
        let velocity_mps = Vec3::new(
            speed * libm::sin(track_rad),
            speed * libm::cos(track_rad),
            climb,
        );
        let samples = vec![Sample {
            time_s: at_s,
            place,
            velocity_mps,
        }];
        Ok(Self(Played {
            icao,
            callsign: format!("FGA{icao:X}"),
            samples,
        }))
    }
}

/// Reads recorded tracks: a JSON array of state vectors with the keys `timestamp` (ms), `icao24`,
/// `latitude`, `longitude`, `altitude` and `geoaltitude` (ft), `groundspeed` (kt), `track` (deg),
/// `vertical_rate` (ft/min), `callsign`, `flight_id`. Every flight begins at time 0.
///
/// # Errors
/// A file that is not such an array.
pub fn read_tracks(text: &str) -> Result<Vec<Played>, String> {
    let rows: Vec<serde_json::Value> = serde_json::from_str(text).map_err(|e| e.to_string())?;
    let mut flights: BTreeMap<String, Played> = BTreeMap::new();
    for row in &rows {
        let number = |key: &str| row.get(key).and_then(serde_json::Value::as_f64);
        let words = |key: &str| {
            row.get(key)
                .and_then(serde_json::Value::as_str)
                .unwrap_or("")
        };
        let (Some(time_ms), Some(latitude), Some(longitude)) =
            (number("timestamp"), number("latitude"), number("longitude"))
        else {
            continue;
        };
        let Some(feet) = number("geoaltitude").or_else(|| number("altitude")) else {
            continue;
        };
        let Some(place) = Geodetic::new(latitude, longitude, feet * FEET_M) else {
            continue;
        };
        let Ok(icao) = u32::from_str_radix(words("icao24"), 16) else {
            continue;
        };
        let track_rad = number("track").unwrap_or(0.0).to_radians();
        let speed = number("groundspeed").unwrap_or(0.0) * KNOT_MPS;
        let climb = number("vertical_rate").unwrap_or(0.0) * FEET_M / 60.0;
        let velocity_mps = Vec3::new(
            speed * libm::sin(track_rad),
            speed * libm::cos(track_rad),
            climb,
        );
        let name = match words("flight_id") {
            "" => words("icao24"),
            name => name,
        };
        let played = flights.entry(name.to_owned()).or_insert_with(|| Played {
            icao: icao & 0x00FF_FFFF,
            callsign: crate::traffic::report::tidy_callsign(words("callsign")),
            samples: Vec::new(),
        });
        played.samples.push(Sample {
            time_s: time_ms * 1e-3,
            place,
            velocity_mps,
        });
    }
    let mut played: Vec<Played> = flights.into_values().collect();
    for flight in &mut played {
        flight.samples.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        flight.samples.dedup_by(|a, b| a.time_s == b.time_s);
        let begin_s = flight.samples.first().map_or(0.0, |sample| sample.time_s);
        for sample in &mut flight.samples {
            sample.time_s -= begin_s;
        }
    }
    if played.is_empty() {
        return Err("no state vectors with timestamp, icao24, latitude and longitude".to_owned());
    }
    Ok(played)
}

/// The aircraft of a `.daa` recording as traffic; those without latitudes are left out.
pub fn from_recording(recording: &fga_formats::daa::Recording) -> Vec<Played> {
    let mut number = 0x00FA_0000;
    recording
        .aircraft
        .iter()
        .filter_map(|track| {
            number += 1;
            let samples: Vec<Sample> = track
                .samples
                .iter()
                .filter_map(|sample| {
                    Some(Sample {
                        time_s: sample.time_s,
                        place: sample.place?,
                        velocity_mps: sample.velocity_mps,
                    })
                })
                .collect();
            let callsign = crate::traffic::report::tidy_callsign(&track.name);
            (!samples.is_empty()).then_some(Played {
                icao: number,
                callsign,
                samples,
            })
        })
        .collect()
}

/// A line of a BaseStation log and when it was received.
#[derive(Debug, Clone, PartialEq)]
pub struct LoggedLine {
    /// Time from the start of the log, seconds.
    pub time_s: f64,
    /// The line without its offset.
    pub line: String,
}

/// Reads a BaseStation log whose lines begin with an offset in nanoseconds; others are left out.
///
/// # Errors
/// A log that cannot be read, or without any such line.
pub fn read_sbs_log(log: impl BufRead) -> io::Result<Vec<LoggedLine>> {
    let mut lines = Vec::new();
    for line in log.lines() {
        let line = line?;
        let Some((offset, rest)) = line.split_once(',') else {
            continue;
        };
        if let Ok(nanoseconds) = offset.parse::<u64>()
            && rest.starts_with("MSG,")
        {
            lines.push(LoggedLine {
                time_s: nanoseconds as f64 * 1e-9,
                line: rest.trim_end().to_owned(),
            });
        }
    }
    if lines.is_empty() {
        return Err(io::Error::new(
            io::ErrorKind::InvalidData,
            "no line of the form NANOSECONDS,MSG,…",
        ));
    }
    Ok(lines)
}

/// The `ADSB_VEHICLE` message of an aircraft at a moment.
pub fn adsb_message(icao: u32, callsign: &str, sample: &Sample) -> MavMessage {
    let velocity = sample.velocity_mps;
    let heading_deg = libm::atan2(velocity.x, velocity.y)
        .to_degrees()
        .rem_euclid(360.0);
    MavMessage::ADSB_VEHICLE(ADSB_VEHICLE_DATA {
        ICAO_address: icao,
        lat: degrees_to_e7(sample.place.latitude_deg),
        lon: degrees_to_e7(sample.place.longitude_deg),
        altitude: to_i32(sample.place.altitude_m * 1e3),
        heading: to_u16(heading_deg * 100.0),
        hor_velocity: to_u16(libm::hypot(velocity.x, velocity.y) * 100.0),
        ver_velocity: to_i16(velocity.z * 100.0),
        flags: AdsbFlags::ADSB_FLAGS_VALID_COORDS
            | AdsbFlags::ADSB_FLAGS_VALID_ALTITUDE
            | AdsbFlags::ADSB_FLAGS_VALID_HEADING
            | AdsbFlags::ADSB_FLAGS_VALID_VELOCITY
            | AdsbFlags::ADSB_FLAGS_VERTICAL_VELOCITY_VALID
            | AdsbFlags::ADSB_FLAGS_VALID_CALLSIGN
            | AdsbFlags::ADSB_FLAGS_SIMULATED,
        squawk: 0o1200,
        altitude_type: AdsbAltitudeType::ADSB_ALTITUDE_TYPE_GEOMETRIC,
        callsign: callsign.chars().take(8).collect::<String>().as_str().into(),
        emitter_type: AdsbEmitterType::ADSB_EMITTER_TYPE_LIGHT,
        tslc: 0,
    })
}

/// The BaseStation lines of an aircraft at a moment: position and velocity.
pub fn sbs_lines(icao: u32, callsign: &str, sample: &Sample) -> String {
    let velocity = sample.velocity_mps;
    let track_deg = libm::atan2(velocity.x, velocity.y)
        .to_degrees()
        .rem_euclid(360.0);
    let speed_kn = libm::hypot(velocity.x, velocity.y) / KNOT_MPS;
    let climb_fpm = velocity.z / FEET_M * 60.0;
    let feet = sample.place.altitude_m / FEET_M;
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "MSG,1,1,1,{icao:06X},1,,,,,{callsign},,,,,,,,,,,0\r\n\
         MSG,3,1,1,{icao:06X},1,,,,,,{feet:.0},,,{:.7},{:.7},,,0,0,0,0\r\n\
         MSG,4,1,1,{icao:06X},1,,,,,,,{speed_kn:.2},{track_deg:.2},,,{climb_fpm:.0},,0,0,0,0\r\n",
        sample.place.latitude_deg, sample.place.longitude_deg,
    );
    text
}

/// Turns the lines of a BaseStation log into `ADSB_VEHICLE` messages.
#[derive(Debug)]
pub struct LineTranslator(Joiner);

impl Default for LineTranslator {
    fn default() -> Self {
        Self(Joiner::new(Source::Sbs))
    }
}

impl LineTranslator {
    /// The message of a line, where it held a position.
    pub fn message(&mut self, line: &str, now_s: f64) -> Option<MavMessage> {
        let report = self.0.take(&sbs::parse_line(line.as_bytes())?, now_s)?;
        let sample = Sample {
            time_s: now_s,
            place: report.place,
            velocity_mps: report.velocity_mps?,
        };
        Some(adsb_message(report.icao, &report.callsign, &sample))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_flies_straight() {
        let line: Line = "ABC123,37.0,-122.0,500,90,50,1,10".parse().unwrap();
        assert!(line.0.at(9.0).is_none());
        let sample = line.0.at(30.0).unwrap();
        // 1000 m east at 37°: 1000 / (111 320 · cos 37° · 1.0012…) ≈ 0.011 238°.
        assert!((sample.place.longitude_deg + 122.0 - 0.011_238).abs() < 1e-5);
        assert!((sample.place.altitude_m - 520.0).abs() < 1e-9);
        for wrong in [
            "",
            "XYZ,1,2,3,4,5",
            "ABC123,95,0,0,0,0",
            "ABC123,1,2,3,4",
            "A,1,2,3,4,nan",
            // Found by fuzzing: beyond the other side of the earth, where no frame holds.
            "ABC,35,1,-122012200904,0904,0,3",
        ] {
            assert!(wrong.parse::<Line>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn recorded_rows_become_flights() {
        let text = r#"[
            {"timestamp": 2000, "icao24": "a3c6bd", "latitude": 47.0, "longitude": -122.0,
             "altitude": 1000.0, "groundspeed": 100.0, "track": 0.0, "vertical_rate": 0.0,
             "callsign": "N1", "flight_id": "N1_1"},
            {"timestamp": 12000, "icao24": "a3c6bd", "latitude": 47.01, "longitude": -122.0,
             "altitude": 2000.0, "groundspeed": 100.0, "track": 0.0, "vertical_rate": 0.0,
             "callsign": "N1", "flight_id": "N1_1"}]"#;
        let flights = read_tracks(text).unwrap();
        assert_eq!(flights.len(), 1);
        let middle = flights[0].at(5.0).unwrap();
        assert!((middle.place.latitude_deg - 47.005).abs() < 1e-9);
        assert!((middle.place.altitude_m - 457.2).abs() < 1e-9);
        assert!(flights[0].at(11.0).is_none());
        assert!(read_tracks("[]").is_err());
    }

    #[test]
    fn sent_lines_are_read_back() {
        let line: Line = "ABC123,37.5,-122.25,500,45,50".parse().unwrap();
        let sample = line.0.at(0.0).unwrap();
        let text = sbs_lines(0x00AB_C123, "FGA1", &sample);
        let mut translator = LineTranslator::default();
        let mut messages = Vec::new();
        for _ in 0..2 {
            messages.extend(
                text.lines()
                    .filter_map(|line| translator.message(line, 0.0)),
            );
        }
        let Some(MavMessage::ADSB_VEHICLE(data)) = messages.first() else {
            panic!("no message")
        };
        assert_eq!(
            (data.ICAO_address, data.lat, data.lon),
            (0xAB_C123, 375_000_000, -1_222_500_000)
        );
        assert!((f64::from(data.heading) - 4500.0).abs() <= 2.0);
        assert!((f64::from(data.altitude) - 500_000.0).abs() < 200.0);
    }
}
