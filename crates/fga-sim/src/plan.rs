//! A flight to be flown.

use fga_formats::geodesy::LocalFrame;

use crate::vehicle_file::VehicleModel;
use crate::world::World;

/// A flight to be flown, with the names that people give to things.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Its name.
    pub name: String,
    /// A sentence about it.
    pub description: String,
    /// Names of the obstacles, in the order of the world's.
    pub names: Vec<String>,
    /// Where the local frame lies on the earth, where it is known.
    pub frame: Option<LocalFrame>,
    /// Time of the source at the start of the run, seconds.
    pub time_offset_s: f64,
    /// The aircraft.
    pub model: VehicleModel,
    /// What is flown.
    pub world: World,
}
