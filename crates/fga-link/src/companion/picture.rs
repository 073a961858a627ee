//! A picture of the moment, for viewers of the flight.

use fga::Vec3;
use fga::avoider::Decision;
use fga::situation::{Obstacle, ObstacleKind};
use fga::vehicle::Vehicle;

use super::Companion;
use crate::authority::Authority;
use crate::ownship::State;

/// The last decision and its input.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Time of the decision's state, seconds since the companion began.
    pub time_s: f64,
    /// The aircraft at that moment.
    pub own: State,
    /// The decision.
    pub decision: Decision,
    /// Name of the threat, if any.
    pub threat_name: Option<String>,
    /// Who flies.
    pub authority: Authority,
    /// The planned limits.
    pub vehicle: Vehicle,
    /// Other aircraft and virtual obstacles with their names; without fence, floor and ceiling.
    pub obstacles: Vec<(Obstacle, String)>,
    /// The way ahead, metres, local frame.
    pub waypoints_m: Vec<Vec3>,
    /// Horizon of the certificate, seconds.
    pub horizon_s: f64,
    /// Distance kept beyond a protected volume, metres.
    pub margin_m: f64,
}

impl Companion {
    /// Time of the last decision's state, seconds.
    pub fn decided_for_s(&self) -> Option<f64> {
        self.decided.map(|decided| decided.for_s)
    }

    /// The picture of the last decision; `None` before the first.
    pub fn picture(&self) -> Option<Picture> {
        let decided = self.decided?;
        let threat = decided.decision.record.threat;
        let beings = self
            .around
            .obstacles()
            .iter()
            .filter(|obstacle| obstacle.kind != ObstacleKind::NaturalBarrier);
        Some(Picture {
            time_s: decided.for_s,
            own: decided.own,
            decision: decided.decision,
            threat_name: threat.map(|threat| self.around.name(threat.id)),
            authority: self.keeper.state(),
            vehicle: *self.vehicle()?,
            obstacles: beings
                .map(|obstacle| (*obstacle, self.around.name(obstacle.id)))
                .collect(),
            waypoints_m: self.route.waypoints_m().to_vec(),
            horizon_s: self.config.protection.horizon_s,
            margin_m: self.config.protection.margin_m,
        })
    }
}
