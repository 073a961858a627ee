//! The coordinated turn: its course rate (Eq. 9), where it leads (Eq. 10–12), and the bank angle that flies a radius (Eq. 60).
//!
//! Lengths in metres, speeds in metres per second, angles in radians, unless a name says otherwise.
//! The bank angle here is a magnitude in [0, π/2).

use core::f64::consts::FRAC_PI_2;

use fga::Vec3;
use fga::situation::Ownship;
use fga::vehicle::STANDARD_GRAVITY_MPS2;

fn positive(value: f64) -> Option<f64> {
    (value.is_finite() && value > 0.0).then_some(value)
}

/// Bank angle that flies a radius, radians: tan φ = V² / (g ρ) (Eq. 60 in SI units).
///
/// `None` unless both are positive.
pub fn bank_for_radius_rad(airspeed_mps: f64, radius_m: f64) -> Option<f64> {
    let airspeed_mps = positive(airspeed_mps)?;
    let radius_m = positive(radius_m)?;
    let squared = positive(airspeed_mps * airspeed_mps)?;
    Some(libm::atan2(squared, STANDARD_GRAVITY_MPS2 * radius_m))
}

/// Course rate of a coordinated turn, radians per second: ψ̇ = g tan φ / V (Eq. 9).
///
/// The bank angle may have either sign, the rate takes it: positive in a left turn.
/// `None` unless the airspeed is positive and |φ| < π/2.
pub fn course_rate_radps(airspeed_mps: f64, bank_rad: f64) -> Option<f64> {
    let airspeed_mps = positive(airspeed_mps)?;
    if !bank_rad.is_finite() || bank_rad.abs() >= FRAC_PI_2 {
        return None;
    }
    let rate_radps = STANDARD_GRAVITY_MPS2 * libm::tan(bank_rad) / airspeed_mps;
    rate_radps.is_finite().then_some(rate_radps)
}

/// Where the aircraft is `after_s` seconds later, turning at a constant course rate with its climb
/// angle held: Eq. 10–12 integrated exactly. The course is not wrapped.
///
/// A course rate or time that is not finite leaves the state as it is.
#[must_use]
pub fn turned(ownship: &Ownship, course_rate_radps: f64, after_s: f64) -> Ownship {
    let turn_rad = course_rate_radps * after_s;
    if !turn_rad.is_finite() || !after_s.is_finite() {
        return *ownship;
    }
    let (sin_climb, cos_climb) = libm::sincos(ownship.climb_rad);
    let level_m = ownship.airspeed_mps * cos_climb * after_s;
    // The chord of the arc: length · sin(Δψ/2)/(Δψ/2), along the mean course.
    let half_rad = turn_rad / 2.0;
    let chord_m = if half_rad.abs() < 1e-8 {
        level_m
    } else {
        level_m * libm::sin(half_rad) / half_rad
    };
    let (sin_mean, cos_mean) = libm::sincos(ownship.course_rad + half_rad);
    let moved_m = Vec3::new(
        chord_m * cos_mean,
        chord_m * sin_mean,
        ownship.airspeed_mps * sin_climb * after_s,
    );
    Ownship {
        position_m: ownship.position_m + moved_m,
        course_rad: ownship.course_rad + turn_rad,
        ..*ownship
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga::vehicle::turn_radius_m;
    use proptest::prelude::*;

    fn ownship(course_rad: f64, climb_rad: f64) -> Ownship {
        Ownship {
            position_m: Vec3::new(10.0, -20.0, 100.0),
            course_rad,
            climb_rad,
            bank_rad: 0.0,
            airspeed_mps: 15.0,
        }
    }

    /// Level coordinated flight: lift L, L cos φ = m g, L sin φ = m V²/ρ.
    #[test]
    fn radius_balances_the_forces() {
        let (airspeed, bank) = (15.0, 0.65);
        let radius = turn_radius_m(airspeed, bank).unwrap();
        let mass = 3.2;
        let lift = mass * 9.806_65 / f64::cos(bank);
        let centripetal = mass * airspeed * airspeed / radius;
        assert!((lift * f64::sin(bank) - centripetal).abs() < 1e-9);
    }

    #[test]
    fn table_4_takes_37_degrees() {
        let bank = bank_for_radius_rad(15.0, 30.0).unwrap();
        assert!((bank.to_degrees() - 37.41).abs() < 0.01);
    }

    #[test]
    fn a_full_turn_takes_the_circumference() {
        let (airspeed, bank) = (20.0, 0.5);
        let rate = course_rate_radps(airspeed, bank).unwrap();
        let circumference = core::f64::consts::TAU * turn_radius_m(airspeed, bank).unwrap();
        assert!((core::f64::consts::TAU / rate - circumference / airspeed).abs() < 1e-9);
    }

    #[test]
    fn input_out_of_range_is_refused() {
        for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
            assert_eq!(turn_radius_m(bad, 0.5), None);
            assert_eq!(turn_radius_m(15.0, bad), None);
            assert_eq!(bank_for_radius_rad(15.0, bad), None);
            assert_eq!(course_rate_radps(bad, 0.1), None);
        }
        assert_eq!(turn_radius_m(15.0, 2.0), None);
        assert_eq!(course_rate_radps(15.0, f64::NAN), None);
    }

    /// Fourth-order integration of Eq. 10–12 with 2,000 steps.
    #[test]
    fn turned_solves_the_equations_of_motion() {
        let start = ownship(0.4, 0.2);
        let (rate, duration, steps) = (-0.5, 7.0, 2000);
        let derivative = |course: f64| {
            Vec3::new(
                15.0 * f64::cos(0.2) * f64::cos(course),
                15.0 * f64::cos(0.2) * f64::sin(course),
                15.0 * f64::sin(0.2),
            )
        };
        let step = duration / f64::from(steps);
        let (mut position, mut course) = (start.position_m, start.course_rad);
        for _ in 0..steps {
            let middle = derivative(course + rate * step / 2.0);
            position += (derivative(course) + middle * 4.0 + derivative(course + rate * step))
                * (step / 6.0);
            course += rate * step;
        }
        let end = turned(&start, rate, duration);
        assert!(end.position_m.distance(position) < 1e-8);
        assert!((end.course_rad - course).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn bank_and_radius_are_inverse(airspeed in 1.0..200.0f64, bank in 0.01..1.5f64) {
            let radius = turn_radius_m(airspeed, bank).unwrap();
            prop_assert!((bank_for_radius_rad(airspeed, radius).unwrap() - bank).abs() < 1e-9);
        }

        #[test]
        fn every_input_gives_a_number_or_none(airspeed: f64, other: f64) {
            for value in [
                turn_radius_m(airspeed, other),
                bank_for_radius_rad(airspeed, other),
                course_rate_radps(airspeed, other),
            ].into_iter().flatten() {
                prop_assert!(value.is_finite());
            }
        }

        #[test]
        fn a_right_turn_mirrors_a_left_turn(rate in 0.0..1.0f64, after in 0.0..20.0f64) {
            let start = ownship(0.0, 0.1);
            let left = turned(&start, rate, after);
            let right = turned(&start, -rate, after);
            let moved_left = left.position_m - start.position_m;
            let moved_right = right.position_m - start.position_m;
            let mirrored = Vec3::new(moved_right.x, -moved_right.y, moved_right.z);
            prop_assert!(moved_left.distance(mirrored) < 1e-9);
        }
    }
}
