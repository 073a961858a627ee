//! Recorded encounters from any program.
//!
//! Which files there are and how each is recognized: `docs/recorded-encounters.md`.
//!
//! Files may be compressed (gzip). Two received tracks are a pair when they come close; see [`pairs`].
//! Where a file holds one instant only, its aircraft fly straight on. Aircraft that say that they are on the ground are left
//! out; so is what cannot be used, with a count by reason.

mod degas;
mod encounters;
pub mod pairs;
mod px4;
mod received;
mod scenario;
mod state_vectors;

use crate::daa;
use crate::error::{InputError, read_bytes, text_of};
use crate::flight_log::ulog;
use crate::gzip::unpacked;
use crate::traffic::sbs;
use std::path::{Path, PathBuf};

pub use encounters::{Content, Encounters, Named};
pub use received::{Heard, Received, ReceivedTrack};

/// First lines that show what a file is: a recorder may begin anywhere.
const LOOK_AT: usize = 1000;

/// Endings of recordings, besides `.gz` after them.
const ENDINGS: [&str; 8] = ["daa", "csv", "txt", "json", "sbs", "log", "scn", "ulg"];

/// The recordings of a folder by their endings, sorted by name; a file stands for itself.
///
/// # Errors
/// An unreadable path; a folder without recordings.
pub fn files_of(path: &Path) -> Result<Vec<PathBuf>, InputError> {
    let unreadable = |error| InputError::unreadable(path, &error);
    if !std::fs::metadata(path).map_err(unreadable)?.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut files = Vec::new();
    for entry in std::fs::read_dir(path).map_err(unreadable)? {
        let file = entry.map_err(unreadable)?.path();
        if has_known_ending(&file) && file.is_file() {
            files.push(file);
        }
    }
    files.sort();
    if files.is_empty() {
        let message = format!(
            "holds no recordings, expected files that end in .{} (or .gz after it)",
            ENDINGS.join(", .")
        );
        return Err(InputError::in_file(path, message));
    }
    Ok(files)
}

fn has_known_ending(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.to_ascii_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let ending = name.rsplit_once('.').map(|(_, ending)| ending);
    ending.is_some_and(|ending| ENDINGS.contains(&ending))
}

/// Reads the encounters of a file.
///
/// # Errors
/// A file that is unreadable or no recording; fewer than two aircraft; no two that come close.
pub fn read(path: &Path) -> Result<Encounters, InputError> {
    parse(&read_bytes(path)?, path)
}

/// Reads a file of any kind.
///
/// # Errors
/// A file that is unreadable or no recording.
pub fn read_content(path: &Path) -> Result<Content, InputError> {
    parse_content(&read_bytes(path)?, path)
}

/// Reads the aircraft of a feed, BaseStation lines or state vectors, whether or not two of them come close.
///
/// # Errors
/// A file that is unreadable, is no feed, or has no aircraft in the air with a position and an altitude.
pub fn read_feed(path: &Path) -> Result<Received, InputError> {
    let received = match read_content(path)? {
        Content::Lines(text) => received::from_sbs(text.as_bytes()),
        Content::States(received) => received,
        Content::Recording(_) => {
            let message = "is a recording, expected lines of BaseStation or state vectors";
            return Err(InputError::in_file(path, message));
        }
    };
    if received.tracks.is_empty() {
        let message = "has no aircraft in the air with a position and an altitude, expected one";
        return Err(InputError::in_file(path, message));
    }
    Ok(received)
}

/// Reads the encounters in the bytes of a file; errors name it `path`. See [`read`].
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path) -> Result<Encounters, InputError> {
    let name = name_of(path);
    let recording = match parse_content(bytes, path)? {
        Content::Lines(text) => {
            let received = received::from_sbs(text.as_bytes()).carried_on();
            return pairs::close_pairs(&received, "lines", &name, path);
        }
        Content::States(states) => {
            return pairs::close_pairs(&states.carried_on(), "state vectors", &name, path);
        }
        Content::Recording(recording) => recording,
    };
    if recording.aircraft.len() < 2 {
        let message = "holds one aircraft only, expected the ownship and at least one more";
        return Err(InputError::in_file(path, message));
    }
    let tally = recording.tally;
    let named = vec![Named { name, recording }];
    Ok(Encounters { named, tally })
}

/// Reads the bytes of a file of any kind; errors name it `path`.
///
/// # Errors
/// As [`read_content`].
pub fn parse_content(bytes: &[u8], path: &Path) -> Result<Content, InputError> {
    let plain = unpacked(bytes, path)?;
    if ulog::is_one(&plain) {
        return Ok(Content::States(px4::parse(&plain)));
    }
    let text = text_of(&plain);
    let begin = text.trim_start();
    if begin.starts_with(['[', '{']) {
        return state_vectors::parse(begin, path).map(Content::States);
    }
    if state_vectors::is_history(begin) {
        return state_vectors::parse_history(begin, path).map(Content::States);
    }
    if scenario::is_one(begin) {
        return Ok(Content::States(scenario::parse(begin)));
    }
    if degas::is_degas(begin) {
        return degas::parse(&text, path).map(Content::Recording);
    }
    if has_messages(begin) {
        return Ok(Content::Lines(text));
    }
    daa::parse(&text, path).map(Content::Recording)
}

/// Whether the first lines hold one of BaseStation.
fn has_messages(text: &str) -> bool {
    text.lines().take(LOOK_AT).any(sbs::is_message)
}

/// Whether the bytes of a file are those of a recording, and not a table of encounters around a line:
/// by the first line that is neither blank nor a comment.
pub fn is_recording(bytes: &[u8], path: &Path) -> bool {
    let Ok(plain) = unpacked(bytes, path) else {
        return true;
    };
    let text = text_of(&plain);
    let begin = text.trim_start();
    if begin.starts_with(['[', '{']) || degas::is_degas(begin) || ulog::is_one(&plain) {
        return true;
    }
    // Lines `key = value` come before the names of a recording's columns.
    let header = begin
        .lines()
        .map(str::trim)
        .find(|line| !line.is_empty() && !line.starts_with('#') && !line.contains('='));
    let has = |names: &[&str]| {
        header.is_some_and(|header| {
            header
                .split([',', ';', '\t', ' '])
                .any(|field| names.contains(&field.to_ascii_lowercase().as_str()))
        })
    };
    !has(&["encounter", "obstacle", "radius_m"])
        && (has(&["time", "tm", "st", "clock"])
            || has_messages(begin)
            || path.extension().is_none_or(|ending| ending != "csv"))
}

/// The name of a file without its endings.
fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.rsplit_once('.')
        .map_or(name, |(stem, _)| stem)
        .to_owned()
}
