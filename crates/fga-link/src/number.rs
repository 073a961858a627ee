//! Conversions between the wire's units and the program's, and checks of ranges.

use fga::Vec3;
use fga_formats::geodesy::Geodetic;
use mavlink::dialects::ardupilotmega::GLOBAL_POSITION_INT_DATA;

/// 1e-7 degrees to degrees.
pub(crate) fn degrees_from_e7(value: i32) -> f64 {
    f64::from(value) * 1e-7
}

/// Degrees to 1e-7 degrees.
pub(crate) fn degrees_to_e7(degrees: f64) -> i32 {
    to_i32(degrees * 1e7)
}

/// The place at a latitude and a longitude in 1e-7 degrees and an altitude in metres; `None` for 0, 0, which stands for no place.
pub(crate) fn place_from_e7(latitude: i32, longitude: i32, altitude_m: f64) -> Option<Geodetic> {
    if latitude == 0 && longitude == 0 {
        return None;
    }
    Geodetic::new(
        degrees_from_e7(latitude),
        degrees_from_e7(longitude),
        altitude_m,
    )
}

/// Place and velocity east, north and up, metres per second; `None` from a receiver without a fix, which reports zero.
pub(crate) fn flown(data: &GLOBAL_POSITION_INT_DATA) -> Option<(Geodetic, Vec3)> {
    let place = place_from_e7(data.lat, data.lon, f64::from(data.alt) * 1e-3)?;
    let velocity = Vec3::new(f64::from(data.vy), f64::from(data.vx), -f64::from(data.vz));
    Some((place, velocity * 0.01))
}

/// The velocity east, north and up at a speed on a track, clockwise from north; metres per second and radians.
pub(crate) fn velocity_mps(speed_mps: f64, track_rad: f64, climb_mps: f64) -> Vec3 {
    let (sin, cos) = libm::sincos(track_rad);
    Vec3::new(speed_mps * sin, speed_mps * cos, climb_mps)
}

/// A float of the wire's width.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the wire has single precision"
)]
pub(crate) fn single(value: f64) -> f32 {
    value as f32
}

/// Functions to the nearest whole number that fits a type.
macro_rules! nearest {
    ($($name:ident -> $kind:ty;)*) => {$(
        /// The nearest whole number that fits this type.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast of a float saturates")]
        pub(crate) fn $name(value: f64) -> $kind {
            value.round() as $kind
        }
    )*};
}

nearest! {
    to_u16 -> u16;
    to_i16 -> i16;
    to_i32 -> i32;
    to_u64 -> u64;
}

/// Collects the first value that is out of range.
#[derive(Debug, Default)]
pub(crate) struct RangeCheck(Option<String>);

impl RangeCheck {
    /// Checks one value, if it is there; one that is not a number is out of any range.
    pub(crate) fn within(
        &mut self,
        name: &str,
        value: impl Into<Option<f64>>,
        low: f64,
        high: f64,
    ) {
        if let Some(value) = value.into().filter(|value| !(low..=high).contains(value)) {
            let fault = || format!("{name} is {value}, expected {low} to {high}");
            self.0.get_or_insert_with(fault);
        }
    }

    /// The first that was out of range.
    pub(crate) fn finish(self) -> Result<(), String> {
        self.0.map_or(Ok(()), Err)
    }
}
