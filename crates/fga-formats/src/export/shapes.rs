//! Outlines of protected volumes.

use core::f64::consts::{PI, TAU};
use fga::Vec3;
use fga::situation::ProtectedVolume;

/// Corners of the polygons that stand for a circle.
pub(super) const CORNERS: u32 = 24;

/// A horizontal circle about `centre`, closed (the first corner again at the end), anticlockwise
/// from above. The polygon circumscribes the circle.
pub(super) fn circle(centre: Vec3, radius_m: f64) -> Vec<Vec3> {
    ring(centre, radius_m / libm::cos(PI / f64::from(CORNERS)))
}

fn ring(centre: Vec3, radius_m: f64) -> Vec<Vec3> {
    (0..=CORNERS)
        .map(|corner| {
            let angle = TAU * f64::from(corner % CORNERS) / f64::from(CORNERS);
            let (sin, cos) = libm::sincos(angle);
            centre + Vec3::new(radius_m * cos, radius_m * sin, 0.0)
        })
        .collect()
}

/// The surface of a volume as closed polygons. The lid, floor and wall of a cylinder enclose it; the
/// bands of a sphere (`bands` circles) have their corners on the surface.
pub(super) fn surface(centre: Vec3, volume: ProtectedVolume, bands: u32) -> Vec<Vec<Vec3>> {
    match volume {
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => {
            let lid = circle(centre + Vec3::Z * half_height_m, radius_m);
            let floor = circle(centre - Vec3::Z * half_height_m, radius_m);
            let mut polygons = wall(&floor, &lid);
            polygons.push(lid);
            polygons.push(floor.into_iter().rev().collect());
            polygons
        }
        ProtectedVolume::Sphere { radius_m } => {
            let rings: Vec<Vec<Vec3>> = (0..=bands)
                .map(|band| {
                    let (sin, cos) =
                        libm::sincos(PI * f64::from(band) / f64::from(bands) - PI / 2.0);
                    ring(centre + Vec3::Z * (radius_m * sin), radius_m * cos)
                })
                .collect();
            rings
                .iter()
                .zip(rings.iter().skip(1))
                .flat_map(|(lower, upper)| wall(lower, upper))
                .collect()
        }
    }
}

/// The quadrilaterals between two rings with equal numbers of corners.
fn wall(lower: &[Vec3], upper: &[Vec3]) -> Vec<Vec<Vec3>> {
    let edges = lower.iter().zip(lower.iter().skip(1));
    let above = upper.iter().zip(upper.iter().skip(1));
    edges
        .zip(above)
        .map(|((a, b), (d, c))| vec![*a, *b, *c, *d, *a])
        .collect()
}
