//! The pilot of a policy.

use fga::avoider::Avoider;
use fga::avoider::belief::BeliefAvoider;
use fga::pilot::Pilot;
use fga_paper::pilot::PaperPilot;

use crate::ahead::Ahead;
use crate::mission_pilot::MissionPilot;
use crate::own::FailureKind;

/// A pilot of a policy.
pub trait PolicyPilot: Pilot {
    /// How the policy has failed in this flight; only policies outside of this crate do.
    fn failure(&self) -> Option<FailureKind> {
        None
    }
}

impl PolicyPilot for Avoider {}
impl PolicyPilot for BeliefAvoider {}
impl PolicyPilot for MissionPilot {}
impl PolicyPilot for PaperPilot {}
impl<P: Pilot> PolicyPilot for Ahead<P> {}
