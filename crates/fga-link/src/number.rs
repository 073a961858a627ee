//! Conversions between the wire's units and the program's, and checks of ranges.

/// 1e-7 degrees to degrees.
pub(crate) fn degrees_from_e7(value: i32) -> f64 {
    f64::from(value) * 1e-7
}

/// Degrees to 1e-7 degrees.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a cast of a float saturates"
)]
pub(crate) fn degrees_to_e7(degrees: f64) -> i32 {
    (degrees * 1e7).round() as i32
}

/// A float of the wire's width.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the wire has single precision"
)]
pub(crate) fn single(value: f64) -> f32 {
    value as f32
}

/// The nearest whole number that fits 16 bits.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a cast of a float saturates"
)]
pub(crate) fn to_u16(value: f64) -> u16 {
    value.round() as u16
}

/// The nearest whole number that fits 16 bits with sign.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a cast of a float saturates"
)]
pub(crate) fn to_i16(value: f64) -> i16 {
    value.round() as i16
}

/// The nearest whole number that fits 32 bits with sign.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a cast of a float saturates"
)]
pub(crate) fn to_i32(value: f64) -> i32 {
    value.round() as i32
}

/// The nearest whole number that fits 64 bits.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a cast of a float saturates"
)]
pub(crate) fn to_u64(value: f64) -> u64 {
    value.round() as u64
}

/// Collects the first value that is out of range.
#[derive(Debug, Default)]
pub(crate) struct Checked(Option<String>);

impl Checked {
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
