//! What a file says of an area.

use fga::Vec2;

use crate::terrain::Area;

/// No place of the ellipsoid of WGS 84 is bent more than with this radius, metres: along the meridian at the equator.
const LEAST_RADIUS_M: f64 = 6_335_439.0;

/// A circle has at most this radius, metres.
pub(crate) const LARGEST_M: f64 = 1e7;

/// The areas of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AreaFile {
    /// The areas, at least one.
    pub areas: Vec<NamedArea>,
    /// What of the file is not used, or used otherwise than it is written; one sentence each.
    pub notes: Vec<String>,
}

/// Which line an edge is from one corner to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EdgeLine {
    /// Straight in longitude and latitude.
    #[default]
    Degrees,
    /// The shortest one on the ellipsoid.
    Geodesic,
}

/// An area of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NamedArea {
    /// Its name.
    pub name: Option<String>,
    /// Its outline.
    pub outline: AreaOutline,
    /// Which line its edges are.
    pub edges: EdgeLine,
    /// Its floor and its ceiling, where the file states them.
    pub limits: [Option<AreaLimit>; 2],
    /// Whether it is to stay in, or to keep out of, where the file says so.
    pub keep_in: Option<bool>,
    /// Whether the file restricts no flight in it (`NO_RESTRICTION`).
    pub is_free: bool,
    /// Whether the file states times at which it applies.
    pub is_timed: bool,
}

/// The outline of an area.
#[derive(Debug, Clone, PartialEq)]
pub enum AreaOutline {
    /// A polygon by its rings, the outline and its holes: latitude and longitude of each corner, degrees; the last corner of a ring is
    /// joined to the first.
    Polygon(Vec<Vec<[f64; 2]>>),
    /// A circle.
    Circle {
        /// Latitude and longitude of its centre, degrees.
        center_deg: [f64; 2],
        /// Its radius, metres.
        radius_m: f64,
    },
}

impl AreaOutline {
    /// The smallest area of latitude and longitude around it; `None` where it has none, or reaches a pole or the antimeridian.
    pub fn span(&self) -> Option<Area> {
        let corners_deg = match self {
            Self::Polygon(rings) => rings.first()?.clone(),
            Self::Circle {
                center_deg: [latitude_deg, longitude_deg],
                radius_m,
            } => {
                let north_deg = (radius_m / LEAST_RADIUS_M).to_degrees();
                let level = libm::cos((latitude_deg.abs() + north_deg).to_radians());
                let east_deg = north_deg / level.max(0.0);
                vec![
                    [latitude_deg - north_deg, longitude_deg - east_deg],
                    [latitude_deg + north_deg, longitude_deg + east_deg],
                ]
            }
        };
        // North before east.
        let corners = corners_deg.into_iter().map(Vec2::from);
        let low = corners.clone().fold(Vec2::INFINITY, Vec2::min);
        let high = corners.fold(Vec2::NEG_INFINITY, Vec2::max);
        Area::new([low.x, low.y, high.x, high.y]).ok()
    }
}

impl Default for AreaOutline {
    fn default() -> Self {
        Self::Polygon(Vec::new())
    }
}

/// A limit of an area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaLimit {
    /// Metres above the reference.
    pub height_m: f64,
    /// What it counts from.
    pub above: Reference,
}

/// What a limit counts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// Mean sea level (`AMSL`).
    Sea,
    /// The ground or the water (`AGL`).
    Ground,
    /// The ellipsoid of WGS 84 (`WGS84`).
    Ellipsoid,
    /// The pressure of the standard atmosphere at the sea, 1013.25 hPa (`STD`): flight levels.
    Pressure,
}

impl AreaLimit {
    /// How far it may be from its height above the sea by the weather, metres: for a flight level 550 m by a pressure of 950 to 1,050 hPa
    /// at the sea, and 12 % of it by air that is 30 K colder or warmer than the standard atmosphere.
    pub fn off_m(&self) -> f64 {
        if self.above == Reference::Pressure {
            550.0 + 0.12 * self.height_m.abs()
        } else {
            0.0
        }
    }
}
