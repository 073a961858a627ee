//! Plays traffic: the paper's third script, with more to play.
//!
//! | script | content |
//! |---|---|
//! | straight lines | from a place, on a track, at a speed |
//! | state vectors | JSON, as [`fga_formats::recordings`] reads it |
//! | `.daa` recording | every aircraft, where the recording has latitudes and longitudes |
//! | BaseStation log | lines at their recorded pace |
//!
//! Everything is played as `ADSB_VEHICLE` messages, as BaseStation lines, or both.

use core::str::FromStr;
use std::io::Read;

use fga::Vec3;
use fga::angle::course_of;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::recordings::{Heard, Received};
use fga_formats::tally::Tally;
pub use fga_formats::traffic::sbs::LoggedLine;
use fga_formats::traffic::{Altitude, Callsign, TrafficReport, sbs};
use mavlink::dialects::ardupilotmega::{
    ADSB_VEHICLE_DATA, AdsbAltitudeType, AdsbEmitterType, AdsbFlags, MavMessage,
};

use crate::number::{degrees_to_e7, to_i16, to_i32, to_u16, velocity_mps};
use crate::traffic::receiver::Joiner;
use crate::traffic::report::tidy_callsign;
use crate::traffic::{AltitudeReference, ReportSource};

/// An aircraft at a moment.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayedState {
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
    /// Whether its altitudes are by pressure; else satellites measured them.
    pub is_by_pressure: bool,
    /// Its path, in order of time; a single sample is a straight line without end.
    pub samples: Vec<PlayedState>,
}

/// Longest gap between two samples that is played through, seconds.
const LONGEST_GAP_S: f64 = 30.0;

impl Played {
    /// Its `ADSB_VEHICLE` message at a time; `None` as for [`Played::at`].
    pub fn message_at(&self, time_s: f64) -> Option<MavMessage> {
        let data = adsb_data(self.icao, &self.callsign, &self.at(time_s)?);
        Some(with_datum(data, self.is_by_pressure))
    }

    /// Its state at a time; `None` before, after, and in long gaps.
    pub fn at(&self, time_s: f64) -> Option<PlayedState> {
        let after = self
            .samples
            .partition_point(|sample| sample.time_s <= time_s);
        let from = self.samples.get(after.checked_sub(1)?)?;
        let ahead_s = time_s - from.time_s;
        let moved = |velocity_mps: Vec3| {
            let frame = LocalFrame::new(from.place, Earth::Wgs84);
            PlayedState {
                time_s,
                place: frame.to_geodetic(velocity_mps * ahead_s),
                velocity_mps,
            }
        };
        match self.samples.get(after) {
            Some(to) if to.time_s - from.time_s <= LONGEST_GAP_S => {
                let share = ahead_s / (to.time_s - from.time_s);
                let between = |a: f64, b: f64| a + (b - a) * share;
                Some(PlayedState {
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
pub struct PlayerLine(pub Played);

/// A text that is no line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "'{0}' is no line, expected ICAO,LATITUDE,LONGITUDE,ALTITUDE_M,TRACK_DEG,SPEED_MPS[,CLIMB_MPS[,AT_S]]"
)]
pub struct LineError(String);

impl FromStr for PlayerLine {
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
        let velocity_mps = velocity_mps(speed, track.to_radians(), climb);
        let samples = vec![PlayedState {
            time_s: at_s,
            place,
            velocity_mps,
        }];
        Ok(Self(Played {
            icao,
            callsign: format!("FGA{icao:X}"),
            is_by_pressure: false,
            samples,
        }))
    }
}

/// The aircraft of state vectors as traffic. Flights that overlap in time keep their times; those before and after
/// them begin with the script, too.
pub fn from_states(received: &Received) -> Vec<Played> {
    let mut number = 0x00FB_0000;
    let mut played: Vec<Played> = received
        .tracks
        .iter()
        .filter(|track| !track.heard.is_empty())
        .map(|track| {
            number += 1;
            let sample = |heard: &Heard| PlayedState {
                time_s: heard.time_s,
                place: heard.place,
                velocity_mps: heard.velocity_mps.unwrap_or_default(),
            };
            Played {
                icao: track.address.unwrap_or(number),
                callsign: tidy_callsign(&track.callsign),
                is_by_pressure: track.is_by_pressure,
                samples: track.heard.iter().map(sample).collect(),
            }
        })
        .collect();
    let begin_s = |flight: &Played| flight.samples.first().map_or(0.0, |first| first.time_s);
    played.sort_by(|a, b| begin_s(a).total_cmp(&begin_s(b)));
    let (mut origin_s, mut until_s) = (0.0, f64::NEG_INFINITY);
    for flight in &mut played {
        if begin_s(flight) > until_s + LONGEST_GAP_S {
            origin_s = begin_s(flight);
        }
        let last_s = flight.samples.last().map_or(0.0, |last| last.time_s);
        until_s = last_s.max(until_s);
        for sample in &mut flight.samples {
            sample.time_s -= origin_s;
        }
    }
    played
}

/// The aircraft of a `.daa` recording as traffic; those without latitudes are left out.
pub fn from_recording(recording: &fga_formats::daa::Recording) -> Vec<Played> {
    let mut number = 0x00FA_0000;
    recording
        .aircraft
        .iter()
        .filter_map(|track| {
            number += 1;
            let samples: Vec<PlayedState> = track
                .samples
                .iter()
                .filter_map(|sample| {
                    Some(PlayedState {
                        time_s: sample.time_s,
                        place: sample.place?,
                        velocity_mps: sample.velocity_mps,
                    })
                })
                .collect();
            let callsign = tidy_callsign(&track.name);
            (!samples.is_empty()).then_some(Played {
                icao: number,
                callsign,
                is_by_pressure: false,
                samples,
            })
        })
        .collect()
}

/// Reads a BaseStation log: every line with a time, and what became of all of them.
pub fn read_log(log: impl Read) -> (Vec<LoggedLine>, Tally) {
    let mut log = sbs::Log::new(log);
    let lines = (&mut log).collect();
    (lines, log.tally())
}

/// The `ADSB_VEHICLE` message of an aircraft at a moment.
pub fn adsb_message(icao: u32, callsign: &str, sample: &PlayedState) -> MavMessage {
    MavMessage::ADSB_VEHICLE(adsb_data(icao, callsign, sample))
}

/// Its content; the altitude counts as geometric.
pub(crate) fn adsb_data(icao: u32, callsign: &str, sample: &PlayedState) -> ADSB_VEHICLE_DATA {
    let velocity = sample.velocity_mps;
    let heading_deg = libm::atan2(velocity.x, velocity.y)
        .to_degrees()
        .rem_euclid(360.0);
    ADSB_VEHICLE_DATA {
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
    }
}

/// The message with the datum of its altitude.
fn with_datum(mut data: ADSB_VEHICLE_DATA, is_by_pressure: bool) -> MavMessage {
    if is_by_pressure {
        data.altitude_type = AdsbAltitudeType::ADSB_ALTITUDE_TYPE_PRESSURE_QNH;
    }
    MavMessage::ADSB_VEHICLE(data)
}

/// The BaseStation lines of an aircraft at a moment: position and velocity.
pub fn sbs_lines(icao: u32, callsign: &str, sample: &PlayedState) -> String {
    let mut lines = Vec::new();
    let report = TrafficReport {
        address: icao,
        callsign: Callsign::new(callsign),
        place_deg: Some([sample.place.latitude_deg, sample.place.longitude_deg]),
        altitude: Some(Altitude::Pressure(sample.place.altitude_m)),
        ground_speed_mps: Some(sample.velocity_mps.truncate().length()),
        course_rad: Some(course_of(sample.velocity_mps)),
        climb_mps: Some(sample.velocity_mps.z),
        on_ground: Some(false),
        ..TrafficReport::default()
    };
    sbs::push_lines(&mut lines, &report);
    String::from_utf8_lossy(&lines).into_owned()
}

/// Turns the lines of a BaseStation log into `ADSB_VEHICLE` messages.
#[derive(Debug)]
pub struct LineTranslator(Joiner);

impl Default for LineTranslator {
    fn default() -> Self {
        Self(Joiner::new(ReportSource::Sbs))
    }
}

impl LineTranslator {
    /// The message of a line, where it and those before it give a position and a velocity.
    pub fn message(&mut self, line: &LoggedLine) -> Option<MavMessage> {
        let message = line.report.as_ref().ok()?;
        let report = self.0.take(message, line.time_s)?;
        let sample = PlayedState {
            time_s: line.time_s,
            place: report.place,
            velocity_mps: report.velocity_mps?,
        };
        let is_by_pressure = report.quality.altitude == AltitudeReference::Pressure;
        let data = adsb_data(report.icao, &report.callsign, &sample);
        Some(with_datum(data, is_by_pressure))
    }
}

#[cfg(test)]
mod tests {
    use fga_formats::recordings::{self, Content};
    use fga_formats::traffic::NON_ICAO;

    use super::*;

    #[test]
    fn a_line_flies_straight() {
        let line: PlayerLine = "ABC123,37.0,-122.0,500,90,50,1,10".parse().unwrap();
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
            assert!(wrong.parse::<PlayerLine>().is_err(), "{wrong}");
        }
    }

    fn received(text: &str) -> Received {
        let path = std::path::Path::new("a.json");
        let Content::States(received) = recordings::parse_content(text.as_bytes(), path).unwrap()
        else {
            panic!("state vectors")
        };
        received
    }

    #[test]
    fn t6_state_vectors_become_flights_at_their_times() {
        let row = |after_ms: u64, icao: &str, latitude: f64, feet: f64| {
            format!(
                r#"{{"timestamp": {}, "icao24": "{icao}", "latitude": {latitude}, "longitude": -122.0,
                "altitude": {feet}, "groundspeed": 100.0, "track": 0.0, "vertical_rate": 0.0, "callsign": "N1"}}"#,
                1_700_000_000_000 + after_ms
            )
        };
        let text = [
            row(2000, "a3c6bd", 47.0, 1000.0),
            row(12_000, "a3c6bd", 47.01, 2000.0),
            row(5000, "~00beef", 47.02, 1000.0),
            row(10_000, "~00beef", 47.03, 1000.0),
            // Hours later, alone: it does not wait for them.
            row(90_000_000, "c0ffee", 47.0, 1000.0),
        ];
        let flights = from_states(&received(&format!("[{}]", text.join(","))));
        let begins: Vec<(u32, f64)> = flights
            .iter()
            .map(|flight| (flight.icao, flight.samples[0].time_s))
            .collect();
        assert_eq!(
            begins,
            [(0xA3_C6BD, 0.0), (0xBEEF | NON_ICAO, 3.0), (0xC0_FFEE, 0.0)]
        );
        let middle = flights[0].at(5.0).unwrap();
        assert!((middle.place.latitude_deg - 47.005).abs() < 1e-9);
        assert!((middle.place.altitude_m - 457.2).abs() < 1e-9);
        assert!(flights[0].at(11.0).is_none());
        let Some(MavMessage::ADSB_VEHICLE(data)) = flights[0].message_at(5.0) else {
            panic!("no message")
        };
        // The altitude of the file is by pressure, and the message says so.
        assert_eq!(
            data.altitude_type,
            AdsbAltitudeType::ADSB_ALTITUDE_TYPE_PRESSURE_QNH
        );
    }

    #[test]
    fn sent_lines_are_read_back() {
        let line: PlayerLine = "ABC123,37.5,-122.25,500,45,50".parse().unwrap();
        let sample = line.0.at(0.0).unwrap();
        let text = sbs_lines(0x00AB_C123, "FGA1", &sample);
        let mut translator = LineTranslator::default();
        let mut messages = Vec::new();
        for _ in 0..2 {
            messages.extend(text.lines().filter_map(|line| {
                translator.message(&LoggedLine {
                    time_s: 0.0,
                    line: line.to_owned(),
                    report: sbs::parse_line(line.as_bytes()),
                })
            }));
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
