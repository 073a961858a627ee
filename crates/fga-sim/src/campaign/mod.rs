//! Campaigns: many drawn encounters, each flown by several policies, with results that are the
//! same to the byte on any number of threads and shards and after any interruption.
//!
//! Encounters are numbered from 0 over the whole campaign. Those of files come first, in their
//! order; after them the cells take turns, so a longer campaign begins with the shorter one. A
//! number gives the cell, the master seed and the random stream, so each encounter can be drawn
//! and flown alone. Work goes in blocks of encounters. Each finished block is a file of its own
//! whose name holds its checksum; the last step puts them together into `results.parquet`.
//!
//! | question | answer |
//! |---|---|
//! | what does a campaign file ask for? | [`mod@file`] |
//! | what is one campaign exactly? | [`Configuration`], [`Campaign`] |
//! | which recordings and models does it draw from? | [`sources`] |
//! | what is known of one encounter flown? | [`Row`], [`metrics`] |
//! | how are rows kept? | [`table`] |
//! | what is in a folder of results? | [`folder`] |
//! | which rows does a folder hold? | [`RowFiles`] |
//! | who flies them? | [`run()`], [`merge()`] |
//! | what do they say together? | [`Totals`], [`risk`] |

pub mod configuration;
pub mod file;
pub mod flight;
pub mod folder;
mod judge;
pub mod merge;
pub mod metrics;
pub mod risk;
pub mod rows;
pub mod run;
mod show;
pub mod sources;
pub mod table;
pub mod totals;

pub use configuration::{Campaign, Configuration, Drawn, Scene, parse_policy};
pub use flight::{Flown, Flyer, Row};
pub use folder::{Folder, Manifest, RESULTS, Shard, Stamp};
pub use merge::{Assembled, assemble, merge, reread};
pub use rows::RowFiles;
pub use run::{DecisionTimes, Progress, Task, run};
pub use totals::{Quantiles, Summary, Totals};

use fga::avoider::SettingsError;
use fga_formats::{InputError, OutputError};

/// Why a campaign cannot be flown or read.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// A file that cannot be used.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A file that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Settings or limits that the core refuses.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// Anything else, as one sentence.
    #[error("{0}")]
    Other(String),
    /// Stopped on request; finished blocks are kept.
    #[error("stopped after {done} of {total} encounters; --resume goes on from there")]
    Stopped {
        /// Encounters in finished blocks.
        done: u64,
        /// Encounters of this folder.
        total: u64,
    },
}
