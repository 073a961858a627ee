//! Flights over ground: a manoeuvre keeps above it, the mission is told where it does not, and what is not known is told.
//!
//! The judge is the true track against the heights of the file: it shares nothing with the certificate.

use alloc::sync::Arc;
use std::path::Path;

use fga_emulator::{Mode, Settings};
use fga_formats::terrain::{Given, Terrain, parse};
use fga_link::authority::Authority;

use crate::common::{GOOD, Intruder, World};

const PROTECTED_M: f64 = 60.0;
const CLEARANCE_M: f64 = 30.0;
/// Clearance, and the vertical error of the format.
const ASKED_M: f64 = CLEARANCE_M + 16.0;
const CONFIG: &str = "[terrain]\nfile = \"N37W123.hgt\"\nclearance_m = 30.0\n";
/// Heights a side.
const SIDE: u32 = 3601;

/// The tile around the emulator's home with heights by metres east and north of it; `None` is a hole.
pub fn tile(height_m: impl Fn(f64, f64) -> Option<i16>) -> Arc<Terrain> {
    let home = Settings::default().home;
    let mut bytes = Vec::new();
    for row in 0..SIDE {
        let latitude_deg = 38.0 - f64::from(row) / f64::from(SIDE - 1);
        let north_m = (latitude_deg - home.latitude_deg) * 110_990.0;
        for column in 0..SIDE {
            let longitude_deg = -123.0 + f64::from(column) / f64::from(SIDE - 1);
            let east_m = (longitude_deg - home.longitude_deg) * 88_300.0;
            let height_m = height_m(east_m, north_m).unwrap_or(i16::MIN);
            bytes.extend(height_m.to_be_bytes());
        }
    }
    let file = parse(&bytes, Path::new("N37W123.hgt"), &Given::default()).expect("heights");
    Arc::new(Terrain::new(vec![file]).expect("terrain"))
}

/// The height of the vehicle above the ground, metres.
fn above_m(world: &World, terrain: &Terrain) -> Option<f64> {
    let place = (world.emulator.home()).to_place(world.emulator.plant().position_m());
    let [latitude_deg, longitude_deg] =
        [place.latitude_e7, place.longitude_e7].map(|e7| f64::from(e7) * 1e-7);
    let ground_m = terrain.height_m(latitude_deg, longitude_deg)?;
    Some(f64::from(place.altitude_mm) * 1e-3 - ground_m)
}

/// A head-on intruder meets the vehicle after a minute.
fn head_on(settings: Settings, terrain: Option<&Arc<Terrain>>) -> World {
    let config = if terrain.is_some() { CONFIG } else { "" };
    let mut world = World::with(settings, config, GOOD, 8);
    world.companion.set_terrain(terrain.cloned());
    let mut intruder = Intruder::straight(0x00AB_CDEF, [5.0, 3000.0, 100.0], [0.0, -25.0, 0.0]);
    intruder.shown_m = 1200.0;
    world.add(intruder);
    world
}

/// A flight and its judge.
struct Flown {
    /// Least height above known ground, metres.
    lowest_m: f64,
    over_unknown: bool,
    /// The least and the most metres east.
    east_m: [f64; 2],
    modes: Vec<Mode>,
    log: Vec<serde_json::Value>,
}

fn fly(world: &mut World, terrain: &Terrain, until_s: f64) -> Flown {
    let mut flown = Flown {
        lowest_m: f64::INFINITY,
        over_unknown: false,
        east_m: [0.0; 2],
        modes: Vec::new(),
        log: Vec::new(),
    };
    while world.time_s < until_s {
        world.step();
        match above_m(world, terrain) {
            Some(above_m) => flown.lowest_m = flown.lowest_m.min(above_m),
            None => flown.over_unknown = true,
        }
        let east_m = world.emulator.plant().position_m()[0];
        flown.east_m = [flown.east_m[0].min(east_m), flown.east_m[1].max(east_m)];
        flown.log.extend(world.companion.take_log());
    }
    let changes = world.emulator.mode_changes().iter();
    flown.modes = changes.map(|change| change.mode).collect();
    flown
}

fn is_told(world: &World, words: &str) -> bool {
    world
        .emulator
        .texts()
        .iter()
        .any(|text| text.contains(words))
}

/// Level ground at the height of home.
fn flat() -> Arc<Terrain> {
    tile(|_, _| Some(4))
}

/// The side that it goes to by its own choice: 1 east, -1 west.
fn choice(settings: Settings) -> f64 {
    let terrain = flat();
    let flown = fly(&mut head_on(settings, Some(&terrain)), &terrain, 130.0);
    assert_eq!(flown.modes, [Mode::Guided, Mode::Auto]);
    if flown.east_m[1] > -flown.east_m[0] {
        1.0
    } else {
        -1.0
    }
}

/// A ridge from 40 m beside the mission on, on one side.
fn ridge(side: f64) -> Arc<Terrain> {
    tile(move |east_m, _| Some(if side * east_m > 40.0 { 300 } else { 4 }))
}

#[test]
fn a_ridge_that_a_manoeuvre_without_ground_hits_is_passed_on_the_other_side() {
    let side = choice(Settings::default());
    let terrain = ridge(side);
    let blind = fly(&mut head_on(Settings::default(), None), &terrain, 130.0);
    assert!(blind.lowest_m < 0.0, "{}", blind.lowest_m);
    let mut world = head_on(Settings::default(), Some(&terrain));
    let flown = fly(&mut world, &terrain, 130.0);
    assert!(
        flown.lowest_m >= ASKED_M,
        "{} {:?}",
        flown.lowest_m,
        flown.east_m
    );
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    assert_eq!(flown.modes, [Mode::Guided, Mode::Auto]);
    assert!(is_told(&world, "fga: the ground bounds the way round"));
    assert!(!is_told(&world, "too low") && !is_told(&world, "unknown ground"));
    // The record has the height above the ground.
    let heights = flown
        .log
        .iter()
        .filter_map(|line| line["above_ground_m"].as_f64());
    let heights: Vec<f64> = heights.collect();
    assert!(
        heights.len() > 10
            && heights
                .iter()
                .all(|above_m| (95.0..105.0).contains(above_m))
    );
}

#[test]
fn without_a_choice_of_its_own_the_ground_changes_no_manoeuvre() {
    let (terrain, settings) = (flat(), Settings::default());
    let free = fly(&mut head_on(settings.clone(), None), &terrain, 130.0);
    let mut world = head_on(settings, Some(&terrain));
    let flown = fly(&mut world, &terrain, 130.0);
    assert_eq!(flown.modes, free.modes);
    for (flown_m, free_m) in flown.east_m.iter().zip(free.east_m) {
        assert!((flown_m - free_m).abs() < 1.0, "{flown_m} {free_m}");
    }
    assert!(!is_told(&world, "ground"));
}
