//! Numbers as text, the same bytes on every machine.

use std::io::Write as _;

/// Powers of ten that a fixed number of decimals needs.
const POWERS: [f64; 10] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9];

/// The finite number that a text is.
pub(crate) fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// How many whole things a value counts: none below 0, and none for what is not a number.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a fraction does not count, and what is out of range is the nearest number"
)]
pub(crate) const fn count(value: f64) -> usize {
    value as usize
}

/// A value in single precision; one beyond its range becomes infinite.
#[expect(clippy::cast_possible_truncation, reason = "infinite beyond the range")]
pub(crate) const fn single(value: f64) -> f32 {
    value as f32
}

/// Appends `value` with exactly `decimals` decimals (at most nine), never as `-0`.
///
/// Rounds the value times a power of ten to the nearest integer, ties to even: every machine does
/// this arithmetic alike. A value that is not finite becomes `NaN`, `inf` or `-inf`; the standard
/// library writes a value too large for this method.
///
/// ```
/// let mut row = Vec::new();
/// fga_formats::number::push_fixed(&mut row, -0.000_04, 4);
/// assert_eq!(row, b"0.0000");
/// ```
pub fn push_fixed(out: &mut Vec<u8>, value: f64, decimals: usize) {
    let decimals = decimals.min(POWERS.len() - 1);
    let power = POWERS.get(decimals).copied().unwrap_or(1.0);
    let scaled = libm::rint(value * power);
    // Below 2^53 every integer is a float and the product's rounding is the only one.
    if scaled.is_nan() || scaled.abs() >= 9_007_199_254_740_992.0 {
        out.extend_from_slice(format!("{value:.decimals$}").as_bytes());
        return;
    }
    let sign = if scaled < 0.0 { "-" } else { "" };
    let (digits, power) = (count(scaled.abs()), count(power));
    let (whole, fraction) = (digits / power, digits % power);
    // Memory takes all.
    let _ = match decimals {
        0 => write!(out, "{sign}{whole}"),
        _ => write!(out, "{sign}{whole}.{fraction:0decimals$}"),
    };
}

/// `value` with exactly `decimals` decimals; see [`push_fixed`].
pub fn fixed(value: f64, decimals: usize) -> String {
    let mut out = Vec::with_capacity(24);
    push_fixed(&mut out, value, decimals);
    String::from_utf8_lossy(&out).into_owned()
}

/// `value` with at most `decimals` decimals and at least one, as in tables of DAIDALUS: no zeros
/// at the end, 0 for what rounds to nothing, and `infty` for infinity.
///
/// ```
/// use fga_formats::number::trimmed;
///
/// assert_eq!([trimmed(4.5, 6), trimmed(200.0, 6), trimmed(-1e-9, 6)], ["4.5", "200.0", "0.0"]);
/// ```
pub fn trimmed(value: f64, decimals: usize) -> String {
    if value.is_nan() {
        return "NaN".into();
    }
    if value.is_infinite() {
        return if value < 0.0 { "-infty" } else { "infty" }.into();
    }
    // One decimal more decides whether a negative value rounds to nothing.
    let scale = POWERS.get(decimals + 1).copied().unwrap_or(1e9);
    let shown = if value < 0.0 && value * scale > -0.5 {
        0.0
    } else {
        value + 0.0
    };
    let text = format!("{shown:.decimals$}");
    let Some((whole, fraction)) = text.split_once('.') else {
        return text;
    };
    let kept = fraction.trim_end_matches('0');
    format!("{whole}.{}", if kept.is_empty() { "0" } else { kept })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn known_numbers() {
        for (value, decimals, text) in [
            (0.0, 0, "0"),
            (-0.0, 2, "0.00"),
            (1.0, 0, "1"),
            (-1.5, 1, "-1.5"),
            (0.000_123, 6, "0.000123"),
            (123_456.789, 4, "123456.7890"),
            (9.999_96, 4, "10.0000"),
            (-0.05, 4, "-0.0500"),
            (1e300, 1, &format!("{:.1}", 1e300)),
            (f64::NAN, 3, "NaN"),
            (f64::INFINITY, 3, "inf"),
        ] {
            assert_eq!(fixed(value, decimals), text);
        }
    }

    proptest! {
        #[test]
        fn reads_back_within_half_a_unit_of_the_last_place(value in -1e9..1e9_f64, decimals in 0..7_usize) {
            let text = fixed(value, decimals);
            let back: f64 = text.parse().unwrap();
            prop_assert!((back - value).abs() <= 0.5 / POWERS[decimals] + value.abs() * 1e-15);
            let fraction = text.split_once('.').map_or(0, |(_, fraction)| fraction.len());
            prop_assert_eq!(fraction, decimals);
        }

        #[test]
        fn any_float_is_written(bits: u64, decimals in 0..20_usize) {
            let value = f64::from_bits(bits);
            let back: f64 = fixed(value, decimals).parse().unwrap();
            prop_assert_eq!(back.is_nan(), value.is_nan());
        }
    }
}
