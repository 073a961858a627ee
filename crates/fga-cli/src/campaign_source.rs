//! Which campaign a command means.

use std::path::PathBuf;

use clap::Args;
use fga_campaign::campaign::file::Overrides;

/// Sources of encounters, besides the file.
#[derive(Args, Debug)]
pub(crate) struct SourceArgs {
    /// A recording or a folder of recordings, besides those in the campaign file; may be given several times.
    #[arg(long, value_name = "PATH")]
    pub(crate) recordings: Vec<PathBuf>,
    /// The file of every [[model]], instead of the one in the campaign file.
    #[arg(long, value_name = "FILE")]
    pub(crate) model: Option<PathBuf>,
}

impl SourceArgs {
    /// Options that override the campaign file.
    pub(crate) fn overrides(&self) -> Overrides {
        Overrides {
            recordings: self.recordings.clone(),
            model: self.model.clone(),
            ..Overrides::default()
        }
    }
}
