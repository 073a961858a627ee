//! What a trial of the program found, each test named after its row. The judge is what the vehicle heard and flew, and the
//! separation; not what the companion says of itself.

use crate::common::beat::heartbeat;
use crate::common::{BAD, GOOD, Intruder, Network, World, distance, mission};
use fga_emulator::{EmulatorSettings, MissionItem, PlaneMode};
use fga_link::authority::Authority;
use fga_link::restart::Note;
use fga_link::{Companion, Config};
use mavlink::dialects::ardupilotmega::{MavCmd, MavMessage};

const RADIUS_M: f64 = 60.0;

fn was_told(world: &World, words: &str) -> bool {
    times_told(world, words) > 0
}

fn times_told(world: &World, words: &str) -> usize {
    let texts = world.emulator.texts().iter();
    texts.filter(|text| text.contains(words)).count()
}

/// A configuration with a disc on the leg, so far north of the start.
fn disc(north_m: f64) -> String {
    let emulator = fga_emulator::Emulator::new(EmulatorSettings::default());
    let place = emulator.home().to_place([0.0, north_m, 100.0]);
    format!(
        "[[obstacle]]\nname = \"disc\"\nlatitude_deg = {:.7}\nlongitude_deg = {:.7}\naltitude_m = 104.0\nradius_m = {RADIUS_M}\n",
        f64::from(place.latitude_e7) * 1e-7,
        f64::from(place.longitude_e7) * 1e-7,
    )
}

fn head_on(north_m: f64) -> Intruder {
    Intruder::straight(0x00AB_CDEF, [0.0, north_m, 100.0], [0.0, -25.0, 0.0])
}

fn command(command: MavCmd) -> MissionItem {
    MissionItem {
        command,
        parameters: [9.0, 1500.0, 0.0, 0.0],
        latitude_e7: 0,
        longitude_e7: 0,
        altitude_m: 0.0,
        ..MissionItem::waypoint(&EmulatorSettings::default().home, [0.0; 3])
    }
}

/// A mission north through waypoints, with a command after each but the last.
fn with_commands(world: &mut World, norths_m: &[f64]) -> Vec<u16> {
    let points: Vec<[f64; 3]> = norths_m.iter().map(|y| [0.0, *y, 100.0]).collect();
    let mut items = mission(&world.emulator, &[]);
    let mut commands = Vec::new();
    for (index, point) in mission(&world.emulator, &points)
        .into_iter()
        .skip(1)
        .enumerate()
    {
        items.push(point);
        if index + 1 < norths_m.len() {
            commands.push(u16::try_from(items.len()).expect("a short mission"));
            items.push(command(MavCmd::MAV_CMD_DO_SET_SERVO));
        }
    }
    world.emulator.set_mission(items, 3);
    commands
}

/// A DO item runs once, or the operator reads that it does not.
fn none_vanishes(world: &World, commands: &[u16], what: &str) {
    let ran = world.emulator.items_run();
    // As sent: the network loses some.
    let said: Vec<&str> = world
        .sent
        .iter()
        .filter_map(|(_, message)| match message {
            MavMessage::STATUSTEXT(data) => data.text.to_str().ok(),
            _ => None,
        })
        .collect();
    for item in commands {
        let times = ran.iter().filter(|(_, ran)| ran == item).count();
        let words = format!("fga: item {item} not run: DO_SET_SERVO");
        let named = usize::from(said.iter().any(|said| *said == words));
        assert_eq!(times + named, 1, "{what}: {item} {ran:?} {said:?}");
    }
}

/// A command after a waypoint that was passed in GUIDED never ran: the item set was the next waypoint.
#[test]
fn l1_a_command_after_a_waypoint_passed_in_the_manoeuvre_runs() {
    let mut world = World::new("", GOOD, 1);
    let commands = with_commands(&mut world, &[-10.0, 1500.0, 6000.0]);
    world.add(head_on(3000.0));
    world.run_while(90.0, "GUIDED", |w| w.mode() != PlaneMode::Guided);
    world.run_while(90.0, "AUTO", |w| w.mode() != PlaneMode::Auto);
    assert!(
        world.emulator.plant().position_m()[1] > 1500.0,
        "passed in it"
    );
    world.run_until(world.time_s + 30.0);
    let ran: Vec<u16> = world.emulator.items_run().iter().map(|ran| ran.1).collect();
    assert_eq!(ran, commands[1..], "{:?}", world.emulator.texts());
    assert_eq!(world.emulator.mission_item(), 5);
    assert!(world.least_m[0].0 >= RADIUS_M);
}

#[test]
fn l1_no_command_of_a_mission_vanishes_in_silence() {
    let lossy = Network { loss: 0.15, ..BAD };
    for (seed, network) in [GOOD, BAD, lossy].into_iter().cycle().take(24).enumerate() {
        let mut world = World::new("", network, seed as u64);
        let seed = f64::from(u32::try_from(seed).expect("few"));
        let first_m = 1000.0 + 45.0 * seed;
        let spacing_m = 150.0 + 60.0 * (seed % 7.0);
        let mut norths_m = vec![-10.0];
        norths_m.extend((0..5_u8).map(|n| first_m + spacing_m * f64::from(n)));
        norths_m.push(9000.0);
        let commands = with_commands(&mut world, &norths_m);
        world.keep_sent = true;
        world.add(head_on(3000.0));
        world.run_while(90.0, "GUIDED", |w| w.mode() != PlaneMode::Guided);
        world.run_while(120.0, "AUTO", |w| w.mode() != PlaneMode::Auto);
        world.run_while(300.0, "the last leg", |w| {
            w.emulator.plant().position_m()[1] < first_m + 4.0 * spacing_m + 100.0
        });
        world.run_until(world.time_s + 5.0);
        none_vanishes(&world, &commands[1..], &format!("{seed}"));
        let modes: Vec<PlaneMode> = world
            .emulator
            .mode_changes()
            .iter()
            .map(|at| at.mode)
            .collect();
        assert_eq!(modes, [PlaneMode::Guided, PlaneMode::Auto], "{seed}");
    }
}

/// With `MIS_RESTART` 1 the commands before the first waypoint run again.
#[test]
fn l1_commands_that_run_again_are_named() {
    let mut world = World::new("", GOOD, 1);
    world.emulator.parameters.set("MIS_RESTART", 1.0);
    let points = [[0.0, -10.0, 100.0], [0.0, 6000.0, 100.0]];
    let mut items = mission(&world.emulator, &points);
    items.insert(1, command(MavCmd::MAV_CMD_DO_SET_SERVO));
    world.emulator.set_mission(items, 3);
    world.add(head_on(3000.0));
    world.run_while(90.0, "GUIDED", |w| w.mode() != PlaneMode::Guided);
    world.run_while(90.0, "AUTO", |w| w.mode() != PlaneMode::Auto);
    world.run_until(world.time_s + 5.0);
    assert_eq!(world.emulator.mission_item(), 3);
    assert_eq!(world.emulator.items_run().len(), 1);
    assert_eq!(
        times_told(&world, "fga: item 1 runs again: DO_SET_SERVO"),
        1
    );
}

/// How long before the entry the mode was taken, and how long it was held, seconds.
fn taken_and_held(world: &mut World, entry_s: impl Fn(&World) -> f64) -> (f64, f64) {
    world.run_while(200.0, "GUIDED", |w| w.mode() != PlaneMode::Guided);
    let (taken_s, ahead_s) = (world.time_s, entry_s(world));
    world.run_while(180.0, "AUTO", |w| w.mode() != PlaneMode::Auto);
    (ahead_s, world.time_s - taken_s)
}

/// For an obstacle at rest the mode was taken 31 to 60 s ahead and held for 56 to 92 s.
#[test]
fn l2_an_obstacle_at_rest_is_taken_over_as_late_as_traffic_and_given_back_as_soon() {
    const NORTH_M: f64 = 2500.0;
    let winds = [
        [0.0, 0.0],
        [8.0, 0.0],
        [-8.0, 0.0],
        [0.0, 8.0],
        [0.0, -8.0],
        [5.5, 5.5],
    ];
    for (wind_mps, network) in winds.into_iter().zip([GOOD, BAD].into_iter().cycle()) {
        let settings = EmulatorSettings {
            wind_mps,
            ..EmulatorSettings::default()
        };
        let mut traffic = World::with(settings.clone(), "", network, 4);
        traffic.add(head_on(2.0 * NORTH_M));
        let moving = taken_and_held(&mut traffic, |w| {
            let own_m = w.emulator.plant().position_m();
            let [_, own_mps, _] = w.emulator.plant().velocity_mps();
            let range_m = distance(own_m, w.intruders[0].position_m) - RADIUS_M;
            range_m / (25.0 + own_mps)
        });
        let mut world = World::with(settings, &disc(NORTH_M), network, 4);
        let mut least_m = f64::INFINITY;
        let resting = taken_and_held(&mut world, |w| {
            let own_m = w.emulator.plant().position_m();
            let [_, own_mps, _] = w.emulator.plant().velocity_mps();
            (NORTH_M - RADIUS_M - own_m[1]) / own_mps
        });
        eprintln!("{wind_mps:?}: traffic {moving:.1?}, at rest {resting:.1?}");
        // Again, for the separation.
        let settings = EmulatorSettings {
            wind_mps,
            ..EmulatorSettings::default()
        };
        let mut world = World::with(settings, &disc(NORTH_M), network, 4);
        while world.emulator.plant().position_m()[1] < NORTH_M + 300.0 {
            world.step();
            let own_m = world.emulator.plant().position_m();
            least_m = least_m.min(distance(own_m, [0.0, NORTH_M, 100.0]));
        }
        assert!(least_m >= RADIUS_M, "{wind_mps:?}: {least_m}");
        assert!(
            resting.0 <= moving.0.max(12.0),
            "{wind_mps:?}: {moving:?} {resting:?}"
        );
        assert!(
            resting.1 <= moving.1.max(30.0),
            "{wind_mps:?}: {moving:?} {resting:?}"
        );
    }
}

/// A waypoint that the manoeuvre passes far off is named.
#[test]
fn l2_no_waypoint_is_skipped_in_silence() {
    for side_m in [0.0, 20.0, -20.0] {
        let mut world = World::new(&disc(1500.0), GOOD, 4);
        let points = [
            [0.0, 0.0, 100.0],
            [side_m, 1500.0, 100.0],
            [0.0, 6000.0, 100.0],
        ];
        let items = mission(&world.emulator, &points);
        world.emulator.set_mission(items, 2);
        let (mut nearest_m, mut reached) = (f64::INFINITY, false);
        while world.emulator.plant().position_m()[1] < 2500.0 && world.time_s < 200.0 {
            world.step();
            let own_m = world.emulator.plant().position_m();
            nearest_m = f64::min(nearest_m, distance(own_m, points[1]));
            reached |= world.mode() == PlaneMode::Auto && distance(own_m, points[1]) < 30.0;
        }
        assert!(!reached && nearest_m > 30.0, "it lies in the disc");
        let words = format!("fga: waypoint 2 passed {nearest_m:.0} m off");
        assert!(
            was_told(&world, &words),
            "{words}: {:?}",
            world.emulator.texts()
        );
    }
}

/// A waypoint that an earlier manoeuvre passed near is not named with the distance of a later one.
#[test]
fn l2_a_waypoint_counts_as_passed_where_it_was_nearest_in_all_manoeuvres() {
    let wide = disc(1500.0).replace(&format!("radius_m = {RADIUS_M}"), "radius_m = 200.0");
    let mut world = World::new(&wide, GOOD, 4);
    let points = [
        [0.0, 0.0, 100.0],
        [0.0, 1350.0, 100.0],
        [0.0, 6000.0, 100.0],
    ];
    let items = mission(&world.emulator, &points);
    world.emulator.set_mission(items, 2);
    let (mut nearest_m, mut off_s) = (f64::INFINITY, None);
    while world.emulator.plant().position_m()[1] < 4000.0 && world.time_s < 300.0 {
        world.step();
        let own_m = world.emulator.plant().position_m();
        nearest_m = f64::min(nearest_m, distance(own_m, points[1]));
        // The operator switches it off for a moment when it has passed the waypoint.
        if own_m[1] > 1420.0 && off_s.is_none() {
            off_s = Some(world.time_s);
            world.companion.set_enabled(false, world.time_s);
        }
        if off_s.is_some_and(|off_s| world.time_s > off_s + 1.0) {
            world.companion.set_enabled(true, world.time_s);
            off_s = Some(f64::INFINITY);
        }
    }
    let words = format!("fga: waypoint 2 passed {nearest_m:.0} m off");
    assert!(
        was_told(&world, &words),
        "{words}: {:?}",
        world.emulator.texts()
    );
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small numbers"
)]
fn note(system_id: u8, world: &World) -> Note {
    Note {
        system_id,
        owned_mode: PlaneMode::Guided.number(),
        previous_mode: PlaneMode::Auto.number(),
        boot_ms: (world.emulator.time_s() * 1e3) as u32,
        given_up: false,
        item: None,
        written_unix_s: 0,
        age_s: 0,
    }
}

fn fly_with(world: &mut World, config: &str, dry_run: bool, notes: Vec<Note>) {
    let config = Config::parse(config).expect("a configuration");
    world.companion = Companion::new(config, dry_run).expect("a companion");
    world.companion.set_notes(notes);
}

/// A note of another vehicle muted the companion for ever.
#[test]
fn l4_a_note_of_another_vehicle_mutes_nobody_and_is_named() {
    let mut world = World::new("", GOOD, 4);
    let notes = vec![note(3, &world), note(7, &world)];
    fly_with(&mut world, "", false, notes);
    world.add(head_on(3000.0));
    world.run_while(20.0, "ready", |w| {
        w.companion.authority() != Authority::Ready
    });
    for other in [3, 7] {
        let words = format!("fga: note of vehicle {other} left aside");
        assert_eq!(times_told(&world, &words), 1);
    }
    assert_eq!(
        world.companion.restart_note(world.time_s),
        None,
        "it is another program's"
    );
    world.run_until(130.0);
    assert!(world.least_m[0].0 >= RADIUS_M, "{:?}", world.least_m);
    let changes = world.emulator.mode_changes().len();
    assert_eq!(changes, 2);
}

/// Of two vehicles on one link the one that was left in a manoeuvre is taken, whichever is heard first.
#[test]
fn l4_the_vehicle_of_the_note_is_waited_for() {
    let mut world = World::new("", GOOD, 4);
    let notes = vec![note(1, &world)];
    fly_with(&mut world, "", false, notes);
    world.emulator.pilot_mode(PlaneMode::Guided);
    let beat = heartbeat(PlaneMode::Auto.number(), true);
    let header = mavlink::MavHeader {
        system_id: 9,
        component_id: 1,
        sequence: 0,
    };
    world.companion.receive(&header, &beat, 0.0);
    world.run_until(2.0);
    assert_eq!(world.companion.vehicle_system(), Some(1));
}

/// A note that this computer's clock says is older than the vehicle's clock says is of another vehicle.
#[test]
fn l4_a_note_whose_age_contradicts_the_vehicles_clock_takes_no_guided() {
    let mut world = World::new("", GOOD, 4);
    let old = Note {
        age_s: 400,
        ..note(1, &world)
    };
    world.emulator.pilot_mode(PlaneMode::Guided);
    fly_with(&mut world, "", false, vec![old]);
    world.run_until(30.0);
    assert_eq!(world.mode(), PlaneMode::Guided, "the pilot's");
    assert!(was_told(
        &world,
        "fga: an old note of a manoeuvre, mode left alone"
    ));
}

fn circle(world: &World, at_m: [f64; 2], radius_m: f32) -> MissionItem {
    MissionItem {
        command: MavCmd::MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION,
        parameters: [radius_m, 0.0, 0.0, 0.0],
        ..MissionItem::waypoint(world.emulator.home(), [at_m[0], at_m[1], 0.0])
    }
}

/// Without traffic a stored fence took the aircraft off its mission, and a waypoint inside was never reached.
#[test]
fn l6_a_fence_is_no_threat_by_itself() {
    let crosses = "fga: the mission crosses the fence";
    for (enabled, kinds, active) in [(0.0, 7.0, false), (1.0, 3.0, false), (1.0, 7.0, true)] {
        for network in [GOOD, BAD] {
            let mut world = World::new("", network, 4);
            let points = [
                [0.0, 0.0, 100.0],
                [0.0, 1500.0, 100.0],
                [600.0, 3000.0, 100.0],
            ];
            let items = mission(&world.emulator, &points);
            world.emulator.set_mission(items, 2);
            let fence = vec![
                circle(&world, [0.0, 900.0], 120.0),
                circle(&world, [50.0, 1500.0], 200.0),
                circle(&world, [170.0, 2100.0], 60.0),
            ];
            world.emulator.store_fence(fence);
            world.emulator.parameters.set("FENCE_ENABLE", enabled);
            world.emulator.parameters.set("FENCE_TYPE", kinds);
            let mut nearest_m = f64::INFINITY;
            while !world.emulator.mission_done() && world.time_s < 250.0 {
                world.step();
                nearest_m = nearest_m.min(distance(world.emulator.plant().position_m(), points[1]));
            }
            assert!(
                nearest_m < 31.0 && world.emulator.mission_done(),
                "{nearest_m}"
            );
            assert_eq!(world.emulator.mode_changes(), [], "{enabled} {kinds}");
            assert_eq!(times_told(&world, crosses), usize::from(active));
        }
    }
}

/// Where the manoeuvre would lead by its own choice stands a circle: it counts while the fence is enabled.
#[test]
fn l6_an_enabled_fence_bounds_the_manoeuvre_and_a_disabled_one_does_not() {
    let flown = |fence: Option<([f64; 2], f64)>| {
        let mut world = World::new("", GOOD, 8);
        world.add(head_on(3000.0));
        if let Some((at_m, enabled)) = fence {
            let fence = vec![circle(&world, at_m, 70.0)];
            world.emulator.store_fence(fence);
            world.emulator.parameters.set("FENCE_ENABLE", enabled);
            world.emulator.parameters.set("FENCE_TYPE", 7.0);
        }
        let (mut farthest_m, mut least_m) = ([0.0_f64; 3], f64::INFINITY);
        while world.time_s < 130.0 {
            world.step();
            let own_m = world.emulator.plant().position_m();
            if own_m[0].abs() > farthest_m[0].abs() {
                farthest_m = own_m;
            }
            if let Some((at_m, _)) = fence {
                least_m = f64::min(least_m, (own_m[0] - at_m[0]).hypot(own_m[1] - at_m[1]));
            }
        }
        assert!(world.least_m[0].0 >= RADIUS_M, "{:?}", world.least_m);
        assert_eq!(world.mode(), PlaneMode::Auto);
        (farthest_m, least_m)
    };
    let (at_m, _) = flown(None);
    let side_m = [1.2 * at_m[0], at_m[1]];
    let (_, disabled_m) = flown(Some((side_m, 0.0)));
    let (_, enabled_m) = flown(Some((side_m, 1.0)));
    assert!(disabled_m < 70.0, "{disabled_m}");
    assert!(enabled_m >= 70.0, "{enabled_m}");
}

/// The program is killed in a manoeuvre and another one begins with its note.
fn restart(world: &mut World, config: &str, after_s: f64) {
    let note = world.companion.restart_note(world.time_s);
    world.killed = true;
    world.run_until(world.time_s + after_s);
    fly_with(world, config, false, note.into_iter().collect());
    world.killed = false;
}

/// Restarted in a manoeuvre it gave the mode back before it had heard any traffic.
#[test]
fn l7_restarted_in_a_manoeuvre_it_hears_traffic_before_it_gives_back() {
    for (report_every_s, after_s) in [
        (5.0, 0.3),
        (5.0, 2.0),
        (1.0, 0.3),
        (1.0, 1.0),
        (0.5, 3.0),
        (2.0, 0.5),
    ] {
        for killed_s in [0.3, 1.5, 3.0] {
            let mut world = World::new("", GOOD, 4);
            world.report_every_s = report_every_s;
            world.add(head_on(3000.0));
            world.run_while(90.0, "GUIDED", |w| w.mode() != PlaneMode::Guided);
            world.run_until(world.time_s + killed_s);
            restart(&mut world, "", after_s);
            world.run_until(150.0);
            let what = format!("{report_every_s} {after_s} {killed_s}: {:?}", world.least_m);
            assert!(world.least_m[0].0 >= RADIUS_M, "{what}");
            let changes = world.emulator.mode_changes();
            assert_eq!(changes.len(), 2, "{what}: {changes:?}");
            assert_eq!(world.mode(), PlaneMode::Auto, "{what}");
        }
    }
}

/// A signal to end in a manoeuvre gave the mode back into the threat.
#[test]
fn l8_a_program_that_is_to_end_flies_on_until_the_mission_is_clear() {
    for network in [GOOD, BAD] {
        for after_s in [0.1, 1.0, 3.0, 6.0] {
            for intruder in [
                head_on(3000.0),
                Intruder::straight(0x00AB_CDEF, [1500.0, 1500.0, 100.0], [-25.0, 0.0, 0.0]),
            ] {
                let mut world = World::new("", network, 4);
                world.add(intruder);
                world.run_while(90.0, "GUIDED", |w| w.mode() != PlaneMode::Guided);
                world.run_until(world.time_s + after_s);
                let asked_s = world.time_s;
                world.companion.shut_down(asked_s);
                world.run_while(61.0, "AUTO", |w| w.mode() != PlaneMode::Auto);
                let took_s = world.time_s - asked_s;
                world.run_until(world.time_s + 60.0);
                let least_m = world.least_m[0].0;
                assert!(least_m >= RADIUS_M, "{after_s}: {least_m} {took_s}");
                assert_eq!(world.mode(), PlaneMode::Auto);
                // A lossy link may lose a text, which nobody acknowledges.
                if network.loss == 0.0 {
                    assert!(was_told(&world, "fga: program ends, restores the mode"));
                    assert!(was_told(&world, "fga: program ends when clear"));
                }
            }
        }
    }
}

/// It ends all the same while something threatens for ever, and at once after a second signal.
#[test]
fn l8_the_end_is_bounded_and_a_second_signal_ends_at_once() {
    let chased = || {
        let mut world = World::new("", GOOD, 4);
        world.add(head_on(3000.0));
        world.run_while(90.0, "GUIDED", |w| w.mode() != PlaneMode::Guided);
        world.run_until(world.time_s + 0.5);
        // It stands in the way from now on, wherever that leads.
        world.intruders[0].velocity_mps = [0.0; 3];
        world
    };
    let mut world = chased();
    world.companion.shut_down(world.time_s);
    let until_s = world.time_s + 61.0;
    while world.time_s < until_s {
        let own_m = world.emulator.plant().position_m();
        world.intruders[0].position_m = [own_m[0] * 0.5, own_m[1] + 150.0, 100.0];
        world.step();
    }
    assert_eq!(world.mode(), PlaneMode::Auto);
    let mut world = chased();
    world.companion.shut_down(world.time_s);
    world.run_until(world.time_s + 0.2);
    world.companion.shut_down_at_once(world.time_s);
    world.run_until(world.time_s + 0.5);
    assert_eq!(world.mode(), PlaneMode::Auto);
}

/// After a kill the vehicle was left in GUIDED without a word by a program that cannot take it up.
#[test]
fn l14_a_vehicle_that_was_left_in_a_manoeuvre_is_named_by_whoever_cannot_fly_it() {
    for (config, dry_run) in [
        ("", true),
        ("[command]\nmode = \"paper\"\n", false),
        ("[vehicle]\nsystem_id = 2\n", false),
    ] {
        let mut world = World::new("", GOOD, 4);
        world.add(head_on(3000.0));
        world.run_while(90.0, "GUIDED", |w| w.mode() != PlaneMode::Guided);
        world.run_until(world.time_s + 1.0);
        let left = world.companion.restart_note(world.time_s);
        fly_with(&mut world, config, dry_run, left.into_iter().collect());
        world.run_until(world.time_s + 20.0);
        let words = "fga: vehicle 1 left in GUIDED: set AUTO";
        assert_eq!(times_told(&world, words), 1, "{config} {dry_run}");
        assert_eq!(
            world.mode(),
            PlaneMode::Guided,
            "nobody commands what it does not fly"
        );
        let line = world.companion.status_line(world.time_s);
        if config.contains("system_id") {
            assert_eq!(
                line,
                "waiting for a vehicle: 1 is heard, expected vehicle.system_id"
            );
        }
    }
}

/// A mode that flickers after the pilot took over filled the operator's screen.
#[test]
fn l14_guided_that_nobody_flies_is_named_every_five_seconds_at_most() {
    let mut world = World::new("", GOOD, 4);
    world.add(head_on(3000.0));
    world.run_while(90.0, "GUIDED", |w| w.mode() != PlaneMode::Guided);
    world.run_until(world.time_s + 1.0);
    for mode in [PlaneMode::Loiter, PlaneMode::Guided]
        .into_iter()
        .cycle()
        .take(50)
    {
        world.emulator.pilot_mode(mode);
        world.run_until(world.time_s + 0.3);
    }
    world.run_until(world.time_s + 2.0);
    // 17 s, 25 changes to GUIDED.
    let times = times_told(&world, "fga: GUIDED, but nobody flies");
    assert!((1..=4).contains(&times), "{times}");
}

#[test]
fn l14_a_link_of_mavlink_1_is_named() {
    let mut companion = Companion::new(Config::default(), false).expect("a companion");
    for n in 0..50_u8 {
        companion.hear_version1(1, f64::from(n));
    }
    let line = companion.status_line(50.0);
    assert_eq!(
        line,
        "waiting for a vehicle: 1 sends MAVLink 1, expected MAVLink 2"
    );
    let texts = companion.outbox();
    assert_eq!(texts.len(), 1);
}
