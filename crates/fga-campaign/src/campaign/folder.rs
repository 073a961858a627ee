//! A folder of results: its manifest and its finished blocks.
//!
//! `campaign.json` says which campaign the folder belongs to. A finished block is
//! `blocks/block-<number>-<first half of its SHA-256>.parquet`: it gets this name when it is
//! complete, and the name shows later damage. Unfinished files begin with a dot and end in `.part`.

use alloc::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use fga_formats::atomic;
use fga_formats::error::read_bytes;
use fga_formats::{InputError, OutputError};
use fga_sim::fingerprint::fingerprint;
use parquet::errors::ParquetError;
use serde::{Deserialize, Serialize};

use super::reading;
use super::table::TableWriter;
use super::{Campaign, CampaignConfiguration, CampaignError, CampaignStamp, Row};

/// Name of the manifest.
pub const MANIFEST: &str = "campaign.json";

/// Name of the table of all rows.
pub const RESULTS: &str = "results.parquet";

/// Name of the folder of finished blocks.
const BLOCKS: &str = "blocks";

/// Digits of the checksum in a block's name.
const CHECKSUM_DIGITS: usize = 32;

/// Which part of a campaign: `number` of `of`, counted from one. A part has every `of`-th block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Its number, from 1.
    pub number: u64,
    /// Number of parts.
    pub of: u64,
}

impl Shard {
    /// The whole campaign.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Reads `k/n`.
    ///
    /// # Errors
    /// One sentence about text that is no such part.
    pub fn parse(text: &str) -> Result<Self, String> {
        text.split_once('/')
            .and_then(|(number, of)| {
                Some(Self {
                    number: number.parse().ok()?,
                    of: of.parse().ok()?,
                })
            })
            .filter(|shard| (1..=shard.of).contains(&shard.number))
            .ok_or_else(|| "expected K/N with K from 1 to N".into())
    }

    /// Whether a block belongs to this part.
    pub const fn has(&self, block: u64) -> bool {
        block % self.of == self.number - 1
    }
}

/// The manifest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Fingerprint of the configuration.
    pub configuration_hash: String,
    /// Origin of the results.
    pub stamp: CampaignStamp,
    /// The part in this folder.
    pub shard: Shard,
    /// The configuration.
    pub configuration: CampaignConfiguration,
}

/// A folder of results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folder(PathBuf);

impl Folder {
    /// The folder at `path`, which need not exist yet.
    pub fn at(path: &Path) -> Self {
        Self(path.into())
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// A file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Its manifest, if it has one.
    ///
    /// # Errors
    /// An unreadable manifest.
    pub fn manifest(&self) -> Result<Option<Manifest>, CampaignError> {
        let path = self.file(MANIFEST);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(InputError::unreadable(path, &error).into()),
        };
        let manifest: Manifest = serde_json::from_slice(&bytes).map_err(|error| {
            InputError::in_file(&path, format!("is no manifest of a campaign: {error}"))
        })?;
        if manifest.configuration.hash() != manifest.configuration_hash {
            let message = "is damaged: the fingerprint is not that of the configuration";
            return Err(InputError::in_file(path, message).into());
        }
        Ok(Some(manifest))
    }

    /// Prepares the folder for a campaign: a new one gets its manifest; an existing one must belong to
    /// the same campaign, with `resume` set.
    ///
    /// # Errors
    /// A folder of another campaign, or one with results but without `resume`.
    pub fn open(&self, manifest: &Manifest, resume: bool) -> Result<(), CampaignError> {
        atomic::prepare_folder(&self.0)?;
        if let Some(found) = self.manifest()? {
            if found.configuration_hash != manifest.configuration_hash {
                let differences = found.configuration.differences(&manifest.configuration);
                return Err(InputError::in_file(
                    &self.0,
                    format!(
                        "holds results of another configuration (differs in {}), expected an empty folder or the same campaign",
                        differences.join(", ")
                    ),
                )
                .into());
            }
            if found.shard != manifest.shard || found.stamp != manifest.stamp {
                return Err(InputError::in_file(
                    &self.0,
                    format!(
                        "holds part {}/{} made on {}, expected part {}/{} made on {}",
                        found.shard.number,
                        found.shard.of,
                        found.stamp,
                        manifest.shard.number,
                        manifest.shard.of,
                        manifest.stamp
                    ),
                )
                .into());
            }
            if !resume {
                return Err(InputError::in_file(
                    &self.0,
                    "holds results of this campaign already; --resume goes on with them",
                )
                .into());
            }
        } else if self.file(RESULTS).exists() || self.file(BLOCKS).exists() {
            let message = "holds results without a manifest, expected an empty folder";
            return Err(InputError::in_file(&self.0, message).into());
        } else {
            self.write_manifest(manifest)?;
        }
        atomic::prepare_folder(&self.file(BLOCKS))?;
        self.clean()?;
        Ok(())
    }

    /// Writes the manifest.
    ///
    /// # Errors
    /// An unwritable folder.
    pub fn write_manifest(&self, manifest: &Manifest) -> Result<(), OutputError> {
        // Strings and finite numbers only: this does not fail.
        let text = serde_json::to_string_pretty(manifest).unwrap_or_default();
        atomic::write(&self.file(MANIFEST), text + "\n")
    }

    /// Removes the unfinished files of a killed program.
    fn clean(&self) -> Result<(), OutputError> {
        for folder in [self.0.clone(), self.file(BLOCKS)] {
            let failed = |error| OutputError::new(&folder, error);
            for entry in fs::read_dir(&folder).map_err(failed)? {
                let entry = entry.map_err(failed)?;
                let name = entry.file_name();
                let name = name.to_string_lossy();
                if name.starts_with('.') && name.ends_with(".part") {
                    fs::remove_file(entry.path()).map_err(failed)?;
                }
            }
        }
        Ok(())
    }

    /// The finished blocks by their numbers.
    ///
    /// # Errors
    /// An unreadable folder, a block file with an unknown name, or two files for one block.
    pub fn blocks(&self) -> Result<BTreeMap<u64, PathBuf>, CampaignError> {
        let folder = self.file(BLOCKS);
        let mut blocks = BTreeMap::new();
        let entries = match fs::read_dir(&folder) {
            Ok(entries) => entries,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(blocks),
            Err(error) => return Err(InputError::unreadable(folder, &error).into()),
        };
        for entry in entries {
            let path = entry
                .map_err(|error| InputError::unreadable(&folder, &error))?
                .path();
            let name = path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            if !name.ends_with(".parquet") {
                continue;
            }
            let Some(number) = number_of(&name) else {
                let message = "is no block of a campaign by its name";
                return Err(InputError::in_file(path, message).into());
            };
            if let Some(other) = blocks.insert(number, path.clone()) {
                return Err(InputError::in_file(
                    path,
                    format!("appears twice: {} holds the same block", other.display()),
                )
                .into());
            }
        }
        Ok(blocks)
    }

    /// Writes a finished block.
    ///
    /// # Errors
    /// An unwritable folder.
    pub fn write_block(
        &self,
        block: u64,
        rows: &[Row],
        campaign: &Campaign,
        stamp: &CampaignStamp,
    ) -> Result<(), CampaignError> {
        let (name, bytes) = encode_block(block, rows, campaign, stamp)?;
        Ok(atomic::write(&self.file(BLOCKS).join(name), bytes)?)
    }

    /// Removes the blocks once their rows are in the table.
    ///
    /// # Errors
    /// An unwritable folder.
    pub fn remove_blocks(&self) -> Result<(), OutputError> {
        let folder = self.file(BLOCKS);
        match fs::remove_dir_all(&folder) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                Err(OutputError::new(folder, error))
            }
            _ => Ok(()),
        }
    }
}

/// A finished block as a file: its name, which holds the checksum, and its bytes.
///
/// # Errors
/// Rows that do not fit into a table.
pub fn encode_block(
    block: u64,
    rows: &[Row],
    campaign: &Campaign,
    stamp: &CampaignStamp,
) -> Result<(String, Vec<u8>), CampaignError> {
    let bytes = TableWriter::new(Vec::new(), campaign, stamp)
        .and_then(|mut table| {
            table.write(rows, campaign)?;
            table.finish()
        })
        .map_err(|error| {
            CampaignError::Other(format!("block {block} cannot be written: {error}"))
        })?;
    let checksum = fingerprint(&bytes);
    let name = format!("block-{block:08}-{}.parquet", &checksum[..CHECKSUM_DIGITS]);
    Ok((name, bytes))
}

/// The number of a block by the name of its file; `None` for other files.
pub fn number_of(name: &str) -> Option<u64> {
    let (number, checksum) = name
        .strip_prefix("block-")?
        .strip_suffix(".parquet")?
        .split_once('-')?;
    (checksum.len() == CHECKSUM_DIGITS).then(|| number.parse().ok())?
}

/// Reads a block and verifies its bytes.
///
/// # Errors
/// An unreadable or damaged block.
pub fn read_block(path: &Path, block: u64, campaign: &Campaign) -> Result<Vec<Row>, CampaignError> {
    let bytes = read_bytes(path)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if !name.ends_with(&format!(
        "-{}.parquet",
        &fingerprint(&bytes)[..CHECKSUM_DIGITS]
    )) {
        return Err(InputError::in_file(
            path,
            "is damaged: its checksum is not the one in its name; take it away and --resume flies it again",
        )
        .into());
    }
    let mut rows = Vec::new();
    reading::read(bytes::Bytes::from(bytes), campaign, |mut group| {
        rows.append(&mut group);
        Ok::<_, ParquetError>(())
    })
    .map_err(|error| reading::unusable(path, &error))?;
    let expected = campaign.configuration.range_of(block);
    let each = campaign.policies.len() as u64;
    let in_place =
        |(index, row): (usize, &Row)| row.encounter == expected.start + index as u64 / each;
    if rows.len() as u64 != (expected.end - expected.start) * each
        || !rows.iter().enumerate().all(in_place)
    {
        return Err(InputError::in_file(path, format!("does not hold block {block}")).into());
    }
    Ok(rows)
}
