//! Properties of every situation: symmetries, and finite commands from finite numbers.

use fga::Vec3;
use fga::avoider::{Candidate, Decision, Reason, Verdict};
use fga::situation::{Mission, Obstacles, Situation};
use fga::situation::{Obstacle, ProtectedVolume, Uncertainty};
use fga::vehicle::{Response, Vehicle};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use crate::flight::{Flies as _, sphere, vehicle};
use crate::policies::{POLICIES, Policy, SYMMETRIC};

/// Surveillance radius, metres.
const RADIUS_M: f64 = 300.0;

/// Threats at rest or flying, within sight and outside their volumes.
fn threats() -> impl Strategy<Value = Vec<Obstacle>> {
    let one = (
        80.0..280.0f64,
        -60.0..60.0f64,
        -40.0..40.0f64,
        -30.0..10.0f64,
        -10.0..10.0f64,
        prop_oneof![Just(20.0), Just(30.0), Just(45.0)],
    );
    prop::collection::vec(one, 1..4).prop_map(|rows| {
        rows.into_iter()
            .zip(0..)
            .map(|((x, y, z, vx, vy, radius_m), id)| {
                sphere(id, Vec3::new(x, y, z), Vec3::new(vx, vy, 0.0), radius_m)
            })
            .collect()
    })
}

/// The first decision in a situation under a map of positions and directions.
fn first(
    policy: Policy,
    obstacles: &[Obstacle],
    scale: f64,
    map: impl Fn(Vec3) -> Vec3,
) -> Decision {
    let vehicle = Vehicle {
        airspeed_mps: vehicle().airspeed_mps * scale,
        turn_radius_m: vehicle().turn_radius_m * scale,
        ..vehicle()
    };
    let mut flight = policy.flight(vehicle, scale, RADIUS_M);
    flight.own.course_rad = {
        let along = map(Vec3::X);
        along.y.atan2(along.x)
    };
    flight.waypoints_m = vec![Vec3::ZERO, map(Vec3::X * 1e4)];
    let seen: Vec<Obstacle> = obstacles
        .iter()
        .map(|o| Obstacle {
            position_m: map(o.position_m),
            velocity_mps: map(o.velocity_mps),
            volume: ProtectedVolume::Sphere {
                radius_m: o.volume.radius_m() * scale,
            },
            ..*o
        })
        .collect();
    flight.decide(&seen)
}

/// Whether two decisions agree up to the map: the certified single turns cost the same to within
/// `tolerance`. Of two-stage manoeuvres and of the best available ones the first success counts, so
/// only their existence must agree.
fn alike(
    policy: Policy,
    (one, other): (&Decision, &Decision),
    tolerance: f64,
) -> Result<(), TestCaseError> {
    prop_assert_eq!(one.state, other.state);
    prop_assert_eq!(one.record.reason, other.record.reason);
    let id = |d: &Decision| d.record.threat.map(|threat| threat.id);
    prop_assert_eq!(id(one), id(other));
    let is_single = |decision: &Decision, chosen: &Candidate| {
        decision.command.stages().len() == 1 && chosen.verdict == Verdict::Chosen
    };
    let exact = policy.weighs_exactly();
    match (one.record.chosen, other.record.chosen) {
        (Some(a), Some(b)) if exact || (is_single(one, &a) && is_single(other, &b)) => {
            let (a, b) = (a.cost, b.cost);
            prop_assert!((a - b).abs() < tolerance, "{a} against {b}");
        }
        (a, b) => prop_assert_eq!(a.is_some(), b.is_some()),
    }
    Ok(())
}

/// Finite numbers of every size, the awkward ones often.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -500.0..500.0f64,
        1 => prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO,
        1 => prop::sample::select(vec![0.0, -0.0, 1e15, -1e15, 1e-12, f64::MAX, f64::MIN, f64::MIN_POSITIVE]),
    ]
}

fn any_vector() -> impl Strategy<Value = Vec3> {
    [any_number(), any_number(), any_number()].prop_map(Vec3::from_array)
}

fn any_obstacle() -> impl Strategy<Value = Obstacle> {
    (
        any_vector(),
        any_vector(),
        any_number(),
        prop::option::of(any_number()),
        any_number(),
        any_number(),
    )
        .prop_map(|(position_m, velocity_mps, radius, half_height, sp, sv)| {
            let radius_m = radius.abs();
            let volume = match half_height {
                Some(half_height) => ProtectedVolume::Cylinder {
                    radius_m,
                    half_height_m: half_height.abs(),
                },
                None => ProtectedVolume::Sphere { radius_m },
            };
            Obstacle {
                uncertainty: Uncertainty {
                    position_m: sp.abs(),
                    velocity_mps: sv.abs(),
                },
                ..Obstacle::straight(1, position_m, velocity_mps, volume)
            }
        })
}

fn is_finite(decision: &Decision) -> bool {
    decision.command.stages().iter().all(|stage| {
        stage.start_s.is_finite()
            && stage.course_rad.is_finite()
            && stage.climb_rad.is_finite()
            && stage.rate_share.is_finite()
    })
}

/// If two manoeuvres are nearly as good, rounding may choose between them: the situations are the
/// same at every run, so that none of these appears by chance.
fn fixed() -> ProptestConfig {
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::with_cases(40)
    }
}

proptest! {
    #![proptest_config(fixed())]

    #[test]
    fn left_and_right_are_alike(obstacles in threats(), which in 0..SYMMETRIC.len()) {
        let policy = SYMMETRIC[which];
        let plain = first(policy, &obstacles, 1.0, |v| v);
        let mirrored = first(policy, &obstacles, 1.0, |v| Vec3::new(v.x, -v.y, v.z));
        alike(policy, (&plain, &mirrored), 1e-4)?;
    }

    #[test]
    fn every_direction_is_alike(
        obstacles in threats(), which in 0..SYMMETRIC.len(), turn in -3.1..3.1f64,
    ) {
        let policy = SYMMETRIC[which];
        let (sin, cos) = turn.sin_cos();
        let plain = first(policy, &obstacles, 1.0, |v| v);
        let turned = first(policy, &obstacles, 1.0, |v| {
            Vec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
        });
        alike(policy, (&plain, &turned), 0.01)?;
    }

    /// Twice the lengths and speeds in the same time is the same situation.
    #[test]
    fn every_size_is_alike(obstacles in threats(), which in 0..SYMMETRIC.len()) {
        let policy = SYMMETRIC[which];
        let plain = first(policy, &obstacles, 1.0, |v| v);
        let doubled = first(policy, &obstacles, 2.0, |v| v * 2.0);
        alike(policy, (&plain, &doubled), 0.01)?;
    }

}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn finite_numbers_give_finite_commands(
        obstacles in prop::collection::vec(any_obstacle(), 0..4),
        own in (any_vector(), any_number(), any_number(), any_number(), any_number()),
        waypoints_m in prop::collection::vec(any_vector(), 0..4),
        wind_mps in any_vector(),
        times in prop::collection::vec(any_number(), 1..6),
        which in 0..POLICIES.len(), sees_all: bool,
    ) {
        let radius_m = if sees_all { f64::INFINITY } else { RADIUS_M };
        let mut flight = POLICIES[which].flight(vehicle(), 1.0, radius_m);
        (flight.own.position_m, flight.own.course_rad, flight.own.climb_rad) = (own.0, own.1, own.2);
        (flight.own.bank_rad, flight.own.airspeed_mps) = (own.3, own.4.abs());
        for time_s in times {
            let decision = flight.pilot.step(&Situation {
                time_s,
                ownship: flight.own,
                obstacles: Obstacles::Rows(&obstacles),
                mission: Mission::new(&waypoints_m),
                wind_mps,
            });
            prop_assert!(is_finite(&decision), "{decision:?}");
        }
    }

    /// A plausible flight in a crowd of anything, closed loop, with every vehicle.
    #[test]
    fn a_flight_through_anything_stays_finite(
        obstacles in prop::collection::vec(any_obstacle(), 0..6),
        which in 0..POLICIES.len(), sees_all: bool,
        speed in 1.0..300.0f64, wider in 1.001..500.0f64, climb in 0.0..1.39f64,
        lag in prop_oneof![Just(0.0), 0.01..3.0f64],
    ) {
        // No turn of more than 10 g.
        let tightest_m = (speed * speed / 98.0).max(1.0);
        let vehicle = Vehicle {
            airspeed_mps: speed,
            turn_radius_m: tightest_m * wider,
            climb_min_rad: -climb,
            climb_max_rad: climb,
            climb_rate_radps: 0.2,
            response: Response { bank_time_constant_s: lag, ..Response::default() },
        };
        let radius_m = if sees_all { f64::INFINITY } else { RADIUS_M };
        let mut flight = POLICIES[which].flight(vehicle, 1.0, radius_m);
        let mut obstacles = obstacles;
        for _ in 0..10 {
            let decision = flight.cycle(&mut obstacles);
            prop_assert!(is_finite(&decision), "{decision:?}");
            prop_assert!(flight.own.position_m.is_finite());
            prop_assert!(decision.record.reason != Reason::InvalidInput);
        }
    }
}
