//! The rows of a folder of results, complete or not.

use std::fs::File;
use std::path::PathBuf;

use fga_formats::InputError;
use parquet::errors::ParquetError;

use super::folder::read_block;
use super::{Campaign, CampaignError, Folder, RESULTS, Row, reading};

/// The files with the rows of a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RowFiles {
    /// The table of all rows: the campaign is complete.
    Table(PathBuf),
    /// The finished blocks with their numbers: the campaign is running, or the folder holds a part.
    Blocks(Vec<(u64, PathBuf)>),
}

impl RowFiles {
    /// The files of a folder.
    ///
    /// # Errors
    /// An unreadable folder.
    pub fn of(folder: &Folder) -> Result<Self, CampaignError> {
        let table = folder.file(RESULTS);
        Ok(if table.is_file() {
            Self::Table(table)
        } else {
            Self::Blocks(folder.blocks()?.into_iter().collect())
        })
    }

    /// Reads the rows by encounter, and within an encounter by policy.
    ///
    /// # Errors
    /// A file that is damaged or of another campaign.
    pub fn read(
        &self,
        campaign: &Campaign,
        mut take: impl FnMut(&Row),
    ) -> Result<(), CampaignError> {
        match self {
            Self::Table(path) => {
                let file =
                    File::open(path).map_err(|error| InputError::unreadable(path, &error))?;
                reading::read(file, campaign, |rows| {
                    rows.iter().for_each(&mut take);
                    Ok::<_, ParquetError>(())
                })
                .map_err(|error| reading::unusable(path, &error))?;
            }
            Self::Blocks(blocks) => {
                for (block, path) in blocks {
                    read_block(path, *block, campaign)?
                        .iter()
                        .for_each(&mut take);
                }
            }
        }
        Ok(())
    }
}
