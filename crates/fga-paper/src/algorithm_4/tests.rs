use super::*;
use crate::turn::{bank_for_radius_rad, course_rate_radps, turned};
use core::f64::consts::FRAC_PI_2;
use fga::angle::direction;
use proptest::prelude::*;

fn ownship(course_rad: f64) -> Ownship {
    Ownship {
        position_m: Vec3::new(100.0, 200.0, 50.0),
        course_rad,
        climb_rad: 0.0,
        bank_rad: 0.0,
        airspeed_mps: 15.0,
    }
}

/// An obstacle `ahead` and `left` of the aircraft.
fn place(own: &Ownship, ahead: f64, left: f64) -> Vec3 {
    own.position_m
        + direction(own.course_rad, 0.0) * ahead
        + direction(own.course_rad + FRAC_PI_2, 0.0) * left
}

/// Flies the commands at `step_s` with a bank that follows at once.
/// Returns (least distance, final state, time of the trigger).
fn fly(plan: Plan, own: Ownship, obstacle: Vec3, step_s: f64) -> (f64, Ownship, f64) {
    let mut execution = Execution::new(plan);
    let (mut own, mut least, mut trigger) = (own, f64::INFINITY, f64::NAN);
    for index in 0..200_000 {
        let at = f64::from(index) * step_s;
        let range = own.position_m.distance(obstacle);
        least = least.min(range);
        let command = execution.step(at, range, own.course_rad);
        if command.phase == Phase::Done {
            return (least, own, trigger);
        }
        if command.phase != Phase::Waiting && trigger.is_nan() {
            trigger = at;
        }
        let rate = course_rate_radps(own.airspeed_mps, command.bank_rad).unwrap();
        own = turned(&own, rate, step_s);
    }
    panic!("never done")
}

#[test]
fn pwm_is_linear_and_right_is_above_neutral() {
    assert_eq!(pwm_us(0.0, 0.5), Some(1500.0));
    assert_eq!(pwm_us(-0.5, 0.5), Some(2000.0));
    assert_eq!(pwm_us(0.25, 0.5), Some(1250.0));
    assert_eq!(pwm_us(9.0, 0.5), Some(1000.0));
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(pwm_us(bad, 0.5), None);
        assert_eq!(pwm_us(0.1, bad), None);
    }
    assert_eq!(pwm_us(0.1, 0.0), None);
}

/// 15 m/s at 37.4°: ρ = 30.0 m; head-on at 300 m with `d_m` = 30 m as in Fig. 24.
#[test]
fn the_plan_by_hand() {
    let own = ownship(0.0);
    let bank = f64::atan(225.0 / (9.806_65 * 30.0));
    let plan = Plan::of(&own, place(&own, 300.0, 0.0), 30.0, bank).unwrap();
    assert!((plan.turn_radius_m - 30.0).abs() < 1e-9);
    assert!((plan.critical_along_m - 51.961_524).abs() < 1e-5);
    assert!((plan.critical_range_m - 51.961_524).abs() < 1e-5);
    assert!((plan.critical_s - 16.535_9).abs() < 1e-3);
    assert!((plan.round_bank_rad - bank).abs() < 1e-9);
    assert_eq!(plan.side, Side::Right);
    // Round 150 m at the same speed: tan φ = 225 / (g 150).
    let wide = Plan::of(&own, place(&own, 600.0, 10.0), 150.0, bank).unwrap();
    assert!((wide.round_bank_rad - f64::atan(0.152_957)).abs() < 1e-5);
}

#[test]
fn the_turn_goes_away_from_the_obstacle() {
    for course in [0.0, 1.0, -3.0, 3.1, 7.0] {
        let own = ownship(course);
        let side = |left| {
            Plan::of(&own, place(&own, 200.0, left), 40.0, 0.6)
                .unwrap()
                .side
        };
        assert_eq!(
            (side(5.0), side(-5.0)),
            (Side::Right, Side::Left),
            "{course}"
        );
    }
}

#[test]
fn no_plan_without_a_projected_collision() {
    let own = ownship(0.5);
    let none = |ahead, left, radius, bank| {
        Plan::of(&own, place(&own, ahead, left), radius, bank).is_none()
    };
    assert!(none(200.0, 41.0, 40.0, 0.6));
    assert!(none(-200.0, 0.0, 40.0, 0.6));
    assert!(none(20.0, 0.0, 40.0, 0.6));
    assert!(none(f64::NAN, 0.0, 40.0, 0.6));
    assert!(none(200.0, 0.0, f64::NAN, 0.6));
    assert!(none(200.0, 0.0, 40.0, 0.0));
    assert!(Plan::of(&ownship(f64::INFINITY), Vec3::ZERO, 40.0, 0.6).is_none());
}

#[test]
fn whichever_trigger_comes_first_starts_it() {
    let own = ownship(0.0);
    let plan = Plan::of(&own, place(&own, 300.0, 10.0), 30.0, 0.6).unwrap();
    let phase_at = |elapsed, range| Execution::new(plan).step(elapsed, range, 0.0).phase;
    assert_eq!(phase_at(0.0, 300.0), Phase::Waiting);
    assert_eq!(phase_at(plan.critical_s + 0.01, 300.0), Phase::TurningAway);
    assert_eq!(
        phase_at(0.0, plan.critical_range_m - 0.01),
        Phase::TurningAway
    );
    assert_eq!(phase_at(f64::NAN, f64::NAN), Phase::Waiting);
    let mut execution = Execution::new(plan);
    execution.step(plan.critical_s, 0.0, 0.0);
    let command = execution.step(plan.critical_s, 0.0, f64::NAN);
    assert_eq!(command.phase, Phase::TurningAway);
    assert_eq!(command.pwm_us, 2000.0);
}

#[test]
fn the_second_phase_turns_the_other_way() {
    let own = ownship(0.0);
    let plan = Plan::of(&own, place(&own, 300.0, 10.0), 60.0, 0.6).unwrap();
    let mut execution = Execution::new(plan);
    assert!(execution.step(0.0, 10.0, 0.0).bank_rad < 0.0);
    let second = execution.step(1.0, 60.0, -plan.round.away.angle_rad - 1e-9);
    assert_eq!(second.phase, Phase::RoundObstacle);
    assert!(second.bank_rad > 0.0 && second.pwm_us < 1500.0);
    let third = execution.step(9.0, 60.0, plan.round.back.angle_rad + 1e-9);
    assert_eq!((third.phase, third.pwm_us), (Phase::TurningBack, 2000.0));
    let last = execution.step(12.0, 90.0, 0.0);
    assert_eq!((last.phase, last.bank_rad), (Phase::Done, 0.0));
    assert_eq!(execution.phase(), Phase::Done);
    assert_eq!(execution.plan().side, Side::Right);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Flown in closed loop it touches the volume within the motion of one control step, ends on the
    /// initial course and line, and triggers at the planned time.
    #[test]
    fn flown_it_touches_and_returns(
        course in -7.0..7.0f64, ahead in 350.0..600.0f64, share in -0.95..0.95f64,
        radius in 10.0..150.0f64, bank in 0.35..0.9f64,
    ) {
        let own = ownship(course);
        let obstacle = place(&own, ahead, share * radius);
        let plan = Plan::of(&own, obstacle, radius, bank).unwrap();
        let (least, end, trigger) = fly(plan, own, obstacle, 0.001);
        prop_assert!((least - radius).abs() < 0.2, "{least} {radius}");
        prop_assert!((end.course_rad - course).abs() < 0.01);
        let aside = (end.position_m - own.position_m).dot(direction(course + FRAC_PI_2, 0.0));
        prop_assert!(aside.abs() < 1.0, "{aside}");
        prop_assert!((trigger - plan.critical_s).abs() < 0.002);
    }
}

/// The FAA's constant is rounded: 0.3 % off in the tangent.
#[test]
fn faa_form_is_the_si_form_in_knots_and_feet() {
    let (airspeed_mps, radius_m) = (40.0, 300.0);
    let si = bank_for_radius_rad(airspeed_mps, radius_m).unwrap();
    let faa = bank_for_radius_faa_rad(airspeed_mps * 3600.0 / 1852.0, radius_m / 0.3048);
    assert_eq!(bank_for_radius_faa_rad(0.0, 300.0), None);
    assert_eq!(bank_for_radius_faa_rad(f64::NAN, 300.0), None);
    assert_eq!(bank_for_radius_faa_rad(78.0, -1.0), None);
    assert!((f64::tan(faa.unwrap()) / f64::tan(si) - 1.003).abs() < 2e-4);
}
