//! Counts the work of a step, in one unit for everything whose length depends on the input.
//!
//! The unit is a test of a straight line against four obstacles. The constants below weigh other work
//! against it; they were measured on a 2020s desktop core, where a unit is some 12 ns.

use core::cell::Cell;

/// A piece of a predicted flight without bank lag.
pub(crate) const PIECE: usize = 3;

/// A piece of a predicted flight with bank lag.
pub(crate) const LAGGED_PIECE: usize = 12;

/// A node of a path with a constant course rate.
pub(crate) const NODE: usize = 1;

/// The same with bank lag.
pub(crate) const LAGGED_NODE: usize = 6;

/// A closer look at one obstacle, beyond the test of a line.
pub(crate) const LOOK: usize = 1;

/// A step towards the least margin without a closed form.
pub(crate) const LEAST_STEP: usize = 2;

/// A look at the ground below a piece of a line, and at its ends.
pub(crate) const GROUND: usize = 6;

/// A line that is set up by hand: a sweep, a manoeuvre in the terms of the search.
pub const SETUP: usize = 15;

/// Numbers that one unit compares.
pub const COMPARED: usize = 16;

/// The work of a step: what is done, from when on it finishes, and how much there may be at most.
///
/// **The bound.** All work of a length that depends on the input asks [`Self::take`] before it is done, piece by piece. A piece
/// that does not fit within `most` is refused, and so is every later one: what is done never exceeds `most`.
///
/// **The answers.** Searches and loops ask [`Self::is_met`] and end at `limit`, with the best answer so far; what is between
/// `limit` and `most` finishes them: the certificate of an answer, the last line of a sweep. After a refusal what was computed
/// may lack pieces, so nothing is proven: a certificate has no margin, and a search has no answer.
#[derive(Debug, Clone)]
pub struct Meter {
    // Wider than any sum of them.
    done: Cell<u64>,
    limit: Cell<u64>,
    most: Cell<u64>,
}

impl Meter {
    /// Nothing done yet: finishes from `limit` on, and never exceeds `most`.
    pub const fn new(limit: u32, most: u32) -> Self {
        Self {
            done: Cell::new(0),
            limit: Cell::new(limit as u64),
            most: Cell::new(most as u64),
        }
    }

    /// Without a limit, for callers outside of a step.
    pub const fn unlimited() -> Self {
        Self::new(u32::MAX, u32::MAX)
    }

    /// For a part of the work: at most `limit` of what is left.
    #[must_use]
    pub fn part(&self, limit: u32) -> Self {
        Self::new(limit.min(self.left()), self.most_left())
    }

    /// Asks for some units before they are done. Once refused, it refuses everything.
    #[inline]
    #[must_use]
    pub fn take(&self, units: usize) -> bool {
        let done = self.done.get() + units as u64;
        if done > self.most.get() {
            self.spend();
            return false;
        }
        self.done.set(done);
        true
    }

    #[cold]
    fn spend(&self) {
        self.limit.set(0);
        self.most.set(0);
    }

    /// Counts what cannot be refused: reading obstacles, and what a part of this meter's work has taken from it.
    #[inline]
    pub fn count(&self, units: usize) {
        self.done.set(self.done.get() + units as u64);
    }

    /// Units done so far.
    pub const fn done(&self) -> u32 {
        narrow(self.done.get())
    }

    /// Units left before it finishes.
    pub const fn left(&self) -> u32 {
        narrow(self.limit.get().saturating_sub(self.done.get()))
    }

    /// Units left before it refuses.
    pub const fn most_left(&self) -> u32 {
        narrow(self.most.get().saturating_sub(self.done.get()))
    }

    /// Whether it is time to finish.
    #[inline]
    pub const fn is_met(&self) -> bool {
        self.done.get() >= self.limit.get()
    }

    /// Whether it refused something: what was computed with it may lack pieces.
    #[inline]
    pub const fn is_spent(&self) -> bool {
        self.most.get() == 0
    }

    /// Leaves all but one part of the limit to others.
    pub fn share(&self, parts: u32) {
        self.limit.set(self.limit.get() / u64::from(parts));
    }

    /// Keeps one part in `parts` of the limit for [`Self::extend`].
    pub fn reserve(&self, parts: u32) {
        let limit = self.limit.get();
        self.limit.set(limit - limit / u64::from(parts));
    }

    /// Releases the reserve.
    pub fn extend(&self, parts: u32) {
        let limit = self.limit.get();
        self.limit.set(limit + limit / u64::from(parts - 1));
    }
}

/// As a number of a record.
#[expect(clippy::cast_possible_truncation, reason = "bounded just before")]
const fn narrow(units: u64) -> u32 {
    if units > u32::MAX as u64 {
        u32::MAX
    } else {
        units as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_done_never_exceeds_the_most_whatever_is_asked_for() {
        let mut asked: usize = 1;
        for most in 0..200 {
            let meter = Meter::new(most / 2, most);
            let mut has_refused = false;
            for _ in 0..300 {
                asked = asked.wrapping_mul(0x5851_f42d).wrapping_add(11) % 97 + 1;
                let is_given = meter.take(asked);
                assert!(meter.done() <= most);
                assert!(!is_given || !has_refused, "work after a refusal");
                has_refused |= !is_given;
                assert_eq!(meter.is_spent(), has_refused || most == 0);
                assert!(meter.is_met() || meter.done() < most / 2);
            }
            assert!(has_refused);
        }
    }

    #[test]
    fn a_part_has_no_more_than_its_whole_has_left() {
        let whole = Meter::new(80, 100);
        assert!(whole.take(60));
        let part = whole.part(1000);
        assert_eq!((part.left(), part.most_left()), (20, 40));
        assert!(part.take(30) && part.is_met() && !part.take(11));
        whole.count(part.done() as usize);
        assert!(whole.done() == 90 && !whole.is_spent());
    }
}
