//! Recorded encounters from any program.
//!
//! | file | recognized by | encounters |
//! |---|---|---|
//! | `.daa` of DAIDALUS; pairing files of MIT-LL (`NAME, east, north, alt, …`) | a line of column names | one |
//! | DEGAS of MIT-LL | a first line `# xE1,xE2,…` | one |
//! | BaseStation lines (SBS), with or without a recorder's nanoseconds before them | lines with `MSG,` | one for each close pair |
//! | state vectors in JSON, a list of objects or an object of columns | `[` or `{` | one for each close pair |
//!
//! Files may be compressed (gzip). Two received tracks are a pair when they come close; see [`pairs`].

mod degas;
pub mod pairs;
mod received;

use crate::daa::{self, Recording};
use crate::error::InputError;
use crate::gzip;
use std::path::{Path, PathBuf};

/// Endings of recordings, besides `.gz` after them.
const ENDINGS: [&str; 6] = ["daa", "csv", "txt", "json", "sbs", "log"];

/// An encounter with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// Name of the file without its ending, and of the pair where the file holds several.
    pub name: String,
    /// The aircraft; the first is the ownship.
    pub recording: Recording,
}

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
        return Err(InputError::in_file(
            path,
            format!(
                "holds no recordings, expected files that end in .{} (or .gz after it)",
                ENDINGS.join(", .")
            ),
        ));
    }
    Ok(files)
}

fn has_known_ending(path: &Path) -> bool {
    let ending_of = |path: &Path| {
        path.extension()
            .map(|ending| ending.to_string_lossy().to_ascii_lowercase())
    };
    let ending = match ending_of(path).as_deref() {
        Some("gz") => ending_of(Path::new(path.file_stem().unwrap_or_default())),
        _ => ending_of(path),
    };
    ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str()))
}

/// Reads the encounters of a file.
///
/// # Errors
/// A file that is unreadable or no recording; fewer than two aircraft; no two that come close.
pub fn read(path: &Path) -> Result<Vec<Named>, InputError> {
    let bytes = std::fs::read(path).map_err(|error| InputError::unreadable(path, &error))?;
    parse(&bytes, path)
}

/// Reads the encounters in the bytes of a file; errors name it `path`. See [`read`].
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path) -> Result<Vec<Named>, InputError> {
    let text = text_of(bytes, path)?;
    let text = text.as_str();
    let name = name_of(path);
    let one = |recording: Recording| {
        if recording.aircraft.len() < 2 {
            return Err(InputError::in_file(
                path,
                "holds one aircraft only, expected the ownship and at least one more",
            ));
        }
        let name = name.clone();
        Ok(vec![Named { name, recording }])
    };
    let begin = text.trim_start();
    if begin.starts_with(['[', '{']) {
        return pairs::close_pairs(&received::from_json(begin, path)?, &name, path);
    }
    if degas::is_degas(begin) {
        return one(degas::parse(text, path)?);
    }
    if begin.lines().take(50).any(received::is_message) {
        return pairs::close_pairs(&received::from_sbs(text), &name, path);
    }
    one(daa::parse(text, path)?)
}

/// Whether the bytes of a file are those of a recording, and not a table of encounters around a line:
/// by the first line that is neither blank nor a comment.
pub fn is_recording(bytes: &[u8], path: &Path) -> bool {
    let Ok(text) = text_of(bytes, path) else {
        return true;
    };
    let begin = text.trim_start();
    if begin.starts_with(['[', '{']) || degas::is_degas(begin) {
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
            || begin.lines().take(50).any(received::is_message)
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

/// The text of a file without its byte order mark, decompressed if it is a gzip one.
pub(crate) fn text_of(bytes: &[u8], path: &Path) -> Result<String, InputError> {
    let plain = gzip::unpacked(bytes, path)?;
    let text = String::from_utf8_lossy(&plain);
    Ok(text.trim_start_matches('\u{feff}').to_owned())
}
