//! One campaign exactly: everything that determines its results.

use std::path::PathBuf;

use fga_files::sensors::SensorSource;
use fga_formats::tally::Tally;
use fga_sim::fingerprint::fingerprint;
use fga_sim::own::{OwnPolicy, piped};
use fga_sim::plant::PlantDifference;
use fga_sim::policy::PolicyChoice;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::sources::ModelFile;
use crate::recorded::RecordingSource;

/// A file of encounters as a source.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileSource {
    /// Its path.
    pub path: PathBuf,
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// Number of its encounters.
    pub encounters: u64,
}

/// Everything that determines the results of a campaign, with all defaults written out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CampaignConfiguration {
    /// Name of the campaign.
    pub name: String,
    /// Version of the program.
    pub version: String,
    /// Number of encounters over all cells.
    pub encounters: u64,
    /// Encounters in a block.
    pub block: u64,
    /// Master seeds.
    pub seeds: Vec<u64>,
    /// Policies by their names on the command line.
    pub policies: Vec<String>,
    /// The policy of the intruders, which react by it; without it they fly their tracks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intruders: Option<String>,
    /// Fingerprints of the policies outside of this crate, in their order, the intruders' last.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub own_sha256: Vec<String>,
    /// Longest time flown, seconds.
    pub horizon_s: f64,
    /// Whether the oracle searches each encounter.
    pub oracle: bool,
    /// Cells as [`EncounterSource::parse`](crate::encounters::EncounterSource::parse) reads them.
    pub cells: Vec<String>,
    /// Files of encounters.
    pub files: Vec<FileSource>,
    /// Files with recorded encounters.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub recordings: Vec<RecordingSource>,
    /// Encounter models.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub models: Vec<ModelFile>,
    /// The faults of left-out recordings, one sentence each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub damaged: Vec<String>,
    /// What became of the lines and rows of the other recordings.
    #[serde(default, skip_serializing_if = "is_whole")]
    pub tally: Tally,
    /// Sources that take the place of the vehicle file's sensor.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<SensorSource>,
    /// What the simulated aircraft does otherwise than the vehicle file says.
    #[serde(default, skip_serializing_if = "is_exact")]
    pub plant: PlantDifference,
    /// Text of the vehicle file; without it the built-in vehicle.
    pub vehicle: Option<String>,
    /// Fingerprint of the aircraft in it.
    pub vehicle_sha256: String,
    /// Encounters with logged events.
    pub events: Vec<u64>,
}

/// Whether there is no difference.
fn is_exact(plant: &PlantDifference) -> bool {
    *plant == PlantDifference::NONE
}

/// Whether nothing was left out of the recordings.
fn is_whole(tally: &Tally) -> bool {
    tally.lost() == 0
}

impl CampaignConfiguration {
    /// What was left out of the recordings, by reason, with the number of those left out as a whole.
    pub fn left_out(&self) -> Map<String, Value> {
        let mut left_out = if is_whole(&self.tally) {
            Map::new()
        } else {
            self.tally.to_json()
        };
        if !self.damaged.is_empty() {
            left_out.insert("recordings".into(), self.damaged.len().into());
        }
        left_out
    }

    /// Fingerprint of everything that determines the results; paths of files and additional logs do not
    /// count.
    pub fn hash(&self) -> String {
        let mut placeless = self.clone();
        placeless.forget_extras();
        for path in placeless.paths() {
            *path = PathBuf::new();
        }
        fingerprint(placeless.to_json().as_bytes())
    }

    /// Clears what does not determine results, except the paths of files.
    fn forget_extras(&mut self) {
        self.events.clear();
        self.damaged.clear();
        self.tally = Tally::default();
    }

    /// The paths of all files.
    fn paths(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let files = self.files.iter_mut().map(|file| &mut file.path);
        let recordings = self.recordings.iter_mut().map(|file| &mut file.path);
        let models = self.models.iter_mut().map(|file| &mut file.path);
        files.chain(recordings).chain(models)
    }

    /// The configuration without what does not determine results; names of files instead of paths.
    pub(super) fn placeless(&self) -> Self {
        let mut placeless = self.clone();
        placeless.forget_extras();
        for path in placeless.paths() {
            *path = path.file_name().map(Into::into).unwrap_or_default();
        }
        placeless
    }

    /// As one line of JSON.
    pub fn to_json(&self) -> String {
        // Strings and finite numbers only: this does not fail.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Number of blocks.
    pub fn blocks(&self) -> u64 {
        self.encounters.div_ceil(self.block.max(1))
    }

    /// Encounters of one block: its first number and the one after its last.
    pub fn range_of(&self, block: u64) -> core::ops::Range<u64> {
        let first = block * self.block;
        first..(first + self.block).min(self.encounters)
    }

    /// Keys that differ between two campaigns.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let value = |c: &Self| serde_json::to_value(c).unwrap_or_default();
        let (own, other) = (value(self), value(other));
        own.as_object().map_or_else(Vec::new, |own| {
            own.iter()
                .filter(|(key, value)| other.get(key) != Some(value))
                .map(|(key, _)| key.clone())
                .collect()
        })
    }
}

/// Most encounters in a block.
const LARGEST_BLOCK: u64 = 8192;

/// Most encounters of a campaign: a Parquet file numbers its row groups, one for each block, from 0 with a signed number
/// of 16 bits.
pub const MOST_ENCOUNTERS: u64 = LARGEST_BLOCK << 15;

/// Encounters in a block of a campaign of `encounters`: enough to keep every thread busy, few
/// enough to lose little in a power failure.
pub(super) fn block_size(encounters: u64) -> u64 {
    encounters.div_ceil(16).clamp(256, LARGEST_BLOCK)
}

/// The number of encounters, if a campaign can have it.
///
/// # Errors
/// One sentence about a number that it cannot have.
pub(super) fn number_of_encounters(number: u64) -> Result<u64, String> {
    if (1..=MOST_ENCOUNTERS).contains(&number) {
        Ok(number)
    } else {
        Err(format!(
            "encounters is {number}, expected 1 to {MOST_ENCOUNTERS}"
        ))
    }
}

/// The policy called `name` with its start, as in `published --start t0`.
///
/// # Errors
/// One sentence about an unknown name or start.
pub fn parse_policy(text: &str) -> Result<PolicyChoice, String> {
    match text.split_once(" --start ") {
        Some((name, start)) if piped(text).is_none() => {
            PolicyChoice::parse(name.trim(), Some(start.trim()))
        }
        _ => PolicyChoice::parse(text.trim(), None),
    }
}

/// The policy with a name: one of the given policies, or one that [`parse_policy`] knows.
///
/// # Errors
/// As [`parse_policy`].
pub fn policy_called(text: &str, own: &[OwnPolicy]) -> Result<PolicyChoice, String> {
    match own.iter().find(|own| own.name() == text) {
        Some(own) => Ok(PolicyChoice::Own(own.clone())),
        None => parse_policy(text),
    }
}

/// Fingerprints of the policies outside of this crate, in their order, the intruders' last.
pub fn own_sha256(policies: &[PolicyChoice], intruders: Option<&PolicyChoice>) -> Vec<String> {
    let all = policies.iter().chain(intruders);
    let own = all.filter_map(PolicyChoice::own);
    own.map(|own| own.sha256().to_owned()).collect()
}
