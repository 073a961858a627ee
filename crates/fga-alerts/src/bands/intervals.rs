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
        let mine = core::mem::take(self);
        let (mut a, mut b) = (mine.iter().peekable(), other.iter().peekable());
        while let (Some(&[a_low, a_high]), Some(&[b_low, b_high])) = (a.peek(), b.peek()) {
            let starts_in_b = Edge.at_most(b_low, a_low) && Edge.less(a_low, b_high);
            let starts_in_a = Edge.at_most(a_low, b_low) && Edge.less(b_low, a_high);
            let a_ends_first = if starts_in_b {
                Edge.at_most(a_high, b_high)
            } else if starts_in_a {
                !Edge.at_most(b_high, a_high)
            } else {
                Edge.at_most(a_high, b_low)
            };
            let end = if a_ends_first { a_high } else { b_high };
            if starts_in_b {
                self.append(a_low, end);
            } else if starts_in_a {
                self.append(b_low, end);
            }
            if a_ends_first {
                a.next();
            } else {
                b.next();
            }
        }
    }

    fn append(&mut self, low: f64, high: f64) {
        match self.0.last_mut() {
            Some([_, last]) if *last >= low => *last = last.max(high),
            _ => self.0.push([low, high]),
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
