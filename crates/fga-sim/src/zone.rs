//! Zones of a world.

use fga::zone::{Outline, Zone};
use fga::{Vec2, Vec3};
use fga_formats::zones::{ZoneError, heights_m};
use fga_judge::zone::zone_margin_m;

/// The outline of a zone, seen from above.
#[derive(Debug, Clone, PartialEq)]
pub enum WorldOutline {
    /// A polygon by its corners, metres east and north.
    Polygon(Vec<Vec2>),
    /// A circle.
    Circle {
        /// Centre, metres east and north.
        center_m: Vec2,
        /// Radius, metres.
        radius_m: f64,
    },
}

/// A zone of a world.
#[derive(Debug, Clone, PartialEq)]
pub struct WorldZone {
    name: String,
    keep_in: bool,
    outline: WorldOutline,
    heights_m: (f64, f64),
}

impl WorldZone {
    /// A zone that the aircraft keeps within or out of, between two altitudes, metres, with a name for people; a circle has a
    /// positive radius.
    ///
    /// # Errors
    /// A floor that is not below the ceiling.
    pub fn new(
        name: String,
        keep_in: bool,
        outline: WorldOutline,
        (floor_m, ceiling_m): (f64, f64),
    ) -> Result<Self, ZoneError> {
        Ok(Self {
            name,
            keep_in,
            outline,
            heights_m: heights_m(floor_m, ceiling_m)?,
        })
    }

    /// A copy of what a situation lends.
    pub fn of(zone: &Zone<'_>) -> Self {
        let outline = match zone.outline {
            Outline::Polygon(corners_m) => WorldOutline::Polygon(corners_m.to_vec()),
            Outline::Circle(center_m, radius_m) => WorldOutline::Circle { center_m, radius_m },
        };
        Self {
            name: String::new(),
            keep_in: zone.keep_in,
            outline,
            heights_m: zone.heights_m,
        }
    }

    /// The zone as the core takes it.
    pub fn zone(&self) -> Zone<'_> {
        Zone {
            keep_in: self.keep_in,
            outline: match &self.outline {
                WorldOutline::Polygon(corners_m) => Outline::Polygon(corners_m),
                WorldOutline::Circle { center_m, radius_m } => {
                    Outline::Circle(*center_m, *radius_m)
                }
            },
            heights_m: self.heights_m,
        }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether the aircraft keeps within it, not out of it.
    pub const fn keep_in(&self) -> bool {
        self.keep_in
    }

    /// Its outline.
    pub const fn outline(&self) -> &WorldOutline {
        &self.outline
    }

    /// Its floor and ceiling, metres; infinite without.
    pub const fn heights_m(&self) -> (f64, f64) {
        self.heights_m
    }

    /// A row of places along the outline, the first one also the last, metres.
    pub fn ring_m(&self) -> Vec<Vec2> {
        let mut ring = match &self.outline {
            WorldOutline::Polygon(corners_m) => corners_m.clone(),
            WorldOutline::Circle { center_m, radius_m } => (0..72)
                .map(|step| {
                    let (sin, cos) = libm::sincos(f64::from(step) * core::f64::consts::TAU / 72.0);
                    *center_m + *radius_m * Vec2::new(cos, sin)
                })
                .collect(),
        };
        ring.extend(ring.first().copied());
        ring
    }

    /// How far a place is on the allowed side of its surface, metres; negative on the other side.
    pub fn margin_m(&self, at_m: Vec3) -> f64 {
        zone_margin_m(&self.zone(), at_m)
    }
}
