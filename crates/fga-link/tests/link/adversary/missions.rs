//! Missions that are long, change while they are read, take off, land, end or begin again.

use fga_emulator::{MissionItem, PlaneMode};
use fga_link::authority::Authority;
use mavlink::dialects::ardupilotmega::{MavCmd, MavMissionType};

use super::*;
use crate::common::{BAD, GOOD, World, mission, upload};

/// 700 waypoints, 60 m apart along the leg that is flown, then to the east.
fn long_mission(world: &World, count: u32, east_from: u32) -> Vec<MissionItem> {
    let points: Vec<[f64; 3]> = (0..count)
        .map(|n| {
            let along_m = 200.0 * f64::from(n.min(east_from));
            let east_m = 200.0 * f64::from(n.saturating_sub(east_from));
            [east_m, along_m, 100.0]
        })
        .collect();
    mission(&world.emulator, &points)
}

#[test]
fn a_mission_of_seven_hundred_items_is_flown_by_before_it_is_read_to_its_end() {
    for network in [GOOD, BAD] {
        let mut world = head_on_in("", network, 3);
        let items = long_mission(&world, 700, 400);
        world.emulator.set_mission(items, 2);
        world.run_while(10.0, "ready", |w| {
            w.companion.authority() != Authority::Ready
        });
        avoids(&mut world);
        let (across_m, _) = world.off_leg();
        assert!(across_m < 20.0, "{across_m}");
    }
}

/// The ground station uploads a mission of the same length while the companion reads the old one: half of each was kept.
#[test]
fn a_mission_that_changes_while_it_is_read_is_read_again() {
    for said in [true, false] {
        let mut world = head_on();
        let items = long_mission(&world, 60, 60);
        world.emulator.set_mission(items, 2);
        // Half of it has arrived.
        world.run_while(10.0, "half of the mission", |w| {
            let asked = |m: &MavMessage| matches!(m, MavMessage::MISSION_REQUEST_INT(d) if d.seq > 30 && d.mission_type == MavMissionType::MAV_MISSION_TYPE_MISSION);
            !w.sent.iter().any(|(_, message)| asked(message))
        });
        let items = long_mission(&world, 60, 5);
        let kind = MavMissionType::MAV_MISSION_TYPE_MISSION;
        // Nobody hears the vehicle's text about it.
        world.cut = !said;
        upload(&mut world, kind, &items, Some(2));
        world.run_until(world.time_s + 0.04);
        world.cut = false;
        world.run_until(world.time_s + 12.0);
        let log = world.companion.take_log();
        let way = log
            .iter()
            .rev()
            .find(|line| line["kind"] == "way")
            .expect("a way");
        let last = way["waypoints_m"]
            .as_array()
            .and_then(|w| w.last())
            .expect("waypoints");
        assert!(last[0].as_f64().expect("east") > 500.0, "{said}: {way}");
    }
}

// Phases of a mission.

/// Take-off and landing belong to the autopilot, above the floor too.
#[test]
fn no_take_off_and_no_landing_of_a_mission_is_taken_over() {
    for command in [
        MavCmd::MAV_CMD_NAV_TAKEOFF,
        MavCmd::MAV_CMD_NAV_LAND,
        MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF,
        MavCmd::MAV_CMD_NAV_VTOL_LAND,
        MavCmd::MAV_CMD_NAV_PAYLOAD_PLACE,
    ] {
        let mut world = head_on();
        let mut items = mission(
            &world.emulator,
            &[
                [0.0, 0.0, 100.0],
                [0.0, 6000.0, 100.0],
                [0.0, 9000.0, 100.0],
            ],
        );
        items[2].command = command;
        world.emulator.set_mission(items, 2);
        world.run_until(80.0);
        assert_eq!(own_changes(&world), 0, "{command:?}");
        let words = "fga: not ready: take-off or landing";
        assert_eq!(times_told(&world, words), 1, "{command:?}");
    }
}

/// The mission is over: the vehicle circles its last item in AUTO. Traffic there is avoided, and the mode comes back.
#[test]
fn traffic_at_the_end_of_a_mission_is_avoided_and_the_mode_comes_back() {
    let mut world = World::new("", GOOD, 3);
    let points = [[0.0, 0.0, 100.0], [0.0, 700.0, 100.0]];
    let items = mission(&world.emulator, &points);
    world.emulator.set_mission(items, 2);
    world.run_while(60.0, "the end", |w| !w.emulator.mission_done());
    world.run_until(world.time_s + 30.0);
    let [x, y, z] = world.emulator.plant().position_m();
    let meet_s = world.time_s + 45.0;
    let mut intruder =
        Intruder::straight(0x00AB_CDEF, [x, y + 25.0 * meet_s, z], [0.0, -25.0, 0.0]);
    intruder.shown_m = 1200.0;
    world.add(intruder);
    // Since the intruder starts at the world's time 0.
    world.intruders[0].position_m = [x, y + 25.0 * 45.0, z];
    world.run_until(world.time_s + 200.0);
    assert_eq!(
        world.mode(),
        PlaneMode::Auto,
        "{:?}",
        world.emulator.mode_changes()
    );
    assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
    assert!(
        world.emulator.mode_changes().len() <= 4,
        "{:?}",
        world.emulator.mode_changes()
    );
}

/// `MIS_RESTART` 1 begins the mission again with each change to AUTO: at its first item, behind the aircraft.
#[test]
fn a_mission_that_restarts_in_auto_goes_on_where_it_was() {
    let mut world = head_on();
    world.emulator.parameters.set("MIS_RESTART", 1.0);
    avoids(&mut world);
    assert_eq!(world.emulator.mission_item(), 2);
    let (across_m, _) = world.off_leg();
    assert!(across_m < 20.0, "{across_m}");
    // After a fault in the manoeuvre too, but not after the pilot.
    for (by_pilot, item) in [(false, 2), (true, 1)] {
        let mut world = head_on();
        world.emulator.parameters.set("MIS_RESTART", 1.0);
        world.run_while(90.0, "command", |w| !is_in_command(w));
        world.run_until(world.time_s + 1.0);
        if by_pilot {
            world.emulator.pilot_mode(PlaneMode::Auto);
        } else {
            let now_s = world.time_s;
            world.companion.set_enabled(false, now_s);
        }
        world.run_until(world.time_s + 3.0);
        assert_eq!(world.mode(), PlaneMode::Auto);
        assert_eq!(world.emulator.mission_item(), item);
    }
}
