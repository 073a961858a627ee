//! Encounter models as sources of a campaign.

use std::path::{Path, PathBuf};

use fga_formats::error::read_bytes;
use fga_formats::{InputError, encounter_model};
use fga_sim::fingerprint::fingerprint;
use serde::{Deserialize, Serialize};

use crate::encounters::modeled::{ModelSource, Pairing};
use crate::unchanged::read_same;

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

/// Reads a model file and describes it.
///
/// # Errors
/// An unreadable file or an unusable model.
pub fn model_file(path: &Path, pairing: Pairing) -> Result<ModelFile, InputError> {
    let bytes = read_bytes(path)?;
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
    let bytes = read_same(&file.path, &file.sha256)?;
    source_of(&bytes, file, airspeed_mps, seed)
}
