//! The status line and what the operator reads, written by a separate thread: a terminal that is held (Ctrl-S), a pipe
//! that nobody reads or a closed one delays nothing else.

use alloc::sync::Arc;
use core::time::Duration;
use std::io::{self, IsTerminal as _, Write as _};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::time::Instant;

use super::shared::{FlightShared, spawn};

/// Interval between lines.
const EVERY: Duration = Duration::from_millis(500);
/// Interval between lines that are kept.
const EVERY_LINE: Duration = Duration::from_secs(10);
/// Most lines that wait for the terminal; more are dropped.
const WAITING_LINES: usize = 32;
/// Longest wait for the terminal at the end of a flight.
const LAST_WORDS: Duration = Duration::from_millis(200);

/// A line for standard error.
enum TerminalLine {
    /// The state now; the next one takes its place.
    State(String),
    /// What the operator reads; it stays.
    Words(String),
}

/// The flight's side of its status line.
pub(super) struct StatusLine {
    to: Option<SyncSender<TerminalLine>>,
    shown: Instant,
}

impl StatusLine {
    /// Whether a status line appears on standard error.
    pub(super) fn begin(shared: &Arc<FlightShared>, wanted: bool) -> io::Result<Self> {
        let to = if wanted {
            let (to, lines) = sync_channel(WAITING_LINES);
            spawn(shared, "fga-status", move |_| {
                // Control codes are for terminals alone; a file or a pipe gets a line now and then.
                let is_terminal = io::stderr().is_terminal();
                let mut written: Option<Instant> = None;
                while let Ok(line) = lines.recv() {
                    // Without a reader there is nobody to report to.
                    let _ = match line {
                        TerminalLine::State(line) if is_terminal => {
                            write!(io::stderr(), "\r\x1b[K{line}")
                        }
                        TerminalLine::State(line)
                            if written.is_none_or(|written| written.elapsed() >= EVERY_LINE) =>
                        {
                            written = Some(Instant::now());
                            writeln!(io::stderr(), "{line}")
                        }
                        TerminalLine::State(_) => Ok(()),
                        TerminalLine::Words(words) if is_terminal => {
                            writeln!(io::stderr(), "\r\x1b[K{words}")
                        }
                        TerminalLine::Words(words) => writeln!(io::stderr(), "{words}"),
                    };
                }
                if is_terminal {
                    let _ = writeln!(io::stderr());
                }
            })?;
            Some(to)
        } else {
            None
        };
        Ok(Self {
            to,
            shown: Instant::now(),
        })
    }

    /// Shows a line if it is due.
    pub(super) fn show(&mut self, line: impl FnOnce() -> String) {
        if let Some(to) = &self.to
            && self.shown.elapsed() >= EVERY
        {
            self.shown = Instant::now();
            let _ = to.try_send(TerminalLine::State(line()));
        }
    }

    /// Shows what the operator reads.
    pub(super) fn say(&self, words: &str) {
        if let Some(to) = &self.to {
            let _ = to.try_send(TerminalLine::Words(words.to_owned()));
        }
    }

    /// Ends the line.
    pub(super) fn end(self) {
        if self.to.is_some() {
            drop(self);
            std::thread::sleep(LAST_WORDS);
        }
    }
}
