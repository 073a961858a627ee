//! Merges blocks into one table, from one folder or from the parts of a campaign.

use alloc::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use fga_formats::atomic::AtomicFile;
use fga_formats::{InputError, OutputError};
use fga_sim::fingerprint::hexadecimal;
use parquet::errors::ParquetError;
use sha2::{Digest as _, Sha256};

use super::folder::{Manifest, RESULTS, read_block};
use super::reading;
use super::table::{self, TableWriter};
use super::totals::Summary;
use super::{Campaign, CampaignError, CampaignStamp, Folder, Shard};

/// The finished table.
#[derive(Debug)]
pub struct Assembled {
    /// Totals of all rows.
    pub summary: Summary,
    /// SHA-256 of `results.parquet`.
    pub sha256: String,
    table: Option<AtomicFile>,
    csv: Option<AtomicFile>,
}

impl Assembled {
    /// Gives the files their names: the last step, after all other writes.
    ///
    /// # Errors
    /// An unwritable folder.
    pub fn commit(&mut self) -> Result<(), OutputError> {
        if let Some(csv) = self.csv.take() {
            csv.commit()?;
        }
        self.table.take().map_or(Ok(()), AtomicFile::commit)
    }
}

/// Writes and hashes.
struct Hashing<W> {
    inner: W,
    hash: Sha256,
}

impl<W: Write> Write for Hashing<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.hash.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

/// The table exists already: verifies it and sums it up.
///
/// # Errors
/// A table that is damaged or of another campaign.
pub fn reread(
    folder: &Folder,
    campaign: &Campaign,
    sha256: Option<&str>,
) -> Result<Assembled, CampaignError> {
    let path = folder.file(RESULTS);
    let unreadable = |error: io::Error| InputError::unreadable(&path, &error);
    let mut file = File::open(&path).map_err(unreadable)?;
    let mut hashing = Hashing {
        inner: io::sink(),
        hash: Sha256::new(),
    };
    io::copy(&mut file, &mut hashing).map_err(unreadable)?;
    let found = hexadecimal(&hashing.hash.finalize());
    if sha256.is_some_and(|expected| expected != found) {
        let message = "is damaged: its checksum is not the one in run.json; take it away and fly the campaign again";
        return Err(InputError::in_file(&path, message).into());
    }
    let mut summary = Summary::default();
    reading::read(file, campaign, |rows| {
        for row in &rows {
            summary.take(row);
        }
        Ok::<_, ParquetError>(())
    })
    .map_err(|error| reading::unusable(&path, &error))?;
    Ok(Assembled {
        summary,
        sha256: found,
        table: None,
        csv: None,
    })
}

/// Merges blocks into `results.parquet` of `folder`, and on request into `results.csv`.
/// [`Assembled::commit`] gives the files their names.
///
/// # Errors
/// A missing or damaged block, or an unwritable output.
pub fn assemble(
    blocks: &BTreeMap<u64, PathBuf>,
    campaign: &Campaign,
    stamp: &CampaignStamp,
    folder: &Folder,
    csv: bool,
) -> Result<Assembled, CampaignError> {
    complete(blocks, campaign)?;
    let path = folder.file(RESULTS);
    let failed = |error: ParquetError| {
        let source = match error {
            ParquetError::External(error) => match error.downcast::<io::Error>() {
                Ok(error) => *error,
                Err(error) => io::Error::other(error),
            },
            other => io::Error::other(other),
        };
        CampaignError::Output(OutputError::new(&path, source))
    };
    let output = Hashing {
        inner: AtomicFile::create(&path)?,
        hash: Sha256::new(),
    };
    let mut table = TableWriter::new(output, campaign, stamp).map_err(failed)?;
    let csv_path = folder.file("results.csv");
    let csv_failed = |error| OutputError::new(&csv_path, error);
    let mut csv = csv.then(|| AtomicFile::create(&csv_path)).transpose()?;
    if let Some(csv) = &mut csv {
        writeln!(csv, "{}", table::csv_columns(campaign)).map_err(csv_failed)?;
    }
    let mut summary = Summary::default();
    let mut line = Vec::new();
    for (block, path) in blocks {
        let rows = read_block(path, *block, campaign)?;
        table.write(&rows, campaign).map_err(failed)?;
        for row in &rows {
            summary.take(row);
            if let Some(csv) = &mut csv {
                line.clear();
                table::push_csv(&mut line, row, campaign);
                csv.write_all(&line).map_err(csv_failed)?;
            }
        }
    }
    let output = table.finish().map_err(failed)?;
    Ok(Assembled {
        summary,
        sha256: hexadecimal(&output.hash.finalize()),
        table: Some(output.inner),
        csv,
    })
}

/// Whether every block is there.
fn complete(blocks: &BTreeMap<u64, PathBuf>, campaign: &Campaign) -> Result<(), CampaignError> {
    let all = campaign.configuration.blocks();
    let missing: Vec<u64> = (0..all)
        .filter(|block| !blocks.contains_key(block))
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    let mut shown: Vec<String> = missing.iter().take(8).map(u64::to_string).collect();
    let more = missing.len() - shown.len();
    if let Some(last) = shown.last_mut().filter(|_| more > 0) {
        *last = format!("{last} and {more} more");
    }
    let are = if missing.len() == 1 { "is" } else { "are" };
    Err(CampaignError::Other(format!(
        "the campaign is not complete: of its {all} blocks {} {are} missing ({})",
        missing.len(),
        shown.join(", ")
    )))
}

/// The campaign and the blocks of several folders, each block once.
#[derive(Debug)]
pub struct MergedParts {
    /// The common manifest, of the whole campaign.
    pub manifest: Manifest,
    /// The campaign.
    pub campaign: Campaign,
    /// The blocks.
    pub blocks: BTreeMap<u64, PathBuf>,
}

/// Opens the folders of the parts of a campaign.
///
/// # Errors
/// A folder that holds no campaign or another one, or a block that appears twice.
pub fn merge(folders: &[PathBuf]) -> Result<MergedParts, CampaignError> {
    let mut found: Option<(Manifest, &Path)> = None;
    let mut blocks: BTreeMap<u64, PathBuf> = BTreeMap::new();
    for path in folders {
        let folder = Folder::at(path);
        let Some(manifest) = folder.manifest()? else {
            let message = "holds no campaign, expected a folder that fga campaign run wrote";
            return Err(InputError::in_file(path, message).into());
        };
        if let Some((first, at)) = &found {
            if first.configuration_hash != manifest.configuration_hash {
                let differences = first.configuration.differences(&manifest.configuration);
                return Err(InputError::in_file(
                    path,
                    format!(
                        "holds another campaign than {} (differs in {})",
                        at.display(),
                        differences.join(", ")
                    ),
                )
                .into());
            }
            if first.stamp != manifest.stamp {
                return Err(InputError::in_file(
                    path,
                    format!(
                        "was made on {}, and {} on {}",
                        manifest.stamp,
                        at.display(),
                        first.stamp
                    ),
                )
                .into());
            }
        } else {
            let whole = Manifest {
                shard: Shard::WHOLE,
                ..manifest
            };
            found = Some((whole, path));
        }
        if folder.file(RESULTS).exists() {
            let message = "is complete already, expected parts of a campaign";
            return Err(InputError::in_file(path, message).into());
        }
        for (block, file) in folder.blocks()? {
            if let Some(other) = blocks.insert(block, file.clone()) {
                return Err(InputError::in_file(
                    file,
                    format!("appears twice: {} holds the same block", other.display()),
                )
                .into());
            }
        }
    }
    let Some((manifest, path)) = found else {
        return Err(CampaignError::Other(
            "no folder was named, expected at least one".into(),
        ));
    };
    let campaign = Campaign::new(manifest.configuration.clone(), path)?;
    complete(&blocks, &campaign)?;
    Ok(MergedParts {
        manifest,
        campaign,
        blocks,
    })
}
