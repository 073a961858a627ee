//! Beast binary frames, as receivers and `dump1090` send them on port 30005.
//!
//! A frame is `0x1A`, a type byte (`1` Mode A/C, `2` short and `3` long Mode S), six bytes of a
//! 12 MHz clock, one byte of signal strength and 2, 7 or 14 bytes of the message; a `0x1A` inside
//! is doubled.

use super::TrafficReport;
use super::surveillance::SurveillanceMessage;
use crate::tally::{LeftOut, Tally};

/// The first byte of a frame, doubled inside one.
const ESCAPE: u8 = 0x1A;
/// Clock and signal strength before the message, bytes.
const HEAD: usize = 7;
/// The longest frame without its escape and type, bytes.
const LONGEST: usize = HEAD + 14;
/// Bytes outside of frames that count as one part of the input.
const STRAY: usize = 64;

/// One frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BeastFrame<'a> {
    /// The receiver's clock, in twelfths of a microsecond.
    pub ticks: u64,
    /// Signal strength, 255 the strongest.
    pub signal: u8,
    /// The message: 2, 7 or 14 bytes.
    pub message: &'a [u8],
}

/// Cuts the bytes of a connection into frames.
#[derive(Debug, Clone, Default)]
pub struct Frames {
    body: [u8; LONGEST],
    filled: usize,
    /// Length of the frame, bytes; zero outside of one.
    expected: usize,
    escaped: bool,
    /// Inside a frame of a type without use.
    other: bool,
    /// Bytes outside of frames since the last one.
    stray: usize,
    tally: Tally,
}

impl Frames {
    /// Takes bytes and calls `take` for each frame in them.
    pub fn push(&mut self, bytes: &[u8], mut take: impl FnMut(BeastFrame<'_>)) {
        for byte in bytes {
            if self.escaped {
                self.escaped = false;
                if *byte != ESCAPE {
                    self.begin(*byte);
                    continue;
                }
            } else if *byte == ESCAPE {
                self.escaped = true;
                continue;
            }
            if self.expected == 0 {
                self.skip();
                continue;
            }
            if let Some(place) = self.body.get_mut(self.filled) {
                *place = *byte;
            }
            self.filled += 1;
            if self.filled < self.expected {
                continue;
            }
            self.expected = 0;
            if let Some((head, message)) = self
                .body
                .get(..self.filled)
                .and_then(<[u8]>::split_first_chunk::<HEAD>)
            {
                let [clock @ .., signal] = *head;
                let ticks = clock
                    .iter()
                    .fold(0, |ticks, byte| ticks << 8 | u64::from(*byte));
                take(BeastFrame {
                    ticks,
                    signal,
                    message,
                });
            }
        }
    }

    /// A type byte after an escape.
    fn begin(&mut self, kind: u8) {
        if self.expected != 0 {
            self.tally.leave_out(LeftOut::CutShort);
        }
        self.filled = 0;
        self.stray = 0;
        self.other = !matches!(kind, b'1'..=b'3');
        if self.other {
            self.tally.leave_out(LeftOut::NotNeeded);
        }
        self.expected = match kind {
            b'1' => HEAD + 2,
            b'2' => HEAD + 7,
            b'3' => HEAD + 14,
            // Settings and unknown types.
            _ => 0,
        };
    }

    /// A byte outside of the known frames.
    fn skip(&mut self) {
        // The first bytes after a type without use are its own.
        let is_its_own = self.other && self.stray == 0;
        if self.stray.is_multiple_of(STRAY) && !is_its_own {
            self.tally.leave_out(LeftOut::UnknownKind);
        }
        self.stray += 1;
    }
}

/// Takes the bytes of a connection as they come and gives reports of airborne aircraft.
#[derive(Debug, Clone, Default)]
pub struct Stream {
    frames: Frames,
    surveillance: SurveillanceMessage,
    tally: Tally,
}

impl Stream {
    /// Takes bytes received at `time_s` and calls `report` for each report in them.
    ///
    /// Times need not grow, but positions need two messages within ten seconds.
    pub fn push(&mut self, bytes: &[u8], time_s: f64, mut report: impl FnMut(TrafficReport)) {
        self.frames.push(bytes, |frame| {
            let taken = self.surveillance.take(frame.message, time_s);
            self.tally.take(&taken);
            taken.into_iter().for_each(&mut report);
        });
    }

    /// A new connection begins: a frame under way will not be finished.
    pub fn reconnect(&mut self) {
        let before = core::mem::take(&mut self.frames);
        self.tally += before.tally;
        if before.expected != 0 {
            self.tally.leave_out(LeftOut::CutShort);
        }
    }

    /// Counts of the frames so far.
    pub fn tally(&self) -> Tally {
        let mut tally = self.tally;
        tally += self.frames.tally;
        tally
    }

    /// Aircraft held in memory, at most 32,768.
    pub fn aircraft(&self) -> usize {
        self.surveillance.aircraft()
    }
}

/// Appends a Mode S message of 7 or 14 bytes as a frame; skips another length.
pub fn push_frame(out: &mut Vec<u8>, ticks: u64, signal: u8, message: &[u8]) {
    let kind = match message.len() {
        7 => b'2',
        14 => b'3',
        _ => return,
    };
    out.extend([ESCAPE, kind]);
    let [_, _, clock @ ..] = ticks.to_be_bytes();
    for byte in clock.iter().chain([&signal]).chain(message) {
        if *byte == ESCAPE {
            out.push(ESCAPE);
        }
        out.push(*byte);
    }
}
