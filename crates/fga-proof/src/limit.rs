//! Limits a number without a panic, finds one between limits, and describes a value out of range.

/// Largest accepted coordinate or length, metres: a quarter of the way round the Earth.
pub const LARGEST_M: f64 = 1e7;

/// Largest accepted component of a velocity, metres per second: beyond the speed that leaves the Earth.
pub const FASTEST_MPS: f64 = 1e4;

/// Latest accepted time of a clock, seconds: that of 1970 until the year 2286.
pub const LATEST_S: f64 = 1e10;

/// Largest accepted angle, radians: a course counts its turns.
pub const MOST_ANGLE_RAD: f64 = 1e4;

/// Bound of what rounding adds to a distance, metres (proof.md §8).
pub const ROUNDED_M: f64 = 2e-5;

/// Bound of what rounding adds to a course, radians (proof.md §8).
pub const ROUNDED_RAD: f64 = 2e-10;

/// Numbers with limits.
pub trait Limit {
    /// Within [low, high]. Unlike `f64::clamp` it never panics: limits in the wrong order give the
    /// upper one, and a limit that is not a number has no effect.
    fn limited(self, low: f64, high: f64) -> f64;
}

impl Limit for f64 {
    #[inline]
    fn limited(self, low: f64, high: f64) -> f64 {
        self.max(low).min(high)
    }
}

/// The least whole number of steps that is at least `steps`, from 1 to `most`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to 1..=most before the cast"
)]
#[inline]
pub fn whole(steps: f64, most: usize) -> usize {
    libm::ceil(steps).limited(1.0, most as f64) as usize
}

/// Where a function is nearer to zero than a value, from two points and its values there of opposite signs (the Illinois method).
pub fn root(mut function: impl FnMut(f64) -> f64, [low, high]: [(f64, f64); 2], near: f64) -> f64 {
    let ((mut a, mut at_a), (mut b, mut at_b)) = (low, high);
    // Six trials are usual.
    for _ in 0..f64::MANTISSA_DIGITS {
        let step = at_b - at_a;
        if at_b.abs() < near || step == 0.0 {
            break;
        }
        let c = b - at_b * (b - a) / step;
        let at_c = function(c);
        if at_c * at_b < 0.0 {
            (a, at_a) = (b, at_b);
        } else {
            at_a *= 0.5;
        }
        (b, at_b) = (c, at_c);
    }
    b
}

/// An unusable setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettingsError {
    /// Name of the setting or limit.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// The expected range, in words.
    pub expected: &'static str,
}

impl core::fmt::Display for SettingsError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (name, value, expected) = (self.name, self.value, self.expected);
        write!(f, "{name} is {value}, expected {expected}")
    }
}

impl core::error::Error for SettingsError {}

impl SettingsError {
    /// An error unless a value is in range.
    ///
    /// # Errors
    /// The value that is not in range.
    pub const fn unless(
        in_range: bool,
        name: &'static str,
        value: f64,
        expected: &'static str,
    ) -> Result<(), Self> {
        if in_range {
            return Ok(());
        }
        Err(Self {
            name,
            value,
            expected,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_lies_between_opposite_signs() {
        let function = |x: f64| x * x * x - 2.0;
        let found = root(function, [(0.0, -2.0), (2.0, 6.0)], 1e-3);
        assert!(function(found).abs() < 1e-3, "{found}");
    }

    #[test]
    fn limits_hold_and_nothing_panics() {
        assert_eq!(2.0.limited(0.0, 1.0), 1.0);
        assert_eq!((-2.0).limited(0.0, 1.0), 0.0);
        assert_eq!(0.5.limited(0.0, 1.0), 0.5);
        assert_eq!(0.5.limited(1.0, 0.0), 0.0);
        assert_eq!(0.5.limited(f64::NAN, f64::NAN), 0.5);
    }
}
