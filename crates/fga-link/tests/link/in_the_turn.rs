//! What changes while a manoeuvre is flown: the traffic's reports, the airspeed, home, the fence, who commands, whether the vehicle is
//! armed. Judged by what the vehicle did and where it was.

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
    world.emulator.texts().iter().any(|text| text.contains(words))
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
        assert!(beside_m < ON_LEG_M && off_rad < ON_LEG_RAD, "{beside_m} {off_rad}");
        assert!(was_told(&world, "fga: clear, mode restored"));
    }
}

/// A crewed aircraft overtakes, and the engine loses power in the turn: at 15 m/s the way out takes longer than planned at 25 m/s.
#[test]
fn another_airspeed_in_the_turn_is_planned_with() {
    for airspeed_mps in [15.0, 20.0, 32.0] {
        let mut world = World::new("[volumes.crewed]\nradius_m = 152.4\nhalf_height_m = 30.48", GOOD, 5);
        world.add(Intruder::straight(
            0x00AB_CDEF,
            [5.0, -2800.0, 100.0],
            [0.0, 60.0, 0.0],
        ));
        world.run_while(120.0, "the turn", |world| {
            world.mode() != PlaneMode::Guided
        });
        world.run_until(world.time_s + 1.0);
        world.emulator.set_airspeed(airspeed_mps);
        world.run_until(world.time_s + 6.0);
        let planned_mps = world.companion.vehicle().expect("limits").airspeed_mps;
        world.run_while(250.0, "AUTO", |world| world.mode() != PlaneMode::Auto);
        let (beside_m, off_rad) = world.off_leg();
        eprintln!("{airspeed_mps}: {planned_mps:.1} m/s, {:?}, {beside_m:.1} m {off_rad:.3}", world.least_m);
        assert!((planned_mps - airspeed_mps).abs() < 0.06 * airspeed_mps, "{planned_mps}");
        assert!(world.least_m[0].0 >= 152.4, "{airspeed_mps}: {:?}", world.least_m);
        assert!(beside_m < ON_LEG_M && off_rad < ON_LEG_RAD, "{beside_m} {off_rad}");
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
    order(&mut world, MavCmd::MAV_CMD_DO_SET_HOME, 0.0, [0.0, 0.0, 85.0]);
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
        texts.filter(|text| text.contains("restored") && !text.contains("not restored")).count()
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
    assert!(matches!(world.companion.authority(), Authority::Released { .. }));
}

/// A corridor of 120 m to each side, stored before the flight, is enabled a second after the turn begins.
#[test]
fn a_fence_that_is_enabled_in_the_turn_bounds_the_manoeuvre() {
    let flown = |half_m: Option<f64>| {
        let mut world = World::new("[protection]\nradius_m = 200.0", GOOD, 5);
        world.add(Intruder::head_on());
        if let Some(half_m) = half_m {
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
            world.emulator.set_fence(fence);
            world.set_parameter("FENCE_ENABLE", 0.0);
        }
        world.run_while(120.0, "the turn", |world| {
            world.mode() != PlaneMode::Guided
        });
        world.run_until(world.time_s + 1.0);
        world.set_parameter("FENCE_ENABLE", 1.0);
        let mut most_m = 0.0_f64;
        let end_s = world.time_s + 60.0;
        while world.time_s < end_s {
            world.step();
            most_m = most_m.max(world.emulator.plant().position_m()[0].abs());
        }
        eprintln!("{half_m:?}: {most_m:.1} m, {:?} {:?}", world.least_m, world.emulator.texts());
        (most_m, world)
    };
    let (free_m, _) = flown(None);
    assert!(free_m > 150.0, "{free_m}");
    let (bound_m, world) = flown(Some(120.0));
    assert!(bound_m <= 120.0 || was_told(&world, "fga: fence"), "{bound_m}");
}
