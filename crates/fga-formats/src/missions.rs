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
//! Waypoints above the ground (frames 10 and 11) are flown over ground that is known: [`MissionFile::over`]. Fences have no
//! heights, whatever their frame.

mod items;
mod mission_file;
mod over;
mod plan;
mod waypoints;

pub use mission_file::{MissionFence, MissionFile, Waypoint};

use std::path::Path;

use crate::error::InputError;
use crate::gzip::read_packed_text;

/// Whether a text is a mission, by its first words.
pub fn is_mission(text: &str) -> bool {
    let begin = text.trim_start();
    let head: String = begin.chars().take(4096).collect();
    begin.starts_with(waypoints::LIST)
        || (begin.starts_with('{')
            && (head.contains("\"fileType\"") || text.contains("\"plannedHomePosition\"")))
}

/// Whether a file is a mission: by its first words, or by an ending that only missions have.
pub fn is_mission_file(path: &Path) -> bool {
    let ending = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
    match ending.as_ref().and_then(|ending| ending.to_str()) {
        Some("plan" | "waypoints") => true,
        Some("txt" | "mission" | "wp" | "json") => {
            read_packed_text(path).is_ok_and(|text| is_mission(&text))
        }
        _ => false,
    }
}

/// Reads a mission.
///
/// # Errors
/// A file that is unreadable or no mission; an item that cannot be understood, with its number or line.
pub fn read(path: &Path) -> Result<MissionFile, InputError> {
    parse(&read_packed_text(path)?, path)
}

/// Reads a mission from its text; see [`read`].
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, path: &Path) -> Result<MissionFile, InputError> {
    let begin = text.trim_start();
    if begin.starts_with(waypoints::LIST) {
        return waypoints::parse(text, path);
    }
    if begin.starts_with('{') {
        return plan::parse(text, path);
    }
    let message = "is no mission, expected a plan of QGroundControl (JSON) or a list that begins with QGC WPL 110";
    Err(InputError::at_line(path, 1, message))
}
