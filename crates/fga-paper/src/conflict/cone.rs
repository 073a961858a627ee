//! The collision cones (Eq. 1–6): in the body's x-y and x-z planes, and in space.
//!
//! Body frame: x along the flight path, y to the left, z up from the path.

use super::Relative;
use fga::Vec3;
use fga::angle::direction;
use fga::certificate::Hazard;
use fga::limit::Limit as _;
use fga::situation::Ownship;

/// The relation of the relative velocity to a collision cone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cone {
    /// `r_0` < `d_m`: the aircraft is inside the disc or sphere; there is no cone.
    ApexInside,
    /// `V_r` is zero (in this plane): there is no bias angle, and no threat.
    NoMotion,
    /// |`θ_t0`| < `θ_dm`: on the way in (Eq. 3, 4).
    Inside {
        /// `θ_t0`, radians; in a plane signed, positive where `V_r` points left of r.
        bias_rad: f64,
        /// `θ_dm` = asin(`d_m` / `r_0`), radians (Eq. 2).
        threshold_rad: f64,
    },
    /// |`θ_t0`| ≥ `θ_dm`: passes by or recedes (Eq. 5, 6).
    Outside {
        /// `θ_t0`, radians; in a plane signed, positive where `V_r` points left of r.
        bias_rad: f64,
        /// `θ_dm` = asin(`d_m` / `r_0`), radians (Eq. 2).
        threshold_rad: f64,
    },
}

impl Cone {
    /// Whether the path is, or will be, inside the disc or sphere.
    pub const fn is_threat(&self) -> bool {
        matches!(self, Self::ApexInside | Self::Inside { .. })
    }
}

/// Eq. 1–6 for a given angle.
fn decide(distance_m: f64, radius_m: f64, bias_rad: Option<f64>) -> Cone {
    if distance_m < radius_m {
        return Cone::ApexInside;
    }
    let Some(bias_rad) = bias_rad else {
        return Cone::NoMotion;
    };
    let threshold_rad = if distance_m > 0.0 {
        libm::asin((radius_m / distance_m).limited(0.0, 1.0))
    } else {
        0.0
    };
    if bias_rad.abs() < threshold_rad {
        Cone::Inside {
            bias_rad,
            threshold_rad,
        }
    } else {
        Cone::Outside {
            bias_rad,
            threshold_rad,
        }
    }
}

/// The cone in space about a sphere of `radius_m`; its half opening angle is asin(`d_m` / `r_0`).
///
/// `None` for a radius that is negative or not finite.
pub fn cone_3d(relative: &Relative, radius_m: f64) -> Option<Cone> {
    let bias_rad = (relative.speed_mps() > 0.0).then(|| relative.bias_rad().unwrap_or(0.0));
    usable(radius_m).then(|| decide(relative.distance_m(), radius_m, bias_rad))
}

/// The cone in the body's x-y plane about a disc of the volume's horizontal radius.
///
/// `None` where a number is not finite or out of range.
pub fn cone_xy(ownship: &Ownship, obstacle: &Hazard) -> Option<Cone> {
    let left = direction(ownship.course_rad + core::f64::consts::FRAC_PI_2, 0.0);
    planar(ownship, obstacle, left, obstacle.volume.radius_m())
}

/// The cone in the body's x-z plane about a disc of the volume's half height.
///
/// `None` where a number is not finite or out of range.
pub fn cone_xz(ownship: &Ownship, obstacle: &Hazard) -> Option<Cone> {
    let up = direction(
        ownship.course_rad,
        ownship.climb_rad + core::f64::consts::FRAC_PI_2,
    );
    planar(ownship, obstacle, up, obstacle.volume.half_height_m())
}

fn usable(radius_m: f64) -> bool {
    radius_m.is_finite() && radius_m >= 0.0
}

fn planar(ownship: &Ownship, obstacle: &Hazard, second: Vec3, radius_m: f64) -> Option<Cone> {
    let relative = Relative::of(ownship, obstacle)?;
    if !usable(radius_m) {
        return None;
    }
    let forward = direction(ownship.course_rad, ownship.climb_rad);
    let (r, v) = (relative.position_m(), relative.velocity_mps());
    let (rx, ry) = (r.dot(forward), r.dot(second));
    let (vx, vy) = (v.dot(forward), v.dot(second));
    let moves = vx != 0.0 || vy != 0.0;
    // θ_vr − θ_r, wrapped to ±π (Eq. 1).
    let bias_rad = moves.then(|| libm::atan2(rx * vy - ry * vx, rx * vx + ry * vy));
    Some(decide(libm::sqrt(rx * rx + ry * ry), radius_m, bias_rad))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conflict::assess;
    use fga::situation::ProtectedVolume;
    use proptest::prelude::*;

    fn ownship(course_rad: f64, climb_rad: f64) -> Ownship {
        Ownship {
            position_m: Vec3::ZERO,
            course_rad,
            climb_rad,
            bank_rad: 0.0,
            airspeed_mps: 15.0,
        }
    }

    fn sphere(position: [f64; 3], velocity: [f64; 3], radius_m: f64) -> Hazard {
        Hazard::exact(
            1,
            Vec3::from_array(position),
            Vec3::from_array(velocity),
            ProtectedVolume::Sphere { radius_m },
        )
    }

    /// 3-4-5: `d_m` = 60 at 100 m opens the cone to asin 0.6 = 36.87°.
    #[test]
    fn the_threshold_is_the_tangent_cone() {
        let relative = Relative::new(Vec3::new(100.0, 0.0, 0.0), Vec3::X * 5.0).unwrap();
        let Some(Cone::Inside { threshold_rad, .. }) = cone_3d(&relative, 60.0) else {
            panic!()
        };
        assert!((threshold_rad.to_degrees() - 36.869_898).abs() < 1e-5);
    }

    #[test]
    fn the_sign_of_the_bias_tells_the_side() {
        // The obstacle is to the right, so V_r points left of r.
        let right = cone_xy(
            &ownship(0.0, 0.0),
            &sphere([100.0, -10.0, 0.0], [0.0; 3], 30.0),
        );
        let Some(Cone::Inside { bias_rad, .. }) = right else {
            panic!("{right:?}")
        };
        assert!((bias_rad - f64::atan(0.1)).abs() < 1e-12);
        // And one below is passed above: in x-z the bias is positive upwards.
        let below = cone_xz(&ownship(2.0, 0.0), &{
            let ahead = direction(2.0, 0.0) * 100.0;
            sphere([ahead.x, ahead.y, -40.0], [0.0; 3], 30.0)
        });
        let Some(Cone::Outside { bias_rad, .. }) = below else {
            panic!("{below:?}")
        };
        assert!((bias_rad - f64::atan(0.4)).abs() < 1e-12);
    }

    #[test]
    fn degenerate_cases_have_names() {
        let still = Relative::new(Vec3::X * 100.0, Vec3::ZERO).unwrap();
        assert_eq!(cone_3d(&still, 30.0), Some(Cone::NoMotion));
        assert_eq!(cone_3d(&still, 130.0), Some(Cone::ApexInside));
        assert_eq!(cone_3d(&still, f64::NAN), None);
        let bad = sphere([f64::NAN, 0.0, 0.0], [0.0; 3], 30.0);
        assert_eq!(cone_xy(&ownship(0.0, 0.0), &bad), None);
        assert_eq!(cone_xz(&ownship(0.0, 0.0), &bad), None);
        // On the spot, with no extent.
        let nothing = Relative::new(Vec3::ZERO, Vec3::X).unwrap();
        assert!(!cone_3d(&nothing, 0.0).unwrap().is_threat());
    }

    proptest! {
        /// The angle of Eq. 4 and the distance of closest approach (Eq. 3) agree.
        #[test]
        fn angle_and_distance_agree(
            r in [-300.0..300.0f64, -300.0..300.0, -300.0..300.0],
            v in [-60.0..60.0f64, -60.0..60.0, -60.0..60.0],
            radius_m in 1.0..100.0f64,
        ) {
            let relative = Relative::new(Vec3::from_array(r), Vec3::from_array(v)).unwrap();
            let volume = ProtectedVolume::Sphere { radius_m };
            let conflict = assess(&relative, &volume);
            prop_assume!(conflict.margin_m().abs() > 1e-9);
            prop_assert_eq!(cone_3d(&relative, radius_m).unwrap().is_threat(), conflict.is_threat());
        }

        /// A path into a sphere enters it in every projection: the two plane cones are necessary, the cone in
        /// space decides.
        #[test]
        fn a_threat_in_space_shows_in_both_planes(
            r in [-300.0..300.0f64, -300.0..300.0, -100.0..100.0],
            v in [-60.0..60.0f64, -60.0..60.0, -10.0..10.0],
            course in -4.0..4.0f64, climb in -0.3..0.3f64,
            radius_m in 1.0..100.0f64,
        ) {
            let ownship = ownship(course, climb);
            let obstacle = sphere(r, v, radius_m);
            let relative = Relative::of(&ownship, &obstacle).unwrap();
            if assess(&relative, &obstacle.volume).margin_m() < -1e-9 {
                prop_assert!(cone_xy(&ownship, &obstacle).unwrap().is_threat());
                prop_assert!(cone_xz(&ownship, &obstacle).unwrap().is_threat());
            }
        }

        #[test]
        fn mirroring_flips_the_bias(
            r in [40.0..300.0f64, -300.0..300.0, -100.0..100.0],
            v in [-60.0..60.0f64, -60.0..60.0, -10.0..10.0],
        ) {
            let mirror = |a: [f64; 3]| [a[0], -a[1], a[2]];
            let bias = |cone| match cone {
                Some(Cone::Inside { bias_rad, .. } | Cone::Outside { bias_rad, .. }) => bias_rad,
                other => panic!("{other:?}"),
            };
            let one = bias(cone_xy(&ownship(0.0, 0.0), &sphere(r, v, 30.0)));
            let other = bias(cone_xy(&ownship(0.0, 0.0), &sphere(mirror(r), mirror(v), 30.0)));
            prop_assert!((one + other).abs() < 1e-9);
        }
    }
}
