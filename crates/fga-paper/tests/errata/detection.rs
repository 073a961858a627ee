//! §2.2, Eq. 4 and 6, Algorithm 1.

use crate::{ball, ownship};
use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga_paper::conflict::{Cone, Conflict, Relative, assess, cone_3d, threatens};
use fga_paper::printed;

#[test]
fn relative_velocity_is_own_minus_obstacle() {
    let (own, ahead) = (ownship(), ball(200.0, 0.0, Vec3::ZERO));
    // Flying straight at it, the angle between V_r and r must be 0.
    let printed = printed::relative_velocity_mps(own.velocity_mps(), ahead.velocity_mps);
    let printed = Relative::new(ahead.position_m, printed).unwrap();
    assert!((printed.bias_rad().unwrap() - core::f64::consts::PI).abs() < 1e-12);
    assert!(Relative::of(&own, &ahead).unwrap().bias_rad().unwrap() < 1e-12);
}

/// 60 m at 100 m: the tangents stand at asin 0.6 = 0.6435. A course 0.62 off passes at
/// 100 sin 0.62 = 58.1 m, inside; sin `θ_dm` = 0.6 calls it safe.
#[test]
fn an_angle_is_compared_with_an_angle() {
    let bias = 0.62_f64;
    assert!(100.0 * bias.sin() < 60.0);
    assert!(!printed::in_collision_cone(bias, 60.0, 100.0));
    let offset = Vec3::new(100.0 * bias.cos(), 100.0 * bias.sin(), 0.0);
    let relative = Relative::new(offset, Vec3::X * 15.0).unwrap();
    assert!(matches!(
        cone_3d(&relative, 60.0),
        Some(Cone::Inside { .. })
    ));
}

/// The same sphere: a line at 0.6 rad cuts it (56.5 m), but lies outside a cone of atan 0.6 = 0.54.
#[test]
fn the_tangent_cone_opens_by_the_arcsine() {
    let bias = 0.6_f64;
    assert!(100.0 * bias.sin() < 60.0);
    assert!(printed::opening_angle_rad(60.0, 100.0) < bias);
    let offset = Vec3::new(100.0 * bias.cos(), 100.0 * bias.sin(), 0.0);
    let relative = Relative::new(offset, Vec3::X * 15.0).unwrap();
    let Some(Cone::Inside { threshold_rad, .. }) = cone_3d(&relative, 60.0) else {
        panic!()
    };
    assert!(threshold_rad > bias);
}

#[test]
fn receding_obstacles_are_no_threat() {
    let behind = Relative::of(&ownship(), &ball(-200.0, 0.0, Vec3::ZERO)).unwrap();
    assert!(printed::is_dangerous(
        200.0,
        behind.bias_rad().unwrap(),
        30.0
    ));
    assert!(!threatens(
        &behind,
        &ProtectedVolume::Sphere { radius_m: 30.0 }
    ));
}

/// Eq. 1 gives a signed angle, Table 1 its absolute value. With the sign, everything on one side
/// counts as dangerous, even an obstacle 100 m to the right of the course.
#[test]
fn the_bias_angle_counts_without_its_sign() {
    let aside = ball(200.0, 100.0, Vec3::ZERO);
    let signed = -f64::atan2(100.0, 200.0);
    assert!(printed::is_dangerous(200.0_f64.hypot(100.0), signed, 30.0));
    let relative = Relative::of(&ownship(), &aside).unwrap();
    assert!(!threatens(&relative, &aside.volume));
}

/// Inside the volume `θ_dm` = asin(30/20) does not exist, and for `V_r` = 0 `θ_t0` does not.
#[test]
fn inside_and_motionless_are_cases_of_their_own() {
    assert!(f64::asin(30.0 / 20.0).is_nan());
    let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
    let inside = Relative::of(&ownship(), &ball(20.0, 0.0, Vec3::ZERO)).unwrap();
    assert_eq!(
        assess(&inside, &volume),
        Conflict::Inside { margin_m: -10.0 }
    );
    let abreast = Relative::of(&ownship(), &ball(50.0, 0.0, Vec3::X * 15.0)).unwrap();
    assert_eq!(abreast.bias_rad(), None);
    assert_eq!(
        assess(&abreast, &volume),
        Conflict::Receding { margin_m: 20.0 }
    );
    assert!(printed::critical_s(50.0, 0.0, 30.0, 30.0, 0.0).is_infinite());
}
