//! Limits in need: used only if nothing is certified with the normal ones.

use fga::Vec3;
use fga::avoider::{Avoider, Decision, Reason, Settings};
use fga::vehicle::Vehicle;

use crate::flight::{Flight, planar, sphere};

/// A turn of 30 m clears a sphere of 40 m from √(70² − 30²) = 63.2 m on, one of 18 m from 55.1 m on.
const RADIUS_M: f64 = 40.0;

fn decision_at(distance_m: f64, in_need: Option<Vehicle>) -> Decision {
    let mut avoider = Avoider::new(Settings::default(), planar()).unwrap();
    avoider.set_vehicle_in_need(in_need).unwrap();
    let place_m = Vec3::new(distance_m, 0.0, 0.0);
    Flight::of(avoider, planar()).decide(&[sphere(1, place_m, Vec3::ZERO, RADIUS_M)])
}

fn steep() -> Vehicle {
    Vehicle {
        turn_radius_m: 18.0,
        ..planar()
    }
}

#[test]
fn the_limits_in_need_are_used_only_where_the_normal_ones_certify_nothing() {
    let margin_m = |decision: &Decision| decision.record.chosen.unwrap().margin_m;
    let normal = decision_at(64.0, Some(steep()));
    assert!(!normal.record.in_need && !normal.record.reason.is_unproven());
    let without = decision_at(59.0, None);
    assert_eq!(without.record.reason, Reason::BestAvailable);
    let saved = decision_at(59.0, Some(steep()));
    assert_eq!(saved.record.reason, Reason::ManeuverChosen);
    assert!(saved.record.in_need && margin_m(&saved) >= 0.05);
    assert!(saved.record.work.work <= Settings::default().work_limit);
    // Hopeless with both: the steep one comes less near.
    let lost = decision_at(50.0, Some(steep()));
    assert_eq!(lost.record.reason, Reason::BestAvailable);
    assert!(lost.record.in_need);
    assert!(margin_m(&lost) > margin_m(&decision_at(50.0, None)) + 1.0);
}

#[test]
fn limits_in_need_that_cannot_be_flown_are_refused() {
    let mut avoider = Avoider::new(Settings::default(), planar()).unwrap();
    let bad = Vehicle {
        turn_radius_m: f64::NAN,
        ..planar()
    };
    assert!(avoider.set_vehicle_in_need(Some(bad)).is_err());
    assert_eq!(avoider.vehicle_in_need(), None);
}

#[test]
fn a_lost_maneuver_is_weighed_anew_once_a_second_and_where_an_obstacle_turns() {
    let avoider = Avoider::new(Settings::default(), planar()).unwrap();
    let mut flight = Flight::of(avoider, planar());
    let mut obstacles = [sphere(1, Vec3::X * 52.0, Vec3::ZERO, RADIUS_M)];
    let mut next = |obstacles: &mut [_]| {
        let record = flight.cycle(obstacles).record;
        assert_eq!(record.reason, Reason::BestAvailable);
        (record.chosen.unwrap().margin_m, record.work.work)
    };
    let (lost_m, searched) = next(&mut obstacles);
    // Reading the obstacle and looking for a way back is left.
    let later: Vec<_> = (0..5).map(|_| next(&mut obstacles)).collect();
    assert!(later.iter().all(|(margin_m, _)| *margin_m == lost_m));
    assert!(later.iter().skip(1).all(|(_, work)| *work < searched / 10));
    obstacles[0].velocity_mps = Vec3::Y * 0.1;
    let works = [(); 3].map(|()| next(&mut obstacles).1);
    assert!(works[0] > searched / 2 && works[1] < searched / 10 && works[2] < searched / 10);
    obstacles[0].position_m.x += 3.0;
    let weighed = (0..10).map(|_| next(&mut obstacles));
    let weighed: Vec<_> = weighed.filter(|(_, work)| *work > searched / 2).collect();
    assert_eq!(weighed.len(), 1);
    assert!(weighed[0].0 > lost_m + 1.0);
}
