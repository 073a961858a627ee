//! Message rates: requested until measured, whatever the order of the start and whatever gets lost; and the
//! reaction to a vehicle that does not send them.

use crate::common::{GOOD, Intruder, Network, Random, World};
use fga_emulator::EmulatorSettings;
use fga_link::authority::Authority;

/// Messages and the intervals that the companion wants them at, seconds.
const WANTED: [(u32, f64); 5] = [(30, 0.05), (33, 0.1), (0, 0.25), (74, 0.25), (42, 0.5)];

fn at_the_asked_rates(world: &World) -> bool {
    WANTED.iter().all(|(message_id, asked_s)| {
        let sent_s = world.emulator.interval_s(*message_id);
        sent_s.is_some_and(|sent_s| sent_s <= asked_s + 1e-6)
    })
}

fn is_ready(world: &World) -> bool {
    world.companion.authority() == Authority::Ready
}

fn texts(world: &World, part: &str) -> usize {
    let texts = world.emulator.texts().iter();
    texts.filter(|text| text.contains(part)).count()
}

/// An earlier version requested only the heartbeat if the others came once a second.
#[test]
fn rates_never_asked() {
    let settings = EmulatorSettings {
        default_interval_s: Some(1.0),
        ..EmulatorSettings::default()
    };
    let mut world = World::with(settings, "", GOOD, 1);
    world.run_until(10.0);
    assert!(
        at_the_asked_rates(&world),
        "{:?}",
        world.emulator.interval_s(30)
    );
    assert!(is_ready(&world));
}

/// Every start is different: the messages that the vehicle sends unasked, the time of its initialisation,
/// whether it restarts or falls silent meanwhile. 30 % of all messages are lost.
fn start(seed: u64) {
    let mut random = Random::new(seed * 6364 + 1442);
    let settings = EmulatorSettings {
        default_interval_s: [None, Some(0.25), Some(1.0), Some(2.0)][(random.next() % 4) as usize],
        initialising_until_s: 20.0 + random.uniform(-4.0, 4.0).max(0.0),
        ..EmulatorSettings::default()
    };
    let network = Network {
        loss: 0.3,
        delay_s: 0.02,
        jitter_s: 0.05,
        copies: 0.02,
    };
    let begins_s = settings.initialising_until_s - 20.0;
    let mut world = World::with(settings, "", network, seed);
    // The last event of the start: from then on it has 10 s.
    let mut last_s = begins_s;
    match seed % 3 {
        0 => {
            world.run_until(random.uniform(0.5, 3.0));
            world.emulator.reboot_on_ground();
            last_s = last_s.max(world.time_s);
        }
        1 => {
            world.run_until(random.uniform(0.0, 2.0));
            world.cut = true;
            world.run_until(world.time_s + random.uniform(0.5, 8.0));
            world.cut = false;
            last_s = last_s.max(world.time_s);
        }
        _ => {}
    }
    world.run_until(last_s);
    let both = |world: &World| is_ready(world) && at_the_asked_rates(world);
    while world.time_s < last_s + 10.0 && !both(&world) {
        world.step();
    }
    assert!(
        both(&world),
        "seed {seed}: {} {:?}",
        world.companion.status_line(world.time_s),
        WANTED.map(|(message_id, _)| world.emulator.interval_s(message_id))
    );
}

#[test]
fn five_hundred_starts_are_ready_within_ten_seconds_at_the_asked_rates() {
    for seed in 0..500 {
        start(seed);
    }
}

/// The radio gives only 1 Hz: steadily not ready, and reported in words.
#[test]
fn too_low_a_rate_is_reported_and_never_ready() {
    let settings = EmulatorSettings {
        fastest_interval_s: 1.0,
        ..EmulatorSettings::default()
    };
    let mut world = World::with(settings, "", GOOD, 1);
    world.add(Intruder::straight(
        0x00AB_CDEF,
        [5.0, 3000.0, 100.0],
        [0.0, -25.0, 0.0],
    ));
    while world.time_s < 50.0 {
        world.step();
        assert!(!is_ready(&world), "at {} s", world.time_s);
    }
    assert_eq!(texts(&world, "fga: ready"), 0);
    let told = texts(&world, "fga: not ready: telemetry comes too seldom");
    assert_eq!(told, 1, "{:?}", world.emulator.texts());
    assert!(world.emulator.mode_changes().is_empty());
}

/// 3 Hz is slow and steady: it is ready once and stays so, and keeps its distance.
#[test]
fn a_slow_rate_that_can_be_flown_by_is_flown_by() {
    let settings = EmulatorSettings {
        fastest_interval_s: 0.33,
        ..EmulatorSettings::default()
    };
    let mut world = World::with(settings, "", GOOD, 1);
    world.add(Intruder::head_on());
    world.run_until(110.0);
    assert_eq!(
        texts(&world, "fga: ready"),
        1,
        "{:?}",
        world.emulator.texts()
    );
    assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
    assert_eq!(world.emulator.mode_changes().len(), 2);
}

/// A vehicle that forgets its rates in flight is asked for them again.
#[test]
fn rates_that_fall_in_flight_are_asked_for_again() {
    let settings = EmulatorSettings {
        default_interval_s: Some(1.0),
        ..EmulatorSettings::default()
    };
    let mut world = World::with(settings, "", GOOD, 1);
    world.run_until(10.0);
    world.emulator.forget_rates();
    assert!(!at_the_asked_rates(&world));
    world.run_until(16.0);
    assert!(at_the_asked_rates(&world) && is_ready(&world));
}
