//! A leg that the aircraft has entered without the avoider's commands, and a clock that is set back.

use fga::Vec3;
use fga::avoider::{Decision, Start, State};
use fga::meter::Meter;
use fga::mission::{Progress, Route, Turner};
use fga::prediction::MotionState;
use fga::situation::Mission;

use crate::flight::{planar, sphere};
use crate::policies::{avoider, settings};

/// The corner is so sharp that the way onto the second leg is a turn round to its beginning; the vehicle flies its own turn.
#[test]
fn a_leg_that_the_vehicle_has_entered_by_itself_is_joined_ahead() {
    let waypoints_m = [
        Vec3::ZERO,
        Vec3::new(1000.0, 0.0, 0.0),
        Vec3::new(-3000.0, 0.0, 0.0),
    ];
    let mission = Mission::new(&waypoints_m);
    let route = Route {
        mission: &mission,
        flyer: &Turner::new(&planar()),
        wind_mps: Vec3::ZERO,
        climb_limits_rad: (0.0, 0.0),
        meter: &Meter::unlimited(),
    };
    let at = |x_m: f64, y_m: f64, course_deg: f64| MotionState {
        time_s: 0.0,
        position_m: Vec3::new(x_m, y_m, 0.0),
        course_rad: course_deg.to_radians(),
        climb_rad: 0.0,
        bank_rad: 0.0,
    };
    // Beside the leg by less than a third of the turn radius of 30 m, or by far more, or on another course.
    for (y_m, course_deg, is_entered) in [
        (8.0, 175.0, true),
        (25.0, 180.0, false),
        (8.0, 150.0, false),
    ] {
        let mut progress = Progress::new();
        for (time_s, state) in [
            (0.0, at(0.0, 0.0, 0.0)),
            (67.0, at(1001.0, 0.0, 0.0)),
            (90.0, at(500.0, y_m, course_deg)),
        ] {
            progress.update(&route, &state, time_s);
        }
        assert_eq!(progress.index(), 1);
        let state = at(500.0, y_m, course_deg);
        let join = progress
            .way_back(&route, &state, 0.52, 0)
            .expect("a way back");
        assert_eq!(
            join.along_m > 500.0,
            is_entered,
            "{y_m} {course_deg}: {join:?}"
        );
    }
}

/// A flight past an obstacle, by a clock that is set back in each state.
fn flown(set_back_s: f64, at_cycles: &[usize]) -> Vec<Decision> {
    let mut flight = avoider(settings(Start::Free), planar());
    let mut obstacles = [sphere(7, Vec3::new(200.0, 5.0, 0.0), Vec3::ZERO, 30.0)];
    (0..400)
        .map(|cycle| {
            if at_cycles.contains(&cycle) {
                flight.time_s -= set_back_s;
            }
            flight.cycle(&mut obstacles)
        })
        .collect()
}

#[test]
fn a_clock_that_is_set_back_by_less_than_a_second_costs_no_plan() {
    let straight_on = flown(0.0, &[]);
    let first = |state| {
        straight_on
            .iter()
            .position(|decision| decision.state == state)
    };
    let cycles: Vec<usize> = [State::Threatened, State::Avoiding, State::Recovering]
        .into_iter()
        .filter_map(first)
        .map(|cycle| cycle + 5)
        .collect();
    assert!(cycles.len() >= 2, "{cycles:?}");
    for (set_back, decision) in flown(0.4, &cycles).iter().zip(&straight_on) {
        assert_eq!(set_back.state, decision.state);
        assert_eq!(set_back.record.reason, decision.record.reason);
        assert!(!set_back.record.clock_set_back);
        let courses = set_back
            .command
            .stages()
            .iter()
            .zip(decision.command.stages());
        for (one, other) in courses {
            assert!((one.course_rad - other.course_rad).abs() < 1e-6);
        }
    }
}

#[test]
fn a_clock_that_is_set_back_farther_costs_the_plan_and_the_record_says_so() {
    let straight_on = flown(0.0, &[]);
    let avoids = |decision: &Decision| decision.state == State::Avoiding;
    let cycle = straight_on.iter().position(avoids).expect("an avoidance") + 5;
    let decisions = flown(100.0, &[cycle]);
    let told: Vec<usize> = (0..decisions.len())
        .filter(|cycle| decisions[*cycle].record.clock_set_back)
        .collect();
    assert_eq!(told, [cycle]);
    let kept = fga::avoider::Reason::ManeuverKept;
    assert_eq!(straight_on[cycle].record.reason, kept);
    assert_ne!(decisions[cycle].record.reason, kept);
}
