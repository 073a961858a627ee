//! When the ownship's lines meet a volume of one intruder.

use crate::aircraft::{Pair, PairDeviation, State};
use crate::almost::Closeness::Rounding;
use crate::bands::path::{Line, Lines};
use crate::loss::{Loss, earlier_of, later_of};
use crate::settings::Settings;
use crate::volume::{Approach, Surroundings, Volume};
use alloc::vec::Vec;
use core::cell::Cell;
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
    #[inline]
    pub(super) fn horizon_s(&self, until_s: f64, maneuver_s: f64) -> f64 {
        if self.settings.counts_maneuver_time {
            until_s
        } else {
            until_s + maneuver_s
        }
    }
}

/// The windows in which lines meet one volume of one intruder, by sides; each is found when it is first asked for.
#[derive(Debug, Clone, Default)]
pub(crate) struct Windows {
    sides: [Vec<Loss>; 2],
}

/// A window that nobody has asked for yet.
const UNKNOWN: Loss = Loss::new(f64::NAN, f64::NAN);

/// Windows to be filled in.
pub(super) type Places<'a> = [&'a [Cell<Loss>]; 2];

impl Windows {
    /// Forgets everything; there is room for the window of each line.
    pub(crate) fn reset(&mut self, lines: Lines) {
        for (losses, lines) in self.sides.iter_mut().zip(lines.sides) {
            losses.clear();
            losses.resize(lines.len(), UNKNOWN);
        }
    }

    pub(super) fn places(&mut self) -> Places<'_> {
        self.sides
            .each_mut()
            .map(|losses| Cell::from_mut(losses.as_mut_slice()).as_slice_of_cells())
    }
}

/// The most by which the velocity changes from line to line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Change {
    aside_mps: f64,
    up_mps: f64,
}

impl Change {
    /// The change of lines that begin with these: each turns by the same angle, or is faster by the same speed.
    pub(super) fn of(lines: &[Line]) -> Option<Self> {
        let [first, second, ..] = lines else {
            return None;
        };
        let change_mps = second.state.velocity_mps - first.state.velocity_mps;
        let aside_mps = libm::sqrt(change_mps.x * change_mps.x + change_mps.y * change_mps.y);
        let speed_mps = first.state.velocity_mps.abs();
        let size_mps = speed_mps.x + speed_mps.y + speed_mps.z;
        let grown = |mps: f64| {
            if mps == 0.0 {
                0.0
            } else {
                mps * 1.001 + 1e-9 * size_mps
            }
        };
        let change = Self {
            aside_mps: grown(aside_mps),
            up_mps: grown(change_mps.z.abs()),
        };
        (change.aside_mps + change.up_mps)
            .is_finite()
            .then_some(change)
    }
}

/// How many lines a room stays free for, if each uses up a part of it.
fn steps_in(room_m: f64, step_m: f64) -> usize {
    if room_m > step_m {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "casts of floats saturate, and the room is positive"
        )]
        let steps = (room_m / step_m) as usize;
        steps.saturating_add(1)
    } else {
        usize::from(room_m > 0.0)
    }
}

/// Whether a window has a part between two times.
#[cold]
#[inline(never)]
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
    meetings(met, volume, lines, None)
}

/// How lines meet a volume of an intruder, by sides.
pub(super) fn meetings<'a>(
    met: &Met<'a>,
    volume: &'a Volume,
    lines: Lines<'a>,
    known: Option<Places<'a>>,
) -> [Meeting<'a>; 2] {
    let lookahead_s = met.settings.lookahead_s;
    // A window that is remembered serves every later question.
    let asked_s = met.asked_s.max(lines.step_s) + 1.0;
    let [low, high] = lines.sides;
    let side = |lines, known| Meeting {
        met: *met,
        volume,
        lines,
        known,
        depends_on_time: volume.depends_on_time(),
        reach: volume.reach(),
        asked_s: (known.is_some() && asked_s < lookahead_s).then_some(asked_s),
        lookahead_s,
        clear_s: clear_s(lookahead_s),
    };
    let known = known.map_or([None, None], |places| places.map(Some));
    let [low_known, high_known] = known;
    [side(low, low_known), side(high, high_known)]
}

/// When the lines of one side meet a volume of an intruder.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Meeting<'a> {
    pub(super) met: Met<'a>,
    volume: &'a Volume,
    pub(super) lines: &'a [Line],
    /// Windows that are remembered.
    known: Option<&'a [Cell<Loss>]>,
    /// Whether windows depend on the time that is asked for.
    pub(super) depends_on_time: bool,
    reach: Option<Surroundings>,
    /// Nothing later than this after the begin of a line is asked for, seconds; `None` where anything may be.
    asked_s: Option<f64>,
    lookahead_s: f64,
    /// A time that rounding cannot make, seconds.
    pub(super) clear_s: f64,
}

impl Meeting<'_> {
    /// When a line meets the volume; `None` where that depends on the time asked for.
    #[expect(clippy::inline_always, reason = "asked for each line of each quantity")]
    #[inline(always)]
    pub(super) fn window(&self, index: usize, line: &Line) -> Option<Loss> {
        if let Some(place) = self.known.and_then(|known| known.get(index)) {
            let known = place.get();
            if !known.entry_s.is_nan() {
                return Some(known);
            }
            let found = self.find(line);
            place.set(found);
            return Some(found);
        }
        if self.depends_on_time {
            return None;
        }
        Some(self.find(line))
    }

    /// Whether a line surely never meets the volume.
    #[expect(clippy::inline_always, reason = "asked for each line of each quantity")]
    #[inline(always)]
    pub(super) fn never_meets(&self, index: usize, line: &Line) -> bool {
        self.window(index, line)
            .is_some_and(|window| window.entry_s == f64::INFINITY)
    }

    /// Finds when a line meets the volume; never, if that is not while it is asked for.
    #[inline(never)]
    fn find(&self, line: &Line) -> Loss {
        let approach = Approach::of(&line.state, self.met.intruder);
        let meets_nothing = self.reach.as_ref().is_some_and(|reach| {
            approach.is_over(line.since_s, reach)
                || self
                    .asked_s
                    .is_some_and(|asked_s| approach.is_later(line.since_s + asked_s, reach))
        });
        if meets_nothing {
            return Loss::NEVER;
        }
        self.met.window(self.volume, line, &approach)
    }

    /// How a line approaches, unless its window is known and more is not worth asking.
    #[expect(clippy::inline_always, reason = "asked for each line of each quantity")]
    #[inline(always)]
    fn approach_of_unknown(&self, index: usize) -> Option<(&Line, Approach, &Surroundings)> {
        let place = self.known?.get(index)?;
        let (line, reach) = (self.lines.get(index)?, self.reach.as_ref()?);
        place
            .get()
            .entry_s
            .is_nan()
            .then(|| (line, Approach::of(&line.state, self.met.intruder), reach))
    }

    /// Whether the volume is surely violated on a line at a time, and around it by more than rounding: the ownship
    /// is within the distance and the height. The window need not be known.
    pub(super) fn is_surely_on(&self, index: usize, time_s: f64, until_s: f64) -> bool {
        let around_s = 2.0 * self.clear_s;
        if time_s + around_s > earlier_of(until_s, self.lookahead_s) {
            return false;
        }
        self.approach_of_unknown(index)
            .is_some_and(|(line, approach, reach)| {
                line.since_s <= time_s - around_s && approach.is_within(time_s, around_s, reach)
            })
    }

    /// Whether the volume is surely not violated in a time after the ownship comes onto a line. The window need not
    /// be known.
    pub(super) fn is_surely_off(&self, index: usize, coast_s: f64) -> bool {
        self.approach_of_unknown(index)
            .is_some_and(|(line, approach, reach)| {
                reach.tau_s == Some(0.0) && approach.is_beyond(line.since_s, coast_s, reach)
            })
    }

    /// Whether the volume is surely not violated on a line from a time on, at which the ownship is on it. The window
    /// need not be known.
    pub(super) fn is_surely_over(&self, index: usize, from_s: f64) -> bool {
        self.approach_of_unknown(index)
            .is_some_and(|(_, approach, reach)| approach.is_over(from_s, reach))
    }

    /// How many of the lines from one on surely meet nothing until a time, 0 where that is not known.
    ///
    /// From line to line the velocity changes by `change`, and never more on the way. So at a time `t` the `m`-th
    /// line from here is at most `m` changes times the time since this line away from this one: nothing is met
    /// where that does not use up the room between this line and the volume. The volume reaches farther than its
    /// distance by no more than the way in its time: `s² + τ (s · v) ≤ D²` gives `|s| ≤ D + τ |v|`, and the height
    /// likewise. The margins exceed the rounding of all that.
    pub(super) fn quiet(&self, index: usize, until_s: f64, change: &Change) -> usize {
        let (Some(reach), Some(line)) = (&self.reach, self.lines.get(index)) else {
            return 0;
        };
        let Some(tau_s) = reach.tau_s else {
            return 0;
        };
        let until_s = earlier_of(until_s, self.lookahead_s);
        let lasts_s = until_s - line.since_s;
        let approach = Approach::of(&line.state, self.met.intruder);
        if !(lasts_s >= 0.0 && approach.is_finite()) {
            return 0;
        }
        let room_m = approach.least_m(line.since_s, until_s)
            - libm::sqrt(reach.square_m2)
            - tau_s * libm::sqrt(approach.speed2_m2ps2);
        let aside = steps_in(room_m, change.aside_mps * (lasts_s + tau_s));
        let coaltitude_s = reach.coaltitude_s;
        let room_m = approach.least_height_m(line.since_s, until_s)
            - reach.height_m
            - coaltitude_s * approach.climb_mps.abs();
        let above = steps_in(room_m, change.up_mps * (lasts_s + coaltitude_s));
        aside.max(above)
    }

    /// Begin and end of the part of a window between the time at which the ownship comes onto the line and a later
    /// one; without a length where the line meets nothing, and not a number where rounding decides.
    #[inline]
    fn part(&self, index: usize, until_s: f64) -> Option<(f64, f64)> {
        let line = self.lines.get(index)?;
        let window = self.window(index, line)?;
        let begin_s = later_of(window.entry_s, line.since_s);
        let end_s = earlier_of(window.exit_s, until_s);
        let lasts_s = end_s - begin_s;
        if lasts_s > self.clear_s {
            Some((begin_s, end_s))
        } else if lasts_s < -self.clear_s || !window.lasts() {
            None
        } else {
            Some((f64::NAN, f64::NAN))
        }
    }

    /// When an ownship on a line that is looked at until a time has left the volume; not a number where rounding
    /// decides.
    #[inline]
    pub(super) fn left_s(&self, index: usize, until_s: f64) -> f64 {
        let until_s = earlier_of(until_s, self.lookahead_s);
        self.part(index, until_s)
            .map_or(f64::NEG_INFINITY, |(_, end_s)| end_s)
    }

    /// When an ownship that is on a line until a time meets the volume; not a number where rounding decides.
    #[inline]
    pub(super) fn met_s(&self, index: usize, until_s: f64) -> f64 {
        self.part(index, until_s)
            .map_or(f64::INFINITY, |(begin_s, _)| begin_s)
    }

    /// Whether the volume is violated on the line between two times, once the ownship is on it.
    #[expect(clippy::inline_always, reason = "asked for each line of each quantity")]
    #[inline(always)]
    pub(super) fn meets_later(&self, index: usize, from_s: f64, until_s: f64) -> bool {
        let until_s = earlier_of(until_s, self.lookahead_s);
        let Some(line) = self.lines.get(index) else {
            return false;
        };
        let begin_s = later_of(from_s, line.since_s);
        begin_s <= until_s && self.meets(index, line, (begin_s, until_s))
    }

    /// Whether the volume is violated at the time at which the ownship comes onto the line, or in
    /// the `coast_s` after it.
    #[expect(clippy::inline_always, reason = "asked for each line of each quantity")]
    #[inline(always)]
    pub(super) fn meets_on_the_way(&self, index: usize, coast_s: f64) -> bool {
        self.lines.get(index).is_some_and(|line| {
            let since_s = line.since_s;
            since_s < self.lookahead_s && self.meets(index, line, (since_s, since_s + coast_s))
        })
    }

    #[expect(clippy::inline_always, reason = "asked for each line of each quantity")]
    #[inline(always)]
    fn meets(&self, index: usize, line: &Line, times: (f64, f64)) -> bool {
        self.overlaps(self.window(index, line), line, times)
    }

    /// Whether a line, of which the window is known, meets the volume between two times.
    #[expect(clippy::inline_always, reason = "asked for each line of each quantity")]
    #[inline(always)]
    pub(super) fn overlaps(
        &self,
        window: Option<Loss>,
        line: &Line,
        (from_s, to_s): (f64, f64),
    ) -> bool {
        let Some(window) = window else {
            return self.volume.conflicts(&self.met.pair(line), from_s, to_s);
        };
        // Most answers are clear: an overlap, or a gap, that rounding cannot make.
        let overlap_s = earlier_of(window.exit_s, to_s) - later_of(window.entry_s, from_s);
        if overlap_s.abs() > self.clear_s {
            return overlap_s > 0.0;
        }
        meets(window, from_s, to_s)
    }

    /// Whether the volume is met at the time at which the ownship comes onto any of these lines, of those it comes
    /// onto in a span of time.
    pub(super) fn meets_at_begin(&self, lines: Range<usize>, from_s: f64, until_s: f64) -> bool {
        for index in lines {
            if let Some(line) = self.lines.get(index)
                && from_s <= line.since_s
                && line.since_s <= until_s
                && line.since_s < self.lookahead_s
                && self.meets(index, line, (line.since_s, line.since_s))
            {
                return true;
            }
        }
        false
    }
}

/// A time that rounding cannot make, seconds.
pub(super) fn clear_s(lookahead_s: f64) -> f64 {
    1e-6 * (1.0 + lookahead_s)
}
