//! The date and time of a BaseStation line.

use chrono::{Datelike, NaiveDate, NaiveTime, Timelike};

/// Seconds from 1970-01-01 to a date `YYYY/MM/DD` and a time `hh:mm:ss.fff`.
pub(super) fn instant_s(date: &str, time: &str) -> Option<f64> {
    let date = NaiveDate::parse_from_str(&date.replace('-', "/"), "%Y/%m/%d").ok()?;
    // What mlat-client writes for 999.5 ms and more.
    let late = time.strip_suffix(".1000");
    let clock = NaiveTime::parse_from_str(late.unwrap_or(time), "%H:%M:%S%.f").ok()?;
    let late_s = if late.is_some() { 1.0 } else { 0.0 };
    let second_s = f64::from(clock.nanosecond()) * 1e-9 + late_s;
    let day_s = f64::from(clock.num_seconds_from_midnight()) + second_s;
    let midnight = date.and_time(NaiveTime::MIN).and_utc().timestamp();
    (1..=9999)
        .contains(&date.year())
        .then_some(midnight as f64 + day_s)
}
