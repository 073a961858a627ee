//! A finished flight for other programs.
//!
//! The simulator and the companion fill a [`Flight`]; the writers of `export` turn it
//! into files. A JSON file keeps it between two commands.

use crate::error::{InputError, OutputError, read_text, shown};
use crate::geodesy::{Earth, Geodetic, LocalFrame};
use crate::{atomic, units};
use alloc::borrow::Cow;
use fga::Vec3;
use fga::situation::ProtectedVolume;
use glam::{DMat3, DQuat};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A finished flight in the local frame.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Flight {
    /// The name of the flight.
    pub name: String,
    /// The policy that flew it.
    pub policy: String,
    /// The origin of the local frame; without it exports to the globe use 0° N 0° E.
    pub origin: Option<Geodetic>,
    /// The figure of the earth below the local frame.
    pub earth: Earth,
    /// Time 0 as seconds since 1970-01-01 00:00 UTC; without it exports use 2000-01-01 12:00 UTC.
    pub start_unix_s: Option<f64>,
    /// The flown samples, times strictly increasing.
    pub samples: Vec<FlightSample>,
    /// The mission's waypoints, metres.
    pub mission: Vec<Vec3>,
    /// The obstacles.
    pub obstacles: Vec<FlightObstacle>,
    /// The zones that bound it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub zones: Vec<FlightZone>,
    /// Events and decisions, in time order.
    pub events: Vec<FlightEvent>,
    /// What other aircraft may do, of a flight on beliefs, in time order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub futures: Vec<FlightFutures>,
}

/// The aircraft at one time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlightSample {
    /// Time, seconds.
    pub time_s: f64,
    /// Position, metres, local frame.
    pub position_m: Vec3,
    /// Course ψ, radians from +x towards +y.
    pub course_rad: f64,
    /// Climb angle θ, radians, positive upwards.
    pub climb_rad: f64,
    /// Bank angle φ, radians, positive in a left turn.
    pub bank_rad: f64,
    /// State of the avoidance, such as `cruise` or `avoiding`.
    pub state: Cow<'static, str>,
    /// Height of the ground below, metres in the local frame; `None` where it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ground_m: Option<f64>,
}

/// An obstacle with its protected volume and its track.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlightObstacle {
    /// Its name.
    pub name: String,
    /// The protected volume.
    #[serde(with = "volume")]
    pub volume: ProtectedVolume,
    /// Its positions, times strictly increasing; a single row is an obstacle at rest there
    /// all the time.
    pub track: Vec<ObstacleSample>,
}

/// An obstacle at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ObstacleSample {
    /// Time, seconds.
    pub time_s: f64,
    /// Position, metres, local frame.
    pub position_m: Vec3,
}

/// A zone: what is above an outline between two altitudes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlightZone {
    /// Its name.
    pub name: String,
    /// Whether the aircraft keeps within it, not out of it.
    pub keep_in: bool,
    /// Its outline, metres east and north; the last place is the first one again.
    pub ring_m: Vec<[f64; 2]>,
    /// Its lowest altitude, metres in the local frame.
    #[serde(default)]
    pub floor_m: Option<f64>,
    /// Its highest altitude, metres in the local frame.
    #[serde(default)]
    pub ceiling_m: Option<f64>,
}

/// An event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlightEvent {
    /// Time, seconds.
    pub time_s: f64,
    /// The kind of event, one word.
    pub kind: String,
    /// The event in plain words.
    pub text: String,
    /// The whole record.
    #[serde(default)]
    pub detail: serde_json::Value,
}

/// What an aircraft may do from a moment on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlightFutures {
    /// Time, seconds.
    pub time_s: f64,
    /// The obstacle's name.
    pub obstacle: String,
    /// Its futures; their weights add up to one.
    pub ways: Vec<FlightWay>,
}

/// A future of an aircraft.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlightWay {
    /// Its weight.
    pub weight: f32,
    /// Its positions at that time and each 5 s up to a minute later, whole metres, local frame.
    pub points_m: Vec<[i32; 3]>,
}

impl Flight {
    /// The local frame on the globe.
    pub fn frame(&self) -> LocalFrame {
        LocalFrame::new(self.origin.unwrap_or_default(), self.earth)
    }

    /// A time of the flight as seconds since 1970-01-01 00:00 UTC.
    pub fn unix_s(&self, time_s: f64) -> f64 {
        self.start_unix_s.unwrap_or(946_728_000.0) + time_s
    }

    /// First and last time, seconds; zero without samples.
    pub fn span_s(&self) -> (f64, f64) {
        let time = |sample: Option<&FlightSample>| sample.map_or(0.0, |sample| sample.time_s);
        (time(self.samples.first()), time(self.samples.last()))
    }

    /// The aircraft's position at a time, linear between samples, constant before the first and
    /// after the last; `None` without samples.
    pub fn position_at(&self, time_s: f64) -> Option<Vec3> {
        let (from_s, to_s) = self.span_s();
        let row = |sample: &FlightSample| (sample.time_s, sample.position_m);
        between(&self.samples, row, time_s.max(from_s).min(to_s))
    }

    /// The events with the aircraft's positions at their times.
    pub fn placed_events(&self) -> impl Iterator<Item = (&FlightEvent, Vec3)> {
        let events = self.events.iter();
        events.filter_map(|event| Some((event, self.position_at(event.time_s)?)))
    }

    /// Samples at least `step_s` apart, plus the first, the last and every change of
    /// state.
    pub fn thinned(&self, step_s: f64) -> Vec<&FlightSample> {
        let mut kept: Vec<&FlightSample> = Vec::new();
        let count = self.samples.len();
        for (index, sample) in self.samples.iter().enumerate() {
            let keep = kept.last().is_none_or(|last| {
                sample.time_s - last.time_s >= step_s * (1.0 - 1e-9)
                    || sample.state != last.state
                    || index + 1 == count
            });
            if keep {
                kept.push(sample);
            }
        }
        kept
    }

    /// Reads a flight from its JSON file.
    ///
    /// # Errors
    /// An unreadable file, a file that is not a flight, or numbers that make no flight.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let wrong = |error| InputError::json(path, "recorded flight", &error);
        let flight: Self = serde_json::from_str(&read_text(path)?).map_err(wrong)?;
        flight
            .check()
            .map_err(|message| InputError::in_file(path, message))?;
        Ok(flight)
    }

    /// Writes the flight as a JSON file, completely or not at all.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        atomic::write_with(path, |file| {
            serde_json::to_writer(file, self).map_err(std::io::Error::from)
        })
    }

    /// Checks that the numbers make a flight: at least one sample, everything finite, times increasing.
    ///
    /// # Errors
    /// The fault, as the end of a sentence about the flight.
    pub fn check(&self) -> Result<(), String> {
        if self.samples.is_empty() {
            return Err("holds no samples, expected at least one".into());
        }
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        for sample in &self.samples {
            let angles = [sample.course_rad, sample.climb_rad, sample.bank_rad];
            let is_finite = finite(&angles) && finite(sample.ground_m.as_slice());
            if !sample.position_m.is_finite() || !is_finite {
                let at = sample.time_s;
                return Err(format!(
                    "the sample at {at} s is not finite, expected numbers"
                ));
            }
        }
        grows("flight", self.samples.iter().map(|sample| sample.time_s))?;
        for obstacle in &self.obstacles {
            let name = shown(&obstacle.name);
            let volume = obstacle.volume;
            let lengths = [volume.radius_m(), volume.half_height_m()];
            let positions_ok = obstacle.track.iter().all(|row| row.position_m.is_finite());
            if !finite(&lengths) || lengths.iter().any(|length| *length < 0.0) || !positions_ok {
                return Err(format!("obstacle {name} is not finite, expected numbers"));
            }
            if obstacle.track.is_empty() {
                return Err(format!("obstacle {name} has no position, expected one"));
            }
            grows(&name, obstacle.track.iter().map(|row| row.time_s))?;
        }
        for zone in &self.zones {
            let heights = [zone.floor_m, zone.ceiling_m].into_iter().flatten();
            let is_closed = zone.ring_m.len() > 3 && zone.ring_m.first() == zone.ring_m.last();
            if !is_closed
                || !finite(zone.ring_m.as_flattened())
                || !heights.clone().all(f64::is_finite)
            {
                let name = shown(&zone.name);
                return Err(format!(
                    "the outline of zone {name} is not a closed ring of finite places"
                ));
            }
        }
        let place_ok = self.origin.is_none_or(|place| {
            Geodetic::new(place.latitude_deg, place.longitude_deg, place.altitude_m).is_some()
        });
        if !place_ok || !self.mission.iter().all(|waypoint| waypoint.is_finite()) {
            return Err("the origin or a waypoint is out of range".into());
        }
        let times_ok = self.events.iter().all(|event| event.time_s.is_finite())
            && finite(self.start_unix_s.as_slice());
        if !times_ok {
            return Err("the time of an event or the start is not finite".into());
        }
        Ok(())
    }
}

/// Refuses times that are not finite or do not increase.
fn grows(what: &str, times_s: impl Iterator<Item = f64>) -> Result<(), String> {
    let mut last_s = f64::NEG_INFINITY;
    for time_s in times_s {
        if !time_s.is_finite() || time_s <= last_s {
            return Err(format!(
                "the time of {what} goes from {last_s} s to {time_s} s, expected it to grow"
            ));
        }
        last_s = time_s;
    }
    Ok(())
}

/// The position at a time, linear between rows; `None` before the first and after the last.
fn between<T>(rows: &[T], of: impl Fn(&T) -> (f64, Vec3), time_s: f64) -> Option<Vec3> {
    let after = rows.partition_point(|row| of(row).0 <= time_s);
    let (before_s, before_m) = of(rows.get(after.checked_sub(1)?)?);
    let Some((next_s, next_m)) = rows.get(after).map(of) else {
        return (before_s == time_s).then_some(before_m);
    };
    Some(before_m.lerp(next_m, (time_s - before_s) / (next_s - before_s)))
}

impl FlightZone {
    /// What it is for, as in scenarios: `keep-in` or `keep-out`.
    pub const fn kind(&self) -> &'static str {
        if self.keep_in { "keep-in" } else { "keep-out" }
    }
}

impl FlightObstacle {
    /// Whether the obstacle stays in one place all the time.
    pub const fn is_static(&self) -> bool {
        self.track.len() <= 1
    }

    /// The obstacle's position at a time, linear between rows; `None` while it is absent:
    /// before the first and after the last row of a moving one.
    pub fn position_at(&self, time_s: f64) -> Option<Vec3> {
        match self.track[..] {
            [only] => Some(only.position_m),
            _ => between(&self.track, |row| (row.time_s, row.position_m), time_s),
        }
    }
}

impl FlightSample {
    /// Height above the ground, metres; `None` where the ground is not known.
    pub fn above_ground_m(&self) -> Option<f64> {
        Some(self.position_m.z - self.ground_m?)
    }

    /// The aircraft's axes in the local frame: forward, left wing, up through the canopy.
    pub fn axes(&self) -> [Vec3; 3] {
        let (sin_course, cos_course) = libm::sincos(self.course_rad);
        let (sin_climb, cos_climb) = libm::sincos(self.climb_rad);
        let (sin_bank, cos_bank) = libm::sincos(self.bank_rad);
        let forward = Vec3::new(cos_climb * cos_course, cos_climb * sin_course, sin_climb);
        let left = Vec3::new(-sin_course, cos_course, 0.0);
        let up = forward.cross(left);
        // In a left turn (positive bank) the left wing points down and the lift to the left.
        [
            forward,
            left * cos_bank - up * sin_bank,
            up * cos_bank + left * sin_bank,
        ]
    }

    /// The attitude as x, y, z, w, in axes into which `turned` turns those of the local frame: the model's x forward, y left, z up.
    pub fn attitude(&self, turned: impl Fn(Vec3) -> Vec3) -> [f64; 4] {
        let [forward, left, up] = self.axes().map(turned);
        DQuat::from_mat3(&DMat3::from_cols(forward, left, up))
            .normalize()
            .to_array()
    }

    /// Compass course, degrees within [0, 360).
    pub fn compass_deg(&self) -> f64 {
        crate::geodesy::compass_from_course_deg(self.course_rad)
    }

    /// Bank as flight instruments show it: degrees, positive with the right wing down.
    pub fn roll_deg(&self) -> f64 {
        -self.bank_rad / units::DEGREE_RAD
    }

    /// Climb angle, degrees.
    pub fn climb_deg(&self) -> f64 {
        self.climb_rad / units::DEGREE_RAD
    }
}

/// A protected volume as `{"radius_m": …}` or `{"radius_m": …, "half_height_m": …}`.
mod volume {
    use fga::situation::ProtectedVolume;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    struct Lengths {
        radius_m: f64,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        half_height_m: Option<f64>,
    }

    pub(super) fn serialize<S: Serializer>(
        volume: &ProtectedVolume,
        out: S,
    ) -> Result<S::Ok, S::Error> {
        let is_sphere = matches!(volume, ProtectedVolume::Sphere { .. });
        let lengths = Lengths {
            radius_m: volume.radius_m(),
            half_height_m: (!is_sphere).then(|| volume.half_height_m()),
        };
        lengths.serialize(out)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        input: D,
    ) -> Result<ProtectedVolume, D::Error> {
        let found = Lengths::deserialize(input)?;
        let radius_m = found.radius_m;
        Ok(match found.half_height_m {
            None => ProtectedVolume::Sphere { radius_m },
            Some(half_height_m) => ProtectedVolume::Cylinder {
                radius_m,
                half_height_m,
            },
        })
    }
}
