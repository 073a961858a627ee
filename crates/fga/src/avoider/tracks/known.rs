//! What is known of an obstacle.

use crate::Vec3;
use crate::avoider::intruders::Trend;
use crate::situation::{Movement, Obstacle, ObstacleKind, ProtectedVolume};

/// An obstacle at its last report, over the ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub(super) obstacle: Obstacle,
    pub(super) heard_s: f64,
    /// Distance of its hazard at its last step, metres.
    pub(super) distance_m: f64,
    pub(super) trend: Trend,
}

impl Known {
    /// Zeros.
    pub(super) const NONE: Self = Self {
        obstacle: Obstacle {
            kind: ObstacleKind::Passengers,
            movement: Movement::AtRest,
            ..Obstacle::straight(
                0,
                Vec3::ZERO,
                Vec3::ZERO,
                ProtectedVolume::Sphere { radius_m: 0.0 },
            )
        },
        heard_s: 0.0,
        distance_m: 0.0,
        trend: Trend::STRAIGHT,
    };

    /// Its extrapolation without reports: straight on, and within its bounds.
    pub(super) fn coasted(&self, missing_s: f64) -> Obstacle {
        let mut obstacle = self.obstacle;
        obstacle.position_m = obstacle.position_after_m(missing_s);
        if let Some(bounds) = obstacle.movement.bounds() {
            let speed_mps = obstacle.velocity_mps.length();
            let across_mps2 = speed_mps * bounds.turn_rate_radps;
            let change_mps2 = across_mps2.max(bounds.acceleration_mps2);
            obstacle.uncertainty.position_m += 0.5 * change_mps2 * missing_s * missing_s;
        }
        obstacle
    }
}
