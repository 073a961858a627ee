//! Keeps a level from flickering: M of N, persistence, and a memory that ends with a gap.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

/// The highest value that at least M of the last N values reach.
///
/// Without M and N every value passes unchanged.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct MOfN<T> {
    m: usize,
    last: VecDeque<T>,
}

impl<T: Copy + Ord> MOfN<T> {
    /// A memory that starts as if it had seen `value` M times, and the least value otherwise.
    pub(crate) fn new(m: usize, n: usize, value: T, least: T) -> Self {
        let mut last = VecDeque::new();
        if m > 0 && m <= n {
            last.resize(m, value);
            last.resize(n, least);
        }
        Self { m, last }
    }

    /// Takes a value and returns the one that counts.
    pub(crate) fn take(&mut self, value: T) -> T {
        if self.last.pop_front().is_some() {
            self.last.push_back(value);
        }
        let mut sorted: Vec<T> = self.last.iter().copied().collect();
        sorted.sort_unstable();
        let highest = sorted.iter().rev().nth(self.m.saturating_sub(1));
        highest.copied().unwrap_or(value)
    }
}

/// Times and counts of the memory of levels.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HysteresisSettings {
    /// A longer gap ends every memory, seconds; 0 for no memory.
    pub memory_s: f64,
    /// Persistence of a raised level, seconds.
    pub persistence_s: f64,
    /// Number of the last values that must agree; 0 passes every value.
    pub agreeing: usize,
    /// Number of remembered values.
    pub remembered: usize,
}

/// A level over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Held {
    votes: MOfN<i8>,
    /// Time of the last rise, seconds.
    pub(crate) rose_s: Option<f64>,
    /// Time, seconds, and level of the last step.
    pub(crate) last: Option<(f64, i8)>,
}

impl Held {
    /// Takes the raw level at a time and returns the level that holds.
    pub(crate) fn take(&mut self, raw: i8, time_s: f64, settings: &HysteresisSettings) -> i8 {
        let goes_on = self
            .last
            .is_some_and(|(last_s, _)| time_s > last_s && time_s - last_s <= settings.memory_s);
        if !goes_on {
            self.votes = MOfN::new(settings.agreeing, settings.remembered, raw, -1);
            self.rose_s = None;
            self.last = None;
        }
        let before = self.last.map_or(-1, |(_, level)| level);
        let agreed = self.votes.take(raw);
        let persists = self
            .rose_s
            .is_some_and(|rose_s| time_s >= rose_s && time_s - rose_s < settings.persistence_s);
        let level = if agreed < 0 {
            self.rose_s = None;
            raw
        } else if persists && before > 0 && agreed < before {
            before
        } else {
            if agreed > 0 && agreed > before {
                self.rose_s = Some(time_s);
            }
            agreed
        };
        self.last = Some((time_s, level));
        level
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_of_four_ignores_a_single_value() {
        let mut votes = MOfN::new(2, 4, 0, -1);
        assert_eq!(votes.take(3), 0);
        assert_eq!(votes.take(0), 0);
        assert_eq!(votes.take(2), 2, "3 and 2 of the last four reach 2");
        assert_eq!(votes.take(0), 2);
        assert_eq!(votes.take(0), 0, "3 has left the memory");
    }

    #[test]
    fn a_risen_level_is_kept_for_the_persistence_and_forgotten_after_a_gap() {
        let settings = HysteresisSettings {
            memory_s: 5.0,
            persistence_s: 4.0,
            agreeing: 0,
            remembered: 0,
        };
        let mut held = Held::default();
        let levels: alloc::vec::Vec<i8> = [0, 3, 0, 0, 0, 0, 0]
            .into_iter()
            .zip(0_u8..)
            .map(|(raw, second)| held.take(raw, f64::from(second), &settings))
            .collect();
        assert_eq!(levels, [0, 3, 3, 3, 3, 0, 0]);
        assert_eq!(held.take(2, 7.0, &settings), 2);
        assert_eq!(
            held.take(0, 13.0, &settings),
            0,
            "after 6 s nothing is remembered"
        );
    }
}
