//! What a mission file says.

use fga::situation::Passing;

use crate::areas::AreaOutline;
use crate::geodesy::Geodetic;

/// A place of a mission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    /// Where; the altitude is above mean sea level, or above the ground.
    pub place: Geodetic,
    /// How it is passed.
    pub passing: Passing,
    /// Whether its altitude is above the ground, and the leg to it follows the ground; [`MissionFile::over`] makes altitudes above the sea of them.
    pub above_ground: bool,
}

/// A fence.
#[derive(Debug, Clone, PartialEq)]
pub struct MissionFence {
    /// Its outline, without holes.
    pub outline: AreaOutline,
    /// Whether the aircraft must stay inside, not outside.
    pub keep_in: bool,
}

/// A mission with its fences and rally points.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MissionFile {
    /// Home, if the file gives it; the altitude is above mean sea level.
    pub home: Option<Geodetic>,
    /// The places in their order, the first of which is where the flight begins; empty for a file of fences only.
    pub waypoints: Vec<Waypoint>,
    /// Speed that the file plans with, metres per second.
    pub cruise_mps: Option<f64>,
    /// Fences.
    pub fences: Vec<MissionFence>,
    /// Rally points; altitudes are above mean sea level.
    pub rally: Vec<Geodetic>,
    /// What of the file is not flown, or flown in another way; one sentence each.
    pub notes: Vec<String>,
}

impl MissionFile {
    /// The contents in words, as in "4 waypoints, 1 fence, 2 rally points".
    pub fn holds(&self) -> String {
        use crate::words::counted;
        format!(
            "{}, {}, {}",
            counted(self.waypoints.len(), "waypoint"),
            counted(self.fences.len(), "fence"),
            counted(self.rally.len(), "rally point")
        )
    }
}
