//! Lane changes: out and back to the mission's direction, where a single turn leads far away.

use fga::Vec3;
use fga::avoider::{Decision, Start, State};
use fga::prediction::{FlightPath, MotionState};
use fga::situation::Obstacle;
use fga::vehicle::{Response, Vehicle};

use crate::flight::{planar, sphere, vehicle};
use crate::policies::{avoider, settings};

const RADIUS_M: f64 = 30.0;

/// Flies 60 s; gives the largest distance from the mission and the least one from an obstacle's centre, metres.
fn fly(vehicle: Vehicle, obstacles: &mut [Obstacle]) -> (f64, f64) {
    let mut flight = avoider(settings(Start::Free), vehicle);
    let (mut aside_m, mut least_m) = (0.0_f64, f64::INFINITY);
    let mut state = State::Cruise;
    for _ in 0..600 {
        state = flight.cycle(obstacles).state;
        let own_m = flight.own.position_m;
        aside_m = aside_m.max(own_m.y.hypot(own_m.z));
        for obstacle in &*obstacles {
            least_m = least_m.min((obstacle.position_m - own_m).length());
        }
    }
    assert_eq!(state, State::Cruise);
    (aside_m, least_m)
}

fn crossing((x, y): (f64, f64), (u, v): (f64, f64), id: u32) -> Obstacle {
    sphere(id, Vec3::new(x, y, 0.0), Vec3::new(u, v, 0.0), RADIUS_M)
}

#[test]
fn in_the_plane_two_turns_let_crossing_traffic_pass_ahead() {
    let mut obstacles = [crossing((-18.0, 299.0), (16.0, -21.0), 0)];
    let (aside_m, least_m) = fly(planar(), &mut obstacles);
    assert!(least_m >= RADIUS_M, "{least_m}");
    assert!(aside_m < 1.6 * RADIUS_M, "{aside_m}");
}

/// Traffic from the left, the right and ahead that meets the aircraft at a place of its mission.
fn junction(x_m: f64, first_id: u32) -> [Obstacle; 3] {
    let time_s = x_m / 15.0;
    [(3.0, -12.0), (-2.0, 10.0), (-12.0, 1.0)].map(|(u, v): (f64, f64)| {
        let id = if u > 0.0 {
            0
        } else if u > -5.0 {
            1
        } else {
            2
        };
        crossing((x_m - u * time_s, -v * time_s), (u, v), first_id + id)
    })
}

#[test]
fn a_climb_past_crossing_traffic_levels_off() {
    let (aside_m, least_m) = fly(vehicle(), &mut junction(200.0, 0));
    assert!(least_m >= RADIUS_M, "{least_m}");
    assert!(aside_m < 1.16 * RADIUS_M, "{aside_m}");
}

/// With bank lag the end of the last turn is looked at once more: as a part of both turns, not as a turn from the
/// mission.
#[test]
fn with_bank_lag_the_margin_is_that_of_both_turns() {
    let mut changes = 0;
    for (case, lag_s) in [0.3, 0.6, 0.9].into_iter().cycle().take(60).enumerate() {
        let part = case as f64 / 60.0;
        let vehicle = Vehicle {
            response: Response {
                bank_time_constant_s: lag_s,
                ..Response::default()
            },
            ..planar()
        };
        let mut flight = avoider(settings(Start::Free), vehicle);
        flight.own.bank_rad = 0.8 * part - 0.4;
        let meets_s = 7.0 + 10.0 * part;
        let (u, v) = (14.0 + 4.0 * part, -24.0 + 6.0 * part);
        let obstacle = crossing((15.0 * meets_s - u * meets_s, -v * meets_s), (u, v), 0);
        let Decision {
            command, record, ..
        } = flight.decide(&[obstacle]);
        let is_change = command.stages().len() == 2;
        let Some(chosen) = record.chosen else {
            continue;
        };
        if record.reason.is_unproven() || !is_change {
            continue;
        }
        changes += 1;
        let mut path = FlightPath::new();
        let start = MotionState::of(&flight.own);
        path.predict(&flight.flyer, &start, &command, 61.0);
        let least_m = (0..6000)
            .map(|step| 0.01 * f64::from(step))
            .map(|at_s| {
                let own_m = path.state_at(&flight.flyer, at_s).unwrap().position_m;
                (obstacle.position_after_m(at_s) - own_m).length() - RADIUS_M
            })
            .fold(f64::INFINITY, f64::min);
        assert!(
            chosen.margin_m <= least_m + 1e-3,
            "{case}: {} of {least_m}",
            chosen.margin_m
        );
    }
    assert!(changes > 10, "{changes}");
}
