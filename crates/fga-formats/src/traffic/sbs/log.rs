//! Recorded BaseStation lines.

use std::io::{BufRead, BufReader, Read};

use super::message::{fields, parse, text_of, without_offset};
use super::time;
use crate::tally::{LeftOut, Tally};
use crate::traffic::TrafficReport;
use crate::traffic::lines::LONGEST_LINE;

/// A longer time of a recorder is a cut line or two in one, nanoseconds (some 30 years).
const LONGEST_NS: u64 = 1_000_000_000_000_000_000;

/// One line of a recording with its time.
#[derive(Debug, Clone, PartialEq)]
pub struct LoggedLine {
    /// Time, seconds: of the recorder, else since 1970.
    pub time_s: f64,
    /// The line without the recorder's time and without its end.
    pub line: String,
    /// What it reports, or why it reports nothing.
    pub report: Result<TrafficReport, LeftOut>,
}

/// Reads recorded BaseStation lines.
///
/// Their times are a recorder's nanoseconds where lines have them, as from Stratux, else the date and time at
/// which the message was received, as receivers write it. After a restart of a recorder that counts from zero
/// the recording goes on without a gap. Lines without a time are left out and counted.
#[derive(Debug)]
pub struct Log<R> {
    input: R,
    /// Shift of the recorder's times, and the last of them, nanoseconds.
    shift_ns: u64,
    last_ns: Option<u64>,
    tally: Tally,
}

impl<R: Read> Log<BufReader<R>> {
    /// The recording in `input`, which is not compressed.
    pub fn new(input: R) -> Self {
        Self {
            input: BufReader::new(input),
            shift_ns: 0,
            last_ns: None,
            tally: Tally::default(),
        }
    }
}

impl<R: BufRead> Log<R> {
    /// Counts of the lines so far.
    pub const fn tally(&self) -> Tally {
        self.tally
    }

    /// The next line, cut after [`LONGEST_LINE`]; `None` at the end or when the input fails.
    fn next_raw(&mut self) -> Option<Vec<u8>> {
        let mut line = Vec::new();
        // One byte more than accepted, so that a cut line shows as too long.
        let mut part = self.input.by_ref().take(LONGEST_LINE as u64 + 1);
        let read = part.read_until(b'\n', &mut line);
        if line.pop_if(|byte| *byte == b'\n').is_none() && line.len() > LONGEST_LINE {
            self.input.skip_until(b'\n').ok()?;
        }
        (read.is_ok_and(|count| count > 0) || !line.is_empty()).then_some(line)
    }

    /// A line with its time.
    fn timed(&mut self, raw: &[u8]) -> Result<LoggedLine, LeftOut> {
        let (offset_ns, line) = without_offset(text_of(raw)?);
        let report = parse(line);
        let time_s = match offset_ns {
            Some(time_ns) if time_ns <= LONGEST_NS => self.recorder_s(time_ns),
            Some(_) => return Err(LeftOut::UnreadableField),
            // Without a report a line needs no time either.
            None => received_s(line).ok_or(report.err().unwrap_or(LeftOut::NoTime))?,
        };
        Ok(LoggedLine {
            time_s,
            line: line.to_owned(),
            report,
        })
    }

    /// The time of a recorder, seconds, without the gaps of its restarts.
    fn recorder_s(&mut self, time_ns: u64) -> f64 {
        if let Some(last_ns) = self.last_ns
            && time_ns < last_ns
        {
            self.shift_ns = self.shift_ns.saturating_add(last_ns - time_ns);
        }
        self.last_ns = Some(time_ns);
        time_ns.saturating_add(self.shift_ns) as f64 / 1e9
    }
}

/// The time at which the message of a line was received, else sent, seconds.
fn received_s(line: &str) -> Option<f64> {
    let mut fields = fields(line).skip(6);
    let mut next = || fields.next().unwrap_or_default();
    let (date, time, sent_date, sent_time) = (next(), next(), next(), next());
    time::instant_s(date, time).or_else(|| time::instant_s(sent_date, sent_time))
}

impl<R: BufRead> Iterator for Log<R> {
    type Item = LoggedLine;

    fn next(&mut self) -> Option<LoggedLine> {
        loop {
            let raw = self.next_raw()?;
            match self.timed(&raw) {
                Ok(logged) => {
                    self.tally.take(&logged.report);
                    return Some(logged);
                }
                Err(reason) => self.tally.leave_out(reason),
            }
        }
    }
}
