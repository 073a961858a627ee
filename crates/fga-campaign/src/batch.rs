//! Encounters from a file, each flown in closed loop.
//!
//! The aircraft starts at the origin on the line along +x, which is its mission; obstacles fly
//! straight and are known from the start, whatever the surveillance radius. Each obstacle's volume
//! is a sphere of its row's radius; where the vehicle file protects a cylinder, it is a cylinder of
//! the row's radius and the file's half height. Ground and zones are those of the table's surroundings. A flight ends at the horizon, or earlier once the
//! aircraft is back on the line (within 1 m and 1°) in cruise and every obstacle has passed.
//!
//! Results do not depend on the number of threads: each encounter flies alone, with its own stream of
//! noise, and rows come out in the order of the file.

mod row;
mod together;
mod tracks;
mod world;

pub(crate) use row::timed;
pub use row::{
    BatchError, BatchRow, FAILURE_COLUMN, MoreColumns, NAME_COLUMN, RESULT_COLUMNS,
    SURROUNDINGS_COLUMNS, TIMING_COLUMNS, TRACK_COLUMNS, push_sample, result_columns,
};
pub use together::{Questions, fly_together};
pub use tracks::{EncounterTracks, fly_tracks};
pub use world::{BatchSettings, empty_world, populate, volume_of};

use row::{BLOCK, row_of};
use world::flyable_world;

use fga::Vec3;
use fga::avoider::SettingsError;
use fga_formats::encounters::Encounter;
use fga_sim::engine::Engine;
use fga_sim::policy::{PolicyChoice, PolicyPilot};
use fga_sim::run::{Plan, RunLog, fly};
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::world::World;
use rayon::prelude::*;

use crate::drawn::RowTable;

/// Flies every encounter on the threads of the current pool and passes the rows to `take` in the order
/// of the encounters.
///
/// # Errors
/// Settings that cannot be flown, surroundings that cannot be used, or the first error of `take`.
pub fn fly_all<E: Send>(
    rows: &RowTable,
    settings: &BatchSettings,
    mut take: impl FnMut(&BatchRow) -> Result<(), E>,
) -> Result<(), BatchError<E>> {
    let world = flyable_world(settings)?;
    // Checks the settings once; the same ones fly every encounter.
    let pilot = || settings.policy.pilot(&world.settings, &world.vehicle);
    pilot()?;
    for block in rows.encounters.chunks(BLOCK) {
        let flown: Vec<Result<BatchRow, BatchError<E>>> = block
            .par_iter()
            .map_init(
                || pilot().map(|pilot| (Engine::new(), world.clone(), pilot)),
                |thread, encounter| {
                    let (engine, world, pilot) = thread.as_mut().map_err(|error| *error)?;
                    rows.surroundings.scenery(encounter.id)?.place(world);
                    Ok(fly_one(engine, world, pilot.as_mut(), encounter, settings))
                },
            )
            .collect();
        for row in flown {
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
    let asked = (encounter.id, settings.tracks);
    if let Some(seen) = settings.policy.sees(world)
        && let Ok(mut pilot) = settings.policy.pilot(&seen.settings, &seen.vehicle)
    {
        return row_of(engine, &seen, pilot.as_mut(), asked);
    }
    pilot.restart();
    row_of(engine, world, pilot, asked)
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
