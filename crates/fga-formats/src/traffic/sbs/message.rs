//! Messages as lines of text.

use core::str::from_utf8;

use super::time;
use crate::geodesy::course_from_compass_rad;
use crate::tally::LeftOut;
use crate::traffic::lines::LONGEST_LINE;
use crate::traffic::{Altitude, Callsign, TrafficReport, address_of};
use crate::units::{FOOT_M, FOOT_PER_MINUTE_MPS, KNOT_MPS};

/// Fields of a message.
pub(super) const FIELDS: usize = 22;

/// Place of the position's error behind them in lines that begin with `MLAT`.
pub(super) const MLAT_ERROR: usize = 24;

/// First words of lines about other things than an aircraft's state.
pub(super) const OTHER_WORDS: [&str; 7] = ["STA", "AIR", "ID", "SEL", "CLK", "CLICK", "START"];

/// A message sent longer after its reception is too old, seconds.
pub(super) const OLDEST_S: f64 = 30.0;

/// A larger difference of its two times is one of clocks, not an age, seconds (as in readsb).
pub(super) const CLOCKS_S: f64 = 1200.0;

/// A position is within this many σ in 95 of 100 cases: √(−2 ln 0.05). `MLAT` lines have the σ of all axes
/// together.
pub(super) const SIGMAS_IN_95: f64 = 2.4477;

/// The report in one line.
///
/// Before the first word the line may have a time in nanoseconds, as in Stratux recordings.
///
/// # Errors
/// Why the line holds no report.
///
/// ```
/// use fga_formats::traffic::sbs;
///
/// let line = b"MSG,3,1,1,4CA2D6,1,,,,,,37000,,,51.45735,-1.02826,,,0,0,0,0";
/// let report = sbs::parse_line(line).expect("a position");
/// assert_eq!(report.address, 0x4C_A2D6);
/// assert_eq!(report.altitude.map(|a| a.metres()), Some(37_000.0 * 0.3048));
/// ```
pub fn parse_line(line: &[u8]) -> Result<TrafficReport, LeftOut> {
    parse(without_offset(text_of(line)?).1)
}

/// The text of a line.
pub(super) fn text_of(line: &[u8]) -> Result<&str, LeftOut> {
    if line.len() > LONGEST_LINE {
        return Err(LeftOut::TooLong);
    }
    let text = from_utf8(line).map_err(|_| LeftOut::UnreadableField)?;
    Ok(text.trim())
}

/// A recorder's nanoseconds before a line, and the line without them.
pub(super) fn without_offset(line: &str) -> (Option<u64>, &str) {
    line.split_once(',')
        .and_then(|(first, rest)| {
            let is_number = !first.is_empty() && first.bytes().all(|byte| byte.is_ascii_digit());
            is_number.then_some((first.parse().ok(), rest))
        })
        .unwrap_or((None, line))
}

/// The fields of a line: commas in quotes do not end one.
pub(super) fn fields(line: &str) -> impl Iterator<Item = &str> {
    let mut is_quoted = false;
    line.split(move |letter| {
        is_quoted ^= letter == '"';
        letter == ',' && !is_quoted
    })
    .map(|field| field.trim().trim_matches('"').trim())
}

/// Whether a line is of the kind that a recording of BaseStation lines begins with.
pub(crate) fn is_message(line: &str) -> bool {
    let (_, line) = without_offset(line.trim());
    let mut fields = fields(line);
    let word = fields.next().unwrap_or_default();
    let kind = fields.next().unwrap_or_default();
    let is_kind = kind.len() <= 1 && kind.bytes().all(|byte| byte.is_ascii_digit());
    is_kind && (matches!(word, "MSG" | "MLAT") || OTHER_WORDS[..5].contains(&word))
}

/// The report in a line without a recorder's time.
pub(super) fn parse(line: &str) -> Result<TrafficReport, LeftOut> {
    let fields: Vec<&str> = fields(line).collect();
    let field = |index: usize| fields.get(index).copied().unwrap_or_default();
    let (count, word, kind) = (fields.len(), field(0), field(1));
    if line.is_empty() || OTHER_WORDS.contains(&word) {
        return Err(LeftOut::NotNeeded);
    }
    let is_word = (2..=8).contains(&word.len()) && word.bytes().all(|b| b.is_ascii_alphabetic());
    if !is_word || (count < FIELDS && !matches!(word, "MSG" | "MLAT")) {
        return Err(LeftOut::UnknownKind);
    }
    if count < FIELDS {
        return Err(LeftOut::CutShort);
    }
    if kind.len() > 1 || kind.bytes().any(|byte| !byte.is_ascii_digit()) {
        return Err(LeftOut::UnreadableField);
    }
    let address = address_of(field(4)).ok_or(LeftOut::NoAddress)?;
    let latitude_deg = number(field(14), 90.0)?;
    let longitude_deg = number(field(15), 180.0)?;
    let place_deg = match (latitude_deg, longitude_deg) {
        // Senders without a position write zeros.
        (Some(0.0), Some(0.0)) | (None, _) | (_, None) => None,
        (Some(latitude_deg), Some(longitude_deg)) => Some([latitude_deg, longitude_deg]),
    };
    let speed_kn = number(field(12), 4000.0)?.filter(|speed| *speed >= 0.0);
    let error_m = if word == "MLAT" {
        number(field(MLAT_ERROR), 1e9)?.filter(|error_m| *error_m > 0.0)
    } else {
        None
    };
    let report = TrafficReport {
        address,
        callsign: Callsign::new(field(10)),
        place_deg,
        altitude: altitude_of(field(11))?,
        ground_speed_mps: speed_kn.map(|knots| knots * KNOT_MPS),
        course_rad: number(field(13), 360.0)?.map(course_from_compass_rad),
        climb_mps: number(without_geometric(field(16)), 60_000.0)?
            .map(|fpm| fpm * FOOT_PER_MINUTE_MPS),
        on_ground: match field(21) {
            "" => None,
            "0" => Some(false),
            "1" | "-1" => Some(true),
            _ => return Err(LeftOut::UnreadableField),
        },
        position_error_m: error_m.map(|sigma_m| sigma_m * SIGMAS_IN_95),
        ..TrafficReport::default()
    };
    if report.says_nothing() {
        return Err(LeftOut::NotNeeded);
    }
    let age_s = time::instant_s(field(6), field(7))
        .zip(time::instant_s(field(8), field(9)))
        .map_or(0.0, |(heard_s, sent_s)| sent_s - heard_s);
    match age_s {
        0.0..=OLDEST_S => Ok(TrafficReport { age_s, ..report }),
        OLDEST_S..=CLOCKS_S => Err(LeftOut::TooOld),
        _ => Ok(report),
    }
}

/// An altitude in feet; `H` behind it says that satellites measured it.
pub(super) fn altitude_of(text: &str) -> Result<Option<Altitude>, LeftOut> {
    let digits = without_geometric(text);
    let is_geometric = digits.len() < text.len();
    let altitude = number(digits, 150_000.0)?.map(|feet| feet * FOOT_M);
    Ok(altitude.map(if is_geometric {
        Altitude::Ellipsoid
    } else {
        Altitude::Pressure
    }))
}

pub(super) fn without_geometric(text: &str) -> &str {
    text.strip_suffix(['H', 'h']).unwrap_or(text)
}

/// A number within ±`largest`; `None` for an empty field.
pub(super) fn number(text: &str, largest: f64) -> Result<Option<f64>, LeftOut> {
    if text.is_empty() {
        return Ok(None);
    }
    let value: f64 = text.parse().map_err(|_| LeftOut::UnreadableField)?;
    if value.abs() <= largest {
        Ok(Some(value))
    } else {
        Err(LeftOut::UnreadableField)
    }
}
