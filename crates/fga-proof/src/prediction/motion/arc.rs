//! Flight at constant rates: its chord exactly, and steps along it.

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
pub(in crate::prediction) fn unit(angle_rad: f64) -> Complex {
    if angle_rad == 0.0 {
        return (1.0, 0.0);
    }
    let (sin, cos) = libm::sincos(angle_rad);
    (cos, sin)
}

/// The mean of a unit complex number that turns by 2 · half, by a scale, from e^(i half).
fn mean(half_rad: f64, half: Complex, scale: f64) -> Complex {
    let chord = scale * sinc(half_rad);
    (chord * half.0, chord * half.1)
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

/// Steps of equal length along an arc of constant rates, without a transcendental call a step.
///
/// ψ+θ, ψ−θ and θ are unit complex numbers that turn by a constant angle each step.
#[derive(Debug, Clone, Copy)]
pub struct ArcSteps {
    state: MotionState,
    step_s: f64,
    course_step_rad: f64,
    climb_step_rad: f64,
    airspeed_mps: f64,
    sum: Complex,
    difference: Complex,
    climb: Complex,
    turn: [Complex; 3],
    shift: [Complex; 3],
}

impl ArcSteps {
    /// Steps of `step_s` seconds along `piece` from `state`.
    pub fn new(flyer: &Flyer, state: &MotionState, piece: &Piece, step_s: f64) -> Self {
        let half_course = 0.5 * piece.course_rate_radps * step_s;
        let half_climb = 0.5 * piece.climb_rate_radps * step_s;
        let scale = flyer.airspeed_mps * step_s;
        let (course, climb) = (unit(state.course_rad), unit(state.climb_rad));
        let (course_half, climb_half) = (unit(half_course), unit(half_climb));
        let sum_half = times(course_half, climb_half);
        let difference_half = times(course_half, conjugate(climb_half));
        Self {
            state: *state,
            step_s,
            course_step_rad: 2.0 * half_course,
            climb_step_rad: 2.0 * half_climb,
            airspeed_mps: flyer.airspeed_mps,
            sum: times(course, climb),
            difference: times(course, conjugate(climb)),
            climb,
            turn: [
                times(sum_half, sum_half),
                times(difference_half, difference_half),
                times(climb_half, climb_half),
            ],
            shift: [
                mean(half_course + half_climb, sum_half, 0.5 * scale),
                mean(half_course - half_climb, difference_half, 0.5 * scale),
                mean(half_climb, climb_half, scale),
            ],
        }
    }

    /// The state now.
    pub const fn state(&self) -> &MotionState {
        &self.state
    }

    /// The velocity now, metres per second.
    pub fn velocity_mps(&self) -> Vec3 {
        let half = 0.5 * self.airspeed_mps;
        Vec3::new(
            half * (self.sum.0 + self.difference.0),
            half * (self.sum.1 + self.difference.1),
            self.airspeed_mps * self.climb.1,
        )
    }

    /// Goes one step on.
    pub fn advance(&mut self) {
        let [sum_shift, difference_shift, climb_shift] = self.shift;
        let sum = times(self.sum, sum_shift);
        let difference = times(self.difference, difference_shift);
        let climb = times(self.climb, climb_shift);
        self.state.position_m += Vec3::new(sum.0 + difference.0, sum.1 + difference.1, climb.1);
        let [sum_turn, difference_turn, climb_turn] = self.turn;
        self.sum = times(self.sum, sum_turn);
        self.difference = times(self.difference, difference_turn);
        self.climb = times(self.climb, climb_turn);
        self.state.time_s += self.step_s;
        self.state.course_rad += self.course_step_rad;
        self.state.climb_rad += self.climb_step_rad;
    }
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
