//! Counts and distributions over the rows of a campaign, for each policy and source.

use alloc::collections::BTreeMap;

use super::Row;
use super::risk::Risks;

/// Resolution near zero, in the unit of the values.
const FINEST: f64 = 1e-3;

/// Relative width of a bin far from zero: 1 %.
const RELATIVE: f64 = 0.01;

/// A distribution in bins that are 0.001 wide near zero and 1 % of the value far from it: its
/// memory does not grow with the number of values, and it does not depend on their order.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Quantiles {
    bins: BTreeMap<i32, u64>,
    count: u64,
}

impl Quantiles {
    /// Adds a value; ignores one that is not finite.
    pub fn take(&mut self, value: f64) {
        if value.is_finite() {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "at most some ten thousand bins"
            )]
            let bin = libm::rint(libm::asinh(value * RELATIVE / FINEST) / RELATIVE) as i32;
            *self.bins.entry(bin).or_default() += 1;
            self.count += 1;
        }
    }

    /// Number of values.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// The value below which this share lies, to the width of a bin; `None` without values.
    ///
    /// # Examples
    ///
    /// ```
    /// let mut quantiles = fga_campaign::campaign::Quantiles::default();
    /// (1..=999).for_each(|k| quantiles.take(f64::from(k)));
    /// assert!((quantiles.at(0.5).unwrap() - 500.0).abs() < 5.0);
    /// ```
    pub fn at(&self, share: f64) -> Option<f64> {
        let wanted = share * self.count as f64;
        let mut below = 0;
        for (bin, count) in &self.bins {
            below += count;
            if below as f64 >= wanted {
                return Some(libm::sinh(f64::from(*bin) * RELATIVE) * FINEST / RELATIVE);
            }
        }
        None
    }
}

/// Counts and distributions over the rows of one policy in one source.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Totals {
    /// Encounters.
    pub encounters: u64,
    /// Entered no volume.
    pub separated: u64,
    /// Would have entered one with the course held.
    pub threatened: u64,
    /// With an answer of the oracle.
    pub asked: u64,
    /// Saved by the oracle.
    pub avoidable: u64,
    /// Saved by the oracle and by the policy.
    pub saved_of_avoidable: u64,
    /// Saved by the policy but not by the oracle: a sign that one of them is wrong.
    pub saved_of_lost: u64,
    /// With a manoeuvre.
    pub manoeuvred: u64,
    /// With a manoeuvre although holding the course would have stayed clear.
    pub needless: u64,
    /// Entered a volume that holding the course would not have entered.
    pub caused: u64,
    /// Back on the line before the end.
    pub rejoined: u64,
    /// Least margins, metres.
    pub margin_m: Quantiles,
    /// Largest distances from the line of flights with a manoeuvre, metres.
    pub cross_track_m: Quantiles,
    /// Extra paths of flights with a manoeuvre, metres.
    pub extra_path_m: Quantiles,
    /// Times away of flights with a manoeuvre, seconds.
    pub time_away_s: Quantiles,
    /// Largest works of a decision, where the policy counts them.
    pub work: Quantiles,
}

impl Totals {
    /// Adds a row.
    pub fn take(&mut self, row: &Row) {
        let count = |counter: &mut u64, yes: bool| *counter += u64::from(yes);
        self.encounters += 1;
        count(&mut self.separated, row.separated);
        count(&mut self.threatened, row.threatened());
        count(&mut self.caused, row.caused);
        count(&mut self.needless, row.needless());
        if let Some(avoidable) = row.avoidable() {
            self.asked += 1;
            count(&mut self.avoidable, avoidable);
            count(&mut self.saved_of_avoidable, avoidable && row.separated);
            count(&mut self.saved_of_lost, !avoidable && row.separated);
        }
        self.margin_m.take(row.min_margin_m);
        self.work.take(row.metrics.work.unwrap_or(f64::NAN));
        if let Some(time_away_s) = row.time_away_s() {
            self.manoeuvred += 1;
            count(&mut self.rejoined, row.rejoined_s.is_some());
            self.cross_track_m.take(row.max_cross_track_m);
            self.extra_path_m.take(row.extra_path_m);
            self.time_away_s.take(time_away_s);
        }
    }
}

/// Totals by policy and source, and by policy over all sources.
#[derive(Debug, Clone, Default)]
pub struct Summary {
    /// Risk ratios of encounters of aircraft.
    pub risks: Risks,
    by_source: BTreeMap<(u32, u32), Totals>,
    by_policy: BTreeMap<u32, Totals>,
}

impl Summary {
    /// Adds a row.
    pub fn take(&mut self, row: &Row) {
        self.risks.take(row);
        self.by_policy.entry(row.policy).or_default().take(row);
        self.by_source
            .entry((row.policy, row.source))
            .or_default()
            .take(row);
    }

    /// Totals of each policy over all sources.
    pub fn policies(&self) -> impl Iterator<Item = (u32, &Totals)> {
        self.by_policy
            .iter()
            .map(|(policy, totals)| (*policy, totals))
    }

    /// Totals of each policy in each source: policy, source, totals.
    pub fn sources(&self) -> impl Iterator<Item = (u32, u32, &Totals)> {
        self.by_source
            .iter()
            .map(|((policy, source), totals)| (*policy, *source, totals))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_near_the_sorted_values() {
        let mut quantiles = Quantiles::default();
        let mut values: Vec<f64> = (0..5000_i32)
            .map(|k| f64::from((k * 7919) % 5000 - 1000) * 0.1)
            .collect();
        values.iter().rev().for_each(|v| quantiles.take(*v));
        quantiles.take(f64::NAN);
        values.sort_by(f64::total_cmp);
        for (share, place) in [(0.01, 49), (0.5, 2499), (0.99, 4949), (1.0, 4999)] {
            let (found, expected) = (quantiles.at(share).unwrap(), values[place]);
            assert!(
                (found - expected).abs() <= 0.002 + 0.01 * expected.abs(),
                "{found} {expected}"
            );
        }
        assert_eq!(quantiles.count(), 5000);
        assert_eq!(Quantiles::default().at(0.5), None);
    }
}
