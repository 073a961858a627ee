//! BaseStation lines, as receivers and `dump1090` send them on port 30003.
//!
//! One message is a line of 22 fields separated by commas:
//! `MSG,type,session,aircraft,address,flight,date,time,date,time,callsign,altitude,ground speed,
//! track,latitude,longitude,vertical rate,squawk,alert,emergency,identification,on ground`.
//! Units: feet, knots, degrees from true north, degrees, feet per minute. A line with fewer fields is
//! cut and skipped, because its last number may be cut too.

use super::{Altitude, Callsign, Counts, TrafficReport};
use crate::error::InputError;
use crate::geodesy::{compass_from_course_deg, course_from_compass_rad};
use crate::number::push_fixed;
use crate::units::{Feet, FeetPerMinute, Knots};
use core::str::from_utf8;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write as _};
use std::path::Path;

/// Longest accepted line, bytes.
const LONGEST_LINE: usize = 512;
/// Fields of a message.
const FIELDS: usize = 22;

/// The report in one line; `None` if it holds none.
///
/// Before `MSG` the line may have a time in nanoseconds, as in Stratux recordings.
///
/// ```
/// use fga_formats::traffic::sbs;
///
/// let line = b"MSG,3,1,1,4CA2D6,1,,,,,,37000,,,51.45735,-1.02826,,,0,0,0,0";
/// let report = sbs::parse_line(line).expect("a position");
/// assert_eq!(report.address, 0x4C_A2D6);
/// assert_eq!(report.altitude.map(|a| a.metres()), Some(37_000.0 * 0.3048));
/// ```
pub fn parse_line(line: &[u8]) -> Option<TrafficReport> {
    parse(line).ok().flatten()
}

/// An incomplete message.
struct Damaged;

/// The report in a line; `None` for another kind or no useful content.
fn parse(line: &[u8]) -> Result<Option<TrafficReport>, Damaged> {
    let line = from_utf8(line).map_err(|_| Damaged)?.trim();
    let mut fields = [""; FIELDS];
    let mut count = 0;
    for field in line.split(',') {
        // A recording's time before the message.
        if count == 0 && !field.is_empty() && field.bytes().all(|byte| byte.is_ascii_digit()) {
            continue;
        }
        if let Some(place) = fields.get_mut(count) {
            *place = field.trim();
        }
        count += 1;
    }
    if fields.first() != Some(&"MSG") {
        return Ok(None);
    }
    if count != FIELDS {
        return Err(Damaged);
    }
    let [
        _,
        kind,
        _,
        _,
        address,
        _,
        _,
        _,
        _,
        _,
        callsign,
        altitude,
        ground_speed,
        track,
        latitude,
        longitude,
        climb,
        _,
        _,
        _,
        _,
        on_ground,
    ] = fields;
    if !matches!(kind, "1" | "2" | "3" | "4" | "5" | "6" | "7" | "8") {
        return Err(Damaged);
    }
    let address = u32::from_str_radix(address, 16)
        .ok()
        .filter(|address| address >> 24 == 0 && *address != 0)
        .ok_or(Damaged)?;
    let latitude_deg = number(latitude, 90.0)?;
    let longitude_deg = number(longitude, 180.0)?;
    let place_deg = match (latitude_deg, longitude_deg) {
        // Senders without a position write zeros.
        (Some(0.0), Some(0.0)) | (None, _) | (_, None) => None,
        (Some(latitude_deg), Some(longitude_deg)) => Some([latitude_deg, longitude_deg]),
    };
    let speed_kn = number(ground_speed, 4000.0)?.filter(|speed| *speed >= 0.0);
    let report = TrafficReport {
        address,
        callsign: Callsign::new(callsign),
        place_deg,
        altitude: number(altitude, 150_000.0)?.map(|feet| Altitude::Pressure(Feet(feet).to_m())),
        ground_speed_mps: speed_kn.map(|knots| Knots(knots).to_mps()),
        course_rad: number(track, 360.0)?.map(course_from_compass_rad),
        climb_mps: number(climb, 60_000.0)?.map(|fpm| FeetPerMinute(fpm).to_mps()),
        on_ground: match on_ground {
            "0" => Some(false),
            "1" | "-1" => Some(true),
            _ => None,
        },
        containment_m: None,
        position_error_m: None,
        source_integrity: None,
        velocity_error_mps: None,
    };
    let nothing = TrafficReport {
        address,
        ..TrafficReport::default()
    };
    Ok((report != nothing).then_some(report))
}

/// A number within ±`largest`; none for an empty field.
fn number(text: &str, largest: f64) -> Result<Option<f64>, Damaged> {
    if text.is_empty() {
        return Ok(None);
    }
    let value: f64 = text.parse().map_err(|_| Damaged)?;
    if value.is_finite() && value.abs() <= largest {
        Ok(Some(value))
    } else {
        Err(Damaged)
    }
}

/// Takes the bytes of a connection as they come and gives reports.
#[derive(Debug, Clone, Default)]
pub struct Stream {
    line: Vec<u8>,
    too_long: bool,
    counts: Counts,
}

impl Stream {
    /// A stream at its beginning.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes bytes and calls `report` for each report in them.
    pub fn push(&mut self, bytes: &[u8], mut report: impl FnMut(TrafficReport)) {
        for byte in bytes {
            if *byte != b'\n' {
                if self.line.len() < LONGEST_LINE {
                    self.line.push(*byte);
                } else {
                    self.too_long = true;
                }
                continue;
            }
            let parsed = if self.too_long {
                Err(Damaged)
            } else {
                parse(&self.line)
            };
            match parsed {
                Ok(Some(found)) => {
                    self.counts.reports += 1;
                    report(found);
                }
                Ok(None) => self.counts.ignored += 1,
                Err(Damaged) => self.counts.damaged += 1,
            }
            self.line.clear();
            self.too_long = false;
        }
    }

    /// Counts of accepted and skipped lines so far.
    pub const fn counts(&self) -> Counts {
        self.counts
    }
}

/// Appends a report as BaseStation lines: identification, position and velocity, if the
/// report has them.
pub fn push_lines(out: &mut Vec<u8>, report: &TrafficReport) {
    let mut line = |kind: u8, fill: &dyn Fn(&mut [Vec<u8>; FIELDS])| {
        let mut fields: [Vec<u8>; FIELDS] = core::array::from_fn(|_| Vec::new());
        fields[0].extend(b"MSG");
        fields[1].push(kind);
        fields[2].push(b'1');
        fields[3].push(b'1');
        let _ = write!(fields[4], "{:06X}", report.address);
        fields[5].push(b'1');
        if let Some(on_ground) = report.on_ground {
            fields[21].extend(if on_ground { &b"-1"[..] } else { b"0" });
        }
        fill(&mut fields);
        out.extend(fields.join(&b','));
        out.extend(b"\r\n");
    };
    let altitude_ft = report.altitude.map(|a| Feet::from_m(a.metres()).0);
    if let Some(callsign) = report.callsign {
        line(b'1', &|fields| {
            fields[10].extend(callsign.as_str().bytes());
        });
    }
    if report.place_deg.is_some() || altitude_ft.is_some() {
        line(b'3', &|fields| {
            if let Some(feet) = altitude_ft {
                push_fixed(&mut fields[11], feet, 0);
            }
            if let Some([latitude_deg, longitude_deg]) = report.place_deg {
                push_fixed(&mut fields[14], latitude_deg, 6);
                push_fixed(&mut fields[15], longitude_deg, 6);
            }
        });
    }
    if report.ground_speed_mps.is_some() || report.climb_mps.is_some() {
        line(b'4', &|fields| {
            if let Some(speed_mps) = report.ground_speed_mps {
                push_fixed(&mut fields[12], Knots::from_mps(speed_mps).0, 1);
            }
            if let Some(course_rad) = report.course_rad {
                push_fixed(&mut fields[13], compass_from_course_deg(course_rad), 1);
            }
            if let Some(climb_mps) = report.climb_mps {
                push_fixed(&mut fields[16], FeetPerMinute::from_mps(climb_mps).0, 0);
            }
        });
    }
}

/// One line of a recording and its time.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedLine {
    /// Time since the recording's first line, seconds; never goes back.
    pub time_s: f64,
    /// The message without the recording's own time, without the line's end.
    pub line: Vec<u8>,
}

/// Reads a recording of BaseStation lines, each with a leading time in nanoseconds, as from Stratux;
/// compressed (gzip) or not.
///
/// After a restart of the recorder (a `START` line, or times that go back) the recording continues
/// without a gap. Damaged lines are skipped.
#[derive(Debug)]
pub struct Recording<R> {
    input: R,
    /// Offset of the file's times, and the last time of the file, nanoseconds.
    shift_ns: u64,
    last_ns: Option<u64>,
    first_ns: Option<u64>,
}

impl Recording<BufReader<Box<dyn Read + Send>>> {
    /// Opens a recording.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn open(path: &Path) -> Result<Self, InputError> {
        let unreadable = |error| InputError::unreadable(path, &error);
        let mut file = BufReader::new(File::open(path).map_err(unreadable)?);
        let compressed = file
            .fill_buf()
            .map_err(unreadable)?
            .starts_with(&[0x1f, 0x8b]);
        let input: Box<dyn Read + Send> = if compressed {
            Box::new(flate2::read::MultiGzDecoder::new(file))
        } else {
            Box::new(file)
        };
        Ok(Self::new(BufReader::new(input)))
    }
}

impl<R: BufRead> Recording<R> {
    /// The recording in `input`.
    pub const fn new(input: R) -> Self {
        Self {
            input,
            shift_ns: 0,
            last_ns: None,
            first_ns: None,
        }
    }

    /// The next line, cut at [`LONGEST_LINE`]; `None` at the end or when the input fails.
    fn next_raw(&mut self) -> Option<Vec<u8>> {
        let mut line = Vec::new();
        loop {
            let buffer = match self.input.fill_buf() {
                Ok(buffer) if !buffer.is_empty() => buffer,
                _ => return (!line.is_empty()).then_some(line),
            };
            let end = buffer.iter().position(|byte| *byte == b'\n');
            let part = buffer
                .get(..end.unwrap_or(buffer.len()))
                .unwrap_or_default();
            // One byte more than accepted, so that a cut line shows as too long.
            let room = (LONGEST_LINE + 1).saturating_sub(line.len());
            line.extend(part.iter().take(room));
            let used = part.len() + usize::from(end.is_some());
            self.input.consume(used);
            if end.is_some() {
                return Some(line);
            }
        }
    }
}

impl<R: BufRead> Iterator for Recording<R> {
    type Item = RecordedLine;

    fn next(&mut self) -> Option<RecordedLine> {
        loop {
            let raw = self.next_raw()?;
            let Some((time, line)) = from_utf8(&raw)
                .ok()
                .filter(|_| raw.len() <= LONGEST_LINE)
                .and_then(|line| line.trim().split_once(','))
            else {
                continue;
            };
            let Ok(time_ns) = time.parse::<u64>() else {
                continue;
            };
            // Some 30 years: a longer time is a cut line or two in one.
            if !line.starts_with("MSG,") || time_ns > 1_000_000_000_000_000_000 {
                continue;
            }
            if let Some(last_ns) = self.last_ns
                && time_ns < last_ns
            {
                self.shift_ns = self.shift_ns.saturating_add(last_ns - time_ns);
            }
            self.last_ns = Some(time_ns);
            let due_ns = time_ns.saturating_add(self.shift_ns);
            let first_ns = *self.first_ns.get_or_insert(due_ns);
            return Some(RecordedLine {
                time_s: (due_ns - first_ns) as f64 / 1e9,
                line: line.as_bytes().to_vec(),
            });
        }
    }
}
