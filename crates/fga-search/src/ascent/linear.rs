//! The step in a box that lifts the least of one or two margins most, to first order, in closed form.

use fga_proof::limit::Limit as _;

use super::{PARAMETERS, Vector, dot};

/// A parameter whose slope is a smaller share of all of it stays where it is.
const SLIGHT: f64 = 0.02;

/// An obstacle's margin and its slope, and its margin after a step.
#[derive(Clone, Copy)]
pub(super) struct Lifted {
    pub(super) after_m: f64,
    pub(super) margin_m: f64,
    pub(super) slope: Vector,
}

impl Lifted {
    pub(super) fn after(&self, step: &Vector) -> f64 {
        self.margin_m + dot(&self.slope, step)
    }
}

/// The step within a box that goes farthest up a slope, in the parameters that matter for it.
pub(super) fn farthest_up(slope: &Vector, room: &[(f64, f64); PARAMETERS]) -> Vector {
    let least = SLIGHT * libm::sqrt(dot(slope, slope));
    let mut step = [0.0; PARAMETERS];
    for ((x, slope), (down, up)) in step.iter_mut().zip(slope).zip(room) {
        if slope.abs() > least {
            *x = if *slope > 0.0 { *up } else { *down };
        }
    }
    step
}

/// The step within a box that lifts the lesser of two margins most.
///
/// Of all mixtures (1 − λ) m₁ + λ m₂ of the two, the one that can be lifted least can be lifted to the answer. In λ that
/// is convex and linear between the λ at which a parameter's slope vanishes; there this parameter is free and makes
/// both margins equal.
pub(super) fn lifts_both(one: &Lifted, other: &Lifted, room: &[(f64, f64); PARAMETERS]) -> Vector {
    let mixed = |share: f64| {
        let mut slope = one.slope;
        for (x, other) in slope.iter_mut().zip(&other.slope) {
            *x += share * (other - *x);
        }
        slope
    };
    let lifted = |share: f64| {
        let highest = mixed(share)
            .iter()
            .zip(room)
            .fold(0.0, |sum, (slope, (down, up))| {
                sum + (slope * down).max(slope * up)
            });
        one.margin_m + share * (other.margin_m - one.margin_m) + highest
    };
    let mut best = (0.0, lifted(0.0));
    let vanishes = one.slope.iter().zip(&other.slope).map(|(a, b)| a / (a - b));
    for share in vanishes.chain([1.0]) {
        if share > 0.0 && share <= 1.0 {
            let value = lifted(share);
            if value < best.1 {
                best = (share, value);
            }
        }
    }
    let slope = mixed(best.0);
    let mut step = farthest_up(&slope, room);
    let least = SLIGHT * libm::sqrt(dot(&slope, &slope));
    let mut apart_m = other.after(&step) - one.after(&step);
    let both = one.slope.iter().zip(&other.slope);
    for (((x, slope), (one, other)), (down, up)) in step.iter_mut().zip(slope).zip(both).zip(room) {
        let closes = one - other;
        if slope.abs() <= least && closes != 0.0 {
            *x = (apart_m / closes).limited(*down, *up);
            apart_m -= *x * closes;
        }
    }
    step
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn lifted(margin_m: f64, slope: Vector) -> Lifted {
        Lifted {
            after_m: margin_m,
            margin_m,
            slope,
        }
    }

    proptest! {
        #[test]
        fn no_step_in_the_box_lifts_both_higher(
            margins_m in (-5.0..5.0f64, -5.0..5.0f64),
            slopes in (proptest::array::uniform6(-8.0..8.0f64), proptest::array::uniform6(-8.0..8.0f64)),
            room in proptest::array::uniform6((-1.0..0.0f64, 0.0..1.0f64)),
            tried in proptest::collection::vec(proptest::array::uniform6(0.0..1.0f64), 300),
        ) {
            let (one, other) = (lifted(margins_m.0, slopes.0), lifted(margins_m.1, slopes.1));
            let value = |step: &Vector| one.after(step).min(other.after(step));
            let step = lifts_both(&one, &other, &room);
            for (x, (down, up)) in step.iter().zip(room) {
                prop_assert!(*x >= down && *x <= up);
            }
            // Parameters with a slight slope stay where they are.
            let slight_m = 6.0 * SLIGHT * 8.0 * 2.5;
            for shares in tried {
                let mut point = [0.0; PARAMETERS];
                for ((x, share), (down, up)) in point.iter_mut().zip(shares).zip(room) {
                    // Half of them at a side of the box, where the best is.
                    *x = down + (2.0 * share - 0.5).limited(0.0, 1.0) * (up - down);
                }
                prop_assert!(value(&point) <= value(&step) + slight_m);
            }
        }
    }

    #[test]
    fn two_opposite_slopes_meet_in_the_middle() {
        let one = lifted(0.0, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let other = lifted(1.0, [-1.0, 0.5, 0.0, 0.0, 0.0, 0.0]);
        let step = lifts_both(&one, &other, &[(-1.0, 2.0); PARAMETERS]);
        // By hand: y = 2 adds 1 to the other, and x = 2 − x makes both 1.
        assert_eq!((step[0], step[1]), (1.0, 2.0));
    }
}
