//! Campaigns: many drawn encounters, each flown by several policies, with results that are the
//! same to the byte on any number of threads and shards and after any interruption.
//!
//! Numbers of encounters run from 0 over the whole campaign. Encounters of files come first, in their
//! order; after them the cells take turns, so a longer campaign begins with the shorter one. A
//! number gives the cell, the master seed and the random stream, so each encounter can be drawn
//! and flown alone. Work goes in blocks of encounters. Each finished block is a separate file
//! with its checksum in the name; the last step merges them into `results.parquet`.
//!
//! | question | answer |
//! |---|---|
//! | what does a campaign file contain? | [`mod@file`] |
//! | what determines one campaign? | [`CampaignConfiguration`], [`Campaign`] |
//! | which models does it draw from? | [`sources`] |
//! | what does the ownship know of the others? | [`sensors`](fga_files::sensors) |
//! | which recordings does it fly? | [`crate::recorded`] |
//! | what is the result of one flown encounter? | [`Row`], [`metrics`] |
//! | how do files hold rows? | [`table`] |
//! | what is in a folder of results? | [`folder`] |
//! | which rows does a folder hold? | [`RowFiles`] |
//! | who flies them? | [`run()`], [`merge()`] |
//! | what do the rows show together? | [`Totals`], [`risk`] |

pub mod configuration;
mod error;
mod expected;
pub mod file;
pub mod flight;
pub mod folder;
mod interval;
mod judge;
pub mod merge;
pub mod metrics;
mod opened;
pub mod reading;
pub mod risk;
pub mod row;
pub mod rows;
pub mod run;
mod show;
pub mod sources;
mod stamp;
pub mod table;
mod tail;
pub mod totals;

pub use configuration::{
    CampaignConfiguration, MOST_ENCOUNTERS, own_sha256, parse_policy, policy_called,
};
pub use error::CampaignError;
pub use expected::Expected;
pub use flight::{CampaignFlyer, TimedRow};
pub use folder::{Folder, Manifest, RESULTS, Shard};
pub use interval::Interval;
pub use judge::{FlownPath, metrics_of};
pub use merge::{Assembled, assemble, merge, reread};
pub use opened::{Campaign, CampaignScene, Drawn};
pub use row::Row;
pub use rows::RowFiles;
pub use run::{CampaignProgress, CampaignTask, PolicyTimes, run};
pub use stamp::CampaignStamp;
pub use tail::Tail;
pub use totals::{Quantiles, Summary, Totals};
