//! Limits a number without a panic, and describes a value out of range.

/// Largest accepted magnitude of a coordinate (metres) or a velocity (metres per second):
/// far beyond any flight, and small enough that no product of four overflows.
pub const LARGEST: f64 = 1e15;

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
        write!(
            f,
            "{} is {}, expected {}",
            self.name, self.value, self.expected
        )
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
    fn limits_hold_and_nothing_panics() {
        assert_eq!(2.0.limited(0.0, 1.0), 1.0);
        assert_eq!((-2.0).limited(0.0, 1.0), 0.0);
        assert_eq!(0.5.limited(0.0, 1.0), 0.5);
        assert_eq!(0.5.limited(1.0, 0.0), 0.0);
        assert_eq!(0.5.limited(f64::NAN, f64::NAN), 0.5);
    }
}
