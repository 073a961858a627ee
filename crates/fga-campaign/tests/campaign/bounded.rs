//! The oracle over ground, among zones and within altitude limits, against numbers by hand; and the drawn surroundings.

use alloc::sync::Arc;

use fga::Vec2;
use fga::Vec3;
use fga::zone::ALL_HEIGHTS_M;
use fga_campaign::batch::empty_world;
use fga_campaign::encounters::{EncounterSource, Scenery};
use fga_campaign::oracle::{
    Judge, OracleAnswer, OracleFlight, OracleObstacle, OracleSettings, OracleStart, OracleVehicle,
    Stages, airspace_of, best_margin_within,
};
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::world::{World, WorldGround, WorldOutline, WorldZone};

use crate::drawn::drawn_settings;

/// Ground 100 m below the start, and 300 m above it from so far beside the x axis on, metres.
fn canyon(wide_m: f64) -> Arc<WorldGround> {
    let (columns, spacing_m) = (501_u16, 4.0);
    let heights_m = (0..columns)
        .flat_map(|row| {
            let off_m = (f64::from(row) - 250.0) * spacing_m;
            let height_m = if off_m.abs() >= wide_m { 300.0 } else { -100.0 };
            vec![height_m; usize::from(columns)]
        })
        .collect();
    let place = (Vec2::splat(-250.0 * spacing_m), Vec2::splat(spacing_m));
    Arc::new(WorldGround::new(place, columns.into(), heights_m, (5.0, 20.0)).unwrap())
}

/// A fence so far beside the x axis, metres.
fn fence(wide_m: f64) -> WorldZone {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let corners = corners.map(|(x, y)| Vec2::new(1e4 * x, wide_m * y));
    let outline = WorldOutline::Polygon(corners.to_vec());
    WorldZone::new("fence".into(), true, outline, ALL_HEIGHTS_M).unwrap()
}

fn empty() -> World {
    empty_world(&drawn_settings(0)).unwrap()
}

/// The oracle's answer for a sphere that stands 250 m ahead.
fn answer(world: &World, radius_m: f64, vehicle: &OracleVehicle, stages: Stages) -> OracleAnswer {
    let ahead = [OracleObstacle::sphere(
        Vec3::X * 250.0,
        Vec3::ZERO,
        radius_m,
    )];
    let settings = OracleSettings {
        stages,
        ..OracleSettings::default()
    };
    let airspace = airspace_of(world);
    best_margin_within(&OracleStart::ORIGIN, vehicle, &ahead, airspace, &settings)
}

/// The same for Table 4's aircraft and 30 m.
fn ask(world: &World, stages: Stages) -> OracleAnswer {
    answer(world, 30.0, &OracleVehicle::table_4(), stages)
}

#[test]
fn between_walls_below_a_ceiling_what_has_no_room_is_not_avoidable() {
    let asked = |wide_m, limits_m| {
        let mut world = empty();
        world.ground = Some(canyon(wide_m));
        world.limits_m = limits_m;
        ask(&world, Stages::Two)
    };
    let (low, free) = ((-20.0, 20.0), ALL_HEIGHTS_M);
    assert!(!asked(24.0, low).avoidable());
    assert!(asked(60.0, low).avoidable());
    // Over it: 30 m higher within 250 m.
    assert!(asked(24.0, free).avoidable());
    // 24 m to each side is less than the radius: without ground it would do.
    let mut world = empty();
    world.limits_m = low;
    assert!(ask(&world, Stages::Two).avoidable());
}

/// One turn that leaves the volume leads 900 m on into the fence; a second one brings the aircraft along it. There is no room to circle.
#[test]
fn in_a_corridor_the_oracle_turns_twice_and_its_margin_is_that_of_the_flight() {
    let vehicle = OracleVehicle::table_4().planar();
    let mut world = empty();
    world.zones = vec![fence(34.0)];
    assert!(!answer(&world, 10.0, &vehicle, Stages::One).avoidable());
    let found = answer(&world, 10.0, &vehicle, Stages::Two);
    // Between the sphere and the fence are 24 m: half of it to each side at best.
    let best_m = found.best_margin_m;
    assert!((11.9..=12.0).contains(&best_m), "{best_m}");
    let flight = OracleFlight::new(&OracleStart::ORIGIN, &vehicle, &found.maneuver, 60.0);
    let least_m = (0..=60_000)
        .map(|step| flight.at(f64::from(step) * 1e-3).position_m)
        .map(|at_m| (34.0 - at_m.y.abs()).min(at_m.distance(Vec3::X * 250.0) - 10.0))
        .fold(f64::INFINITY, f64::min);
    assert!((least_m - best_m).abs() < 0.02, "{least_m} {best_m}");
}

#[test]
fn walls_stand_over_the_ground_while_the_air_moves() {
    // 2 m/s across: without a crab angle the aircraft is 120 m beside its line after a minute.
    let mut world = empty();
    world.wind_mps = Vec3::Y * 2.0;
    for (wide_m, is_in) in [(100.0, true), (130.0, false)] {
        world.zones = vec![fence(wide_m)];
        let answer = best_margin_within(
            &OracleStart::ORIGIN,
            &OracleVehicle::table_4().planar(),
            &[],
            airspace_of(&world),
            &OracleSettings::default(),
        );
        let held_m = answer.do_nothing_margin_m;
        assert!((held_m - (wide_m - 120.0)).abs() < 1e-6, "{held_m}");
        assert_eq!(held_m < 0.0, is_in);
    }
}

#[test]
fn what_the_aircraft_begins_on_the_wrong_side_of_does_not_bound_it() {
    let mut world = empty();
    world.limits_m = (50.0, 200.0);
    let mut behind = fence(50.0);
    world.zones = vec![behind.clone()];
    let held_m = |world: &World| ask(world, Stages::One).do_nothing_margin_m;
    // The sphere ahead, not the floor of which it begins 50 m below.
    assert!((held_m(&world) + 30.0).abs() < 1e-6);
    let outline = WorldOutline::Circle {
        center_m: Vec2::ZERO,
        radius_m: 40.0,
    };
    behind = WorldZone::new("here".into(), false, outline, ALL_HEIGHTS_M).unwrap();
    world.zones.push(behind);
    assert!((held_m(&world) + 30.0).abs() < 1e-6);
}

/// Its zones, and heights of its ground.
fn shape(scenery: &Scenery) -> (Vec<WorldZone>, Vec<Option<f64>>) {
    let heights_m = (0..200).map(|index| {
        let at = Vec2::new(f64::from(index % 20), f64::from(index / 20)) * 60.0;
        scenery.ground.as_ref()?.height_m(at)
    });
    (scenery.zones.clone(), heights_m.collect())
}

#[test]
fn drawn_surroundings_leave_the_mission_clear_and_differ_from_each_other() {
    for family in ["valley", "ridges", "ground-wall", "corridor"] {
        let source = EncounterSource::parse(&format!("{family}:2:300-600:0-60"), 4).unwrap();
        let mut faster = source;
        faster.airspeed_mps = 45.0;
        for number in 0..20 {
            let scenery = source.scenery(number);
            assert_eq!(shape(&scenery), shape(&source.scenery(number)));
            assert_ne!(shape(&scenery), shape(&source.scenery(number + 1)));
            assert_eq!(scenery.ground.is_none(), family == "corridor");
            for (scenery, scale) in [(scenery, 1.0), (faster.scenery(number), 3.0)] {
                let (from_m, to_m) = (Vec3::ZERO, Vec3::X * (900.0 * scale));
                if let Some(ground) = &scenery.ground {
                    let asked_m = ground.error_m() + ground.clearance_m();
                    let (least_m, is_known) = ground.along_m(from_m, to_m);
                    assert!(
                        is_known && least_m >= asked_m,
                        "{family} {number}: {least_m}"
                    );
                    // It rises above the aircraft somewhere within reach.
                    let beside = [-500.0, 500.0].map(|y| Vec2::new(500.0, y) * scale);
                    let is_low =
                        |at: &Vec2| ground.height_m(*at).is_some_and(|h| h < -30.0 * scale);
                    assert!(family != "valley" || !beside.iter().all(is_low), "{number}");
                }
                for step in 0..=900 {
                    let at_m = from_m.lerp(to_m, f64::from(step) / 900.0);
                    let is_free = scenery.zones.iter().all(|zone| zone.margin_m(at_m) > 0.0);
                    assert!(is_free, "{family} {number}");
                }
            }
        }
    }
}

/// A sphere ahead, above and below which the aircraft has no room, and beside it too little in the layer of its vehicle file.
#[test]
fn encounters_of_a_file_are_judged_within_the_limits_of_the_vehicle() {
    let mut model = drawn_settings(0).model;
    model.vehicle.turn_radius_m = 200.0;
    let ahead = fga::situation::ProtectedVolume::Sphere { radius_m: 60.0 };
    let encounter = fga_formats::encounters::Encounter {
        id: 0,
        obstacles: vec![fga::situation::Obstacle::straight(
            0,
            Vec3::X * 130.0,
            Vec3::ZERO,
            ahead,
        )],
    };
    let best_m = |model: &VehicleModel| Judge::new(model, 60.0).unwrap().best_margin_m(&encounter);
    let free_m = best_m(&model);
    model.limits_m = (-5.0, 5.0);
    assert!(best_m(&model) < free_m - 1.0, "{} {free_m}", best_m(&model));
}
