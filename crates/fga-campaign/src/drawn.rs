//! Encounters in files, as everything that flies them reads them: tables of obstacles around a line,
//! recordings, and what `fga campaign draw` writes of both, as text and as Parquet.
//!
//! A drawn recording carries its number, its master seed and its weight, so that it flies again with the
//! same sensor noise and counts as much as when it was drawn. Values in files have as many digits as it
//! takes to read the same numbers back.

mod columns;
mod origin;
mod read;
mod surroundings;
mod tables;

use std::path::{Path, PathBuf};

use fga_formats::InputError;
use fga_formats::encounters::{self, Encounter};
use fga_formats::error::read_bytes;
use fga_formats::recordings::{self, Encounters};

pub use origin::{DrawnContent, Origin};
pub use surroundings::{SURROUNDINGS, SceneryFolder, write_surroundings};
pub use tables::DrawnWriter;

/// The table of aircraft with tracks in a drawn folder.
pub const TRACKS: &str = "tracks.parquet";

/// The table of obstacles around a line in a drawn folder.
pub const ROWS: &str = "encounters.parquet";

/// The content of a file, or of a folder, whose content is always tracks.
///
/// # Errors
/// An unreadable path; a folder with encounters of both kinds; an unusable Parquet file.
pub fn content(path: &Path) -> Result<DrawnContent, InputError> {
    let unreadable = |error| InputError::unreadable(path, &error);
    if std::fs::metadata(path).map_err(unreadable)?.is_dir() {
        let [rows, tracks] = [ROWS, TRACKS].map(|name| path.join(name).is_file());
        return match (rows, tracks) {
            (true, true) => Err(InputError::in_file(
                path,
                format!(
                    "holds obstacles around a line as well as aircraft with tracks, expected one of its files: {ROWS} or {TRACKS}"
                ),
            )),
            (true, false) => Ok(DrawnContent::Rows),
            (false, _) => Ok(DrawnContent::Tracks),
        };
    }
    if path.extension().is_some_and(|ending| ending == "toml") {
        return Err(InputError::in_file(
            path,
            "is a .toml file, expected encounters (.csv, .parquet), a recording or a folder",
        ));
    }
    let bytes = read_bytes(path)?;
    if columns::is_parquet(&bytes) {
        return read::content(bytes, path);
    }
    Ok(if recordings::is_recording(&bytes, path) {
        DrawnContent::Tracks
    } else {
        DrawnContent::Rows
    })
}

/// The files with recordings in a folder: its table of drawn tracks, else its recordings by their
/// endings; a file stands for itself.
///
/// # Errors
/// An unreadable path; a folder without recordings.
pub fn files_of(path: &Path) -> Result<Vec<PathBuf>, InputError> {
    let table = path.join(TRACKS);
    if table.is_file() {
        return Ok(vec![table]);
    }
    recordings::files_of(path)
}

/// The recordings in the bytes of a file.
///
/// # Errors
/// A file that is none, or holds none that can be used.
pub fn recordings_in(bytes: &[u8], path: &Path) -> Result<Encounters, InputError> {
    if columns::is_parquet(bytes) {
        return read::tracks(bytes.to_vec(), path);
    }
    recordings::parse(bytes, path)
}

/// The table with encounters around a line: a drawn folder's, else the file itself.
fn table_of(path: &Path) -> PathBuf {
    let table = path.join(ROWS);
    if table.is_file() {
        table
    } else {
        path.to_owned()
    }
}

/// Encounters around a line, with what surrounds them.
#[derive(Debug, Clone, PartialEq)]
pub struct RowTable {
    /// The encounters.
    pub encounters: Vec<Encounter>,
    /// The ground and the zones around them.
    pub surroundings: SceneryFolder,
    /// Fingerprint of the files; empty for encounters from no file.
    pub sha256: String,
}

impl From<Vec<Encounter>> for RowTable {
    /// Without ground and zones.
    fn from(encounters: Vec<Encounter>) -> Self {
        Self {
            encounters,
            surroundings: SceneryFolder::default(),
            sha256: String::new(),
        }
    }
}

/// The encounters around a line in a file, or in the drawn folder that holds it, with their surroundings.
///
/// # Errors
/// As [`encounters::read`]; surroundings without a file for each encounter.
pub fn read_rows(path: &Path) -> Result<RowTable, InputError> {
    let path = &table_of(path);
    let bytes = read_bytes(path)?;
    let encounters = rows_in(&bytes, path)?;
    let surroundings = SceneryFolder::of_table(path);
    Ok(RowTable {
        sha256: surroundings.fingerprint(&bytes, &encounters)?,
        surroundings,
        encounters,
    })
}

/// The encounters around a line in the bytes of a file.
///
/// # Errors
/// As [`encounters::parse`].
fn rows_in(bytes: &[u8], path: &Path) -> Result<Vec<Encounter>, InputError> {
    if columns::is_parquet(bytes) {
        return read::rows(bytes.to_vec(), path);
    }
    encounters::parse(bytes, path)
}
