//! Small manoeuvres about a wide volume: a climb while a large turn remains in reserve.

use fga::Vec3;
use fga::avoider::State;
use fga::situation::{Obstacle, ProtectedVolume};

use crate::aircraft::{crewed, light_aircraft};
use crate::flight::PERIOD_S;

/// Well clear by ASTM F3442, metres.
const RADIUS_M: f64 = 609.6;
const HALF_HEIGHT_M: f64 = 76.2;

fn head_on() -> Obstacle {
    Obstacle {
        volume: ProtectedVolume::Cylinder {
            radius_m: RADIUS_M,
            half_height_m: HALF_HEIGHT_M,
        },
        ..crewed(Vec3::new(9000.0, 40.0, 0.0), Vec3::new(-52.0, 0.0, 0.0))
    }
}

struct Flown {
    /// Least signed distance outside of the volume, metres.
    least_m: f64,
    /// Largest distance from the mission, sideways, metres.
    cross_m: f64,
    states: Vec<State>,
}

/// Flies past an intruder. With `follows`, a delay in seconds and a turn rate in rad/s, the intruder follows the aircraft:
/// that long after the manoeuvre begins it climbs or sinks with the aircraft, by 2.5 m/s at most, and turns towards it.
fn flown(follows: Option<(f64, f64)>) -> Flown {
    let mut flight = light_aircraft();
    let mut intruder = head_on();
    let mut begun_s = None;
    let (mut least_m, mut cross_m) = (f64::INFINITY, 0.0_f64);
    let mut states = Vec::new();
    for _ in 0..3000 {
        if let Some((after_s, rate_radps)) = follows
            && begun_s.is_some_and(|begun_s| flight.time_s >= begun_s + after_s)
        {
            let away_m = flight.own.position_m - intruder.position_m;
            let v = intruder.velocity_mps;
            let towards = (v.x * away_m.y - v.y * away_m.x).signum();
            let turned_rad = v.y.atan2(-v.x).abs();
            let rate_radps = if turned_rad < 0.5 {
                towards * rate_radps
            } else {
                0.0
            };
            let (sin, cos) = (rate_radps * PERIOD_S).sin_cos();
            intruder.velocity_mps = Vec3::new(
                cos * v.x - sin * v.y,
                sin * v.x + cos * v.y,
                away_m.z.clamp(-2.5, 2.5),
            );
        }
        let mut rows = [intruder];
        let decision = flight.cycle(&mut rows);
        intruder = rows[0];
        if decision.state == State::Avoiding {
            begun_s.get_or_insert(flight.time_s);
        }
        states.push(decision.state);
        let offset_m = flight.own.position_m - intruder.position_m;
        let beside_m = offset_m.x.hypot(offset_m.y) - RADIUS_M;
        least_m = least_m.min(beside_m.max(offset_m.z.abs() - HALF_HEIGHT_M));
        cross_m = cross_m.max(flight.own.position_m.y.abs());
    }
    states.dedup();
    Flown {
        least_m,
        cross_m,
        states,
    }
}

#[test]
fn a_climb_in_time_departs_less_than_the_volume_is_wide() {
    let flown = flown(None);
    assert!(flown.least_m >= 0.0, "{}", flown.least_m);
    assert!(flown.cross_m < 0.5 * RADIUS_M, "{}", flown.cross_m);
    let avoiding = flown.states.iter().filter(|s| **s == State::Avoiding);
    assert_eq!(avoiding.count(), 1, "{:?}", flown.states);
    assert_eq!(flown.states.last(), Some(&State::Cruise));
}

#[test]
fn an_intruder_that_follows_a_small_manoeuvre_is_avoided_by_a_large_one() {
    let mut large = 0;
    for after_s in [0.0, 2.0, 5.0, 8.0, 12.0, 16.0] {
        for rate_radps in [0.0, 0.02, 0.05] {
            let flown = flown(Some((after_s, rate_radps)));
            assert!(
                flown.least_m >= 0.0,
                "{after_s} s, {rate_radps} rad/s: {} m",
                flown.least_m
            );
            large += u32::from(flown.cross_m > 0.5 * RADIUS_M);
        }
    }
    assert!(large > 0);
}

/// A recorded path: straight on for 20 s, then a turn to the left, 40 corners of 4°, one each 0.7 s.
fn recorded_turn() -> Vec<Vec3> {
    let mut points_m = vec![Vec3::ZERO];
    let mut place_m = Vec3::X * 1000.0;
    for corner in 1..=40 {
        points_m.push(place_m);
        let (sin, cos) = (f64::from(corner) * 4.0_f64.to_radians()).sin_cos();
        place_m += Vec3::new(cos, sin, 0.0) * 36.0;
    }
    let last_m = place_m - points_m[40];
    points_m.push(place_m + last_m * 500.0);
    points_m
}

/// An earlier version predicted 18 stages of a mission, took the flight for straight after them, and avoided what the mission
/// itself turns away from.
#[test]
fn a_mission_that_turns_away_at_many_corners_is_flown_past_an_aircraft() {
    for (x_m, y_m) in [(4250.0, 600.0), (4500.0, 900.0)] {
        let mut flight = light_aircraft();
        flight.waypoints_m = recorded_turn();
        let mut rows = [Obstacle {
            position_m: Vec3::new(x_m, y_m, 0.0),
            ..head_on()
        }];
        for _ in 0..1000 {
            let decision = flight.cycle(&mut rows);
            assert_ne!(decision.state, State::Avoiding, "{}", flight.time_s);
            let offset_m = flight.own.position_m - rows[0].position_m;
            assert!(offset_m.x.hypot(offset_m.y) > RADIUS_M);
        }
    }
}
