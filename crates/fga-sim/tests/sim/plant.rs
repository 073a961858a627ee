//! The plant against the core's prediction, against another integration, and against its limits.

use fga::Vec3;
use fga::maneuver::{Maneuver, Stage};
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::vehicle::{Response, Vehicle};
use fga_sim::plant::{Autopilot, Plant};
use proptest::prelude::*;

fn vehicle(response: Response) -> Vehicle {
    Vehicle {
        airspeed_mps: 15.0,
        turn_radius_m: 30.0,
        climb_min_rad: -15.0_f64.to_radians(),
        climb_max_rad: 15.0_f64.to_radians(),
        climb_rate_radps: 0.2,
        response,
    }
}

const LAGGED: Response = Response {
    dead_time_s: 0.0,
    bank_time_constant_s: 0.6,
    turn_rate_factor: 0.74,
};

fn two_stages(first: (f64, f64, f64), gap_s: f64, second: (f64, f64)) -> Maneuver {
    let mut maneuver = Maneuver::turn(first.0, first.1, first.2);
    maneuver.push(Stage {
        start_s: first.0 + gap_s,
        course_rad: second.0,
        climb_rad: second.1,
        rate_share: 1.0,
    });
    maneuver
}

/// Flies one manoeuvre and shows the state after each tenth of a second.
fn fly(vehicle: Vehicle, maneuver: &Maneuver, seconds: u32, mut show: impl FnMut(f64, &Plant)) {
    let mut plant = Plant::new(vehicle, Autopilot::Direct, Vec3::ZERO);
    plant.place(0.0, Vec3::ZERO, 0.0, 0.0);
    plant.command(maneuver, f64::INFINITY);
    for k in 1..=10 * seconds {
        plant.advance(f64::from(k) * 0.1 - plant.time_s(), |_, _| ());
        show(f64::from(k) * 0.1, &plant);
    }
}

/// Largest distance between the flown and the predicted position over twelve seconds.
fn prediction_error_m(vehicle: Vehicle, maneuver: &Maneuver) -> f64 {
    let flyer = Flyer::new(&vehicle);
    let mut path = FlightPath::new();
    let start = MotionState {
        time_s: 0.0,
        position_m: Vec3::ZERO,
        course_rad: 0.0,
        climb_rad: 0.0,
        bank_rad: 0.0,
    };
    path.predict(&flyer, &start, maneuver, 12.0);
    let mut largest = 0.0_f64;
    fly(vehicle, maneuver, 12, |time_s, plant| {
        if let Some(predicted) = path.state_at(&flyer, time_s) {
            largest = largest.max(predicted.position_m.distance(plant.ownship().position_m));
        }
    });
    largest
}

proptest! {
    #[test]
    fn the_core_predicts_the_ideal_plant_exactly(
        first in (0.0..2.0f64, -3.5..3.5f64, -0.26..0.26f64),
        gap in 0.0..5.0f64,
        second in (-3.5..3.5f64, -0.26..0.26f64),
    ) {
        let maneuver = two_stages(first, gap, second);
        let error = prediction_error_m(vehicle(Response::default()), &maneuver);
        prop_assert!(error < 1e-6, "{error}");
    }

    #[test]
    fn the_core_predicts_the_lagged_plant_closely(
        first in (0.0..2.0f64, -3.5..3.5f64, -0.26..0.26f64),
        gap in 0.0..5.0f64,
        second in (-3.5..3.5f64, -0.26..0.26f64),
    ) {
        let maneuver = two_stages(first, gap, second);
        let error = prediction_error_m(vehicle(LAGGED), &maneuver);
        prop_assert!(error < 5e-3, "{error}");
    }

    #[test]
    fn a_lagged_turn_meets_its_course_without_overshoot(
        course in prop_oneof![-3.5..-0.02f64, 0.02..3.5f64],
        time_constant in 0.1..1.5f64,
        dead_time in prop_oneof![Just(0.0), 0.05..0.8f64],
    ) {
        let response = Response {
            dead_time_s: dead_time,
            bank_time_constant_s: time_constant,
            turn_rate_factor: 0.8,
        };
        let mut last = 0.0;
        let mut before_dead_time = 0.0_f64;
        fly(vehicle(response), &Maneuver::turn(0.0, course, 0.1), 30, |time_s, plant| {
            let own = plant.ownship();
            assert!(own.course_rad * course.signum() <= course.abs() + 2e-3, "overshoot");
            assert!(own.bank_rad.abs() <= (225.0_f64 / (9.806_65 * 30.0)).atan() + 1e-9);
            if time_s < dead_time {
                before_dead_time = before_dead_time.max(own.course_rad.abs() + own.climb_rad.abs());
            }
            last = own.course_rad;
        });
        prop_assert!((last - course).abs() < 2e-3, "{last} instead of {course}");
        prop_assert_eq!(before_dead_time, 0.0);
    }
}

/// Bank lag by another rule: Euler's in steps of 0.1 ms.
#[test]
fn a_lagged_turn_agrees_with_small_euler_steps() {
    let vehicle = vehicle(LAGGED);
    let mut plant = Plant::new(vehicle, Autopilot::Direct, Vec3::ZERO);
    plant.place(0.0, Vec3::ZERO, 0.0, 0.0);
    // Far enough that the full bank is commanded throughout.
    plant.command(&Maneuver::turn(0.0, 20.0, 0.0), f64::INFINITY);
    plant.advance(4.0, |_, _| ());
    let (mut x, mut y, mut course, mut bank) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    let commanded = (225.0_f64 / (9.806_65 * 30.0)).atan();
    let h = 1e-4;
    for _ in 0..40_000 {
        x += 15.0 * course.cos() * h;
        y += 15.0 * course.sin() * h;
        course += 0.74 * 9.806_65 * bank.tan() / 15.0 * h;
        bank += (commanded - bank) / 0.6 * h;
    }
    let own = plant.ownship();
    assert!(
        (own.course_rad - course).abs() < 1e-3,
        "{} {course}",
        own.course_rad
    );
    assert!((own.bank_rad - bank).abs() < 1e-3);
    assert!(own.position_m.distance(Vec3::new(x, y, 0.0)) < 0.02);
}

#[test]
fn the_pi_autopilot_settles_on_its_course() {
    let autopilot = Autopilot::ProportionalIntegral {
        proportional_per_s: 2.0,
        integral_per_s2: 0.1,
    };
    let mut plant = Plant::new(vehicle(Response::default()), autopilot, Vec3::ZERO);
    plant.place(0.0, Vec3::ZERO, 0.0, 0.0);
    plant.command(&Maneuver::turn(0.0, 1.0, 0.1), f64::INFINITY);
    let mut largest = 0.0_f64;
    plant.advance(2.0, |arc, _| largest = largest.max(arc.course_rate_radps));
    assert!((largest - 0.5).abs() < 1e-9, "the rate is limited to V/ρ");
    plant.advance(38.0, |_, _| ());
    let own = plant.ownship();
    assert!((own.course_rad - 1.0).abs() < 0.01 && (own.climb_rad - 0.1).abs() < 0.01);
}

#[test]
fn wind_carries_the_path_along() {
    let wind = Vec3::new(3.0, -2.0, 0.5);
    let maneuver = Maneuver::turn(0.5, -2.0, 0.1);
    let flown = |wind: Vec3| {
        let mut plant = Plant::new(vehicle(Response::default()), Autopilot::Direct, wind);
        plant.place(0.0, Vec3::ZERO, 0.0, 0.0);
        plant.command(&maneuver, f64::INFINITY);
        plant.advance(7.0, |_, _| ());
        plant.ownship().position_m
    };
    assert!(flown(wind).distance(flown(Vec3::ZERO) + wind * 7.0) < 1e-9);
}
