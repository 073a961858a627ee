//! Encounters in which the protected volume is lost: the flight keeps away from its middle.

use fga::Vec3;
use fga::avoider::{Settings, Start};
use fga::certificate::Hazard;
use fga::situation::{Movement, Obstacle, ProtectedVolume};
use fga::vehicle::Vehicle;

use crate::flight::planar;
use crate::policies::{avoider, settings};

/// The well-clear volume of ASTM F3442.
const WELL_CLEAR: ProtectedVolume = ProtectedVolume::Cylinder {
    radius_m: 609.6,
    half_height_m: 76.2,
};

/// The horizontal distance of a near mid-air collision, metres.
const NEAR_M: f64 = 152.4;

/// The least horizontal distance of a flight from an aircraft that is seen late, metres.
fn least_m(position_m: Vec3, velocity_mps: Vec3, movement: Movement) -> f64 {
    let vehicle = Vehicle {
        airspeed_mps: 28.0,
        turn_radius_m: 114.0,
        ..planar()
    };
    let settings = Settings {
        surveillance_radius_m: f64::INFINITY,
        ..settings(Start::Free)
    };
    let mut flight = avoider(settings, vehicle);
    let mut obstacles = [Obstacle {
        movement,
        ..Obstacle::straight(7, position_m, velocity_mps, WELL_CLEAR)
    }];
    let mut least_m = f64::INFINITY;
    for _ in 0..600 {
        flight.cycle(&mut obstacles);
        let offset_m = flight.own.position_m - obstacles[0].position_m;
        least_m = least_m.min(offset_m.x.hypot(offset_m.y));
    }
    least_m
}

/// In an earlier version the margin inside a cylinder was the distance to its nearest face: at one height all ways
/// counted alike, and the aircraft flew through the middle.
#[test]
fn an_aircraft_that_cannot_stay_well_clear_still_turns_away() {
    for movement in [Movement::Straight, Movement::CREWED] {
        for (distance_m, aside_m) in [(800.0, 20.0), (700.0, -90.0), (400.0, 200.0)] {
            let position_m = Vec3::new(distance_m, aside_m, 20.0);
            let least_m = least_m(position_m, Vec3::X * -45.0, movement);
            assert!(
                least_m > NEAR_M,
                "{movement:?} {distance_m} {aside_m}: {least_m}"
            );
        }
    }
}

#[test]
fn the_depth_in_a_cylinder_grows_towards_its_axis_and_its_middle() {
    let hazard = Hazard::exact(7, Vec3::ZERO, Vec3::ZERO, WELL_CLEAR).by_depth();
    let margin_m = |aside_m, above_m| hazard.margin_m(Vec3::new(aside_m, 0.0, above_m), 0.0);
    assert!((margin_m(0.0, 0.0) + 38.1).abs() < 1e-9);
    for above_m in [0.0, 30.0, 70.0] {
        assert!(margin_m(100.0, above_m) < margin_m(500.0, above_m));
        assert!(margin_m(500.0, above_m) < 0.0);
        assert!(margin_m(609.6, above_m).abs() < 1e-9);
    }
    for aside_m in [0.0, 300.0, 600.0] {
        assert!(margin_m(aside_m, 10.0) < margin_m(aside_m, 60.0));
        assert!(margin_m(aside_m, 76.2).abs() < 1e-9);
    }
}
