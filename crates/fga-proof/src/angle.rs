//! Angles: wrapping and directions. They increase anticlockwise from above; left is the positive side.

use core::f64::consts::{PI, TAU};

use crate::{Vec2, Vec3};

/// The same direction in (−π, π]; a non-finite angle gives 0.
pub fn wrap_pi(angle_rad: f64) -> f64 {
    if angle_rad > -PI && angle_rad <= PI {
        return angle_rad;
    }
    if !angle_rad.is_finite() {
        return 0.0;
    }
    let wrapped = libm::remainder(angle_rad, TAU);
    if wrapped <= -PI { PI } else { wrapped }
}

/// Cosine and sine of an angle; free for 0.
#[inline]
pub fn unit(angle_rad: f64) -> Vec2 {
    if angle_rad == 0.0 {
        return Vec2::X;
    }
    let (sin, cos) = libm::sincos(angle_rad);
    Vec2::new(cos, sin)
}

/// The unit vector of a course and a climb angle (Eq. 10–12 with V = 1).
pub fn direction(course_rad: f64, climb_rad: f64) -> Vec3 {
    let (sin_course, cos_course) = libm::sincos(course_rad);
    let (sin_climb, cos_climb) = libm::sincos(climb_rad);
    Vec3::new(cos_climb * cos_course, cos_climb * sin_course, sin_climb)
}

/// Course of a vector in (−π, π]; 0 for a vertical or zero vector.
pub fn course_of(vector: Vec3) -> f64 {
    libm::atan2(vector.y, vector.x)
}

/// Climb angle of a vector in [−π/2, π/2]; 0 for the zero vector.
pub fn climb_of(vector: Vec3) -> f64 {
    libm::atan2(vector.z, vector.truncate().length())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapping_keeps_the_direction() {
        for (angle, expected) in [
            (0.0, 0.0),
            (PI, PI),
            (-PI, PI),
            (3.0 * PI, PI),
            (7.0, 7.0 - TAU),
        ] {
            assert!((wrap_pi(angle) - expected).abs() < 1e-12, "{angle}");
        }
        assert_eq!(wrap_pi(f64::NAN), 0.0);
        assert_eq!(wrap_pi(f64::INFINITY), 0.0);
    }

    #[test]
    fn a_left_turn_from_east_leads_north() {
        assert!(direction(PI / 2.0, 0.0).distance(Vec3::Y) < 1e-12);
    }

    #[test]
    fn direction_and_its_angles_agree() {
        let vector = direction(2.0, -0.3) * 7.0;
        assert!((course_of(vector) - 2.0).abs() < 1e-12);
        assert!((climb_of(vector) + 0.3).abs() < 1e-12);
    }
}
