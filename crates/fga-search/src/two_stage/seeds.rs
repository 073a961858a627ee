//! The best manoeuvre of each combination of sides and climb targets, from which climbs begin.

use super::KINDS;
use crate::{Found, Turns};

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

    pub(super) fn take(&mut self, kind: usize, turns: Turns, margin_m: f64) {
        self.best_m = self.best_m.max(margin_m);
        if let Some(slot) = self.found.get_mut(kind)
            && slot.is_none_or(|held| margin_m > held.margin_m)
        {
            // The cost of a seed does not matter.
            let cost = f64::INFINITY;
            *slot = Some(Found {
                turns,
                margin_m,
                cost,
            });
        }
    }

    /// Removes the best remaining one that is worth a climb.
    pub(super) fn pop(&mut self) -> Option<Found> {
        let floor_m = self.floor_m();
        let best = self
            .found
            .iter_mut()
            .max_by(|a, b| margin(a.as_ref()).total_cmp(&margin(b.as_ref())))?;
        best.take_if(|found| found.margin_m >= floor_m)
    }
}

fn margin(slot: Option<&Found>) -> f64 {
    slot.map_or(f64::MIN, |found| found.margin_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_far_below_the_best_one_are_not_climbed() {
        let turns = Turns {
            wait_s: 0.0,
            turn_rad: 1.0,
            climb_rad: 0.0,
            second: None,
        };
        let mut seeds = Seeds::new(8.0);
        for (kind, margin_m) in [-10.0, -3.0, -1.0].into_iter().enumerate() {
            seeds.take(kind, turns, margin_m);
        }
        let popped = [(); 3].map(|()| seeds.pop().map(|found| found.margin_m));
        assert_eq!(popped, [Some(-1.0), Some(-3.0), None]);
    }
}
