//! What changes while a manoeuvre is flown: the traffic's reports, the airspeed, home, the fence, who commands, whether the vehicle is
//! armed. Judged by what the vehicle did and where it was.
#![allow(clippy::cast_possible_truncation, reason = "small numbers")]

use fga_emulator::PlaneMode;
use fga_link::authority::Authority;
use mavlink::dialects::ardupilotmega::{
    COMMAND_INT_DATA, COMMAND_LONG_DATA, MavCmd, MavFrame, MavMessage,
};

use crate::common::{GOOD, GROUND, Intruder, World, distance, mission};

/// On the leg: this near, metres, and this well aligned, radians.
const ON_LEG_M: f64 = 20.0;
const ON_LEG_RAD: f64 = 0.1;

/// A head-on intruder, seconds after the vehicle turns away from it.
fn turning(config: &str, after_s: f64) -> World {
    let mut world = World::new(config, GOOD, 5);
    world.add(Intruder::head_on());
    world.run_while(120.0, "the turn", |world| {
        let is_turning = world.emulator.plant().bank_rad().abs() > 0.3;
        !(world.mode() == PlaneMode::Guided && is_turning)
    });
    world.run_until(world.time_s + after_s);
    world
}

fn was_told(world: &World, words: &str) -> bool {
    world
        .emulator
        .texts()
        .iter()
        .any(|text| text.contains(words))
}

/// A ground station's order on the second link.
fn order(world: &mut World, command: MavCmd, param2: f32, [east_m, north_m, up_m]: [f64; 3]) {
    let home = *world.emulator.home();
    let place = home.to_place([east_m, north_m, up_m]);
    let data = COMMAND_INT_DATA {
        command,
        frame: MavFrame::MAV_FRAME_GLOBAL,
        param2,
        x: place.latitude_e7,
        y: place.longitude_e7,
        z: (up_m + home.altitude_m) as f32,
        target_system: 1,
        target_component: 1,
        ..COMMAND_INT_DATA::DEFAULT
    };
    world
        .emulator
        .receive_on_second_link(&GROUND, &MavMessage::COMMAND_INT(data));
}

/// The tracks are dropped 20 s after the last report, and the way back is the vehicle's to fly.
#[test]
fn after_silent_traffic_the_mode_is_given_back_on_the_leg() {
    for (after_s, wind_mps) in [(0.0, [0.0, 0.0]), (2.0, [0.0, 0.0]), (2.0, [6.0, 0.0])] {
        let settings = fga_emulator::EmulatorSettings {
            wind_mps,
            ..fga_emulator::EmulatorSettings::default()
        };
        let mut world = World::with(settings, "", GOOD, 5);
        world.add(Intruder::head_on());
        world.run_while(120.0, "the take-over", |world| {
            world.mode() != PlaneMode::Guided
        });
        world.run_until(world.time_s + after_s);
        world.report_every_s = f64::INFINITY;
        world.next_reports_at(f64::INFINITY);
        world.run_while(200.0, "AUTO", |world| world.mode() != PlaneMode::Auto);
        let (beside_m, off_rad) = world.off_leg();
        eprintln!("{beside_m:.1} m, {off_rad:.3} rad at {:.1} s", world.time_s);
        assert!(
            beside_m < ON_LEG_M && off_rad < ON_LEG_RAD,
            "{beside_m} {off_rad}"
        );
        world.run_until(world.time_s + 1.0);
        assert!(was_told(&world, "fga: clear, mode restored"));
    }
}

/// A crewed aircraft overtakes, and the airspeed changes in the turn. At 15 m/s the way out takes longer than planned at 25 m/s, too
/// long even for a pilot who turns at once as far as is best: that one comes to 147 m, and the old plan to 121 m.
#[test]
fn another_airspeed_in_the_turn_is_planned_with() {
    for (airspeed_mps, least_m) in [(15.0, 140.0), (20.0, 152.4), (32.0, 152.4)] {
        let mut world = World::new(
            "[volumes.crewed]\nradius_m = 152.4\nhalf_height_m = 30.48",
            GOOD,
            5,
        );
        world.add(Intruder::straight(
            0x00AB_CDEF,
            [5.0, -2800.0, 100.0],
            [0.0, 60.0, 0.0],
        ));
        world.run_while(120.0, "the turn", |world| world.mode() != PlaneMode::Guided);
        world.run_until(world.time_s + 1.0);
        world.emulator.set_airspeed(airspeed_mps);
        world.run_until(world.time_s + 6.0);
        let planned_mps = world.companion.vehicle().expect("limits").airspeed_mps;
        world.run_while(250.0, "AUTO", |world| world.mode() != PlaneMode::Auto);
        let (beside_m, off_rad) = world.off_leg();
        assert!(
            was_told(&world, "fga: airspeed now"),
            "{:?}",
            world.emulator.texts()
        );
        eprintln!(
            "{airspeed_mps}: {planned_mps:.1} m/s, {:?}, {beside_m:.1} m {off_rad:.3}",
            world.least_m
        );
        assert!(
            (planned_mps - airspeed_mps).abs() < 0.06 * airspeed_mps,
            "{planned_mps}"
        );
        assert!(
            world.least_m[0].0 >= least_m,
            "{airspeed_mps}: {:?}",
            world.least_m
        );
        assert!(
            beside_m < ON_LEG_M && off_rad < ON_LEG_RAD,
            "{beside_m} {off_rad}"
        );
    }
}

#[test]
fn an_operator_who_sends_the_vehicle_elsewhere_in_guided_wins() {
    let mut world = turning("", 1.5);
    let place_m = [1500.0, 500.0, 120.0];
    order(&mut world, MavCmd::MAV_CMD_DO_REPOSITION, 1.0, place_m);
    world.run_until(world.time_s + 90.0);
    assert_eq!(world.mode(), PlaneMode::Guided, "nobody gives AUTO back");
    let left_m = distance(world.emulator.plant().position_m(), place_m);
    assert!(left_m < 200.0, "it flies to its operator's place: {left_m}");
    assert!(was_told(&world, "fga: others command GUIDED, released"));
}

/// A router passes the order to every component.
#[test]
fn an_operator_whose_order_for_guided_is_heard_wins() {
    let mut world = turning("", 1.5);
    let changes = world.emulator.mode_changes().len();
    world.say_from_ground(&MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
        command: MavCmd::MAV_CMD_DO_SET_MODE,
        param1: 1.0,
        param2: PlaneMode::Guided.number() as f32,
        target_system: 1,
        target_component: 0,
        ..COMMAND_LONG_DATA::DEFAULT
    }));
    world.run_until(world.time_s + 60.0);
    assert_eq!(world.emulator.mode_changes().len(), changes);
    assert!(was_told(&world, "fga: others command GUIDED, released"));
}

#[test]
fn home_that_is_moved_in_the_turn_ends_no_manoeuvre() {
    let mut world = turning("", 1.0);
    order(
        &mut world,
        MavCmd::MAV_CMD_DO_SET_HOME,
        0.0,
        [0.0, 0.0, 85.0],
    );
    world.run_while(150.0, "AUTO", |world| world.mode() != PlaneMode::Auto);
    eprintln!("{:?}", world.least_m);
    assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
    let (beside_m, off_rad) = world.off_leg();
    assert!(beside_m < ON_LEG_M && off_rad < ON_LEG_RAD);
    assert!(was_told(&world, "fga: home moved +85 m, floor stays"));
    assert!(!was_told(&world, "below the floor"));
}

#[test]
fn a_vehicle_that_was_disarmed_in_the_turn_is_named_when_nobody_flies_it() {
    let mut world = turning("", 1.0);
    world.emulator.set_armed(false);
    world.run_until(world.time_s + 12.0);
    let told = world.emulator.texts().len();
    world.emulator.set_armed(true);
    world.run_until(world.time_s + 5.0);
    let texts = &world.emulator.texts()[told..];
    let words = "fga: GUIDED, but nobody flies: set a mode";
    assert!(texts.iter().any(|text| text == words), "{texts:?}");
    assert_eq!(world.mode(), PlaneMode::Guided);
}

/// Requests do not reach the vehicle, or the pilot chose MANUAL: then no text says that the mode was restored.
#[test]
fn a_mode_is_called_restored_when_the_vehicle_reports_it() {
    let restored = |world: &World| {
        let texts = world.emulator.texts().iter();
        texts
            .filter(|text| text.contains("restored") && !text.contains("not restored"))
            .count()
    };
    // Nothing reaches the vehicle from here on; the texts do afterwards.
    let mut world = turning("", 1.0);
    world.keep_sent = true;
    world.uplink_queue_s = 1e3;
    world.companion.shut_down_at_once(world.time_s);
    world.run_until(world.time_s + 3.0);
    assert_eq!(world.mode(), PlaneMode::Guided);
    let says = |world: &World, words: &str| {
        world.sent.iter().any(|(_, message)| {
            matches!(message, MavMessage::STATUSTEXT(data) if data.text.to_str().is_ok_and(|text| text.contains(words)))
        })
    };
    assert!(says(&world, "fga: program ends, restores the mode"));
    assert!(!says(&world, "mode restored"));
    // The pilot chooses MANUAL while the request is on its way.
    let mut world = turning("", 1.0);
    world.uplink_queue_s = 0.5;
    world.companion.shut_down_at_once(world.time_s);
    world.emulator.pilot_mode(PlaneMode::Manual);
    world.run_until(world.time_s + 5.0);
    assert_eq!((world.mode(), restored(&world)), (PlaneMode::Manual, 0));
    // It arrives.
    let mut world = turning("", 1.0);
    world.companion.shut_down_at_once(world.time_s);
    world.run_until(world.time_s + 3.0);
    assert_eq!((world.mode(), restored(&world)), (PlaneMode::Auto, 1));
    assert!(matches!(
        world.companion.authority(),
        Authority::Released { .. }
    ));
}

/// The greatest distance from the leg, metres, past a head-on intruder with a sphere of this radius, metres; a corridor of this half
/// width, stored before the flight, is enabled a second after the take-over.
fn in_corridor(radius_m: f64, half_m: f64, enables: bool) -> (f64, World) {
    let mut world = World::new(&format!("[protection]\nradius_m = {radius_m}"), GOOD, 5);
    world.add(Intruder::head_on());
    let corners_m = [
        [-half_m, -2000.0],
        [-half_m, 20_000.0],
        [half_m, 20_000.0],
        [half_m, -2000.0],
    ];
    let mut fence = mission(&world.emulator, &corners_m.map(|[x, y]| [x, y, 0.0]));
    fence.remove(0);
    for item in &mut fence {
        item.command = MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION;
        item.parameters[0] = 4.0;
    }
    world.emulator.store_fence(fence);
    world.run_while(120.0, "the take-over", |world| {
        world.mode() != PlaneMode::Guided
    });
    world.run_until(world.time_s + 1.0);
    if enables {
        world.set_parameter("FENCE_ENABLE", 1.0);
    }
    let mut most_m = 0.0_f64;
    let end_s = world.time_s + 60.0;
    while world.time_s < end_s {
        world.step();
        most_m = most_m.max(world.emulator.plant().position_m()[0].abs());
    }
    eprintln!("{radius_m} {half_m}: {most_m:.1} m, {:?}", world.least_m);
    (most_m, world)
}

#[test]
fn a_fence_that_is_enabled_in_the_turn_bounds_the_manoeuvre_or_is_told() {
    let leaves = "fga: outside the fence in the manoeuvre";
    let (free_m, world) = in_corridor(60.0, 70.0, false);
    assert!(free_m > 75.0, "{free_m}");
    assert!(!was_told(&world, leaves));
    // With room it is kept, and the aircraft too.
    let (bound_m, world) = in_corridor(60.0, 70.0, true);
    assert!(bound_m <= 70.0, "{bound_m}");
    assert!(world.least_m[0].0 >= 60.0 && !was_told(&world, leaves));
    // Without room for both the aircraft is kept, and the operator reads what the fence is not.
    let (_, world) = in_corridor(152.4, 120.0, true);
    assert!(world.least_m[0].0 >= 152.4, "{:?}", world.least_m);
    assert!(was_told(&world, leaves));
}

/// A corridor of 140 m to the left and 60 m to the right, 8 m/s of tailwind, and an aircraft that crosses at 40 m/s: the way out is a
/// turn in need. The vehicle's steep turns are wider than its normal ones show: at 63° it flies 0.5 of the ideal rate, not 0.7.
#[test]
fn a_steep_turn_that_is_wider_than_the_normal_ones_show_keeps_the_fence() {
    let settings = fga_emulator::EmulatorSettings {
        plant: fga_emulator::PlantSettings {
            steep_loss: 0.64,
            ..fga_emulator::PlantSettings::default()
        },
        wind_mps: [0.0, 8.0],
        ..fga_emulator::EmulatorSettings::default()
    };
    let mut turned_in_need = 0;
    for (side, off_s) in [
        (1.0, 0.0),
        (-1.0, 0.0),
        (1.0, 1.0),
        (-1.0, 1.0),
        (1.0, -1.0),
        (-1.0, -1.0),
        (1.0, 2.0),
        (-1.0, 2.0),
    ] {
        let mut world = World::with(settings.clone(), "", GOOD, 5);
        let meets_s = 60.0;
        world.add(Intruder::straight(
            0x00AB_CDEF,
            [side * 40.0 * (meets_s + off_s), 33.0 * meets_s, 100.0],
            [-side * 40.0, 0.0, 0.0],
        ));
        world.intruders[0].shown_m = 1000.0;
        world.set_parameter("ROLL_LIMIT_DEG", 65.0);
        let corners_m = [
            [-140.0, -2000.0],
            [-140.0, 20_000.0],
            [60.0, 20_000.0],
            [60.0, -2000.0],
        ];
        let mut fence = mission(&world.emulator, &corners_m.map(|[x, y]| [x, y, 0.0]));
        fence.remove(0);
        for item in &mut fence {
            item.command = MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION;
            item.parameters[0] = 4.0;
        }
        world.emulator.set_fence(fence);
        let (mut outside_m, mut in_need, mut bank) = (f64::NEG_INFINITY, false, 0.0_f64);
        while world.time_s < 120.0 {
            world.step();
            let east_m = world.emulator.plant().position_m()[0];
            outside_m = outside_m.max(east_m - 60.0).max(-140.0 - east_m);
            bank = bank.max(world.emulator.plant().bank_rad().abs());
            in_need |= world
                .companion
                .decision()
                .is_some_and(|decision| decision.record.in_need);
        }
        eprintln!(
            "{side} {off_s}: outside {outside_m:.1} need {in_need} bank {bank:.2} {:?}",
            world.least_m
        );
        assert!(outside_m <= 0.0, "{outside_m}");
        assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
        turned_in_need += u32::from(in_need && bank > 0.9);
    }
    assert!(turned_in_need > 0);
}
