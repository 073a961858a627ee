//! Counts the work of a step, in one unit for everything whose length depends on the input.
//!
//! The unit is a test of a straight line against four obstacles. The constants below weigh other work
//! against it; they were measured on a 2020s desktop core, where a unit is some 12 ns.

use core::cell::Cell;

/// A piece of a predicted flight without bank lag.
pub(crate) const PIECE: usize = 3;

/// A piece of a predicted flight with bank lag.
pub(crate) const LAGGED_PIECE: usize = 12;

/// A step along an arc with bank lag.
pub(crate) const LAGGED_STEP: usize = 8;

/// A node of a path with a constant course rate.
pub(crate) const NODE: usize = 1;

/// The same with bank lag.
pub(crate) const LAGGED_NODE: usize = 6;

/// A closer look at one obstacle, beyond the test of a line.
pub(crate) const LOOK: usize = 1;

/// A step towards the least margin without a closed form.
pub(crate) const LEAST_STEP: usize = 2;

/// A line that is set up by hand: a sweep, a manoeuvre in the terms of the search.
pub(crate) const SETUP: usize = 15;

/// The table of the turns to a side from a bank.
pub(crate) const BEND: usize = 60;

/// A trial of a shortest path of three turns.
pub(crate) const WORD: usize = 12;

/// Making the hazard of a motion.
pub(crate) const MOTION: usize = 4;

/// Counts work up to a limit. Count finished work; loops ask [`Self::is_met`] first.
#[derive(Debug, Clone)]
pub(crate) struct Meter {
    done: Cell<u32>,
    limit: u32,
}

impl Meter {
    /// Nothing done yet.
    pub(crate) const fn new(limit: u32) -> Self {
        Self {
            done: Cell::new(0),
            limit,
        }
    }

    /// Without a limit, for callers outside of a step.
    pub(crate) const fn unlimited() -> Self {
        Self::new(u32::MAX)
    }

    /// Counts some units.
    #[inline]
    pub(crate) fn count(&self, units: usize) {
        let units = u32::try_from(units).unwrap_or(u32::MAX);
        self.done.set(self.done.get().saturating_add(units));
    }

    /// Units counted so far.
    pub(crate) const fn done(&self) -> u32 {
        self.done.get()
    }

    /// Units left.
    pub(crate) const fn left(&self) -> u32 {
        self.limit.saturating_sub(self.done())
    }

    /// Whether the limit is met.
    #[inline]
    pub(crate) const fn is_met(&self) -> bool {
        self.done() >= self.limit
    }

    /// Leaves all but one part of the limit to others.
    pub(crate) const fn share(&mut self, parts: u32) {
        self.limit /= parts;
    }

    /// Keeps one part in `parts` of the limit for [`Self::extend`].
    pub(crate) const fn reserve(&mut self, parts: u32) {
        self.limit -= self.limit / parts;
    }

    /// Releases the reserve.
    pub(crate) const fn extend(&mut self, parts: u32) {
        self.limit += self.limit / (parts - 1);
    }
}
