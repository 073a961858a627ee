//! A command that takes effect later: the policy saves the avoidable encounters with a dead time as
//! without.

use fga::avoider::Start;
use fga_campaign::batch::{BatchSettings, empty_world, populate};
use fga_campaign::encounters::EncounterSource;
use fga_campaign::oracle::{
    OracleObstacle, OracleSettings, OracleStart, OracleVehicle, best_margin,
};
use fga_sim::engine::Engine;
use fga_sim::policy::PolicyChoice;
use fga_sim::vehicle_file::VehicleModel;

/// Encounters that the oracle saves and the policy loses, of a cell's first `count`.
fn lost(cell: &str, start: Start, count: u64) -> Vec<u64> {
    let source = EncounterSource::parse(cell, 41).unwrap();
    let mut model = VehicleModel::built_in().unwrap();
    model.vehicle.response.dead_time_s = 0.8;
    model.vehicle.response.bank_time_constant_s = 0.4;
    let settings = BatchSettings {
        model,
        policy: PolicyChoice::Avoider(start),
        horizon_s: 60.0,
        seed: 0,
        tracks: false,
    };
    let mut world = empty_world(&settings).unwrap();
    let mut engine = Engine::new();
    let mut lost = Vec::new();
    for number in 0..count {
        let encounter = source.encounter(number).unwrap();
        populate(&mut world, &encounter, &settings.model.protection);
        let pilot = settings.policy.pilot(&world.settings, &world.vehicle);
        let outcome = engine.fly(&world, pilot.unwrap().as_mut(), &mut ());
        if outcome.separated() {
            continue;
        }
        let obstacles: Vec<_> = encounter
            .obstacles
            .iter()
            .map(OracleObstacle::from)
            .collect();
        let answer = best_margin(
            &OracleStart::ORIGIN,
            &OracleVehicle::from(&settings.model.vehicle),
            &obstacles,
            &OracleSettings::default(),
        );
        if answer.avoidable() {
            lost.push(number);
        }
    }
    lost
}

#[test]
fn avoidable_encounters_are_saved_with_a_dead_time() {
    for cell in ["threats:1:300:15-30", "threats:2:100-500:15-30,planar"] {
        for start in [Start::Free, Start::Latest] {
            let lost = lost(cell, start, 40);
            assert!(lost.is_empty(), "{cell} {start:?}: {lost:?}");
        }
    }
}
