//! Recordings and encounter models as sources of a campaign.

use std::path::{Path, PathBuf};

use fga_formats::daa::Recording;
use fga_formats::recordings::{self, Named};
use fga_formats::{InputError, encounter_model};
use serde::{Deserialize, Serialize};

use super::CampaignError;
use crate::encounters::modeled::{ModelSource, Pairing};
use crate::fingerprint::fingerprint;
use crate::recording;
use crate::run::Plan;
use crate::vehicle_file::VehicleModel;

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

/// An encounter model as a source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    /// Its path.
    pub path: PathBuf,
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// How its aircraft meet.
    pub pairing: Pairing,
}

/// The content of folders of recordings.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Found {
    /// Usable files.
    pub sources: Vec<RecordingSource>,
    /// The faults of the others, one sentence each.
    pub damaged: Vec<String>,
}

/// Searches folders and files for recordings; reads each completely and tries it as a flight.
///
/// # Errors
/// An unreadable folder or one without recordings; no usable recording.
pub fn find(paths: &[PathBuf], model: &VehicleModel) -> Result<Found, InputError> {
    let mut found = Found::default();
    for path in paths {
        let source = std::path::absolute(path)
            .unwrap_or_else(|_| path.clone())
            .file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        for file in recordings::files_of(path)? {
            match look_at(&file, &source, model) {
                Ok(usable) => found.sources.push(usable),
                Err(error) => found.damaged.push(error.to_string()),
            }
        }
    }
    if found.sources.is_empty()
        && let Some(first) = found.damaged.first()
    {
        let path = paths.first().cloned().unwrap_or_default();
        return Err(InputError::in_file(
            path,
            format!(
                "holds {} recordings, of which none can be used, expected at least one; the first: {first}",
                found.damaged.len()
            ),
        ));
    }
    Ok(found)
}

/// A usable file in its present state.
fn look_at(path: &Path, source: &str, model: &VehicleModel) -> Result<RecordingSource, InputError> {
    let bytes = std::fs::read(path).map_err(|error| InputError::unreadable(path, &error))?;
    let encounters = recordings::parse(&bytes, path)?;
    for named in &encounters {
        plan_of(&named.recording, &named.name, model)
            .map_err(|message| InputError::in_file(path, message))?;
    }
    Ok(RecordingSource {
        path: std::path::absolute(path).unwrap_or_else(|_| path.to_owned()),
        sha256: fingerprint(&bytes),
        encounters: encounters.len() as u64,
        source: source.to_owned(),
    })
}

/// A recorded or drawn encounter as a flight.
pub(super) fn plan_of(
    recording: &Recording,
    name: &str,
    model: &VehicleModel,
) -> Result<Plan, String> {
    recording::plan(recording, name.to_owned(), name.to_owned(), model.clone())
}

/// The recordings of a campaign, read on demand.
#[derive(Debug, Default)]
pub(super) struct Recordings {
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
    pub(super) fn open(sources: &[RecordingSource]) -> Result<Self, CampaignError> {
        let mut opened = Self {
            sources: sources.to_vec(),
            ..Self::default()
        };
        for (index, source) in sources.iter().enumerate() {
            let mut named = read(source)?;
            if named.len() as u64 != source.encounters {
                return Err(changed(source).into());
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
    pub(super) fn len(&self) -> usize {
        self.places.len()
    }

    /// Names of the encounters in their order.
    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    /// Names of the folders, each once, in their order.
    pub(super) fn folders(&self) -> Vec<String> {
        let mut folders: Vec<String> = Vec::new();
        for source in &self.sources {
            if !folders.contains(&source.source) {
                folders.push(source.source.clone());
            }
        }
        folders
    }

    /// The encounter with this number and the name of its folder.
    pub(super) fn get(&self, number: usize) -> Result<Option<(Recording, &str)>, CampaignError> {
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
    let bytes = std::fs::read(&source.path)
        .map_err(|error| InputError::unreadable(&source.path, &error))?;
    if fingerprint(&bytes) != source.sha256 {
        return Err(changed(source));
    }
    recordings::parse(&bytes, &source.path)
}

fn changed(source: &RecordingSource) -> InputError {
    InputError::in_file(
        &source.path,
        "is not the file that the campaign was begun with",
    )
}

/// Reads a model file and describes it.
///
/// # Errors
/// An unreadable file or an unusable model.
pub fn model_file(path: &Path, pairing: Pairing) -> Result<ModelFile, InputError> {
    let bytes = std::fs::read(path).map_err(|error| InputError::unreadable(path, &error))?;
    let found = ModelFile {
        path: std::path::absolute(path).unwrap_or_else(|_| path.to_owned()),
        sha256: fingerprint(&bytes),
        pairing,
    };
    source_of(&bytes, &found, 15.0, 0)?;
    Ok(found)
}

fn source_of(
    bytes: &[u8],
    file: &ModelFile,
    airspeed_mps: f64,
    seed: u64,
) -> Result<ModelSource, InputError> {
    let model = encounter_model::parse(&String::from_utf8_lossy(bytes), &file.path)?;
    ModelSource::new(model, file.pairing.clone(), airspeed_mps, seed)
        .map_err(|message| InputError::in_file(&file.path, message))
}

/// Opens a model and verifies that it is unchanged.
pub(super) fn open_model(
    file: &ModelFile,
    airspeed_mps: f64,
    seed: u64,
) -> Result<ModelSource, InputError> {
    let bytes =
        std::fs::read(&file.path).map_err(|error| InputError::unreadable(&file.path, &error))?;
    if fingerprint(&bytes) != file.sha256 {
        return Err(InputError::in_file(
            &file.path,
            "is not the file that the campaign was begun with",
        ));
    }
    source_of(&bytes, file, airspeed_mps, seed)
}
