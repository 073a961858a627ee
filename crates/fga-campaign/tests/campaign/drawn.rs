//! Drawn encounters among what is fixed over the ground.

use fga::avoider::Start;
use fga::situation::Movement;
use fga_campaign::batch::{BatchSettings, populate};
use fga_campaign::encounters::EncounterSource;
use fga_sim::policy::PolicyChoice;
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::world::World;

/// The built-in vehicle, in every second encounter with a bank lag.
pub(crate) fn drawn_settings(number: u64) -> BatchSettings {
    let mut model = VehicleModel::built_in().unwrap();
    if number % 2 == 1 {
        model.vehicle.response.bank_time_constant_s = 0.6;
    }
    BatchSettings {
        model,
        policy: PolicyChoice::Avoider(Start::AtDetection),
        horizon_s: 90.0,
        seed: 3,
        tracks: false,
    }
}

/// Adds one or two intruders; those of every third encounter are crewed.
pub(crate) fn add_intruders(world: &mut World, settings: &BatchSettings, number: u64) {
    let cell = ["threats:1:300-600:0-30", "threats:2:300-600:0-60"][usize::from(number % 4 > 1)];
    let source = EncounterSource::parse(cell, 11).unwrap();
    let encounter = source.encounter(number).unwrap();
    populate(world, &encounter, &settings.model.protection);
    if number.is_multiple_of(3) {
        for obstacle in &mut world.obstacles {
            obstacle.movement = Movement::CREWED;
        }
    }
}
