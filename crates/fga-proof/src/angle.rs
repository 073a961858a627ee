//! Angles and sides: wrapping, directions, and the only place where a sign becomes a [`Side`].
//!
//! Angles increase anticlockwise from above; left is the positive side.

use core::f64::consts::{PI, TAU};

use crate::Vec3;

/// The side of a turn, as the pilot sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// Anticlockwise from above: the course ψ increases.
    Left,
    /// Clockwise from above: the course ψ decreases.
    Right,
}

impl Side {
    /// Both sides, left first.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// +1 for left, −1 for right: the sign of the course rate of a turn to this side.
    #[inline]
    pub const fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// The opposite side.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// The side to which `angle_rad` turns; zero counts as left.
    pub const fn of(angle_rad: f64) -> Self {
        if angle_rad < 0.0 {
            Self::Right
        } else {
            Self::Left
        }
    }
}

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
    libm::atan2(
        vector.z,
        libm::sqrt(vector.x * vector.x + vector.y * vector.y),
    )
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
        let turned = direction(Side::Left.sign() * PI / 2.0, 0.0);
        assert!(turned.distance(Vec3::Y) < 1e-12);
        assert_eq!(Side::of(-0.1), Side::Right);
    }

    #[test]
    fn direction_and_its_angles_agree() {
        let vector = direction(2.0, -0.3) * 7.0;
        assert!((course_of(vector) - 2.0).abs() < 1e-12);
        assert!((climb_of(vector) + 0.3).abs() < 1e-12);
    }
}
