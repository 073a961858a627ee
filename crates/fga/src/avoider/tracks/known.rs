//! What is known of an obstacle.

use crate::Vec3;
use crate::avoider::intruders::Trend;
use crate::situation::{Movement, Obstacle, ObstacleKind, ProtectedVolume};

/// An obstacle at its last report, over the ground.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    pub(super) obstacle: Obstacle,
    pub(super) heard_s: f64,
    /// Distance of its hazard at its last step, metres.
    pub(super) distance_m: f64,
    pub(super) trend: Trend,
    /// How long it limits the flight, seconds.
    pub(super) until_s: f64,
}

impl Known {
    /// Zeros.
    pub const NONE: Self = Self {
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
        until_s: 0.0,
    };

    /// Its extrapolation without reports: straight on, from a report that has become older.
    pub(super) fn coasted(&self, missing_s: f64) -> Obstacle {
        Obstacle {
            position_m: self.obstacle.position_after_m(missing_s),
            age_s: self.obstacle.age_s.max(0.0) + missing_s,
            ..self.obstacle
        }
    }
}
