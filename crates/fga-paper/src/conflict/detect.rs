//! Algorithm 1, corrected: which of the obstacles threaten.

use super::{Conflict, Relative, assess};
use fga::Vec3;
use fga::certificate::Hazard;
use fga::situation::{Ownship, ProtectedVolume};

/// A threatening obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detection {
    /// Its index in the searched slice.
    pub index: usize,
    /// Its geometry seen from the aircraft.
    pub relative: Relative,
    /// [`Conflict::Inside`] or [`Conflict::Threat`].
    pub conflict: Conflict,
}

/// Whether the path is, or will be, inside the volume: the decision of [`assess`] without its numbers.
#[inline]
pub fn threatens(relative: &Relative, volume: &ProtectedVolume) -> bool {
    match *volume {
        ProtectedVolume::Sphere { radius_m } => {
            let (r, v) = (relative.position_m(), relative.velocity_mps());
            let squared = radius_m * radius_m;
            if r.length_squared() < squared {
                return true;
            }
            r.dot(v) > 0.0 && r.cross(v).length_squared() < squared * v.length_squared()
        }
        ProtectedVolume::Cylinder { .. } => {
            super::inside_during(relative, volume).is_some_and(|(_, exit_s)| exit_s > 0.0)
        }
    }
}

/// The obstacles within `radius_m` (R, infinity allowed) that threaten, in their order (Alg. 1).
///
/// An obstacle with a number that is not finite does not count: check [`Obstacle::is_valid`](fga::situation::Obstacle::is_valid) where
/// obstacles enter.
pub fn detect<'a>(
    ownship: &'a Ownship,
    obstacles: &'a [Hazard],
    radius_m: f64,
) -> impl Iterator<Item = Detection> + 'a {
    let position_m = ownship.position_m;
    let velocity_mps = ownship.velocity_mps();
    let radius_squared = radius_m * radius_m;
    obstacles
        .iter()
        .enumerate()
        .filter(move |(_, obstacle)| {
            let r = obstacle.position_m - position_m;
            let v = velocity_mps - obstacle.velocity_mps;
            may_threaten(r, v, &obstacle.volume, radius_squared)
        })
        .filter_map(move |(index, obstacle)| {
            let r = obstacle.position_m - position_m;
            let relative = Relative::new(r, velocity_mps - obstacle.velocity_mps)?;
            threatens(&relative, &obstacle.volume).then(|| Detection {
                index,
                relative,
                conflict: assess(&relative, &obstacle.volume),
            })
        })
}

/// Whether the sphere about the volume is near enough, and the path is or will be inside: false only if
/// the volume itself cannot threaten. Computes everything without a branch.
#[expect(
    clippy::needless_bitwise_bool,
    reason = "a branch costs more than the products"
)]
#[inline]
fn may_threaten(r: Vec3, v: Vec3, volume: &ProtectedVolume, radius_squared: f64) -> bool {
    let bounding_squared = match *volume {
        ProtectedVolume::Sphere { radius_m } => radius_m * radius_m,
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => radius_m * radius_m + half_height_m * half_height_m,
    };
    let distance_squared = r.length_squared();
    let near = distance_squared <= radius_squared;
    let inside = distance_squared < bounding_squared;
    let closing = r.dot(v) > 0.0;
    let crossing = r.cross(v).length_squared() < bounding_squared * v.length_squared();
    near & (inside | (closing & crossing))
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    fn ownship() -> Ownship {
        Ownship {
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: 15.0,
        }
    }

    #[test]
    fn only_what_closes_within_the_radius_is_reported() {
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        let at = |x: f64, y: f64, vx: f64| {
            Hazard::exact(0, Vec3::new(x, y, 0.0), Vec3::new(vx, 0.0, 0.0), volume)
        };
        let obstacles = [
            at(200.0, 0.0, 0.0),
            at(-200.0, 0.0, 0.0),
            at(-200.0, 5.0, 40.0),
            at(200.0, 31.0, 0.0),
            at(400.0, 0.0, 0.0),
            at(10.0, 0.0, 15.0),
            at(f64::NAN, 0.0, 0.0),
            at(200.0, 0.0, 20.0),
        ];
        let found: Vec<usize> = detect(&ownship(), &obstacles, 300.0)
            .map(|d| d.index)
            .collect();
        assert_eq!(found, [0, 2, 5]);
        assert_eq!(detect(&ownship(), &obstacles, f64::INFINITY).count(), 4);
    }

    proptest! {
        /// The scan agrees with a check of each obstacle.
        #[test]
        fn the_scan_is_each_decision(
            rows in proptest::collection::vec((-300.0..300.0f64, -300.0..300.0f64, -80.0..80.0f64, -40.0..40.0f64, -40.0..40.0f64, any::<bool>()), 0..30),
            radius in 50.0..500.0f64,
        ) {
            let obstacles: Vec<Hazard> = rows.iter().map(|(x, y, z, vx, vy, ball)| {
                let volume = if *ball {
                    ProtectedVolume::Sphere { radius_m: 30.0 }
                } else {
                    ProtectedVolume::Cylinder { radius_m: 50.0, half_height_m: 20.0 }
                };
                Hazard::exact(0, Vec3::new(*x, *y, *z), Vec3::new(*vx, *vy, 1.0), volume)
            }).collect();
            let scanned: Vec<usize> = detect(&ownship(), &obstacles, radius).map(|d| d.index).collect();
            let each: Vec<usize> = (0..obstacles.len()).filter(|i| {
                let relative = Relative::of(&ownship(), &obstacles[*i]).unwrap();
                relative.distance_m() <= radius && assess(&relative, &obstacles[*i].volume).is_threat()
            }).collect();
            prop_assert_eq!(scanned, each);
        }

        #[test]
        fn the_quick_decision_is_the_full_one(
            r in [-300.0..300.0f64, -300.0..300.0, -80.0..80.0],
            v in [-40.0..40.0f64, -40.0..40.0, -8.0..8.0],
            radius_m in 1.0..150.0f64, half_height_m in 1.0..60.0f64, ball: bool,
        ) {
            let volume = if ball {
                ProtectedVolume::Sphere { radius_m }
            } else {
                ProtectedVolume::Cylinder { radius_m, half_height_m }
            };
            let relative = Relative::new(Vec3::from_array(r), Vec3::from_array(v)).unwrap();
            let conflict = assess(&relative, &volume);
            prop_assume!(conflict.margin_m().abs() > 1e-9);
            prop_assert_eq!(threatens(&relative, &volume), conflict.is_threat());
        }
    }
}
