//! A flat earth near home, accurate to a metre over the few kilometres of a test.

/// Origin of the local frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Home {
    /// Latitude, degrees.
    pub latitude_deg: f64,
    /// Longitude, degrees.
    pub longitude_deg: f64,
    /// Altitude above mean sea level, metres.
    pub altitude_m: f64,
}

/// A position in MAVLink's units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WirePlace {
    /// Latitude, 1e-7 degrees.
    pub latitude_e7: i32,
    /// Longitude, 1e-7 degrees.
    pub longitude_e7: i32,
    /// Altitude above mean sea level, millimetres.
    pub altitude_mm: i32,
}

const SEMI_MAJOR_M: f64 = 6_378_137.0;
const ECCENTRICITY_SQUARED: f64 = 6.694_379_990_14e-3;

impl Home {
    /// Metres per degree of latitude and of longitude.
    fn metres_per_degree(&self) -> [f64; 2] {
        let latitude = self.latitude_deg.to_radians();
        let sin = libm::sin(latitude);
        let root = libm::sqrt(1.0 - ECCENTRICITY_SQUARED * sin * sin);
        let north = SEMI_MAJOR_M * (1.0 - ECCENTRICITY_SQUARED) / (root * root * root);
        let east = SEMI_MAJOR_M / root * libm::cos(latitude);
        [north.to_radians(), east.to_radians()]
    }

    /// A place in the local frame, metres.
    pub fn to_local_m(&self, place: WirePlace) -> [f64; 3] {
        let [north, east] = self.metres_per_degree();
        [
            (f64::from(place.longitude_e7) * 1e-7 - self.longitude_deg) * east,
            (f64::from(place.latitude_e7) * 1e-7 - self.latitude_deg) * north,
            f64::from(place.altitude_mm) * 1e-3 - self.altitude_m,
        ]
    }

    /// A local position as a place.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "saturates; tests stay near home"
    )]
    pub fn to_place(&self, [x, y, z]: [f64; 3]) -> WirePlace {
        let [north, east] = self.metres_per_degree();
        WirePlace {
            latitude_e7: ((self.latitude_deg + y / north) * 1e7).round() as i32,
            longitude_e7: ((self.longitude_deg + x / east) * 1e7).round() as i32,
            altitude_mm: ((self.altitude_m + z) * 1e3).round() as i32,
        }
    }
}

/// Difference of angles in (−π, π].
pub(crate) fn wrap(angle_rad: f64) -> f64 {
    let wrapped = libm::remainder(angle_rad, core::f64::consts::TAU);
    if wrapped <= -core::f64::consts::PI {
        core::f64::consts::PI
    } else {
        wrapped
    }
}

/// Heading from one position to another, radians clockwise from north.
pub(crate) fn bearing(from_m: [f64; 3], to_m: [f64; 3]) -> f64 {
    libm::atan2(to_m[0] - from_m[0], to_m[1] - from_m[1])
}

/// Horizontal distance, metres.
pub(crate) fn distance_m(from_m: [f64; 3], to_m: [f64; 3]) -> f64 {
    libm::hypot(to_m[0] - from_m[0], to_m[1] - from_m[1])
}
