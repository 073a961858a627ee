//! Several obstacles as one larger volume (§3.4.4, Fig. 10 and 11).

use crate::conflict::{Relative, threatens};
use fga::Vec3;
use fga::certificate::{Extent, Hazard};
use fga::situation::{Ownship, ProtectedVolume};

/// The number of volumes on the aircraft's straight path (§3.4.4).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathOverlap {
    /// None: there is nothing to avoid.
    None,
    /// Case 2: only the one at this index; the others do not matter.
    One(usize),
    /// Case 1: this many, at least two.
    Several(usize),
}

/// Which of the two cases of §3.4.4 it is. Obstacles with a number that is not finite do not count.
pub fn path_overlap(ownship: &Ownship, obstacles: &[Hazard]) -> PathOverlap {
    let mut on_path = obstacles
        .iter()
        .enumerate()
        .filter(|(_, obstacle)| {
            Relative::of(ownship, obstacle).is_some_and(|r| threatens(&r, &obstacle.volume))
        })
        .map(|(index, _)| index);
    match (on_path.next(), on_path.count()) {
        (None, _) => PathOverlap::None,
        (Some(index), 0) => PathOverlap::One(index),
        (Some(_), others) => PathOverlap::Several(others + 1),
    }
}

/// Replaces obstacles whose volumes leave a gap of at most `gap_m` between them, and which move
/// together, by one that contains both (Fig. 10(b): a single obstacle with a larger `d_e`), until
/// no such pair is left. Returns the number of the remaining ones, at the front of the slice, in the order
/// of their first members; the rest of the slice has no meaning.
///
/// Two spheres become the smallest sphere about both; otherwise the result is an upright cylinder.
/// The merged obstacle keeps the lower identifier and the faster growth. Velocities may differ by
/// `same_velocity_mps`; it keeps their mean. Invalid obstacles stay as they are.
pub fn merge_overlapping(obstacles: &mut [Hazard], gap_m: f64, same_velocity_mps: f64) -> usize {
    let mut len = obstacles.len();
    loop {
        let live = obstacles.get(..len).unwrap_or(&[]);
        let Some((first, second, merged)) = mergeable(live, gap_m, same_velocity_mps) else {
            return len;
        };
        if let Some(slot) = obstacles.get_mut(first) {
            *slot = merged;
        }
        if let Some(tail) = obstacles.get_mut(second..len) {
            tail.rotate_left(1);
        }
        len -= 1;
    }
}

fn mergeable(
    obstacles: &[Hazard],
    gap_m: f64,
    same_velocity_mps: f64,
) -> Option<(usize, usize, Hazard)> {
    for (first, one) in obstacles.iter().enumerate() {
        for (second, other) in obstacles.iter().enumerate().skip(first + 1) {
            let together = one.is_valid()
                && other.is_valid()
                && one.velocity_mps.distance(other.velocity_mps) <= same_velocity_mps
                && gap_between_m(one, other) <= gap_m;
            if together {
                return Some((first, second, merged(one, other)));
            }
        }
    }
    None
}

/// Gap between two volumes, metres; negative if they overlap. Exact for two spheres and for two
/// cylinders; a sphere beside a cylinder counts as the cylinder about it.
fn gap_between_m(one: &Hazard, other: &Hazard) -> f64 {
    let offset = other.position_m - one.position_m;
    let radii = one.volume.radius_m() + other.volume.radius_m();
    match (one.volume, other.volume) {
        (ProtectedVolume::Sphere { .. }, ProtectedVolume::Sphere { .. }) => offset.length() - radii,
        _ => ProtectedVolume::Cylinder {
            radius_m: radii,
            half_height_m: one.volume.half_height_m() + other.volume.half_height_m(),
        }
        .margin_m(offset),
    }
}

/// Centre and half width of the smallest interval, disc or sphere about two.
fn enclose(offset_m: f64, one_m: f64, other_m: f64) -> (f64, f64) {
    if offset_m + other_m <= one_m {
        (0.0, one_m)
    } else if offset_m + one_m <= other_m {
        (offset_m, other_m)
    } else {
        let radius_m = (offset_m + one_m + other_m) / 2.0;
        (radius_m - one_m, radius_m)
    }
}

fn merged(one: &Hazard, other: &Hazard) -> Hazard {
    let offset = other.position_m - one.position_m;
    let (volume, shift) = match (one.volume, other.volume) {
        (ProtectedVolume::Sphere { radius_m: a }, ProtectedVolume::Sphere { radius_m: b }) => {
            let (along_m, radius_m) = enclose(offset.length(), a, b);
            let shift = offset.normalize_or_zero() * along_m;
            (ProtectedVolume::Sphere { radius_m }, shift)
        }
        (a, b) => {
            let level = Vec3::new(offset.x, offset.y, 0.0);
            let (along_m, radius_m) = enclose(level.length(), a.radius_m(), b.radius_m());
            let (rise_m, half_height_m) =
                enclose(offset.z.abs(), a.half_height_m(), b.half_height_m());
            let up = if offset.z < 0.0 { -rise_m } else { rise_m };
            let shift = level.normalize_or_zero() * along_m + Vec3::Z * up;
            let volume = ProtectedVolume::Cylinder {
                radius_m,
                half_height_m,
            };
            (volume, shift)
        }
    };
    let extent = Extent {
        position_m: one.position_m + shift,
        velocity_mps: (one.velocity_mps + other.velocity_mps) / 2.0,
        volume,
        growth_mps: one.growth_mps.max(other.growth_mps),
        stretch_m: (
            one.stretch_m.0.max(other.stretch_m.0),
            one.stretch_m.1.max(other.stretch_m.1),
        ),
        window_s: (
            one.window_s.0.min(other.window_s.0),
            one.window_s.1.max(other.window_s.1),
        ),
        allowed_depth_m: one.allowed_depth_m.min(other.allowed_depth_m),
    };
    Hazard::compared(one.id().min(other.id()), extent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    fn sphere(id: u32, x: f64, y: f64, radius_m: f64) -> Hazard {
        let volume = ProtectedVolume::Sphere { radius_m };
        Hazard::exact(id, Vec3::new(x, y, 0.0), Vec3::ZERO, volume)
    }

    fn ownship() -> Ownship {
        Ownship {
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: 15.0,
        }
    }

    /// Fig. 10: two spheres of 30 m whose centres lie 50 m apart fit into one of 55 m midway.
    #[test]
    fn case_1_is_one_larger_obstacle() {
        let mut obstacles = [
            sphere(2, 200.0, 25.0, 30.0),
            sphere(3, 200.0, 400.0, 30.0),
            sphere(1, 200.0, -25.0, 30.0),
        ];
        assert_eq!(
            path_overlap(&ownship(), &obstacles),
            PathOverlap::Several(2)
        );
        assert_eq!(merge_overlapping(&mut obstacles, 0.0, 0.0), 2);
        let merged = obstacles[0];
        assert_eq!(merged.id(), 1);
        assert!(merged.position_m.distance(Vec3::X * 200.0) < 1e-9);
        assert!((merged.volume.radius_m() - 55.0).abs() < 1e-12);
        assert_eq!(obstacles[1].id(), 3);
        assert_eq!(
            path_overlap(&ownship(), &obstacles[..2]),
            PathOverlap::One(0)
        );
    }

    /// Fig. 11: only one lies on the path.
    #[test]
    fn case_2_is_the_one_on_the_path() {
        let obstacles = [sphere(1, 200.0, 80.0, 30.0), sphere(2, 300.0, 5.0, 30.0)];
        assert_eq!(path_overlap(&ownship(), &obstacles), PathOverlap::One(1));
        assert_eq!(path_overlap(&ownship(), &obstacles[..1]), PathOverlap::None);
    }

    #[test]
    fn obstacles_that_move_apart_are_not_merged() {
        let mut obstacles = [sphere(1, 200.0, 0.0, 30.0), sphere(2, 210.0, 0.0, 30.0)];
        let moves = obstacles[1];
        obstacles[1] = Hazard::exact(2, moves.position_m, Vec3::Y * 5.0, moves.volume);
        assert_eq!(merge_overlapping(&mut obstacles, 0.0, 0.1), 2);
    }

    #[test]
    fn the_lower_identifier_and_the_faster_growth_stay() {
        let mut obstacles = [sphere(8, 0.0, 0.0, 30.0), sphere(7, 1.0, 0.0, 5.0)];
        obstacles[1] = obstacles[1].growing(4.0);
        assert_eq!(merge_overlapping(&mut obstacles, 0.0, 0.0), 1);
        assert_eq!((obstacles[0].id(), obstacles[0].growth_mps), (7, 4.0));
        // The smaller one lies within the larger one, which stays as it is.
        assert_eq!(obstacles[0].volume.radius_m(), 30.0);
    }

    proptest! {
        /// Every point of every volume lies in one of the merged volumes.
        #[test]
        fn nothing_gets_lost(
            rows in proptest::collection::vec((-100.0..100.0f64, -100.0..100.0f64, -50.0..50.0f64, 1.0..40.0f64, 1.0..40.0f64, any::<bool>()), 1..8),
            gap in 0.0..20.0f64,
        ) {
            let before: Vec<Hazard> = (0..).zip(&rows).map(|(id, (x, y, z, a, b, ball))| {
                let volume = if *ball {
                    ProtectedVolume::Sphere { radius_m: *a }
                } else {
                    ProtectedVolume::Cylinder { radius_m: *a, half_height_m: *b }
                };
                Hazard::exact(id, Vec3::new(*x, *y, *z), Vec3::ZERO, volume)
            }).collect();
            let mut after = before.clone();
            let len = merge_overlapping(&mut after, gap, 0.0);
            for obstacle in &before {
                let (r, h) = (obstacle.volume.radius_m(), obstacle.volume.half_height_m());
                let ball = matches!(obstacle.volume, ProtectedVolume::Sphere { .. });
                for i in 0..200 {
                    let turn = f64::from(i) * 0.7;
                    let up = f64::from(i % 11) / 5.0 - 1.0;
                    let width = if ball { r * f64::sqrt(1.0 - up * up) } else { r };
                    let height = if ball { r } else { h };
                    let point = obstacle.position_m
                        + Vec3::new(width * f64::cos(turn), width * f64::sin(turn), height * up);
                    let held = after[..len].iter().any(|o| o.volume.margin_m(point - o.position_m) < 1e-6);
                    prop_assert!(held);
                }
            }
        }
    }
}
