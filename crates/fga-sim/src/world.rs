//! The parts of one flight.

pub use crate::obstacle::{TrackReport, WorldObstacle};
pub use crate::zone::{WorldOutline, WorldZone};
pub use fga_formats::terrain::LocalGround as WorldGround;

use alloc::sync::Arc;

use fga::Vec3;
use fga::situation::{Passing, Uncertainty};
use fga::vehicle::Vehicle;
use fga_belief::Source;

use crate::plant::{Autopilot, Gust, PlantDifference};
use crate::sensor::SensorSettings;
use crate::settings::PolicySettings;
use crate::track::Track;
use crate::vehicle_file::VehicleModel;

/// The end of a flight before its horizon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// No earlier end.
    Horizon,
    /// Back on the mission's line with every obstacle passed (its distance no longer shrinks).
    BackAndPassed,
    /// The aircraft has passed the last waypoint.
    MissionFlown,
}

/// Largest distance from the line that counts as back on it, metres.
pub const BACK_WITHIN_M: f64 = 1.0;

/// Largest difference from the line's direction that counts as back on it, radians (1°).
pub const BACK_WITHIN_RAD: f64 = 1.0 * core::f64::consts::PI / 180.0;

/// The aircraft at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartState {
    /// Position, metres, local frame.
    pub position_m: Vec3,
    /// Course through the air, radians.
    pub course_rad: f64,
    /// Climb angle through the air, radians.
    pub climb_rad: f64,
}

/// One flight: aircraft, mission, obstacles, sensor, wind, end.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    /// Waypoints of the mission, metres, local frame; at least two.
    pub mission_m: Vec<Vec3>,
    /// How the aircraft passes each waypoint; fly-by beyond the end of this list.
    pub passing: Vec<Passing>,
    /// The lowest and the highest altitude of a manoeuvre, metres; infinite without a limit.
    pub limits_m: (f64, f64),
    /// The zones of its airspace.
    pub zones: Vec<WorldZone>,
    /// Its ground, where that is known.
    pub ground: Option<Arc<WorldGround>>,
    /// The aircraft at the start.
    pub start: StartState,
    /// The aircraft's limits, as its pilot knows them.
    pub vehicle: Vehicle,
    /// What the aircraft and the air do otherwise, of which the pilot knows nothing.
    pub plant: PlantDifference,
    /// How commands become bank and climb.
    pub autopilot: Autopilot,
    /// The decision settings; the policy is chosen with the pilot.
    pub settings: PolicySettings,
    /// Velocity of the air over the ground, as the pilot knows it, metres per second.
    pub wind_mps: Vec3,
    /// A gust, of which the policy knows nothing.
    pub gust: Option<Gust>,
    /// The obstacles.
    pub obstacles: Vec<WorldObstacle>,
    /// The sensor.
    pub sensor: SensorSettings,
    /// Further sources beside it.
    pub more_sensors: Vec<SensorSettings>,
    /// Master seed of the sensor's noise.
    pub seed: u64,
    /// Stream of the noise: the encounter's number.
    pub stream: u64,
    /// Longest time flown, seconds.
    pub horizon_s: f64,
    /// End of the flight before that.
    pub ending: Ending,
    /// Recorded flight of the aircraft until it first manoeuvres.
    pub recorded: Option<Track>,
}

impl World {
    /// The limits of the aircraft that flies.
    pub fn flies(&self) -> Vehicle {
        self.plant.vehicle(&self.vehicle)
    }

    /// The wind that blows, metres per second.
    pub fn blows_mps(&self) -> Vec3 {
        self.plant.wind_mps(self.wind_mps)
    }

    /// The world of an aircraft alone, with its own settings, limits and sensors.
    pub fn of(
        model: &VehicleModel,
        mission_m: Vec<Vec3>,
        start: StartState,
        (horizon_s, ending): (f64, Ending),
    ) -> Self {
        Self {
            mission_m,
            passing: Vec::new(),
            limits_m: model.limits_m,
            zones: Vec::new(),
            ground: None,
            start,
            vehicle: model.vehicle,
            plant: model.plant,
            autopilot: model.autopilot,
            settings: model.settings,
            wind_mps: model.wind_mps,
            gust: None,
            obstacles: Vec::new(),
            sensor: model.sensor,
            more_sensors: model.more_sensors.clone(),
            seed: 0,
            stream: 0,
            horizon_s,
            ending,
            recorded: None,
        }
    }

    /// The same with its reports as they come: no tracker between them and a policy, which knows their errors.
    pub(crate) fn as_reported(&self) -> Self {
        let mut reported = self.clone();
        let sensors = core::iter::once(&mut reported.sensor).chain(&mut reported.more_sensors);
        for sensor in sensors {
            sensor.tracked = false;
        }
        let errors = &mut reported.settings.errors;
        *errors = self.sensor.errors();
        let mut reports = self.obstacles.iter().flat_map(|obstacle| &obstacle.reports);
        if reports.any(|report| report.uncertainty != Uncertainty::default()) {
            // Each report says its own.
            for sigma in [
                &mut errors.position_m,
                &mut errors.velocity_mps,
                &mut errors.climb_mps,
            ] {
                sigma.source = Source::Assumed;
            }
        }
        reported
    }
}
