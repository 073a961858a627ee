//! What a league flies.

use std::path::PathBuf;

use fga_sim::own::OwnPolicy;

/// What a league flies.
#[derive(Debug, Clone, Default)]
pub struct Terms {
    /// Sets: names of shipped ones, or paths of campaign files; without any, all shipped ones whose data are there.
    pub sets: Vec<String>,
    /// Policies by their names on the command line, or of `own`; without any, [`POLICIES`](super::POLICIES).
    pub policies: Vec<String>,
    /// Policies by which intruders with tracks react, besides `none`, which is always flown: they fly their tracks;
    /// `itself` for the policy of the ownship.
    pub intruders: Vec<String>,
    /// Policies outside of this program.
    pub own: Vec<OwnPolicy>,
    /// Folder of third-party data, with `flown` and `encounter-models`.
    pub data: Option<PathBuf>,
    /// Encounters of each set that draws them; without it the set's number.
    pub encounters: Option<u64>,
    /// Worst encounters of each policy in each set with a replay.
    pub worst: usize,
}
