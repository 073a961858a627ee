//! A flight plan.

mod warnings;

use fga_formats::geodesy::LocalFrame;

use crate::vehicle_file::VehicleModel;
use crate::world::World;

/// A flight plan, with names for people.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Its name.
    pub name: String,
    /// A sentence about it.
    pub description: String,
    /// Names of the obstacles, in the order of the world's.
    pub names: Vec<String>,
    /// What of its files counts otherwise than it is written, each one sentence.
    pub notes: Vec<String>,
    /// The place of the local frame on the earth, if known.
    pub frame: Option<LocalFrame>,
    /// Time of the source at the start of the run, seconds.
    pub time_offset_s: f64,
    /// The aircraft.
    pub model: VehicleModel,
    /// The world to fly.
    pub world: World,
}
