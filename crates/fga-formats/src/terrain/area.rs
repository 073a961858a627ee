//! Areas of latitude and longitude.

/// An area of latitudes and longitudes, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// Least latitude.
    pub south_deg: f64,
    /// Least longitude.
    pub west_deg: f64,
    /// Largest latitude.
    pub north_deg: f64,
    /// Largest longitude.
    pub east_deg: f64,
}

impl Area {
    /// An area from its sides in the order south, west, north, east, which may be out of range.
    pub(super) const fn of([south_deg, west_deg, north_deg, east_deg]: [f64; 4]) -> Self {
        Self {
            south_deg,
            west_deg,
            north_deg,
            east_deg,
        }
    }

    /// An area from its sides in the order south, west, north, east.
    ///
    /// # Errors
    /// Sides out of order or range, a pole, an area across the antimeridian.
    pub fn new(sides_deg: [f64; 4]) -> Result<Self, String> {
        let [south_deg, west_deg, north_deg, east_deg] = sides_deg;
        if !(south_deg > -90.0 && south_deg < north_deg && north_deg < 90.0) {
            return Err(format!(
                "the latitudes {south_deg} and {north_deg}, expected south below north and no pole"
            ));
        }
        if !(west_deg >= -180.0 && west_deg < east_deg && east_deg <= 180.0) {
            return Err(format!(
                "the longitudes {west_deg} and {east_deg}, expected west below east from -180 to 180; \
                 an area across the antimeridian is two areas"
            ));
        }
        Ok(Self::of(sides_deg))
    }

    /// Whether two areas have more than an edge in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.south_deg < other.north_deg
            && other.south_deg < self.north_deg
            && self.west_deg < other.east_deg
            && other.west_deg < self.east_deg
    }

    /// The smallest area around both.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        Self {
            south_deg: self.south_deg.min(other.south_deg),
            west_deg: self.west_deg.min(other.west_deg),
            north_deg: self.north_deg.max(other.north_deg),
            east_deg: self.east_deg.max(other.east_deg),
        }
    }
}

impl core::fmt::Display for Area {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "latitude {:.5} to {:.5}, longitude {:.5} to {:.5}",
            self.south_deg, self.north_deg, self.west_deg, self.east_deg
        )
    }
}
