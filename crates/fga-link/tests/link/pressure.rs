//! Heights of other aircraft are pressure altitudes, and the weather moves them by hundreds of
//! metres: the companion compares pressure with pressure.

use crate::common::{GOOD, Intruder, World};
use fga_emulator::{EmulatorSettings, PlaneMode};

/// Protected by default, metres.
const PROTECTED_M: f64 = 60.0;

/// A head-on intruder at our altitude, seen through pressure altitudes.
fn flown(config: &str, sea_level_hpa: f64, told: bool, home_m: f64) -> World {
    let mut settings = EmulatorSettings {
        sea_level_hpa: told.then_some(sea_level_hpa),
        ..EmulatorSettings::default()
    };
    settings.home.altitude_m = home_m;
    let mut world = World::with(settings, config, GOOD, 3);
    world.sea_level_hpa = Some(sea_level_hpa);
    world.add(Intruder::head_on());
    world.run_until(110.0);
    let (least_m, _) = world.least_m[0];
    eprintln!("{sea_level_hpa} hPa, told: {told}, home at {home_m} m: least {least_m:.1} m");
    world
}

#[test]
fn a_reported_pressure_altitude_is_compared_with_the_vehicles_pressure() {
    for config in ["", "[protection]\nradius_m = 60.0\nhalf_height_m = 40.0\n"] {
        for sea_level_hpa in [950.0, 970.0, 990.0, 1013.25, 1030.0, 1050.0] {
            let world = flown(config, sea_level_hpa, true, 4.0);
            assert!(world.least_m[0].0 >= PROTECTED_M, "{sea_level_hpa}");
            assert_eq!(world.mode(), PlaneMode::Auto);
        }
    }
}

#[test]
fn without_the_vehicles_pressure_the_weather_is_bounded() {
    for home_m in [4.0, 900.0] {
        for sea_level_hpa in [950.0, 990.0, 1050.0] {
            let world = flown("", sea_level_hpa, false, home_m);
            assert!(world.least_m[0].0 >= PROTECTED_M, "{sea_level_hpa}");
        }
    }
}

/// With a known pressure, traffic well above passes.
#[test]
fn traffic_well_above_is_no_threat_with_a_known_pressure() {
    let settings = EmulatorSettings {
        sea_level_hpa: Some(990.0),
        ..EmulatorSettings::default()
    };
    let mut world = World::with(settings, "", GOOD, 3);
    world.sea_level_hpa = Some(990.0);
    world.add(Intruder::straight(
        0x00AB_CDEF,
        [5.0, 3000.0, 280.0],
        [0.0, -25.0, 0.0],
    ));
    world.run_until(80.0);
    assert_eq!(world.companion.counts().maneuvers, 0);
    assert!(world.least_m[0].0 > 175.0);
}
