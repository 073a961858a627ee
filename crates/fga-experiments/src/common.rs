//! Common parts of the experiments: the aircraft, the flight, and the cells.

use clap::Args;
use fga_campaign::batch::{BatchSettings, empty_world, populate};
use fga_campaign::encounters::EncounterSource;
use fga_campaign::oracle::OracleObstacle;
use fga_formats::encounters::Encounter;
use fga_sim::engine::{Engine, Observer, Outcome};
use fga_sim::policy::{Pilot, PolicyChoice};
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::world::World;

/// Bank beyond which a turn has a side, radians (5°).
const BANKED_RAD: f64 = 0.087;

/// How often the bank changes its side.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Reversals {
    pub(crate) count: u32,
    /// The last bank to a side, radians.
    last_rad: f64,
}

impl Reversals {
    /// Takes the next bank, radians.
    pub(crate) fn bank(&mut self, bank_rad: f64) {
        if bank_rad.abs() > BANKED_RAD {
            self.count += u32::from(self.last_rad * bank_rad < 0.0);
            self.last_rad = bank_rad;
        }
    }

    /// Another manoeuvre begins.
    pub(crate) const fn begin(&mut self) {
        self.last_rad = 0.0;
    }
}

/// Time between two decisions, seconds.
pub(crate) const PERIOD_S: f64 = 0.1;

/// Horizon of the decisions, seconds.
pub(crate) const HORIZON_S: f64 = 60.0;

/// Flights drawn by an experiment itself.
#[derive(Args, Debug)]
pub(crate) struct DrawnArgs {
    /// Number of flights, of each kind where there are several.
    #[arg(value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) count: u64,
    /// Master seed.
    #[arg(default_value_t = 1)]
    pub(crate) seed: u64,
}

/// The encounters to draw.
#[derive(Args, Debug)]
pub(crate) struct DrawOptions {
    /// Master seed.
    pub(crate) seed: u64,
    /// Number of encounters in each cell.
    pub(crate) count: u64,
    /// Cells, as in a campaign file; without them the hundred of {1, 2, 3, 5, 10} threats ×
    /// {100–500, 300} m × five speeds, in space and in the plane.
    #[arg(value_name = "CELL")]
    cells: Vec<String>,
}

impl DrawOptions {
    /// The cells with their sources.
    pub(crate) fn sources(&self) -> Result<Vec<(String, EncounterSource)>, String> {
        let names = if self.cells.is_empty() {
            all_cells()
        } else {
            self.cells.clone()
        };
        names
            .into_iter()
            .map(|cell| Ok((cell.clone(), EncounterSource::parse(&cell, self.seed)?)))
            .collect()
    }
}

fn all_cells() -> Vec<String> {
    let mut cells = Vec::new();
    for option in ["", ",planar"] {
        for seen in ["100-500", "300"] {
            for count in [1, 2, 3, 5, 10] {
                for speed in ["0", "0-15", "15-30", "30-45", "45-60"] {
                    cells.push(format!("threats:{count}:{seen}:{speed}{option}"));
                }
            }
        }
    }
    cells
}

/// The aircraft of Table 4, without climbs if everything happens at one altitude.
pub(crate) fn model(planar: bool) -> Result<VehicleModel, String> {
    let mut model = VehicleModel::built_in().map_err(|e| e.to_string())?;
    if planar {
        (model.vehicle.climb_min_rad, model.vehicle.climb_max_rad) = (0.0, 0.0);
    }
    Ok(model)
}

/// The world of an encounter.
pub(crate) fn world(settings: &BatchSettings, encounter: &Encounter) -> Result<World, String> {
    let mut world = empty_world(settings).ok_or("the wind is too strong to hold the line")?;
    populate(&mut world, encounter, &settings.model.protection);
    Ok(world)
}

/// A pilot of the settings' policy for a world.
pub(crate) fn pilot(
    settings: &BatchSettings,
    world: &World,
) -> Result<Box<dyn Pilot + Send>, String> {
    settings
        .policy
        .pilot(&world.settings, &world.vehicle)
        .map(|pilot| -> Box<dyn Pilot + Send> { pilot })
        .map_err(|e| e.to_string())
}

/// The settings of an experiment without noise.
pub(crate) fn settings(
    planar: bool,
    policy: PolicyChoice,
    horizon_s: f64,
) -> Result<BatchSettings, String> {
    Ok(BatchSettings {
        horizon_s,
        ..BatchSettings::of(model(planar)?, policy)
    })
}

/// Flies an encounter.
pub(crate) fn fly(
    settings: &BatchSettings,
    encounter: &Encounter,
    observer: &mut impl Observer,
) -> Result<Outcome, String> {
    let world = world(settings, encounter)?;
    let mut pilot = pilot(settings, &world)?;
    Ok(Engine::new().fly(&world, pilot.as_mut(), observer))
}

/// The obstacles of an encounter for the oracle, in still air.
pub(crate) fn oracle_obstacles(encounter: &Encounter) -> Vec<OracleObstacle> {
    encounter
        .obstacles
        .iter()
        .map(OracleObstacle::from)
        .collect()
}

/// The median; NaN for an empty list.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
