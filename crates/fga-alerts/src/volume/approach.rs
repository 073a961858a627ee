//! What a volume asks of two straight lines, computed once for every volume.

use crate::aircraft::State;
use crate::plane::{cross, half_roots};
use glam::DVec2;

/// How the ownship's line approaches the intruder's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Approach {
    /// Squared horizontal distance now, m².
    pub(crate) square_m2: f64,
    /// Position times velocity in the plane, m²/s: negative while they converge.
    pub(crate) closing_m2ps: f64,
    /// Squared horizontal relative speed, m²/s².
    pub(crate) speed2_m2ps2: f64,
    /// Squared cross product of position and velocity in the plane, m⁴/s².
    moment2: f64,
    /// Height of the ownship above the intruder, metres.
    pub(crate) height_m: f64,
    /// Its climb relative to the intruder, m/s.
    pub(crate) climb_mps: f64,
}

/// A circle and a height: outside of either a volume is not violated, unless time counts too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reach {
    /// Squared horizontal distance, m².
    pub(crate) square_m2: f64,
    /// Vertical distance, metres.
    pub(crate) height_m: f64,
    /// Modified tau, seconds, that violates too; `None` where another time does.
    pub(crate) tau_s: Option<f64>,
}

/// A part of a size that rounding cannot make.
const MARGIN: f64 = 1e-9;

/// A slower relative motion may count as rest, metres per second.
const LEAST_MPS: f64 = 1e-3;

impl Approach {
    #[inline]
    pub(crate) fn of(ownship: &State, intruder: &State) -> Self {
        let offset_m = ownship.position_m - intruder.position_m;
        let relative_mps = ownship.velocity_mps - intruder.velocity_mps;
        Self {
            height_m: offset_m.z,
            climb_mps: relative_mps.z,
            ..Self::in_plane(offset_m.truncate(), relative_mps.truncate())
        }
    }

    /// The horizontal part alone.
    #[inline]
    pub(crate) fn in_plane(s: DVec2, v: DVec2) -> Self {
        let moment = cross(s, v);
        Self {
            square_m2: s.length_squared(),
            closing_m2ps: s.dot(v),
            speed2_m2ps2: v.length_squared(),
            moment2: moment * moment,
            height_m: 0.0,
            climb_mps: 0.0,
        }
    }

    /// Whether every number is finite: no line is judged that cannot be flown.
    #[inline]
    pub(crate) fn is_finite(&self) -> bool {
        // A sum with a number that is not finite is not finite.
        (self.square_m2 + self.closing_m2ps + self.speed2_m2ps2 + self.height_m + self.climb_mps)
            .is_finite()
    }

    /// Room left inside a circle at the closest approach, times the squared speed: positive where
    /// the line crosses the circle, zero where it touches.
    #[inline]
    pub(crate) fn room(&self, reach_m2: f64) -> f64 {
        reach_m2 * self.speed2_m2ps2 - self.moment2
    }

    /// Whether the line stays out of a circle from now on: it leads away, or misses it.
    #[inline]
    pub(crate) fn passes_by(&self, reach_m2: f64) -> bool {
        self.square_m2 > reach_m2 && (self.closing_m2ps > 0.0 || self.room(reach_m2) < 0.0)
    }

    /// Whether an ownship that comes onto the line at a time, not before now, surely meets nothing within a reach
    /// any more: it is outside and leads away, in the plane or in height.
    ///
    /// The margins exceed the rounding of the times at which the line leaves the reach: these come from the roots
    /// of the same squares, each rounded to 1e-16 of its size.
    #[inline]
    pub(crate) fn is_over(&self, since_s: f64, reach: &Reach) -> bool {
        if self.passes_by(reach.square_m2) {
            return true;
        }
        let (turn, grown_m2) = (
            self.speed2_m2ps2 * since_s,
            (2.0 * self.closing_m2ps + self.speed2_m2ps2 * since_s) * since_s,
        );
        let size_m2 = self.square_m2 + turn * since_s;
        let leads_away =
            self.closing_m2ps + turn > 0.0 && self.speed2_m2ps2 > LEAST_MPS * LEAST_MPS;
        if leads_away && self.square_m2 + grown_m2 > reach.square_m2 + MARGIN * size_m2 {
            return true;
        }
        let climbed_m = self.climb_mps * since_s;
        let height_m = self.height_m + climbed_m;
        let size_m = self.height_m.abs() + climbed_m.abs() + reach.height_m;
        height_m * self.climb_mps > 0.0
            && self.climb_mps.abs() > LEAST_MPS
            && height_m.abs() > reach.height_m + MARGIN * size_m
    }

    /// Whether the line surely meets nothing within a reach until a time: it converges all that time, and neither
    /// the distance nor the modified tau come down to the reach.
    ///
    /// Both are violated where `s² + τ (s · v) ≤ D²`. The left side is a parabola in time: at that time it must still
    /// fall, and still exceed D². [`Approach::is_over`] explains the margin.
    #[inline]
    pub(crate) fn is_later(&self, until_s: f64, reach: &Reach) -> bool {
        let Some(tau_s) = reach.tau_s else {
            return false;
        };
        let a = self.speed2_m2ps2;
        let b = 2.0 * self.closing_m2ps + tau_s * a;
        let square_m2 = a * until_s * until_s;
        let value_m2 =
            self.square_m2 + tau_s * self.closing_m2ps - reach.square_m2 + b * until_s + square_m2;
        let closing_m2 = self.closing_m2ps.abs() * (until_s + tau_s);
        let size_m2 =
            self.square_m2 + reach.square_m2 + closing_m2 + tau_s * a * until_s + square_m2;
        2.0 * a * until_s + b < 0.0
            && a > LEAST_MPS * LEAST_MPS
            && value_m2 > 4.0 * MARGIN * size_m2
    }

    /// When the line enters and leaves a circle, seconds; `None` where it never does.
    #[inline]
    pub(crate) fn crossings_s(&self, reach_m2: f64) -> Option<(f64, f64)> {
        half_roots(
            self.speed2_m2ps2,
            self.closing_m2ps,
            self.square_m2 - reach_m2,
        )
    }
}
