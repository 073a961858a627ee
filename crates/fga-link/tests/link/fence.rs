//! Fences that nobody should store: edges that cross, corners by the hundred, no room, a vehicle on the wrong side, changes in a
//! manoeuvre. Traffic is avoided among all of them, the mode is given back, and a fence that leaves room is kept.

use fga_emulator::{MissionItem, PlaneMode};
use mavlink::dialects::ardupilotmega::MavCmd;

use crate::common::{GOOD, Intruder, World};

const PROTECTED_M: f64 = 60.0;

const IN: MavCmd = MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION;
const OUT: MavCmd = MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION;
const CIRCLE_IN: MavCmd = MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION;
const CIRCLE_OUT: MavCmd = MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION;

/// Items of a polygon, or a circle about each corner with a radius, metres.
fn items(world: &World, command: MavCmd, number: f32, corners_m: &[[f64; 2]]) -> Vec<MissionItem> {
    let home = world.emulator.home();
    let item = |[x, y]: &[f64; 2]| MissionItem {
        command,
        parameters: [number, 0.0, 0.0, 0.0],
        ..MissionItem::waypoint(home, [*x, *y, 0.0])
    };
    corners_m.iter().map(item).collect()
}

fn polygon(world: &World, command: MavCmd, corners_m: &[[f64; 2]]) -> Vec<MissionItem> {
    items(world, command, corners_m.len() as f32, corners_m)
}

fn rectangle([west_m, east_m, south_m, north_m]: [f64; 4]) -> [[f64; 2]; 4] {
    [
        [west_m, south_m],
        [west_m, north_m],
        [east_m, north_m],
        [east_m, south_m],
    ]
}

fn round(center_m: [f64; 2], radius_m: f64, count: u32) -> Vec<[f64; 2]> {
    let corner = |index: u32| {
        let (sin, cos) = (f64::from(index) / f64::from(count) * core::f64::consts::TAU).sin_cos();
        [center_m[0] + radius_m * cos, center_m[1] + radius_m * sin]
    };
    (0..count).map(corner).collect()
}

/// A head-on intruder meets the vehicle after a minute.
fn head_on() -> World {
    head_on_by("worst-case")
}

fn head_on_by(policy: &str) -> World {
    let config = format!("[command]\npolicy = \"{policy}\"\n");
    let mut world = World::new(&config, GOOD, 8);
    world.add(Intruder::head_on());
    world
}

/// A fence that is stored in a world.
type Stored<'a> = &'a dyn Fn(&World) -> Vec<MissionItem>;

/// The least and the most metres east in a flight past a head-on intruder, which begins with a fence and meets another one a
/// second after it has left its mission.
fn flown(
    before: impl Fn(&World) -> Vec<MissionItem>,
    then: Option<Stored<'_>>,
) -> ((f64, f64), World) {
    flown_by("worst-case", before, then)
}

fn flown_by(
    policy: &str,
    before: impl Fn(&World) -> Vec<MissionItem>,
    then: Option<Stored<'_>>,
) -> ((f64, f64), World) {
    let mut world = head_on_by(policy);
    let fence = before(&world);
    world.emulator.set_fence(fence);
    let (mut least_m, mut most_m) = (0.0_f64, 0.0_f64);
    let mut left_s = f64::INFINITY;
    let mut then = then;
    while world.time_s < 140.0 {
        world.step();
        if world.mode() == PlaneMode::Guided {
            left_s = left_s.min(world.time_s);
        }
        if world.time_s > left_s + 1.0
            && let Some(then) = then.take()
        {
            let fence = then(&world);
            world.emulator.set_fence(fence);
        }
        let east_m = world.emulator.plant().position_m()[0];
        (least_m, most_m) = (least_m.min(east_m), most_m.max(east_m));
    }
    let modes: Vec<PlaneMode> = (world.emulator.mode_changes().iter())
        .map(|change| change.mode)
        .collect();
    eprintln!("{least_m:.1} {most_m:.1} {:?} {modes:?}", world.least_m);
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    assert_eq!(modes, [PlaneMode::Guided, PlaneMode::Auto]);
    ((least_m, most_m), world)
}

fn nothing(_: &World) -> Vec<MissionItem> {
    Vec::new()
}

/// Which way it goes by its own choice: 1 east, -1 west; and how far, metres.
fn choice() -> (f64, f64) {
    let ((least_m, most_m), _) = flown(nothing, None);
    if most_m > -least_m {
        (1.0, most_m)
    } else {
        (-1.0, -least_m)
    }
}

/// How far it went to a side, metres.
fn to_side(side: f64, (least_m, most_m): (f64, f64)) -> f64 {
    if side > 0.0 { most_m } else { -least_m }
}

#[test]
fn edges_that_cross_bound_the_manoeuvre() {
    let (side, _) = choice();
    // A strip whose far end is a knot.
    let (near, far) = (side * 45.0, side * -900.0);
    let corners_m = [
        [far, -2000.0],
        [far, 20_000.0],
        [near + side * 500.0, 21_000.0],
        [far - side * 500.0, 21_000.0],
        [near, 20_000.0],
        [near, -2000.0],
    ];
    let (east_m, world) = flown(|world| polygon(world, IN, &corners_m), None);
    assert!(to_side(side, east_m) <= 45.0, "{east_m:?}");
    let told = |words: &str| {
        world
            .emulator
            .texts()
            .iter()
            .any(|text| text.contains(words))
    };
    assert!(!told("not understood"));
}

#[test]
fn an_area_to_stay_in_and_one_to_stay_out_of_bind_together() {
    let (side, _) = choice();
    let block = rectangle([30.0 * side, 700.0 * side, -500.0, 5000.0]);
    let around = rectangle([-200.0, 200.0, -2000.0, 20_000.0]);
    let both = |world: &World| {
        let mut fence = polygon(world, IN, &around);
        fence.extend(polygon(world, OUT, &block));
        fence.extend(items(world, CIRCLE_IN, 15_000.0, &[[0.0, 0.0]]));
        fence
    };
    let (east_m, _) = flown(both, None);
    assert!(to_side(side, east_m) <= 30.0, "{east_m:?}");
    assert!(east_m.0 >= -200.0 && east_m.1 <= 200.0, "{east_m:?}");
}

/// More corners near than the core holds: nothing is proven, and traffic is avoided all the same.
#[test]
fn among_more_corners_than_there_is_room_for_traffic_is_avoided() {
    let crowd = |world: &World| {
        let mut fence = Vec::new();
        for (x, y) in [(-600.0, 1300.0), (600.0, 1300.0), (600.0, 1800.0)] {
            fence.extend(polygon(world, OUT, &round([x, y], 150.0, 120)));
        }
        fence
    };
    flown(crowd, None);
}

#[test]
fn a_fence_with_no_room_for_a_manoeuvre_comes_after_the_traffic() {
    let corridor = rectangle([-8.0, 8.0, -2000.0, 20_000.0]);
    for policy in ["worst-case", "belief"] {
        flown_by(policy, |world| polygon(world, IN, &corridor), None);
    }
}

#[test]
fn a_vehicle_on_the_wrong_side_is_not_led_off_its_mission() {
    // Away from its mission, around it, and one without an area.
    for (command, area) in [
        (IN, rectangle([300.0, 900.0, -2000.0, 20_000.0])),
        (OUT, rectangle([-900.0, 900.0, -2000.0, 20_000.0])),
        (IN, rectangle([0.0, 0.0, -2000.0, 20_000.0])),
    ] {
        flown(|world| polygon(world, command, &area), None);
    }
}

#[test]
fn a_fence_that_arrives_in_a_manoeuvre_binds_or_leads_out() {
    let (side, most_m) = choice();
    // Across the way, with room before it; around the vehicle, which flies out; none where there was one.
    let (near, far) = (side * (0.6 * most_m).max(30.0), side * 900.0);
    let wall = rectangle([near, far, -500.0, 5000.0]);
    flown(nothing, Some(&|world| polygon(world, OUT, &wall)));
    let here = |world: &World| {
        let own_m = world.emulator.plant().position_m();
        items(world, CIRCLE_OUT, 25.0, &[[own_m[0], own_m[1]]])
    };
    flown(nothing, Some(&here));
    let strip = rectangle([-side * 900.0, side * 45.0, -2000.0, 20_000.0]);
    flown(|world| polygon(world, IN, &strip), Some(&nothing));
}

#[test]
fn a_fence_that_is_disabled_in_flight_binds_no_longer() {
    let (side, most_m) = choice();
    let strip = rectangle([-side * 900.0, side * 0.5 * most_m, -2000.0, 20_000.0]);
    let mut world = head_on();
    let fence = polygon(&world, IN, &strip);
    world.emulator.set_fence(fence);
    world.run_until(20.0);
    world.emulator.parameters.set("FENCE_ENABLE", 0.0);
    let mut farthest_m = 0.0_f64;
    while world.time_s < 140.0 {
        world.step();
        farthest_m = farthest_m.max(side * world.emulator.plant().position_m()[0]);
    }
    assert!(
        (farthest_m - most_m).abs() < 0.2 * most_m,
        "{farthest_m} {most_m}"
    );
}
