//! The rows of a search, their prefixes, and which row is next.

use super::rows::{Prefix, Row};
use super::tuned::{ASIDE_RAD, CLIMBS, LEVEL_AFTER, STARTS};

/// Most prefixes: starts, first turns to either side, and climbs and descents that level off.
const PREFIXES: usize = STARTS.len() + 2 * ASIDE_RAD.len() + 2 * LEVEL_AFTER.len();

/// Most rows: a start has one for each side and climb target, twice where turns may also lead less far than back to the
/// mission's direction.
pub(super) const ROWS: usize = STARTS.len() * 3 * CLIMBS + PREFIXES;

/// Rows and their prefixes.
#[derive(Debug, Clone)]
pub(super) struct Lattice {
    pub prefixes: [Prefix; PREFIXES],
    prefix_count: usize,
    pub rows: [Row; ROWS],
    pub row_count: usize,
}

impl Lattice {
    pub(super) const NONE: Self = Self {
        prefixes: [Prefix::NONE; PREFIXES],
        prefix_count: 0,
        rows: [Row::NONE; ROWS],
        row_count: 0,
    };

    /// Forgets all rows.
    pub(super) const fn clear(&mut self) {
        (self.prefix_count, self.row_count) = (0, 0);
    }

    /// Adds a prefix; its rows follow.
    pub(super) fn begin(&mut self, prefix: &Prefix) {
        if let Some(slot) = self.prefixes.get_mut(self.prefix_count) {
            *slot = *prefix;
            self.prefix_count += 1;
        }
    }

    /// Adds a row of the last prefix.
    pub(super) fn put(&mut self, row: &Row) {
        if let Some(slot) = self.rows.get_mut(self.row_count) {
            let prefix = self.prefix_count.saturating_sub(1);
            *slot = Row { prefix, ..*row };
            self.row_count += 1;
        }
    }

    /// The row that may cost least, and that cost.
    pub(super) fn next(&self) -> Option<(usize, f64)> {
        let mut least = (0, f64::INFINITY);
        for (place, row) in self.rows.iter().take(self.row_count).enumerate() {
            if row.cost < least.1 {
                least = (place, row.cost);
            }
        }
        (least.1 < f64::INFINITY).then_some(least)
    }

    /// Removes all rows of a prefix.
    pub(super) fn close(&mut self, prefix: usize) {
        for row in self.rows.iter_mut().take(self.row_count) {
            if row.prefix == prefix {
                row.close();
            }
        }
    }
}
