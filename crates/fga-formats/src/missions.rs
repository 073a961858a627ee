//! Missions, fences and rally points as ground stations write them.
//!
//! | file | recognized by |
//! |---|---|
//! | `.plan` of QGroundControl | an object with `"fileType": "Plan"` |
//! | `.waypoints`, `.txt` of Mission Planner, MAVProxy and others | a first line `QGC WPL 110` |
//!
//! What an aircraft in the simulator flies is a list of places, so that the items of a mission become one: a take-off
//! begins it, a landing or an item that circles for ever ends it, a return leads over home, circles are flown past,
//! and an item without a place (`DO_*`) is left out. Whatever is left out is counted in [`MissionFile::notes`].
//! Heights above the ground (frames 10 and 11) are refused: no ground is known here.

mod items;
mod plan;
mod waypoints;

use std::path::Path;

use fga::situation::Passing;

use crate::error::{InputError, read_text};
use crate::geodesy::Geodetic;

/// A place of a mission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    /// Where; the altitude is above mean sea level.
    pub place: Geodetic,
    /// How it is passed.
    pub passing: Passing,
}

/// The outline of a fence; latitudes and longitudes in degrees.
#[derive(Debug, Clone, PartialEq)]
pub enum Outline {
    /// A circle.
    Circle {
        /// Its centre: latitude and longitude, degrees.
        center_deg: [f64; 2],
        /// Its radius, metres.
        radius_m: f64,
    },
    /// A polygon of at least three corners.
    Polygon {
        /// Latitude and longitude of each corner, degrees.
        corners_deg: Vec<[f64; 2]>,
    },
}

/// A fence.
#[derive(Debug, Clone, PartialEq)]
pub struct Fence {
    /// Its outline.
    pub outline: Outline,
    /// Whether the aircraft must stay inside, not outside.
    pub keep_in: bool,
}

/// A mission with its fences and rally points.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MissionFile {
    /// Home, if the file gives it; the altitude is above mean sea level.
    pub home: Option<Geodetic>,
    /// The places in their order, the first of which is where the flight begins; empty for a file of fences only.
    pub waypoints: Vec<Waypoint>,
    /// Speed that the file plans with, metres per second.
    pub cruise_mps: Option<f64>,
    /// Fences.
    pub fences: Vec<Fence>,
    /// Rally points; altitudes are above mean sea level.
    pub rally: Vec<Geodetic>,
    /// What of the file is not flown, or flown in another way; one sentence each.
    pub notes: Vec<String>,
}

/// The first words of a list of waypoints.
const LIST: &str = "QGC WPL";

/// Whether a text is a mission, by its first words.
pub fn is_mission(text: &str) -> bool {
    let begin = text.trim_start();
    let head: String = begin.chars().take(4096).collect();
    begin.starts_with(LIST)
        || (begin.starts_with('{')
            && (head.contains("\"fileType\"") || text.contains("\"plannedHomePosition\"")))
}

/// Whether a file is a mission: by its first words, or by an ending that only missions have.
pub fn is_mission_file(path: &Path) -> bool {
    let ending = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
    match ending.as_ref().and_then(|ending| ending.to_str()) {
        Some("plan" | "waypoints") => true,
        Some("txt" | "mission" | "wp" | "json") => {
            read_text(path).is_ok_and(|text| is_mission(&text))
        }
        _ => false,
    }
}

/// Reads a mission.
///
/// # Errors
/// A file that is unreadable or no mission; an item that cannot be understood, with its number or line.
pub fn read(path: &Path) -> Result<MissionFile, InputError> {
    parse(&read_text(path)?, path)
}

/// Reads a mission from its text; see [`read`].
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, path: &Path) -> Result<MissionFile, InputError> {
    let begin = text.trim_start();
    if begin.starts_with(LIST) {
        return waypoints::parse(text, path);
    }
    if begin.starts_with('{') {
        return plan::parse(text, path);
    }
    Err(InputError::at_line(
        path,
        1,
        "is no mission, expected a plan of QGroundControl (JSON) or a list that begins with QGC WPL 110",
    ))
}

impl MissionFile {
    /// The contents in words, as in "4 waypoints, 1 fence, 2 rally points".
    pub fn holds(&self) -> String {
        use crate::words::counted;
        format!(
            "{}, {}, {}",
            counted(self.waypoints.len(), "waypoint"),
            counted(self.fences.len(), "fence"),
            counted(self.rally.len(), "rally point")
        )
    }
}
