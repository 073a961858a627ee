//! A cylinder: closer than a distance and a height at once.

use crate::aircraft::Pair;
use crate::almost::Closeness;
use crate::loss::Loss;
use crate::plane::{Crossing, circle_crossings, room, same_velocity};
use crate::units::{FOOT_M, NAUTICAL_MILE_M};

/// A cylinder, its flat sides level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// Horizontal distance, metres.
    pub radius_m: f64,
    /// Vertical distance, metres.
    pub half_height_m: f64,
}

impl Cylinder {
    /// Near mid-air collision: 500 ft and 100 ft (RTCA SC-147).
    pub const NMAC: Self = Self::new(500.0 * FOOT_M, 100.0 * FOOT_M);
    /// Well clear of ASTM F3442: 2,000 ft and 250 ft.
    pub const F3442: Self = Self::new(2000.0 * FOOT_M, 250.0 * FOOT_M);
    /// Separation of controlled traffic, as in CD3D: 5 nmi and 1,000 ft.
    pub const CD3D: Self = Self::new(5.0 * NAUTICAL_MILE_M, 1000.0 * FOOT_M);

    /// A cylinder from its distances, metres.
    pub const fn new(radius_m: f64, half_height_m: f64) -> Self {
        Self {
            radius_m,
            half_height_m,
        }
    }

    /// Whether the volume is violated now.
    pub fn is_violated(&self, pair: &Pair) -> bool {
        let (s, _) = pair.plane();
        let (height_m, _) = pair.vertical();
        s.length_squared() < self.radius_m * self.radius_m && height_m.abs() < self.half_height_m
    }

    /// The whole violation, seconds from now.
    pub(super) fn window(&self, pair: &Pair) -> Loss {
        let ((s, v), (height_m, climb_mps)) = (pair.plane(), pair.vertical());
        let (own, other) = (pair.ownship.velocity_mps, pair.intruder.velocity_mps);
        let is_inside = Closeness::Rounding.less(s.length_squared(), self.radius_m * self.radius_m);
        let stays = is_inside && same_velocity(own.truncate(), other.truncate());
        if !stays && room(s, v, self.radius_m) <= 0.0 {
            return Loss::NEVER;
        }
        let vertical = if !Closeness::Rounding.same(own.z, other.z) {
            let at = |crossing| slab_crossing_s(height_m, climb_mps, self.half_height_m, crossing);
            Loss::new(at(Crossing::Entry), at(Crossing::Exit))
        } else if Closeness::Rounding.less(height_m.abs(), self.half_height_m) {
            Loss::ALWAYS
        } else {
            return Loss::NEVER;
        };
        if stays {
            return vertical;
        }
        circle_crossings(s, v, self.radius_m).map_or(Loss::NEVER, |plane| plane.and(vertical))
    }

    pub(super) fn violation(&self, pair: &Pair, from_s: f64, to_s: f64) -> Loss {
        if from_s < 0.0 || from_s >= to_s {
            return Loss::NEVER;
        }
        self.window(pair).and(Loss::new(from_s, to_s))
    }
}

/// When a height crosses a slab of this half height, seconds; `climb_mps` is not zero.
pub(super) fn slab_crossing_s(
    height_m: f64,
    climb_mps: f64,
    half_height_m: f64,
    crossing: Crossing,
) -> f64 {
    let direction = if climb_mps >= 0.0 { 1.0 } else { -1.0 };
    (crossing.sign() * direction * half_height_m - height_m) / climb_mps
}
