//! The worst of many results: those with the least margin, if equal those with the least distance, then in order of
//! arrival. Margins to cylinders are often equal: right above an aircraft the half height is all that counts.

/// Keeps the few with the least margin, in memory only for these few.
#[derive(Debug)]
pub struct Worst<T> {
    most: usize,
    kept: Vec<([f64; 2], u64, T)>,
    seen: u64,
}

impl<T> Worst<T> {
    /// Keeps at most `most`.
    pub const fn new(most: usize) -> Self {
        Self {
            most,
            kept: Vec::new(),
            seen: 0,
        }
    }

    /// Adds one with its margin and its distance.
    pub fn take(&mut self, rank: [f64; 2], item: T) {
        self.kept.push((rank, self.seen, item));
        self.seen += 1;
        if self.kept.len() >= 2 * self.most.max(512) {
            self.cut();
        }
    }

    /// The kept ones, the worst one first.
    pub fn into_items(mut self) -> impl Iterator<Item = T> {
        self.cut();
        self.kept.into_iter().map(|(_, _, item)| item)
    }

    fn cut(&mut self) {
        self.kept.sort_by(|a, b| {
            let by = |place: usize| a.0[place].total_cmp(&b.0[place]);
            by(0).then(by(1)).then(a.1.cmp(&b.1))
        });
        self.kept.truncate(self.most);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_margins_stay_in_order() {
        let mut worst = Worst::new(3);
        for number in 0..5_000_u32 {
            // A permutation: 1237 and 5000 have no common factor.
            let place = number * 1237 % 5000;
            worst.take([f64::from(place / 2), 0.0], place);
        }
        let kept: Vec<u32> = worst.into_items().collect();
        assert_eq!(kept.len(), 3);
        assert_eq!(kept[2] / 2, 1);
        assert!(kept[..2].contains(&0) && kept[..2].contains(&1));
    }

    #[test]
    fn n11_equal_margins_are_ordered_by_distance() {
        let mut worst = Worst::new(3);
        for (number, distance_m) in [400.0, 80.0, 250.0, 80.0].into_iter().enumerate() {
            worst.take([-76.2, distance_m], number);
        }
        assert_eq!(worst.into_items().collect::<Vec<_>>(), [1, 3, 2]);
    }

    #[test]
    fn none_are_kept_where_none_are_asked_for() {
        let mut worst = Worst::new(0);
        worst.take([-1.0, 0.0], ());
        assert_eq!(worst.into_items().count(), 0);
    }
}
