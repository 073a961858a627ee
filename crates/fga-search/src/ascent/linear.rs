//! The small linear program of a climb: the step in a box that lifts the least of several margins most, to first order.
//!
//! In x = step − lowest corner and t = least margin − its least value in the box, all of them ≥ 0, it is: largest t with
//! t − sᵢ·x ≤ bᵢ and x ≤ the width of the box. No bᵢ is negative, so the simplex method begins at the origin.

use crate::climbs::{CLOSEST, PARAMETERS, Vector};

/// Unknowns: the step and the least margin.
const UNKNOWNS: usize = PARAMETERS + 1;

/// Constraints: one for each margin, one for the width of each side.
const CONSTRAINTS: usize = CLOSEST + PARAMETERS;

/// Most exchanges.
const EXCHANGES: usize = 30;

/// A smaller number is zero.
const ZERO: f64 = 1e-9;

/// A box: how far down and up each parameter may go.
pub(super) type Room = [(f64, f64); PARAMETERS];

/// A margin and its slope.
#[derive(Debug, Clone, Copy)]
pub(super) struct Margin {
    pub(super) now_m: f64,
    pub(super) slope: Vector,
}

impl Margin {
    pub(super) const NONE: Self = Self {
        now_m: 0.0,
        slope: [0.0; PARAMETERS],
    };

    fn after(&self, step: &Vector) -> f64 {
        let products = self.slope.iter().zip(step).map(|(slope, x)| slope * x);
        self.now_m + products.sum::<f64>()
    }

    /// Its least value in a box.
    fn lowest_m(&self, room: &Room) -> f64 {
        let slopes = self.slope.iter().zip(room);
        let lowest = slopes.map(|(slope, (down, up))| (slope * down).min(slope * up));
        self.now_m + lowest.sum::<f64>()
    }
}

/// A constraint: coefficients of the unknowns outside the base, the right side, and which unknown it is in the base.
#[derive(Clone, Copy)]
struct Constraint {
    factors: [f64; UNKNOWNS],
    right: f64,
    unknown: Option<usize>,
}

/// The step that lifts the least margin most, and that margin.
pub(super) fn lifted(margins: &[Margin], room: &Room) -> (Vector, f64) {
    let lowest = room.map(|(down, _)| down);
    let least_m = margins
        .iter()
        .fold(f64::INFINITY, |least, m| least.min(m.lowest_m(room)));
    let none = Constraint {
        factors: [0.0; UNKNOWNS],
        right: f64::INFINITY,
        unknown: None,
    };
    let mut table = [none; CONSTRAINTS];
    let (of_margins, of_sides) = table.split_at_mut(CLOSEST);
    for (row, margin) in of_margins.iter_mut().zip(margins) {
        row.factors = [1.0; UNKNOWNS];
        for (factor, slope) in row.factors.iter_mut().zip(margin.slope) {
            *factor = -slope;
        }
        row.right = (margin.after(&lowest) - least_m).max(0.0);
    }
    for (side, (row, (down, up))) in of_sides.iter_mut().zip(room).enumerate() {
        for (place, factor) in row.factors.iter_mut().enumerate() {
            *factor = f64::from(place == side);
        }
        row.right = up - down;
    }
    // The unknowns outside the base, and by how much each lifts the least margin.
    let mut outside: [Option<usize>; UNKNOWNS] = core::array::from_fn(Some);
    let mut gains = [0.0_f64; UNKNOWNS];
    if let Some(last) = gains.last_mut() {
        *last = 1.0;
    }
    for _ in 0..EXCHANGES {
        let most = gains.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        let Some((column, gain)) = most.map(|(column, gain)| (column, *gain)) else {
            break;
        };
        let factor_of = |row: &Constraint| row.factors.get(column).copied().unwrap_or(0.0);
        let first = table
            .iter()
            .enumerate()
            .filter(|(_, row)| factor_of(row) > ZERO);
        let first = first
            .min_by(|(_, a), (_, b)| (a.right / factor_of(a)).total_cmp(&(b.right / factor_of(b))));
        let Some((place, mut pivot)) = first.map(|(place, row)| (place, *row)) else {
            break;
        };
        if gain <= ZERO || pivot.right == f64::INFINITY {
            break;
        }
        // Exchanges the unknown of the column and that of the row.
        let divisor = factor_of(&pivot);
        if let (Some(slot), Some(factor)) = (outside.get_mut(column), pivot.factors.get_mut(column))
        {
            core::mem::swap(slot, &mut pivot.unknown);
            *factor = 1.0;
        }
        pivot.factors = pivot.factors.map(|factor| factor / divisor);
        pivot.right /= divisor;
        let take_out = |factors: &mut [f64; UNKNOWNS]| {
            let share = factors.get_mut(column).map_or(0.0, core::mem::take);
            for (factor, of_pivot) in factors.iter_mut().zip(pivot.factors) {
                *factor -= share * of_pivot;
            }
            share
        };
        for row in &mut table {
            let share = take_out(&mut row.factors);
            if share != 0.0 {
                row.right = (row.right - share * pivot.right).max(0.0);
            }
        }
        take_out(&mut gains);
        if let Some(row) = table.get_mut(place) {
            *row = pivot;
        }
    }
    let mut step = lowest;
    for row in &table {
        if let Some(x) = row.unknown.and_then(|unknown| step.get_mut(unknown)) {
            *x += row.right;
        }
    }
    for (x, (down, up)) in step.iter_mut().zip(room) {
        *x = x.max(*down).min(*up);
    }
    (
        step,
        margins
            .iter()
            .fold(f64::INFINITY, |least, m| least.min(m.after(&step))),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga_proof::limit::Limit as _;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_step_in_the_box_lifts_the_least_margin_higher(
            margins in proptest::collection::vec((-5.0..5.0f64, proptest::array::uniform6(-8.0..8.0f64)), 1..=CLOSEST),
            room in proptest::array::uniform6((-1.0..0.0f64, 0.0..1.0f64)),
            tried in proptest::collection::vec(proptest::array::uniform6(0.0..1.0f64), 300),
        ) {
            let margins: alloc::vec::Vec<Margin> =
                margins.into_iter().map(|(now_m, slope)| Margin { now_m, slope }).collect();
            let value = |step: &Vector| margins.iter().map(|m| m.after(step)).fold(f64::INFINITY, f64::min);
            let (step, promised_m) = lifted(&margins, &room);
            for (x, (down, up)) in step.iter().zip(room) {
                prop_assert!(*x >= down && *x <= up);
            }
            prop_assert!((value(&step) - promised_m).abs() < 1e-9);
            for shares in tried {
                let mut point = [0.0; PARAMETERS];
                for ((x, share), (down, up)) in point.iter_mut().zip(shares).zip(room) {
                    // Half of them at a side of the box, where the best is.
                    *x = down + (2.0 * share - 0.5).limited(0.0, 1.0) * (up - down);
                }
                prop_assert!(value(&point) <= promised_m + 1e-9);
            }
        }
    }

    #[test]
    fn two_opposite_slopes_meet_in_the_middle() {
        let one = Margin {
            now_m: 0.0,
            slope: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        };
        let other = Margin {
            now_m: 1.0,
            slope: [-1.0, 0.5, 0.0, 0.0, 0.0, 0.0],
        };
        let (step, least_m) = lifted(&[one, other], &[(-1.0, 2.0); PARAMETERS]);
        // By hand: y = 2 adds 1 to the other, and x = 2 − x makes both 1.
        assert_eq!((step[0], step[1], least_m), (1.0, 2.0, 1.0));
    }
}
