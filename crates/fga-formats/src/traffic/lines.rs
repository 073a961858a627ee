//! Lines from the bytes of a connection, of bounded length.

use super::TrafficReport;
use crate::tally::{LeftOut, Tally};

/// Longest accepted line, bytes.
pub(super) const LONGEST_LINE: usize = 512;

/// The line under way, and what became of those before it.
#[derive(Debug, Clone, Default)]
pub(super) struct LineBuffer {
    line: Vec<u8>,
    tally: Tally,
}

impl LineBuffer {
    /// Takes bytes and calls `report` for each line that `parse` takes as a report.
    pub(super) fn push(
        &mut self,
        bytes: &[u8],
        mut parse: impl FnMut(&[u8]) -> Result<TrafficReport, LeftOut>,
        mut report: impl FnMut(TrafficReport),
    ) {
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
            if self.line.len() > LONGEST_LINE {
                self.line.clear();
                continue;
            }
            let parsed = parse(&self.line);
            self.tally.take(&parsed);
            if let Ok(found) = parsed {
                report(found);
            }
            self.line.clear();
        }
    }

    /// A new connection begins: a line under way will not be finished.
    pub(super) fn reconnect(&mut self) {
        if (1..=LONGEST_LINE).contains(&self.line.len()) {
            self.tally.leave_out(LeftOut::CutShort);
        }
        self.line.clear();
    }

    pub(super) const fn tally(&self) -> Tally {
        self.tally
    }
}
