//! Units at the edge: their names and their SI factors.
//!
//! Inside fga there are only metres, seconds, radians and metres per second; these convert every other
//! unit.

use core::f64::consts::PI;

use crate::error::shown;

/// One foot, metres (international foot, exact).
pub const FOOT_M: f64 = 0.3048;
/// One nautical mile, metres (exact).
pub const NAUTICAL_MILE_M: f64 = 1852.0;
/// One knot, metres per second.
pub const KNOT_MPS: f64 = NAUTICAL_MILE_M / 3600.0;
/// One foot per minute, metres per second.
pub const FOOT_PER_MINUTE_MPS: f64 = FOOT_M / 60.0;
/// Standard gravity, metres per second squared (exact).
pub const STANDARD_GRAVITY_MPS2: f64 = 9.806_65;
/// One degree, radians.
pub const DEGREE_RAD: f64 = PI / 180.0;

/// The quantity of a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// An angle; the SI unit is the radian.
    Angle,
    /// A length; the SI unit is the metre.
    Length,
    /// A speed; the SI unit is the metre per second.
    Speed,
    /// A duration; the SI unit is the second.
    Time,
    /// A change of speed; the SI unit is the metre per second squared.
    Acceleration,
    /// A change of angle; the SI unit is the radian per second.
    AngularRate,
}

impl Dimension {
    /// Units that messages name as examples.
    pub const fn examples(self) -> &'static str {
        match self {
            Self::Angle => "deg or rad",
            Self::Length => "m, ft, nmi or km",
            Self::Speed => "kn, m/s, fpm or km/h",
            Self::Time => "s, min or h",
            Self::Acceleration => "m/s^2, ft/s^2 or G",
            Self::AngularRate => "deg/s or rad/s",
        }
    }

    /// The dimension with an article, for messages.
    pub const fn with_article(self) -> &'static str {
        match self {
            Self::Angle => "an angle",
            Self::Length => "a length",
            Self::Speed => "a speed",
            Self::Time => "a time",
            Self::Acceleration => "an acceleration",
            Self::AngularRate => "an angular rate",
        }
    }
}

/// A unit: its quantity and its SI factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Its quantity.
    pub dimension: Dimension,
    /// SI units in one of it.
    pub factor: f64,
}

impl Unit {
    /// Degrees of arc.
    pub const DEGREE: Self = Self::new(Dimension::Angle, DEGREE_RAD);
    /// Feet.
    pub const FOOT: Self = Self::new(Dimension::Length, FOOT_M);
    /// Nautical miles.
    pub const NAUTICAL_MILE: Self = Self::new(Dimension::Length, NAUTICAL_MILE_M);
    /// Knots.
    pub const KNOT: Self = Self::new(Dimension::Speed, KNOT_MPS);
    /// Feet per minute.
    pub const FOOT_PER_MINUTE: Self = Self::new(Dimension::Speed, FOOT_PER_MINUTE_MPS);
    /// Seconds.
    pub const SECOND: Self = Self::new(Dimension::Time, 1.0);

    const fn new(dimension: Dimension, factor: f64) -> Self {
        Self { dimension, factor }
    }

    /// The value in SI units.
    pub fn to_si(self, value: f64) -> f64 {
        value * self.factor
    }

    /// The unit with this name, in any case and with or without brackets; `None` if unknown.
    ///
    /// `nm` is a nautical mile, as in every aviation file.
    ///
    /// ```
    /// use fga_formats::units::Unit;
    ///
    /// assert_eq!(Unit::parse("[kts]"), Some(Unit::KNOT));
    /// assert_eq!(Unit::parse("furlong"), None);
    /// ```
    pub fn parse(name: &str) -> Option<Self> {
        use Dimension::{Acceleration, Angle, AngularRate, Length, Speed, Time};
        let name = bare_name(name).to_ascii_lowercase();
        let (dimension, factor) = match name.as_str() {
            "deg" | "degs" | "degree" | "degrees" | "°" => (Angle, DEGREE_RAD),
            "rad" | "rads" | "radian" | "radians" => (Angle, 1.0),
            "m" | "meter" | "meters" | "metre" | "metres" => (Length, 1.0),
            "km" | "kilometer" | "kilometers" | "kilometre" | "kilometres" => (Length, 1000.0),
            "ft" | "foot" | "feet" => (Length, FOOT_M),
            "nmi" | "nm" | "nauticalmile" | "nautical_mile" => (Length, NAUTICAL_MILE_M),
            "mi" | "mile" | "miles" => (Length, 1609.344),
            "kn" | "kt" | "kts" | "knot" | "knots" | "nmi/h" => (Speed, KNOT_MPS),
            "mps" | "m/s" | "meter_per_second" | "metre_per_second" => (Speed, 1.0),
            "kph" | "kmh" | "kmph" | "km/h" => (Speed, 1.0 / 3.6),
            "mph" | "mi/h" => (Speed, 0.447_04),
            "fps" | "ftps" | "ft/s" => (Speed, FOOT_M),
            "fpm" | "ft/min" | "ftpm" => (Speed, FOOT_PER_MINUTE_MPS),
            "nmi/s" | "nm/s" => (Speed, NAUTICAL_MILE_M),
            "m/s^2" | "m/s2" => (Acceleration, 1.0),
            "ft/s^2" | "ft/s2" => (Acceleration, FOOT_M),
            "g" => (Acceleration, STANDARD_GRAVITY_MPS2),
            "deg/s" => (AngularRate, DEGREE_RAD),
            "rad/s" => (AngularRate, 1.0),
            "s" | "sec" | "secs" | "second" | "seconds" => (Time, 1.0),
            "ms" | "msec" | "millisecond" | "milliseconds" => (Time, 1e-3),
            "min" | "minute" | "minutes" => (Time, 60.0),
            "h" | "hr" | "hrs" | "hour" | "hours" => (Time, 3600.0),
            _ => return None,
        };
        Some(Self::new(dimension, factor))
    }

    /// The unit with this name, of a quantity; `None` if the name stands for no unit.
    ///
    /// # Errors
    /// An unknown unit, one of another quantity; a sentence without its subject.
    pub(crate) fn of(name: &str, dimension: Dimension) -> Result<Option<Self>, String> {
        let (unknown, of) = match Self::parse(name) {
            Some(unit) if unit.dimension == dimension => return Ok(Some(unit)),
            Some(other) => ("", format!(" of {}", other.dimension.with_article())),
            None if Self::is_unspecified(name) => return Ok(None),
            None => ("unknown ", String::new()),
        };
        let (found, expected) = (shown(name), dimension.with_article());
        let examples = dimension.examples();
        Err(format!(
            "has the {unknown}unit {found}{of}, expected {expected} unit such as {examples}"
        ))
    }

    /// Whether a unit field says that the column has no unit.
    pub fn is_unspecified(name: &str) -> bool {
        matches!(
            bare_name(name).to_ascii_lowercase().as_str(),
            "" | "-" | "none" | "unitless" | "unspecified"
        )
    }
}

/// A unit field without its brackets and blanks.
fn bare_name(name: &str) -> &str {
    name.trim_matches(|c: char| c.is_whitespace() || matches!(c, '[' | ']' | '(' | ')' | '"'))
}

#[cfg(test)]
mod tests {
    use super::*;

    // Exact factors of the international system, NIST Special Publication 811, Appendix B.
    #[test]
    fn factors_are_those_of_the_tables() {
        let si = |name: &str| Unit::parse(name).unwrap().factor;
        assert!((si("kn") - 0.514_444_444_444).abs() < 1e-12);
        assert!((si("fpm") - 0.005_08).abs() < 1e-15);
        assert!((si("mph") - 0.447_04).abs() < 1e-15);
        assert!((si("kph") - 0.277_777_777_778).abs() < 1e-12);
        assert!((si("deg") - 0.017_453_292_519_943).abs() < 1e-15);
    }

    #[test]
    fn names_are_found_in_any_case_and_in_brackets() {
        for name in ["[knot]", "KN", " kts ", "(Knots)", "kt"] {
            assert_eq!(Unit::parse(name), Some(Unit::KNOT), "{name}");
        }
        assert!(Unit::is_unspecified("[none]") && Unit::is_unspecified("unitless"));
        assert!(!Unit::is_unspecified("[deg]"));
    }
}
