//! Risk of a near mid-air collision beyond what was counted: the tail of the nearest approaches.
//!
//! With a good system hardly any is left to count, but many encounters come near. Let r be the least over time of the larger of
//! horizontal separation / 500 ft and vertical separation / 100 ft: below 1 is a near mid-air collision. Above a threshold the
//! excesses of y = −ln r follow a generalized Pareto distribution (Pickands, Balkema and de Haan), whose two parameters come from
//! weighted moments (Hosking and Wallis 1987). Its tail beyond y = 0, times the weighted share of encounters above the threshold,
//! is the probability. The interval is a bootstrap over encounters, the threshold fixed.
//!
//! It is an extrapolation: it holds as far as the nearest encounters become nearer in the same way as the near ones did. A fault that
//! no encounter showed is not in it.

use super::interval::{Interval, percentiles, poisson};
use crate::encounters::Random;

/// Bootstrap samples.
const SAMPLES: u64 = 500;

/// Master seed of the bootstrap.
const SEED: u64 = 0x7A11_0F00;

/// Fewer encounters give no tail.
const LEAST: usize = 200;

/// Encounters above the threshold: a tenth of all, within these numbers.
const ABOVE: (usize, usize) = (50, 1000);

/// An encounter in the tail's eyes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nearness {
    pub(super) weight: f64,
    /// −ln r as flown.
    pub(super) y: f64,
    /// Whether it has the loss without avoidance.
    pub(super) nominal: bool,
}

/// The ratio of a tail's probability and the share of losses without avoidance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tail {
    /// Encounters above the threshold.
    pub above: u64,
    /// The ratio.
    pub ratio: f64,
    /// Its 95 % interval.
    pub interval: Interval,
}

/// A generalized Pareto distribution.
#[derive(Debug, Clone, Copy)]
struct Pareto {
    scale: f64,
    shape: f64,
}

impl Pareto {
    /// From positive excesses with weights, ascending; `None` where they do not determine it.
    fn fit(excesses: &[(f64, f64)]) -> Option<Self> {
        let total: f64 = excesses.iter().map(|(_, weight)| weight).sum();
        if excesses.len() < 10 || total <= 0.0 {
            return None;
        }
        let (mut below, mut mean, mut moment) = (0.0, 0.0, 0.0);
        for (excess, weight) in excesses {
            let share = (below + 0.5 * weight) / total;
            below += weight;
            mean += weight / total * excess;
            moment += weight / total * excess * (1.0 - share);
        }
        let rest = mean - 2.0 * moment;
        (mean > 0.0 && rest > 1e-12 * mean).then(|| Self {
            scale: 2.0 * mean * moment / rest,
            shape: 2.0 - mean / rest,
        })
    }

    /// Probability of more than `excess`.
    fn beyond(&self, excess: f64) -> f64 {
        if self.shape.abs() < 1e-9 {
            return libm::exp(-excess / self.scale);
        }
        let base = 1.0 + self.shape * excess / self.scale;
        if base <= 0.0 {
            return 0.0;
        }
        libm::pow(base, -1.0 / self.shape)
    }
}

/// The tail of some encounters; `None` for too few, without any loss in the flights without avoidance, or where more than a tail is
/// lost, so that counting is better.
pub(super) fn tail(encounters: &[Nearness]) -> Option<Tail> {
    if encounters.len() < LEAST {
        return None;
    }
    let mut order: Vec<f64> = encounters.iter().map(|encounter| encounter.y).collect();
    order.sort_by(f64::total_cmp);
    let above = (encounters.len() / 10).clamp(ABOVE.0, ABOVE.1);
    let threshold = *order.get(order.len().checked_sub(above + 1)?)?;
    if threshold >= 0.0 || !threshold.is_finite() {
        return None;
    }
    let mut cases: Vec<Nearness> = encounters
        .iter()
        .copied()
        .filter(|encounter| encounter.nominal || encounter.y > threshold)
        .collect();
    cases.sort_by(|a, b| a.y.total_cmp(&b.y));
    let mut excesses = Vec::with_capacity(cases.len());
    let mut ratio = |times: &mut dyn FnMut() -> f64| {
        let mut nominal = 0.0;
        excesses.clear();
        for case in &cases {
            let weight = case.weight * times();
            if weight <= 0.0 {
                continue;
            }
            if case.nominal {
                nominal += weight;
            }
            if case.y > threshold {
                excesses.push((case.y - threshold, weight));
            }
        }
        let share: f64 = excesses.iter().map(|(_, weight)| weight).sum();
        let pareto = Pareto::fit(&excesses)?;
        (nominal > 0.0).then(|| share * pareto.beyond(-threshold) / nominal)
    };
    let best = ratio(&mut || 1.0)?;
    let ratios: Vec<f64> = (0..SAMPLES)
        .filter_map(|sample| {
            let mut random = Random::new(SEED, sample);
            ratio(&mut || poisson(&mut random))
        })
        .collect();
    let interval = percentiles(ratios)?;
    Some(Tail {
        above: encounters.iter().filter(|e| e.y > threshold).count() as u64,
        ratio: best,
        interval: Interval {
            low: interval.low.min(best),
            high: interval.high.max(best),
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Miss distances uniform in a disc of 30 times the radius of the loss: the probability is 1/900. Half of the encounters come from an
    /// inner disc of a third of the radius, with weights that make up for it. One in 100 is lost without avoidance.
    fn disc(campaign: u64, count: u64) -> Vec<Nearness> {
        let mut random = Random::new(11, campaign);
        (0..count)
            .map(|number| {
                let radius = if random.unit() < 0.5 { 10.0 } else { 30.0 };
                let r = radius * libm::sqrt(1.0 - random.unit());
                // Density 0.5 / (π 30²) everywhere, and 0.5 / (π 10²) more within.
                let density = 0.5 + if r < 10.0 { 0.5 * 9.0 } else { 0.0 };
                Nearness {
                    weight: 1.0 / density,
                    y: -libm::log(r),
                    nominal: number % 100 == 0,
                }
            })
            .collect()
    }

    #[test]
    fn the_interval_covers_the_probability_of_a_known_distribution() {
        let (mut covered, mut counted, mut wide) = (0, 0, 0.0);
        for campaign in 0..60 {
            let encounters = disc(campaign, 1500);
            let total: f64 = encounters.iter().map(|e| e.weight).sum();
            let lost: f64 = encounters
                .iter()
                .filter(|e| e.nominal)
                .map(|e| e.weight)
                .sum();
            let expected = total / 900.0 / lost;
            let found = tail(&encounters).unwrap();
            assert_eq!(found.above, 150);
            covered += u32::from(found.interval.low <= expected && expected <= found.interval.high);
            counted += u32::from(encounters.iter().any(|e| e.y > 0.0));
            wide += libm::log(found.interval.high / found.interval.low.max(1e-6)) / 60.0;
        }
        // 95 % of 60 are 57.
        assert!(covered >= 50, "{covered}");
        // The interval is within two orders of magnitude, and most campaigns have something to count too.
        assert!(counted > 30 && wide < 4.6, "{counted} {wide}");
    }

    #[test]
    fn a_pareto_distribution_is_found_again() {
        let mut random = Random::new(3, 3);
        for (scale, shape) in [(0.5, 0.0), (1.0, 0.25), (2.0, -0.4)] {
            let mut excesses: Vec<(f64, f64)> = (0..40_000)
                .map(|_| {
                    let uniform: f64 = 1.0 - random.unit();
                    let excess = if shape == 0.0 {
                        -scale * libm::log(uniform)
                    } else {
                        scale / shape * (libm::pow(uniform, -shape) - 1.0)
                    };
                    (excess, 1.0)
                })
                .collect();
            excesses.sort_by(|a, b| a.0.total_cmp(&b.0));
            let found = Pareto::fit(&excesses).unwrap();
            assert!((found.scale / scale - 1.0).abs() < 0.05, "{found:?}");
            assert!((found.shape - shape).abs() < 0.05, "{found:?}");
        }
        // Bounded: nothing beyond 2 / 0.4.
        let bounded = Pareto {
            scale: 2.0,
            shape: -0.4,
        };
        assert!(bounded.beyond(4.9) > 0.0 && bounded.beyond(5.1) <= 0.0);
    }

    #[test]
    fn too_few_encounters_and_more_losses_than_a_tail_give_none() {
        assert_eq!(tail(&disc(1, 199)), None);
        let lost = |number: u32| Nearness {
            weight: 1.0,
            y: 1.0 - f64::from(number) * 1e-3,
            nominal: true,
        };
        let many: Vec<Nearness> = (0..1000).map(lost).collect();
        assert_eq!(tail(&many), None);
    }
}
