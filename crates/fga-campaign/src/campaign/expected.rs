//! The expected duration of a campaign, before it is flown.
//!
//! The campaign flies a small sample of what is left first, on the same threads. It keeps the sample's rows and flies no
//! encounter twice. The sample is spread over all encounters, so that a campaign that grows harder towards its end is
//! not underestimated.

use alloc::collections::BTreeMap;
use core::sync::atomic::{AtomicU64, Ordering};
use core::time::Duration;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use super::flight::CampaignFlyer;
use super::{Campaign, CampaignError, TimedRow};

/// The sample is at most one in this many encounters.
const ONE_IN: u64 = 50;

/// Largest sample.
const LARGEST_SAMPLE: u64 = 256;

/// No encounter of the sample begins later than this.
const SAMPLING_TIME: Duration = Duration::from_secs(2);

/// 2⁶⁴ over the golden ratio: its multiples spread evenly over the circle, however many there are.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// What flying the rest of a campaign probably takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Encounters of the sample.
    pub sample: u64,
    /// Encounters left to fly.
    pub left: u64,
    /// Threads that fly them.
    pub threads: u64,
    /// Time in flights of all threads together, seconds: the processor time where each thread has a core.
    pub processor_s: f64,
}

impl Expected {
    /// Time until all are flown, seconds.
    pub fn duration_s(&self) -> f64 {
        self.processor_s / self.threads.min(self.left).max(1) as f64
    }
}

/// The rows of flown encounters by their numbers.
pub(super) type FlownSample = BTreeMap<u64, Vec<TimedRow>>;

/// Flies a sample of the encounters in `blocks`, `left` altogether; says nothing where there are too few or where `go_on`
/// ends it.
///
/// # Errors
/// A recording that is gone, or settings that the core refuses.
pub(super) fn expect(
    campaign: &Campaign,
    blocks: &[u64],
    left: u64,
    go_on: &(impl Fn() -> bool + Sync),
) -> Result<(Option<Expected>, FlownSample), CampaignError> {
    let wanted = (left / ONE_IN).min(LARGEST_SAMPLE);
    let (next, begun) = (AtomicU64::new(0), Instant::now());
    // The flown encounters and the time in their flights.
    let sum = Mutex::new(Ok((FlownSample::new(), Duration::ZERO)));
    let fly = || -> Result<(FlownSample, Duration), CampaignError> {
        let mut flyer = CampaignFlyer::new(campaign)?;
        let (mut flown, mut taken) = (FlownSample::new(), Duration::ZERO);
        while begun.elapsed() < SAMPLING_TIME && go_on() {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let number = place(index, left);
            let Some(number) = number_of(campaign, blocks, number).filter(|_| index < wanted)
            else {
                break;
            };
            let takes_off = Instant::now();
            let mut rows = Vec::with_capacity(campaign.policies.len());
            match flyer.fly_while(number, &mut rows, go_on) {
                Err(CampaignError::Stopped { .. }) => break,
                flown => flown?,
            }
            taken += takes_off.elapsed();
            flown.insert(number, rows);
        }
        Ok((flown, taken))
    };
    if wanted > 0 {
        rayon::broadcast(|_| {
            let one = fly();
            let mut sum = sum.lock().unwrap_or_else(PoisonError::into_inner);
            match (&mut *sum, one) {
                (Ok((flown, taken)), Ok((more, time))) => {
                    flown.extend(more);
                    *taken += time;
                }
                (Ok(_), Err(error)) => *sum = Err(error),
                (Err(_), _) => {}
            }
        });
    }
    let (flown, taken) = sum.into_inner().unwrap_or_else(PoisonError::into_inner)?;
    let sample = flown.len() as u64;
    let expected = (sample > 0).then(|| Expected {
        sample,
        left,
        threads: rayon::current_num_threads() as u64,
        processor_s: taken.as_secs_f64() * left as f64 / sample as f64,
    });
    Ok((expected, flown))
}

/// The `index`-th place of a sample of `0..left`.
fn place(index: u64, left: u64) -> u64 {
    let turn = index.wrapping_add(1).wrapping_mul(GOLDEN);
    ((u128::from(turn) * u128::from(left)) >> 64) as u64
}

/// The number of an encounter by its place among those of `blocks`.
fn number_of(campaign: &Campaign, blocks: &[u64], place: u64) -> Option<u64> {
    // Only the last block may be a short one.
    let size = campaign.configuration.block.max(1);
    let block = blocks.get(usize::try_from(place / size).ok()?)?;
    Some(campaign.configuration.range_of(*block).start + place % size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_is_spread_over_what_is_left() {
        for left in [100, 970, 6000, 1_000_003] {
            let count = (left / ONE_IN).min(LARGEST_SAMPLE);
            let mut places: Vec<u64> = (0..count).map(|index| place(index, left)).collect();
            places.sort_unstable();
            // The three-gap theorem: no gap is larger than 2.62 mean ones.
            let mut before = 0;
            for at in places.iter().copied().chain([left]) {
                assert!(at <= left, "{at} of {left}");
                assert!((at - before) as f64 <= 2.62 * left as f64 / count as f64 + 1.0);
                before = at;
            }
            places.dedup();
            assert_eq!(places.len() as u64, count);
        }
    }

    #[test]
    fn the_duration_is_shared_by_the_threads() {
        let expected = Expected {
            sample: 4,
            left: 1000,
            threads: 8,
            processor_s: 80.0,
        };
        assert_eq!(expected.duration_s(), 10.0);
        // Fewer encounters than threads.
        let few = Expected {
            left: 2,
            ..expected
        };
        assert_eq!(few.duration_s(), 40.0);
    }
}
