//! When the ownship's lines meet the volumes of one intruder.

use crate::aircraft::{Pair, PairDeviation, State};
use crate::almost::Closeness::Rounding;
use crate::bands::path::Line;
use crate::loss::Loss;
use crate::settings::Settings;
use crate::volume::Volume;
use alloc::vec::Vec;
use core::cmp::Ordering;

/// An intruder as the ownship's manoeuvres meet it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Met<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) intruder: State,
    pub(crate) deviation: PairDeviation,
}

/// A volume of one intruder, against which lines of the ownship are judged.
pub(super) struct Meeting<'a> {
    met: Met<'a>,
    volume: &'a Volume,
    /// The violation on each line; `None` where it depends on the part that is asked for.
    windows: Vec<Option<Loss>>,
}

impl<'a> Meeting<'a> {
    pub(super) fn new<'l>(
        met: &Met<'a>,
        volume: &'a Volume,
        lines: impl Iterator<Item = &'l Line>,
    ) -> Self {
        let horizon_s = met.settings.lookahead_s + 1.0;
        let window = |line: &Line| {
            if line.state.is_finite() {
                volume.window(&met.pair(&line.state), horizon_s)
            } else {
                Some(Loss::NEVER)
            }
        };
        Self {
            met: *met,
            volume,
            windows: lines.map(window).collect(),
        }
    }

    /// Whether the volume is violated on a line between two times, the same one for a moment.
    fn meets(&self, index: usize, line: &Line, from_s: f64, to_s: f64) -> bool {
        match self.windows.get(index).copied().flatten() {
            None => self
                .volume
                .conflicts(&self.met.pair(&line.state), from_s, to_s),
            Some(window) if Rounding.same(from_s, to_s) => window.is_on_at(from_s),
            Some(window) => from_s <= to_s && window.conflicts_within(from_s, to_s),
        }
    }
}

impl Met<'_> {
    pub(crate) fn pair(&self, ownship: &State) -> Pair {
        Pair {
            ownship: *ownship,
            intruder: self.intruder,
            deviation: self.deviation,
        }
    }
}

/// What the ownship stays out of: a volume from a change on, and in recovery another one until then.
pub(super) struct Guard<'a> {
    pub(super) later: &'a Meeting<'a>,
    pub(super) before: Option<&'a Meeting<'a>>,
    /// Time of the change, seconds.
    pub(super) change_s: f64,
    /// Until when lines are looked at, seconds; a manoeuvre's own time comes on top unless the settings count it.
    pub(super) until_s: f64,
}

impl<'a> Guard<'a> {
    /// A volume that counts from now on.
    pub(super) const fn of(volume: &'a Meeting<'a>, until_s: f64) -> Self {
        Self {
            later: volume,
            before: None,
            change_s: 0.0,
            until_s,
        }
    }

    /// Whether the ownship meets a volume while it is on a line for a while at most, in the course of its manoeuvre;
    /// `order` of the line and the change says which volumes count.
    pub(super) fn stops(
        &self,
        index: usize,
        line: &Line,
        order: Option<Ordering>,
        coast_s: f64,
    ) -> bool {
        let meets =
            |meeting: &Meeting| meeting.meets(index, line, line.since_s, line.since_s + coast_s);
        line.since_s < self.later.met.settings.lookahead_s
            && (order.is_some_and(Ordering::is_ge) && meets(self.later)
                || order.is_some_and(Ordering::is_le) && self.before.is_some_and(meets))
    }

    /// Whether the ownship meets a volume on a line that it flies until a time or the horizon.
    pub(super) fn blocks(&self, index: usize, line: &Line, until_s: f64) -> bool {
        let settings = self.later.met.settings;
        let horizon_s = if settings.counts_maneuver_time {
            self.until_s
        } else {
            self.until_s + line.since_s
        };
        let meets = |meeting: &Meeting, from_s: f64, to_s: f64| {
            let (from_s, to_s) = (from_s.max(line.since_s), to_s.min(settings.lookahead_s));
            from_s <= to_s && meeting.meets(index, line, from_s, to_s)
        };
        meets(self.later, self.change_s, horizon_s.min(until_s))
            || self
                .before
                .is_some_and(|before| meets(before, 0.0, self.change_s.min(until_s)))
    }
}
