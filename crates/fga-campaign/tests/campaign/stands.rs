//! A flight that leaves out known decisions ends as the one that makes them all.

use std::path::Path;

use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga_campaign::batch::{BatchSettings, empty_world, populate};
use fga_campaign::campaign::{Campaign, file};
use fga_campaign::encounters::EncounterSource;
use fga_sim::engine::{Engine, Observer, Outcome};
use fga_sim::policy::PolicyChoice;
use fga_sim::track::{Track, TrackPoint};
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::world::World;

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
fn fly_both(engine: &mut Engine, world: &World, policy: &PolicyChoice) -> [usize; 2] {
    let mut pilot = policy.pilot(&world.settings, &world.vehicle).unwrap();
    let all = engine.fly(world, pilot.as_mut(), &mut Watch);
    let expected = numbers(engine, &all);
    let made = engine.elapsed_ns().len();
    pilot.restart();
    let few = engine.fly(world, pilot.as_mut(), &mut ());
    let found = numbers(engine, &few);
    let events = |outcome: &Outcome| {
        let Outcome {
            threat_s,
            start_s,
            clear_s,
            rejoined_s,
            mission_flown,
            waypoints_missed,
            ..
        } = *outcome;
        let seen_s = engine.first_seen_s().to_vec();
        let times_s = (threat_s, start_s, clear_s, rejoined_s);
        (times_s, mission_flown, waypoints_missed, seen_s)
    };
    assert_eq!(events(&all), events(&few));
    // What is flown and measured does not depend on the decisions in between.
    assert_eq!(found, expected, "{few:?} instead of {all:?}");
    [made, engine.elapsed_ns().len()]
}

/// Flies encounters of some families with a model; all decisions, and those that were made.
fn fly(model: VehicleModel, policy: &PolicyChoice) -> [usize; 2] {
    let settings = BatchSettings {
        model,
        policy: policy.clone(),
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
            let encounter = source.encounter(number).unwrap();
            populate(&mut world, &encounter, &settings.model.protection);
            let [all, made] = fly_both(&mut engine, &world, policy);
            sum = [sum[0] + all, sum[1] + made];
        }
    }
    sum
}

#[test]
fn known_decisions_are_left_out_and_change_nothing() {
    let [all, made] = fly(VehicleModel::built_in().unwrap(), &PolicyChoice::Mission);
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
    let [all, made] = fly(model, &PolicyChoice::Mission);
    assert!(all > 10 * made, "{made} of {all}");
}

#[test]
fn neither_do_they_in_wind() {
    let mut model = VehicleModel::built_in().unwrap();
    model.wind_mps = Vec3::new(3.0, -4.0, 0.5);
    fly(model, &PolicyChoice::Mission);
}

#[test]
fn with_a_dead_time_every_decision_is_made() {
    let mut model = VehicleModel::built_in().unwrap();
    model.wind_mps = Vec3::new(3.0, -4.0, 0.5);
    model.vehicle.response.dead_time_s = 0.35;
    let [all, made] = fly(model, &PolicyChoice::Mission);
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
            let [all, made] = fly_both(&mut engine, &world, &settings.policy);
            assert!(all > 5 * made, "{made} of {all}");
        }
    }
}

/// Flies encounters of `table4-dynamic` with the aircraft of a vehicle file under a policy, changed by `change`; all decisions, and
/// those that were made.
fn fly_campaign(
    vehicle: &str,
    policy: &str,
    count: u64,
    change: impl Fn(&mut World),
) -> [usize; 2] {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = std::fs::read_to_string(root.join("vehicles").join(vehicle)).unwrap();
    let overrides = file::Overrides {
        vehicle: Some(text),
        ..Default::default()
    };
    let path = root.join("campaigns/table4-dynamic.toml");
    let campaign = Campaign::new(file::read(&path, &overrides).unwrap(), &path).unwrap();
    let policy = PolicyChoice::parse(policy, None).unwrap();
    let mut engine = Engine::new();
    let mut sum = [0, 0];
    for number in 0..count {
        let mut world = campaign.plan(number).unwrap().world;
        change(&mut world);
        let [all, made] = fly_both(&mut engine, &world, &policy);
        sum = [sum[0] + all, sum[1] + made];
    }
    sum
}

#[test]
fn nothing_changes_in_wind_with_noise_among_turning_intruders_and_on_several_legs() {
    let is_windy = |world: &mut World| world.wind_mps = Vec3::new(2.0, -4.0, 0.3);
    let is_noisy = |world: &mut World| world.sensor.position_sigma_m = 2.0;
    let has_legs = |world: &mut World| {
        let places_m = [(0.0, 0.0), (150.0, 0.0), (300.0, 200.0), (1e4, 200.0)];
        world.mission_m = places_m.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec();
    };
    for vehicle in ["paper.toml", "rascal-110.toml", "apprentice-15e.toml"] {
        fly_campaign(vehicle, "turn-aware", 40, is_windy);
        fly_campaign(vehicle, "turn-aware", 10, is_noisy);
        fly_campaign(vehicle, "turn-aware", 30, has_legs);
        fly_campaign(vehicle, "turn-aware", 30, |world| {
            for obstacle in &mut world.obstacles {
                obstacle.track = turning(&obstacle.track);
            }
        });
    }
    for policy in ["published", "circle", "mvp", "orca", "operator-f3442"] {
        fly_campaign("paper.toml", policy, 20, |_| ());
    }
}

/// A track that turns to the left after ten seconds, in chords of half a second.
fn turning(track: &Track) -> Track {
    let (from_m, velocity_mps) = track.at(0.0).unwrap();
    let step_s = 0.5;
    let (mut time_s, mut position_m) = (0.0, from_m);
    let mut points = Vec::new();
    let (mut forward, mut left) = (
        velocity_mps,
        Vec3::new(-velocity_mps.y, velocity_mps.x, 0.0),
    );
    while time_s < 700.0 {
        points.push(TrackPoint { time_s, position_m });
        if time_s >= 10.0 {
            let (sin, cos) = 0.05_f64.sin_cos();
            (forward, left) = (forward * cos + left * sin, left * cos - forward * sin);
        }
        position_m += forward * step_s;
        time_s += step_s;
    }
    Track::through(points).unwrap()
}
