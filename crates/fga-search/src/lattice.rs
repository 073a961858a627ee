//! The rows of a search, their prefixes, and which row is next.

use super::rows::{Prefix, Row};
use super::tuned::{ASIDE_RAD, CLIMBS, LEVEL_AFTER, STARTS};

/// Most prefixes: starts, first turns to either side, and climbs and descents that level off.
const PREFIXES: usize = STARTS.len() + 2 * ASIDE_RAD.len() + 2 * LEVEL_AFTER.len();

/// Most rows: a start has one for each side and climb target, twice where turns may also lead less far than back to the
/// mission's direction.
pub(super) const ROWS: usize = STARTS.len() * 3 * CLIMBS + PREFIXES;

/// Rows and their prefixes.
pub(super) struct Lattice {
    pub prefixes: [Option<Prefix>; PREFIXES],
    prefix_count: usize,
    pub rows: [Option<Row>; ROWS],
    row_count: usize,
    /// The least cost of each row.
    pub costs: [f64; ROWS],
}

impl Lattice {
    pub(super) const fn new() -> Self {
        Self {
            prefixes: [None; PREFIXES],
            prefix_count: 0,
            rows: [None; ROWS],
            row_count: 0,
            costs: [f64::INFINITY; ROWS],
        }
    }

    /// Adds a prefix; its rows follow.
    pub(super) fn begin(&mut self, prefix: &Prefix) {
        if let Some(slot) = self.prefixes.get_mut(self.prefix_count) {
            *slot = Some(*prefix);
            self.prefix_count += 1;
        }
    }

    /// Adds a row of the last prefix.
    pub(super) fn put(&mut self, row: &Row) {
        let places = self
            .rows
            .get_mut(self.row_count)
            .zip(self.costs.get_mut(self.row_count));
        if let Some((slot, cost)) = places {
            let prefix = self.prefix_count.saturating_sub(1);
            *slot = Some(Row { prefix, ..*row });
            *cost = row.cost;
            self.row_count += 1;
        }
    }

    /// The row that may cost least, and that cost.
    pub(super) fn next(&self) -> Option<(usize, f64)> {
        let mut least = (0, f64::INFINITY);
        for (place, cost) in self.costs.iter().take(self.row_count).enumerate() {
            if *cost < least.1 {
                least = (place, *cost);
            }
        }
        (least.1 < f64::INFINITY).then_some(least)
    }

    /// Removes all rows of a prefix.
    pub(super) fn close(&mut self, prefix: usize) {
        let rows = self.rows.iter().zip(&mut self.costs);
        for (row, cost) in rows.take(self.row_count) {
            if row.is_some_and(|row| row.prefix == prefix) {
                *cost = f64::INFINITY;
            }
        }
    }
}
