//! Room for obstacles that is lent.

use fga::Vec3;
use fga::avoider::{Avoider, Known, LIMITS, Settings, State, Tracks};
use fga::certificate::Hazard;
use fga::situation::{Movement, Obstacle};

use crate::flight::{Flight, sphere, vehicle};

#[test]
fn with_room_for_few_obstacles_it_decides_as_with_room_for_all() {
    let known = Box::leak(Box::new([Known::NONE; 3 + LIMITS]));
    let rows = Box::leak(Box::new([Hazard::NONE; 64]));
    let tracks = Tracks::within((known.as_mut_slice(), rows.as_mut_slice()));
    let mut lent = Avoider::within(Settings::default(), vehicle(), tracks);
    lent.prepare().unwrap();
    let own = Avoider::new(Settings::default(), vehicle()).unwrap();
    let mut flights = (Flight::of(lent, vehicle()), Flight::of(own, vehicle()));
    let aircraft = |id, place_m, velocity_mps| Obstacle {
        movement: Movement::CREWED,
        ..sphere(id, place_m, velocity_mps, 30.0)
    };
    let mut obstacles = [
        aircraft(1, Vec3::new(700.0, 10.0, 0.0), Vec3::X * -20.0),
        aircraft(2, Vec3::new(300.0, -900.0, 5.0), Vec3::Y * 25.0),
        sphere(3, Vec3::new(420.0, 0.0, 0.0), Vec3::ZERO, 30.0),
    ];
    let mut avoids = false;
    for _ in 0..500 {
        let (lent, own) = &mut flights;
        let decision = lent.cycle(&mut obstacles.clone());
        assert_eq!(decision, own.cycle(&mut obstacles));
        avoids |= decision.state == State::Avoiding;
    }
    assert!(avoids);
}
