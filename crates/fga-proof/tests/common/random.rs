//! Random numbers of tests.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "the tests of several crates use it in part"
)]

/// `SplitMix64` (Steele, Lea and Flood 2014): the same cases on every machine.
pub struct Random(pub u64);

impl Random {
    /// A number from 0 to 1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number in a range.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Whether something of this share happens.
    pub fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }
}
