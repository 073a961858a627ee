//! Which build made some results.

use fga_formats::build;
use serde::{Deserialize, Serialize};

/// Origin of the results, besides the configuration.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CampaignStamp {
    /// The target of the build.
    pub target: String,
    /// The commit of the build.
    #[serde(default = "unknown")]
    pub commit: String,
}

/// The commit in manifests that do not name it.
fn unknown() -> String {
    build::UNKNOWN.into()
}

impl CampaignStamp {
    /// The stamp of this program, built for `target`.
    pub fn of_this_build(target: &str) -> Self {
        Self {
            target: target.into(),
            commit: build::commit().into(),
        }
    }
}

impl core::fmt::Display for CampaignStamp {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{} by commit {}", self.target, self.commit)
    }
}
