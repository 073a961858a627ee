//! Numbers and vectors from a seed, and a situation, for tests.

use crate::situation::{Mission, Obstacles, Ownship, Situation};
use fga_proof::Vec3;

/// A situation without obstacles of an aircraft on the course 0, at a time, a place and an airspeed.
pub(crate) fn flying(time_s: f64, x_m: f64, airspeed_mps: f64) -> Situation<'static> {
    Situation {
        time_s,
        ownship: Ownship {
            position_m: Vec3::new(x_m, 0.0, 0.0),
            airspeed_mps,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
        },
        obstacles: Obstacles::Rows(&[]),
        mission: Mission::new(&[]),
        wind_mps: Vec3::ZERO,
    }
}

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
