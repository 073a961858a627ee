//! What is learned of drawn aircraft that fly as the vehicle equations say, in a wind, with noise.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small numbers of steps"
)]

use fga_learned::{Interval, KnownAircraft, Learned, SeenState};
use fga_proof::Vec2;
use fga_proof::vehicle::{Response, STANDARD_GRAVITY_MPS2};
use proptest::prelude::*;
use proptest::strategy::ValueTree as _;
use proptest::test_runner::{Config, TestRng, TestRunner};

/// A drawn aircraft, and a vehicle file that is wrong by less than it is believed to be.
#[derive(Debug, Clone, Copy)]
struct Drawn {
    airspeed_mps: f64,
    truth: Response,
    wind_mps: Vec2,
    believed: KnownAircraft,
    bank_rad: f64,
    leg_s: f64,
    noise: f64,
    seed: u32,
}

fn drawn() -> impl Strategy<Value = Drawn> {
    let truth = (0.5..1.1_f64, 0.15..1.2_f64, 0.0..0.6_f64, 12.0..35.0_f64);
    let off = (-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64);
    let wind = (-6.0..6.0_f64, -6.0..6.0_f64, -4.0..4.0_f64, -4.0..4.0_f64);
    let flight = (0.3..0.9_f64, 2.0..8.0_f64, 0.0..1.0_f64, any::<u32>());
    (truth, off, wind, flight).prop_map(|(truth, off, wind, flight)| {
        let truth_response = Response {
            turn_rate_factor: truth.0,
            bank_time_constant_s: truth.1,
            dead_time_s: truth.2,
        };
        let file = Response {
            turn_rate_factor: truth.0 / (1.0 + 0.25 * off.0),
            bank_time_constant_s: (truth.1 + 0.4 * off.1).max(0.0),
            dead_time_s: (truth.2 + 0.2 * off.2).max(0.0),
        };
        let wind_mps = Vec2::new(wind.0, wind.1);
        let believed_mps = wind_mps + Vec2::new(wind.2, wind.3);
        Drawn {
            airspeed_mps: truth.3,
            truth: truth_response,
            wind_mps,
            believed: KnownAircraft::within(&file, believed_mps, (0.26, 0.4, 0.2, 4.0)),
            bank_rad: flight.0,
            leg_s: flight.1,
            noise: flight.2,
            seed: flight.3,
        }
    })
}

/// A draw between −1 and 1.
fn noise(seed: &mut u32) -> f64 {
    *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    f64::from(*seed >> 8) / f64::from(1_u32 << 23) - 1.0
}

/// Flies turns to both sides; looks at what is known after each step of 0.1 s.
fn fly(drawn: &Drawn, seconds: f64, mut look: impl FnMut(f64, &Learned)) -> Learned {
    const STEP_S: f64 = 0.01;
    let mut learned = Learned::default();
    let (mut bank_rad, mut course_rad, mut seed) = (0.0_f64, 0.3_f64, drawn.seed);
    let commanded = |time_s: f64| {
        let leg = (time_s / drawn.leg_s).floor().rem_euclid(3.0);
        drawn.bank_rad * (1.0 - leg)
    };
    let steps = (seconds / STEP_S) as u32;
    for step in 0..steps {
        let time_s = f64::from(step) * STEP_S;
        let target_rad = commanded(time_s - drawn.truth.dead_time_s);
        let stays = (-STEP_S / drawn.truth.bank_time_constant_s).exp();
        bank_rad = target_rad + (bank_rad - target_rad) * stays;
        let rate = drawn.truth.turn_rate_factor * STANDARD_GRAVITY_MPS2 * bank_rad.tan()
            / drawn.airspeed_mps;
        course_rad += rate * STEP_S;
        if step % 10 != 9 {
            continue;
        }
        let time_s = time_s + STEP_S;
        let scale = drawn.noise;
        let direction = Vec2::new(course_rad.cos(), course_rad.sin());
        let gust_mps = 0.5 * scale * Vec2::new(noise(&mut seed), noise(&mut seed));
        let seen = SeenState {
            time_s,
            bank_rad: bank_rad + 0.004 * scale * noise(&mut seed),
            turn_rate_radps: rate + 0.02 * scale * noise(&mut seed),
            airspeed_mps: drawn.airspeed_mps + 0.5 * scale * noise(&mut seed),
            velocity_mps: Some(drawn.airspeed_mps * direction + drawn.wind_mps + gust_mps),
        };
        learned.see(&seen, |before_s| Some(commanded(time_s - before_s)));
        look(time_s, &learned);
    }
    learned
}

fn rows(known: &KnownAircraft) -> [Interval; 6] {
    let [east, north] = known.wind_mps;
    [
        known.turn_rate_factor,
        known.bank_time_constant_s,
        known.dead_time_s,
        known.late_s,
        east,
        north,
    ]
}

fn truth(drawn: &Drawn) -> [f64; 6] {
    let Response {
        dead_time_s,
        bank_time_constant_s,
        turn_rate_factor,
    } = drawn.truth;
    let late_s = dead_time_s + bank_time_constant_s;
    let wind = drawn.wind_mps;
    [
        turn_rate_factor,
        bank_time_constant_s,
        dead_time_s,
        late_s,
        wind.x,
        wind.y,
    ]
}

/// The same draws each time.
fn draws(count: u32) -> impl Iterator<Item = Drawn> {
    let config = Config {
        failure_persistence: None,
        ..Config::default()
    };
    let rng = TestRng::deterministic_rng(config.rng_algorithm);
    let mut runner = TestRunner::new_with_rng(config, rng);
    (0..count).map(move |_| drawn().new_tree(&mut runner).expect("a draw").current())
}

/// Of each value at each time at least 97 of 100.
#[test]
fn the_truth_lies_in_the_interval_as_often_as_is_said() {
    const TIMES_S: [f64; 4] = [5.0, 15.0, 30.0, 90.0];
    const DRAWS: u32 = 300;
    let mut inside = [[0_u32; 6]; TIMES_S.len()];
    let mut widths = [[0.0; 6]; TIMES_S.len()];
    for drawn in draws(DRAWS) {
        let truth = truth(&drawn);
        fly(&drawn, 90.5, |time_s, learned| {
            let Some(at) = TIMES_S.iter().position(|at_s| (time_s - at_s).abs() < 0.05) else {
                return;
            };
            let known = rows(&learned.known(&drawn.believed));
            for (n, (row, truth)) in known.iter().zip(truth).enumerate() {
                inside[at][n] += u32::from(row.contains(truth));
                widths[at][n] += row.half() / f64::from(DRAWS);
            }
        });
    }
    for (at_s, (inside, widths)) in TIMES_S.iter().zip(inside.iter().zip(widths)) {
        eprintln!("after {at_s} s: inside {inside:?} of {DRAWS}, half widths {widths:.3?}");
    }
    assert!(
        inside
            .iter()
            .flatten()
            .all(|inside| 100 * inside >= 97 * DRAWS)
    );
}

proptest! {
    #![proptest_config(Config { cases: 64, failure_persistence: None, ..Config::default() })]

    /// Straight flight, a still bank and no command.
    #[test]
    fn an_interval_narrows_by_evidence_alone(drawn in drawn(), flown_s in 0.0..30.0_f64) {
        let before = rows(&Learned::default().known(&drawn.believed));
        for (row, believed) in before.iter().zip(rows(&drawn.believed)) {
            let off = (row.low - believed.low).abs().max((row.high - believed.high).abs());
            prop_assert!(off < 1e-9, "{row:?} {believed:?}");
        }
        let mut learned = fly(&drawn, flown_s, |_, _| {});
        let before = rows(&learned.known(&drawn.believed));
        for n in 0..600_u32 {
            let seen = SeenState {
                time_s: 1000.0 + 0.1 * f64::from(n),
                bank_rad: 0.01,
                turn_rate_radps: 0.003,
                airspeed_mps: drawn.airspeed_mps,
                velocity_mps: None,
            };
            learned.see(&seen, |_| None);
        }
        let after = rows(&learned.known(&drawn.believed));
        for (before, after) in before.iter().zip(after) {
            prop_assert!(after.half() >= before.half() - 1e-9, "{before:?} {after:?}");
        }
    }

    /// NaN, infinities, clocks that jump and gaps, between states of a flight.
    #[test]
    fn nothing_that_is_not_finite_comes_out(
        drawn in drawn(),
        rubbish in prop::collection::vec((prop::array::uniform6(any::<f64>()), any::<f64>()), 1..200),
    ) {
        let mut learned = fly(&drawn, 10.0, |_, _| {});
        for (n, ([time_s, bank_rad, rate, airspeed_mps, x, y], commanded)) in rubbish.iter().enumerate() {
            let plausible = n % 3 == 0;
            let seen = SeenState {
                time_s: if plausible { 10.0 + 0.1 * n as f64 } else { *time_s },
                bank_rad: if plausible { 0.5 } else { *bank_rad },
                turn_rate_radps: *rate,
                airspeed_mps: if n % 2 == 0 { 20.0 } else { *airspeed_mps },
                velocity_mps: Some(Vec2::new(*x, *y)),
            };
            learned.see(&seen, |_| Some(*commanded));
        }
        for row in rows(&learned.known(&drawn.believed)) {
            prop_assert!([row.low, row.mean, row.high].iter().all(|v| v.is_finite()), "{row:?}");
            prop_assert!(row.low <= row.mean + 1e-9 && row.mean <= row.high + 1e-9, "{row:?}");
        }
    }

    /// The same flight with another load: a factor that is lower by 0.2 from the middle on.
    #[test]
    fn an_aircraft_that_becomes_another_one_is_learned_anew(drawn in drawn()) {
        prop_assume!(drawn.truth.turn_rate_factor > 0.7 && drawn.noise < 0.5);
        let turning = |learned: &mut Learned, from_s: f64, factor: f64| {
            for n in 0..900_u32 {
                let (bank_rad, airspeed_mps) = (drawn.bank_rad, drawn.airspeed_mps);
                let ideal = STANDARD_GRAVITY_MPS2 * bank_rad.tan() / airspeed_mps;
                let time_s = from_s + 0.1 * f64::from(n);
                let turn_rate_radps = factor * ideal;
                let seen = SeenState { time_s, bank_rad, turn_rate_radps, airspeed_mps, velocity_mps: None };
                learned.see(&seen, |_| None);
            }
        };
        let factor = drawn.truth.turn_rate_factor;
        let mut learned = Learned::default();
        turning(&mut learned, 0.0, factor);
        prop_assert!(learned.known(&drawn.believed).turn_rate_factor.contains(factor));
        turning(&mut learned, 90.0, factor - 0.2);
        let known = learned.known(&drawn.believed).turn_rate_factor;
        prop_assert!(known.contains(factor - 0.2), "{known:?} {factor}");
    }

    #[test]
    fn the_same_flight_teaches_the_same(drawn in drawn()) {
        let flown = || fly(&drawn, 20.0, |_, _| {}).known(&drawn.believed);
        prop_assert_eq!(flown(), flown());
    }
}
