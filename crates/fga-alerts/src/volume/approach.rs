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
