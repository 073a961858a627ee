//! Random numbers of the tests and examples, the same for ever.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "tests and examples use it in part"
)]

/// `SplitMix64`: small, seeded, the same everywhere.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// About normal, with σ: the sum of twelve.
    pub fn normal(&mut self, sigma: f64) -> f64 {
        sigma * (0..12).map(|_| self.uniform(-0.5, 0.5)).sum::<f64>()
    }

    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 / (1_u64 << 53) as f64)
    }
}
