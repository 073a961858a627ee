//! A flight that leaves out known decisions ends as the one that makes them all.

use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga_sim::batch::{BatchSettings, empty_world, populate};
use fga_sim::encounters::EncounterSource;
use fga_sim::engine::{Engine, Observer, Outcome};
use fga_sim::policy::PolicyChoice;
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::world::World;

/// Flights differ by rounding alone, metres and seconds.
const ROUNDING: f64 = 1e-9;

/// Wants every decision.
struct Watch;

impl Observer for Watch {}

/// Every number of an outcome and of its separations.
fn numbers(engine: &Engine, outcome: &Outcome) -> Vec<f64> {
    let Outcome {
        min_separation_m,
        min_margin_m,
        max_cross_track_m,
        extra_path_m,
        end_s,
        ..
    } = *outcome;
    let least = engine.separations().iter().flat_map(|separation| {
        let (margin, distance) = (separation.margin(), separation.distance());
        [margin.value_m, distance.value_m, distance.time_s]
    });
    [
        min_separation_m,
        min_margin_m,
        max_cross_track_m,
        extra_path_m,
        end_s,
    ]
    .into_iter()
    .chain(least)
    .collect()
}

/// Flies a world with all decisions and with those that are needed; the numbers of both.
fn fly_both(engine: &mut Engine, world: &World, policy: PolicyChoice) -> [usize; 2] {
    let mut pilot = policy.pilot(&world.settings, &world.vehicle).unwrap();
    let all = engine.fly(world, pilot.as_mut(), &mut Watch);
    let expected = numbers(engine, &all);
    let made = engine.elapsed_ns().len();
    let within = match policy {
        PolicyChoice::Mission => ROUNDING,
        // It gives the commands of known decisions to the bit.
        _ => 0.0,
    };
    pilot.restart();
    let few = engine.fly(world, pilot.as_mut(), &mut ());
    let found = numbers(engine, &few);
    assert_eq!(all.mission_flown, few.mission_flown);
    for (found, expected) in found.iter().zip(&expected) {
        assert!(
            found == expected || (found - expected).abs() < within,
            "{found} instead of {expected}: {few:?} instead of {all:?}"
        );
    }
    [made, engine.elapsed_ns().len()]
}

/// Flies encounters of some families with a model; all decisions, and those that were made.
fn fly(model: VehicleModel, policy: PolicyChoice) -> [usize; 2] {
    let settings = BatchSettings {
        model,
        policy,
        horizon_s: 60.0,
        seed: 3,
        tracks: false,
    };
    let mut world = empty_world(&settings).unwrap();
    let mut engine = Engine::new();
    let mut sum = [0, 0];
    for cell in [
        "threats:3:100-500:0-60",
        "threats:1:300:0",
        "overtaking",
        "wall-gap",
    ] {
        let source = EncounterSource::parse(cell, 5).unwrap();
        for number in 0..60 {
            let encounter = source.encounter(number);
            populate(&mut world, &encounter, &settings.model.protection);
            let [all, made] = fly_both(&mut engine, &world, policy);
            sum = [sum[0] + all, sum[1] + made];
        }
    }
    sum
}

#[test]
fn known_decisions_are_left_out_and_change_nothing() {
    let [all, made] = fly(VehicleModel::built_in().unwrap(), PolicyChoice::Mission);
    assert!(all > 10 * made, "{made} of {all}");
}

#[test]
fn neither_do_they_beside_cylinders_and_with_bank_lag() {
    let mut model = VehicleModel::built_in().unwrap();
    model.protection = ProtectedVolume::Cylinder {
        radius_m: 30.0,
        half_height_m: 12.0,
    };
    model.vehicle.response.bank_time_constant_s = 0.6;
    let [all, made] = fly(model, PolicyChoice::Mission);
    assert!(all > 10 * made, "{made} of {all}");
}

#[test]
fn neither_do_they_in_wind() {
    let mut model = VehicleModel::built_in().unwrap();
    model.wind_mps = Vec3::new(3.0, -4.0, 0.5);
    fly(model, PolicyChoice::Mission);
}

#[test]
fn with_a_dead_time_every_decision_is_made() {
    let mut model = VehicleModel::built_in().unwrap();
    model.wind_mps = Vec3::new(3.0, -4.0, 0.5);
    model.vehicle.response.dead_time_s = 0.35;
    let [all, made] = fly(model, PolicyChoice::Mission);
    assert_eq!(all, made);
}

#[test]
fn the_end_of_a_mission_and_the_horizon_are_not_flown_over() {
    let settings = BatchSettings {
        model: VehicleModel::built_in().unwrap(),
        policy: PolicyChoice::Mission,
        horizon_s: 61.234,
        seed: 3,
        tracks: false,
    };
    let mut world = empty_world(&settings).unwrap();
    let mut engine = Engine::new();
    for ending in [
        fga_sim::world::Ending::Horizon,
        fga_sim::world::Ending::MissionFlown,
    ] {
        world.ending = ending;
        for length_m in [333.3, 1e6] {
            world.mission_m = vec![Vec3::ZERO, Vec3::X * length_m];
            let [all, made] = fly_both(&mut engine, &world, settings.policy);
            assert!(all > 5 * made, "{made} of {all}");
        }
    }
}

#[test]
fn the_avoider_leaves_out_what_it_knows_and_flies_the_same() {
    for lag_s in [0.0, 0.6] {
        let mut model = VehicleModel::built_in().unwrap();
        model.vehicle.response.bank_time_constant_s = lag_s;
        let [all, made] = fly(model, PolicyChoice::default());
        assert!(
            2 * all > 5 * made,
            "{made} of {all} with a lag of {lag_s} s"
        );
    }
}

#[test]
fn the_avoider_leaves_out_nothing_among_what_it_cannot_foresee() {
    let mut noisy = VehicleModel::built_in().unwrap();
    noisy.sensor.position_sigma_m = 3.0;
    let mut slow = VehicleModel::built_in().unwrap();
    slow.sensor.update_period_s = 0.5;
    let mut late = VehicleModel::built_in().unwrap();
    late.vehicle.response.dead_time_s = 0.35;
    for model in [noisy, slow, late] {
        let [all, made] = fly(model, PolicyChoice::default());
        assert_eq!(all, made);
    }
}
