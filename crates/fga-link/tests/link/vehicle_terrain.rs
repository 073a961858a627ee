//! Ground asked of the vehicle itself, which answers `TERRAIN_CHECK` post by post as ArduPilot does.

use alloc::sync::Arc;
use core::sync::atomic::{AtomicBool, Ordering};

use fga_emulator::{EmulatorSettings, PlaneMode};

use crate::common::{GOOD, Intruder, Network, World};
use crate::station_terrain::pieces;
use crate::terrain::{Flown, PROTECTED_M, choice, fly_beside, is_told};

const CONFIG: &str = "[terrain]\nsource = \"vehicle\"\nclearance_m = 30.0\n";

/// A vehicle and a head-on intruder; its card has heights by metres east and north of home.
fn vehicle(
    network: Network,
    height_m: impl Fn(f64, f64) -> Option<f32> + Send + Sync + 'static,
) -> World {
    let mut world = World::with(EmulatorSettings::default(), CONFIG, network, 8);
    let home = *world.emulator.home();
    world
        .emulator
        .set_card(move |[latitude_deg, longitude_deg]| {
            let north_m = (latitude_deg - home.latitude_deg) * 110_990.0;
            let east_m = (longitude_deg - home.longitude_deg) * 88_300.0;
            height_m(east_m, north_m)
        });
    world.add(Intruder::head_on());
    world
}

/// A flight past the intruder.
fn asked(
    network: Network,
    height_m: impl Fn(f64, f64) -> Option<f32> + Send + Sync + 'static,
    until_s: f64,
) -> (World, Flown) {
    let mut world = vehicle(network, height_m);
    let mut flown = fly_beside(&mut world, None, until_s, |_| {});
    world.companion.shut_down(until_s);
    flown.log.extend(world.companion.take_log());
    (world, flown)
}

#[test]
fn the_vehicle_is_asked_for_the_ground_and_its_ridge_is_avoided() {
    let side = choice();
    // Posts are 100 m apart: the mission is clear wherever they are.
    let ridge = move |east_m: f64, _| Some(if side * east_m > 105.0 { 400.0 } else { 4.0 });
    let (world, flown) = asked(GOOD, ridge, 130.0);
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    assert_eq!(flown.modes, [PlaneMode::Guided, PlaneMode::Auto]);
    let to_ridge_m = (side * flown.east_m[0]).max(side * flown.east_m[1]);
    assert!(to_ridge_m < 20.0, "{:?}", flown.east_m);
    assert!(is_told(&world, "fga: the ground bounds the way round"));
    // Sixteen posts a piece, twenty posts a second.
    let taken = pieces(&flown, "taken");
    assert!((90..=163).contains(&taken), "{taken}");
    assert_eq!(
        (pieces(&flown, "wrong"), pieces(&flown, "contradicting")),
        (0, 0)
    );
    let texts = world.emulator.texts();
    assert!(
        !is_told(&world, "no terrain") && !is_told(&world, "unknown"),
        "{texts:?}"
    );
}

#[test]
fn a_link_that_loses_a_tenth_asks_again_for_the_posts_that_are_missing() {
    let side = choice();
    let ridge = move |east_m: f64, _| Some(if side * east_m > 105.0 { 400.0 } else { 4.0 });
    // A tenth of the questions and a tenth of the answers.
    let lossy = Network { loss: 0.1, ..GOOD };
    let (world, flown) = asked(lossy, ridge, 130.0);
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    let to_ridge_m = (side * flown.east_m[0]).max(side * flown.east_m[1]);
    let taken = pieces(&flown, "taken");
    println!("taken {taken} {:?}", world.emulator.texts());
    assert!(taken >= 25, "{taken}");
    assert!(to_ridge_m < 20.0, "{:?}", flown.east_m);
}

#[test]
fn a_vehicle_that_knows_no_ground_is_told_and_traffic_is_avoided() {
    let (world, flown) = asked(GOOD, |_, _| None, 130.0);
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    assert!(is_told(&world, "fga: no terrain from the vehicle"));
    assert!(is_told(&world, "fga: avoids over unknown ground"));
    assert_eq!(pieces(&flown, "taken"), 0);
    // Heights that are no ground are left out.
    let (world, flown) = asked(GOOD, |_, _| Some(3e4), 40.0);
    assert!(is_told(&world, "fga: terrain answers that are no ground"));
    assert_eq!(pieces(&flown, "taken"), 0);
}

/// ArduPilot answers then, but knows no height.
#[test]
fn a_vehicle_with_its_terrain_off_is_told_within_seconds_and_asked_once_it_is_on() {
    let mut world = vehicle(GOOD, |_, _| Some(4.0));
    world.emulator.parameters.set("TERRAIN_ENABLE", 0.0);
    let mut told_s = None;
    let flown = fly_beside(&mut world, None, 130.0, |world| {
        if is_told(world, "fga: no terrain: TERRAIN_ENABLE is 0") {
            told_s.get_or_insert(world.time_s);
        }
    });
    assert!(told_s.is_some_and(|told_s| told_s < 5.0), "{told_s:?}");
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    assert_eq!(flown.modes, [PlaneMode::Guided, PlaneMode::Auto]);
    world.set_parameter("TERRAIN_ENABLE", 1.0);
    fly_beside(&mut world, None, 150.0, |_| {});
    let picture = world.companion.picture().expect("a decision");
    assert!(
        picture
            .above_ground
            .and_then(|above| above.here_m)
            .is_some()
    );
}

/// ArduPlane 4.7 gives heights as its card has them until it arms, and from then on so that the ground below it is where it stands.
#[test]
fn ground_from_before_the_vehicle_armed_is_asked_for_again() {
    let settings = EmulatorSettings {
        armed: false,
        ..EmulatorSettings::default()
    };
    let mut world = World::with(settings, CONFIG, GOOD, 8);
    let shifts = Arc::new(AtomicBool::new(false));
    let shifted = Arc::clone(&shifts);
    world.emulator.set_card(move |_| {
        let is_shifted = shifted.load(Ordering::Relaxed);
        Some(if is_shifted { 12.0 } else { 32.0 })
    });
    let run = |world: &mut World, until_s: f64| {
        while world.time_s < until_s {
            world.step();
        }
    };
    run(&mut world, 60.0);
    shifts.store(true, Ordering::Relaxed);
    world.emulator.set_armed(true);
    let here_m = |world: &World| {
        let picture = world.companion.picture().expect("a decision");
        picture.above_ground.and_then(|above| above.here_m)
    };
    // 104 m above the sea: what was known counts until the new heights come.
    run(&mut world, 61.5);
    assert_eq!(here_m(&world).map(f64::round), Some(72.0));
    run(&mut world, 80.0);
    assert_eq!(here_m(&world).map(f64::round), Some(92.0));
}
