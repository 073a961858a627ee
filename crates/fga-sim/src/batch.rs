//! Encounters from a file, each flown in closed loop.
//!
//! The aircraft starts at the origin on the line along +x, which is its mission; obstacles fly
//! straight and are known from the start, whatever the surveillance radius. Each obstacle's volume
//! is a sphere of its row's radius; where the vehicle file protects a cylinder, it is a cylinder of
//! the row's radius and the file's half height. A flight ends at the horizon, or earlier once the
//! aircraft is back on the line (within 1 m and 1°) in cruise and every obstacle has passed.
//!
//! Results do not depend on the number of threads: each encounter flies alone, with its own stream of
//! noise, and rows come out in the order of the file.

mod together;
mod tracks;

pub use together::{Questions, fly_together};
pub use tracks::{Tracks, fly_tracks};

use fga::Vec3;
use fga::avoider::SettingsError;
use fga_formats::InputError;
use fga_formats::encounters::Encounter;
use fga_formats::number::push_fixed;
use fga_formats::words::push_csv_field;
use rayon::prelude::*;

use fga::situation::{Obstacle, ProtectedVolume};

use crate::engine::{Engine, Observer, Outcome, Sample};
use crate::own::FailureKind;
use crate::policy::{PolicyChoice, PolicyPilot, PolicySettings};
use crate::run::{Plan, RunLog, fly};
use crate::track::Track;
use crate::vehicle_file::VehicleModel;
use crate::wind::crab;
use crate::world::{Ending, StartState, World, WorldObstacle};

/// Encounters between two writes; it bounds the memory.
const BLOCK: usize = 512;

/// Length of the mission along +x, metres: longer than any flight.
const MISSION_LENGTH_M: f64 = 1e6;

/// Columns of `results.csv`.
pub const RESULT_COLUMNS: &str = "encounter,separated,min_separation_m,min_margin_m,start_s,clear_s,max_cross_track_m,extra_path_m,waypoints_missed";

/// The column after them for a policy of one's own.
pub const FAILURE_COLUMN: &str = "policy_failure";

/// The column after all others for encounters with names.
pub const NAME_COLUMN: &str = "name";

/// The first line of `results.csv`.
pub fn result_columns(is_own: bool, is_named: bool) -> String {
    let mut columns = RESULT_COLUMNS.to_owned();
    let more = [(is_own, FAILURE_COLUMN), (is_named, NAME_COLUMN)];
    for (_, name) in more.into_iter().filter(|(is_there, _)| *is_there) {
        columns.push(',');
        columns.push_str(name);
    }
    columns
}

/// Columns of `timing.csv`.
pub const TIMING_COLUMNS: &str = "encounter,decision_median_us,decision_max_us";

/// Columns of `tracks.csv`.
pub const TRACK_COLUMNS: &str = "encounter,t_s,x_m,y_m,z_m,course_rad,climb_rad,bank_rad";

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

/// One flown encounter.
#[derive(Debug, Clone, PartialEq)]
pub struct BatchRow {
    /// The encounter's number.
    pub encounter: u64,
    /// The result of the flight.
    pub outcome: Outcome,
    /// Median time of a decision, nanoseconds.
    pub decision_median_ns: u64,
    /// Longest time of a decision, nanoseconds.
    pub decision_max_ns: u64,
    /// Number of decisions.
    pub decisions: usize,
    /// How the policy failed.
    pub failure: Option<FailureKind>,
    /// Its rows of `tracks.csv`; empty without `tracks`.
    pub track_rows: Vec<u8>,
}

/// Reasons why a batch cannot fly.
#[derive(Debug, thiserror::Error)]
pub enum BatchError<E> {
    /// Settings or limits that the core refuses.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The wind is too strong to hold the line.
    #[error(
        "wind of {wind_mps} m/s across or against an airspeed of {airspeed_mps} m/s, expected less: the line cannot be flown"
    )]
    Wind {
        /// Its speed, metres per second.
        wind_mps: f64,
        /// The vehicle's airspeed, metres per second.
        airspeed_mps: f64,
    },
    /// A recording that cannot be read any more.
    #[error(transparent)]
    Input(#[from] InputError),
    /// `take` refused a row.
    #[error(transparent)]
    Sink(E),
}

/// The world of a batch without its obstacles; `None` if the wind is too strong for the line.
pub fn empty_world(settings: &BatchSettings) -> Option<World> {
    let model = &settings.model;
    let (course_rad, climb_rad) = crab(Vec3::X, model.vehicle.airspeed_mps, model.wind_mps)?;
    Some(World {
        mission_m: vec![Vec3::ZERO, Vec3::X * MISSION_LENGTH_M],
        passing: Vec::new(),
        limits_m: settings.model.limits_m,
        zones: Vec::new(),
        start: StartState {
            position_m: Vec3::ZERO,
            course_rad,
            climb_rad,
        },
        vehicle: model.vehicle,
        autopilot: model.autopilot,
        settings: PolicySettings {
            avoider: fga::avoider::Settings {
                surveillance_radius_m: f64::INFINITY,
                ..model.settings.avoider
            },
            ..model.settings
        },
        wind_mps: model.wind_mps,
        gust: None,
        obstacles: Vec::new(),
        sensor: crate::sensor::SensorSettings {
            range_m: f64::INFINITY,
            ..model.sensor
        },
        more_sensors: Vec::new(),
        seed: settings.seed,
        stream: 0,
        horizon_s: settings.horizon_s,
        ending: Ending::BackAndPassed,
        recorded: None,
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

/// Flies every encounter on the threads of the current pool and passes the rows to `take` in the order
/// of the encounters.
///
/// # Errors
/// Settings that cannot be flown, or the first error of `take`.
pub fn fly_all<E>(
    encounters: &[Encounter],
    settings: &BatchSettings,
    mut take: impl FnMut(&BatchRow) -> Result<(), E>,
) -> Result<(), BatchError<E>> {
    let world = empty_world(settings).ok_or_else(|| BatchError::Wind {
        wind_mps: settings.model.wind_mps.length(),
        airspeed_mps: settings.model.vehicle.airspeed_mps,
    })?;
    // Checks the settings once; the same ones fly every encounter.
    let pilot = || settings.policy.pilot(&world.settings, &world.vehicle);
    pilot()?;
    for block in encounters.chunks(BLOCK) {
        let rows: Vec<Result<BatchRow, SettingsError>> = block
            .par_iter()
            .map_init(
                || pilot().map(|pilot| (Engine::new(), world.clone(), pilot)),
                |thread, encounter| {
                    let (engine, world, pilot) = thread.as_mut().map_err(|error| *error)?;
                    Ok(fly_one(engine, world, pilot.as_mut(), encounter, settings))
                },
            )
            .collect();
        for row in rows {
            take(&row?).map_err(BatchError::Sink)?;
        }
    }
    Ok(())
}

/// Flies one encounter with a pilot of the settings' policy.
pub fn fly_one(
    engine: &mut Engine,
    world: &mut World,
    pilot: &mut dyn PolicyPilot,
    encounter: &Encounter,
    settings: &BatchSettings,
) -> BatchRow {
    populate(world, encounter, &settings.model.protection);
    pilot.restart();
    let mut rows = TrackRows {
        encounter: encounter.id,
        rows: Vec::new(),
    };
    let outcome = if settings.tracks {
        engine.fly(world, pilot, &mut rows)
    } else {
        engine.fly(world, pilot, &mut ())
    };
    BatchRow {
        track_rows: rows.rows,
        failure: pilot.failure(),
        ..timed(encounter.id, outcome, engine.elapsed_ns())
    }
}

/// The result of a flight with the durations of its decisions, nanoseconds in any order.
pub(crate) fn timed(encounter: u64, outcome: Outcome, elapsed_ns: &mut [u64]) -> BatchRow {
    let decisions = elapsed_ns.len();
    let decision_max_ns = elapsed_ns.iter().copied().max().unwrap_or(0);
    let decision_median_ns = match decisions {
        0 => 0,
        count => *elapsed_ns.select_nth_unstable(count / 2).1,
    };
    BatchRow {
        encounter,
        outcome,
        decision_median_ns,
        decision_max_ns,
        decisions,
        failure: None,
        track_rows: Vec::new(),
    }
}

/// An encounter as a plan for [`show`], in the world of [`empty_world`].
pub fn plan(mut world: World, encounter: &Encounter, model: &VehicleModel) -> Plan {
    populate(&mut world, encounter, &model.protection);
    Plan {
        name: format!("encounter {}", encounter.id),
        description: String::new(),
        names: encounter
            .obstacles
            .iter()
            .map(|obstacle| format!("obstacle {}", obstacle.id))
            .collect(),
        frame: None,
        notes: Vec::new(),
        time_offset_s: 0.0,
        model: model.clone(),
        world,
    }
}

/// Flies the plan of an encounter exactly as [`fly_all`] does and logs everything.
///
/// # Errors
/// Settings or limits that the core refuses.
pub fn show(plan: Plan, policy: &PolicyChoice) -> Result<RunLog, SettingsError> {
    let mut log = fly(plan, policy, &mut |_| ())?;
    // The line has no end; show the flown part and a little more.
    let farthest_m = log
        .samples
        .iter()
        .map(|sample| sample.position_m.x)
        .fold(100.0, f64::max);
    log.plan.world.mission_m = vec![Vec3::ZERO, Vec3::X * (farthest_m * 1.1)];
    Ok(log)
}

/// Collects the rows of `tracks.csv`.
struct TrackRows {
    encounter: u64,
    rows: Vec<u8>,
}

impl Observer for TrackRows {
    fn sample(&mut self, sample: &Sample) {
        self.rows
            .extend_from_slice(self.encounter.to_string().as_bytes());
        self.rows.push(b',');
        push_sample(&mut self.rows, sample);
        self.rows.push(b'\n');
    }
}

/// Appends `t_s,x_m,y_m,z_m,course_rad,climb_rad,bank_rad` of a sample, six decimals each.
pub fn push_sample(row: &mut Vec<u8>, sample: &Sample) {
    push_fixed(row, sample.time_s, 6);
    for value in [
        sample.position_m.x,
        sample.position_m.y,
        sample.position_m.z,
        sample.course_rad,
        sample.climb_rad,
        sample.bank_rad,
    ] {
        row.push(b',');
        push_fixed(row, value, 6);
    }
}

/// The least margin as written: the written number decides whether it is negative.
fn written(value_m: f64) -> f64 {
    libm::rint(value_m * 1e6) / 1e6
}

impl BatchRow {
    /// Whether the flight entered no volume, by the rule of `results.csv`.
    pub fn separated(&self) -> bool {
        written(self.outcome.min_margin_m) >= 0.0
    }

    /// Appends its row of `results.csv`, with the failure of the policy if it is one of one's own, and with the name of the
    /// encounter if it has one.
    pub fn push_result(&self, row: &mut Vec<u8>, is_own: bool, name: Option<&str>) {
        let outcome = &self.outcome;
        row.extend_from_slice(self.encounter.to_string().as_bytes());
        row.extend_from_slice(if self.separated() {
            b",true"
        } else {
            b",false"
        });
        for value in [
            Some(outcome.min_separation_m),
            Some(outcome.min_margin_m),
            outcome.start_s,
            outcome.clear_s,
            Some(outcome.max_cross_track_m),
            Some(outcome.extra_path_m),
        ] {
            row.push(b',');
            if let Some(value) = value {
                push_fixed(row, value, 6);
            }
        }
        row.push(b',');
        row.extend_from_slice(outcome.waypoints_missed.to_string().as_bytes());
        if is_own {
            row.push(b',');
            row.extend_from_slice(self.failure.map_or("", FailureKind::name).as_bytes());
        }
        if let Some(name) = name {
            row.push(b',');
            push_csv_field(row, name.as_bytes());
        }
        row.push(b'\n');
    }

    /// Appends its row of `timing.csv`.
    pub fn push_timing(&self, row: &mut Vec<u8>) {
        row.extend_from_slice(self.encounter.to_string().as_bytes());
        for nanoseconds in [self.decision_median_ns, self.decision_max_ns] {
            row.push(b',');
            push_fixed(row, nanoseconds as f64 / 1000.0, 3);
        }
        row.push(b'\n');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crab_angle_flies_along_the_line() {
        let wind = Vec3::new(3.0, -5.0, 1.0);
        let (course, climb) = crab(Vec3::X, 15.0, wind).unwrap();
        let ground = fga::angle::direction(course, climb) * 15.0 + wind;
        assert!(ground.y.abs() < 1e-12 && ground.z.abs() < 1e-12 && ground.x > 15.0);
        assert_eq!(crab(Vec3::X, 15.0, Vec3::new(-16.0, 0.0, 0.0)), None);
        assert_eq!(crab(Vec3::X, 15.0, Vec3::new(0.0, 15.0, 0.0)), None);
    }
}
