//! Signals of a log at one steady rate.

use core::f64::consts::{PI, TAU};

use super::phases::{Limits, Phases};
use crate::tally::Tally;

/// Longest time between two samples of the bank and its command, seconds.
const SLOWEST_BANK_S: f64 = 0.25;
/// Longest time between two samples of the other signals, seconds.
const SLOWEST_OTHER_S: f64 = 1.0;
/// Share by which the median of a stream's periods may be longer: messages come with jitter.
const JITTER: f64 = 0.05;
/// A log is brought to at most this rate, seconds from row to row.
const SHORTEST_PERIOD_S: f64 = 0.05;
/// A signal without a sample for longer has a gap, seconds.
const GAP_S: f64 = 1.5;
/// An aircraft slower than this share of its cruise does not fly.
const FLYING_SHARE: f64 = 0.5;
/// An aircraft whose airspeed is below this for nine tenths of a log never flies, metres per second: wind in a tube.
const FLIES_MPS: f64 = 6.0;
/// Shorter pieces of flight are left out, seconds.
const SHORTEST_PIECE_S: f64 = 5.0;
/// A log longer than this is not brought to a steady rate, rows.
const MOST_ROWS: f64 = 2e7;

/// A signal: times and values.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Series(Vec<(f64, f64)>);

impl Series {
    pub(super) fn push(&mut self, time_s: f64, value: f64) {
        if time_s.is_finite() && value.is_finite() {
            self.0.push((time_s, value));
        }
    }

    /// The value that it never leaves.
    pub(super) fn constant(&self) -> Option<f64> {
        let first = self.0.first()?.1;
        self.0
            .iter()
            .all(|sample| sample.1 == first)
            .then_some(first)
    }

    /// Whether it comes often enough for a bank.
    pub(super) fn is_fast(&self) -> bool {
        self.period_s() <= SLOWEST_BANK_S * (1.0 + JITTER)
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// In order of time, one value for each time.
    fn sort(&mut self) {
        self.0.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.0.dedup_by(|later, earlier| later.0 == earlier.0);
    }

    /// Takes out the jumps of a full turn.
    fn unwrap(&mut self) {
        let mut turns = 0.0;
        let mut last = None;
        for (_, value) in &mut self.0 {
            if let Some(last) = last {
                let step: f64 = *value - last;
                if step.abs() > PI {
                    turns -= libm::round(step / TAU) * TAU;
                }
            }
            last = Some(*value);
            *value += turns;
        }
    }

    /// Median time from sample to sample, seconds.
    fn period_s(&self) -> f64 {
        let mut steps: Vec<f64> = self
            .0
            .iter()
            .zip(self.0.iter().skip(1))
            .map(|(a, b)| b.0 - a.0)
            .collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY)
    }

    /// The value at a time, between two samples that are no gap apart; `from` is where the search begins
    /// and is moved on.
    fn at(&self, time_s: f64, from: &mut usize) -> Option<f64> {
        while self.0.get(*from + 1).is_some_and(|next| next.0 <= time_s) {
            *from += 1;
        }
        let (before_s, before) = *self.0.get(*from)?;
        if before_s == time_s {
            return Some(before);
        }
        let (after_s, after) = *self.0.get(*from + 1)?;
        if before_s > time_s || after_s - before_s > GAP_S {
            return None;
        }
        Some(before + (after - before) * (time_s - before_s) / (after_s - before_s))
    }

    /// A signal from this one and another at the same times; times at which there is no other are left out.
    pub(super) fn over(&self, other: &Self, of: impl Fn(f64, f64) -> Option<f64>) -> Self {
        let mut sorted = other.clone();
        sorted.sort();
        let mut mine = self.clone();
        mine.sort();
        let mut from = 0;
        let mut result = Self::default();
        for (time_s, value) in mine.0 {
            let found = sorted
                .at(time_s, &mut from)
                .and_then(|other| of(value, other));
            if let Some(found) = found {
                result.push(time_s, found);
            }
        }
        result
    }

    fn span_s(&self) -> Option<(f64, f64)> {
        Some((self.0.first()?.0, self.0.last()?.0))
    }
}

/// What a log says, each signal at its own rate.
#[derive(Debug, Default)]
pub(super) struct Signals {
    pub(super) airspeed_mps: Series,
    pub(super) bank_command_rad: Series,
    pub(super) bank_rad: Series,
    pub(super) course_rad: Series,
    pub(super) climb_rad: Series,
    /// Why the log shows no flight, whatever its signals.
    pub(super) never_flies: Option<String>,
    /// When an avoider would fly.
    pub(super) phases: Phases,
    pub(super) limits: Limits,
    /// What holds each signal in files of this kind, in the order of the fields.
    pub(super) sources: [&'static str; 5],
    /// What became of the messages or rows.
    pub(super) tally: Tally,
}

/// A part of a log in which the aircraft flies and every signal is there, at a steady rate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SeriesPiece {
    /// Time of the first row, seconds, as the log counts them.
    pub start_s: f64,
    /// Airspeed, metres per second.
    pub airspeed_mps: Vec<f64>,
    /// Commanded bank, radians.
    pub bank_command_rad: Vec<f64>,
    /// Flown bank, radians.
    pub bank_rad: Vec<f64>,
    /// Course through the air, radians, without jumps.
    pub course_rad: Vec<f64>,
    /// Climb angle of the path, radians.
    pub climb_rad: Vec<f64>,
}

impl SeriesPiece {
    /// Number of rows.
    pub const fn len(&self) -> usize {
        self.bank_rad.len()
    }

    /// Whether it has no row.
    pub const fn is_empty(&self) -> bool {
        self.bank_rad.is_empty()
    }
}

/// A log at a steady rate, in pieces without gaps.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FlightLog {
    /// Time from row to row, seconds.
    pub period_s: f64,
    /// Limits of the vehicle, as far as the log has them.
    pub limits: Limits,
    /// The pieces in order of time; there is at least one.
    pub pieces: Vec<SeriesPiece>,
    /// What became of the messages or rows of the file.
    pub tally: Tally,
}

impl Signals {
    /// The series, in the order of the fields.
    pub(super) const fn each(&mut self) -> [&mut Series; 5] {
        [
            &mut self.airspeed_mps,
            &mut self.bank_command_rad,
            &mut self.bank_rad,
            &mut self.course_rad,
            &mut self.climb_rad,
        ]
    }

    /// The signals at one rate.
    pub(super) fn log(mut self) -> Result<FlightLog, String> {
        let names = [
            "airspeed",
            "commanded bank",
            "bank",
            "course",
            "climb angle",
        ];
        let sources = self.sources;
        let cruise_mps = self.cruise_mps();
        if let Some(reason) = self.never_flies {
            return Err(format!("never flies: {reason}, expected a flight"));
        }
        if !self.airspeed_mps.is_empty() && cruise_mps < FLIES_MPS {
            return Err(format!(
                "never flies: its airspeed is below {cruise_mps:.1} m/s nine tenths of the time ({}), expected a flight",
                sources[0]
            ));
        }
        let mut span_s = (f64::NEG_INFINITY, f64::INFINITY);
        for (series, (name, source)) in self.each().into_iter().zip(names.iter().zip(sources)) {
            series.sort();
            let Some((first, last)) = series.span_s() else {
                return Err(format!("has no {name}, expected {source}"));
            };
            span_s = (span_s.0.max(first), span_s.1.min(last));
            let is_bank = name.ends_with("bank");
            let slowest_s = if is_bank {
                SLOWEST_BANK_S
            } else {
                SLOWEST_OTHER_S
            };
            let found_s = series.period_s();
            if found_s > slowest_s * (1.0 + JITTER) {
                return Err(format!(
                    "has the {name} every {found_s:.3} s ({source}), expected it at least every {slowest_s} s"
                ));
            }
        }
        self.course_rad.unwrap();
        let period_s = self.bank_rad.period_s().max(SHORTEST_PERIOD_S);
        let rows = (span_s.1 - span_s.0) / period_s;
        if rows > MOST_ROWS {
            return Err(format!(
                "lasts {:.0} s, expected a flight",
                span_s.1 - span_s.0
            ));
        }
        let pieces = self.pieces(span_s, period_s);
        if pieces.is_empty() {
            return Err(format!(
                "has no {SHORTEST_PIECE_S} s of flight in which every signal is there without a gap, in a mode in which \
                 an avoider flies, outside of take-off and landing"
            ));
        }
        Ok(FlightLog {
            period_s,
            limits: self.limits,
            pieces,
            tally: self.tally,
        })
    }

    /// What is flown, in pieces.
    fn pieces(&self, span_s: (f64, f64), period_s: f64) -> Vec<SeriesPiece> {
        let flying_mps = FLYING_SHARE * self.cruise_mps();
        let mut places = [0; 5];
        let mut pieces = Vec::new();
        let mut piece = SeriesPiece::default();
        let mut finish = |piece: &mut SeriesPiece| {
            let done = core::mem::take(piece);
            #[expect(clippy::cast_precision_loss, reason = "a number of rows")]
            let lasts_s = done.len() as f64 * period_s;
            if lasts_s >= SHORTEST_PIECE_S {
                pieces.push(done);
            }
        };
        let mut step = 0.0;
        loop {
            let time_s = span_s.0 + step * period_s;
            // The last row of a steady log is there whatever the rounding of its times.
            if time_s > span_s.1 + 1e-6 {
                break;
            }
            let time_s = time_s.min(span_s.1);
            step += 1.0;
            let [a, b, c, d, e] = &mut places;
            let row = (|| {
                Some([
                    self.airspeed_mps.at(time_s, a)?,
                    self.bank_command_rad.at(time_s, b)?,
                    self.bank_rad.at(time_s, c)?,
                    self.course_rad.at(time_s, d)?,
                    self.climb_rad.at(time_s, e)?,
                ])
            })();
            let flies = |row: &[f64; 5]| row[0] > flying_mps && self.phases.would_fly(time_s);
            let Some([airspeed_mps, command_rad, bank_rad, course_rad, climb_rad]) =
                row.filter(flies)
            else {
                finish(&mut piece);
                continue;
            };
            if piece.is_empty() {
                piece.start_s = time_s;
            }
            piece.airspeed_mps.push(airspeed_mps);
            piece.bank_command_rad.push(command_rad);
            piece.bank_rad.push(bank_rad);
            piece.course_rad.push(course_rad);
            piece.climb_rad.push(climb_rad);
        }
        finish(&mut piece);
        pieces
    }

    /// A speed that is exceeded for a tenth of the samples.
    fn cruise_mps(&self) -> f64 {
        let mut speeds: Vec<f64> = self.airspeed_mps.0.iter().map(|sample| sample.1).collect();
        speeds.sort_by(f64::total_cmp);
        speeds.get(speeds.len() * 9 / 10).copied().unwrap_or(0.0)
    }
}
