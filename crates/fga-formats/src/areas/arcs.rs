//! Arcs of circles on the ellipsoid, as places between which edges are shortest lines.

use super::area::LARGEST_M;
use geo::Point;
use geo::algorithm::line_measures::{Bearing, Destination, Distance, Geodesic};

/// An edge is nowhere farther from its arc, metres.
const TRUE_M: f64 = 0.5;
/// An arc has at most this many edges.
const MOST: f64 = 720.0;

/// An arc round a centre.
#[derive(Debug, Clone, Copy)]
pub(super) struct CircleArc {
    /// Longitude and latitude of the centre, degrees.
    pub(super) center_deg: [f64; 2],
    /// Radius at the beginning and at the end, metres.
    pub(super) radius_m: [f64; 2],
    /// Bearings from the centre, clockwise from north, degrees.
    pub(super) bearing_deg: [f64; 2],
    pub(super) clockwise: bool,
}

impl CircleArc {
    /// The arc from one place to another.
    pub(super) fn between(center_deg: [f64; 2], ends_deg: [[f64; 2]; 2], clockwise: bool) -> Self {
        let center = Point::from(center_deg);
        Self {
            center_deg,
            radius_m: ends_deg.map(|end| Geodesic.distance(center, Point::from(end))),
            bearing_deg: ends_deg.map(|end| Geodesic.bearing(center, Point::from(end))),
            clockwise,
        }
    }

    /// Longitude and latitude of places along it, from its beginning to its end, degrees.
    pub(super) fn places(&self) -> Result<Vec<Vec<f64>>, String> {
        let [begin_m, end_m] = self.radius_m;
        let [begin_deg, end_deg] = self.bearing_deg;
        let is_radius = |radius_m: f64| (0.0..=LARGEST_M).contains(&radius_m);
        if !is_radius(begin_m) || !is_radius(end_m) || !(end_deg - begin_deg).is_finite() {
            return Err(format!("an arc with a radius of {begin_m} m"));
        }
        let turn_deg = (end_deg - begin_deg).rem_euclid(360.0);
        let turn_deg = if self.clockwise {
            turn_deg
        } else {
            turn_deg - 360.0
        };
        let half_rad = libm::acos(1.0 - (TRUE_M / begin_m.max(end_m)).min(1.0));
        let steps = libm::ceil((0.5 * turn_deg.abs().to_radians() / half_rad).clamp(1.0, MOST));
        let mut places = Vec::new();
        let mut step = 0.0;
        while step <= steps {
            let share = step / steps;
            let bearing_deg = begin_deg + share * turn_deg;
            let radius_m = begin_m + share * (end_m - begin_m);
            let at = Geodesic.destination(Point::from(self.center_deg), bearing_deg, radius_m);
            places.push(vec![at.x(), at.y()]);
            step += 1.0;
        }
        Ok(places)
    }
}
