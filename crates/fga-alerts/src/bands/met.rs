//! When the ownship's lines meet a volume of one intruder.

use crate::aircraft::{Pair, PairDeviation, State};
use crate::almost::Closeness::Rounding;
use crate::bands::opening::clear_s;
use crate::bands::path::{Line, Lines};
use crate::loss::Loss;
use crate::settings::Settings;
use crate::volume::{Approach, Volume};
use alloc::vec::Vec;
use core::ops::Range;

/// An intruder as the ownship's maneuvers meet it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Met<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) intruder: &'a State,
    pub(crate) deviation: PairDeviation,
    /// Nothing later than this after the end of a maneuver is asked for, seconds.
    pub(crate) asked_s: f64,
}

impl Met<'_> {
    fn pair(&self, line: &Line) -> Pair {
        Pair {
            ownship: line.state,
            intruder: *self.intruder,
            deviation: self.deviation,
        }
    }

    /// When the line meets a volume of which the violation does not depend on the time asked for.
    #[inline]
    pub(super) fn window(&self, volume: &Volume, line: &Line, approach: &Approach) -> Loss {
        if !approach.is_finite() {
            return Loss::NEVER;
        }
        let horizon_s = self.settings.lookahead_s + 1.0;
        volume.window(approach, || self.pair(line), horizon_s)
    }

    /// Until when a maneuver that ends at a time is looked at.
    pub(super) fn horizon_s(&self, until_s: f64, maneuver_s: f64) -> f64 {
        if self.settings.counts_maneuver_time {
            until_s
        } else {
            until_s + maneuver_s
        }
    }
}

/// How lines approach one intruder, the same for every volume.
#[derive(Debug, Clone, Default)]
pub(crate) struct Approaches {
    sides: [Vec<Approach>; 2],
}

impl Approaches {
    /// The approaches of one side.
    pub(super) fn side(&self, side: usize) -> &[Approach] {
        self.sides.get(side).map_or(&[], Vec::as_slice)
    }

    pub(crate) fn fill(&mut self, met: &Met, lines: Lines) {
        for (approaches, lines) in self.sides.iter_mut().zip(lines.sides) {
            approaches.clear();
            approaches.extend(
                lines
                    .iter()
                    .map(|line| Approach::of(&line.state, met.intruder)),
            );
        }
    }
}

/// The windows in which lines meet one volume of one intruder.
#[derive(Debug, Clone, Default)]
pub(crate) struct Windows {
    sides: [SideWindows; 2],
}

/// The windows of one side.
#[derive(Debug, Clone, Default)]
struct SideWindows {
    losses: Vec<Loss>,
    /// Lines outside of it meet nothing at any time that is asked for.
    live: Range<usize>,
    /// The lines on the way from which to the next the volume is met. Where nothing is asked of the lines behind the
    /// first one, it is the last one that is known.
    stops: Vec<usize>,
}

impl SideWindows {
    fn fill(
        &mut self,
        met: &Met,
        volume: &Volume,
        lines: &[Line],
        approaches: &[Approach],
        (step_s, asked): (f64, Asked),
    ) {
        self.losses.clear();
        self.losses.resize(lines.len(), Loss::NEVER);
        self.stops.clear();
        let lookahead_s = met.settings.lookahead_s;
        // Nothing later is asked for: not by a horizon, and not by a step that begins before it.
        let latest_s = lookahead_s + 1.0 + step_s;
        let last = libm::floor(lookahead_s / step_s);
        let asked_s = met.asked_s.max(step_s) + 1.0;
        let clear_s = clear_s(lookahead_s);
        let asks_less = asked_s < lookahead_s;
        let reach = volume.reach();
        let (mut first, mut end, mut known) = (lines.len(), 0, lines.len());
        let lines = lines.iter().zip(approaches).zip(&mut self.losses);
        for (index, ((line, approach), loss)) in lines.enumerate() {
            if reach.is_some_and(|reach| {
                approach.is_over(line.since_s, &reach)
                    || (asks_less && approach.is_later(line.since_s + asked_s, &reach))
            }) {
                continue;
            }
            *loss = met.window(volume, line, approach);
            let since_s = line.since_s;
            if !(loss.lasts() && since_s < loss.exit_s && loss.entry_s < latest_s) {
                continue;
            }
            first = first.min(index);
            end = index + 1;
            let next_s = since_s + step_s;
            let overlap_s = loss.exit_s.min(next_s) - loss.entry_s.max(since_s);
            if overlap_s >= -clear_s
                && step_s > 0.0
                && since_s < lookahead_s
                && index as f64 <= last
                && (overlap_s > clear_s || meets(*loss, since_s, next_s))
            {
                self.stops.push(index);
                if asked == Asked::UntilMet {
                    known = end;
                    break;
                }
            }
        }
        self.losses.truncate(known);
        self.live = if first < end { first..end } else { 0..0 };
    }
}

/// Which windows of a volume are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Asked {
    /// All.
    All,
    /// Only those of lines before the first one on the way to which the volume is met: it counts from the begin.
    UntilMet,
}

impl Windows {
    /// Finds the windows of lines.
    pub(crate) fn fill(
        &mut self,
        met: &Met,
        volume: &Volume,
        lines: Lines,
        approaches: &Approaches,
        asked: Asked,
    ) {
        let sides = lines.sides.into_iter().zip(&approaches.sides);
        for (windows, (side, approaches)) in self.sides.iter_mut().zip(sides) {
            windows.fill(met, volume, side, approaches, (lines.step_s, asked));
        }
    }

    /// How lines meet a volume of an intruder, by sides.
    pub(super) fn of<'a>(
        &'a self,
        met: &Met<'a>,
        volume: &'a Volume,
        lines: Lines<'a>,
    ) -> [Meeting<'a>; 2] {
        let [low, high] = &self.sides;
        meetings([Some(low), Some(high)], met, volume, lines)
    }
}

/// Whether a window has a part between two times.
#[inline]
fn meets(window: Loss, from_s: f64, to_s: f64) -> bool {
    if !window.lasts() {
        return false;
    }
    // Most answers are clear, and then rounding is not asked for.
    if Rounding.is_far(from_s, to_s) {
        if window.is_clear(from_s, to_s) {
            return from_s < to_s && window.entry_s < to_s && from_s < window.exit_s;
        }
    } else if Rounding.same(from_s, to_s) {
        return window.is_on_at(from_s);
    }
    from_s <= to_s && window.conflicts_within(from_s, to_s)
}

/// How lines meet a volume of an intruder, where no window is worth remembering.
pub(super) fn meetings_once<'a>(
    met: &Met<'a>,
    volume: &'a Volume,
    lines: Lines<'a>,
) -> [Meeting<'a>; 2] {
    meetings([None, None], met, volume, lines)
}

fn meetings<'a>(
    [low, high]: [Option<&'a SideWindows>; 2],
    met: &Met<'a>,
    volume: &'a Volume,
    lines: Lines<'a>,
) -> [Meeting<'a>; 2] {
    let [low_lines, high_lines] = lines.sides;
    let side = |lines, windows| Meeting {
        met: *met,
        volume,
        lines,
        windows,
        clear_s: clear_s(met.settings.lookahead_s),
    };
    [side(low_lines, low), side(high_lines, high)]
}

/// When the lines of one side meet a volume of an intruder.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Meeting<'a> {
    pub(super) met: Met<'a>,
    volume: &'a Volume,
    pub(super) lines: &'a [Line],
    /// What is known; nothing where windows depend on the time that is asked for.
    windows: Option<&'a SideWindows>,
    /// A time that rounding cannot make, seconds.
    clear_s: f64,
}

impl Meeting<'_> {
    /// Lines outside of it meet nothing.
    pub(super) fn live(&self) -> Range<usize> {
        self.windows
            .map_or(0..self.lines.len(), |windows| windows.live.clone())
    }

    /// When a line meets the volume; `None` where that depends on the time asked for.
    #[inline]
    fn window(&self, index: usize, line: &Line) -> Option<Loss> {
        if let Some(windows) = self.windows {
            return windows.losses.get(index).copied();
        }
        if self.volume.depends_on_time() {
            return None;
        }
        let approach = Approach::of(&line.state, self.met.intruder);
        Some(self.met.window(self.volume, line, &approach))
    }

    /// Begin and end of the part of a known window between the time at which the ownship comes onto the line and
    /// a later one; the end may lie before the begin. `None` where the line meets nothing at all.
    pub(super) fn part(&self, index: usize, until_s: f64) -> Option<(f64, f64)> {
        let window = self.windows?.losses.get(index)?;
        let line = self.lines.get(index)?;
        window
            .lasts()
            .then(|| (window.entry_s.max(line.since_s), window.exit_s.min(until_s)))
    }

    fn meets(&self, index: usize, line: &Line, from_s: f64, to_s: f64) -> bool {
        match self.window(index, line) {
            Some(window) => meets(window, from_s, to_s),
            None => self.volume.conflicts(&self.met.pair(line), from_s, to_s),
        }
    }

    /// The first of some lines on the way to which the volume is met, the ownship `coast_s` on each: the step of
    /// the windows, where these are known.
    pub(super) fn first_met(&self, mut lines: Range<usize>, coast_s: f64) -> Option<usize> {
        let Some(windows) = self.windows else {
            return lines.find(|index| self.meets_on_the_way(*index, coast_s));
        };
        let place = windows.stops.partition_point(|stop| *stop < lines.start);
        let stop = windows.stops.get(place).copied();
        stop.filter(|stop| lines.contains(stop))
    }

    /// Whether the volume is violated on the line between two times, once the ownship is on it.
    #[inline]
    pub(super) fn meets_later(&self, index: usize, from_s: f64, until_s: f64) -> bool {
        let until_s = until_s.min(self.met.settings.lookahead_s);
        // Most answers are clear: an overlap, or a gap, that rounding cannot make.
        if let Some(windows) = self.windows
            && let (Some(window), Some(line)) = (windows.losses.get(index), self.lines.get(index))
        {
            let begin_s = window.entry_s.max(line.since_s).max(from_s);
            let overlap_s = window.exit_s.min(until_s) - begin_s;
            if overlap_s.abs() > self.clear_s {
                return overlap_s > 0.0;
            }
        }
        self.meets_later_exactly(index, from_s, until_s)
    }

    fn meets_later_exactly(&self, index: usize, from_s: f64, until_s: f64) -> bool {
        let Some(line) = self.lines.get(index) else {
            return false;
        };
        line.since_s <= until_s
            && from_s <= until_s
            && self.meets(index, line, from_s.max(line.since_s), until_s)
    }

    /// Whether the volume is violated at the time at which the ownship comes onto the line, or in
    /// the `coast_s` after it.
    pub(super) fn meets_on_the_way(&self, index: usize, coast_s: f64) -> bool {
        self.lines.get(index).is_some_and(|line| {
            if let Some(window) = self.windows.and_then(|windows| windows.losses.get(index)) {
                // Most lines are met at another time.
                let begin_s = window.entry_s.max(line.since_s);
                if begin_s - window.exit_s.min(line.since_s + coast_s) > self.clear_s {
                    return false;
                }
            }
            line.since_s < self.met.settings.lookahead_s
                && self.meets(index, line, line.since_s, line.since_s + coast_s)
        })
    }
}
