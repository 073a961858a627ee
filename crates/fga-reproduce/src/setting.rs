//! What is reproduced where, and what may stop it.

use std::path::{Path, PathBuf};

use fga_campaign::campaign::CampaignError;
use fga_formats::{InputError, OutputError};

/// What to reproduce, and where to.
pub struct Setting<'a> {
    /// Number of encounters for each point of a curve.
    pub encounters: u64,
    /// Master seed.
    pub seed: u64,
    /// Folder of the report; its data files are in `data`.
    pub folder: &'a Path,
    /// Receives the name of each part before the part begins.
    pub announce: &'a (dyn Fn(&str) + Sync),
    /// Whether to go on.
    pub goes_on: &'a (dyn Fn() -> bool + Sync),
}

/// Why the evaluation was not reproduced.
#[derive(Debug)]
pub enum ReproduceError {
    /// A setting or an input cannot be used.
    Input(String),
    /// A file cannot be written.
    Output(OutputError),
    /// [`Setting::goes_on`] said no.
    Stopped,
}

impl core::fmt::Display for ReproduceError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Input(message) => f.write_str(message),
            Self::Output(error) => write!(f, "{error}"),
            Self::Stopped => f.write_str("interrupted"),
        }
    }
}

impl core::error::Error for ReproduceError {}

impl From<InputError> for ReproduceError {
    fn from(error: InputError) -> Self {
        Self::of(&error)
    }
}

impl From<OutputError> for ReproduceError {
    fn from(error: OutputError) -> Self {
        Self::Output(error)
    }
}

impl From<CampaignError> for ReproduceError {
    fn from(error: CampaignError) -> Self {
        match error {
            CampaignError::Output(error) => Self::Output(error),
            other => Self::of(&other),
        }
    }
}

impl ReproduceError {
    /// An input error, in its words.
    pub(crate) fn of(error: &impl core::fmt::Display) -> Self {
        Self::Input(error.to_string())
    }
}

impl Setting<'_> {
    /// Announces the next section, unless it is time to stop.
    pub(crate) fn begin(&self, what: &str) -> Result<(), ReproduceError> {
        if !(self.goes_on)() {
            return Err(ReproduceError::Stopped);
        }
        (self.announce)(what);
        Ok(())
    }

    /// Folder of the data files.
    pub(crate) fn data(&self) -> PathBuf {
        self.folder.join("data")
    }
}
