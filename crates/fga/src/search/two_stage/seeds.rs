//! The best manoeuvre of each combination of sides and climb targets, from which climbs begin.

use super::KINDS;
use crate::search::Found;

/// The best manoeuvre of each kind.
pub(super) struct Seeds {
    found: [Option<Found>; KINDS],
    pub(super) best_m: f64,
    worth_m: f64,
}

impl Seeds {
    pub(super) const fn new(worth_m: f64) -> Self {
        Self {
            found: [None; KINDS],
            best_m: f64::MIN,
            worth_m,
        }
    }

    pub(super) fn floor_m(&self) -> f64 {
        self.best_m - self.worth_m
    }

    pub(super) fn floor_of_m(&self, kind: usize) -> f64 {
        let held = self.found.get(kind).copied().flatten();
        held.map_or(f64::MIN, |held| held.margin_m)
            .max(self.floor_m())
    }

    pub(super) fn take(&mut self, kind: usize, found: Found) {
        self.best_m = self.best_m.max(found.margin_m);
        if let Some(slot) = self.found.get_mut(kind)
            && slot.is_none_or(|held| found.margin_m > held.margin_m)
        {
            *slot = Some(found);
        }
    }

    /// Removes the best remaining one.
    pub(super) fn pop(&mut self) -> Option<Found> {
        let best = self
            .found
            .iter_mut()
            .filter(|slot| slot.is_some())
            .max_by(|a, b| margin(a.as_ref()).total_cmp(&margin(b.as_ref())))?;
        best.take()
    }
}

fn margin(slot: Option<&Found>) -> f64 {
    slot.map_or(f64::MIN, |found| found.margin_m)
}
