//! Outlines of protected volumes and zones.

use core::f64::consts::{PI, TAU};
use fga::Vec3;
use fga::situation::ProtectedVolume;

use crate::flight::{Flight, FlightZone};

/// Corners of the polygons that stand for a circle.
pub(super) const CORNERS: u32 = 24;

/// A zone without a floor or a ceiling is drawn this far beyond the flight, metres.
const BEYOND_M: f64 = 100.0;

/// Floor and ceiling with which a zone is drawn, metres in the local frame.
pub(super) fn zone_heights_m(flight: &Flight, zone: &FlightZone) -> (f64, f64) {
    let heights_m = flight.samples.iter().map(|sample| sample.position_m.z);
    let lowest_m = heights_m.clone().fold(f64::INFINITY, f64::min);
    let highest_m = heights_m.fold(f64::NEG_INFINITY, f64::max);
    let below_m = zone
        .ceiling_m
        .map_or(lowest_m, |ceiling_m| ceiling_m.min(lowest_m));
    let floor_m = zone.floor_m.unwrap_or(below_m - BEYOND_M);
    (
        floor_m,
        zone.ceiling_m.unwrap_or(highest_m.max(floor_m) + BEYOND_M),
    )
}

/// Least time between places of the curtain, seconds.
const CURTAIN_STEP_S: f64 = 1.0;

/// The ground below the flight and the flight, in pieces over known ground.
pub(super) fn curtain(flight: &Flight) -> Vec<[Vec<Vec3>; 2]> {
    let mut pieces = vec![[Vec::new(), Vec::new()]];
    for sample in flight.thinned(CURTAIN_STEP_S) {
        match (sample.ground_m, pieces.last_mut()) {
            (Some(ground_m), Some([ground, path])) => {
                ground.push(sample.position_m.with_z(ground_m));
                path.push(sample.position_m);
            }
            _ => pieces.push([Vec::new(), Vec::new()]),
        }
    }
    pieces.retain(|[ground, _]| ground.len() > 1);
    pieces
}

/// The places of a line. Readers need two, so a single one is doubled.
pub(super) fn line<T: Clone>(places: impl Iterator<Item = T>) -> Vec<T> {
    let mut places: Vec<T> = places.collect();
    if let [only] = &places[..] {
        places.push(only.clone());
    }
    places
}

/// The surface of a zone as closed polygons: of one to keep within its wall alone, through which the flight is seen.
pub(super) fn zone_surface(flight: &Flight, zone: &FlightZone) -> Vec<Vec<Vec3>> {
    let (floor_m, ceiling_m) = zone_heights_m(flight, zone);
    let [floor, lid] = [floor_m, ceiling_m].map(|z_m| -> Vec<Vec3> {
        let places = zone.ring_m.iter();
        places
            .map(|[x_m, y_m]| Vec3::new(*x_m, *y_m, z_m))
            .collect()
    });
    let mut polygons = wall(&floor, &lid);
    if !zone.keep_in {
        polygons.extend([floor, lid]);
    }
    polygons
}

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
pub(super) fn wall(lower: &[Vec3], upper: &[Vec3]) -> Vec<Vec<Vec3>> {
    let edges = lower.iter().zip(lower.iter().skip(1));
    let above = upper.iter().zip(upper.iter().skip(1));
    edges
        .zip(above)
        .map(|((a, b), (d, c))| vec![*a, *b, *c, *d, *a])
        .collect()
}
