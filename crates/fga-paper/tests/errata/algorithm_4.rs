//! Algorithm 4, Eq. 59 and 60. Bearings here are compass bearings where a name says so.

use crate::{flown_separation, ownship};
use core::f64::consts::FRAC_PI_2;
use fga::Vec3;
use fga::angle::wrap_pi;
use fga::search::Side;
use fga::vehicle::turn_radius_m;
use fga_paper::algorithm_4::{Execution, Phase, Plan, pwm_us};
use fga_paper::printed;
use fga_paper::turn::bank_for_radius_rad;

/// Bank angle for 30 m at 15 m/s.
fn bank() -> f64 {
    bank_for_radius_rad(15.0, 30.0).unwrap()
}

fn plan(ahead: f64, left: f64) -> Plan {
    Plan::of(&ownship(), Vec3::new(ahead, left, 0.0), 30.0, bank()).unwrap()
}

/// Head-on, ρ = d = 30 m: the circle of the turn touches the volume from √(60² − 30²) = 51.96 m;
/// line 17 says √(60² + 30²) = 67.1 m.
#[test]
fn the_critical_distance_is_a_leg_and_not_a_hypotenuse() {
    let printed = printed::critical_along_m(30.0, 30.0, 300.0, 0.0);
    assert!((printed - 67.08).abs() < 0.01);
    let corrected = plan(300.0, 0.0).critical_along_m;
    let flown = |before: f64| {
        let target = (Vec3::X * 300.0, Vec3::ZERO);
        flown_separation(15.0, 30.0, FRAC_PI_2, (300.0 - before) / 15.0, target, 30.0)
    };
    assert!((flown(corrected) - 30.0).abs() < 0.02);
    assert!(flown(printed) > 40.0);
}

/// Mirrored encounters have mirrored answers; with a signed sine they differ by 17 m.
#[test]
fn the_critical_distance_has_no_side() {
    let bias = f64::asin(20.0 / 300.0);
    let left = printed::critical_along_m(30.0, 30.0, 300.0, bias);
    let right = printed::critical_along_m(30.0, 30.0, 300.0, -bias);
    assert!(left - right > 17.0);
    let (left, right) = (plan(299.33, 20.0), plan(299.33, -20.0));
    assert!((left.critical_along_m - right.critical_along_m).abs() < 1e-9);
}

/// From 300 m at 15 m/s the turn is due after (300 − 51.96)/15 = 16.5 s, not after 67.1/15 = 4.5 s.
#[test]
fn the_timer_runs_until_the_distance_is_reached() {
    let printed = printed::critical_timer_s(67.08, 15.0);
    assert!((printed - 4.47).abs() < 0.01);
    let due = plan(300.0, 0.0).critical_s;
    assert!((300.0 - 15.0 * due - 51.96).abs() < 0.01);
}

/// At 300 m, at the time 0, there is nothing to do yet; lines 24 and 25 do not wait.
#[test]
fn it_waits_until_one_of_the_triggers_fires() {
    assert!(!printed::is_waiting(300.0, 67.08, 0.0, 4.47));
    let mut execution = Execution::new(plan(300.0, 0.0));
    assert_eq!(execution.step(0.0, 300.0, 0.0).phase, Phase::Waiting);
    assert_eq!(execution.step(16.6, 300.0, 0.0).phase, Phase::TurningAway);
    // Close and late: turn. Lines 24 and 25 wait just then.
    assert!(printed::is_waiting(40.0, 67.08, 20.0, 4.47));
    let late = Execution::new(plan(300.0, 0.0)).step(20.0, 40.0, 0.0);
    assert_eq!(late.phase, Phase::TurningAway);
}

/// 20 m aside the range at the start is √(33.2² + 20²) = 38.7 m, not the 33.2 m along the course:
/// a trigger on the latter begins 6.6 m late and enters the volume.
#[test]
fn a_range_is_compared_with_a_range() {
    let plan = plan(300.0, 20.0);
    assert!((plan.critical_along_m - 33.17).abs() < 0.01);
    assert!((plan.critical_range_m - 38.73).abs() < 0.01);
    let target = (Vec3::new(300.0, 20.0, 0.0), Vec3::ZERO);
    let flown = |before: f64| {
        flown_separation(
            15.0,
            30.0,
            -FRAC_PI_2,
            (300.0 - before) / 15.0,
            target,
            30.0,
        )
    };
    let along_at_range = |range: f64| (range * range - 400.0_f64).sqrt();
    assert!(flown(along_at_range(plan.critical_along_m)) < 28.5);
    assert!((flown(along_at_range(plan.critical_range_m)) - 30.0).abs() < 0.02);
}

/// Course 3.1, bearing −3.1: the obstacle is 0.083 rad to the left, so the turn goes right. The
/// plain difference 6.2 has the other sign.
#[test]
fn differences_of_angles_are_wrapped() {
    let (course, bearing) = (3.1, -3.1);
    assert!(wrap_pi(bearing - course) > 0.0);
    let unwrapped = printed::turn_direction(course, bearing);
    let wrapped = printed::turn_direction(wrap_pi(course - bearing), 0.0);
    assert_eq!((unwrapped, wrapped), (1.0, -1.0));
    let mut own = ownship();
    own.course_rad = course;
    let place = Vec3::new(f64::cos(bearing), f64::sin(bearing), 0.0) * 200.0;
    assert_eq!(
        Plan::of(&own, place, 30.0, bank()).unwrap().side,
        Side::Right
    );
}

/// Line 31 turns away with compass angles (clockwise), towards with those of Eq. 10–12
/// (anticlockwise), and not at all dead ahead.
#[test]
fn the_side_of_the_turn_does_not_depend_on_luck() {
    // The obstacle is 0.1 rad to the right; +1 is PWM 2000 is right, towards it.
    let compass = printed::turn_direction(1.0, 1.0 + 0.1);
    let mathematical = printed::turn_direction(1.0, 1.0 - 0.1);
    assert_eq!((compass, mathematical), (-1.0, 1.0));
    assert_eq!(printed::turn_direction(1.0, 1.0), 0.0);
    assert_eq!(plan(300.0, -5.0).side, Side::Left);
    assert_eq!(plan(300.0, 0.0).side, Side::Right);
}

/// After a turn to the left the way round is to the right: 2000, where line 35 gives 1000.
#[test]
fn the_second_turn_goes_the_other_way() {
    let plan = plan(300.0, -5.0);
    let mut execution = Execution::new(plan);
    let first = execution.step(99.0, 10.0, 0.0);
    let second = execution.step(99.0, 30.0, plan.round.away.angle_rad + 1e-9);
    assert_eq!(second.phase, Phase::RoundObstacle);
    assert!(first.pwm_us < 1500.0 && second.pwm_us > 1500.0);
    let printed = printed::second_turn_pwm_us(-1.0, plan.round_bank_rad, plan.bank_max_rad);
    assert!(printed < 1500.0);
}

/// The text under Eq. 59: dir is the sign of `θ_t0`, +1 anticlockwise; two sentences before, 2000 is
/// right. With line 7's compass angles an obstacle to the right gives +1, 2000, and a turn to it.
#[test]
fn the_direction_of_eq_59_is_right_for_plus_one() {
    let compass_bias: f64 = 0.1;
    let printed = printed::second_turn_pwm_us(compass_bias.signum(), bank(), bank());
    assert!(printed > 1500.0);
    let plan = plan(300.0, -5.0);
    let command = Execution::new(plan).step(99.0, 10.0, 0.0);
    assert!(command.bank_rad > 0.0 && command.pwm_us < 1500.0);
    assert_eq!(pwm_us(-0.3, 0.3), Some(2000.0));
}

/// In metres, Eq. 60 banks 33.7° for 30 m at 15 m/s, which flies 34.4 m.
#[test]
fn eq_60_is_in_knots_and_feet() {
    let printed = printed::bank_rad(15.0, 30.0);
    assert!((printed.to_degrees() - 33.67).abs() < 0.01);
    assert!((turn_radius_m(15.0, printed).unwrap() - 34.45).abs() < 0.01);
    assert!((turn_radius_m(15.0, bank()).unwrap() - 30.0).abs() < 1e-9);
}
