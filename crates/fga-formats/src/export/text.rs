//! Times and names as text.

use chrono::{DateTime, SecondsFormat};
use quick_xml::escape::escape;

/// `2000-01-01T12:00:00.000Z` for seconds since 1970-01-01 00:00 UTC, clamped to the years
/// 0000 to 9999.
pub(super) fn iso(unix_s: f64) -> String {
    // Whole milliseconds first, so that 59.9996 s does not become 60.000 s.
    let millis = libm::rint(unix_s * 1e3).clamp(-62_167_219_200_000.0, 253_402_300_799_999.0);
    #[expect(clippy::cast_possible_truncation, reason = "clamped")]
    let time = DateTime::from_timestamp_millis(millis as i64);
    time.unwrap_or_default()
        .to_rfc3339_opts(SecondsFormat::Millis, true)
}

/// A text with the reserved characters of XML and HTML escaped, and those that XML forbids removed.
pub(super) fn escaped(text: &str) -> String {
    let is_allowed =
        |c: &char| matches!(c, '\t' | '\n' | '\r' | '\u{20}'..='\u{fffd}' | '\u{10000}'..);
    let allowed: String = text.chars().filter(is_allowed).collect();
    escape(allowed).into_owned()
}

#[cfg(test)]
mod tests {
    use super::iso;

    // Checked against `date -u -d @SECONDS +%FT%T`.
    #[test]
    fn times_are_those_of_the_calendar() {
        for (unix_s, text) in [
            (0.0, "1970-01-01T00:00:00.000Z"),
            (946_728_000.0, "2000-01-01T12:00:00.000Z"),
            (1_709_164_799.25, "2024-02-28T23:59:59.250Z"),
            (1_709_164_800.0, "2024-02-29T00:00:00.000Z"),
            (1_440_000_000.999_9, "2015-08-19T16:00:01.000Z"),
            (-1.0, "1969-12-31T23:59:59.000Z"),
            (1e300, "9999-12-31T23:59:59.999Z"),
        ] {
            assert_eq!(iso(unix_s), text);
        }
    }
}
