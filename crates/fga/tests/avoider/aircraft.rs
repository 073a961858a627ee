//! Aircraft as obstacles: waiting, withstanding, keeping, and extrapolating a missing one.

use fga::Vec3;
use fga::avoider::{Avoider, Settings, State};
use fga::situation::{Movement, Obstacle, ProtectedVolume};
use fga::vehicle::{Response, Vehicle};

use crate::flight::{Flight, PERIOD_S, sphere, vehicle};

const VOLUME: (f64, f64) = (152.4, 30.48);

/// A light aircraft: 50 m/s, 30 degrees of bank.
fn light_aircraft() -> Flight {
    let vehicle = Vehicle {
        airspeed_mps: 50.0,
        turn_radius_m: 441.6,
        climb_min_rad: -5.0_f64.to_radians(),
        climb_max_rad: 3.5_f64.to_radians(),
        climb_rate_radps: 0.05,
        response: Response::default(),
    };
    let settings = Settings {
        surveillance_radius_m: 15e3,
        ..Settings::default()
    };
    Flight::of(Avoider::new(settings, vehicle).unwrap(), vehicle)
}

fn crewed(position_m: Vec3, velocity_mps: Vec3) -> Obstacle {
    let volume = ProtectedVolume::Cylinder {
        radius_m: VOLUME.0,
        half_height_m: VOLUME.1,
    };
    Obstacle {
        movement: Movement::CREWED,
        ..Obstacle::new(1, position_m, velocity_mps, volume)
    }
}

/// Least signed distance outside of the NMAC cylinder, and the states, while the intruder turns at a
/// rate from a moment on, for ten seconds.
fn flown(mut intruder: Obstacle, turn: Option<(f64, f64)>) -> (f64, Vec<State>, Option<f64>) {
    let mut flight = light_aircraft();
    let (mut least_m, mut resilience) = (f64::INFINITY, None);
    let mut states = Vec::new();
    for _ in 0..1500 {
        if let Some((from_s, rate_radps)) = turn
            && (from_s..from_s + 10.0).contains(&flight.time_s)
        {
            let (sin, cos) = (rate_radps * PERIOD_S).sin_cos();
            let v = intruder.velocity_mps;
            intruder.velocity_mps = Vec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z);
        }
        let mut rows = [intruder];
        let decision = flight.cycle(&mut rows);
        intruder = rows[0];
        if decision.state == State::Avoiding && resilience.is_none() {
            resilience = decision.record.resilience;
        }
        states.push(decision.state);
        let offset = flight.own.position_m - intruder.position_m;
        let beside_m = offset.x.hypot(offset.y) - VOLUME.0;
        least_m = least_m.min(beside_m.max(offset.z.abs() - VOLUME.1));
    }
    states.dedup();
    (least_m, states, resilience)
}

#[test]
fn an_aircraft_that_may_turn_is_avoided_with_half_of_its_bounds_in_hand_and_once() {
    let intruder = crewed(Vec3::new(6000.0, 800.0, 0.0), Vec3::new(-52.0, -13.0, 0.0));
    let (least_m, states, resilience) = flown(intruder, None);
    assert!(least_m > 0.0, "{least_m}");
    assert!(
        resilience.is_some_and(|share| share >= 0.5),
        "{resilience:?}"
    );
    let avoiding = states.iter().filter(|s| **s == State::Avoiding).count();
    assert_eq!(avoiding, 1, "{states:?}");
    assert_eq!(states.last(), Some(&State::Cruise), "{states:?}");
}

/// An intruder that turns towards a plan past a straight line.
#[test]
fn an_aircraft_that_turns_at_the_standard_rate_at_any_moment_is_avoided() {
    for side in [-1.0, 1.0] {
        for from_s in [20.0, 30.0, 38.0, 44.0, 50.0] {
            let intruder = crewed(Vec3::new(6000.0, 800.0, 0.0), Vec3::new(-52.0, -13.0, 0.0));
            let turn = (from_s, side * 3.0_f64.to_radians());
            let (least_m, states, _) = flown(intruder, Some(turn));
            assert!(least_m > 0.0, "{turn:?}: {least_m} {states:?}");
            assert!(states.len() < 12, "{turn:?}: {states:?}");
        }
    }
}

#[test]
fn an_aircraft_that_passes_clear_in_every_motion_is_let_pass() {
    let intruder = crewed(Vec3::new(6000.0, 2500.0, 0.0), Vec3::new(-55.0, 0.0, 0.0));
    let (_, states, _) = flown(intruder, None);
    assert_eq!(states, [State::Cruise]);
}

/// An earlier version forgot and found in turn an obstacle whose every second report is missing.
#[test]
fn reports_that_are_missing_cost_nothing() {
    let avoider = Avoider::new(Settings::default(), vehicle()).unwrap();
    let mut flight = Flight::of(avoider, vehicle());
    let mut rows = [sphere(
        1,
        Vec3::new(280.0, 5.0, 0.0),
        Vec3::new(-15.0, 0.0, 0.0),
        30.0,
    )];
    let mut least_m = f64::INFINITY;
    for step in 0..400_u32 {
        // Every third report arrives, and none for a second in between.
        let heard = step.is_multiple_of(3) && !(60..70).contains(&step);
        if heard {
            flight.cycle(&mut rows);
        } else {
            flight.cycle(&mut []);
            rows[0].position_m = rows[0].position_after_m(PERIOD_S);
        }
        least_m = least_m.min(flight.own.position_m.distance(rows[0].position_m));
    }
    assert!(least_m >= 30.0, "{least_m}");
}
