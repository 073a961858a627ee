//! Every fault against the emulator: the vehicle's behaviour, and the operator's messages.

use crate::common::{BAD, GOOD, Intruder, Network, World, parameter_set};
use fga_emulator::{EmulatorSettings, PlaneMode};
use fga_link::authority::{Authority, Fault, reaction};
use mavlink::dialects::ardupilotmega::{COMMAND_LONG_DATA, MavCmd, MavMessage};

/// A head-on intruder that meets the aircraft after a minute.
fn head_on(config: &str, network: Network, seed: u64) -> World {
    let mut world = World::new(config, network, seed);
    world.add(Intruder::head_on());
    world
}

fn until_in_command(world: &mut World) {
    world.run_while(90.0, "command", |w| {
        !matches!(w.companion.authority(), Authority::InCommand { .. })
    });
}

fn in_command() -> World {
    let mut world = head_on("", GOOD, 3);
    until_in_command(&mut world);
    world
}

fn is_released(world: &World, fault: Fault) -> bool {
    matches!(world.companion.authority(), Authority::Released { fault: f, .. } if f == fault)
}

fn was_told(world: &World, fault: Fault) -> bool {
    world
        .emulator
        .texts()
        .iter()
        .any(|text| text == reaction(fault).text)
}

/// Mode changes that the companion asked for.
fn own_changes(world: &World) -> usize {
    world
        .emulator
        .mode_changes()
        .iter()
        .filter(|change| change.component_id == 196)
        .count()
}

#[test]
fn the_pilot_takes_over_in_every_state() {
    for mode in [
        PlaneMode::FlyByWireA,
        PlaneMode::Rtl,
        PlaneMode::Loiter,
        PlaneMode::Manual,
    ] {
        for state in ["taking", "in-command", "returning"] {
            let mut world = head_on("", GOOD, 3);
            world.keep_sent = true;
            world.run_while(120.0, state, |w| w.companion.authority().name() != state);
            world.emulator.pilot_mode(mode);
            let changes = own_changes(&world);
            // The heartbeat that reports the mode takes one delay of the network.
            world.run_until(world.time_s + 0.1);
            assert!(world.companion.owed().is_none(), "{state} {mode:?}");
            assert!(is_released(&world, Fault::ModeChanged), "{state} {mode:?}");
            let sent = world.sent.len();
            world.run_until(world.time_s + 10.0);
            assert_eq!(
                world.mode(),
                mode,
                "{state} {:?}",
                world.emulator.mode_changes()
            );
            // Else a request was on its way already, and the companion restored the pilot's mode after it.
            if state == "in-command" {
                assert_eq!(own_changes(&world), changes);
            }
            let targets = world.sent[sent..].iter().any(|(_, message)| {
                matches!(message, MavMessage::SET_ATTITUDE_TARGET(_))
                    || matches!(message, MavMessage::COMMAND_LONG(data)
                        if data.command == MavCmd::MAV_CMD_DO_SET_MODE)
            });
            assert!(!targets || state != "in-command", "{state} {mode:?}");
            assert!(was_told(&world, Fault::ModeChanged));
        }
    }
}

#[test]
fn after_the_pilot_only_the_operator_arms_it_again() {
    let mut world = in_command();
    world.emulator.pilot_mode(PlaneMode::Loiter);
    world.intruders.clear();
    world.run_until(world.time_s + 25.0);
    world.emulator.pilot_mode(PlaneMode::Auto);
    world.run_until(world.time_s + 15.0);
    assert!(is_released(&world, Fault::ModeChanged));
    world.say_from_ground(&parameter_set(196, "FGA_ENABLE", 1.0));
    world.run_until(world.time_s + 1.0);
    assert_eq!(world.companion.authority(), Authority::Ready);
    // And the command switches it off.
    world.say_from_ground(&MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
        command: MavCmd::MAV_CMD_USER_1,
        param1: 0.0,
        target_system: 1,
        target_component: 196,
        ..COMMAND_LONG_DATA::DEFAULT
    }));
    world.run_until(world.time_s + 1.0);
    assert_eq!(world.companion.authority(), Authority::Waiting);
}

#[test]
fn killed_in_mid_manoeuvre_the_autopilot_resolves_it() {
    let mut world = in_command();
    world.run_while(20.0, "a turn", |w| {
        w.emulator.plant().bank_rad().abs() < 0.12
    });
    world.killed = true;
    // GUIDED_TIMEOUT of 3 s, then it circles the point at which GUIDED was entered.
    world.run_until(world.time_s + 60.0);
    assert_eq!(world.mode(), PlaneMode::Guided);
    let plant = world.emulator.plant();
    let entered_m = world.emulator.mode_changes()[0].time_s;
    assert!(entered_m > 0.0);
    let bank = plant.bank_rad().abs();
    assert!(bank < 46.0_f64.to_radians());
    let before = plant.position_m();
    world.run_until(world.time_s + 30.0);
    let after = world.emulator.plant().position_m();
    assert!(
        crate::common::distance(before, after) < 400.0,
        "it stays near"
    );
}

#[test]
fn killed_with_the_sticks_held_the_overrides_fall_away() {
    let mut world = paper_world(GOOD);
    until_in_command(&mut world);
    world.run_until(world.time_s + 1.5);
    assert!(world.emulator.plant().bank_rad().abs() > 0.4);
    world.killed = true;
    world.run_until(world.time_s + 7.0);
    assert!(
        world.emulator.plant().bank_rad().abs() < 0.02,
        "wings level"
    );
}

#[test]
fn a_lost_link_is_reported_and_the_mode_restored() {
    let mut world = in_command();
    world.cut = true;
    // Longer than any manoeuvre flies on without telemetry.
    world.run_until(world.time_s + 9.0);
    assert!(is_released(&world, Fault::LinkLost) || is_released(&world, Fault::TelemetryStale));
    world.cut = false;
    world.run_while(6.0, "flown on", |w| {
        !matches!(w.companion.authority(), Authority::InCommand { .. })
    });
    // Restored once, at the end: AUTO would have led back to the intruder, and to another take-over.
    world.run_until(world.time_s + 90.0);
    let changes = world.emulator.mode_changes().iter();
    let modes: Vec<PlaneMode> = changes.map(|change| change.mode).collect();
    assert_eq!(modes, [PlaneMode::Guided, PlaneMode::Auto]);
}

/// It flies on as long as the manoeuvre is proven, and at most eight seconds.
#[test]
fn stale_telemetry_restores_the_mode() {
    let mut world = in_command();
    // The intruder keeps pace: the way back is never free.
    world.intruders[0].velocity_mps = [0.0, 25.0, 0.0];
    world.intruders[0].position_m[1] = world.emulator.plant().position_m()[1] + 300.0;
    world.no_telemetry = true;
    world.run_until(world.time_s + 3.0);
    assert_eq!(world.mode(), PlaneMode::Guided);
    world.run_while(9.0, "the mode given back", |w| w.mode() != PlaneMode::Auto);
    world.run_until(world.time_s + 0.2);
    assert!(was_told(&world, Fault::TelemetryStale));
    assert!(is_released(&world, Fault::TelemetryStale));
    world.no_telemetry = false;
    world.run_until(world.time_s + 1.0);
    assert!(
        !is_released(&world, Fault::TelemetryStale),
        "well again by itself"
    );
}

#[test]
fn a_refused_take_over_is_reported() {
    let mut world = head_on("", GOOD, 3);
    world.run_while(40.0, "ready", |w| {
        w.companion.authority() != Authority::Ready
    });
    world.emulator.refuse_commands(true);
    world.run_until(75.0);
    assert_eq!(world.mode(), PlaneMode::Auto);
    assert!(was_told(&world, Fault::TakeOverRefused));
}

#[test]
fn after_three_refusals_only_the_operator_arms_it_again() {
    // Slow traffic with a large volume, so that it begins early enough for them all.
    let mut world = head_on("[protection]\nradius_m = 400.0\n", GOOD, 3);
    world.intruders[0].velocity_mps = [0.0, -5.0, 0.0];
    world.run_while(40.0, "ready", |w| {
        w.companion.authority() != Authority::Ready
    });
    world.emulator.refuse_commands(true);
    world.run_while(130.0, "switched off", |w| {
        !w.emulator
            .texts()
            .iter()
            .any(|text| text.contains("refused too often"))
    });
    let refused = reaction(Fault::TakeOverRefused).text;
    let told = world
        .emulator
        .texts()
        .iter()
        .filter(|text| *text == refused);
    assert_eq!(told.count(), 3);
    world.emulator.refuse_commands(false);
    world.run_until(world.time_s + 10.0);
    assert_eq!(world.mode(), PlaneMode::Auto);
    assert_eq!(world.companion.authority(), Authority::Waiting);
}

#[test]
fn below_the_floor_in_a_manoeuvre_the_mode_is_restored() {
    let mut world = in_command();
    // A sink of 85 m, to 15 m: the floor is at 30 m.
    world.emulator.displace([0.0, 0.0, -85.0]);
    world.run_while(5.0, "release", |w| !is_released(w, Fault::BelowFloor));
    world.run_until(world.time_s + 1.0);
    assert_eq!(world.mode(), PlaneMode::Auto);
    assert!(was_told(&world, Fault::BelowFloor));
}

#[test]
fn the_operator_switches_it_off_in_a_manoeuvre() {
    let mut world = in_command();
    world.say_from_ground(&parameter_set(196, "FGA_ENABLE", 0.0));
    world.run_while(2.0, "release", |w| !is_released(w, Fault::OperatorOff));
    world.run_until(world.time_s + 10.0);
    assert_eq!(world.mode(), PlaneMode::Auto);
    assert!(was_told(&world, Fault::OperatorOff));
    assert!(is_released(&world, Fault::OperatorOff));
}

#[test]
fn a_refused_return_is_reported_and_left_to_the_pilot() {
    let mut world = in_command();
    world.emulator.refuse_commands(true);
    world.run_while(90.0, "release", |w| !is_released(w, Fault::ReturnRefused));
    world.run_until(world.time_s + 0.2);
    assert!(was_told(&world, Fault::ReturnRefused));
}

#[test]
fn a_vehicle_that_does_not_follow_is_given_back() {
    let mut world = in_command();
    world.emulator.ignore_targets(true);
    world.run_while(20.0, "release", |w| !is_released(w, Fault::NotFollowing));
    world.run_until(world.time_s + 1.0);
    assert_eq!(world.mode(), PlaneMode::Auto);
    assert!(was_told(&world, Fault::NotFollowing));
}

#[test]
fn a_restarted_autopilot_is_left_alone() {
    let mut world = in_command();
    world.emulator.reboot();
    world.run_until(world.time_s + 8.0);
    assert!(was_told(&world, Fault::AutopilotRestarted));
    assert!(is_released(&world, Fault::AutopilotRestarted));
}

#[test]
fn a_disarmed_vehicle_is_left_alone() {
    let mut world = in_command();
    world.emulator.set_armed(false);
    world.run_until(world.time_s + 1.0);
    assert!(is_released(&world, Fault::Disarmed));
}

#[test]
fn below_the_floor_or_disarmed_or_in_another_mode_it_never_acts() {
    for (config, mode) in [
        ("[limits]\nfloor_m = 120.0", PlaneMode::Auto),
        ("", PlaneMode::Loiter),
    ] {
        let mut world = head_on(config, GOOD, 3);
        world.emulator.pilot_mode(mode);
        world.run_until(75.0);
        assert_eq!(world.companion.counts().maneuvers, 0);
        assert_eq!(own_changes(&world), 0);
    }
    let mut world = head_on("[safety]\narmed_at_start = false", GOOD, 3);
    world.run_until(75.0);
    assert_eq!(own_changes(&world), 0);
}

#[test]
fn lost_traffic_ends_in_the_mission_again() {
    let mut world = head_on("[traffic]\ndrop_after_s = 5.0", BAD, 3);
    until_in_command(&mut world);
    world.intruders.clear();
    world.run_until(world.time_s + 40.0);
    assert_eq!(world.mode(), PlaneMode::Auto);
    assert!(world.companion.tracks().tracks().is_empty());
}

/// A static obstacle 150 m wide on the leg, flown round as in the paper: CRUISE, FBWB, CRUISE.
const PAPER: &str = "[command]\nmode = \"paper\"\n[protection]\nmargin_m = 5.0\n[[obstacle]]\nname = \"disc\"\nlatitude_deg = 37.6324141\nlongitude_deg = -122.3748\naltitude_m = 104.0\nradius_m = 150.0\n";

fn paper_world(network: Network) -> World {
    let mut world = World::new(PAPER, network, 5);
    world.emulator.pilot_mode(PlaneMode::Cruise);
    world
}

/// The disc, in the emulator's frame, metres.
fn disc_m(world: &World) -> [f64; 3] {
    world.emulator.home().to_local_m(fga_emulator::WirePlace {
        latitude_e7: 376_324_141,
        longitude_e7: -1_223_748_000,
        altitude_mm: 104_000,
    })
}

#[test]
fn algorithm_4_flies_round_a_static_obstacle() {
    for network in [GOOD, BAD] {
        let mut world = paper_world(network);
        let at = disc_m(&world);
        let mut least_m = f64::INFINITY;
        while world.time_s < 110.0 {
            world.step();
            let own = world.emulator.plant().position_m();
            least_m = least_m.min((own[0] - at[0]).hypot(own[1] - at[1]));
        }
        eprintln!("least {least_m:.1} m, {:?}", world.emulator.mode_changes());
        assert!(least_m >= 150.0, "{least_m}");
        let modes: Vec<PlaneMode> = world
            .emulator
            .mode_changes()
            .iter()
            .map(|change| change.mode)
            .collect();
        assert_eq!(
            modes,
            [PlaneMode::Cruise, PlaneMode::FlyByWireB, PlaneMode::Cruise]
        );
        // Back on its course, north.
        assert!(world.off_leg().1 < 0.1, "{:?}", world.off_leg());
    }
}

/// In a turn an ArduPlane flies faster than its throttle stick asks for. A stick that follows the measured airspeed lets it
/// wander; a plan with the airspeed of the fastest turn makes the circle too tight.
#[test]
fn algorithm_4_holds_its_throttle_and_follows_the_circle_at_the_airspeed_flown() {
    // Two and a half times as much as was seen.
    let mut settings = EmulatorSettings::default();
    settings.plant.airspeed_in_turn_mps = 6.0;
    let mut world = World::with(settings, PAPER, GOOD, 5);
    world.emulator.pilot_mode(PlaneMode::Cruise);
    world.keep_sent = true;
    let at = disc_m(&world);
    let (mut least_m, mut fastest_mps) = (f64::INFINITY, 0.0_f64);
    while world.time_s < 110.0 {
        world.step();
        let plant = world.emulator.plant();
        let own = plant.position_m();
        least_m = least_m.min((own[0] - at[0]).hypot(own[1] - at[1]));
        fastest_mps = fastest_mps.max(plant.airspeed_mps());
    }
    let sticks = world.sent.iter().filter_map(|(_, message)| match message {
        MavMessage::RC_CHANNELS_OVERRIDE(data) if data.chan3_raw > 0 => Some(data.chan3_raw),
        _ => None,
    });
    let (lowest_us, highest_us) =
        sticks.fold((u16::MAX, 0), |(low, high), us| (low.min(us), high.max(us)));
    eprintln!(
        "least {least_m:.1} m, up to {fastest_mps:.1} m/s, throttle {lowest_us} to {highest_us} us"
    );
    assert_eq!(lowest_us, highest_us);
    assert!((26.0..28.0).contains(&fastest_mps), "{fastest_mps}");
    // The disc and its margin of 5 m.
    assert!(least_m >= 154.5, "{least_m}");
}

/// Winds up to 0.8 of the airspeed from every side: the disc is kept, and the mode comes back. A disc that is seen too
/// late is told and left alone.
#[test]
fn d8_mode_paper_keeps_its_disc_in_wind_or_does_not_begin() {
    let mut flown = 0;
    for (radius_m, strength, side) in [
        (150.0, 0.0, 0),
        (150.0, 0.3, 0),
        (150.0, 0.5, 1),
        (150.0, 0.5, 2),
        (150.0, 0.5, 3),
        (30.0, 0.8, 0),
        (60.0, 0.8, 1),
        (150.0, 0.8, 2),
        (300.0, 0.8, 3),
        (300.0, 0.4, 2),
        (300.0, 0.5, 0),
    ] {
        for surveillance_m in [3000.0, 160.0] {
            // The aircraft flies north: from ahead, the left, behind, the right.
            let (sin, cos) = (f64::from(side) * core::f64::consts::FRAC_PI_2).sin_cos();
            let speed_mps = strength * fga_emulator::PlantSettings::default().airspeed_mps;
            // CRUISE holds the track that the aircraft has, north.
            let settings = EmulatorSettings {
                wind_mps: [speed_mps * sin, -speed_mps * cos],
                heading_rad: -(strength * sin).asin(),
                ..EmulatorSettings::default()
            };
            let config = format!(
                "[command]\nmode = \"paper\"\n[protection]\nmargin_m = 5.0\nsurveillance_m = {surveillance_m:?}\n\
                 [[obstacle]]\nname = \"disc\"\nlatitude_deg = 37.6324141\nlongitude_deg = -122.3748\n\
                 altitude_m = 104.0\nradius_m = {radius_m:?}\n"
            );
            let mut world = World::with(settings, &config, GOOD, 5);
            world.emulator.pilot_mode(PlaneMode::Cruise);
            let at = disc_m(&world);
            let mut least_m = f64::INFINITY;
            let mut is_past = false;
            while world.time_s < 1500.0 && !(is_past && world.mode() == PlaneMode::Cruise) {
                world.step();
                let own = world.emulator.plant().position_m();
                is_past = own[1] > at[1] + radius_m + 200.0;
                least_m = least_m.min((own[0] - at[0]).hypot(own[1] - at[1]));
            }
            let modes: Vec<PlaneMode> = world
                .emulator
                .mode_changes()
                .iter()
                .map(|change| change.mode)
                .collect();
            let told = world
                .emulator
                .texts()
                .iter()
                .any(|text| text.contains("no way round disc"));
            let case = format!(
                "{radius_m} m, {strength} of the airspeed, side {side}, seen at {surveillance_m} m: {least_m} m, {modes:?}"
            );
            eprintln!("{case}");
            if told {
                assert!(surveillance_m < 3000.0, "{case}");
                assert_eq!(modes, [PlaneMode::Cruise], "{case}");
            } else {
                flown += 1;
                assert!(least_m >= radius_m, "{case}");
                assert_eq!(
                    modes,
                    [PlaneMode::Cruise, PlaneMode::FlyByWireB, PlaneMode::Cruise],
                    "{case}"
                );
                assert!(world.off_leg().1 < 0.1, "{case}: {:?}", world.off_leg());
            }
        }
    }
    assert!((11..22).contains(&flown), "{flown}");
}

/// The companion learns the dead time in the first turns: the configuration says 0.25 s, and the vehicle answers
/// sooner. The avoider would forget a plan for a later moment than the next decision.
#[test]
fn the_moment_that_is_decided_for_never_goes_back() {
    let mut world = paper_world(GOOD);
    let mut last_s = f64::NEG_INFINITY;
    while world.time_s < 110.0 {
        world.step();
        if let Some(for_s) = world.companion.decided_for_s() {
            assert!(for_s >= last_s, "{for_s} after {last_s}");
            last_s = for_s;
        }
    }
    assert!(world.companion.response().dead_time_s < 0.25);
}

#[test]
fn heading_commands_avoid_too() {
    let mut world = head_on("[command]\nmode = \"heading\"", BAD, 4);
    world.run_until(130.0);
    eprintln!(
        "least {:?} {:?}",
        world.least_m,
        world.emulator.mode_changes()
    );
    assert!(world.least_m[0].0 >= 60.0);
    assert_eq!(world.mode(), PlaneMode::Auto);
    assert_eq!(world.emulator.mode_changes().len(), 2);
}

#[test]
fn a_dry_run_only_reports() {
    let mut world = head_on("", GOOD, 3);
    world.companion = fga_link::Companion::new(fga_link::Config::parse("").unwrap(), true).unwrap();
    world.run_until(80.0);
    assert_eq!(own_changes(&world), 0);
    assert!(
        world
            .emulator
            .texts()
            .iter()
            .any(|text| text.contains("would avoid"))
    );
}

/// A quadplane hovers against the wind in AUTO while it takes off or lands: GUIDED would make it speed up.
#[test]
fn a_vehicle_that_hovers_is_not_taken_over() {
    let mut settings = EmulatorSettings::default();
    settings.plant.airspeed_mps = 7.0;
    let mut world = World::with(settings, "", GOOD, 1);
    for (name, value) in [("AIRSPEED_CRUISE", 25.0), ("AIRSPEED_MIN", 12.0)] {
        world.set_parameter(name, value);
    }
    let mut intruder = Intruder::straight(0x00AB_CDEF, [5.0, 900.0, 100.0], [0.0, -25.0, 0.0]);
    intruder.shown_m = 800.0;
    world.add(intruder);
    world.run_until(40.0);
    assert_ne!(world.companion.authority(), Authority::Ready);
    assert_eq!(world.emulator.mode_changes().len(), 0);
    let texts = world.emulator.texts();
    assert!(
        texts.contains(&"fga: not ready: too slow to fly a turn".to_owned()),
        "{texts:?}"
    );
}

/// Heard again after a lost link, the vehicle is in GUIDED with AUTO owed to it: the way is the mission's, not a line ahead in GUIDED, along
/// which it once counted as back on its leg.
#[test]
fn l1_after_a_lost_link_the_way_is_that_of_the_mode_from_before() {
    // The first heartbeat comes up to a second after the first telemetry.
    for tenth in 0..10 {
        let mut world = head_on("", GOOD, 3);
        until_in_command(&mut world);
        world.cut = true;
        world.run_until(world.time_s + 8.0 + 0.1 * f64::from(tenth));
        world.cut = false;
        let mut off_m = f64::INFINITY;
        world.run_while(90.0, "AUTO", |w| {
            off_m = w.off_leg().0;
            w.mode() != PlaneMode::Auto
        });
        assert!(off_m < 20.0, "given back {off_m} m beside the leg");
        let ways: Vec<String> = (world.companion.take_log().iter())
            .filter(|entry| entry["kind"] == "way")
            .map(|entry| entry["mode"].to_string())
            .collect();
        assert!(
            !ways.is_empty() && ways.iter().all(|mode| mode == "\"AUTO\""),
            "{ways:?}"
        );
    }
}
