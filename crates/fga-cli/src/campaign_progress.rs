//! The expected duration and the progress of `fga campaign run`, on standard error.

use core::time::Duration;
use std::io::{IsTerminal as _, Write as _};
use std::time::Instant;

use fga_campaign::campaign::{CampaignProgress, Expected};
use fga_formats::words::{counted, per_second};

/// Progress on standard error: on a terminal a line that overwrites itself, else a line now and then.
pub(crate) struct ProgressDisplay {
    terminal: bool,
    /// What is flown.
    what: &'static str,
    /// When flying began, with the sample.
    begun: Instant,
    /// Whether the expected duration has been told.
    is_told: bool,
    shown: Option<Instant>,
}

impl ProgressDisplay {
    /// Nothing shown yet; flying begins now.
    pub(crate) fn new() -> Self {
        Self::of("encounters")
    }

    /// The same for another word.
    pub(crate) fn of(what: &'static str) -> Self {
        Self {
            what,
            terminal: std::io::stderr().is_terminal(),
            begun: Instant::now(),
            is_told: false,
            shown: None,
        }
    }

    /// Shows the expected duration first, then the progress now and then.
    pub(crate) fn show(&mut self, progress: &CampaignProgress) {
        if !self.is_told {
            self.is_told = true;
            if let Some(expected) = &progress.expected {
                eprintln!("{}", in_words(expected));
            }
            return;
        }
        let pause = Duration::from_millis(if self.terminal { 500 } else { 10_000 });
        if self.shown.is_some_and(|shown| shown.elapsed() < pause) {
            return;
        }
        self.shown = Some(Instant::now());
        let rate = (progress.done - progress.before) as f64 / progress.elapsed_s.max(1e-9);
        let left_s = (progress.total - progress.done) as f64 / rate.max(1e-9);
        let line = format!(
            "{} of {} {} ({:.1} %), {} a second, {} left",
            progress.done,
            progress.total,
            self.what,
            100.0 * progress.done as f64 / progress.total.max(1) as f64,
            per_second(rate),
            duration(left_s)
        );
        let mut out = std::io::stderr().lock();
        let _ = if self.terminal {
            write!(out, "\r{line:<78}")
        } else {
            writeln!(out, "{line}")
        };
        let _ = out.flush();
    }

    /// Time since flying began, seconds.
    pub(crate) fn flying_s(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    /// Ends the line on a terminal.
    pub(crate) fn end(&self) {
        if self.terminal && self.shown.is_some() {
            eprintln!();
        }
    }
}

/// What the rest probably takes, before it is flown.
fn in_words(expected: &Expected) -> String {
    format!(
        "expected: {} on {} for {}, {} of processor time (by a sample of {})",
        duration(expected.duration_s()),
        counted(expected.threads, "thread"),
        counted(expected.left, "encounter"),
        duration(expected.processor_s),
        expected.sample
    )
}

/// A time in words.
fn duration(seconds: f64) -> String {
    if seconds < 90.0 {
        format!("{seconds:.0} s")
    } else if seconds < 5400.0 {
        format!("{:.0} min", seconds / 60.0)
    } else {
        format!("{:.1} h", seconds / 3600.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_expected_duration_in_words() {
        let expected = Expected {
            sample: 256,
            left: 100_000,
            threads: 2,
            processor_s: 6000.0,
        };
        assert_eq!(
            in_words(&expected),
            "expected: 50 min on 2 threads for 100000 encounters, 1.7 h of processor time (by a sample of 256)"
        );
    }
}
