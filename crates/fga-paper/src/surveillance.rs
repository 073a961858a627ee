//! The layers of surveillance (§2.2, §2.3 (4)): what the sensor searches, what may become a danger.

/// Search radius of the sensor over `d_m` (§2.3 (4)).
pub const SEARCH_RATIO: f64 = 50.0;
/// Potential danger radius R over `d_m` (§2.3 (4)).
pub const SURVEILLANCE_RATIO: f64 = 10.0;

/// The two radii about the aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surveillance {
    /// R: an obstacle nearer than this is a potential one, metres.
    pub radius_m: f64,
    /// Search radius of the sensor, metres, at least R.
    pub search_radius_m: f64,
}

/// The layer of a distance, outermost first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Layer {
    /// Out of the sensor's reach.
    Beyond,
    /// Within the search radius: seen, of no concern yet.
    Search,
    /// Within R: a potential obstacle, to be checked against the collision cones.
    Potential,
}

impl Surveillance {
    /// The paper's: R = 10 `d_m`, search radius 50 `d_m`. `None` unless `d_m` is positive.
    pub fn of(radius_m: f64) -> Option<Self> {
        let search_radius_m = SEARCH_RATIO * radius_m;
        (radius_m > 0.0 && search_radius_m.is_finite()).then_some(Self {
            radius_m: SURVEILLANCE_RATIO * radius_m,
            search_radius_m,
        })
    }

    /// The layer of an obstacle at this distance; a distance that is not a number is beyond.
    pub fn layer(&self, distance_m: f64) -> Layer {
        if distance_m <= self.radius_m {
            Layer::Potential
        } else if distance_m <= self.search_radius_m {
            Layer::Search
        } else {
            Layer::Beyond
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 4: R = 300 m for `d_m` = 30 m; §2.3: 50 times for the sensor.
    #[test]
    fn radii_are_those_of_table_4() {
        let surveillance = Surveillance::of(30.0).unwrap();
        assert_eq!(
            (surveillance.radius_m, surveillance.search_radius_m),
            (300.0, 1500.0)
        );
        assert_eq!(surveillance.layer(300.0), Layer::Potential);
        assert_eq!(surveillance.layer(301.0), Layer::Search);
        assert_eq!(surveillance.layer(1501.0), Layer::Beyond);
        assert_eq!(surveillance.layer(f64::NAN), Layer::Beyond);
        for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
            assert_eq!(Surveillance::of(bad), None);
        }
    }
}
