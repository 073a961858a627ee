//! A picture of the moment, for viewers of the flight.

use alloc::sync::Arc;

use fga::Vec3;
use fga::avoider::Decision;
use fga::situation::Obstacle;
use fga::vehicle::Vehicle;
use fga_formats::terrain::LocalGround;

use crate::authority::Authority;
use crate::ground::AboveGround;
use crate::ownship::OwnState;

/// The last decision and its input.
#[derive(Debug, Clone)]
pub struct FlightPicture {
    /// Time of the decision's state, seconds since the companion began.
    pub time_s: f64,
    /// The aircraft at that moment.
    pub own: OwnState,
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
    /// The height above the ground, here and ahead; `None` where no ground is known.
    pub above_ground: Option<AboveGround>,
    /// The ground around the vehicle; another one from time to time.
    pub ground: Option<Arc<LocalGround>>,
}
