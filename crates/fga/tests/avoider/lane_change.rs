//! Lane changes: out and back to the mission's direction, where a single turn leads far away.

use fga::Vec3;
use fga::avoider::{Start, State};
use fga::situation::Obstacle;
use fga::vehicle::Vehicle;

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
    assert!(aside_m < 1.1 * RADIUS_M, "{aside_m}");
}
