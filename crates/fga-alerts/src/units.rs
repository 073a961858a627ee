//! Units of the standards, in SI units.

pub(crate) const FOOT_M: f64 = 0.3048;
pub(crate) const NAUTICAL_MILE_M: f64 = 1852.0;
pub(crate) const KNOT_MPS: f64 = NAUTICAL_MILE_M / 3600.0;
pub(crate) const FOOT_PER_MINUTE_MPS: f64 = FOOT_M / 60.0;
pub(crate) const DEGREE_RAD: f64 = core::f64::consts::PI / 180.0;
/// Standard gravity, m/s².
pub(crate) const GRAVITY_MPS2: f64 = 9.806_65;
