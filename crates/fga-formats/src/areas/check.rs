//! Whether zones can be made of an area.

use fga::Vec2;

use super::area::{AreaOutline, EdgeLine, NamedArea};
use crate::geodesy::{Earth, Geodetic, LocalFrame};
use crate::zones::{MAX_CORNERS, ZoneError, heights_m, polygon, with_holes};

/// A degree of latitude, metres.
pub(super) const DEGREE_M: f64 = 111_195.0;

impl NamedArea {
    /// Whether a zone can be made of it, wherever a flight begins.
    ///
    /// # Errors
    /// As [`with_holes`], with its first corner as origin; a floor that is not below a ceiling with the same reference.
    pub fn check(&self) -> Result<(), ZoneError> {
        if let [Some(floor), Some(ceiling)] = self.limits
            && floor.above == ceiling.above
        {
            heights_m(floor.height_m, ceiling.height_m)?;
        }
        let AreaOutline::Polygon(rings) = &self.outline else {
            return Ok(());
        };
        self.check_rings()?;
        // A hole is nearer to a flight than an outline round a country.
        let place = |[latitude_deg, longitude_deg]: &[f64; 2]| {
            Geodetic::new(*latitude_deg, *longitude_deg, 0.0)
        };
        let Some(origin) = rings.iter().rev().flatten().find_map(place) else {
            return Err(ZoneError::Corners(0));
        };
        let frame = LocalFrame::new(origin, Earth::Wgs84);
        for mut rings in self.on_plane(&frame, self.keep_in == Some(true)).polygons {
            let holes = rings.split_off(1);
            with_holes(rings.pop().unwrap_or_default(), holes)?;
        }
        Ok(())
    }

    /// Whether its rings are polygons as they are given, on a map of longitude and latitude; those with many corners, and wide ones whose
    /// edges are bent there, show it on the plane.
    ///
    /// # Errors
    /// As [`polygon`].
    pub fn check_rings(&self) -> Result<(), ZoneError> {
        let AreaOutline::Polygon(rings) = &self.outline else {
            return Ok(());
        };
        for ring in rings.iter().filter(|ring| ring.len() <= MAX_CORNERS) {
            let [south, west] = ring.first().copied().unwrap_or_default();
            let level = libm::cos(south.to_radians()).max(0.01);
            let on_map = |[latitude_deg, longitude_deg]: &[f64; 2]| {
                let (east_deg, north_deg) = (longitude_deg - west, latitude_deg - south);
                DEGREE_M * Vec2::new(level * east_deg, north_deg)
            };
            let corners: Vec<Vec2> = ring.iter().map(on_map).collect();
            let widest_m = if self.edges == EdgeLine::Degrees {
                9e6
            } else {
                5e4
            };
            if corners.iter().all(|at| at.length() <= widest_m) {
                polygon(corners)?;
            }
        }
        Ok(())
    }
}
