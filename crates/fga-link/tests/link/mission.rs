//! The mission that the vehicle really flies: uploads on another link, and items that are no waypoints.

use crate::common::{GOOD, GROUND, Intruder, World, mission, upload};
use fga_emulator::{MissionItem, PlaneMode};
use fga_link::authority::Authority;
use mavlink::dialects::ardupilotmega::{MISSION_COUNT_DATA, MavCmd, MavMessage, MavMissionType};

fn ready(world: &mut World) {
    world.run_while(20.0, "ready", |w| {
        w.companion.authority() != Authority::Ready
    });
}

/// Waypoints that the way leads to, east and north, metres.
fn way(world: &World) -> Vec<[f64; 2]> {
    let picture = world.companion.picture();
    picture.map_or_else(Vec::new, |picture| {
        let waypoints = picture.waypoints_m.iter();
        waypoints.map(|at| [at.x, at.y]).collect()
    })
}

fn leads_to(world: &World, to_m: [f64; 2]) -> bool {
    let near = |at: &[f64; 2]| (at[0] - to_m[0]).hypot(at[1] - to_m[1]) < 10.0;
    way(world).iter().skip(1).any(near)
}

/// The same number of items, and the same present one: only the target shows it.
#[test]
fn another_mission_uploaded_on_another_link_is_noticed_within_two_seconds() {
    for current in [None, Some(2)] {
        let mut world = World::new("", GOOD, 1);
        ready(&mut world);
        world.run_until(10.0);
        assert!(leads_to(&world, [0.0, 6000.0]), "{:?}", way(&world));
        let points = [
            [0.0, 0.0, 100.0],
            [2000.0, 5000.0, 100.0],
            [2000.0, 9000.0, 100.0],
            [3000.0, 9000.0, 100.0],
        ];
        let items = mission(&world.emulator, &points);
        let kind = MavMissionType::MAV_MISSION_TYPE_MISSION;
        upload(&mut world, kind, &items, current);
        let at_s = world.time_s;
        world.run_while(2.0, "the new mission", |w| {
            !leads_to(w, [2000.0, 5000.0]) || leads_to(w, [0.0, 6000.0])
        });
        eprintln!("noticed and read after {:.2} s", world.time_s - at_s);
        assert_eq!(world.companion.authority(), Authority::Ready);
    }
}

/// Until the companion knows the list, the way leads to the vehicle's own target.
#[test]
fn while_nobody_may_read_the_list_the_way_leads_to_the_vehicles_own_target() {
    let mut world = World::new("", GOOD, 1);
    ready(&mut world);
    world.run_until(10.0);
    let points = [
        [0.0, 0.0, 100.0],
        [2000.0, 5000.0, 100.0],
        [2000.0, 9000.0, 100.0],
    ];
    let items = mission(&world.emulator, &points);
    let kind = MavMissionType::MAV_MISSION_TYPE_MISSION;
    upload(&mut world, kind, &items, Some(2));
    // Another upload has begun and is never finished: the vehicle lets nobody read.
    let count = MISSION_COUNT_DATA {
        count: 5,
        target_system: 1,
        target_component: 1,
        ..MISSION_COUNT_DATA::DEFAULT
    };
    world
        .emulator
        .receive_on_second_link(&GROUND, &MavMessage::MISSION_COUNT(count));
    world.run_while(2.0, "the vehicle's own target", |w| {
        !leads_to(w, [2000.0, 5000.0]) || way(w).len() != 2
    });
}

/// The mission changes in the middle of a manoeuvre: the way back is the new leg's.
#[test]
fn after_an_upload_in_a_manoeuvre_it_comes_back_to_the_new_leg() {
    let mut world = World::new("", GOOD, 1);
    world.add(Intruder::head_on());
    world.run_while(90.0, "command", |w| {
        !matches!(w.companion.authority(), Authority::InCommand { .. })
    });
    let points = [
        [-200.0, 0.0, 100.0],
        [-200.0, 6000.0, 100.0],
        [-200.0, 9000.0, 100.0],
        [3000.0, 9000.0, 100.0],
    ];
    let items = mission(&world.emulator, &points);
    let kind = MavMissionType::MAV_MISSION_TYPE_MISSION;
    upload(&mut world, kind, &items, Some(2));
    world.run_while(60.0, "the mode given back", |w| w.mode() != PlaneMode::Auto);
    let east_m = world.emulator.plant().position_m()[0];
    assert!((east_m + 200.0).abs() < 20.0, "{east_m}");
    assert!(world.least_m[0].0 >= 60.0);
    assert_eq!(world.emulator.mode_changes().len(), 2);
}

#[test]
fn another_fence_uploaded_on_another_link_is_read_again() {
    let mut world = World::new("", GOOD, 1);
    ready(&mut world);
    world.run_until(10.0);
    let home = *world.emulator.home();
    let circle = MissionItem {
        command: MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION,
        parameters: [100.0, 0.0, 0.0, 0.0],
        ..MissionItem::waypoint(&home, [500.0, 2000.0, 0.0])
    };
    upload(
        &mut world,
        MavMissionType::MAV_MISSION_TYPE_FENCE,
        &[circle],
        None,
    );
    world.run_until(world.time_s + 2.5);
    let texts = world.emulator.texts();
    assert!(
        texts
            .iter()
            .any(|text| text == "fga: the fence has changed"),
        "{texts:?}"
    );
}

/// A moved circle: the same number of items, and no message reports it.
#[test]
fn a_fence_with_as_many_items_as_before_is_noticed_within_two_seconds() {
    let mut world = World::new("", GOOD, 1);
    let home = *world.emulator.home();
    let circles = |east_m: f64| {
        [[0.0, 3000.0], [east_m, 2000.0]].map(|[x, y]| MissionItem {
            command: MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION,
            parameters: [100.0, 0.0, 0.0, 0.0],
            ..MissionItem::waypoint(&home, [x + 400.0, y, 0.0])
        })
    };
    world.emulator.set_fence(circles(100.0).to_vec());
    ready(&mut world);
    world.run_until(10.5);
    let told = |world: &World| {
        let texts = world.emulator.texts();
        texts
            .iter()
            .any(|text| text == "fga: the fence has changed")
    };
    assert!(!told(&world), "the same fence is no news");
    let kind = MavMissionType::MAV_MISSION_TYPE_FENCE;
    upload(&mut world, kind, &circles(160.0), None);
    world.run_while(2.0, "the new fence", |w| !told(w));
}
