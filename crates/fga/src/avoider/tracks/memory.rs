//! What is known of each obstacle, at this step and the last one.

use super::MAX_TRACKED;
use crate::Vec3;
use crate::avoider::intruders::Trend;
use crate::situation::{Obstacle, ProtectedVolume};

/// The obstacles of a step, and how many of them the next one remembers.
#[derive(Debug, Clone)]
pub(super) struct Memory {
    pub(super) known: [Known; MAX_TRACKED],
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

    pub(super) fn get(&self, place: usize) -> Option<&Known> {
        self.known.get(..self.len)?.get(place)
    }

    /// The obstacle with an identifier; most often it has the same index as before.
    pub(super) fn of(&self, id: u32, place: usize) -> Option<&Known> {
        let is_it = |known: &&Known| known.obstacle.id == id;
        let all = self.known.get(..self.len)?;
        self.get(place)
            .filter(is_it)
            .or_else(|| all.iter().find(is_it))
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
