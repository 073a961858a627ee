//! Faults in which an earlier version lost the vehicle or its mode, against the emulator in scaled time: each
//! test is named after the observation. Tests with threads, files and signals are in `program.rs` and in the
//! tests of the command line.

use crate::common::beat::heartbeat;
use crate::common::{GOOD, Intruder, World, parameter_set};
use fga_emulator::PlaneMode;
use fga_link::authority::{Authority, Fault, reaction};
use fga_link::restart::Note;
use fga_link::{Companion, Config};
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{COMMAND_LONG_DATA, MavCmd, MavMessage};

/// A head-on intruder that meets the aircraft after a minute.
fn head_on() -> World {
    let mut world = World::new("", GOOD, 3);
    world.add(Intruder::head_on());
    world.keep_sent = true;
    world
}

fn in_command() -> World {
    let mut world = head_on();
    world.run_while(90.0, "command", |w| {
        !matches!(w.companion.authority(), Authority::InCommand { .. })
    });
    world
}

fn was_told(world: &World, words: &str) -> bool {
    world.emulator.texts().iter().any(|text| text == words)
}

/// Changes of mode that the companion asked for.
fn own_changes(world: &World) -> usize {
    let changes = world.emulator.mode_changes();
    changes.iter().filter(|c| c.component_id == 196).count()
}

/// The values of `FGA_STATE` since a moment.
fn states_since(world: &World, since_s: f64) -> Vec<f32> {
    world
        .sent
        .iter()
        .filter(|(time_s, _)| *time_s >= since_s)
        .filter_map(|(_, message)| match message {
            MavMessage::NAMED_VALUE_FLOAT(data) if data.name.to_str() == Ok("FGA_STATE") => {
                Some(data.value)
            }
            _ => None,
        })
        .collect()
}

/// A frame under the vehicle's ids, with a number this far ahead of the vehicle's own.
fn forge(world: &mut World, ahead: u8, message: &MavMessage) {
    let header = MavHeader {
        system_id: 1,
        component_id: 1,
        sequence: world.vehicle_sequence().wrapping_add(ahead),
    };
    world.companion.receive(&header, message, world.time_s);
}

fn avoided(world: &World) {
    assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
    assert_eq!(world.mode(), PlaneMode::Auto);
}

#[test]
fn one_heartbeat_with_the_armed_bit_clear() {
    let mut world = in_command();
    forge(&mut world, 0, &heartbeat(15, false));
    world.run_until(world.time_s + 0.3);
    assert!(matches!(
        world.companion.authority(),
        Authority::InCommand { .. }
    ));
    world.run_until(120.0);
    avoided(&world);
    assert_eq!(own_changes(&world), 2);
}

#[test]
fn two_heartbeats_with_the_armed_bit_clear() {
    let mut world = in_command();
    // At once and before the next true one; the numbers are those that come next.
    forge(&mut world, 0, &heartbeat(15, false));
    forge(&mut world, 1, &heartbeat(15, false));
    assert!(was_told_soon(&mut world, reaction(Fault::Disarmed).text));
    // The vehicle says that it is armed again, and gets its mode back.
    world.run_while(2.0, "AUTO", |w| w.mode() != PlaneMode::Auto);
    world.run_until(130.0);
    assert_eq!(world.mode(), PlaneMode::Auto);
}

fn was_told_soon(world: &mut World, words: &str) -> bool {
    world.run_until(world.time_s + 0.2);
    was_told(world, words)
}

#[test]
fn heartbeats_of_another_system_forged_at_ten_a_second_hide_no_pilot() {
    for ahead in [0, 1, 30, 64, 127, 128, 200, 255] {
        let mut world = in_command();
        let begin_s = world.time_s;
        let (mut next_s, mut changes) = (begin_s, None);
        while world.time_s < begin_s + 15.0 {
            if world.time_s >= next_s && world.time_s < begin_s + 9.0 {
                next_s += 0.1;
                forge(&mut world, ahead, &heartbeat(15, true));
            }
            if world.time_s >= begin_s + 1.0 && changes.is_none() {
                world.emulator.pilot_mode(PlaneMode::Manual);
                changes = Some(own_changes(&world));
            }
            world.step();
        }
        assert_eq!(world.mode(), PlaneMode::Manual, "{ahead}");
        assert_eq!(Some(own_changes(&world)), changes, "{ahead}");
        let told = was_told(&world, reaction(Fault::Contradiction).text)
            || was_told(&world, reaction(Fault::ModeChanged).text);
        assert!(told, "{ahead}: {:?}", world.emulator.texts());
    }
}

#[test]
fn forged_heartbeats_of_manual_while_ready_are_reported() {
    let mut world = head_on();
    world.run_while(40.0, "ready", |w| {
        w.companion.authority() != Authority::Ready
    });
    for _ in 0..20 {
        forge(&mut world, 5, &heartbeat(0, true));
        world.run_until(world.time_s + 0.13);
    }
    assert!(was_told(&world, reaction(Fault::Contradiction).text));
    assert_eq!(world.companion.authority(), Authority::Waiting);
    // Once they agree, it is ready again.
    world.run_until(world.time_s + 5.0);
    assert_eq!(world.companion.authority(), Authority::Ready);
}

#[test]
fn roll_limit_deg_5_set_in_command() {
    let mut world = in_command();
    world.set_parameter("ROLL_LIMIT_DEG", 5.0);
    world.run_while(1.5, "AUTO", |w| w.mode() != PlaneMode::Auto);
    world.run_until(world.time_s + 0.5);
    let since_s = world.time_s;
    assert!(was_told(&world, reaction(Fault::NoDecision).text));
    world.run_until(since_s + 30.0);
    assert_eq!(world.mode(), PlaneMode::Auto);
    let states = states_since(&world, since_s);
    assert!(states.len() > 20);
    assert!(
        states.iter().all(|state| [0.0, 5.0].contains(state)),
        "{states:?}"
    );
    // A flyable limit again: it is ready again by itself.
    world.set_parameter("ROLL_LIMIT_DEG", 55.0);
    world.run_while(6.0, "ready", |w| {
        w.companion.authority() != Authority::Ready
    });
}

#[test]
fn roll_limit_deg_4_set_in_cruise() {
    let mut world = head_on();
    world.run_while(40.0, "ready", |w| {
        w.companion.authority() != Authority::Ready
    });
    world.set_parameter("ROLL_LIMIT_DEG", 4.0);
    world.run_until(world.time_s + 1.5);
    let since_s = world.time_s;
    assert!(was_told(
        &world,
        "fga: not ready: bank limit cannot be flown"
    ));
    world.run_until(since_s + 10.0);
    assert_eq!(world.companion.authority(), Authority::Waiting);
    let states = states_since(&world, since_s);
    assert!(
        states.len() > 10 && states.iter().all(|state| *state == 0.0),
        "{states:?}"
    );
}

#[test]
fn fga_enable_0_from_any_system() {
    let mut world = in_command();
    let switch_off = [
        parameter_set(196, "FGA_ENABLE", 0.0),
        MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            command: MavCmd::MAV_CMD_USER_1,
            param1: 0.0,
            target_system: 1,
            target_component: 196,
            ..COMMAND_LONG_DATA::DEFAULT
        }),
    ];
    let from = |world: &mut World, system_id: u32| {
        for message in &switch_off {
            let header = MavHeader {
                system_id,
                component_id: 190,
                sequence: 0,
            };
            world.companion.receive(&header, message, world.time_s);
        }
    };
    for system in [1, 2, 42, 200, 254] {
        from(&mut world, system);
    }
    world.run_until(world.time_s + 0.5);
    assert!(matches!(
        world.companion.authority(),
        Authority::InCommand { .. }
    ));
    world.run_until(120.0);
    avoided(&world);
    from(&mut world, 255);
    assert_eq!(world.companion.authority(), Authority::Waiting);
}

#[test]
fn a_step_that_comes_late_is_no_fault() {
    let mut world = in_command();
    for _ in 0..3 {
        // The whole machine is busy: it reads nothing and decides nothing.
        world.killed = true;
        world.run_until(world.time_s + 0.7);
        world.killed = false;
        world.run_until(world.time_s + 1.0);
    }
    assert!(matches!(
        world.companion.authority(),
        Authority::InCommand { .. }
    ));
    world.run_until(120.0);
    avoided(&world);
    assert_eq!(own_changes(&world), 2);
}

/// The program is killed, and another one begins after a while with its note.
fn restart(world: &mut World, after_s: f64, note: Option<Note>) {
    world.killed = true;
    world.run_until(world.time_s + after_s);
    let mut companion = Companion::new(Config::default(), false).expect("a companion");
    companion.set_notes(note.into_iter().collect());
    world.companion = companion;
    world.killed = false;
}

#[test]
fn kill_9_in_command_restarted_one_second_later() {
    let mut world = in_command();
    world.run_until(world.time_s + 2.0);
    let note = world.companion.restart_note(world.time_s);
    assert!(note.is_some());
    restart(&mut world, 1.0, note);
    world.run_until(120.0);
    assert!(
        was_told(&world, "fga: restarted, goes on avoiding"),
        "{:?}",
        world.emulator.texts()
    );
    avoided(&world);
    assert_eq!(world.companion.restart_note(world.time_s), None);
}

#[test]
fn kill_9_in_command_and_the_pilot_chooses_before_the_restart() {
    for mode in [PlaneMode::Manual, PlaneMode::FlyByWireA, PlaneMode::Loiter] {
        let mut world = in_command();
        let note = world.companion.restart_note(world.time_s);
        world.emulator.pilot_mode(mode);
        let changes = own_changes(&world);
        restart(&mut world, 1.0, note);
        world.run_until(world.time_s + 20.0);
        assert_eq!((world.mode(), own_changes(&world)), (mode, changes));
        assert_eq!(
            world.companion.restart_note(world.time_s),
            None,
            "the note is history"
        );
    }
}

#[test]
fn guided_without_a_note_of_this_flight_is_the_pilots_own() {
    let mut world = in_command();
    let note = world.companion.restart_note(world.time_s).expect("a note");
    let other_flight = Note {
        boot_ms: note.boot_ms + 3_600_000,
        ..note
    };
    for note in [None, Some(other_flight)] {
        restart(&mut world, 0.5, note);
        world.run_until(world.time_s + 15.0);
        assert_eq!(world.mode(), PlaneMode::Guided);
        assert_eq!(own_changes(&world), 1);
    }
    assert!(was_told(
        &world,
        "fga: an old note of a manoeuvre, mode left alone"
    ));
}

#[test]
fn silences_of_ten_and_sixty_seconds_are_survived() {
    for silence_s in [10.0, 60.0] {
        let mut world = in_command();
        world.cut = true;
        world.run_until(world.time_s + silence_s);
        world.cut = false;
        if silence_s > 30.0 {
            world.run_while(5.0, "AUTO", |w| w.mode() != PlaneMode::Auto);
        }
        // After ten seconds the manoeuvre goes on instead.
        world.run_until(150.0);
        assert_eq!(world.mode(), PlaneMode::Auto);
        assert_eq!(world.emulator.mode_changes().len(), 2);
    }
}

#[test]
fn every_lost_ability_is_reported() {
    let ready = || {
        let mut world = head_on();
        world.intruders.clear();
        world.shown.clear();
        world.run_while(40.0, "ready", |w| {
            w.companion.authority() != Authority::Ready
        });
        world
    };
    let mut world = ready();
    world.no_telemetry = true;
    world.run_until(world.time_s + 3.0);
    assert!(was_told(&world, "fga: not ready: no fresh telemetry"));
    let mut world = ready();
    world.emulator.displace([0.0, 0.0, -80.0]);
    world.run_until(world.time_s + 2.0);
    assert!(was_told(&world, "fga: not ready: too low"));
    let mut world = ready();
    world.emulator.pilot_mode(PlaneMode::Loiter);
    world.run_until(world.time_s + 2.0);
    assert!(was_told(
        &world,
        "fga: not ready: mode is not to be taken over"
    ));
    world.emulator.pilot_mode(PlaneMode::Auto);
    world.run_until(world.time_s + 1.0);
    assert_eq!(world.companion.authority(), Authority::Ready);
}
