//! Times as text.

use crate::number::fixed;

/// `2000-01-01T12:00:00.000Z` for seconds since 1970-01-01 00:00 UTC, clamped to the years
/// 0000 to 9999.
pub(super) fn iso(unix_s: f64) -> String {
    // Whole milliseconds first, so that 59.9996 s does not become 60.000 s.
    let millis = libm::rint(unix_s * 1e3).clamp(-62_167_219_200_000.0, 253_402_300_799_999.0);
    let days = libm::floor(millis / 86_400_000.0);
    let in_day_s = (millis - days * 86_400_000.0) / 1e3;
    let (year, month, day) = civil(days);
    let hour = libm::floor(in_day_s / 3600.0);
    let minute = libm::floor((in_day_s - hour * 3600.0) / 60.0);
    let second = in_day_s - hour * 3600.0 - minute * 60.0;
    let second = fixed(second, 3);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:0>6}Z")
}

/// Year, month and day of a number of days since 1970-01-01 in the Gregorian calendar
/// (Howard Hinnant, "chrono-Compatible Low-Level Date Algorithms", `civil_from_days`).
fn civil(days: f64) -> (i64, i64, i64) {
    #[expect(clippy::cast_possible_truncation, reason = "at most some millions")]
    let shifted = days as i64 + 719_468;
    let era = shifted.div_euclid(146_097);
    let day_of_era = shifted.rem_euclid(146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 {
        shifted_month + 3
    } else {
        shifted_month - 9
    };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    (year, month, day)
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
