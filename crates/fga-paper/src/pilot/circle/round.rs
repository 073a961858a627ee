//! The way round an obstacle that is flown.

use fga::Vec3;
use fga::avoider::Threat;

use super::way::Way;
use crate::algorithm_4::Phase;

/// The way round one obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::pilot) struct Round {
    /// `None` where no way keeps the volume.
    pub(super) way: Option<Way>,
    /// The obstacle and its wind when the way was planned.
    pub(super) id: u32,
    pub(super) wind_mps: Vec3,
    /// Time of the plan, seconds on the situation's clock.
    pub(super) planned_s: f64,
    /// Time of the threat's times, seconds on the situation's clock.
    pub(super) told_s: f64,
    pub(super) threat: Threat,
}

impl Round {
    /// Whether it is flown.
    pub(super) fn is_flown(&self) -> bool {
        let phase = self.way.map(|way| way.phase());
        phase.is_some_and(|phase| !matches!(phase, Phase::Waiting | Phase::Done))
    }
}
