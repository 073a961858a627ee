//! The distribution from which a batch of flights is drawn, and how it moves to the flights that came nearest to a failure.

use crate::encounters::random::Random;

/// Share of the flights that are drawn from the usual distribution.
const USUAL_SHARE: f64 = 0.1;

/// Weight of a batch's own mean and spread in those of the next one.
const SMOOTHING: f64 = 0.6;

/// Least spread of a parameter, in standard deviations of its usual distribution.
const LEAST_SPREAD: f64 = 0.3;

/// A point of the standard normal distribution.
pub(super) type ProposalPoint = Vec<f64>;

/// Length from the most usual flight.
pub(super) fn distance(point: &[f64]) -> f64 {
    libm::sqrt(point.iter().map(|z| z * z).sum())
}

/// The normal distribution from which a batch is drawn.
pub(super) struct Proposal {
    mean: ProposalPoint,
    spread: ProposalPoint,
}

impl Proposal {
    /// The usual distribution, with as many times its spread.
    pub(super) fn usual(dimensions: usize, spread: f64) -> Self {
        Self {
            mean: vec![0.0; dimensions],
            spread: vec![spread; dimensions],
        }
    }

    /// Its density over the usual one's, for the mixture of both.
    pub(super) fn weight(&self, point: &[f64]) -> f64 {
        let mut exponent = 0.0;
        for ((z, mean), spread) in point.iter().zip(&self.mean).zip(&self.spread) {
            let own = (z - mean) / spread;
            exponent += 0.5 * (z * z - own * own) - libm::log(*spread);
        }
        1.0 / (USUAL_SHARE + (1.0 - USUAL_SHARE) * libm::exp(exponent))
    }

    pub(super) fn draw(&self, random: &mut Random) -> ProposalPoint {
        let is_usual = random.unit() < USUAL_SHARE;
        let each = self.mean.iter().zip(&self.spread);
        each.map(|(mean, spread)| {
            let z = normal(random);
            if is_usual { z } else { mean + spread * z }
        })
        .collect()
    }

    /// Moves to the elite of a batch: points with weights.
    pub(super) fn follow(&mut self, elite: &[(&ProposalPoint, f64)]) {
        let total: f64 = elite.iter().map(|(_, weight)| weight).sum();
        if total <= 0.0 {
            return;
        }
        let own = self.mean.iter_mut().zip(&mut self.spread);
        for (place, (own_mean, own_spread)) in own.enumerate() {
            let mean = elite.iter().map(|(z, w)| z[place] * w).sum::<f64>() / total;
            let square = |z: &ProposalPoint| (z[place] - mean) * (z[place] - mean);
            let variance = elite.iter().map(|(z, w)| square(z) * w).sum::<f64>() / total;
            let spread = libm::sqrt(variance).max(LEAST_SPREAD);
            *own_mean += SMOOTHING * (mean - *own_mean);
            *own_spread += SMOOTHING * (spread - *own_spread);
        }
    }
}

/// A number of the standard normal distribution (Box and Muller).
fn normal(random: &mut Random) -> f64 {
    let radius = libm::sqrt(-2.0 * libm::log(1.0 - random.unit()));
    radius * libm::cos(core::f64::consts::TAU * random.unit())
}
