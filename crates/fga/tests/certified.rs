//! A decision that says *certified* is certified: its command, from the aircraft's place, against volumes of their full size.

// The encounters of the benchmarks.
#[path = "../../fga-bench/src/cycles.rs"]
#[expect(dead_code, unreachable_pub, reason = "the benchmark uses the rest")]
mod cycles;
#[path = "../../fga-proof/tests/common/random.rs"]
mod random;

use core::f64::consts::TAU;

use cycles::{BenchAircraft, BenchEncounter};
use fga::Vec3;
use fga::assumptions::{Assumptions, Viewpoint};
use fga::avoider::{Avoider, Settings, Verdict};
use fga::certificate::Hazard;
use fga::command::{Command, Proof, Terms};
use fga::maneuver::{Maneuver, Stage};
use fga::meter::Meter;
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::{
    Mission, Obstacle, Obstacles, Ownship, ProtectedVolume, Situation, Uncertainty,
};
use fga::vehicle::Vehicle;
use random::Random;

const PERIOD_S: f64 = 0.1;

#[test]
fn every_chosen_manoeuvre_has_a_proof() {
    let (mut certified, mut open) = (0, 0);
    for aircraft in BenchAircraft::ALL {
        for number in 0..12 {
            BenchEncounter::threats(aircraft, 1 + number % 4, u64::from(number)).fly(
                |_, _, decision| {
                    let chosen = decision.record.chosen.map(|chosen| chosen.verdict);
                    let proof = decision.command.proof();
                    assert_eq!(
                        proof.is_some(),
                        chosen == Some(Verdict::Chosen),
                        "{decision:?}"
                    );
                    if let Some(bound) = decision.command.certified() {
                        assert!(bound.margin_m >= bound.target_m && bound.target_m > 0.0);
                        assert!(bound.horizon_s > 0.0);
                        certified += 1;
                    } else if chosen.is_some() {
                        open += 1;
                    }
                    false
                },
            );
        }
    }
    assert!(certified > 1000 && open > 10, "{certified} and {open}");
}

/// One to three obstacles that keep their velocity and come near a leg at an altitude, metres.
fn drawn_obstacles(random: &mut Random, z_m: f64) -> Vec<Obstacle> {
    let count = 1 + u32::from(random.chance(0.6)) + u32::from(random.chance(0.4));
    (1..=count)
        .map(|id| {
            let (met_s, (sin, cos)) = (random.within(3.0, 25.0), random.within(0.0, TAU).sin_cos());
            let speed_mps = random.within(0.0, 30.0);
            let velocity_mps =
                Vec3::new(cos * speed_mps, sin * speed_mps, random.within(-1.0, 1.0));
            let aside_m = [(); 2].map(|()| random.within(-20.0, 20.0));
            let met_m = Vec3::new(15.0 * met_s, aside_m[0], z_m + aside_m[1]);
            let radius_m = random.within(15.0, 40.0);
            let volume = if random.chance(0.5) {
                ProtectedVolume::Sphere { radius_m }
            } else {
                ProtectedVolume::Cylinder {
                    radius_m,
                    half_height_m: random.within(10.0, 20.0),
                }
            };
            let from_m = met_m - velocity_mps * met_s;
            let uncertainty = if random.chance(0.3) {
                Uncertainty {
                    position_m: random.within(0.0, 4.0),
                    velocity_mps: random.within(0.0, 0.5),
                }
            } else {
                Uncertainty::default()
            };
            Obstacle {
                uncertainty,
                ..Obstacle::straight(id, from_m, velocity_mps, volume)
            }
        })
        .collect()
}

/// A flight among one to three obstacles that keep their velocity, between altitudes near the leg: how many decisions said certified,
/// and how many leaving.
fn judge(random: &mut Random, lag_s: f64, drift_mps: f64) -> (u32, u32) {
    let vehicle = if lag_s > 0.0 {
        Vehicle::lagged(lag_s)
    } else {
        Vehicle::table_4()
    };
    let settings = Settings {
        drift_mps,
        ..Settings::default()
    };
    let mut avoider = Avoider::new(settings, vehicle).unwrap();
    let flyer = Flyer::new(&vehicle);
    let z_m = 100.0;
    let limits_m = (
        z_m - random.within(0.5, 12.0),
        z_m + random.within(0.5, 12.0),
    );
    let waypoints_m = [Vec3::Z * z_m, Vec3::new(3000.0, 0.0, z_m)];
    let mission = Mission {
        limits_m,
        ..Mission::new(&waypoints_m)
    };
    let obstacles = drawn_obstacles(random, z_m);
    let mut state = MotionState {
        position_m: waypoints_m[0],
        ..MotionState::ahead(0.0)
    };
    let (mut path, mut certified, mut leaving) = (FlightPath::new(), 0, 0);
    for step in 0..300 {
        let time_s = PERIOD_S * f64::from(step);
        let now: Vec<Obstacle> = obstacles
            .iter()
            .map(|row| Obstacle {
                position_m: row.position_after_m(time_s),
                ..*row
            })
            .collect();
        let ownship = Ownship {
            position_m: state.position_m,
            course_rad: state.course_rad,
            climb_rad: state.climb_rad,
            bank_rad: state.bank_rad,
            airspeed_mps: 15.0,
        };
        let decision = avoider.step(&Situation {
            time_s,
            ownship,
            obstacles: Obstacles::Rows(&now),
            mission,
            wind_mps: Vec3::ZERO,
        });
        // Of volumes of their full size the aircraft is out, or the word is another one.
        let widened: Vec<Hazard> = (now.iter())
            .map(|row| Hazard::new(row, Vec3::ZERO, settings.confidence_sigmas))
            .collect();
        let is_out = widened
            .iter()
            .all(|row| row.margin_m(state.position_m, 0.0) >= 0.0);
        match decision.command.proof() {
            Some(Proof::Certified(_)) => {
                let bound = decision.command.certified().unwrap();
                assert!(is_out, "{step}: certified inside of a volume");
                let terms = Terms::new(bound.horizon_s, bound.target_m, bound.target_m).unwrap();
                let mut again = Command::from(*decision.command);
                let found = again.prove(
                    (&flyer, &mut path),
                    &state,
                    &Assumptions::only(&widened),
                    &terms,
                    &Meter::unlimited(),
                );
                assert!(found.is_ok(), "{step}: {bound:?}, and {found:?}");
                certified += 1;
            }
            Some(Proof::Leaving(_)) => leaving += 1,
            None => {}
        }
        path.predict(&flyer, &state, &decision.command, 1.0);
        state = path.state_at(&flyer, PERIOD_S).unwrap();
        state.time_s = 0.0;
    }
    (certified, leaving)
}

/// An earlier version levelled a command off at an altitude limit after its proof, and called certified what was shrunk because the
/// aircraft was inside.
#[test]
fn a_certified_command_keeps_its_target_from_volumes_of_their_full_size() {
    let (mut certified, mut leaving) = (0, 0);
    for (lag_s, drift_mps) in [(0.0, 0.0), (0.0, 1.0), (0.6, 0.0), (0.6, 1.0)] {
        for case in 0..200 {
            let counts = judge(&mut Random(case), lag_s, drift_mps);
            certified += counts.0;
            leaving += counts.1;
        }
    }
    assert!(
        certified > 100_000 && leaving > 100,
        "{certified}, {leaving}"
    );
}

/// What proves a turn against an obstacle behind it, with one thing changed.
fn proves(share: f64, horizon_s: f64, hazard: &Hazard) -> bool {
    let mut turn = Maneuver::hold();
    turn.push(Stage {
        rate_share: share,
        ..Stage::turn(0.0, 3.0, 0.0)
    });
    let flyer = Flyer::new(&Vehicle::table_4());
    let (start, mut path) = (MotionState::ahead(0.0), FlightPath::new());
    Terms::new(horizon_s, 0.05, 10.0).is_some_and(|terms| {
        let all = Assumptions::only(core::slice::from_ref(hazard));
        let flight = (&flyer, &mut path);
        Command::from(turn)
            .prove(flight, &start, &all, &terms, &Meter::unlimited())
            .is_ok()
    })
}

#[test]
fn what_is_out_of_range_proves_nothing() {
    let volume = ProtectedVolume::Sphere { radius_m: 50.0 };
    let behind = |at_m: Vec3| Hazard::exact(1, at_m, Vec3::ZERO, volume);
    let clear = behind(Vec3::X * 300.0);
    assert!(proves(1.0, 60.0, &clear));
    for share in [0.0, -1.0, 5.0, f64::NAN, f64::INFINITY] {
        assert!(!proves(share, 60.0, &clear), "share {share}");
    }
    for horizon_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(!proves(1.0, horizon_s, &clear), "horizon {horizon_s}");
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(!proves(1.0, 60.0, &behind(Vec3::new(bad, 0.0, 0.0))));
        assert!(!proves(1.0, 60.0, &behind(Vec3::new(0.0, 0.0, bad))));
        let mut row = Obstacle::straight(1, Vec3::X * 300.0, Vec3::ZERO, volume);
        row.velocity_mps.y = bad;
        assert!(!proves(1.0, 60.0, &Hazard::new(&row, Vec3::ZERO, 3.0)));
        assert!(!proves(1.0, 60.0, &clear.growing(bad)), "growth {bad}");
    }
    assert!(!proves(1.0, 60.0, &clear.growing(-1.0)));
    // What is to compare by proves nothing, however far it is.
    assert!(!proves(1.0, 60.0, &Hazard::compared(1, *clear)));
    // From inside a volume nothing is certified.
    let near = Obstacle::straight(1, Vec3::X * 40.0, Vec3::ZERO, volume);
    let seen = Hazard::seen(&near, &Viewpoint::default(), f64::INFINITY);
    let (flyer, mut path) = (Flyer::new(&Vehicle::table_4()), FlightPath::new());
    let mut away = Command::from(Maneuver::turn(0.0, 3.0, 0.0));
    let terms = Terms::new(60.0, 0.0, 0.0).unwrap();
    let all = Assumptions::only(core::slice::from_ref(&seen));
    let start = MotionState {
        course_rad: 3.0,
        ..MotionState::ahead(0.0)
    };
    let proof = away.prove(
        (&flyer, &mut path),
        &start,
        &all,
        &terms,
        &Meter::unlimited(),
    );
    assert!(matches!(proof, Ok(Proof::Leaving(_))), "{proof:?}");
    assert!(away.certified().is_none() && away.proof().is_some());
    // Whoever edits it loses the proof.
    away.edit().limit_climbs(0.0, 0.0);
    assert!(away.proof().is_none());
}
