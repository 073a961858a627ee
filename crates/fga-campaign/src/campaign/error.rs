//! What can go wrong with a campaign.

use fga::avoider::SettingsError;
use fga_formats::{InputError, OutputError};

/// Reasons why a campaign cannot be flown or read.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// An unusable file.
    #[error(transparent)]
    Input(#[from] InputError),
    /// An unwritable file.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Settings or limits that the core refuses.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// Anything else, as one sentence.
    #[error("{0}")]
    Other(String),
    /// Stopped on request; finished blocks stay.
    #[error("stopped after {done} of {total} encounters; --resume goes on from there")]
    Stopped {
        /// Encounters in finished blocks.
        done: u64,
        /// Encounters of this folder.
        total: u64,
    },
}
