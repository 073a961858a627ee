//! What is around the aircraft: the input of a decision, with its obstacles as rows or columns.

pub use fga_proof::situation::*;

pub use crate::columns::{Columns, ColumnsError, Obstacles};

use fga_proof::Vec3;
use fga_proof::limit::{FASTEST_MPS, LARGEST_M, LATEST_S, MOST_ANGLE_RAD};

/// The input of one decision. Positions and velocities are over the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Situation<'a> {
    /// Time of the state, seconds on any clock that does not run backwards.
    pub time_s: f64,
    /// The aircraft. Its course and climb angle describe its motion through the air.
    pub ownship: Ownship,
    /// The known obstacles, velocities over the ground.
    pub obstacles: Obstacles<'a>,
    /// The mission; the same at every step.
    pub mission: Mission<'a>,
    /// Velocity of the air over the ground, metres per second.
    pub wind_mps: Vec3,
}

impl Situation<'_> {
    /// Whether it is usable: every number of the aircraft, the clock and the
    /// wind is finite and in the range in which a certificate holds (`docs/proof.md`).
    pub fn is_usable(&self) -> bool {
        let own = &self.ownship;
        let angles = Vec3::new(own.course_rad, own.climb_rad, own.bank_rad);
        own.is_valid()
            && self.time_s.is_finite()
            && self.wind_mps.is_finite()
            && own.position_m.abs().max_element() <= LARGEST_M
            && angles.abs().max_element() <= MOST_ANGLE_RAD
            && self.wind_mps.abs().max_element() <= FASTEST_MPS
            && own.airspeed_mps <= FASTEST_MPS
            && self.time_s.abs() <= LATEST_S
    }

    /// Whether the aircraft cannot meet an obstacle within `horizon_s` seconds, whatever its turns. Without a
    /// root: an obstacle just out of reach counts as within it.
    pub fn is_out_of_reach(&self, obstacle: &Obstacle, horizon_s: f64) -> bool {
        let square = |x: f64| x * x;
        let own = &self.ownship;
        let offset = obstacle.position_m - own.position_m;
        // (a + b)² ≤ 2 (a² + b²), twice.
        let speeds = 2.0
            * (square(own.airspeed_mps) + (obstacle.velocity_mps - self.wind_mps).length_squared());
        let size = obstacle.volume.radius_m() + obstacle.volume.half_height_m() + 1e3;
        let reach = 2.0 * (speeds * square(horizon_s) + square(size));
        offset.length_squared() > reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::flying;

    #[test]
    fn numbers_beyond_every_flight_are_unusable() {
        assert!(flying(0.0, 0.0, 10.0).is_usable());
        for time_s in [f64::NAN, 2.0 * LATEST_S] {
            assert!(
                !Situation {
                    time_s,
                    ..flying(0.0, 0.0, 10.0)
                }
                .is_usable()
            );
        }
        let wind_mps = Vec3::new(0.0, f64::INFINITY, 0.0);
        assert!(
            !Situation {
                wind_mps,
                ..flying(0.0, 0.0, 10.0)
            }
            .is_usable()
        );
        assert!(!flying(0.0, 0.0, -1.0).is_usable());
    }

    /// At 10 m/s each, within a minute and 1,060 m of sizes: 2 (400 · 60² + 1060²) is the square of 2,264 m.
    #[test]
    fn out_of_reach_is_what_no_turn_meets() {
        let is_out = |away_m: f64| {
            let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
            let (place_m, velocity_mps) = (Vec3::new(0.0, away_m, 0.0), Vec3::new(10.0, 0.0, 0.0));
            let obstacle = Obstacle::straight(1, place_m, velocity_mps, volume);
            flying(0.0, 0.0, 10.0).is_out_of_reach(&obstacle, 60.0)
        };
        assert!(!is_out(2260.0) && is_out(2270.0));
    }
}
