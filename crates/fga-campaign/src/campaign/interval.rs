//! Intervals of 95 % by the bootstrap.

use fga_sim::whole::nearest;

use crate::encounters::Random;

/// A 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// Half of its width.
    pub fn half_width(&self) -> f64 {
        0.5 * (self.high - self.low)
    }
}

/// A Poisson number of mean 1 by inversion.
pub(super) fn poisson(random: &mut Random) -> f64 {
    let uniform = random.unit();
    let mut probability = 0.367_879_441_171_442_33;
    let mut below = probability;
    let mut count = 0.0;
    while uniform >= below && count < 30.0 {
        count += 1.0;
        probability /= count;
        below += probability;
    }
    count
}

/// The 2.5 and 97.5 percentiles of some values.
pub(super) fn percentiles(mut values: Vec<f64>) -> Option<Interval> {
    values.sort_by(f64::total_cmp);
    Some(Interval {
        low: nearest(&values, 0.025)?,
        high: nearest(&values, 0.975)?,
    })
}
