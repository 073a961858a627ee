//! Where a piece of flight leads: at constant rates exactly.

use crate::Vec3;
use crate::prediction::motion::{Flyer, MotionState, Piece};

type Complex = (f64, f64);

fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

const fn conjugate(a: Complex) -> Complex {
    (a.0, -a.1)
}

/// e^(i angle); free for level flight.
fn unit(angle_rad: f64) -> Complex {
    if angle_rad == 0.0 {
        return (1.0, 0.0);
    }
    let (sin, cos) = libm::sincos(angle_rad);
    (cos, sin)
}

/// sin(x) / x in x², whose next term is below 10⁻¹⁷ up to 1.
const SINC: [f64; 9] = [
    1.0,
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
];

/// sin(x) / x.
fn sinc(x: f64) -> f64 {
    if x.abs() > 1.0 {
        return libm::sin(x) / x;
    }
    let square = x * x;
    SINC.iter().rev().fold(0.0, |sum, term| sum * square + term)
}

impl Flyer {
    /// Displacement over `after_s` seconds at constant rates, metres (Eq. 10–12 integrated exactly), and course and climb
    /// angle halfway as unit complex numbers.
    fn chord(
        &self,
        course_rad: f64,
        climb_rad: f64,
        (course_rate_radps, climb_rate_radps): (f64, f64),
        after_s: f64,
    ) -> (Vec3, Complex, Complex) {
        let half_course = 0.5 * course_rate_radps * after_s;
        let half_climb = 0.5 * climb_rate_radps * after_s;
        let scale = self.airspeed_mps * after_s;
        let course = unit(course_rad + half_course);
        let climb = unit(climb_rad + half_climb);
        if climb_rate_radps == 0.0 {
            let chord = scale * sinc(half_course);
            let moved_m = Vec3::new(
                chord * climb.0 * course.0,
                chord * climb.0 * course.1,
                scale * climb.1,
            );
            return (moved_m, course, climb);
        }
        let sum = times(course, climb);
        let difference = times(course, conjugate(climb));
        let sum_chord = 0.5 * sinc(half_course + half_climb);
        let difference_chord = 0.5 * sinc(half_course - half_climb);
        let moved_m = Vec3::new(
            scale * (sum_chord * sum.0 + difference_chord * difference.0),
            scale * (sum_chord * sum.1 + difference_chord * difference.1),
            scale * sinc(half_climb) * climb.1,
        );
        (moved_m, course, climb)
    }

    /// Displacement `after_s` seconds into a piece, metres.
    ///
    /// With a course rate quadratic in time, the course differs from its mean rate by a parabola and a cubic that is odd
    /// about the middle: e(t) = a (s² − T²/4) / 2 + b s (s² − T²/4) / 6, s = t − T/2. This counts the parabola's first two orders,
    /// and the cubic's first, also while the climb angle changes.
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
        let (level, steep) = (climb.0, climb.1 * climb_radps);
        let left_m = cube_m
            * (level * growth * (turned / 480.0 - 1.0 / 12.0) + steep * curve * square / 720.0);
        let ahead_m = cube_m
            * square
            * (level * (mean_radps * curve / 720.0 - growth * growth / 240.0)
                - steep * mean_radps * growth / 240.0);
        let (cos, sin) = course;
        chord_m
            + Vec3::new(
                ahead_m * cos - left_m * sin,
                ahead_m * sin + left_m * cos,
                0.0,
            )
    }
}
