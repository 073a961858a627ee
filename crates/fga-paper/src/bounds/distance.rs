//! Bound 1: the initial distance must leave time for the turn (Eq. 26–30).

use crate::timing::{Geometry, Times};

/// Least initial distance from which a turn of radius `ρ_min` still avoids a static obstacle that is
/// seen at the bias angle `θ_t0`, metres: the distance at which the turn must begin at once.
///
/// The corrected Eq. 29: the distance where min(`t_c`, `t_L`) = 0. It is the larger of
/// (ρ + d) / (cos θ + sin θ) and √((ρ + d)² − ρ² cos² θ) − ρ sin θ; the first alone is too short
/// where ρ < d/√2.
///
/// `None` unless both lengths are positive and 0 ≤ θ < π/2 (a closing obstacle).
pub fn least_distance_m(turn_radius_m: f64, radius_m: f64, bias_rad: f64) -> Option<f64> {
    let positive = |value: f64| value.is_finite() && value > 0.0;
    let closing = (0.0..core::f64::consts::FRAC_PI_2).contains(&bias_rad);
    if !positive(turn_radius_m) || !positive(radius_m) || !closing {
        return None;
    }
    let (sin, cos) = libm::sincos(bias_rad);
    let sum_m = turn_radius_m + radius_m;
    let buffered_m = sum_m / (cos + sin);
    let tangent_m =
        libm::sqrt((sum_m * sum_m - turn_radius_m * turn_radius_m * cos * cos).max(0.0))
            - turn_radius_m * sin;
    let least_m = buffered_m.max(tangent_m);
    least_m.is_finite().then_some(least_m)
}

/// Whether every encounter leaves time for the turn: `t_c` > 0 (Eq. 26, 30, corrected).
/// An encounter without a threat is feasible.
pub fn distance_feasible(
    encounters: impl IntoIterator<Item = Geometry>,
    turn_radius_m: f64,
) -> bool {
    encounters.into_iter().all(|encounter| {
        !encounter.is_threat()
            || Times::of(&encounter, turn_radius_m, 0.0).is_some_and(|t| t.critical_s > 0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn seen_from(distance_m: f64, bias_rad: f64, radius_m: f64) -> Geometry {
        Geometry {
            along_m: distance_m * f64::cos(bias_rad),
            across_m: distance_m * f64::sin(bias_rad),
            closing_mps: 15.0,
            radius_m,
        }
    }

    #[test]
    fn head_on_it_is_the_critical_distance() {
        assert!((least_distance_m(30.0, 30.0, 0.0).unwrap() - 60.0).abs() < 1e-12);
        // d = 150, ρ = 30: √(180² − 30²) = 177.5 is less than 180.
        assert!((least_distance_m(30.0, 150.0, 0.0).unwrap() - 180.0).abs() < 1e-12);
    }

    #[test]
    fn wrong_input_is_refused() {
        for bad in [f64::NAN, f64::INFINITY, -1.0] {
            assert_eq!(least_distance_m(bad, 30.0, 0.0), None);
            assert_eq!(least_distance_m(30.0, bad, 0.0), None);
            assert_eq!(least_distance_m(30.0, 30.0, bad), None);
        }
        assert_eq!(least_distance_m(30.0, 30.0, 2.0), None);
    }

    #[test]
    fn each_of_many_must_be_far_enough() {
        let far = seen_from(100.0, 0.0, 30.0);
        let near = seen_from(59.0, 0.0, 30.0);
        assert!(distance_feasible([far, far], 30.0));
        assert!(!distance_feasible([far, near], 30.0));
        assert!(distance_feasible([seen_from(59.0, 3.0, 30.0)], 30.0));
        assert!(distance_feasible([], 30.0));
    }

    proptest! {
        /// A circle about the turn's centre (0, ρ) must stay d away from the obstacle. It does at the least
        /// distance; a tenth nearer it does not, where the larger of the two terms is the exact one.
        #[test]
        fn the_turn_begun_at_once_stays_clear(radius in 10.0..200.0f64, turn in 10.0..200.0f64, bias in 0.0..0.7f64) {
            let least = least_distance_m(turn, radius, bias).unwrap();
            // Beyond the cone there is no threat to check.
            prop_assume!(least * f64::sin(bias) < radius);
            let centre_apart = |r: f64| libm::hypot(r * f64::cos(bias), r * f64::sin(bias) + turn);
            prop_assert!(centre_apart(least) >= turn + radius - 1e-9);
            prop_assert!(distance_feasible([seen_from(least * 1.000_001, bias, radius)], turn));
            prop_assert!(!distance_feasible([seen_from(least * 0.999_999, bias, radius)], turn));
        }
    }
}
