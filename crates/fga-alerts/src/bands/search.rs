//! Finds the steps of a manoeuvre that lead into a conflict.

use crate::bands::intervals::Intervals;
use crate::bands::met::Meeting;
use crate::bands::opening::{Openings, SideOpenings, hull};
use crate::bands::span::Span;
use alloc::vec::Vec;
use core::ops::Range;

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
    pub(crate) later: [Meeting<'a>; 2],
    /// The task's earlier volume.
    pub(crate) before: Option<[Meeting<'a>; 2]>,
    /// Time of one step, seconds; 0 where a maneuver takes none.
    pub(crate) step_s: f64,
    /// What is known of a task with an earlier volume.
    pub(super) openings: Option<&'a Openings>,
}

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
    task: &'a Task,
    /// Steps outside of it meet nothing.
    live: Range<usize>,
    openings: Option<&'a SideOpenings>,
}

impl FanSearch<'_> {
    fn sides<'b>(&'b self, task: &'b Task) -> [SideSearch<'b>; 2] {
        let [low, high] = &self.later;
        let before = self.before.as_ref();
        let side = |index, later: &'b Meeting<'b>, before: Option<&'b Meeting<'b>>| SideSearch {
            openings: self.openings.and_then(|openings| openings.side(index)),
            later,
            before,
            step_s: self.step_s,
            task,
            live: hull(later.live(), before.map_or(0..0, Meeting::live)),
        };
        [
            side(0, low, before.map(|[low, _]| low)),
            side(1, high, before.map(|[_, high]| high)),
        ]
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

    /// Two neighbouring values that lead past every aircraft, where the volumes count from now on.
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
                let count = sides.first().map_or(0, SideSearch::count);
                let mut is_free_before = false;
                for index in 0..count {
                    if sides.iter().any(|side| side.stops_at(index)) {
                        return None;
                    }
                    let is_free = sides.iter().all(|side| side.leads_past(index));
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

    /// Whether the straight line after a step is free of conflicts.
    #[inline]
    fn leads_past(&self, index: usize) -> bool {
        let known = self.openings;
        known
            .and_then(|openings| openings.is_free(index, self.task.from_s))
            .unwrap_or_else(|| self.finds_past(index))
    }

    /// Whether the volume, which counts from now on, is met on the way to the next step.
    fn stops_at(&self, index: usize) -> bool {
        self.step_s > 0.0
            && index as f64 <= libm::floor(self.later.met.settings.lookahead_s / self.step_s)
            && self.later.meets_on_the_way(index, self.step_s)
    }

    fn finds_past(&self, index: usize) -> bool {
        let task = self.task;
        let until_s = if self.step_s == 0.0 {
            task.until_s
        } else {
            let since_s = self.later.lines.get(index).map_or(0.0, |line| line.since_s);
            self.later.met.horizon_s(task.until_s, since_s)
        };
        !self.later.meets_later(index, task.from_s, until_s)
            && !self
                .before
                .is_some_and(|before| before.meets_later(index, 0.0, task.from_s))
    }

    fn any_conflict(&self) -> bool {
        self.live.clone().any(|index| !self.leads_past(index))
    }

    /// Number of steps before the manoeuvre itself violates the volume.
    fn flyable_steps(&self) -> usize {
        let task = self.task;
        let step_s = self.step_s;
        if step_s == 0.0 {
            return self.count();
        }
        // The volume counts from the first step at or after `from_s`, the earlier one until then.
        let from = count_of(libm::ceil(task.from_s / step_s));
        let last = count_of(libm::floor(self.later.met.settings.lookahead_s / step_s));
        let last_before = count_of(libm::floor(task.from_s / step_s));
        let Range { start, mut end } = self.live.clone();
        let before = self.before.and_then(|before| {
            let lines = start..end.min(last_before.saturating_add(1));
            before.first_met(lines, step_s)
        });
        end = before.unwrap_or(end);
        let lines = start.max(from)..end.min(last.saturating_add(1));
        let later = self.later.first_met(lines, step_s);
        later.or(before).unwrap_or(self.count())
    }

    /// Calls `take` for each run of steps without conflict, as long as it wants more.
    fn free_runs(&self, when: When, mut take: impl FnMut(usize, usize) -> bool) {
        let steps = self.flyable_steps();
        let Some(last) = steps.checked_sub(1) else {
            return;
        };
        // Up to the first live step all are free.
        let mut first = (self.live.start > 0 || self.live.is_empty()).then_some(0);
        for index in self.live.start..self.live.end.min(steps) {
            if self.leads_past(index) {
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
        // Behind the last one too.
        let first = first.or_else(|| (self.live.end < steps).then_some(self.live.end));
        if let Some(first) = first
            && first != last
        {
            take(first, last);
        }
    }

    /// Whether some step is reachable and leads past.
    fn finds_a_way(&self) -> bool {
        let task = self.task;
        for (index, line) in self.later.lines.iter().enumerate() {
            if !self.live.contains(&index) {
                return true;
            }
            if self.step_s > 0.0 {
                let at_s = line.since_s;
                let violates = |meeting: &Meeting| meeting.meets_on_the_way(index, 0.0);
                if (task.from_s <= at_s && violates(self.later))
                    || (at_s <= task.from_s && self.before.is_some_and(violates))
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
