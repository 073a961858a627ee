//! Missions of more than waypoints, with a manoeuvre at the critical place: each row of the table of missions in
//! `docs/fly-inputs.md`. Head-on traffic comes 1,500 m north of the start.

use crate::common::{GOOD, Intruder, World};
use fga_emulator::{MissionItem, PlaneMode};
use fga_link::authority::{Authority, Fault};
use mavlink::dialects::ardupilotmega::MavCmd;

/// Command, parameters 1 to 4, and place, metres east and north.
type Row = (MavCmd, [f32; 4], Option<[f64; 2]>);

/// A world with a mission after its home item, and the traffic.
fn world(items: &[Row]) -> World {
    let mut world = World::new("", GOOD, 3);
    let home = *world.emulator.home();
    let item = |(command, parameters, place): &Row| {
        let [x, y] = place.unwrap_or_default();
        let at = MissionItem::waypoint(&home, [x, y, 100.0]);
        let (latitude_e7, longitude_e7) = match place {
            Some(_) => (at.latitude_e7, at.longitude_e7),
            None => (0, 0),
        };
        MissionItem {
            command: *command,
            parameters: *parameters,
            latitude_e7,
            longitude_e7,
            ..at
        }
    };
    let mut mission = crate::common::mission(&world.emulator, &[]);
    mission.extend(items.iter().map(item));
    world.emulator.set_mission(mission, 2);
    world.add(Intruder::head_on());
    world
}

const fn waypoint(x: f64, y: f64) -> Row {
    (MavCmd::MAV_CMD_NAV_WAYPOINT, [0.0; 4], Some([x, y]))
}

/// Flies until the traffic has passed and the mode is back: kept clear, one change out, one back.
fn avoids(what: &str, world: &mut World) {
    world.run_while(90.0, what, |w| w.mode() != PlaneMode::Guided);
    world.run_while(90.0, what, |w| w.mode() != PlaneMode::Auto);
    world.run_until(world.time_s + 30.0);
    let least_m = world.least_m[0].0;
    assert!(least_m >= 60.0, "{what}: {least_m}");
    let changes = world.emulator.mode_changes();
    assert_eq!(changes.len(), 2, "{what}: {changes:?}");
    assert_eq!(world.mode(), PlaneMode::Auto, "{what}");
}

#[test]
fn a_jump_for_ever_is_followed() {
    // Between two waypoints, over and over; the first is behind the meeting point.
    let jump = (MavCmd::MAV_CMD_DO_JUMP, [2.0, -1.0, 0.0, 0.0], None);
    let mut world = world(&[
        waypoint(0.0, 0.0),
        waypoint(0.0, 1700.0),
        waypoint(800.0, 1700.0),
        jump,
    ]);
    avoids("jump for ever", &mut world);
    world.run_while(200.0, "the jump", |w| w.emulator.mission_item() != 3);
    world.run_while(200.0, "the jump", |w| w.emulator.mission_item() != 2);
}

#[test]
fn a_jump_that_is_made_some_times_ends_the_way_and_the_vehicle_makes_it() {
    let jump = (MavCmd::MAV_CMD_DO_JUMP, [1.0, 1.0, 0.0, 0.0], None);
    let mut world = world(&[
        waypoint(0.0, 0.0),
        waypoint(0.0, 1700.0),
        jump,
        waypoint(0.0, 9000.0),
    ]);
    avoids("jump once", &mut world);
    world.run_while(200.0, "the jump", |w| w.emulator.mission_item() != 1);
    world.run_while(200.0, "the jump", |w| w.emulator.mission_item() != 2);
    world.run_while(300.0, "on", |w| w.emulator.mission_item() != 4);
}

#[test]
fn circles_of_the_mission_are_flown_by_the_vehicle_after_the_manoeuvre() {
    let circles = (
        MavCmd::MAV_CMD_NAV_LOITER_TURNS,
        [2.0, 0.0, 0.0, 0.0],
        Some([0.0, 1900.0]),
    );
    let mut world = world(&[waypoint(0.0, 0.0), circles, waypoint(0.0, 9000.0)]);
    avoids("circles", &mut world);
    world.run_while(120.0, "on", |w| w.emulator.mission_item() != 3);
}

#[test]
fn a_spline_is_passed_over_as_the_vehicle_does() {
    let spline = (
        MavCmd::MAV_CMD_NAV_SPLINE_WAYPOINT,
        [0.0; 4],
        Some([900.0, 900.0]),
    );
    let mut world = world(&[
        waypoint(0.0, 0.0),
        waypoint(0.0, 700.0),
        spline,
        waypoint(0.0, 6000.0),
    ]);
    avoids("spline", &mut world);
    let (across_m, _) = world.off_leg();
    assert!(across_m < 20.0, "{across_m}");
}

#[test]
fn a_landing_is_led_to_and_its_start_passed_over() {
    let start = (MavCmd::MAV_CMD_DO_LAND_START, [0.0; 4], None);
    let land = (MavCmd::MAV_CMD_NAV_LAND, [0.0; 4], Some([0.0, 5000.0]));
    let mut world = world(&[waypoint(0.0, 0.0), start, waypoint(0.0, 2500.0), land]);
    avoids("landing", &mut world);
    let (across_m, _) = world.off_leg();
    assert!(across_m < 20.0, "{across_m}");
    world.run_while(60.0, "the landing", |w| w.emulator.mission_item() != 4);
}

#[test]
fn a_mission_that_ends_in_the_manoeuvre_is_given_back() {
    let mut world = world(&[waypoint(0.0, 0.0), waypoint(0.0, 1550.0)]);
    avoids("the end", &mut world);
    world.run_while(60.0, "done", |w| !w.emulator.mission_done());
}

#[test]
fn a_return_in_the_mission_is_the_vehicles_own() {
    let home = (MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH, [0.0; 4], None);
    let mut world = world(&[waypoint(0.0, 0.0), waypoint(0.0, 1700.0), home]);
    avoids("return", &mut world);
    world.run_while(60.0, "home", |w| {
        let [_, north_mps, _] = w.emulator.plant().velocity_mps();
        north_mps > 0.0
    });
}

/// A failsafe, or the pilot, sends the vehicle home in the middle of a manoeuvre.
#[test]
fn rtl_in_the_middle_of_a_manoeuvre_stays() {
    let mut world = world(&[waypoint(0.0, 0.0), waypoint(0.0, 6000.0)]);
    world.run_while(90.0, "command", |w| {
        !matches!(w.companion.authority(), Authority::InCommand { .. })
    });
    world.run_until(world.time_s + 2.0);
    world.emulator.pilot_mode(PlaneMode::Rtl);
    world.run_until(world.time_s + 60.0);
    assert_eq!(world.mode(), PlaneMode::Rtl);
    let modes: Vec<PlaneMode> = world
        .emulator
        .mode_changes()
        .iter()
        .map(|at| at.mode)
        .collect();
    assert_eq!(modes, [PlaneMode::Guided, PlaneMode::Rtl]);
    let by_the_pilot = Fault::ModeChanged;
    assert!(
        matches!(world.companion.authority(), Authority::Released { fault, .. } if fault == by_the_pilot)
    );
}
