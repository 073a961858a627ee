//! The date and time of a BaseStation line.

use chrono::{NaiveDate, NaiveTime};

/// Seconds from 1970-01-01 to a date `YYYY/MM/DD` and a time `hh:mm:ss.fff`.
pub(super) fn instant_s(date: &str, time: &str) -> Option<f64> {
    let mut parts = date.split(['/', '-']);
    let mut next = || parts.next()?.parse::<u32>().ok();
    let (year, month, day) = (next()?.cast_signed(), next()?, next()?);
    if parts.next().is_some() || !(1..=9999).contains(&year) {
        return None;
    }
    let date = NaiveDate::from_ymd_opt(year, month, day)?.and_time(NaiveTime::MIN);
    let mut parts = time.split(':');
    let (hour, minute, second) = (parts.next()?, parts.next()?, parts.next()?);
    let (hour, minute): (u32, u32) = (hour.parse().ok()?, minute.parse().ok()?);
    let (second, fraction) = second.split_once('.').unwrap_or((second, "0"));
    let second: u32 = second.parse().ok()?;
    let thousandths: f64 = match fraction {
        // What mlat-client writes for 999.5 ms and more.
        "1000" => 1000.0,
        _ if !fraction.bytes().all(|byte| byte.is_ascii_digit()) => return None,
        _ => format!("0.{fraction}").parse::<f64>().ok()? * 1000.0,
    };
    let is_time = parts.next().is_none() && hour < 24 && minute < 60 && second <= 60;
    let day_s = f64::from(hour * 3600 + minute * 60 + second) + thousandths / 1000.0;
    is_time.then(|| date.and_utc().timestamp() as f64 + day_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times of `date -u -d … +%s`.
    #[test]
    fn t1_days_follow_each_other_at_month_ends() {
        for (date, time, expected_s) in [
            ("1970/01/01", "00:00:00.000", 0.0),
            ("2024/02/28", "23:59:59.000", 1_709_164_799.0),
            ("2024/02/29", "00:00:00.000", 1_709_164_800.0),
            ("2024/03/01", "00:00:00.500", 1_709_251_200.5),
            ("2026/04/30", "23:59:59.1000", 1_777_593_600.0),
            ("2026-05-01", "00:00:00", 1_777_593_600.0),
            ("2000/12/31", "23:59:59.25", 978_307_199.25),
        ] {
            assert_eq!(instant_s(date, time), Some(expected_s), "{date} {time}");
        }
        for (date, time) in [
            ("", ""),
            ("2024/13/01", "00:00:00"),
            ("2024/00/01", "00:00:00"),
            ("2024/01/01", "24:00:00"),
            ("2024/01/01/01", "00:00:00"),
            ("2024/01/01", "00:00"),
            ("2024/01/01", "00:00:0x"),
            ("2024/01/01", "00:00:00.e9"),
        ] {
            assert_eq!(instant_s(date, time), None, "{date} {time}");
        }
    }
}
