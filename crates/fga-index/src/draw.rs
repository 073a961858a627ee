//! Numbers and vectors from a seed, for tests.

use fga_proof::Vec3;

/// Numbers from a seed.
pub(crate) struct Draw(pub(crate) u64);

impl Draw {
    pub(crate) fn within(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self.0.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
        from + (self.0 >> 11) as f64 / (1_u64 << 53) as f64 * (to - from)
    }

    pub(crate) fn vector(&mut self, most: f64) -> Vec3 {
        let [x, y, z] = [most; 3].map(|most| self.within(-most, most));
        Vec3::new(x, y, z)
    }
}
