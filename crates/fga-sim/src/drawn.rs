//! Encounters in files, as everything that flies them reads them: tables of obstacles around a line,
//! recordings, and what `fga campaign draw` writes of both, as text and as Parquet.
//!
//! A drawn recording carries its number, its master seed and its weight, so that it flies again with the
//! same sensor noise and counts as much as when it was drawn. Values in files have as many digits as it
//! takes to read the same numbers back.

mod columns;
mod read;
mod tables;

use std::path::{Path, PathBuf};

use fga_formats::InputError;
use fga_formats::daa::Recording;
use fga_formats::encounters::{self, Encounter};
use fga_formats::recordings::{self, Encounters};

pub use tables::{ROW_COLUMNS, TRACK_COLUMNS, TableWriter};

/// The table of aircraft with tracks in a drawn folder.
pub const TRACKS: &str = "tracks.parquet";

/// The table of obstacles around a line in a drawn folder.
pub const ROWS: &str = "encounters.parquet";

/// The keys of a recording's parameters.
const KEYS: [&str; 3] = ["fga_encounter", "fga_seed", "fga_weight"];

/// The largest weight: sums of squares of weights stay finite.
const LARGEST_WEIGHT: f64 = 1e12;

/// Where a recording comes from, if it was drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Origin {
    /// Number of the encounter in its campaign: the stream of its sensor noise.
    pub number: Option<u64>,
    /// Its master seed.
    pub seed: Option<u64>,
    /// Number of encounters that it represents.
    pub weight: f64,
}

impl Origin {
    /// The origin that a recording names; without one its weight is 1.
    ///
    /// # Errors
    /// One sentence about a number that is missing, appears twice or cannot be used.
    pub fn of(recording: &Recording) -> Result<Self, String> {
        let value = |name: &str| {
            let mut found = recording.parameters.iter().filter(|(key, _)| key == name);
            found.next().map(|(_, value)| value.as_str())
        };
        for name in KEYS {
            let named = |(key, _): &&(String, String)| key == name;
            if recording.parameters.iter().filter(named).count() > 1 {
                return Err(format!("{name} appears twice, expected it once"));
            }
        }
        let whole = |name: &str| {
            value(name)
                .map(|text| {
                    text.parse::<u64>().map_err(|_| {
                        format!(
                            "{name} is {}, expected a whole number from 0",
                            fga_formats::error::shown(text)
                        )
                    })
                })
                .transpose()
        };
        let [number, seed, weight] = KEYS;
        let weight = match value(weight) {
            // A drawn encounter counts by its weight: 1 would change every ratio.
            None if value(number).is_some() => {
                return Err(format!("{weight} is missing, expected it beside {number}"));
            }
            None => 1.0,
            Some(text) => text
                .parse()
                .ok()
                .filter(|weight: &f64| *weight > 0.0 && *weight <= LARGEST_WEIGHT)
                .ok_or_else(|| {
                    format!(
                        "{weight} is {}, expected a positive number up to {LARGEST_WEIGHT:e}",
                        fga_formats::error::shown(text)
                    )
                })?,
        };
        Ok(Self {
            number: whole(number)?,
            seed: whole(seed)?,
            weight,
        })
    }

    /// Writes the origin into a recording.
    pub fn mark(&self, recording: &mut Recording) {
        recording
            .parameters
            .retain(|(key, _)| !KEYS.contains(&key.as_str()));
        let values = [
            self.number.map(|number| number.to_string()),
            self.seed.map(|seed| seed.to_string()),
            Some(self.weight.to_string()),
        ];
        for (key, value) in KEYS.iter().zip(values) {
            let value = value.map(|value| ((*key).to_owned(), value));
            recording.parameters.extend(value);
        }
    }
}

/// The content of a file of encounters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// Obstacles around the line of the ownship.
    Rows,
    /// Aircraft with tracks.
    Tracks,
}

/// The content of a file, or of a folder, whose content is always tracks.
///
/// # Errors
/// An unreadable path; a folder with encounters of both kinds; an unusable Parquet file.
pub fn content(path: &Path) -> Result<Content, InputError> {
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
            (true, false) => Ok(Content::Rows),
            (false, _) => Ok(Content::Tracks),
        };
    }
    if path.extension().is_some_and(|ending| ending == "toml") {
        return Err(InputError::in_file(
            path,
            "is a .toml file, expected encounters (.csv, .parquet), a recording or a folder",
        ));
    }
    let bytes = std::fs::read(path).map_err(unreadable)?;
    if columns::is_parquet(&bytes) {
        return read::content(bytes, path);
    }
    Ok(if recordings::is_recording(&bytes, path) {
        Content::Tracks
    } else {
        Content::Rows
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
pub fn table_of(path: &Path) -> PathBuf {
    let table = path.join(ROWS);
    if table.is_file() {
        table
    } else {
        path.to_owned()
    }
}

/// The encounters around a line in a file, or in the drawn folder that holds it.
///
/// # Errors
/// As [`encounters::read`].
pub fn read_rows(path: &Path) -> Result<Vec<Encounter>, InputError> {
    let path = &table_of(path);
    let bytes = std::fs::read(path).map_err(|error| InputError::unreadable(path, &error))?;
    rows_in(&bytes, path)
}

/// The encounters around a line in the bytes of a file.
///
/// # Errors
/// As [`encounters::parse`].
pub fn rows_in(bytes: &[u8], path: &Path) -> Result<Vec<Encounter>, InputError> {
    if columns::is_parquet(bytes) {
        return read::rows(bytes.to_vec(), path);
    }
    encounters::parse(bytes, path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_origin_is_read_back_and_wrong_numbers_are_refused() {
        let mut recording = Recording {
            aircraft: Vec::new(),
            tally: fga_formats::tally::Tally::default(),
            frame: None,
            parameters: vec![("fga_weight".into(), "-1".into())],
        };
        let said = Origin::of(&recording).unwrap_err();
        assert_eq!(
            said,
            "fga_weight is \"-1\", expected a positive number up to 1e12"
        );
        let origin = Origin {
            number: Some(17),
            seed: Some(u64::MAX),
            weight: 0.1 + 0.2,
        };
        origin.mark(&mut recording);
        assert_eq!(Origin::of(&recording), Ok(origin));
        recording.parameters[1].1 = "1.5".into();
        let said = Origin::of(&recording).unwrap_err();
        assert_eq!(said, "fga_seed is \"1.5\", expected a whole number from 0");
        origin.mark(&mut recording);
        recording.parameters.pop();
        let said = Origin::of(&recording).unwrap_err();
        assert_eq!(
            said,
            "fga_weight is missing, expected it beside fga_encounter"
        );
        origin.mark(&mut recording);
        recording.parameters.push(("fga_weight".into(), "1".into()));
        let said = Origin::of(&recording).unwrap_err();
        assert_eq!(said, "fga_weight appears twice, expected it once");
    }
}
