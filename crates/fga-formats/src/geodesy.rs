//! Latitude, longitude and altitude into the local frame and back.
//!
//! The core knows a plane with x east, y north and z up. A [`LocalFrame`] touches the earth with
//! that plane at an origin. Both earth models use the same construction: an orthographic projection
//! of the position onto the plane gives x and y, and z is the difference of altitudes. So a flight at
//! constant altitude stays at constant z, and two aircraft at the same altitude have no vertical
//! separation, however far they are from the origin.
//!
//! - [`Earth::Wgs84`] is the ellipsoid of GPS, for missions and for MAVLink.
//! - [`Earth::Daidalus`] is the sphere on which one minute of arc is one nautical mile
//!   (radius 1852 m × 60 × 180 / π ≈ 6 366 707 m). NASA's DAIDALUS computes separations on it,
//!   so readers of its format use it. Its distances differ from those on the ellipsoid by at most
//!   0.52 % (at the poles), and at latitudes of 34° to 41° by less than 0.2 % north–south and
//!   0.33 % east–west.
//!
//! Accuracy: at distance d from the origin, lengths along the radius shrink by the factor
//! √(1 − d²/R²), 0.013 % at 100 km.

use crate::units::{DEGREE_RAD, NAUTICAL_MILE_M};
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use glam::DVec3;

/// A place on the earth.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Geodetic {
    /// Latitude, degrees, north positive.
    pub latitude_deg: f64,
    /// Longitude, degrees, east positive.
    pub longitude_deg: f64,
    /// Altitude, metres, above the datum of the source.
    pub altitude_m: f64,
}

/// Range of plausible altitudes, metres; frames are valid within it, and not at the earth's
/// centre.
const ALTITUDES_M: core::ops::RangeInclusive<f64> = -20_000.0..=1_000_000.0;

impl Geodetic {
    /// A place from degrees and metres; `None` unless the latitude is within ±90°, the longitude
    /// within ±360° and the altitude from −20 km to 1,000 km.
    pub fn new(latitude_deg: f64, longitude_deg: f64, altitude_m: f64) -> Option<Self> {
        let valid = latitude_deg.is_finite()
            && latitude_deg.abs() <= 90.0
            && longitude_deg.is_finite()
            && longitude_deg.abs() <= 360.0
            && ALTITUDES_M.contains(&altitude_m);
        valid.then_some(Self {
            latitude_deg,
            longitude_deg,
            altitude_m,
        })
    }

    /// Distance from another place along a spherical earth, metres; within 0.6 % of the ellipsoid's.
    pub fn distance_m(self, other: Self) -> f64 {
        let haversine = |apart_deg: f64| {
            let sin = libm::sin(0.5 * apart_deg * DEGREE_RAD);
            sin * sin
        };
        let shrunk = |place: Self| libm::cos(place.latitude_deg * DEGREE_RAD);
        let east = haversine(other.longitude_deg - self.longitude_deg);
        let half =
            haversine(other.latitude_deg - self.latitude_deg) + shrunk(self) * shrunk(other) * east;
        2.0 * DAIDALUS_RADIUS_M * libm::asin(libm::sqrt(half.min(1.0)))
    }
}

/// The figure of the earth below a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Earth {
    /// The ellipsoid of GPS.
    #[default]
    Wgs84,
    /// The sphere on which one minute of arc is one nautical mile.
    Daidalus,
}

/// WGS-84 semi-major axis, metres (NGA.STND.0036, defining parameter).
const WGS84_A_M: f64 = 6_378_137.0;
/// WGS-84 flattening (NGA.STND.0036, defining parameter).
const WGS84_F: f64 = 1.0 / 298.257_223_563;
/// Radius of the sphere on which one minute of arc is one nautical mile, metres.
pub const DAIDALUS_RADIUS_M: f64 = NAUTICAL_MILE_M * 60.0 * 180.0 / PI;

impl Earth {
    fn semi_major_m(self) -> f64 {
        match self {
            Self::Wgs84 => WGS84_A_M,
            Self::Daidalus => DAIDALUS_RADIUS_M,
        }
    }

    fn eccentricity_squared(self) -> f64 {
        match self {
            Self::Wgs84 => WGS84_F * (2.0 - WGS84_F),
            Self::Daidalus => 0.0,
        }
    }

    /// Earth-centred position of a latitude and longitude at a height, metres.
    fn centred(self, latitude_rad: f64, longitude_rad: f64, height_m: f64) -> DVec3 {
        let e2 = self.eccentricity_squared();
        let (sin_lat, cos_lat) = libm::sincos(latitude_rad);
        let (sin_lon, cos_lon) = libm::sincos(longitude_rad);
        let normal_m = self.semi_major_m() / libm::sqrt(1.0 - e2 * sin_lat * sin_lat);
        DVec3::new(
            (normal_m + height_m) * cos_lat * cos_lon,
            (normal_m + height_m) * cos_lat * sin_lon,
            (normal_m * (1.0 - e2) + height_m) * sin_lat,
        )
    }

    /// Latitude, longitude (radians) and height (metres) of an earth-centred position, by
    /// iteration on the latitude (converges to 1e-12 rad in a handful of steps near the surface).
    fn geodetic(self, centred: DVec3) -> (f64, f64, f64) {
        let e2 = self.eccentricity_squared();
        let axis_m = libm::hypot(centred.x, centred.y);
        let longitude_rad = libm::atan2(centred.y, centred.x);
        let mut latitude_rad = libm::atan2(centred.z, axis_m * (1.0 - e2));
        let mut normal_m = self.semi_major_m();
        for _ in 0..8 {
            let sin_lat = libm::sin(latitude_rad);
            normal_m = self.semi_major_m() / libm::sqrt(1.0 - e2 * sin_lat * sin_lat);
            latitude_rad = libm::atan2(centred.z + e2 * normal_m * sin_lat, axis_m);
        }
        let (sin_lat, cos_lat) = libm::sincos(latitude_rad);
        let height_m = if cos_lat.abs() > 0.1 {
            axis_m / cos_lat - normal_m
        } else {
            centred.z / sin_lat - normal_m * (1.0 - e2)
        };
        (latitude_rad, longitude_rad, height_m)
    }
}

/// Unit vectors east, north and up at a place, earth-centred.
fn axes(latitude_rad: f64, longitude_rad: f64) -> [DVec3; 3] {
    let (sin_lat, cos_lat) = libm::sincos(latitude_rad);
    let (sin_lon, cos_lon) = libm::sincos(longitude_rad);
    [
        DVec3::new(-sin_lon, cos_lon, 0.0),
        DVec3::new(-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat),
        DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat),
    ]
}

/// A local frame on the earth: x east, y north, z up, metres, from an origin.
///
/// ```
/// use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
///
/// // San Francisco, and a place one minute of arc to the north of it.
/// let origin = Geodetic::new(37.6189, -122.375, 4.0).expect("valid");
/// let frame = LocalFrame::new(origin, Earth::Daidalus);
/// let north = Geodetic::new(37.6189 + 1.0 / 60.0, -122.375, 104.0).expect("valid");
/// let local = frame.to_local_m(north);
/// assert!((local.y - 1852.0).abs() < 0.01 && local.z == 100.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalFrame {
    origin: Geodetic,
    earth: Earth,
    /// Height of the horizontal projection, metres.
    height_m: f64,
    centred: DVec3,
    axes: [DVec3; 3],
}

impl LocalFrame {
    /// The frame that touches the earth at `origin`.
    ///
    /// On [`Earth::Wgs84`] horizontal distances hold at the origin's altitude; on
    /// [`Earth::Daidalus`] at the surface, as DAIDALUS computes them.
    pub fn new(origin: Geodetic, earth: Earth) -> Self {
        let latitude_rad = origin.latitude_deg * DEGREE_RAD;
        let longitude_rad = origin.longitude_deg * DEGREE_RAD;
        let height_m = match earth {
            Earth::Wgs84 => origin.altitude_m,
            Earth::Daidalus => 0.0,
        };
        Self {
            origin,
            earth,
            height_m,
            centred: earth.centred(latitude_rad, longitude_rad, height_m),
            axes: axes(latitude_rad, longitude_rad),
        }
    }

    /// The origin of the frame.
    pub const fn origin(&self) -> Geodetic {
        self.origin
    }

    /// The figure of the earth below the frame.
    pub const fn earth(&self) -> Earth {
        self.earth
    }

    /// Local position of a place, metres.
    pub fn to_local_m(&self, place: Geodetic) -> DVec3 {
        let centred = self.earth.centred(
            place.latitude_deg * DEGREE_RAD,
            place.longitude_deg * DEGREE_RAD,
            self.height_m,
        );
        let from_origin = centred - self.centred;
        let [east, north, _] = self.axes;
        DVec3::new(
            from_origin.dot(east),
            from_origin.dot(north),
            place.altitude_m - self.origin.altitude_m,
        )
    }

    /// The place at a local position; the inverse of [`LocalFrame::to_local_m`] within a
    /// millimetre up to 500 km from the origin.
    ///
    /// Farther from the origin than the earth's radius there is no such place: the rim
    /// replaces the position.
    pub fn to_geodetic(&self, local_m: DVec3) -> Geodetic {
        let [east, north, up] = self.axes;
        let radius_m = self.earth.semi_major_m() + self.height_m;
        let far_m = libm::hypot(local_m.x, local_m.y);
        let scale = if far_m > 0.99 * radius_m {
            0.99 * radius_m / far_m
        } else {
            1.0
        };
        let (x_m, y_m) = (local_m.x * scale, local_m.y * scale);
        let across_m = far_m * scale;
        // Depth of the curved surface below the plane: exact on a sphere, then Newton's method.
        let mut depth_m = libm::sqrt(radius_m * radius_m - across_m * across_m) - radius_m;
        let foot = self.centred + east * x_m + north * y_m;
        let (mut latitude_rad, mut longitude_rad, mut height_m) =
            self.earth.geodetic(foot + up * depth_m);
        for _ in 0..6 {
            let slope = axes(latitude_rad, longitude_rad)[2].dot(up).max(0.05);
            depth_m -= (height_m - self.height_m) / slope;
            (latitude_rad, longitude_rad, height_m) = self.earth.geodetic(foot + up * depth_m);
        }
        Geodetic {
            latitude_deg: latitude_rad / DEGREE_RAD,
            longitude_deg: longitude_rad / DEGREE_RAD,
            altitude_m: local_m.z + self.origin.altitude_m,
        }
    }

    /// A local direction in earth-centred axes (x through 0° N 0° E, z through the north pole).
    pub fn centred_direction(&self, local: DVec3) -> DVec3 {
        let [east, north, up] = self.axes;
        east * local.x + north * local.y + up * local.z
    }

    /// Local velocity of something that moves east, north and up at a place (metres per second):
    /// the convergence of meridians turns its east and north against the frame's.
    pub fn velocity_mps(&self, place: Geodetic, east_north_up_mps: DVec3) -> DVec3 {
        let [east, north, _] = axes(
            place.latitude_deg * DEGREE_RAD,
            place.longitude_deg * DEGREE_RAD,
        );
        let centred = east * east_north_up_mps.x + north * east_north_up_mps.y;
        let [frame_east, frame_north, _] = self.axes;
        DVec3::new(
            centred.dot(frame_east),
            centred.dot(frame_north),
            east_north_up_mps.z,
        )
    }
}

/// Course ψ of the core (radians from east towards north) of a compass course (degrees from
/// north towards east), within (−π, π].
///
/// ```
/// use fga_formats::geodesy::course_from_compass_rad;
///
/// assert_eq!(course_from_compass_rad(90.0), 0.0); // east
/// assert_eq!(course_from_compass_rad(0.0), core::f64::consts::FRAC_PI_2); // north
/// ```
pub fn course_from_compass_rad(compass_deg: f64) -> f64 {
    let turned = libm::remainder(90.0 - compass_deg, 360.0) * DEGREE_RAD;
    if turned <= -PI { turned + TAU } else { turned }
}

/// East, north and up of a velocity by its compass course (degrees from north towards east), its speed and its climb.
pub(crate) fn velocity_from_compass(compass_deg: f64, speed_mps: f64, climb_mps: f64) -> DVec3 {
    let (sin, cos) = libm::sincos(course_from_compass_rad(compass_deg));
    DVec3::new(speed_mps * cos, speed_mps * sin, climb_mps)
}

/// Compass course (degrees from north towards east, within [0, 360)) of a course ψ of the core.
pub fn compass_from_course_deg(course_rad: f64) -> f64 {
    let degrees = ((FRAC_PI_2 - course_rad) / DEGREE_RAD).rem_euclid(360.0);
    if degrees >= 360.0 { 0.0 } else { degrees }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn place(latitude_deg: f64, longitude_deg: f64, altitude_m: f64) -> Geodetic {
        Geodetic::new(latitude_deg, longitude_deg, altitude_m).unwrap()
    }

    // From the radii of curvature M = a(1 − e²)/(1 − e² sin²φ)^(3/2) and N cos φ at φ = 45°:
    #[test]
    fn places_are_checked() {
        for [latitude, longitude, altitude] in [
            [90.1, 0.0, 0.0],
            [0.0, 360.1, 0.0],
            [f64::NAN, 0.0, 0.0],
            [0.0, 0.0, f64::INFINITY],
            [0.0, 0.0, -1.2e11],
            [0.0, 0.0, 1.1e6],
        ] {
            assert_eq!(Geodetic::new(latitude, longitude, altitude), None);
        }
        assert!(Geodetic::new(-90.0, 360.0, -430.0).is_some());
    }

    // 111 131.8 m for a degree of latitude and 78 846.8 m for one of longitude.
    #[test]
    fn degrees_on_the_ellipsoid_have_the_tabulated_length() {
        let frame = LocalFrame::new(place(45.0, 7.0, 0.0), Earth::Wgs84);
        let north =
            frame.to_local_m(place(45.005, 7.0, 0.0)) - frame.to_local_m(place(44.995, 7.0, 0.0));
        let east =
            frame.to_local_m(place(45.0, 7.005, 0.0)) - frame.to_local_m(place(45.0, 6.995, 0.0));
        assert!((north.y / 0.01 - 111_131.8).abs() < 0.5, "{}", north.y);
        assert!((east.x / 0.01 - 78_846.8).abs() < 0.5, "{}", east.x);
    }

    // 45° N 45° E at 1000 m: x = y = (N + h)/2, z = (N (1 − e²) + h)/√2 with N = a/√(1 − e²/2).
    #[test]
    fn earth_centred_position_is_the_closed_form() {
        let centred = Earth::Wgs84.centred(PI / 4.0, PI / 4.0, 1000.0);
        let expected = DVec3::new(
            3_194_919.145_060_6,
            3_194_919.145_060_6,
            4_488_055.515_647_1,
        );
        assert!((centred - expected).length() < 1e-4, "{centred}");
    }

    #[test]
    fn compass_and_course_agree_with_the_rose() {
        for (compass, course) in [
            (0.0, 90.0),
            (45.0, 45.0),
            (90.0, 0.0),
            (180.0, -90.0),
            (270.0, 180.0),
        ] {
            let found = course_from_compass_rad(compass) / DEGREE_RAD;
            assert!((found - course).abs() < 1e-12, "{compass}: {found}");
            let back = compass_from_course_deg(course * DEGREE_RAD);
            assert!((back - compass).abs() < 1e-9, "{course}: {back}");
        }
    }

    #[test]
    fn velocity_is_the_derivative_of_the_position() {
        for earth in [Earth::Wgs84, Earth::Daidalus] {
            let frame = LocalFrame::new(place(40.0, -100.0, 0.0), earth);
            let start = place(40.4, -99.2, 0.0);
            // 1e-5° of longitude in one second, due east there.
            let end = place(40.4, -99.2 + 1e-5, 0.0);
            let difference = frame.to_local_m(end) - frame.to_local_m(start);
            let local_frame = LocalFrame::new(start, earth);
            let speed_mps = local_frame.to_local_m(end).x;
            let velocity = frame.velocity_mps(start, DVec3::new(speed_mps, 0.0, 0.0));
            assert!(
                (difference - velocity).length() < 1e-6,
                "{difference} {velocity}"
            );
        }
    }

    proptest! {
        #[test]
        fn there_and_back(
            latitude in -89.0..89.0_f64, longitude in -180.0..180.0_f64, altitude in -100.0..15_000.0_f64,
            x in -300_000.0..300_000.0_f64, y in -300_000.0..300_000.0_f64, z in -1000.0..1000.0_f64,
            ellipsoid: bool,
        ) {
            let earth = if ellipsoid { Earth::Wgs84 } else { Earth::Daidalus };
            let frame = LocalFrame::new(place(latitude, longitude, altitude), earth);
            let local = DVec3::new(x, y, z);
            let back = frame.to_local_m(frame.to_geodetic(local));
            prop_assert!((back - local).length() < 1e-3, "{local} {back}");
        }

        #[test]
        fn every_finite_position_has_a_finite_place(
            x in proptest::num::f64::NORMAL, y in proptest::num::f64::NORMAL, latitude in -90.0..90.0_f64,
        ) {
            let frame = LocalFrame::new(place(latitude, 0.0, 0.0), Earth::Wgs84);
            let found = frame.to_geodetic(DVec3::new(x, y, 0.0));
            prop_assert!(found.latitude_deg.is_finite() && found.longitude_deg.is_finite());
        }
    }
}
