//! Flights over ground: manoeuvres keep above the ground; the operator reads where the mission does not, and where the ground is unknown.
//!
//! The judge is the true track against the heights of the file: it shares nothing with the certificate.

use alloc::sync::Arc;
use std::path::Path;
use std::sync::OnceLock;

use fga_emulator::{EmulatorSettings, MissionItem, PlaneMode};
use fga_formats::terrain::{Given, Terrain, parse};
use fga_link::replay::replay;
use fga_link::tlog::TlogWriter;
use fga_link::wire::encode;
use fga_link::{Companion, Config};
use mavlink::dialects::ardupilotmega::{
    DISTANCE_SENSOR_DATA, MavCmd, MavMessage, MavSensorOrientation,
};

use crate::common::{GOOD, Intruder, World};

pub(crate) const PROTECTED_M: f64 = 60.0;
const CLEARANCE_M: f64 = 30.0;
/// Clearance, and the vertical error of the format.
const ASKED_M: f64 = CLEARANCE_M + 16.0;
const CONFIG: &str = "[terrain]\nfile = \"N37W123.hgt\"\nclearance_m = 30.0\n";
/// Heights a side.
const SIDE: u32 = 1201;

/// The tile around the emulator's home with heights by metres east and north of it; `None` is a hole.
pub(crate) fn tile(height_m: impl Fn(f64, f64) -> Option<i16>) -> Arc<Terrain> {
    let home = EmulatorSettings::default().home;
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
pub(crate) fn head_on(settings: EmulatorSettings, terrain: Option<&Arc<Terrain>>) -> World {
    let config = if terrain.is_some() { CONFIG } else { "" };
    let mut world = World::with(settings, config, GOOD, 8);
    world.companion.set_terrain(terrain.cloned());
    world.add(Intruder::head_on());
    world
}

/// A flight and its judge.
pub(crate) struct Flown {
    /// Least height above known ground, metres.
    pub(crate) lowest_m: f64,
    pub(crate) over_unknown: bool,
    /// The least and the most metres east.
    pub(crate) east_m: [f64; 2],
    pub(crate) modes: Vec<PlaneMode>,
    pub(crate) log: Vec<serde_json::Value>,
}

fn fly(world: &mut World, terrain: &Terrain, until_s: f64) -> Flown {
    fly_beside(world, Some(terrain), until_s, |_| {})
}

/// Something else acts after each step.
pub(crate) fn fly_beside(
    world: &mut World,
    terrain: Option<&Terrain>,
    until_s: f64,
    mut other: impl FnMut(&mut World),
) -> Flown {
    let mut flown = Flown {
        lowest_m: f64::INFINITY,
        over_unknown: false,
        east_m: [0.0; 2],
        modes: Vec::new(),
        log: Vec::new(),
    };
    while world.time_s < until_s {
        world.step();
        other(world);
        match terrain.map(|terrain| above_m(world, terrain)) {
            Some(Some(above_m)) => flown.lowest_m = flown.lowest_m.min(above_m),
            Some(None) => flown.over_unknown = true,
            None => {}
        }
        let east_m = world.emulator.plant().position_m()[0];
        flown.east_m = [flown.east_m[0].min(east_m), flown.east_m[1].max(east_m)];
        flown.log.extend(world.companion.take_log());
    }
    let changes = world.emulator.mode_changes().iter();
    flown.modes = changes.map(|change| change.mode).collect();
    flown
}

pub(crate) fn is_told(world: &World, words: &str) -> bool {
    world
        .emulator
        .texts()
        .iter()
        .any(|text| text.contains(words))
}

/// Level ground at the height of home.
fn flat() -> Arc<Terrain> {
    static FLAT: OnceLock<Arc<Terrain>> = OnceLock::new();
    Arc::clone(FLAT.get_or_init(|| tile(|_, _| Some(4))))
}

/// The side that it goes to by its own choice: 1 east, -1 west.
pub(crate) fn choice() -> f64 {
    static SIDE: OnceLock<f64> = OnceLock::new();
    *SIDE.get_or_init(|| {
        let flown = fly(
            &mut head_on(EmulatorSettings::default(), None),
            &flat(),
            130.0,
        );
        assert_eq!(flown.modes, [PlaneMode::Guided, PlaneMode::Auto]);
        if flown.east_m[1] > -flown.east_m[0] {
            1.0
        } else {
            -1.0
        }
    })
}

/// A ridge that begins at the first post beside the mission, 74 m from it, on one side.
fn ridge(side: f64) -> Arc<Terrain> {
    tile(move |east_m, _| Some(if side * east_m > 80.0 { 900 } else { 4 }))
}

#[test]
fn a_ridge_that_a_manoeuvre_without_ground_hits_is_passed_on_the_other_side() {
    let side = choice();
    let terrain = ridge(side);
    let blind = fly(
        &mut head_on(EmulatorSettings::default(), None),
        &terrain,
        130.0,
    );
    assert!(blind.lowest_m < 0.0, "{}", blind.lowest_m);
    let mut world = head_on(EmulatorSettings::default(), Some(&terrain));
    let flown = fly(&mut world, &terrain, 130.0);
    assert!(
        flown.lowest_m >= ASKED_M,
        "{} {:?}",
        flown.lowest_m,
        flown.east_m
    );
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    assert_eq!(flown.modes, [PlaneMode::Guided, PlaneMode::Auto]);
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

/// In a turn ArduPlane climbs and sinks by some degrees. An earlier version took that to last for as long as it looked ahead: over
/// ground 10 m below what it takes, nothing was certified any more, and the manoeuvre changed with each swing.
#[test]
fn a_vehicle_that_keeps_its_altitude_is_not_expected_to_sink_into_the_ground() {
    let terrain = tile(|_, _| Some(50));
    let mut world = head_on(EmulatorSettings::default(), Some(&terrain));
    let mut log = Vec::new();
    while world.time_s < 130.0 {
        world.reported_sink_mps = if (world.time_s % 4.0) < 2.0 {
            1.5
        } else {
            -1.5
        };
        world.step();
        log.extend(world.companion.take_log());
    }
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    assert!(!is_told(&world, "ground"), "{:?}", world.emulator.texts());
    let has = |words: &str| log.iter().filter(|line| line["reason"] == words).count();
    assert!(has("maneuver-chosen") == 1 && has("best-available") == 0);
}

#[test]
fn without_a_choice_of_its_own_the_ground_changes_no_manoeuvre() {
    let (terrain, settings) = (flat(), EmulatorSettings::default());
    let free = fly(&mut head_on(settings.clone(), None), &terrain, 130.0);
    let mut world = head_on(settings, Some(&terrain));
    let flown = fly(&mut world, &terrain, 130.0);
    assert_eq!(flown.modes, free.modes);
    for (flown_m, free_m) in flown.east_m.iter().zip(free.east_m) {
        assert!((flown_m - free_m).abs() < 1.0, "{flown_m} {free_m}");
    }
    assert!(!is_told(&world, "ground"));
}

#[test]
fn the_mission_is_told_where_it_is_too_low_or_over_unknown_ground_and_flown_as_it_is() {
    // A hill below the second leg, a hole below the third.
    let terrain = tile(|east_m, north_m| {
        let is_hole = (1000.0..1500.0).contains(&east_m) && north_m > 8000.0;
        let height = if (7000.0..8000.0).contains(&north_m) {
            80
        } else {
            4
        };
        (!is_hole).then_some(height)
    });
    let mut world = World::new(CONFIG, GOOD, 8);
    world.companion.set_terrain(Some(Arc::clone(&terrain)));
    world.run_until(20.0);
    assert!(is_told(&world, "fga: item 3 is 24 m above ground: too low"));
    assert!(is_told(&world, "fga: item 4 is over unknown ground"));
    // Nothing threatens: the ground begins no manoeuvre.
    let flown = fly(&mut world, &terrain, 480.0);
    assert_eq!(flown.modes, []);
    assert!(
        (20.0..28.0).contains(&flown.lowest_m) && flown.over_unknown,
        "{}",
        flown.lowest_m
    );
    let texts = world.emulator.texts();
    let told = texts.iter().filter(|text| text.contains("too low"));
    assert_eq!(told.count(), 1, "{texts:?}");
    // The ground was made again as the vehicle left its middle.
    let made = flown
        .log
        .iter()
        .filter(|line| line["kind"] == "ground")
        .count();
    assert!((3..8).contains(&made), "{made}");
}

#[test]
fn over_unknown_ground_traffic_is_avoided_where_nothing_else_helps_and_that_is_told() {
    let terrain = tile(|east_m, _| (east_m.abs() < 80.0).then_some(4));
    let mut world = head_on(EmulatorSettings::default(), Some(&terrain));
    let flown = fly(&mut world, &terrain, 130.0);
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    assert_eq!(flown.modes, [PlaneMode::Guided, PlaneMode::Auto]);
    assert!(flown.over_unknown && is_told(&world, "fga: avoids over unknown ground"));
    // Where one side is known, it is taken.
    let side = choice();
    let terrain = tile(move |east_m, _| (side * east_m < 80.0).then_some(4));
    let mut world = head_on(EmulatorSettings::default(), Some(&terrain));
    let flown = fly(&mut world, &terrain, 130.0);
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    assert!(
        !flown.over_unknown && !is_told(&world, "unknown"),
        "{:?}",
        flown.east_m
    );
}

#[test]
fn a_fence_and_the_ground_are_kept_in_eight_metres_a_second_of_wind() {
    let side = choice();
    for wind_mps in [[8.0, 0.0], [-8.0, 0.0], [0.0, 8.0], [0.0, -8.0]] {
        let settings = EmulatorSettings {
            wind_mps,
            ..EmulatorSettings::default()
        };
        let terrain = ridge(side);
        let mut world = head_on(settings, Some(&terrain));
        let home = *world.emulator.home();
        let edge = -side * 160.0;
        let corners = [
            [edge, -2000.0],
            [edge, 20_000.0],
            [-edge, 20_000.0],
            [-edge, -2000.0],
        ];
        let fence = corners.map(|[x, y]| MissionItem {
            command: MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION,
            parameters: [4.0, 0.0, 0.0, 0.0],
            ..MissionItem::waypoint(&home, [x, y, 0.0])
        });
        world.emulator.set_fence(fence.to_vec());
        let flown = fly(&mut world, &terrain, 140.0);
        assert!(
            world.least_m[0].0 >= PROTECTED_M,
            "{wind_mps:?} {:?}",
            world.least_m
        );
        assert!(flown.lowest_m >= ASKED_M, "{wind_mps:?} {}", flown.lowest_m);
        let farthest_m = flown.east_m[1].max(-flown.east_m[0]);
        assert!(farthest_m <= 160.0, "{wind_mps:?} {farthest_m}");
        assert_eq!(
            flown.modes,
            [PlaneMode::Guided, PlaneMode::Auto],
            "{wind_mps:?}"
        );
    }
}

#[test]
fn a_rangefinder_that_disagrees_is_told_once_and_changes_nothing() {
    let terrain = flat();
    let flight = |distance_m: u16| {
        let mut world = head_on(EmulatorSettings::default(), Some(&terrain));
        let (mut log, mut step) = (Vec::new(), 0);
        while world.time_s < 130.0 {
            world.step();
            let measured = DISTANCE_SENSOR_DATA {
                min_distance: 20,
                max_distance: 20_000,
                current_distance: distance_m * 100,
                orientation: MavSensorOrientation::MAV_SENSOR_ROTATION_PITCH_270,
                ..DISTANCE_SENSOR_DATA::DEFAULT
            };
            step += 1_u32;
            if step.is_multiple_of(25) {
                world.say_as((1, 1), &MavMessage::DISTANCE_SENSOR(measured));
            }
        }
        world.companion.shut_down(130.0);
        log.extend(world.companion.take_log());
        let line = log
            .iter()
            .find(|line| line["kind"] == "ground-heard")
            .expect("counts")
            .clone();
        let texts = world.emulator.texts().iter();
        let told: Vec<_> = texts
            .filter(|text| text.contains("rangefinder"))
            .cloned()
            .collect();
        (
            told,
            line["rangefinder"]["disagreeing"]
                .as_u64()
                .expect("a count"),
            world.least_m[0].0,
        )
    };
    let (told, disagreeing, least_m) = flight(100);
    assert_eq!((told.len(), disagreeing), (0, 0));
    let (told, disagreeing, higher_m) = flight(40);
    assert_eq!(told, ["fga: rangefinder: ground 60 m higher"]);
    assert!(disagreeing > 100, "{disagreeing}");
    assert!((higher_m - least_m).abs() < 1e-6, "{higher_m} {least_m}");
    // Lower ground neither.
    let (told, _, lower_m) = flight(190);
    assert_eq!(told.len(), 1);
    assert!((lower_m - least_m).abs() < 1e-6, "{lower_m} {least_m}");
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a short flight"
)]
fn micros(at_s: f64) -> u64 {
    (at_s * 1e6) as u64 + 1
}

#[test]
fn a_recorded_flight_over_ground_is_repeated() {
    let terrain = ridge(choice());
    let mut world = head_on(EmulatorSettings::default(), Some(&terrain));
    world.heard = Some(Vec::new());
    let flown = fly(&mut world, &terrain, 130.0);
    let mut log = Vec::new();
    let mut writer = TlogWriter::new(&mut log);
    for (at_s, header, message) in world.heard.take().expect("kept") {
        let raw = encode(header, &message, None);
        writer
            .write(micros(at_s), raw.raw_bytes())
            .expect("written");
    }
    let chosen = |lines: &[serde_json::Value]| {
        let line = lines
            .iter()
            .find(|line| line["reason"] == "maneuver-chosen")
            .cloned();
        let line = line.expect("a manoeuvre");
        assert!(line["above_ground_m"].is_number());
        line["command"][0]["course_rad"].as_f64().expect("a course")
    };
    let replayed = |terrain: Option<Arc<Terrain>>| {
        let config: Config = crate::common::configuration(CONFIG);
        let mut companion = Companion::new(config, false).expect("a companion");
        companion.set_terrain(terrain);
        let mut lines = Vec::new();
        let done = replay(log.as_slice(), &mut companion, |line| {
            lines.push(line.clone());
            Ok(())
        });
        done.expect("a log");
        chosen(&lines)
    };
    let (live_rad, again_rad) = (chosen(&flown.log), replayed(Some(Arc::clone(&terrain))));
    assert!((live_rad - again_rad).abs() < 0.1, "{live_rad} {again_rad}");
}
