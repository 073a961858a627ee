//! The loop over the blocks of a campaign.

use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;

use super::flight::Flyer;
use super::folder::{Manifest, read_block};
use super::{Campaign, CampaignError, Flown, Folder, Quantiles, Row, Shard, Stamp};

/// What is to be done in which folder.
#[derive(Debug)]
pub struct Task<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// Which part of it.
    pub shard: Shard,
    /// What made the results.
    pub stamp: Stamp,
    /// Where results go.
    pub folder: Folder,
    /// Whether results that are there are gone on with.
    pub resume: bool,
}

/// How far the work is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Encounters in finished blocks.
    pub done: u64,
    /// Of these, those that were there before.
    pub before: u64,
    /// Encounters of this part.
    pub total: u64,
    /// Seconds since the first block began.
    pub elapsed_s: f64,
}

/// How long decisions took, of one policy.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct DecisionTimes {
    /// Encounters flown.
    pub encounters: u64,
    /// Decisions made.
    pub decisions: u64,
    /// Medians of the encounters, microseconds.
    pub median_us: Quantiles,
    /// Longest one, nanoseconds.
    pub max_ns: u64,
    /// Time of all flights together, nanoseconds.
    pub flight_ns: u64,
}

impl DecisionTimes {
    fn take(&mut self, flown: &Flown) {
        self.encounters += 1;
        self.decisions += flown.decisions;
        self.median_us
            .take(flown.decision_median_ns as f64 / 1000.0);
        self.max_ns = self.max_ns.max(flown.decision_max_ns);
        self.flight_ns += flown.flight_ns;
    }
}

impl Task<'_> {
    /// The manifest of the folder.
    pub fn manifest(&self) -> Manifest {
        Manifest {
            configuration_hash: self.campaign.hash.clone(),
            stamp: self.stamp.clone(),
            shard: self.shard,
            configuration: self.campaign.configuration.clone(),
        }
    }
}

/// Flies every block that is not there yet, on the threads of the current pool.
///
/// `go_on` is asked now and then; once it says no, the running block is dropped and the finished
/// ones stay. `show` is told of every finished block. Gives the decision times of each policy,
/// of the encounters that were flown now.
///
/// # Errors
/// A folder of another campaign, a damaged block, an output that cannot be written, or
/// [`CampaignError::Stopped`].
pub fn run(
    task: &Task<'_>,
    go_on: &(impl Fn() -> bool + Sync),
    show: &mut dyn FnMut(&Progress),
) -> Result<Vec<DecisionTimes>, CampaignError> {
    let campaign = task.campaign;
    let configuration = &campaign.configuration;
    task.folder.open(&task.manifest(), task.resume)?;
    let finished = task.folder.blocks()?;
    let size = |block: u64| {
        let range = configuration.range_of(block);
        range.end - range.start
    };
    let mut progress = Progress {
        done: 0,
        before: 0,
        total: (0..configuration.blocks())
            .filter(|b| task.shard.has(*b))
            .map(size)
            .sum(),
        elapsed_s: 0.0,
    };
    for (block, path) in &finished {
        check(*block, path, task)?;
        progress.done += size(*block);
    }
    progress.before = progress.done;
    let mut times = vec![DecisionTimes::default(); campaign.policies.len()];
    let begun = Instant::now();
    // Settings are checked once here; the same ones fly every encounter.
    Flyer::new(campaign)?;
    for block in (0..configuration.blocks()).filter(|block| task.shard.has(*block)) {
        if finished.contains_key(&block) {
            continue;
        }
        let Some(flown) = fly_block(campaign, configuration.range_of(block), go_on)? else {
            return Err(CampaignError::Stopped {
                done: progress.done,
                total: progress.total,
            });
        };
        for flown in &flown {
            if let Some(times) = times.get_mut(flown.row.policy as usize) {
                times.take(flown);
            }
        }
        let rows: Vec<Row> = flown.iter().map(|flown| flown.row).collect();
        task.folder
            .write_block(block, &rows, campaign, &task.stamp)?;
        progress.done += size(block);
        progress.elapsed_s = begun.elapsed().as_secs_f64();
        show(&progress);
    }
    Ok(times)
}

/// Whether a block that is there belongs here and is still what was written.
fn check(block: u64, path: &Path, task: &Task<'_>) -> Result<(), CampaignError> {
    if block >= task.campaign.configuration.blocks() || !task.shard.has(block) {
        return Err(CampaignError::Other(format!(
            "{}: block {block} does not belong to part {}/{} of this campaign",
            path.display(),
            task.shard.number,
            task.shard.of
        )));
    }
    read_block(path, block, task.campaign).map(drop)
}

/// Flies the encounters of a block; `None` where it was stopped.
fn fly_block(
    campaign: &Campaign,
    range: core::ops::Range<u64>,
    go_on: &(impl Fn() -> bool + Sync),
) -> Result<Option<Vec<Flown>>, CampaignError> {
    let flown: Vec<Vec<Flown>> = range
        .into_par_iter()
        .map_init(
            || Flyer::new(campaign),
            |flyer, number| {
                let mut flown = Vec::with_capacity(campaign.policies.len());
                if go_on() {
                    match flyer {
                        Ok(flyer) => flyer.fly(number, &mut flown)?,
                        Err(error) => return Err(CampaignError::Other(error.to_string())),
                    }
                }
                Ok(flown)
            },
        )
        .collect::<Result<_, _>>()?;
    let complete = flown.iter().all(|rows| !rows.is_empty());
    Ok(complete.then(|| flown.into_iter().flatten().collect()))
}
