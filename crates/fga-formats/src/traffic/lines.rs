//! Lines from the bytes of a connection, of bounded length.

use super::TrafficReport;
use crate::tally::{LeftOut, Tally};

/// Longest accepted line, bytes.
pub(super) const LONGEST_LINE: usize = 512;

/// What lines mean.
pub trait LineParser: Default {
    /// The report in a line.
    ///
    /// # Errors
    /// Why it holds none.
    fn take(&mut self, line: &[u8]) -> Result<TrafficReport, LeftOut>;
}

/// Takes the bytes of a connection as they come and gives the reports in its lines.
#[derive(Debug, Clone, Default)]
pub struct Lines<P> {
    /// The line whose end has not come yet.
    line: Vec<u8>,
    tally: Tally,
    parser: P,
}

impl<P: LineParser> Lines<P> {
    /// Takes bytes and calls `report` for each report in them.
    pub fn push(&mut self, bytes: &[u8], mut report: impl FnMut(TrafficReport)) {
        for byte in bytes {
            if *byte != b'\n' {
                // One byte more than accepted shows that a line is too long: it counts now, because it may never end.
                if self.line.len() <= LONGEST_LINE {
                    self.line.push(*byte);
                    if self.line.len() > LONGEST_LINE {
                        self.tally.leave_out(LeftOut::TooLong);
                    }
                }
                continue;
            }
            if self.line.len() <= LONGEST_LINE {
                let parsed = self.parser.take(&self.line);
                self.tally.take(&parsed);
                parsed.into_iter().for_each(&mut report);
            }
            self.line.clear();
        }
    }

    /// A new connection begins: a line under way will not be finished, and what lines before it said is forgotten.
    pub fn reconnect(&mut self) {
        if (1..=LONGEST_LINE).contains(&self.line.len()) {
            self.tally.leave_out(LeftOut::CutShort);
        }
        self.line.clear();
        self.parser = P::default();
    }

    /// Counts of the lines so far.
    pub const fn tally(&self) -> Tally {
        self.tally
    }
}
