//! Flights of aircraft of which the configuration is wrong: they turn faster or slower than it says, and bank earlier or later.

use crate::common::{GOOD, Intruder, Random, World};
use fga_emulator::{EmulatorSettings, PlaneMode, PlantSettings};

const PROTECTED_M: f64 = 60.0;
const MEET_S: [f64; 2] = [60.0, 150.0];

/// What came of the flights.
#[derive(Debug, Default)]
struct Flown {
    flights: u32,
    kept: u32,
    missed: u32,
    maneuvers: u32,
    back: u32,
    off_m: Vec<f64>,
    factors: Vec<f64>,
}

/// Flies past two intruders, the second one with what the first one taught.
fn fly(seed: u64, (wrong, config): (f64, &str), flown: &mut Flown) {
    let mut random = Random::new(seed);
    let standard = PlantSettings::default();
    let plant = PlantSettings {
        turn_rate_factor: standard.turn_rate_factor * (1.0 + wrong * random.uniform(-0.25, 0.25)),
        roll_time_constant_s: standard.roll_time_constant_s + wrong * random.uniform(-0.15, 0.4),
        ..standard
    };
    let settings = EmulatorSettings {
        plant,
        wind_mps: [random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0)],
        ..EmulatorSettings::default()
    };
    let wind_mps = settings.wind_mps;
    let mut world = World::with(settings, config, GOOD, seed);
    for (icao, meet_s) in [(0x00AB_CDEF, MEET_S[0]), (0x00AB_CDEE, MEET_S[1])] {
        let track = random.uniform(90.0, 270.0_f64).to_radians();
        let speed = random.uniform(15.0, 35.0);
        let velocity = [speed * track.sin(), speed * track.cos(), 0.0];
        let meet = [random.uniform(-30.0, 30.0), (25.0 + wind_mps[1]) * meet_s];
        let from = [
            meet[0] - velocity[0] * meet_s,
            meet[1] - velocity[1] * meet_s,
            100.0,
        ];
        let shown_m = random.uniform(250.0, 525.0);
        world.add(Intruder {
            shown_m,
            ..Intruder::straight(icao, from, velocity)
        });
    }
    let mut off_m = 0.0_f64;
    while world.time_s < 220.0 {
        world.step();
        off_m = off_m.max(world.off_leg().0);
    }
    flown.flights += 1;
    flown.kept += u32::from(world.least_m.iter().all(|least| least.0 >= PROTECTED_M));
    flown.back += u32::from(world.mode() == PlaneMode::Auto);
    flown.off_m.push(off_m);
    flown.missed += world.companion.counts().missed;
    flown.maneuvers += world.companion.counts().maneuvers;
    flown
        .factors
        .push(world.companion.response().turn_rate_factor / plant.turn_rate_factor);
    if std::env::var("FGA_LOG").is_ok() {
        let response = world.companion.response();
        eprintln!("{seed}: {:?} {off_m:.0} m, {response:?}", world.least_m);
        let log = world.companion.take_log();
        let texts = log.iter().filter(|line| line["kind"] == "text");
        texts.for_each(|line| eprintln!("  {} {}", line["t_s"], line["text"]));
    }
}

fn campaign(wrong: f64, config: &str) -> Flown {
    let mut flown = Flown::default();
    for seed in crate::common::seeds(12) {
        fly(seed, (wrong, config), &mut flown);
    }
    flown.off_m.sort_by(f64::total_cmp);
    flown.factors.sort_by(f64::total_cmp);
    let middle = |of: &[f64]| of[of.len() / 2];
    eprintln!(
        "wrong {wrong} {config:?}: {} of {} kept, {} back, {} manoeuvres, {} missed, off the leg {:.0} m (largest {:.0} m), factor {:.3?}",
        flown.kept,
        flown.flights,
        flown.back,
        flown.maneuvers,
        flown.missed,
        middle(&flown.off_m),
        flown.off_m.last().unwrap(),
        [
            flown.factors[0],
            middle(&flown.factors),
            *flown.factors.last().unwrap()
        ],
    );
    flown
}

const MARGIN: &str = "[response]\nmargin = true\n";

#[test]
fn an_aircraft_of_which_the_configuration_is_wrong_keeps_clear_and_is_learned() {
    for config in ["", MARGIN] {
        let flown = campaign(1.0, config);
        let all = (flown.flights, flown.flights);
        assert_eq!((flown.kept, flown.back), all, "{flown:?}");
        let factors = &flown.factors;
        assert!(
            factors.iter().all(|ratio| (0.85..1.08).contains(ratio)),
            "{flown:?}"
        );
        assert!(10 * flown.missed <= flown.maneuvers + 9, "{flown:?}");
    }
}

#[test]
fn an_aircraft_of_which_the_configuration_is_right_keeps_clear() {
    for config in ["", MARGIN] {
        let flown = campaign(0.0, config);
        let all = (flown.flights, flown.flights);
        assert_eq!((flown.kept, flown.back), all, "{flown:?}");
    }
}
