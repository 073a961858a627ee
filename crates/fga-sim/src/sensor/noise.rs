//! Random numbers of a source.

use fga::Vec3;
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

/// Modifies the master seed for the stream of misses.
pub(super) const MISSES: u64 = 0x006D_6973_7365_6400;

/// The same for errors that stay.
pub(super) const BIASES: u64 = 0x6269_6173_6573_0000;

/// The same for the obstacles that a source can see.
pub(super) const EQUIPPED: u64 = 0x6571_7569_7070_6564;

/// The same for interruptions.
pub(super) const DROPOUTS: u64 = 0x6472_6f70_6f75_7473;

/// The same for errors of the chart.
pub(super) const CHART: u64 = 0x6368_6172_7400_0000;

/// Times its place, the same for each further source.
pub(super) const NEXT_SOURCE: u64 = 0x9e37_79b9_7f4a_7c15;

/// Gaussian noise from one counter-based stream (Box–Muller).
#[derive(Debug, Clone)]
pub(super) struct Noise {
    generator: ChaCha8Rng,
    spare: Option<f64>,
}

impl Noise {
    pub(super) fn new(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self {
            generator,
            spare: None,
        }
    }

    /// A number in (0, 1].
    pub(super) fn unit(&mut self) -> f64 {
        ((self.generator.next_u64() >> 11) + 1) as f64 / (1_u64 << 53) as f64
    }

    fn gaussian(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = libm::sqrt(-2.0 * libm::log(self.unit()));
        let (sin, cos) = libm::sincos(core::f64::consts::TAU * self.unit());
        self.spare = Some(radius * sin);
        radius * cos
    }

    /// One number for each component, times its σ.
    pub(super) fn vector(&mut self, sigma: Vec3) -> Vec3 {
        Vec3::new(self.gaussian(), self.gaussian(), self.gaussian()) * sigma
    }
}
