//! What the vehicle, its neighbors and a forger can do to a companion, flown against the emulator in scaled time: two autopilots
//! on one link, forged answers, impossible telemetry, failsafes and fences in a manoeuvre, take-off and landing, long and changing
//! missions, and answers that never come.

mod missions;

use crate::common::{BAD, GOOD, Intruder, Network, World, mission};
use fga_emulator::{Emulator, EmulatorSettings, PlaneMode};
use fga_link::authority::{Authority, Fault, reaction};
use fga_link::{Companion, Config};
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{
    COMMAND_ACK_DATA, HEARTBEAT_DATA, MavAutopilot, MavCmd, MavMessage, MavModeFlag, MavParamType,
    MavResult, MavState, MavType, PARAM_VALUE_DATA,
};

/// A head-on intruder that meets the aircraft after a minute.
fn head_on_in(config: &str, network: Network, seed: u64) -> World {
    let mut world = World::new(config, network, seed);
    world.add(Intruder::head_on());
    world.keep_sent = true;
    world
}

fn head_on() -> World {
    head_on_in("", GOOD, 3)
}

fn is_in_command(world: &World) -> bool {
    matches!(world.companion.authority(), Authority::InCommand { .. })
}

fn in_command() -> World {
    let mut world = head_on();
    world.run_while(90.0, "command", |w| !is_in_command(w));
    world
}

fn was_told(world: &World, words: &str) -> bool {
    world.emulator.texts().iter().any(|text| text == words)
}

fn times_told(world: &World, words: &str) -> usize {
    let texts = world.emulator.texts().iter();
    texts.filter(|text| *text == words).count()
}

/// Changes of mode that the companion asked for.
fn own_changes(world: &World) -> usize {
    let changes = world.emulator.mode_changes();
    changes.iter().filter(|c| c.component_id == 196).count()
}

fn heartbeat(autopilot: MavAutopilot, mavtype: MavType, mode: u32) -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        custom_mode: mode,
        mavtype,
        autopilot,
        base_mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
        system_status: MavState::MAV_STATE_ACTIVE,
        mavlink_version: 3,
    })
}

fn plane(mode: u32) -> MavMessage {
    let autopilot = MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA;
    heartbeat(autopilot, MavType::MAV_TYPE_FIXED_WING, mode)
}

/// Passes the traffic with one change of mode out and one back.
fn avoids(world: &mut World) {
    world.run_until(130.0);
    assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
    assert_eq!(world.mode(), PlaneMode::Auto);
    let changes = world.emulator.mode_changes();
    assert_eq!(changes.len(), 2, "{changes:?}");
}

// Two autopilots.

#[test]
fn two_vehicles_on_one_link_need_an_id_in_the_configuration() {
    let words = "fga: not ready: two vehicles, set system_id";
    for neighbor_first in [true, false] {
        let mut world = head_on();
        let mut next_s = if neighbor_first { 0.0 } else { 0.5 };
        let mut was_ready = false;
        while world.time_s < 40.0 {
            if world.time_s >= next_s {
                next_s += 1.0;
                world.say_as((2, 1), &plane(10));
            }
            world.step();
            was_ready |= world.companion.authority() != Authority::Waiting;
        }
        assert!(!was_ready, "whose mode would it take?");
        assert_eq!(times_told(&world, words), 1);
    }
    let mut world = head_on_in("[vehicle]\nsystem_id = 1\n", GOOD, 3);
    let mut next_s = 0.0;
    while world.time_s < 130.0 {
        if world.time_s >= next_s {
            next_s += 1.0;
            world.say_as((2, 1), &plane(10));
        }
        world.step();
    }
    avoids(&mut world);
}

#[test]
fn a_vehicle_that_comes_near_later_is_told_and_changes_nothing() {
    let mut world = head_on();
    let mut next_s = 20.0;
    while world.time_s < 100.0 {
        if world.time_s >= next_s {
            next_s += 1.0;
            world.say_as((2, 1), &plane(0));
        }
        world.step();
    }
    avoids(&mut world);
    assert_eq!(times_told(&world, "fga: another vehicle on the link: 2"), 1);
}

/// The mistake of a fleet: two vehicles with the id of the factory, in the same mode.
#[test]
fn two_vehicles_with_one_id_are_noticed_and_not_taken_over() {
    for (boot_s, aside_m) in [(500.0, 3000.0), (10.0, 3000.0), (20.05, 150.0)] {
        let mut world = head_on();
        let mut other = Emulator::new(EmulatorSettings {
            boot_s,
            position_m: [aside_m, 0.0, 100.0],
            ..EmulatorSettings::default()
        });
        let points = [[aside_m, 0.0, 100.0], [aside_m, 9000.0, 100.0]];
        let items = mission(&other, &points);
        other.set_mission(items, 2);
        let mut ready_s = 0.0;
        while world.time_s < 50.0 {
            world.step();
            // Both hear the companion.
            for (_, message) in world.sent.drain(..).collect::<Vec<_>>() {
                let header = MavHeader {
                    system_id: 1,
                    component_id: 196,
                    sequence: 0,
                };
                other.receive(&header, &message);
            }
            other.advance(fga_emulator::STEP_S);
            for message in other.drain() {
                world.say_as((1, 1), &message);
            }
            if world.time_s > 10.0 && world.companion.authority() == Authority::Ready {
                ready_s += fga_emulator::STEP_S;
            }
        }
        assert_eq!(own_changes(&world), 0, "{boot_s} {aside_m}");
        assert!(ready_s < 0.1, "{boot_s} {aside_m}: ready for {ready_s} s");
        let words = "fga: not ready: two senders with one id";
        let texts = world.emulator.texts();
        assert!(was_told(&world, words), "{boot_s} {aside_m}: {texts:?}");
    }
}

#[test]
fn other_components_and_kinds_of_vehicle_hide_no_pilot() {
    let mut world = in_command();
    let begin_s = world.time_s;
    let (mut next_s, mut changes) = (begin_s, None);
    while world.time_s < begin_s + 15.0 {
        if world.time_s >= next_s {
            next_s += 0.1;
            let px4 = MavAutopilot::MAV_AUTOPILOT_PX4;
            let ours = MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA;
            world.say_as((1, 1), &heartbeat(px4, MavType::MAV_TYPE_FIXED_WING, 15));
            world.say_as((1, 1), &heartbeat(ours, MavType::MAV_TYPE_QUADROTOR, 15));
            world.say_as((1, 2), &plane(15));
            world.say_as((7, 1), &plane(15));
        }
        if world.time_s >= begin_s + 1.0 && changes.is_none() {
            world.emulator.pilot_mode(PlaneMode::Manual);
            changes = Some(own_changes(&world));
        }
        world.step();
    }
    assert_eq!(world.mode(), PlaneMode::Manual);
    assert_eq!(Some(own_changes(&world)), changes);
    assert!(was_told(&world, reaction(Fault::ModeChanged).text));
}

/// A multicopter, or another firmware: the program waited for ever and said nothing.
#[test]
fn a_vehicle_that_is_no_arduplane_is_told() {
    let config = Config::parse("").expect("configuration");
    for (autopilot, kind) in [
        (
            MavAutopilot::MAV_AUTOPILOT_PX4,
            MavType::MAV_TYPE_FIXED_WING,
        ),
        (
            MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
            MavType::MAV_TYPE_QUADROTOR,
        ),
    ] {
        let mut companion = Companion::new(config.clone(), false).expect("companion");
        let header = MavHeader {
            system_id: 1,
            component_id: 1,
            sequence: 0,
        };
        let mut texts = Vec::new();
        for second in 0..30 {
            let now_s = f64::from(second);
            companion.receive(&header, &heartbeat(autopilot, kind, 10), now_s);
            companion.tick(now_s);
            for outgoing in companion.outbox() {
                if let MavMessage::STATUSTEXT(data) = outgoing.message {
                    texts.push(data.text.to_str().unwrap_or_default().to_owned());
                }
            }
        }
        assert_eq!(texts, ["fga: not ready: vehicle 1 is no ArduPlane"]);
        let line = companion.status_line(30.0);
        assert!(line.contains("no ArduPlane"), "{line}");
    }
}

// Forged answers.

fn answer(command: MavCmd, result: MavResult) -> MavMessage {
    MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
        command,
        result,
        target_system: 1,
        target_component: 196,
        ..COMMAND_ACK_DATA::DEFAULT
    })
}

/// Flies past the traffic with this answer to a command ten times a second under the vehicle's ids.
fn with_forged(config: &str, network: Network, message: &MavMessage) -> World {
    let mut world = head_on_in(config, network, 3);
    let mut next_s = 5.0;
    while world.time_s < 130.0 {
        if world.time_s >= next_s {
            next_s += 0.1;
            world.say_as((1, 1), message);
        }
        world.step();
    }
    world
}

#[test]
fn forged_refusals_of_the_mode_do_not_end_the_avoidance() {
    for result in [
        MavResult::MAV_RESULT_DENIED,
        MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
        MavResult::MAV_RESULT_UNSUPPORTED,
    ] {
        let forged = answer(MavCmd::MAV_CMD_DO_SET_MODE, result);
        let world = with_forged("", GOOD, &forged);
        assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
        assert_eq!(world.mode(), PlaneMode::Auto);
        assert_eq!(own_changes(&world), 2);
    }
}

/// The network loses a third of the requests; the forged answers say that each arrived.
#[test]
fn forged_acceptances_of_the_mode_do_not_stop_the_requests() {
    let network = Network { loss: 0.33, ..GOOD };
    let forged = answer(MavCmd::MAV_CMD_DO_SET_MODE, MavResult::MAV_RESULT_ACCEPTED);
    for seed in 0..10 {
        let mut world = head_on_in("", network, seed);
        let mut next_s = 5.0;
        while world.time_s < 130.0 {
            if world.time_s >= next_s {
                next_s += 0.02;
                world
                    .companion
                    .receive(&header_of_vehicle(&world), &forged, world.time_s);
            }
            world.step();
        }
        assert!(world.least_m[0].0 >= 60.0, "{seed}: {:?}", world.least_m);
        assert_eq!(world.mode(), PlaneMode::Auto, "{seed}");
    }
}

fn header_of_vehicle(world: &World) -> MavHeader {
    MavHeader {
        system_id: 1,
        component_id: 1,
        sequence: world.vehicle_sequence(),
    }
}

#[test]
fn forged_refusals_of_a_heading_do_not_end_the_avoidance() {
    let forged = answer(
        MavCmd::MAV_CMD_GUIDED_CHANGE_HEADING,
        MavResult::MAV_RESULT_DENIED,
    );
    let config = "[command]\nmode = \"heading\"\n";
    let world = with_forged(config, GOOD, &forged);
    assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
    assert_eq!(world.mode(), PlaneMode::Auto);
}

/// A request of ours was lost a minute ago. A forged answer to it does not make the pilot's own GUIDED ours.
#[test]
fn a_forged_acceptance_does_not_make_the_pilots_mode_ours() {
    let mut world = head_on();
    world.run_while(90.0, "a take-over", |w| {
        world_is_still_ready(w.companion.authority())
    });
    // None of its requests arrives.
    world.network.loss = 1.0;
    world.run_until(world.time_s + 1.0);
    world.network.loss = 0.0;
    world.emulator.pilot_mode(PlaneMode::Cruise);
    world.run_until(world.time_s + 60.0);
    let forged = answer(MavCmd::MAV_CMD_DO_SET_MODE, MavResult::MAV_RESULT_ACCEPTED);
    world.say_as((1, 1), &forged);
    world.run_until(world.time_s + 0.2);
    world.emulator.pilot_mode(PlaneMode::Guided);
    world.run_until(world.time_s + 10.0);
    assert_eq!(
        world.mode(),
        PlaneMode::Guided,
        "{:?}",
        world.emulator.mode_changes()
    );
}

fn world_is_still_ready(authority: Authority) -> bool {
    matches!(authority, Authority::Waiting | Authority::Ready)
}

// What the vehicle does by itself in a manoeuvre.

/// A short failsafe of the receiver circles, and afterwards sets the mode from before: GUIDED, although nobody flies in it.
#[test]
fn a_short_failsafe_in_a_manoeuvre_that_ends_in_guided_is_told() {
    for after_s in [1.0, 5.0, 25.0, 90.0] {
        let mut world = in_command();
        world.run_until(world.time_s + 1.0);
        world.emulator.pilot_mode(PlaneMode::Circle);
        let changes = own_changes(&world);
        world.run_until(world.time_s + after_s);
        world.emulator.pilot_mode(PlaneMode::Guided);
        world.run_until(world.time_s + 20.0);
        assert_eq!(world.mode(), PlaneMode::Guided, "it may be the pilot's");
        assert_eq!(own_changes(&world), changes);
        let words = "fga: GUIDED, but nobody flies: set a mode";
        assert_eq!(times_told(&world, words), 1, "{after_s}");
    }
}

#[test]
fn a_battery_failsafe_in_every_moment_of_a_manoeuvre_keeps_its_mode() {
    for network in [GOOD, BAD] {
        for step in 0..40 {
            let mut world = head_on_in("", network, 3 + step);
            world.run_while(90.0, "a take-over", |w| {
                world_is_still_ready(w.companion.authority())
            });
            // Every 20 ms of the take-over, then every half second of the manoeuvre.
            let wait_s = if step < 25 {
                0.02 * step as f64
            } else {
                0.7 * (step - 24) as f64
            };
            world.run_until(world.time_s + wait_s);
            keeps_rtl(&mut world, &format!("{step}, {network:?}"));
        }
    }
}

/// The vehicle returns by itself. A request that was on its way may take it back; once the companion has heard of the return, it
/// ends that.
fn keeps_rtl(world: &mut World, what: &str) {
    world.companion.take_log();
    world.emulator.pilot_mode(PlaneMode::Rtl);
    world.run_until(world.time_s + 20.0);
    let log = world.companion.take_log();
    let heard = log
        .iter()
        .any(|line| line["kind"] == "mode" && line["mode"] == "RTL");
    let changes = world.emulator.mode_changes();
    assert!(
        world.mode() == PlaneMode::Rtl || !heard,
        "{what}: {changes:?}, {:?}",
        world.companion.authority()
    );
}

/// The companion gives the mode back; a draw of the network, and of the moment within half a second after that.
fn gives_back(network: Network, draw: u64) -> World {
    let mut world = head_on_in("", network, 3 + draw);
    world.run_while(120.0, "the return", |w| {
        !matches!(w.companion.authority(), Authority::Returning { .. })
    });
    world.run_until(world.time_s + 0.02 * (draw % 25) as f64);
    world
}

/// The fence sends the vehicle home while the companion gives the mode back. In the later draws, found among 5,000, a request for
/// AUTO arrives after that, and the companion hears of both in another order, or of the answer last.
#[test]
fn a_fence_breach_that_races_with_the_return_keeps_its_mode() {
    for network in [GOOD, BAD] {
        for draw in (0..25).chain([77, 174, 275, 580, 650, 808, 949, 1102]) {
            let mut world = gives_back(network, draw);
            keeps_rtl(&mut world, &format!("{draw}, {network:?}"));
        }
    }
}

/// The request for AUTO arrived before the fence acted. An earlier version took the pilot's AUTO for that request in these draws.
#[test]
fn the_pilots_auto_soon_after_a_fence_breach_is_not_undone() {
    for (draw, after_s) in [(105, 1.0), (109, 1.0), (132, 1.5), (133, 1.5), (411, 2.0)] {
        let mut world = gives_back(BAD, draw);
        world.emulator.pilot_mode(PlaneMode::Rtl);
        world.run_until(world.time_s + after_s);
        world.emulator.pilot_mode(PlaneMode::Auto);
        let changes = own_changes(&world);
        world.run_until(world.time_s + 20.0);
        assert_eq!(own_changes(&world), changes, "{draw}");
        assert_eq!(world.mode(), PlaneMode::Auto, "{draw}");
    }
}

/// With `FENCE_ACTION` 6 or 7 the fence flies the vehicle home in GUIDED, which is then not the companion's.
#[test]
fn a_fence_that_acts_in_guided_is_told_and_nothing_is_taken_over() {
    let words = "fga: not ready: FENCE_ACTION uses GUIDED";
    for (action, enabled, may) in [
        (6.0, 1.0, false),
        (7.0, 1.0, false),
        (1.0, 1.0, true),
        (6.0, 0.0, true),
    ] {
        let mut world = head_on();
        world.emulator.parameters.set("FENCE_ACTION", action);
        world.emulator.parameters.set("FENCE_ENABLE", enabled);
        world.run_until(130.0);
        assert_eq!(own_changes(&world) > 0, may, "{action}");
        assert_eq!(was_told(&world, words), !may, "{action}");
    }
}

#[test]
fn a_mode_of_a_newer_firmware_is_nobodys_to_take() {
    let mut world = in_command();
    let changes = own_changes(&world);
    world.emulator.pilot_mode(PlaneMode::Newer);
    world.run_until(world.time_s + 30.0);
    assert_eq!(world.mode(), PlaneMode::Newer);
    assert_eq!(own_changes(&world), changes);
    assert!(was_told(&world, reaction(Fault::ModeChanged).text));
    let line = world.companion.status_line(world.time_s);
    assert!(
        line.contains(&format!("mode {}", PlaneMode::Newer.number())),
        "{line}"
    );
    // From the beginning.
    let mut world = head_on();
    world.emulator.pilot_mode(PlaneMode::Newer);
    world.run_until(80.0);
    assert_eq!(own_changes(&world), 0);
}

// Answers that never come.

#[test]
fn parameters_that_are_never_answered_are_told() {
    for (gone, words) in [
        (
            "ROLL_LIMIT_DEG",
            "fga: not ready: vehicle's limits not known",
        ),
        (
            "AIRSPEED_CRUISE",
            "fga: not ready: vehicle's limits not known",
        ),
    ] {
        let mut world = head_on();
        world.emulator.parameters.remove(gone);
        world.run_until(80.0);
        assert_eq!(own_changes(&world), 0, "{gone}");
        assert_eq!(times_told(&world, words), 1, "{gone}");
    }
    // All others of those that the companion asks for: their defaults do.
    let mut world = head_on();
    for name in [
        "AIRSPEED_MIN",
        "AVD_ENABLE",
        "AVD_F_ACTION",
        "FENCE_ACTION",
        "FENCE_ENABLE",
        "GUIDED_TIMEOUT",
        "MAV_GCS_SYSID",
        "MIS_RESTART",
        "RALLY_INCL_HOME",
        "RALLY_LIMIT_KM",
        "RC_OVERRIDE_TIME",
    ] {
        world.emulator.parameters.remove(name);
    }
    world.run_while(20.0, "ready", |w| {
        w.companion.authority() != Authority::Ready
    });
}

/// Absurd limits of the vehicle are no reason for a manoeuvre that it cannot fly; what is no number changes nothing.
#[test]
fn absurd_parameters_take_no_vehicle_over_that_cannot_be_flown() {
    for (name, value, may) in [
        ("ROLL_LIMIT_DEG", f32::NAN, true),
        ("ROLL_LIMIT_DEG", f32::INFINITY, true),
        ("ROLL_LIMIT_DEG", 1e30, true),
        ("ROLL_LIMIT_DEG", -45.0, false),
        ("AIRSPEED_MIN", 1e30, false),
        ("TECS_CLMB_MAX", f32::MAX, true),
        ("AIRSPEED_STALL", f32::MAX, true),
    ] {
        let mut world = head_on();
        let mut next_s = 1.0;
        while world.time_s < 110.0 {
            if world.time_s >= next_s {
                next_s += 1.0;
                let told = MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
                    param_value: value,
                    param_count: 1,
                    param_index: 0,
                    param_id: name.into(),
                    param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
                });
                world.say_as((1, 1), &told);
            }
            world.step();
        }
        assert_eq!(own_changes(&world) > 0, may, "{name} {value}");
        assert_eq!(world.mode(), PlaneMode::Auto, "{name} {value}");
    }
}
