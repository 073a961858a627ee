//! Where a piece of flight leads: at constant rates exactly.

use crate::angle::unit;
use crate::prediction::motion::{Flyer, MotionState, Piece};
use crate::{Vec2, Vec3};

/// sin(x) / x.
fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { libm::sin(x) / x }
}

impl Flyer {
    /// Displacement over `after_s` seconds at constant rates, metres (Eq. 10–12 integrated exactly), and cosine and sine of course
    /// and climb angle halfway.
    fn chord(
        &self,
        course_rad: f64,
        climb_rad: f64,
        (course_rate_radps, climb_rate_radps): (f64, f64),
        after_s: f64,
    ) -> (Vec3, Vec2, Vec2) {
        let half_course = 0.5 * course_rate_radps * after_s;
        let half_climb = 0.5 * climb_rate_radps * after_s;
        let course = unit(course_rad + half_course);
        let climb = unit(climb_rad + half_climb);
        let sum = climb.rotate(course) * sinc(half_course + half_climb);
        let back = Vec2::new(climb.x, -climb.y);
        let difference = back.rotate(course) * sinc(half_course - half_climb);
        let level = 0.5 * (sum + difference);
        let moved = level.extend(sinc(half_climb) * climb.y);
        (moved * (self.airspeed_mps * after_s), course, climb)
    }

    /// Displacement `after_s` seconds into a piece, metres.
    ///
    /// With a course rate quadratic in time, the course differs from its mean rate by a parabola and a cubic about the middle. This
    /// counts the parabola's first two orders, and the cubic's first, also while the climb angle changes (proof.md §5).
    pub(super) fn moved_m(&self, state: &MotionState, piece: &Piece, after_s: f64) -> Vec3 {
        let mean_radps = piece.mean_radps(after_s);
        let climb_radps = piece.climb_rate_radps;
        let (course_rad, climb_rad) = (state.course_rad, state.climb_rad);
        let rates_radps = (mean_radps, climb_radps);
        let (chord_m, course, climb) = self.chord(course_rad, climb_rad, rates_radps, after_s);
        if !piece.is_rolling() {
            return chord_m;
        }
        let curve = piece.course_curve_radps3;
        let growth = piece.course_growth_radps2 + 0.5 * curve * after_s;
        let square = after_s * after_s;
        let turned = (mean_radps * mean_radps + climb_radps * climb_radps) * square;
        let cube_m = self.airspeed_mps * square * after_s;
        let (level, steep) = (climb.x, climb.y * climb_radps);
        let left_m = cube_m
            * (level * growth * (turned / 480.0 - 1.0 / 12.0) + steep * curve * square / 720.0);
        let ahead_m = cube_m
            * square
            * (level * (mean_radps * curve / 720.0 - growth * growth / 240.0)
                - steep * mean_radps * growth / 240.0);
        chord_m + course.rotate(Vec2::new(ahead_m, left_m)).extend(0.0)
    }
}
