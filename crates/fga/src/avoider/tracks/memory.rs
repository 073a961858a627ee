//! What was known of each obstacle at the last step.

use super::MAX_TRACKED;
use crate::Vec3;
use crate::avoider::intruders::Trend;
use crate::situation::{Obstacle, ProtectedVolume};

/// The obstacles at the last step.
#[derive(Debug, Clone)]
pub(super) struct Memory {
    known: [Known; MAX_TRACKED],
    pub(super) len: usize,
}

impl Memory {
    #[expect(
        clippy::large_stack_arrays,
        reason = "no allocation: the caller says where it lies"
    )]
    pub(super) const NONE: Self = Self {
        known: [Known::NONE; MAX_TRACKED],
        len: 0,
    };

    pub(super) fn known(&self, place: usize) -> Option<Known> {
        let known = self.known.get(..self.len)?;
        known.get(place).copied()
    }

    /// The obstacle with an identifier; most often it has the same index as before.
    pub(super) fn of(&self, id: u32, place: usize) -> Option<Known> {
        let is_it = |known: &Known| known.obstacle.id == id;
        self.known(place)
            .filter(is_it)
            .or_else(|| self.known.iter().take(self.len).copied().find(is_it))
    }

    pub(super) fn add(&mut self, known: Known) {
        if let Some(slot) = self.known.get_mut(self.len) {
            *slot = known;
            self.len += 1;
        }
    }
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
