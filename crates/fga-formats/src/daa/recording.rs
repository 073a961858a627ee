//! Recorded aircraft.

use crate::geodesy::{Earth, Geodetic, LocalFrame};
use crate::tally::Tally;
use fga_alerts::Deviation;
use glam::DVec3;

/// The content of a recording: at least the ownship, at least one sample each.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// The aircraft in the order of their first rows; the first is the ownship.
    pub aircraft: Vec<Track>,
    /// The local frame, if the file has latitudes and longitudes.
    pub frame: Option<LocalFrame>,
    /// The `key = value` lines before the column names, keys in lower case.
    pub parameters: Vec<(String, String)>,
    /// What became of the rows of its file.
    pub tally: Tally,
}

/// The recorded flight of one aircraft.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// The aircraft's name.
    pub name: String,
    /// The samples, times strictly increasing.
    pub samples: Vec<TrackSample>,
}

/// One row of a recording in SI units and the local frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackSample {
    /// Time in the file's count, s.
    pub time_s: f64,
    /// Position, metres, local frame; for Cartesian files as in the file.
    pub position_m: DVec3,
    /// Velocity over ground, metres per second, local frame.
    pub velocity_mps: DVec3,
    /// The geodetic position in the file, if it has latitudes and longitudes.
    pub place: Option<Geodetic>,
    /// Horizontal velocity through the air, metres per second, local frame, if the file has it.
    pub air_mps: Option<DVec3>,
    /// Standard deviations of position and velocity; zero where the file has no such column.
    pub deviation: Deviation,
}

impl TrackSample {
    /// A row without optional columns: time (seconds), position (metres) and velocity (metres per second).
    pub fn new(time_s: f64, position_m: DVec3, velocity_mps: DVec3) -> Self {
        Self {
            time_s,
            position_m,
            velocity_mps,
            place: None,
            air_mps: None,
            deviation: Deviation::default(),
        }
    }
}

/// The separation of two aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DaaSeparation {
    /// Horizontal distance, metres.
    pub horizontal_m: f64,
    /// Vertical distance, metres, never negative.
    pub vertical_m: f64,
}

impl Recording {
    /// The ownship's track.
    pub fn ownship(&self) -> Option<&Track> {
        self.aircraft.first()
    }

    /// The other aircraft.
    pub fn intruders(&self) -> &[Track] {
        self.aircraft.get(1..).unwrap_or_default()
    }

    /// The separation of two samples as DAIDALUS measures it: in the plane that touches the
    /// earth at the first one.
    pub fn separation(ownship: &TrackSample, intruder: &TrackSample) -> DaaSeparation {
        let offset_m = match (ownship.place, intruder.place) {
            (Some(own), Some(other)) => LocalFrame::new(own, Earth::Daidalus).to_local_m(other),
            _ => intruder.position_m - ownship.position_m,
        };
        DaaSeparation {
            horizontal_m: libm::hypot(offset_m.x, offset_m.y),
            vertical_m: offset_m.z.abs(),
        }
    }
}

impl Track {
    /// Position and velocity at a time, linear between the rows; `None` before the first and after the
    /// last. The velocity is the slope of that line; at a single row it is the recorded one.
    pub fn state_at(&self, time_s: f64) -> Option<(DVec3, DVec3)> {
        let after = self
            .samples
            .partition_point(|sample| sample.time_s <= time_s);
        let before = self.samples.get(after.checked_sub(1)?)?;
        let Some(next) = self.samples.get(after) else {
            let last = after.checked_sub(2).and_then(|i| self.samples.get(i));
            let velocity_mps = last.map_or(before.velocity_mps, |last| {
                (before.position_m - last.position_m) / (before.time_s - last.time_s)
            });
            return (before.time_s == time_s).then_some((before.position_m, velocity_mps));
        };
        let velocity_mps = (next.position_m - before.position_m) / (next.time_s - before.time_s);
        let position_m = before.position_m + velocity_mps * (time_s - before.time_s);
        Some((position_m, velocity_mps))
    }
}
