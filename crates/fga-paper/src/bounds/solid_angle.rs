//! The admissible directions in space (Eq. 51–53): the complement of every obstacle's collision
//! cone, cut by what the vehicle can reach.

use crate::conflict::{Relative, threatens};
use fga::Vec3;
use fga::angle::direction;
use fga::certificate::Hazard;

/// Golden angle, radians: turning by it spreads points evenly over a sphere.
const GOLDEN_ANGLE_RAD: f64 = 2.399_963_229_728_653;

/// Whether straight flight with this velocity stays clear of every obstacle: it lies in ∩ `Ω_i`
/// (Eq. 52). From a volume around the aircraft it must lead away.
///
/// False where a number is not finite.
pub fn direction_admissible(position_m: Vec3, velocity_mps: Vec3, obstacles: &[Hazard]) -> bool {
    obstacles.iter().all(|obstacle| {
        let relative = Relative::new(
            obstacle.position_m - position_m,
            velocity_mps - obstacle.velocity_mps,
        );
        relative.is_some_and(|relative| {
            if obstacle.volume.margin_m(relative.position_m()) < 0.0 {
                !relative.is_closing()
            } else {
                !threatens(&relative, &obstacle.volume)
            }
        })
    })
}

/// ∩ `Ω_i` as a fraction of the full sphere of 4π, for a speed and climb angles within
/// `climb_rad` = (least, largest), by counting `samples` evenly spread directions.
///
/// The error is about 1/samples^0.75. `None` for no samples, a speed that is not positive, or
/// angles outside of ±π/2.
pub fn admissible_fraction(
    position_m: Vec3,
    airspeed_mps: f64,
    climb_rad: (f64, f64),
    obstacles: &[Hazard],
    samples: u32,
) -> Option<f64> {
    let (least_rad, largest_rad) = climb_rad;
    let quarter = -core::f64::consts::FRAC_PI_2..=core::f64::consts::FRAC_PI_2;
    let usable = samples > 0
        && airspeed_mps.is_finite()
        && airspeed_mps > 0.0
        && quarter.contains(&least_rad)
        && quarter.contains(&largest_rad);
    if !usable {
        return None;
    }
    let count = f64::from(samples);
    let admissible = (0..samples)
        .filter(|index| {
            let index = f64::from(*index);
            // Equal steps in sin θ are equal areas.
            let climb_rad = libm::asin(1.0 - (2.0 * index + 1.0) / count);
            let way = direction(index * GOLDEN_ANGLE_RAD, climb_rad);
            (least_rad..=largest_rad).contains(&climb_rad)
                && direction_admissible(position_m, way * airspeed_mps, obstacles)
        })
        .count();
    Some(admissible as f64 / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::FRAC_PI_2;
    use fga::situation::ProtectedVolume;

    const ALL: (f64, f64) = (-FRAC_PI_2, FRAC_PI_2);

    fn ball(position: Vec3, velocity: Vec3, radius_m: f64) -> Hazard {
        Hazard::exact(1, position, velocity, ProtectedVolume::Sphere { radius_m })
    }

    /// The cap of half angle asin 0.6 covers (1 − cos)/2 = 0.1 of the sphere.
    #[test]
    fn a_static_obstacle_hides_a_cap() {
        let obstacle = ball(Vec3::new(60.0, 0.0, 80.0), Vec3::ZERO, 60.0);
        let fraction = admissible_fraction(Vec3::ZERO, 15.0, ALL, &[obstacle], 40_000).unwrap();
        assert!((fraction - 0.9).abs() < 2e-3, "{fraction}");
    }

    /// The climb angles within ±30° make up sin 30° = half of the sphere.
    #[test]
    fn the_reachable_directions_are_a_band() {
        let band = (-FRAC_PI_2 / 3.0, FRAC_PI_2 / 3.0);
        let fraction = admissible_fraction(Vec3::ZERO, 15.0, band, &[], 40_000).unwrap();
        assert!((fraction - 0.5).abs() < 1e-3);
        assert_eq!(
            admissible_fraction(Vec3::ZERO, 15.0, ALL, &[], 100),
            Some(1.0)
        );
    }

    /// The same by Monte Carlo with another generator and the closest approach by stepping in time.
    #[test]
    fn a_moving_obstacle_agrees_with_random_directions() {
        let obstacle = ball(
            Vec3::new(100.0, 20.0, -10.0),
            Vec3::new(-20.0, 0.0, 5.0),
            40.0,
        );
        let fraction = admissible_fraction(Vec3::ZERO, 15.0, ALL, &[obstacle], 40_000).unwrap();
        let mut state = 12_345_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) * 2.0 - 1.0
        };
        let (mut clear, mut all) = (0, 0);
        while all < 4000 {
            let way = Vec3::new(random(), random(), random());
            if way.length_squared() > 1.0 || way.length_squared() < 1e-6 {
                continue;
            }
            all += 1;
            let velocity = way.normalize() * 15.0;
            let least = (0..600)
                .map(|i| {
                    let t = f64::from(i) * 0.05;
                    (obstacle.position_after_m(t) - velocity * t).length()
                })
                .fold(f64::INFINITY, f64::min);
            clear += i32::from(least >= 40.0);
        }
        assert!(
            (f64::from(clear) / 4000.0 - fraction).abs() < 0.03,
            "{fraction}"
        );
    }

    #[test]
    fn inside_half_of_the_sphere_leads_away() {
        let obstacle = ball(Vec3::new(5.0, 0.0, 0.0), Vec3::ZERO, 30.0);
        let fraction = admissible_fraction(Vec3::ZERO, 15.0, ALL, &[obstacle], 10_000).unwrap();
        assert!((fraction - 0.5).abs() < 1e-2);
    }

    #[test]
    fn wrong_input_is_refused() {
        assert!(!direction_admissible(
            Vec3::NAN,
            Vec3::X,
            &[ball(Vec3::X * 90.0, Vec3::ZERO, 1.0)]
        ));
        for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
            assert_eq!(admissible_fraction(Vec3::ZERO, bad, ALL, &[], 10), None);
        }
        assert_eq!(
            admissible_fraction(Vec3::ZERO, 15.0, (f64::NAN, 0.0), &[], 10),
            None
        );
        assert_eq!(admissible_fraction(Vec3::ZERO, 15.0, ALL, &[], 0), None);
    }
}
