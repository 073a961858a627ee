//! A cylinder: closer than a distance and a height at once.

use crate::aircraft::Pair;
use crate::almost::Closeness;
use crate::loss::Loss;
use crate::plane::{Crossing, same_velocity};
use crate::volume::approach::{Approach, Surroundings};

/// A cylinder, its flat sides level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// Horizontal distance, metres.
    pub radius_m: f64,
    /// Vertical distance, metres.
    pub half_height_m: f64,
}

const FOOT_M: f64 = 0.3048;
const NAUTICAL_MILE_M: f64 = 1852.0;

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

    pub(super) const fn reach(&self) -> Surroundings {
        Surroundings {
            square_m2: self.radius_m * self.radius_m,
            height_m: self.half_height_m,
            tau_s: Some(0.0),
            coaltitude_s: 0.0,
        }
    }

    #[inline]
    pub(super) fn window(&self, approach: &Approach, pair: impl FnOnce() -> Pair) -> Loss {
        let reach_m2 = self.radius_m * self.radius_m;
        let is_inside = Closeness::Rounding.less(approach.square_m2, reach_m2);
        if !is_inside && approach.room(reach_m2) <= 0.0 {
            return Loss::NEVER;
        }
        let pair = pair();
        let (own, other) = (pair.ownship.velocity_mps, pair.intruder.velocity_mps);
        let stays = is_inside && same_velocity(own.truncate(), other.truncate());
        let crosses = approach.room(reach_m2) > 0.0;
        if !stays && !crosses {
            return Loss::NEVER;
        }
        let (height_m, climb_mps) = (approach.height_m, approach.climb_mps);
        let vertical = if !Closeness::Rounding.same(own.z, other.z) {
            Loss::new(
                slab_crossing_s(height_m, climb_mps, self.half_height_m, Crossing::Entry),
                slab_crossing_s(height_m, climb_mps, self.half_height_m, Crossing::Exit),
            )
        } else if Closeness::Rounding.less(height_m.abs(), self.half_height_m) {
            Loss::ALWAYS
        } else {
            return Loss::NEVER;
        };
        if stays {
            return vertical;
        }
        approach
            .crossings_s(reach_m2)
            .map_or(Loss::NEVER, |(entry_s, exit_s)| {
                Loss::new(entry_s, exit_s).and(vertical)
            })
    }

    pub(super) fn violation(&self, pair: &Pair, from_s: f64, to_s: f64) -> Loss {
        if from_s < 0.0 || from_s >= to_s {
            return Loss::NEVER;
        }
        self.window(&Approach::of(&pair.ownship, &pair.intruder), || *pair)
            .and(Loss::new(from_s, to_s))
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
