//! Bound 2: fast enough for some direction to leave the collision cone (Eq. 31–45, 49, 50).
//!
//! In velocity space the directions that collide form a cone with its apex at `V_a`, open towards
//! the obstacle. The aircraft's velocities form a circle (a sphere) of radius `V_u` about 0. If 0
//! lies in that cone, some direction is clear exactly if the circle reaches the cone's surface:
//! `V_u` ≥ `V_a` |sin σ|, σ the angle between `V_a` and the nearest edge (Fig. 6, 7). If 0 lies
//! outside, the obstacle would miss a standing aircraft, and some direction is always clear.

use crate::conflict::Relative;
use fga::Vec3;

/// Least speed at which some direction in the plane is clear of the disc, metres per second
/// (Eq. 44): min of `V_a` |sin(`θ_va` − `θ_r1`)| and `V_a` |sin(`θ_r2` − `θ_va`)|, 0 where the
/// obstacle would miss a standing aircraft.
///
/// `offset_m` is A − U; both vectors are taken in the horizontal plane. `None` for input that is
/// not finite or an aircraft inside the disc, where there is no cone.
pub fn least_speed_2d_mps(offset_m: Vec3, obstacle_mps: Vec3, radius_m: f64) -> Option<f64> {
    let level = |v: Vec3| Vec3::new(v.x, v.y, 0.0);
    least_speed_3d_mps(level(offset_m), level(obstacle_mps), radius_m)
}

/// Least speed at which some direction in space is clear of the sphere, metres per second
/// (Eq. 49): `V_a` |sin σ|, 0 where the obstacle would miss a standing aircraft.
///
/// `None` for input that is not finite or an aircraft inside the sphere, where there is no cone.
pub fn least_speed_3d_mps(offset_m: Vec3, obstacle_mps: Vec3, radius_m: f64) -> Option<f64> {
    // A standing aircraft: V_r = −V_a.
    let standing = Relative::new(offset_m, -obstacle_mps)?;
    let distance_m = standing.distance_m();
    if !radius_m.is_finite() || radius_m < 0.0 || distance_m <= radius_m {
        return None;
    }
    let opening_rad = libm::asin(radius_m / distance_m);
    let sigma_rad = match standing.bias_rad() {
        Some(bias_rad) if bias_rad < opening_rad => opening_rad - bias_rad,
        _ => return Some(0.0),
    };
    Some(standing.speed_mps() * libm::sin(sigma_rad).abs())
}

/// Whether each of the obstacles, given as (A − U, `V_a`, `d_m`), leaves some course clear
/// (Eq. 45). Necessary for avoiding all of them, not sufficient: the courses must also intersect
/// ([`HeadingSet`](super::HeadingSet)). An obstacle without a cone makes it false.
pub fn speed_feasible_2d(
    airspeed_mps: f64,
    obstacles: impl IntoIterator<Item = (Vec3, Vec3, f64)>,
) -> bool {
    obstacles.into_iter().all(|(offset, velocity, radius)| {
        least_speed_2d_mps(offset, velocity, radius).is_some_and(|least| airspeed_mps >= least)
    })
}

/// The same in space (Eq. 50).
pub fn speed_feasible_3d(
    airspeed_mps: f64,
    obstacles: impl IntoIterator<Item = (Vec3, Vec3, f64)>,
) -> bool {
    obstacles.into_iter().all(|(offset, velocity, radius)| {
        least_speed_3d_mps(offset, velocity, radius).is_some_and(|least| airspeed_mps >= least)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conflict::threatens;
    use fga::angle::direction;
    use fga::situation::ProtectedVolume;
    use proptest::prelude::*;

    /// Head-on from 100 m with 30 m: the edges stand at asin 0.3, so 60 m/s need 60 · 0.3 = 18 m/s.
    #[test]
    fn head_on_by_hand() {
        let least = least_speed_2d_mps(Vec3::X * 100.0, Vec3::X * -60.0, 30.0).unwrap();
        assert!((least - 18.0).abs() < 1e-9);
        assert!(!speed_feasible_2d(
            15.0,
            [(Vec3::X * 100.0, Vec3::X * -60.0, 30.0)]
        ));
        assert!(speed_feasible_3d(
            18.1,
            [(Vec3::X * 100.0, Vec3::X * -60.0, 30.0)]
        ));
    }

    #[test]
    fn without_a_cone_there_is_no_answer() {
        assert_eq!(least_speed_2d_mps(Vec3::X * 10.0, Vec3::X, 30.0), None);
        assert_eq!(least_speed_3d_mps(Vec3::X * f64::NAN, Vec3::X, 30.0), None);
        assert_eq!(least_speed_3d_mps(Vec3::X * 100.0, Vec3::X, f64::NAN), None);
        assert_eq!(
            least_speed_3d_mps(Vec3::X * 100.0, Vec3::ZERO, 30.0),
            Some(0.0)
        );
    }

    proptest! {
        /// Tries 7,200 courses: some is clear exactly above the bound.
        #[test]
        fn some_course_is_clear_exactly_above_the_bound(
            ahead in 40.0..400.0f64, heading in -3.2..3.2f64, va in 1.0..60.0f64, vu in 1.0..40.0f64,
        ) {
            let (offset, velocity) = (Vec3::X * ahead, direction(heading, 0.0) * va);
            let least = least_speed_2d_mps(offset, velocity, 30.0).unwrap();
            prop_assume!((vu / least.max(1e-9) - 1.0).abs() > 0.01);
            let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
            let some = (0..7200).any(|i| {
                let own = direction(f64::from(i) * core::f64::consts::TAU / 7200.0, 0.0) * vu;
                !threatens(&Relative::new(offset, own - velocity).unwrap(), &volume)
            });
            prop_assert_eq!(some, vu > least);
        }

        /// In space the plane through `V_a` and the axis holds the nearest edge: same bound, tried with
        /// directions over the whole sphere.
        #[test]
        fn in_space_likewise(
            ahead in 40.0..200.0f64, heading in -3.2..3.2f64, climb in -1.5..1.5f64, va in 1.0..60.0f64, vu in 1.0..40.0f64,
        ) {
            let (offset, velocity) = (Vec3::X * ahead, direction(heading, climb) * va);
            let least = least_speed_3d_mps(offset, velocity, 30.0).unwrap();
            prop_assume!((vu / least.max(1e-9) - 1.0).abs() > 0.02);
            let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
            let some = (0..40_000).any(|i| {
                let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 40_000.0;
                let own = direction(f64::from(i) * 2.399_963_229_728_653, f64::asin(z)) * vu;
                !threatens(&Relative::new(offset, own - velocity).unwrap(), &volume)
            });
            prop_assert_eq!(some, vu > least);
        }
    }
}
