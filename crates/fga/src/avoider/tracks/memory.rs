//! What was known of each obstacle at the last step.

use super::MAX_TRACKED;
use crate::Vec3;
use crate::avoider::intruders::Trend;
use crate::situation::{Obstacle, ProtectedVolume};
use fga_proof::list::List;

/// The obstacles at the last step.
pub(super) type Memory = List<Known, MAX_TRACKED>;

/// The obstacle with an identifier; most often it has the same index as before.
pub(super) fn known_as(id: u32, place: usize, all: &[Known]) -> Option<Known> {
    let is_it = |known: &&Known| known.obstacle.id == id;
    let same = all.get(place).filter(is_it);
    same.or_else(|| all.iter().find(is_it)).copied()
}

/// An obstacle at its last report, over the ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub(super) obstacle: Obstacle,
    pub(super) heard_s: f64,
    pub(super) trend: Trend,
}

impl Known {
    pub(super) const NONE: Self = Self {
        obstacle: Obstacle::straight(
            0,
            Vec3::ZERO,
            Vec3::ZERO,
            ProtectedVolume::Sphere { radius_m: 0.0 },
        ),
        heard_s: f64::NEG_INFINITY,
        trend: Trend::STRAIGHT,
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
