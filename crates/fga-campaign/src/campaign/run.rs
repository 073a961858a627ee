//! The loop over the encounters of a campaign.
//!
//! Every thread takes the next few encounters, in their order, until none are left. The thread that
//! flies the last one of a block writes the block, while the others go on: no thread waits for another,
//! neither at the end of a block nor for the disk. Memory holds at most one block more than there are
//! threads.

use alloc::collections::BTreeMap;
use core::sync::atomic::{AtomicU64, Ordering};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::expected::{Expected, FlownSample, expect};
use super::flight::CampaignFlyer;
use super::folder::{Manifest, read_block};
use super::{Campaign, CampaignError, CampaignStamp, Folder, Quantiles, Row, Shard, TimedRow};

/// The work and its folder.
#[derive(Debug)]
pub struct CampaignTask<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// The part to fly.
    pub shard: Shard,
    /// Origin of the results.
    pub stamp: CampaignStamp,
    /// Folder of the results.
    pub folder: Folder,
    /// Whether to continue with existing results.
    pub resume: bool,
    /// Whether a sample is flown first, which shows the expected duration.
    pub is_expected: bool,
    /// Whether a stop flies the blocks that are begun to their end.
    pub ends_begun: bool,
}

/// The progress of the work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CampaignProgress {
    /// Encounters in finished blocks.
    pub done: u64,
    /// Of these, the ones from earlier runs.
    pub before: u64,
    /// Encounters of this part.
    pub total: u64,
    /// Seconds since the first flight began.
    pub elapsed_s: f64,
    /// What flying those that are not done when the run begins probably takes; unknown for a few or without a sample.
    pub expected: Option<Expected>,
}

/// Durations of the decisions of one policy.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PolicyTimes {
    /// Encounters flown.
    pub encounters: u64,
    /// Number of decisions.
    pub decisions: u64,
    /// Medians of the encounters, microseconds.
    pub median_us: Quantiles,
    /// Longest one, nanoseconds.
    pub max_ns: u64,
    /// Duration of all flights together, nanoseconds.
    pub flight_ns: u64,
}

impl PolicyTimes {
    fn take(&mut self, flown: &TimedRow) {
        self.encounters += 1;
        self.decisions += flown.decisions;
        self.median_us
            .take(flown.decision_median_ns as f64 / 1000.0);
        self.max_ns = self.max_ns.max(flown.decision_max_ns);
        self.flight_ns += flown.flight_ns;
    }
}

impl CampaignTask<'_> {
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

/// Encounters that a thread takes at once.
const TAKEN: u64 = 4;

/// Flies every missing block, on the threads of the current pool.
///
/// Calls `go_on` now and then; once it returns false, finished blocks stay, and running ones are dropped, or flown to their
/// end with [`CampaignTask::ends_begun`], unless drawing an encounter takes long; the first missing block counts as begun. `show` gets the expected duration before the first block, and every finished block. Returns the durations of
/// the decisions of each policy, for the encounters of this run.
///
/// # Errors
/// A folder of another campaign, a damaged block, an unwritable output, or
/// [`CampaignError::Stopped`].
pub fn run(
    task: &CampaignTask<'_>,
    go_on: &(impl Fn() -> bool + Sync),
    show: &mut (dyn FnMut(&CampaignProgress) + Send),
) -> Result<Vec<PolicyTimes>, CampaignError> {
    let campaign = task.campaign;
    let configuration = &campaign.configuration;
    task.folder.open(&task.manifest(), task.resume)?;
    let finished = task.folder.blocks()?;
    let size = |block: u64| {
        let range = configuration.range_of(block);
        range.end - range.start
    };
    let mut progress = CampaignProgress {
        done: 0,
        before: 0,
        total: (0..configuration.blocks())
            .filter(|b| task.shard.has(*b))
            .map(size)
            .sum(),
        elapsed_s: 0.0,
        expected: None,
    };
    for (block, path) in &finished {
        check(*block, path, task)?;
        progress.done += size(*block);
    }
    progress.before = progress.done;
    // Checks the settings once; the same ones fly every encounter.
    CampaignFlyer::new(campaign)?;
    let blocks: Vec<u64> = (0..configuration.blocks())
        .filter(|block| task.shard.has(*block) && !finished.contains_key(block))
        .collect();
    let begun = Instant::now();
    let mut sample = FlownSample::new();
    if task.is_expected {
        let left = progress.total - progress.done;
        (progress.expected, sample) = expect(campaign, &blocks, left, go_on)?;
    }
    show(&progress);
    let work = RunWork {
        task,
        blocks,
        sample,
        next: AtomicU64::new(0),
        end: AtomicU64::new(u64::MAX),
        begun,
        state: Mutex::new(WorkState {
            running: BTreeMap::new(),
            times: vec![PolicyTimes::default(); campaign.policies.len()],
            progress,
            show,
            error: None,
        }),
    };
    rayon::broadcast(|_| work.go_through(go_on));
    let state = work
        .state
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner);
    match state.error {
        Some(error) => Err(error),
        None if state.progress.done < state.progress.total => Err(CampaignError::Stopped {
            done: state.progress.done,
            total: state.progress.total,
        }),
        None => Ok(state.times),
    }
}

/// The remaining work and the progress.
struct RunWork<'a> {
    task: &'a CampaignTask<'a>,
    /// Numbers of the blocks to be flown.
    blocks: Vec<u64>,
    /// What was flown for the expected duration.
    sample: FlownSample,
    /// The next encounters to take, counted over these blocks in portions of [`TAKEN`].
    next: AtomicU64,
    /// The first of these blocks that is not begun any more after a stop.
    end: AtomicU64,
    begun: Instant,
    state: Mutex<WorkState<'a>>,
}

struct WorkState<'a> {
    /// Flown encounters of unfinished blocks.
    running: BTreeMap<u64, BTreeMap<u64, Vec<TimedRow>>>,
    times: Vec<PolicyTimes>,
    progress: CampaignProgress,
    show: &'a mut (dyn FnMut(&CampaignProgress) + Send),
    /// The first error.
    error: Option<CampaignError>,
}

impl<'a> RunWork<'a> {
    fn state(&self) -> MutexGuard<'_, WorkState<'a>> {
        // A panic of a thread ends the program.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next encounters to fly and their block.
    fn take(&self, go_on: &impl Fn() -> bool) -> Option<(u64, core::ops::Range<u64>)> {
        let configuration = &self.task.campaign.configuration;
        let portions = configuration.block.div_ceil(TAKEN);
        loop {
            let taken = self.next.fetch_add(1, Ordering::Relaxed);
            let index = taken / portions;
            if taken.is_multiple_of(portions) && index > 0 && !go_on() {
                self.end.fetch_min(index, Ordering::Relaxed);
            }
            if index >= self.end.load(Ordering::Relaxed) {
                return None;
            }
            let index = usize::try_from(index).ok()?;
            let block = *self.blocks.get(index)?;
            let range = configuration.range_of(block);
            let first = range.start + taken % portions * TAKEN;
            // The last block may be a short one.
            if first < range.end {
                return Some((block, first..(first + TAKEN).min(range.end)));
            }
        }
    }

    /// Flies on until nothing is left, a stop or an error.
    fn go_through(&self, go_on: &(impl Fn() -> bool + Sync)) {
        if let Err(error) = self.try_to_go_through(go_on) {
            // A stop is said with what is done.
            if !matches!(error, CampaignError::Stopped { .. }) {
                self.state().error.get_or_insert(error);
            }
            // Nobody begins anything more.
            self.next.store(u64::MAX / 2, Ordering::Relaxed);
        }
    }

    fn try_to_go_through(&self, go_on: &(impl Fn() -> bool + Sync)) -> Result<(), CampaignError> {
        let mut flyer = CampaignFlyer::new(self.task.campaign)?;
        while let Some((block, numbers)) = self.take(go_on) {
            let mut flown = Vec::with_capacity(numbers.clone().count());
            for number in numbers {
                if !self.task.ends_begun && !go_on() {
                    return Ok(());
                }
                let mut rows = self.sample.get(&number).cloned().unwrap_or_default();
                if rows.is_empty() {
                    flyer.fly_while(number, &mut rows, go_on)?;
                }
                flown.push((number, rows));
            }
            if let Some(rows) = self.add(block, flown) {
                self.write(block, &rows)?;
            }
        }
        Ok(())
    }

    /// Adds encounters to their block; all of its rows in order once it is whole.
    fn add(&self, block: u64, flown: Vec<(u64, Vec<TimedRow>)>) -> Option<Vec<TimedRow>> {
        let range = self.task.campaign.configuration.range_of(block);
        let mut state = self.state();
        let running = state.running.entry(block).or_default();
        running.extend(flown);
        if running.len() as u64 != range.end - range.start {
            return None;
        }
        let whole = state.running.remove(&block)?;
        Some(whole.into_values().flatten().collect())
    }

    fn write(&self, block: u64, flown: &[TimedRow]) -> Result<(), CampaignError> {
        let task = self.task;
        let rows: Vec<Row> = flown.iter().map(|flown| flown.row).collect();
        task.folder
            .write_block(block, &rows, task.campaign, &task.stamp)?;
        let range = task.campaign.configuration.range_of(block);
        let mut state = self.state();
        for flown in flown {
            if let Some(times) = state.times.get_mut(flown.row.policy as usize) {
                times.take(flown);
            }
        }
        state.progress.done += range.end - range.start;
        state.progress.elapsed_s = self.begun.elapsed().as_secs_f64();
        let progress = state.progress;
        (state.show)(&progress);
        Ok(())
    }
}

/// Whether an existing block belongs here and is undamaged.
fn check(block: u64, path: &Path, task: &CampaignTask<'_>) -> Result<(), CampaignError> {
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
