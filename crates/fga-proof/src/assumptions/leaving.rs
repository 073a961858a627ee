//! A volume that the aircraft is in.

use crate::Vec3;
use crate::certificate::{Assumption, Hazard};
use crate::situation::{Obstacle, ProtectedVolume};

/// How near to the centre of a volume the aircraft may come again while leaving it, as a share of its offset.
pub const LEAVING_SHARE: f64 = 0.98;

impl Hazard {
    /// Makes the volume of an obstacle smaller for an aircraft at an offset in it, metres.
    pub(super) fn leave(&mut self, obstacle: &Obstacle, offset_m: Vec3) {
        self.stands_for = self.stands_for.max(Assumption::Leaving);
        if obstacle.volume.margin_m(offset_m) < 0.0 && self.is_cylinder() {
            self.extent.allowed_depth_m = 0.0;
            let nearer_m = self.position_m + LEAVING_SHARE * offset_m;
            self.extent.allowed_depth_m = -self.margin_m(nearer_m, 0.0);
        } else {
            self.extent.volume = relaxed(&self.volume, &obstacle.volume, offset_m);
        }
    }
}

/// A sphere around the aircraft, or a widened cylinder around it that it has not entered itself, shrunk so that
/// the aircraft is just outside: a manoeuvre certified against it leads out. While the aircraft is outside of the
/// volume itself, the result is at least as large as that one.
fn relaxed(widened: &ProtectedVolume, itself: &ProtectedVolume, offset_m: Vec3) -> ProtectedVolume {
    let (true_m, true_half_m) = (itself.radius_m(), itself.half_height_m());
    let (mut radius_m, mut half_m) = (widened.radius_m(), widened.half_height_m());
    if let ProtectedVolume::Sphere { .. } = widened {
        let distance_m = offset_m.length();
        let least_m = if distance_m >= true_m { true_m } else { 0.0 };
        radius_m = (LEAVING_SHARE * distance_m).max(least_m);
    } else {
        let (aside_m, above_m) = (offset_m.truncate().length(), offset_m.z.abs());
        let share = (aside_m / radius_m).max(above_m / half_m);
        radius_m = (LEAVING_SHARE * share * radius_m).max(true_m);
        half_m = (LEAVING_SHARE * share * half_m).max(true_half_m);
        // Being beyond either of the two keeps it outside.
        if aside_m >= true_m {
            radius_m = radius_m.min(LEAVING_SHARE * aside_m).max(true_m);
        } else {
            half_m = half_m.min(LEAVING_SHARE * above_m).max(true_half_m);
        }
    }
    widened.resized(radius_m, half_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An earlier version used a volume smaller than the true one when the aircraft was outside of the volume
    /// itself but inside its widened one, near the surface.
    #[test]
    fn a_relaxed_volume_is_as_large_as_the_true_one_until_that_is_entered() {
        let places = [
            Vec3::new(30.1, 0.0, 0.0),
            Vec3::new(0.0, 31.0, 9.0),
            Vec3::new(3.0, 4.0, 10.05),
            Vec3::new(29.0, 0.0, 11.0),
            Vec3::new(38.0, 0.0, 9.9),
        ];
        let cylinder = ProtectedVolume::Cylinder {
            radius_m: 30.0,
            half_height_m: 10.0,
        };
        let sphere = ProtectedVolume::Sphere { radius_m: 30.0 };
        for offset_m in places {
            for itself in [cylinder, sphere] {
                let widened = itself.grown(12.0);
                if itself.margin_m(offset_m) < 0.0 || widened.margin_m(offset_m) >= 0.0 {
                    continue;
                }
                let shrunk = relaxed(&widened, &itself, offset_m);
                assert!(shrunk.radius_m() >= itself.radius_m(), "{shrunk:?}");
                assert!(
                    shrunk.half_height_m() >= itself.half_height_m(),
                    "{shrunk:?}"
                );
                assert!(shrunk.margin_m(offset_m) >= 0.0, "{shrunk:?} {offset_m}");
            }
        }
    }
}
