//! Zones: no manoeuvre enters one, none begins because of one, and a manoeuvre inside leads out.

use fga::avoider::{Reason, Settings, Start, State};
use fga::situation::{Movement, Obstacle};
use fga::zone::{ALL_HEIGHTS_M, Outline, Zone};
use fga::{Vec2, Vec3};

use crate::flight::{Flight, planar, sphere, vehicle};
use crate::policies::{avoider, settings};

const IN: bool = true;
const OUT: bool = false;

/// Zones that last as long as the tests.
fn polygon(keep_in: bool, corners: &[[f64; 2]], heights_m: (f64, f64)) -> Zone<'static> {
    let corners: Vec<Vec2> = corners.iter().map(|at| Vec2::from_array(*at)).collect();
    Zone {
        keep_in,
        outline: Outline::Polygon(corners.leak()),
        heights_m,
    }
}

fn box_of([west, east, south, north]: [f64; 4], keep_in: bool) -> Zone<'static> {
    polygon(
        keep_in,
        &[[west, south], [east, south], [east, north], [west, north]],
        ALL_HEIGHTS_M,
    )
}

fn flight(zones: &[Zone<'static>]) -> Flight {
    Flight {
        zones: zones.to_vec(),
        ..avoider(settings(Start::AtDetection), planar())
    }
}

/// A little to the left of the line: the cheapest way round is on the right.
fn standing() -> Vec<Obstacle> {
    vec![sphere(7, Vec3::new(200.0, 5.0, 0.0), Vec3::ZERO, 30.0)]
}

/// The most and the least offset from the line until the aircraft is back, all certified.
fn offsets(flight: &mut Flight, obstacles: &mut [Obstacle]) -> (f64, f64) {
    let (mut least_m, mut most_m) = (0.0_f64, 0.0_f64);
    for _ in 0..400 {
        let decision = flight.cycle(obstacles);
        let reason = decision.record.reason;
        assert!(
            !reason.is_unproven(),
            "{reason:?} at {}",
            flight.own.position_m
        );
        least_m = least_m.min(flight.own.position_m.y);
        most_m = most_m.max(flight.own.position_m.y);
    }
    assert!(
        flight.own.position_m.y.abs() < 1.0,
        "{}",
        flight.own.position_m
    );
    (least_m, most_m)
}

#[test]
fn a_manoeuvre_keeps_out_of_a_zone() {
    let (least_m, _) = offsets(&mut flight(&[]), &mut standing());
    assert!(least_m < -20.0, "{least_m}");
    let village = box_of([0.0, 400.0, -300.0, -10.0], OUT);
    let (least_m, most_m) = offsets(&mut flight(&[village]), &mut standing());
    assert!(least_m > -10.0 && most_m > 30.0, "{least_m} {most_m}");
}

#[test]
fn a_manoeuvre_stays_within_a_zone() {
    let corridor = box_of([-100.0, 2e5, -10.0, 60.0], IN);
    let (least_m, most_m) = offsets(&mut flight(&[corridor]), &mut standing());
    assert!(
        least_m > -10.0 && (30.0..60.0).contains(&most_m),
        "{least_m} {most_m}"
    );
}

/// One that the leg left 14 km ahead bound nothing on it.
#[test]
fn a_zone_that_the_leg_leaves_far_ahead_binds_here() {
    let corridor = box_of([-100.0, 2000.0, -10.0, 60.0], IN);
    let (least_m, _) = offsets(&mut flight(&[corridor]), &mut standing());
    assert!(least_m > -10.0, "{least_m}");
}

#[test]
fn above_a_zone_a_manoeuvre_is_free() {
    let corners = [[0.0, -300.0], [400.0, -300.0], [400.0, -10.0], [0.0, -10.0]];
    let low = polygon(OUT, &corners, (-200.0, -20.0));
    let (least_m, _) = offsets(&mut flight(&[low]), &mut standing());
    let (free_m, _) = offsets(&mut flight(&[]), &mut standing());
    assert_eq!(least_m, free_m);
}

#[test]
fn a_manoeuvre_that_may_climb_keeps_to_the_heights() {
    let (west, east) = (-500.0, 2e5);
    let corners = [[west, -500.0], [east, -500.0], [east, 500.0], [west, 500.0]];
    let layer = polygon(IN, &corners, (-12.0, 8.0));
    let mut flight = Flight {
        zones: vec![layer],
        ..avoider(settings(Start::Free), vehicle())
    };
    let mut obstacles = standing();
    for _ in 0..400 {
        assert!(!flight.cycle(&mut obstacles).record.reason.is_unproven());
        assert!(
            (-12.0..=8.0).contains(&flight.own.position_m.z),
            "{}",
            flight.own.position_m
        );
    }
}

#[test]
fn among_aircraft_that_may_turn_zones_bind_as_well() {
    let oncoming = || {
        vec![Obstacle {
            movement: Movement::CREWED,
            ..sphere(7, Vec3::new(700.0, 5.0, 0.0), Vec3::X * -20.0, 30.0)
        }]
    };
    let (least_m, most_m) = offsets(&mut flight(&[]), &mut oncoming());
    let side = if -least_m > most_m { -1.0 } else { 1.0 };
    let [south, north] = if side < 0.0 {
        [-400.0, -10.0]
    } else {
        [10.0, 400.0]
    };
    let beside = box_of([-200.0, 1500.0, south, north], OUT);
    let (least_m, most_m) = offsets(&mut flight(&[beside]), &mut oncoming());
    assert!(
        (side * least_m).max(side * most_m) < 10.0,
        "{least_m} {most_m}"
    );
}

#[test]
fn a_zone_alone_is_no_reason_to_manoeuvre() {
    let corridor = box_of([-100.0, 2e5, -3.0, 3.0], IN);
    let wall = box_of([300.0, 320.0, 4.0, 200.0], OUT);
    let mut flight = flight(&[corridor, wall]);
    for _ in 0..400 {
        let decision = flight.cycle(&mut []);
        assert_eq!(
            (decision.state, decision.record.reason),
            (State::Cruise, Reason::Clear)
        );
    }
    assert_eq!(flight.own.position_m.y, 0.0);
}

/// Without an allowance for what the mission itself does, nothing on the leg would keep the margin.
#[test]
fn a_mission_nearer_to_a_zone_than_the_margin_is_left_and_taken_up_again() {
    let margin = Settings {
        margin_m: 6.0,
        ..settings(Start::AtDetection)
    };
    let wall = box_of([-500.0, 2e5, -200.0, -2.0], OUT);
    let mut flight = Flight {
        zones: vec![wall],
        ..avoider(margin, planar())
    };
    let (least_m, most_m) = offsets(&mut flight, &mut standing());
    assert!(least_m > -2.0 && most_m > 36.0, "{least_m} {most_m}");
}

#[test]
fn a_zone_that_the_leg_itself_enters_does_not_bind() {
    let across = box_of([100.0, 300.0, -300.0, 300.0], OUT);
    let short = box_of([-100.0, 150.0, -300.0, 300.0], IN);
    let (mut bound, mut free) = (flight(&[across, short]), flight(&[]));
    let (mut one, mut other) = (standing(), standing());
    for _ in 0..400 {
        let decisions = (bound.cycle(&mut one), free.cycle(&mut other));
        assert_eq!(*decisions.0.command, *decisions.1.command);
    }
}

/// It was flown round as a threat until the corner.
#[test]
fn a_zone_that_the_next_leg_soon_enters_does_not_bind() {
    let beyond = box_of([20.0, 300.0, -300.0, -8.0], OUT);
    let (mut bound, mut free) = (flight(&[beyond]), flight(&[]));
    for flight in [&mut bound, &mut free] {
        flight.waypoints_m = [[0.0, 0.0], [150.0, 0.0], [150.0, -900.0]]
            .map(|[x, y]| Vec3::new(x, y, 0.0))
            .to_vec();
    }
    let obstacle = sphere(7, Vec3::new(80.0, 5.0, 0.0), Vec3::ZERO, 20.0);
    let (mut one, mut other) = (vec![obstacle], vec![obstacle]);
    for _ in 0..300 {
        let decisions = (bound.cycle(&mut one), free.cycle(&mut other));
        assert_eq!(*decisions.0.command, *decisions.1.command);
    }
}

/// At its end it was led back into the fence, and flew on for ever.
#[test]
fn a_mission_that_ends_outside_is_flown_to_its_end() {
    let short = box_of([-100.0, 150.0, -300.0, 300.0], IN);
    let (mut bound, mut free) = (flight(&[short]), flight(&[]));
    for flight in [&mut bound, &mut free] {
        flight.waypoints_m = vec![Vec3::ZERO, Vec3::X * 250.0];
    }
    for _ in 0..300 {
        let decisions = (bound.cycle(&mut []), free.cycle(&mut []));
        assert_eq!(*decisions.0.command, *decisions.1.command);
    }
}

/// On both sides of the mission, and outside of a fence.
#[test]
fn a_start_on_the_wrong_side_begins_nothing() {
    let zones = [
        box_of([-300.0, 2000.0, -80.0, 400.0], OUT),
        box_of([-300.0, 2000.0, 60.0, 400.0], IN),
    ];
    for (zone, y) in zones.into_iter().zip([-200.0, 150.0]) {
        let (mut bound, mut free) = (flight(&[zone]), flight(&[]));
        for flight in [&mut bound, &mut free] {
            flight.waypoints_m = vec![Vec3::new(0.0, y, 0.0), Vec3::new(1e5, y, 0.0)];
        }
        for _ in 0..300 {
            let decisions = (bound.cycle(&mut []), free.cycle(&mut []));
            assert_eq!(*decisions.0.command, *decisions.1.command);
            assert_eq!(decisions.0.record.reason, decisions.1.record.reason);
        }
        assert!(!zone.is_entered(bound.own.position_m));
    }
}

/// The mission leads out to the right, and an obstacle stands there: without the zone the way round leads farther in.
#[test]
fn a_manoeuvre_inside_leads_out_the_nearest_way() {
    let zone = box_of([-300.0, 2000.0, -80.0, 400.0], OUT);
    let mut flight = flight(&[zone]);
    flight.waypoints_m = vec![Vec3::new(0.0, -200.0, 0.0), Vec3::new(1e5, -200.0, 0.0)];
    let mut obstacles = vec![sphere(7, Vec3::new(60.0, -90.0, 0.0), Vec3::ZERO, 30.0)];
    let mut has_avoided = false;
    for _ in 0..300 {
        let decision = flight.cycle(&mut obstacles);
        let is_in = zone.is_entered(flight.own.position_m);
        has_avoided |= is_in && decision.state == State::Avoiding;
        assert!(!decision.record.reason.is_unproven() || is_in);
        assert!(!is_in || flight.time_s < 20.0, "{}", flight.own.position_m);
    }
    assert!(has_avoided);
}

/// There is no room for what leads out of the third zone.
#[test]
fn among_many_obstacles_nothing_is_proven_inside_of_many_zones() {
    let zones = [400.0, 420.0, 440.0].map(|y| box_of([-300.0, 2000.0, -80.0, y], OUT));
    let mut flight = flight(&zones);
    flight.waypoints_m = vec![Vec3::new(0.0, -200.0, 0.0), Vec3::new(1e5, -200.0, 0.0)];
    let ahead = sphere(126, Vec3::new(60.0, -90.0, 0.0), Vec3::ZERO, 30.0);
    let masts = (0..125).map(|id| {
        let beside_m = Vec3::new(f64::from(id), 200.0, 0.0);
        sphere(id, beside_m, Vec3::ZERO, 1.0)
    });
    let mut obstacles: Vec<Obstacle> = masts.chain([ahead]).collect();
    for _ in 0..60 {
        let is_in = zones[0].is_entered(flight.own.position_m);
        let decision = flight.cycle(&mut obstacles);
        assert!(!is_in || decision.command.proof().is_none());
    }
}

/// The last leg descends, the fence stands beyond its end: the flight past the last waypoint was a threat.
#[test]
fn a_fence_beyond_the_end_begins_nothing() {
    let fence = box_of([-500.0, 1050.0, -500.0, 500.0], IN);
    for wind_mps in [Vec3::ZERO, Vec3::Y, Vec3::new(3.0, -9.0, 0.0)] {
        let (mut bound, mut free) = (flight(&[fence]), flight(&[]));
        for flight in [&mut bound, &mut free] {
            flight.waypoints_m = vec![Vec3::Z * 100.0, Vec3::new(1000.0, 0.0, 40.0)];
            flight.own.position_m.z = 100.0;
            flight.wind_mps = wind_mps;
        }
        for _ in 0..900 {
            let decisions = (bound.cycle(&mut []), free.cycle(&mut []));
            assert_eq!(*decisions.0.command, *decisions.1.command);
            assert_eq!(decisions.0.state, State::Cruise);
        }
        let off_m = bound.own.position_m.y;
        assert!(
            off_m.abs() < 1.0,
            "past the end it holds its track: {off_m}"
        );
    }
}
