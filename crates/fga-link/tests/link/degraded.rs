//! Sensors, clocks, links and settings that are wrong but not gone: it avoids with what there is, or says by name why not.

#![allow(
    clippy::cast_possible_truncation,
    reason = "a bench with small numbers"
)]

use core::ops::Range;

use crate::common::{GOOD, Intruder, Network, Random, World, seeds};
use fga_emulator::PlaneMode;
use fga_link::authority::Authority;
use fga_link::signing::Signing;
use mavlink::dialects::ardupilotmega::MavMessage;

/// Protected by default, metres.
const PROTECTED_M: f64 = 60.0;
const KEY: [u8; 32] = [7; 32];
const YEARS_S: i64 = 2_000_000_000;

/// A head-on intruder that meets the aircraft after a minute.
fn head_on(config: &str) -> World {
    let mut world = World::new(config, GOOD, 3);
    world.add(Intruder::head_on());
    world
}

fn times_told(world: &World, text: &str) -> usize {
    let texts = world.emulator.texts().iter();
    texts.filter(|told| told.contains(text)).count()
}

fn assert_kept(world: &World, what: &str) {
    let (least_m, at_s) = world.least_m[0];
    let texts = world.emulator.texts();
    eprintln!("{what}: least {least_m:.1} m at {at_s:.1} s");
    assert!(least_m >= PROTECTED_M, "{what}: {least_m} m, {texts:?}");
    assert_eq!(world.mode(), PlaneMode::Auto, "{what}");
}

/// A signed link: the companion's clock is off by some seconds.
fn signed(world: &mut World, clock_off_s: i64) {
    world.signing = Some((
        Signing::new(KEY, 0, false),
        Signing::with_clock_off(KEY, 1, false, clock_off_s),
    ));
}

#[test]
fn l5_a_signed_link_is_flown_with_any_clock() {
    for off_s in [-YEARS_S, -3600, 0, 3600] {
        let mut world = head_on("");
        signed(&mut world, off_s);
        world.run_until(110.0);
        assert_kept(&world, &format!("clock off by {off_s} s"));
        // At most what was sent before anything was heard.
        assert_eq!(world.refused[0], 0);
        assert!(world.refused[1] < 30, "{:?}", world.refused);
    }
}

#[test]
fn l9_a_blocked_pitot_tube_switches_nothing_off() {
    for blocked_s in [0.0, 20.0, 48.0] {
        let mut world = head_on("");
        while world.time_s < 110.0 {
            world.blocked_pitot = world.time_s >= blocked_s;
            world.step();
        }
        assert_kept(&world, &format!("blocked from {blocked_s} s"));
        assert_eq!(times_told(&world, "airspeed sensor fails"), 1);
    }
}

/// The airspeed that a real ArduPlane reports comes some tenths of a second after the ground speed, in the take-off run too.
#[test]
fn l9_an_airspeed_that_comes_late_is_no_failure() {
    let mut world = head_on("");
    while world.time_s < 30.0 {
        world.blocked_pitot = (20.0..20.8).contains(&world.time_s);
        world.step();
    }
    assert_eq!(times_told(&world, "airspeed sensor fails"), 0);
}

#[test]
fn l10_the_round_trip_is_part_of_readiness_and_of_the_plan() {
    for (each_way_s, usable) in [
        (0.05, true),
        (0.3, true),
        (0.6, true),
        (1.5, false),
        (3.0, false),
    ] {
        let mut world = head_on("");
        world.network.delay_s = each_way_s;
        let mut ready = false;
        while world.time_s < 110.0 {
            world.step();
            ready |= world.time_s > 20.0 && world.companion.authority() == Authority::Ready;
        }
        assert_eq!(ready, usable, "{each_way_s} s each way");
        if usable {
            assert_kept(&world, &format!("{each_way_s} s each way"));
        } else {
            assert_eq!(world.emulator.mode_changes().len(), 0, "{each_way_s} s");
            assert_eq!(
                times_told(&world, "link answers too late"),
                1,
                "{each_way_s} s"
            );
        }
    }
}

#[test]
fn l11_the_vehicles_own_avoidance_is_named_once() {
    for action in [2.0, 3.0, 4.0, 5.0, 6.0] {
        let mut world = head_on("");
        world.set_parameter("AVD_ENABLE", 1.0);
        world.set_parameter("AVD_F_ACTION", action);
        world.run_until(90.0);
        assert_eq!(times_told(&world, "AVD_F_ACTION avoids by itself"), 1);
        assert_eq!(times_told(&world, "fga: not ready"), 1, "{action}");
        assert_eq!(times_told(&world, "fga: ready"), 0, "{action}");
        assert_eq!(world.companion.counts().maneuvers, 0);
    }
    // It only reports.
    let mut world = head_on("");
    world.set_parameter("AVD_ENABLE", 1.0);
    world.run_until(110.0);
    assert_kept(&world, "AVD_F_ACTION 1");
}

#[test]
fn l13_a_bank_limit_of_nine_degrees_is_avoided_with() {
    for (limit, vertical) in [(9.0, false), (9.0, true), (6.0, false), (3.0, true)] {
        let mut world = head_on(&format!("[vehicle]\nvertical = {vertical}\n"));
        // Seen as far ahead as ADS-B is.
        world.intruders[0].shown_m = f64::INFINITY;
        world.set_parameter("ROLL_LIMIT_DEG", limit);
        world.run_until(160.0);
        let (least_m, _) = world.least_m[0];
        eprintln!("limit {limit}, vertical {vertical}: least {least_m:.1} m");
        assert!(
            least_m >= PROTECTED_M,
            "limit {limit}, vertical {vertical}: {least_m} m"
        );
        assert_eq!(times_told(&world, "cannot be flown"), 0);
    }
}

/// The pilot reads within this time that the vehicle is left in GUIDED, seconds.
const WORDS_WITHIN_S: f64 = 5.0;

/// Whether a text leaves the mode to the pilot.
fn leaves_to_pilot(text: &str) -> bool {
    ["pilot must set it", "released", "set one", "set a mode"]
        .iter()
        .any(|words| text.contains(words))
}

/// Watches that GUIDED without the companion is on its way back to the mission, or in the pilot's hands.
#[derive(Default)]
struct NobodyFlies {
    since_s: Option<f64>,
    told_s: Option<f64>,
}

impl NobodyFlies {
    /// The failure in words.
    fn watch(&mut self, world: &mut World) -> Option<String> {
        let now_s = world.time_s;
        for (sent_s, message) in world.sent.drain(..) {
            if let MavMessage::STATUSTEXT(data) = message
                && data.text.to_str().is_ok_and(leaves_to_pilot)
            {
                self.told_s = Some(sent_s);
            }
        }
        // A mode that is owed is asked for until the vehicle reports it, or the pilot reads that it does not.
        let cares = world.companion.owed().is_some();
        if world.mode() != PlaneMode::Guided || cares {
            self.since_s = None;
            return None;
        }
        let since_s = *self.since_s.get_or_insert(now_s);
        let told = self.told_s.is_some_and(|s| s > since_s - WORDS_WITHIN_S);
        if told || now_s - since_s <= WORDS_WITHIN_S {
            return None;
        }
        let texts = world.emulator.texts();
        Some(format!("GUIDED is nobody's from {since_s:.1} s: {texts:?}"))
    }
}

/// Wrong in two ways at once, from drawn moments on.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    Pitot,
    Avoidance(f32),
    Queue(f64),
    Clock(i64),
    Bank(f32),
}

fn drawn(random: &mut Random) -> (Fault, f64, f64) {
    let fault = match random.next() % 5 {
        0 => Fault::Pitot,
        1 => Fault::Avoidance(if random.next().is_multiple_of(2) {
            3.0
        } else {
            4.0
        }),
        2 => Fault::Queue(random.uniform(1.0, 5.0)),
        3 => Fault::Clock([-YEARS_S, -3600, 3600][(random.next() % 3) as usize]),
        _ => Fault::Bank(if random.next().is_multiple_of(2) {
            9.0
        } else {
            3.0
        }),
    };
    let begins_s = random.uniform(5.0, 60.0);
    (fault, begins_s, begins_s + random.uniform(1.0, 30.0))
}

/// What must hold in a flight with drawn faults; the failure in words.
fn fails(seed: u64) -> Option<String> {
    let mut random = Random::new(seed);
    let faults = [drawn(&mut random), drawn(&mut random)];
    let is_on = |wanted: fn(Fault) -> bool, time_s: f64| {
        faults
            .iter()
            .any(|(fault, from_s, to_s)| wanted(*fault) && (*from_s..*to_s).contains(&time_s))
    };
    let mut world = head_on("");
    world.keep_sent = true;
    let mut nobody = NobodyFlies::default();
    for (fault, ..) in faults {
        if let Fault::Clock(off_s) = fault {
            signed(&mut world, off_s);
        }
    }
    let (mut able, mut lost) = (false, None);
    while world.time_s < 130.0 {
        world.blocked_pitot = is_on(|fault| fault == Fault::Pitot, world.time_s);
        for (fault, from_s, to_s) in faults {
            let crosses =
                |at_s: f64| world.time_s < at_s && at_s <= world.time_s + fga_emulator::STEP_S;
            let (begins, ends) = (crosses(from_s), crosses(to_s));
            match fault {
                Fault::Avoidance(action) if begins => {
                    world.set_parameter("AVD_ENABLE", 1.0);
                    world.set_parameter("AVD_F_ACTION", action);
                }
                Fault::Avoidance(_) if ends => world.set_parameter("AVD_F_ACTION", 1.0),
                Fault::Bank(limit) if begins => world.set_parameter("ROLL_LIMIT_DEG", limit),
                Fault::Bank(_) if ends => world.set_parameter("ROLL_LIMIT_DEG", 45.0),
                Fault::Queue(queue_s) if begins => world.uplink_queue_s = queue_s,
                Fault::Queue(_) if ends => world.uplink_queue_s = 0.0,
                _ => {}
            }
        }
        let told = world.companion.counts().texts;
        world.step();
        if let Some(failure) = nobody.watch(&mut world) {
            return Some(format!("seed {seed}: {failure}, {faults:?}"));
        }
        let now_able = matches!(
            world.companion.authority(),
            Authority::Ready
                | Authority::Taking { .. }
                | Authority::InCommand { .. }
                | Authority::Returning { .. }
        );
        if able && !now_able {
            lost = Some((world.time_s, told));
        }
        able = now_able;
        if let Some((lost_s, told)) = lost {
            if able || world.companion.counts().texts > told {
                lost = None;
            } else if world.time_s - lost_s > 3.0 {
                return Some(format!(
                    "seed {seed}: silent from {lost_s:.1} s, {faults:?}"
                ));
            }
        }
    }
    let texts = world.emulator.texts();
    // A blocked tube and a wrong clock take no lead at all.
    let harmless = faults
        .iter()
        .all(|(fault, ..)| matches!(fault, Fault::Pitot | Fault::Clock(_)));
    let (least_m, _) = world.least_m[0];
    (harmless && least_m < PROTECTED_M)
        .then(|| format!("seed {seed}: {least_m:.1} m, {faults:?}, {texts:?}"))
}

/// Up to four queues of 1 to 5 s on the way to the vehicle, which overlap, about the encounter, on a network that loses,
/// copies and reorders; in some sequences the pilot chooses LOITER. Returns the failure in words.
fn fails_in_queues(seed: u64) -> Option<String> {
    let mut random = Random::new(seed ^ 0x0EE5);
    let queues: Vec<(f64, f64, f64)> = (0..=random.next() % 4)
        .map(|_| {
            let begins_s = random.uniform(35.0, 70.0);
            let ends_s = begins_s + random.uniform(0.5, 25.0);
            (random.uniform(1.0, 5.0), begins_s, ends_s)
        })
        .collect();
    let network = Network {
        loss: [0.0, 0.1, 0.3][(random.next() % 3) as usize],
        jitter_s: [0.0, 0.2, 1.0][(random.next() % 3) as usize],
        copies: [0.0, 0.1][(random.next() % 2) as usize],
        ..GOOD
    };
    let pilot = random
        .next()
        .is_multiple_of(4)
        .then(|| random.uniform(45.0, 75.0));
    let mut world = World::new("", network, seed);
    world.keep_sent = true;
    let mut intruder = Intruder::straight(0x00AB_CDEF, [5.0, 3000.0, 100.0], [0.0, -25.0, 0.0]);
    intruder.shown_m = random.uniform(400.0, 1500.0);
    world.add(intruder);
    let mut nobody = NobodyFlies::default();
    let mut chose = false;
    while world.time_s < 140.0 {
        // A later queue replaces an earlier one, so that what it delays is overtaken when it ends.
        let on = |(_, from_s, to_s): &&(f64, f64, f64)| (*from_s..*to_s).contains(&world.time_s);
        let queue_s = queues
            .iter()
            .rfind(on)
            .map_or(0.0, |(queue_s, ..)| *queue_s);
        world.uplink_queue_s = queue_s;
        world.step();
        if pilot.is_some_and(|at_s| at_s <= world.time_s) && !chose {
            chose = true;
            world.emulator.pilot_mode(PlaneMode::Loiter);
        }
        if let Some(failure) = nobody.watch(&mut world) {
            return Some(format!(
                "seed {seed}: {failure}, {queues:?} {network:?}, pilot {pilot:?}"
            ));
        }
    }
    None
}

#[test]
fn l10_guided_is_never_nobodys_under_queues_of_every_order() {
    assert_none(seeds(100), fails_in_queues);
}

#[test]
fn in_no_sequence_of_degradations_an_ability_is_lost_in_silence() {
    assert_none(seeds(100), fails);
}

/// Two queues overlap: requests for GUIDED arrive after the return that overtook them.
#[test]
fn l10_requests_that_the_return_overtook_are_reported() {
    assert_eq!(fails(199), None);
}

/// Flies every seed; no failure is left.
fn assert_none(seeds: Range<u64>, fails: fn(u64) -> Option<String>) {
    let threads = std::thread::available_parallelism().map_or(2, usize::from);
    let failures: Vec<String> = std::thread::scope(|scope| {
        let fliers: Vec<_> = (0..threads)
            .map(|first| {
                let seeds = seeds.clone().skip(first).step_by(threads);
                scope.spawn(move || seeds.filter_map(fails).collect::<Vec<_>>())
            })
            .collect();
        let fliers = fliers.into_iter();
        fliers
            .flat_map(|flier| flier.join().expect("no panic"))
            .collect()
    });
    assert!(
        failures.is_empty(),
        "{} of {seeds:?}: {failures:#?}",
        failures.len()
    );
}
