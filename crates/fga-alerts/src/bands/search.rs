//! Finds the steps of a manoeuvre that lead into a conflict.

use crate::bands::intervals::Intervals;
use crate::bands::met::{Change, Meeting};
use crate::bands::path::Line;
use crate::bands::span::Span;
use crate::loss::{earlier_of, later_of};
use alloc::vec::Vec;

/// When a volume must not be met; until then another one, in recovery.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Task {
    /// Start of the volume, seconds.
    pub(crate) from_s: f64,
    /// End of the search, seconds.
    pub(crate) until_s: f64,
}

/// A fan of manoeuvres against one intruder.
pub(crate) struct FanSearch<'a> {
    /// The task's volume, by sides.
    pub(crate) later: &'a [Meeting<'a>; 2],
    /// The task's earlier volume.
    pub(crate) before: Option<&'a [Meeting<'a>; 2]>,
    /// Time of one step, seconds; 0 where a maneuver takes none.
    pub(crate) step_s: f64,
}

/// Lines that are looked at before it is asked again how many meet nothing.
const LINES_BETWEEN: usize = 8;

/// When a run of free steps is named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum When {
    /// As a whole.
    Whole,
    /// As soon as it has a length.
    Soon,
}

/// One side of a fan.
struct SideSearch<'a> {
    later: &'a Meeting<'a>,
    before: Option<&'a Meeting<'a>>,
    step_s: f64,
    task: Task,
    /// First and last step on the way from which the volume counts.
    counts: (usize, usize),
    /// Last step on the way from which the earlier volume counts.
    last_before: usize,
}

impl FanSearch<'_> {
    fn sides(&self, task: &Task) -> [SideSearch<'_>; 2] {
        let [low, high] = self.later;
        // The volume counts from the first step at or after `from_s`, the earlier one until then.
        let steps = task.from_s / self.step_s;
        let last_before = count_of(steps);
        let from = last_before.saturating_add(usize::from((last_before as f64) < steps));
        let last = count_of(low.met.settings.lookahead_s / self.step_s);
        let side = |later, before| SideSearch {
            later,
            before,
            step_s: self.step_s,
            task: *task,
            counts: (from, last),
            last_before,
        };
        let [low_before, high_before] = self
            .before
            .map_or([None, None], |before| before.each_ref().map(Some));
        [side(low, low_before), side(high, high_before)]
    }

    /// Whether no maneuver can begin: the current line meets the volume at once.
    pub(crate) fn is_blocked_at_once(&self, task: &Task) -> bool {
        self.step_s > 0.0
            && self.sides(task).iter().all(|side| {
                let meeting = side.before.unwrap_or(side.later);
                (side.before.is_some() || task.from_s == 0.0)
                    && meeting.meets_on_the_way(0, self.step_s)
            })
    }

    /// Whether any manoeuvre leads into the volume.
    pub(crate) fn any_conflict(&self, task: &Task) -> bool {
        self.sides(task).iter().any(SideSearch::any_conflict)
    }

    /// Whether no manoeuvre leads past the volume.
    pub(crate) fn all_conflict(&self, task: &Task) -> bool {
        !self.sides(task).iter().any(SideSearch::finds_a_way)
    }

    /// A part of the values without conflict; none where there is no such value.
    pub(crate) fn some_free(&self, task: &Task, span: &Span, free: &mut Intervals) -> bool {
        free.clear();
        let mut found = false;
        for (side, sign) in self.sides(task).iter().zip([-1.0, 1.0]) {
            side.free_runs(When::Soon, |first, last| {
                let value = |steps| span.value + sign * span.step * f64::from(int(steps));
                let (first, last) = (value(first), value(last));
                span.add_free(free, first.min(last), first.max(last));
                found = true;
                false
            });
            if found {
                break;
            }
        }
        found
    }

    /// Two neighbouring values that lead past every aircraft.
    pub(crate) fn common_neighbors(searches: &[(Self, Task)], span: &Span) -> Option<(f64, f64)> {
        [-1.0, 1.0]
            .into_iter()
            .enumerate()
            .find_map(|(side, sign)| {
                let sides = searches.iter().filter_map(|(search, task)| {
                    let mut sides = search.sides(task).into_iter();
                    sides.nth(side)
                });
                let sides: Vec<SideSearch> = sides.collect();
                let lines = sides.first().map_or(&[][..], |side| side.later.lines);
                let mut is_free_before = false;
                for (index, line) in lines.iter().enumerate() {
                    let mut is_free = true;
                    for side in &sides {
                        is_free &= side.look(index, line)?;
                    }
                    if is_free && is_free_before {
                        let value = |index| span.value + sign * span.step * f64::from(int(index));
                        let (near, far) = (value(index - 1), value(index));
                        return Some((near.min(far), near.max(far)));
                    }
                    is_free_before = is_free;
                }
                None
            })
    }

    /// The values without conflict.
    pub(crate) fn free(&self, task: &Task, span: &Span, free: &mut Intervals) {
        let [low, high] = self.sides(task);
        let mut runs: Vec<[i32; 2]> = Vec::new();
        low.free_runs(When::Whole, |first, last| {
            runs.push([-int(last), -int(first)]);
            true
        });
        runs.reverse();
        high.free_runs(When::Whole, |first, last| {
            let (first, last) = (int(first), int(last));
            match runs.last_mut() {
                // Both sides begin at the current value.
                Some(run) if runs_join(*run, first) => run[1] = last,
                _ => runs.push([first, last]),
            }
            true
        });
        free.clear();
        for [first, last] in runs {
            if first != last {
                span.add_free(
                    free,
                    span.step * f64::from(first) + span.value,
                    span.step * f64::from(last) + span.value,
                );
            }
        }
    }
}

/// A number of steps from a rounded one.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "casts of floats saturate, and no more steps than usize holds are asked for"
)]
const fn count_of(steps: f64) -> usize {
    steps as usize
}

/// A step count, of which there are at most 100,000.
fn int(steps: usize) -> i32 {
    i32::try_from(steps).unwrap_or(i32::MAX)
}

/// Whether a run on the high side continues one on the low side.
fn runs_join([begin, end]: [i32; 2], first: i32) -> bool {
    begin <= 0 && end <= 0 && first - end <= 1
}

impl SideSearch<'_> {
    fn count(&self) -> usize {
        self.later.lines.len()
    }

    /// Until when a line that begins at a time is looked at.
    #[expect(clippy::inline_always, reason = "asked for each line of each quantity")]
    #[inline(always)]
    fn until_s(&self, since_s: f64) -> f64 {
        if self.step_s == 0.0 {
            return self.task.until_s;
        }
        self.later.met.horizon_s(self.task.until_s, since_s)
    }

    /// Whether the straight line after a step is free of conflicts.
    #[inline]
    fn leads_past(&self, index: usize) -> bool {
        let from_s = self.task.from_s;
        let since_s = self.later.lines.get(index).map_or(0.0, |line| line.since_s);
        !self.later.meets_later(index, from_s, self.until_s(since_s))
            && !self
                .before
                .is_some_and(|before| before.meets_later(index, 0.0, from_s))
    }

    /// Whether the straight line after a step is free of conflicts; `None` where a volume that counts is met on the
    /// way to the next step: no later one can be flown to, nor this one.
    #[expect(clippy::inline_always, reason = "asked for each line of each quantity")]
    #[inline(always)]
    fn look(&self, index: usize, line: &Line) -> Option<bool> {
        let (later, since_s) = (self.later, line.since_s);
        // Most lines meet nothing at all.
        if self.before.is_none() && later.never_meets(index, line) {
            return Some(true);
        }
        let lookahead_s = later.met.settings.lookahead_s;
        let from_s = self.task.from_s;
        let goes_on = self.step_s > 0.0 && since_s < lookahead_s;
        let way_s = (since_s, since_s + self.step_s);
        let mut meets = false;
        if let Some(before) = self.before {
            let stops = goes_on && index <= self.last_before;
            let line_s = (since_s, earlier_of(from_s, lookahead_s));
            let counts = line_s.0 <= line_s.1;
            if (stops || counts) && !before.never_meets(index, line) {
                let window = before.window(index, line);
                if stops && before.overlaps(window, line, way_s) {
                    return None;
                }
                meets = counts && before.overlaps(window, line, line_s);
            }
        }
        let (from, last) = self.counts;
        let stops = goes_on && from <= index && index <= last;
        let line_s = (
            later_of(from_s, since_s),
            earlier_of(self.until_s(since_s), lookahead_s),
        );
        let counts = line_s.0 <= line_s.1 && !meets;
        let is_over = !stops && later.is_surely_over(index, line_s.0);
        if (stops || counts) && !is_over && !later.never_meets(index, line) {
            let window = later.window(index, line);
            if stops && later.overlaps(window, line, way_s) {
                return None;
            }
            meets = meets || (counts && later.overlaps(window, line, line_s));
        }
        Some(!meets)
    }

    /// Whether any step leads into the volume, which counts from now on.
    fn any_conflict(&self) -> bool {
        let change = Change::of(self.later.lines);
        let last_s = self.until_s(self.later.lines.last().map_or(0.0, |line| line.since_s));
        let mut index = 0;
        while index < self.count() {
            let quiet = change.map_or(0, |change| self.later.quiet(index, last_s, &change));
            // Where it is not quiet, a few lines are looked at before that is asked again.
            let asked = index..index.saturating_add(LINES_BETWEEN).min(self.count());
            if quiet == 0 && asked.clone().any(|index| !self.leads_past(index)) {
                return true;
            }
            index = if quiet == 0 {
                asked.end
            } else {
                index.saturating_add(quiet)
            };
        }
        false
    }

    /// Calls `take` for each run of steps without conflict, as long as it wants more.
    fn free_runs(&self, when: When, mut take: impl FnMut(usize, usize) -> bool) {
        let mut first: Option<usize> = None;
        let mut steps = 0;
        for (index, line) in self.later.lines.iter().enumerate() {
            let Some(is_free) = self.look(index, line) else {
                break;
            };
            steps = index + 1;
            if is_free {
                let first = *first.get_or_insert(index);
                if when == When::Soon && first != index && !take(first, index) {
                    return;
                }
            } else if let Some(first) = first.take()
                && (when == When::Whole || first + 1 != index)
                && !take(first, index.saturating_sub(1))
            {
                return;
            }
        }
        if let Some(first) = first
            && first + 1 != steps
        {
            take(first, steps.saturating_sub(1));
        }
    }

    /// Whether some step is reachable and leads past.
    fn finds_a_way(&self) -> bool {
        let from_s = self.task.from_s;
        for (index, line) in self.later.lines.iter().enumerate() {
            if self.step_s > 0.0 {
                let at_s = line.since_s;
                let violates = |meeting: &Meeting| meeting.meets_on_the_way(index, 0.0);
                if (from_s <= at_s && violates(self.later))
                    || (at_s <= from_s && self.before.is_some_and(violates))
                {
                    return false;
                }
            }
            if self.leads_past(index) {
                return true;
            }
        }
        false
    }
}
