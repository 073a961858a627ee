//! Random numbers, the same on every machine.

use core::f64::consts::TAU;
use core::time::Duration;
use std::time::Instant;

use fga::Vec3;
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

use super::family::Range;

/// The level unit vector that many turns to the left of +x.
pub(super) fn level(turns: f64) -> Vec3 {
    let (sin, cos) = libm::sincos(TAU * turns);
    Vec3::new(cos, sin, 0.0)
}

/// Most repeated draws of an encounter: a hundred times what the rarest cell in use needs, and at most seconds.
const MOST_DRAWS: u32 = 10_000_000;

/// A stop ends draws that have taken longer than this; the others are drawn to their end.
const LONG: Duration = Duration::from_millis(100);

/// The random stream of one encounter.
#[derive(Clone)]
pub struct Random<'a> {
    stream: ChaCha8Rng,
    /// Draws that may still be repeated.
    left: u32,
    begun: Instant,
    go_on: &'a (dyn Fn() -> bool + Sync),
}

impl Random<'_> {
    /// Stream `stream` of the master seed.
    pub fn new(seed: u64, stream: u64) -> Self {
        Self::with_stop(seed, stream, &|| true)
    }
}

impl<'a> Random<'a> {
    /// The same; repeats no draw for long once `go_on` returns false.
    pub(super) fn with_stop(seed: u64, stream: u64, go_on: &'a (dyn Fn() -> bool + Sync)) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self {
            stream: generator,
            left: MOST_DRAWS,
            begun: Instant::now(),
            go_on,
        }
    }

    /// Counts a draw that is repeated until it suits; nothing once there were too many, or after a stop.
    pub(super) fn again(&mut self) -> Option<()> {
        self.left = self.left.checked_sub(1)?;
        ((self.go_on)() || self.begun.elapsed() < LONG).then_some(())
    }

    /// Uniform in [0, 1): the upper 53 bits of an integer times 2⁻⁵³, exact.
    pub fn unit(&mut self) -> f64 {
        (self.stream.next_u64() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Uniform in a range.
    pub fn within(&mut self, range: Range) -> f64 {
        range.0 + (range.1 - range.0) * self.unit()
    }

    /// A whole number from `least` to `most`, both included.
    pub fn count(&mut self, least: u32, most: u32) -> u32 {
        let values = u64::from(most.saturating_sub(least)) + 1;
        // A multiply and shift; the bias of 2⁻³² does not matter here.
        let drawn = (((self.stream.next_u64() >> 32) * values) >> 32) as u32;
        least + drawn
    }

    /// +1 or −1.
    pub fn sign(&mut self) -> f64 {
        if self.stream.next_u64() >> 63 == 0 {
            1.0
        } else {
            -1.0
        }
    }

    /// A unit vector, uniform on the circle or on the sphere.
    pub fn direction(&mut self, planar: bool) -> Vec3 {
        let turns = self.unit();
        if planar {
            return level(turns);
        }
        let z = 2.0 * self.unit() - 1.0;
        level(turns) * libm::sqrt(1.0 - z * z) + Vec3::Z * z
    }

    /// A point of the disc of `radius` about the origin and perpendicular to `axis`, uniform; in
    /// the plane, of the line across it.
    pub fn offset(&mut self, axis: Vec3, radius: f64, planar: bool) -> Vec3 {
        let horizontal = libm::sqrt(axis.x * axis.x + axis.y * axis.y);
        let left = if horizontal > 1e-9 {
            Vec3::new(-axis.y, axis.x, 0.0) / horizontal
        } else {
            Vec3::Y
        };
        if planar {
            return left * (radius * (2.0 * self.unit() - 1.0));
        }
        let up = axis.cross(left);
        let distance = radius * libm::sqrt(self.unit());
        let (sin, cos) = libm::sincos(TAU * self.unit());
        (left * cos + up * sin) * distance
    }
}
