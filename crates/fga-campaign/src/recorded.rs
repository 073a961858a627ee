//! Recorded encounters as a source: which files hold some, which of them fly, and reading them on demand.

use std::path::{Path, PathBuf};

use fga_formats::InputError;
use fga_formats::daa::Recording;
use fga_formats::error::read_bytes;
use fga_formats::recordings::Named;
use fga_formats::tally::Tally;
use fga_sim::fingerprint::fingerprint;
use fga_sim::plan::Plan;
use fga_sim::recording;
use fga_sim::vehicle_file::VehicleModel;
use serde::{Deserialize, Serialize};

use crate::drawn::{self, Origin};
use crate::unchanged::{changed, read_same};

/// A file with recorded encounters as a source.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingSource {
    /// Its path.
    pub path: PathBuf,
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// Number of its encounters.
    pub encounters: u64,
    /// Name of the given folder or file.
    pub source: String,
}

/// The content of folders of recordings.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct FoundRecordings {
    /// Usable files.
    pub sources: Vec<RecordingSource>,
    /// The faults of the others, one sentence each.
    pub damaged: Vec<String>,
    /// What became of the lines and rows of the usable files.
    pub tally: Tally,
}

/// Searches folders and files for recordings; reads each completely and tries it as a flight.
///
/// # Errors
/// An unreadable folder or one without recordings; no usable recording.
pub fn find(paths: &[PathBuf], model: &VehicleModel) -> Result<FoundRecordings, InputError> {
    let mut found = FoundRecordings::default();
    let mut errors = Vec::new();
    for path in paths {
        let source = std::path::absolute(path)
            .unwrap_or_else(|_| path.clone())
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        for file in drawn::files_of(path)? {
            match look_at(&file, &source, model) {
                Ok((usable, tally)) => {
                    found.sources.push(usable);
                    found.tally += tally;
                }
                Err(error) => errors.push(error),
            }
        }
    }
    found.damaged = errors.iter().map(ToString::to_string).collect();
    if !found.sources.is_empty() || errors.is_empty() {
        return Ok(found);
    }
    let count = errors.len();
    match errors.into_iter().next() {
        Some(error) if count == 1 => Err(error),
        first => Err(InputError::in_file(
            paths.first().cloned().unwrap_or_default(),
            format!(
                "holds {count} recordings, of which none can be used, expected at least one; the first: {}",
                first.map_or_else(String::new, |error| error.to_string())
            ),
        )),
    }
}

/// A usable file in its present state.
fn look_at(
    path: &Path,
    source: &str,
    model: &VehicleModel,
) -> Result<(RecordingSource, Tally), InputError> {
    let bytes = read_bytes(path)?;
    let read = drawn::recordings_in(&bytes, path)?;
    let encounters = read.named;
    for named in &encounters {
        let wrong = |message: String| match encounters.len() {
            1 => InputError::in_file(path, message),
            _ => InputError::in_file(path, format!("{}: {message}", named.name)),
        };
        plan_of(&named.recording, &named.name, model).map_err(wrong)?;
        Origin::of(&named.recording).map_err(wrong)?;
    }
    let usable = RecordingSource {
        path: std::path::absolute(path).unwrap_or_else(|_| path.to_owned()),
        sha256: fingerprint(&bytes),
        encounters: encounters.len() as u64,
        source: source.to_owned(),
    };
    Ok((usable, read.tally))
}

/// A recorded or drawn encounter as a flight.
pub(crate) fn plan_of(
    recording: &Recording,
    name: &str,
    model: &VehicleModel,
) -> Result<Plan, String> {
    recording::plan(recording, name.to_owned(), name.to_owned(), model.clone())
}

/// The recordings of a campaign, read on demand.
#[derive(Debug, Default)]
pub(crate) struct Recordings {
    sources: Vec<RecordingSource>,
    /// The encounters of files with several: parsed once.
    kept: Vec<Vec<Named>>,
    /// File and index in it of each encounter.
    places: Vec<(usize, usize)>,
    /// Names of the encounters.
    names: Vec<String>,
}

impl Recordings {
    /// Opens files and verifies that they are unchanged.
    pub(crate) fn open(sources: &[RecordingSource]) -> Result<Self, InputError> {
        let mut opened = Self {
            sources: sources.to_vec(),
            ..Self::default()
        };
        for (index, source) in sources.iter().enumerate() {
            let mut named = read(source)?;
            if named.len() as u64 != source.encounters {
                return Err(changed(&source.path));
            }
            for (place, one) in named.iter().enumerate() {
                opened.places.push((index, place));
                opened.names.push(one.name.clone());
            }
            // Each flight reads its recording again: memory does not grow with the folder.
            if named.len() == 1 {
                named.clear();
            }
            opened.kept.push(named);
        }
        Ok(opened)
    }

    /// Number of encounters.
    pub(crate) fn len(&self) -> usize {
        self.places.len()
    }

    /// Number of files.
    pub(crate) fn files(&self) -> usize {
        self.sources.len()
    }

    /// Fingerprint of the content of all files.
    pub(crate) fn sha256(&self) -> String {
        let each: Vec<&str> = self
            .sources
            .iter()
            .map(|file| file.sha256.as_str())
            .collect();
        match each.as_slice() {
            [one] => (*one).to_owned(),
            _ => fingerprint(each.join("\n").as_bytes()),
        }
    }

    /// Names of the encounters in their order.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// Names of the folders, each once, in their order.
    pub(crate) fn folders(&self) -> Vec<String> {
        let mut folders: Vec<String> = Vec::new();
        for source in &self.sources {
            if !folders.contains(&source.source) {
                folders.push(source.source.clone());
            }
        }
        folders
    }

    /// The encounter with this number and the name of its folder.
    pub(crate) fn get(&self, number: usize) -> Result<Option<(Recording, &str)>, InputError> {
        let Some(&(index, place)) = self.places.get(number) else {
            return Ok(None);
        };
        let (Some(source), Some(kept)) = (self.sources.get(index), self.kept.get(index)) else {
            return Ok(None);
        };
        let recording = match kept.get(place) {
            Some(named) => Some(named.recording.clone()),
            None => read(source)?
                .into_iter()
                .next()
                .map(|named| named.recording),
        };
        Ok(recording.map(|recording| (recording, source.source.as_str())))
    }
}

/// Reads a file and verifies that it is unchanged.
fn read(source: &RecordingSource) -> Result<Vec<Named>, InputError> {
    let bytes = read_same(&source.path, &source.sha256)?;
    Ok(drawn::recordings_in(&bytes, &source.path)?.named)
}
