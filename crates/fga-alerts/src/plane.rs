//! Relative motion in the horizontal plane: closest approach and the crossing of a circle.
//!
//! `s` is the ownship's position relative to the intruder, `v` its relative velocity, both
//! constant-velocity, x east and y north, metres and metres per second.

use crate::almost::Closeness;
use crate::loss::Loss;
use glam::DVec2;

/// A crossing of a boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Crossing {
    /// The earlier one, inwards.
    Entry,
    /// The later one, outwards.
    Exit,
}

impl Crossing {
    pub(crate) const fn sign(self) -> f64 {
        match self {
            Self::Entry => -1.0,
            Self::Exit => 1.0,
        }
    }
}

/// `v × s` as a number: positive where `b` is anticlockwise of `a`.
#[inline]
pub(crate) fn cross(a: DVec2, b: DVec2) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Time of the horizontal closest approach, seconds, negative in the past; `None` without
/// relative motion.
pub(crate) fn time_to_closest_s(s: DVec2, v: DVec2) -> Option<f64> {
    (v != DVec2::ZERO).then(|| -s.dot(v) / v.length_squared())
}

/// The room inside a circle of this radius at the closest approach, times the squared speed:
/// positive if the straight line crosses the circle, zero if it touches.
pub(crate) fn room(s: DVec2, v: DVec2, radius_m: f64) -> f64 {
    let moment = cross(s, v);
    radius_m * radius_m * v.length_squared() - moment * moment
}

/// When the straight line crosses the circle, seconds; `None` if it never does.
pub(crate) fn circle_crossing_s(
    s: DVec2,
    v: DVec2,
    radius_m: f64,
    crossing: Crossing,
) -> Option<f64> {
    half_root(
        v.length_squared(),
        s.dot(v),
        s.length_squared() - radius_m * radius_m,
        crossing,
    )
}

/// Between which times the straight line is inside the circle, seconds; `None` if it never is.
pub(crate) fn circle_crossings(s: DVec2, v: DVec2, radius_m: f64) -> Option<Loss> {
    let at = |crossing| circle_crossing_s(s, v, radius_m, crossing);
    Some(Loss::new(at(Crossing::Entry)?, at(Crossing::Exit)?))
}

/// Root of `a t² + 2 b t + c`.
pub(crate) fn half_root(a: f64, b: f64, c: f64, crossing: Crossing) -> Option<f64> {
    if a == 0.0 {
        return (b != 0.0).then(|| -c / (2.0 * b));
    }
    let (square, product) = (b * b, a * c);
    (Closeness::Rounding.same(square, product) || square > product)
        .then(|| (-b + crossing.sign() * libm::sqrt((square - product).max(0.0))) / a)
}

/// Root of `a t² + b t + c`.
pub(crate) fn root(a: f64, b: f64, c: f64, crossing: Crossing) -> Option<f64> {
    if a == 0.0 {
        return (b != 0.0).then(|| -c / b);
    }
    let (square, product) = (b * b, 4.0 * a * c);
    (Closeness::Rounding.same(square, product) || square > product)
        .then(|| (-b + crossing.sign() * libm::sqrt((square - product).max(0.0))) / (2.0 * a))
}

/// Whether two velocities count as one, component by component.
#[inline]
pub(crate) fn same_velocity(a: DVec2, b: DVec2) -> bool {
    Closeness::Rounding.same(a.x, b.x) && Closeness::Rounding.same(a.y, b.y)
}

/// Modified time to the circle `DMOD`, seconds: `(DMOD² − |s|²) / (s · v)`; `None` where the
/// aircraft do not converge.
///
/// Source: RTCA DO-365B, appendix on the DAA well clear; Muñoz et al., "A Family of Well-Clear
/// Boundary Models for the Integration of UAS in the NAS", AIAA 2014-2412.
pub(crate) fn modified_tau_s(s: DVec2, v: DVec2, radius_m: f64) -> Option<f64> {
    let closing = s.dot(v);
    (closing < 0.0).then(|| (radius_m * radius_m - s.length_squared()) / closing)
}
