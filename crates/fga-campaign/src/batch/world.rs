//! The world in which an encounter is flown.

use fga::Vec3;
use fga::situation::{Obstacle, ProtectedVolume};
use fga_formats::encounters::Encounter;
use fga_judge::track::Track;
use fga_sim::policy::PolicyChoice;
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::wind::crab;
use fga_sim::world::{Ending, StartState, World, WorldObstacle};

use super::row::BatchError;

/// Length of the mission along +x, metres: longer than any flight.
const MISSION_LENGTH_M: f64 = 1e6;

/// The settings of a batch.
#[derive(Debug, Clone, PartialEq)]
pub struct BatchSettings {
    /// The aircraft.
    pub model: VehicleModel,
    /// The policy.
    pub policy: PolicyChoice,
    /// Longest time flown, seconds.
    pub horizon_s: f64,
    /// Master seed of the sensor's noise.
    pub seed: u64,
    /// Whether to make the rows of `tracks.csv`.
    pub tracks: bool,
}

impl BatchSettings {
    /// Those of an aircraft and a policy: flights of a minute, the first seed, no tracks.
    pub const fn of(model: VehicleModel, policy: PolicyChoice) -> Self {
        Self {
            model,
            policy,
            horizon_s: 60.0,
            seed: 0,
            tracks: false,
        }
    }
}

/// The world of a batch without its obstacles; `None` if the wind is too strong for the line.
pub fn empty_world(settings: &BatchSettings) -> Option<World> {
    let model = &settings.model;
    let (course_rad, climb_rad) = crab(Vec3::X, model.vehicle.airspeed_mps, model.wind_mps)?;
    let mission_m = vec![Vec3::ZERO, Vec3::X * MISSION_LENGTH_M];
    let start = StartState {
        position_m: Vec3::ZERO,
        course_rad,
        climb_rad,
    };
    let until = (settings.horizon_s, Ending::BackAndPassed);
    let mut world = World::of(model, mission_m, start, until);
    world.settings.avoider.surveillance_radius_m = f64::INFINITY;
    world.sensor.range_m = f64::INFINITY;
    world.more_sensors.clear();
    world.seed = settings.seed;
    Some(world)
}

/// The same, or an error about the wind.
pub(super) fn flyable_world<E>(settings: &BatchSettings) -> Result<World, BatchError<E>> {
    empty_world(settings).ok_or_else(|| BatchError::Wind {
        wind_mps: settings.model.wind_mps.length(),
        airspeed_mps: settings.model.vehicle.airspeed_mps,
    })
}

/// The volume of an obstacle of an encounter: its own sphere, or a cylinder of the same
/// radius if the vehicle file protects a cylinder.
pub fn volume_of(obstacle: &Obstacle, protection: &ProtectedVolume) -> ProtectedVolume {
    let radius_m = obstacle.volume.radius_m();
    match *protection {
        ProtectedVolume::Sphere { .. } => ProtectedVolume::Sphere { radius_m },
        ProtectedVolume::Cylinder { half_height_m, .. } => ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        },
    }
}

/// Replaces the obstacles of a world by an encounter's.
pub fn populate(world: &mut World, encounter: &Encounter, protection: &ProtectedVolume) {
    world.stream = encounter.id;
    world.obstacles.clear();
    world
        .obstacles
        .extend(encounter.obstacles.iter().zip(0..).map(|(obstacle, id)| {
            let volume = volume_of(obstacle, protection);
            let track = Track::straight(obstacle.position_m, obstacle.velocity_mps);
            WorldObstacle {
                movement: obstacle.movement,
                ..WorldObstacle::new(id, track, volume)
            }
        }));
}
