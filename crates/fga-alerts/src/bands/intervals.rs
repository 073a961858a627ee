//! Sets of intervals, with edges equal within the resolution of band edges.

use crate::almost::Closeness::Edge;
use alloc::vec::Vec;

/// Disjoint closed intervals in increasing order.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Intervals(Vec<[f64; 2]>);

impl Intervals {
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.0.iter().copied()
    }

    /// From one value to another, on a circular scale around it where the first one is not less.
    pub(crate) fn around(low: f64, high: f64, modulus: f64) -> Self {
        let mut around = Self::default();
        if low < high || modulus == 0.0 {
            around.add(low, high);
        } else {
            around.add(0.0, high);
            around.add(low, modulus);
        }
        around
    }

    /// Adds an interval; ignores one without length.
    pub(crate) fn add(&mut self, mut low: f64, mut high: f64) {
        if !Edge.less(low, high) {
            return;
        }
        let mut below = 0;
        self.0.retain(|&[other_low, other_high]| {
            if Edge.at_most(other_low, high) && Edge.at_most(low, other_high) {
                low = low.min(other_low);
                high = high.max(other_high);
                return false;
            }
            below += usize::from(other_low < low);
            true
        });
        self.0.insert(below, [low, high]);
    }

    /// Adds every interval of `other`.
    pub(crate) fn unite(&mut self, other: &Self) {
        for [low, high] in other.iter() {
            self.add(low, high);
        }
    }

    /// Keeps the intersection with `other`.
    pub(crate) fn intersect(&mut self, other: &Self) {
        for [low, high] in core::mem::take(self).iter() {
            for [other_low, other_high] in other.iter() {
                self.add(low.max(other_low), high.min(other_high));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(parts: &[[f64; 2]]) -> Intervals {
        let mut set = Intervals::default();
        for &[low, high] in parts {
            set.add(low, high);
        }
        set
    }

    #[test]
    fn parts_that_touch_are_one() {
        assert_eq!(
            set(&[[5.0, 6.0], [1.0, 2.0], [2.000_1, 3.0]]).0,
            [[1.0, 3.0], [5.0, 6.0]]
        );
        assert_eq!(set(&[[1.0, 2.0], [4.0, 5.0], [0.0, 9.0]]).0, [[0.0, 9.0]]);
        assert!(set(&[[1.0, 1.000_01]]).is_empty());
    }

    #[test]
    fn intersection_keeps_what_is_in_both() {
        let mut both = set(&[[0.0, 4.0], [6.0, 9.0]]);
        both.intersect(&set(&[[1.0, 2.0], [3.0, 7.0], [8.0, 12.0]]));
        assert_eq!(both.0, [[1.0, 2.0], [3.0, 4.0], [6.0, 7.0], [8.0, 9.0]]);
        both.intersect(&Intervals::default());
        assert!(both.is_empty());
    }
}
