//! The ground: no manoeuvre comes lower than it takes to clear it, none begins because of it, and a manoeuvre below leads up.

use fga::avoider::{Reason, Settings, Start, State};
use fga::ground::Ground;
use fga::situation::Obstacle;
use fga::{Vec2, Vec3};

use crate::flight::{Flight, planar, sphere, vehicle};
use crate::policies::{avoider, settings};

/// Spacing of the posts, metres.
const SPACING_M: f64 = 20.0;
/// Error and clearance, metres.
const NEEDED_M: f64 = 25.0;

/// Ground from 1 km behind to 7 km ahead and 1 km to both sides, by its height at a place; it lasts as long as the tests.
fn ground(height_m: impl Fn(f64, f64) -> f64) -> Ground<'static> {
    let (columns, rows) = (401_u16, 101_u16);
    let heights: Vec<f32> = (0..u32::from(columns) * u32::from(rows))
        .map(|index| {
            let x = f64::from(index % u32::from(columns)) * SPACING_M - 1000.0;
            let y = f64::from(index / u32::from(columns)) * SPACING_M - 1000.0;
            #[expect(clippy::cast_possible_truncation, reason = "heights of a test")]
            let height = height_m(x, y) as f32;
            height
        })
        .collect();
    let columns = usize::from(columns);
    let mut peaks = vec![0.0; Ground::peak_count(columns, heights.len())];
    Ground::fill_peaks(columns, &heights, &mut peaks);
    let slices = (&*heights.leak(), &*peaks.leak());
    let place = (Vec2::splat(-1000.0), Vec2::splat(SPACING_M));
    Ground::new(place, columns, slices, (5.0, 20.0)).unwrap()
}

fn flight(height_m: impl Fn(f64, f64) -> f64) -> Flight {
    Flight {
        ground: Some(ground(height_m)),
        ..avoider(settings(Start::AtDetection), planar())
    }
}

/// A little to the left of the line: the cheapest way round is on the right.
fn standing() -> Vec<Obstacle> {
    vec![sphere(7, Vec3::new(200.0, 5.0, 0.0), Vec3::ZERO, 30.0)]
}

/// The most and the least offset from the line until the aircraft is back, all certified.
fn offsets(flight: &mut Flight) -> (f64, f64) {
    let mut obstacles = standing();
    let (mut least_m, mut most_m) = (0.0_f64, 0.0_f64);
    for _ in 0..400 {
        let reason = flight.cycle(&mut obstacles).record.reason;
        let at_m = flight.own.position_m;
        assert!(!reason.is_unproven(), "{reason:?} at {at_m}");
        least_m = least_m.min(at_m.y);
        most_m = most_m.max(at_m.y);
    }
    let at_m = flight.own.position_m;
    assert!(at_m.y.abs() < 1.0, "{at_m}");
    (least_m, most_m)
}

/// A hill to the right: it takes 25 m, so that there is room as far as 15 m beside the line.
fn hill(_: f64, y: f64) -> f64 {
    if y < -10.0 { 0.0 } else { -100.0 }
}

#[test]
fn no_turn_leads_into_a_hill() {
    let (least_m, most_m) = offsets(&mut flight(|_, _| -100.0));
    assert!(least_m < -20.0 && most_m < 5.0, "{least_m} {most_m}");
    let (least_m, most_m) = offsets(&mut flight(hill));
    assert!(least_m > -15.0 && most_m > 30.0, "{least_m} {most_m}");
}

#[test]
fn no_turn_leads_over_unknown_ground() {
    let unknown = |_: f64, y: f64| if y < -20.0 { f64::NAN } else { -100.0 };
    let (least_m, most_m) = offsets(&mut flight(unknown));
    assert!(least_m > -12.0 && most_m > 30.0, "{least_m} {most_m}");
}

/// Between walls that leave no room to the sides, and over ground that leaves none below.
#[test]
fn in_a_valley_the_aircraft_climbs() {
    let valley = |_: f64, y: f64| if y.abs() > 30.0 { 0.0 } else { -30.0 };
    let mut flight = Flight {
        ground: Some(ground(valley)),
        ..avoider(settings(Start::Free), vehicle())
    };
    let mut obstacles = standing();
    let mut highest_m = 0.0_f64;
    for _ in 0..400 {
        let reason = flight.cycle(&mut obstacles).record.reason;
        let at_m = flight.own.position_m;
        assert!(!reason.is_unproven(), "{reason:?} at {at_m}");
        assert!(obstacles[0].position_m.distance(at_m) > 30.0, "{at_m}");
        let needed_m = NEEDED_M + valley(at_m.x, at_m.y);
        assert!(at_m.z > needed_m, "{at_m}");
        highest_m = highest_m.max(at_m.z);
    }
    // Between the walls it is at most 30 m beside the line, and the sphere's centre 5 m.
    assert!(highest_m > 10.0, "{highest_m}");
}

/// The decisions of two flights without and with ground, side by side.
fn are_the_same(mut free: Flight, mut bound: Flight, obstacles: &[Obstacle]) {
    let mut rows = [obstacles.to_vec(), obstacles.to_vec()];
    for _ in 0..400 {
        let one = free.cycle(&mut rows[0]).command;
        let other = bound.cycle(&mut rows[1]).command;
        assert_eq!(*one, *other);
    }
}

#[test]
fn a_mission_that_clears_the_ground_or_leads_into_it_is_flown_as_given() {
    let free = || avoider(settings(Start::AtDetection), planar());
    let ridge = |x: f64, y: f64| -60.0 + 59.0 * (0.01 * x).sin() * (0.01 * y).cos();
    for height_m in [0.0, -40.0] {
        are_the_same(free(), flight(move |x, y| ridge(x, y) + height_m), &[]);
    }
    // Over unknown ground nothing binds, and far above the ground there is nothing to bind.
    let far_or_unknown = |level_m: f64| flight(move |_, _| level_m);
    are_the_same(free(), far_or_unknown(f64::NAN), &standing());
    are_the_same(free(), far_or_unknown(-2000.0), &standing());
}

/// The mission leads 5 m above what it takes, its beginning lies 15 m below that.
#[test]
fn a_start_too_low_leads_up() {
    let mut flight = Flight {
        ground: Some(ground(|_, _| -20.0)),
        ..avoider(settings(Start::AtDetection), vehicle())
    };
    flight.waypoints_m = vec![Vec3::new(0.0, 0.0, 10.0), Vec3::new(5000.0, 0.0, 10.0)];
    flight.own.position_m.z = -10.0;
    flight.own.climb_rad = -0.1;
    let mut up_s = None;
    for _ in 0..300 {
        let decision = flight.cycle(&mut []);
        assert!(!decision.record.reason.is_unproven());
        if flight.own.position_m.z > -20.0 + NEEDED_M {
            up_s.get_or_insert(flight.time_s);
        } else {
            assert!(up_s.is_none() && flight.own.position_m.z > -11.5);
        }
    }
    // 15 m at 3.9 m/s, and a change of the climb angle.
    assert!(up_s.is_some_and(|up_s| up_s < 8.0), "{up_s:?}");
}

/// Everything but a turn to the right, over unknown ground, leads into aircraft or ground.
#[test]
fn over_unknown_ground_a_turn_is_flown_where_nothing_else_avoids_traffic() {
    let cliff = |_: f64, y: f64| {
        if y < -20.0 {
            f64::NAN
        } else if y > 20.0 {
            200.0
        } else {
            -100.0
        }
    };
    let margin = Settings {
        margin_m: 3.0,
        ..settings(Start::AtDetection)
    };
    let mut flight = Flight {
        ground: Some(ground(cliff)),
        ..avoider(margin, planar())
    };
    let mut obstacles = standing();
    let (mut is_unproven, mut nearest_m) = (false, f64::INFINITY);
    for _ in 0..150 {
        let decision = flight.cycle(&mut obstacles);
        is_unproven |= decision.record.reason == Reason::BestAvailable;
        assert!(flight.own.position_m.y < 20.0);
        nearest_m = nearest_m.min(flight.own.position_m.distance(obstacles[0].position_m) - 30.0);
        assert!(
            decision.state != State::Cruise
                || decision.record.reason == Reason::Clear
                || nearest_m > 0.0
        );
    }
    assert!(is_unproven && nearest_m > 0.0, "{is_unproven} {nearest_m}");
}
