//! Altitude maneuvers: which lines lead to each altitude, and which altitudes meet a conflict.

use crate::aircraft::State;
use crate::bands::intervals::Intervals;
use crate::bands::met::Meeting;
use crate::bands::path::{LevelChange, Line};
use crate::bands::search::{Task, When};
use crate::bands::span::Span;
use crate::settings::Settings;
use alloc::vec::Vec;
use core::ops::Range;

/// The lines that lead to the altitudes of a span.
///
/// Altitudes beyond the horizon are represented by one on each side: on the way to any of them
/// the same is met.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Levels {
    /// Lines of every target, in the order in which they are flown.
    pub(crate) lines: Vec<Line>,
    targets: Vec<Target>,
    /// Steps and the target that each of them is judged by, in growing order.
    parts: Vec<Part>,
    /// Steps from the current altitude upwards and downwards; none where it lies outside.
    around: Option<(i32, i32)>,
}

/// Neighbouring steps that one target stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    pub(super) first: i32,
    pub(super) last: i32,
    target: usize,
}

/// How an altitude is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Target {
    /// The line on which it flies level, or the only one.
    level: usize,
    /// `None` where the altitude is flown along one line from the begin.
    way: Option<LevelWay>,
}

/// A way of three parts: to the rate, along the rate, to the altitude.
///
/// The lines to the rate, and the one along it, are the same for all altitudes to one side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LevelWay {
    /// The first line.
    begin: usize,
    /// The line along the rate.
    rate: usize,
    /// The first line after the rate is left.
    late: usize,
    /// When the rate is reached and left, seconds.
    pub(super) rate_since_s: f64,
    pub(super) rate_until_s: f64,
    /// When it flies level, seconds.
    pub(super) level_since_s: f64,
}

impl LevelWay {
    /// Lines until the rate is reached.
    pub(super) fn early(&self) -> Range<usize> {
        self.begin..self.rate
    }

    pub(super) const fn rate(&self) -> usize {
        self.rate
    }
}

impl Target {
    /// `None` where the altitude is flown along one line from the begin.
    pub(super) const fn way(&self) -> Option<&LevelWay> {
        self.way.as_ref()
    }

    pub(super) const fn level(&self) -> usize {
        self.level
    }

    /// Lines after the rate is left and before the altitude is reached.
    pub(super) fn late(&self) -> Range<usize> {
        self.way.map_or(0..0, |way| way.late..self.level)
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "casts of floats saturate, and more steps than i32 holds are never asked for"
)]
const fn int(value: f64) -> i32 {
    value as i32
}

/// Whole seconds from one to another, within the horizon.
fn seconds(first_s: f64, last_s: f64, horizon_s: f64) -> impl Iterator<Item = f64> {
    let (first_s, last_s) = (first_s.max(0.0), last_s.min(horizon_s));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "not negative and at most the horizon"
    )]
    let count = if last_s < first_s {
        0
    } else {
        (last_s - first_s) as usize + 1
    };
    (0..count).map(move |i| first_s + i as f64)
}

/// The first of some steps from which on a condition holds, the end for none.
fn first_of(mut from: i32, mut end: i32, holds: impl Fn(i32) -> bool) -> i32 {
    while from < end {
        let middle = from.midpoint(end);
        if holds(middle) {
            end = middle;
        } else {
            from = middle + 1;
        }
    }
    from
}

/// Heights farther away than this are reached after the horizon, metres.
///
/// Stopping, accelerating and levelling out take less than three braking ways.
fn horizon_m(settings: &Settings, ownship: &State) -> f64 {
    let rate_mps = settings.vertical_rate_mps.max(ownship.velocity_mps.z.abs());
    let braking_m = rate_mps * rate_mps / settings.vertical_acceleration_mps2;
    rate_mps * settings.lookahead_s + 3.0 * braking_m
}

impl Levels {
    pub(super) fn targets(&self) -> &[Target] {
        &self.targets
    }

    /// Neighbouring steps, in growing order, and the target that they are judged by.
    pub(super) fn parts(&self) -> impl Iterator<Item = (&Part, &Target)> {
        self.parts
            .iter()
            .filter_map(|part| Some((part, self.targets.get(part.target)?)))
    }

    /// Finds the lines that lead to the altitudes of a span.
    pub(crate) fn fill(
        &mut self,
        settings: &Settings,
        ownship: &State,
        span: &Span,
        instantaneous: bool,
    ) {
        self.lines.clear();
        self.targets.clear();
        self.parts.clear();
        let height_m = ownship.position_m.z;
        let last = int(libm::floor((span.max - span.min) / span.step)) + 1;
        let inside = height_m >= span.min && height_m <= span.max;
        self.around = inside.then(|| {
            (
                int(libm::ceil(height_m - span.min) / span.step),
                int(libm::floor((height_m - span.min) / span.step)),
            )
        });
        let beyond_m = horizon_m(settings, ownship);
        let target_m = |step: i32| span.min + f64::from(step) * span.step;
        // Up or down beyond the horizon, else within it.
        let side = |step: i32| {
            let target_m = target_m(step);
            let is_beyond = !instantaneous && (target_m - height_m).abs() > beyond_m;
            is_beyond.then_some(target_m >= height_m)
        };
        // Targets grow with the steps, so the ones beyond the horizon are the first and the last ones.
        let below = first_of(0, last + 1, |step| side(step) != Some(false));
        let above = first_of(below, last + 1, |step| side(step) == Some(true));
        let first = (below > 0).then_some((0, below - 1));
        let within = (below..above).map(|step| (step, step));
        let rest = (above <= last).then_some((above, last));
        let mut start = None;
        for (first, last) in first.into_iter().chain(within).chain(rest) {
            let target = self.targets.len();
            self.parts.push(Part {
                first,
                last,
                target,
            });
            let target_m = target_m(first);
            if instantaneous {
                self.add_level(LevelChange::instantly(target_m, ownship), None);
            } else {
                let change = LevelChange::to(target_m, settings, ownship);
                self.add(&change, settings.lookahead_s, &mut start);
            }
        }
    }

    fn add_level(&mut self, line: Line, way: Option<LevelWay>) {
        let level = self.lines.len();
        self.lines.push(line);
        self.targets.push(Target { level, way });
    }

    /// Adds the lines to an altitude; `start` is the last change and where its first line and the one along its
    /// rate are.
    fn add(
        &mut self,
        change: &LevelChange,
        horizon_s: f64,
        start: &mut Option<(LevelChange, [usize; 2])>,
    ) {
        let (t1, t2) = (change.rate_since_s, change.rate_until_s);
        let t3 = change.level_since_s + 1.0;
        if !(t1.is_finite() && t2.is_finite() && t3.is_finite()) {
            return self.add_level(change.line_at(0.0), None);
        }
        let known = start.filter(|(before, _)| change.begins_as(before));
        let [begin, rate] = known.map_or_else(
            || {
                let begin = self.lines.len();
                let early = seconds(0.0, libm::floor(t1), horizon_s);
                self.lines
                    .extend(early.map(|time_s| change.line_at(time_s)));
                self.lines.push(change.line_at(t1.max(0.0)));
                [begin, self.lines.len() - 1]
            },
            |(_, lines)| lines,
        );
        *start = Some((*change, [begin, rate]));
        let late = self.lines.len();
        let seconds = seconds(libm::ceil(t2), libm::floor(t3), horizon_s);
        self.lines
            .extend(seconds.map(|time_s| change.line_at(time_s)));
        let way = LevelWay {
            begin,
            rate,
            late,
            rate_since_s: t1,
            rate_until_s: t2,
            level_since_s: t3,
        };
        self.add_level(change.line_at(t3.max(0.0)), Some(way));
    }
}

/// Altitude maneuvers against one intruder.
pub(crate) struct LevelSearch<'a> {
    pub(crate) levels: &'a Levels,
    /// The task's volume.
    pub(crate) later: &'a Meeting<'a>,
    /// The task's earlier volume.
    pub(crate) before: Option<&'a Meeting<'a>>,
}

impl LevelSearch<'_> {
    /// Whether one of these lines meets a conflict at the time at which the ownship is on it.
    fn violates(&self, lines: Range<usize>, task: &Task) -> bool {
        self.later
            .meets_at_begin(lines.clone(), task.from_s, f64::INFINITY)
            || self
                .before
                .is_some_and(|before| before.meets_at_begin(lines, 0.0, task.from_s))
    }

    fn line_leads_past(&self, index: usize, task: &Task, until_s: f64) -> bool {
        !self.later.meets_later(index, task.from_s, until_s)
            && !self
                .before
                .is_some_and(|before| before.meets_later(index, 0.0, task.from_s))
    }

    /// Whether flying to an altitude meets no conflict.
    pub(super) fn leads_past(&self, target: &Target, task: &Task) -> bool {
        let level = target.level();
        let Some(way) = target.way() else {
            return self.line_leads_past(level, task, task.until_s);
        };
        if self.violates(way.early(), task) {
            return false;
        }
        let rate = way.rate();
        let (t1, t2, t3) = (way.rate_since_s, way.rate_until_s, way.level_since_s);
        let met = &self.later.met;
        let until_s = met.horizon_s(task.until_s, t1.max(0.0)).min(t2);
        if (t2 >= task.from_s && self.later.meets_later(rate, task.from_s, until_s))
            || (t2 >= 0.0
                && self
                    .before
                    .is_some_and(|before| before.meets_later(rate, 0.0, task.from_s.min(t2))))
        {
            return false;
        }
        !self.violates(target.late(), task)
            && self.line_leads_past(level, task, met.horizon_s(task.until_s, t3.max(0.0)))
    }

    fn part_leads_past(&self, part: &Part, task: &Task) -> bool {
        let target = self.levels.targets.get(part.target);
        target.is_none_or(|target| self.leads_past(target, task))
    }

    /// Calls `take` with the first and last step of each run that meets no conflict, until it
    /// says that it has enough.
    fn free_runs(&self, task: &Task, when: When, mut take: impl FnMut(i32, i32) -> bool) {
        let mut run: Option<(i32, i32)> = None;
        for part in &self.levels.parts {
            if self.part_leads_past(part, task) {
                let first = run.map_or(part.first, |(first, _)| first);
                run = Some((first, part.last));
                if when == When::Soon && first != part.last && take(first, part.last) {
                    return;
                }
            } else if let Some((first, last)) = run.take()
                && first != last
                && take(first, last)
            {
                return;
            }
        }
        if let Some((first, last)) = run
            && first != last
        {
            take(first, last);
        }
    }

    /// Two neighbouring altitudes that meet no conflict with any aircraft.
    pub(crate) fn common_neighbors(searches: &[(Self, Task)], span: &Span) -> Option<(f64, f64)> {
        let (first, _) = searches.first()?;
        let mut is_free_before = false;
        for part in &first.levels.parts {
            let mut all = searches.iter();
            let is_free = all.all(|(search, task)| search.part_leads_past(part, task));
            if is_free && (is_free_before || part.first != part.last) {
                let step = if is_free_before {
                    part.first - 1
                } else {
                    part.first
                };
                let value = |step| span.step * f64::from(step) + span.min;
                return Some((value(step), value(step + 1)));
            }
            is_free_before = is_free;
        }
        None
    }

    /// The altitudes that meet no conflict.
    pub(crate) fn free(&self, task: &Task, span: &Span, free: &mut Intervals) {
        self.put_free(task, span, free, When::Whole);
    }

    /// A part of the altitudes that meet no conflict; none where there is no such altitude.
    pub(crate) fn some_free(&self, task: &Task, span: &Span, free: &mut Intervals) -> bool {
        self.put_free(task, span, free, When::Soon)
    }

    /// Puts the free altitudes, or the first part of them that has a length; whether there are any.
    fn put_free(&self, task: &Task, span: &Span, free: &mut Intervals, when: When) -> bool {
        free.clear();
        let mut found = false;
        self.free_runs(task, when, |first, last| {
            let value = |step| span.step * f64::from(step) + span.min;
            span.add_free(free, value(first), value(last));
            found = true;
            when == When::Soon
        });
        found
    }

    /// Whether some altitude from the current one upwards, or downwards, is `wanted`: free or not.
    fn finds(&self, task: &Task, wanted_free: bool) -> bool {
        let Some((up_from, down_from)) = self.levels.around else {
            return false;
        };
        let reaches = |part: &Part| part.last >= up_from || part.first <= down_from;
        self.levels
            .parts
            .iter()
            .any(|part| reaches(part) && self.part_leads_past(part, task) == wanted_free)
    }

    /// Whether no maneuver can begin: each begins on the current line, which meets the volume at
    /// once.
    pub(crate) fn is_blocked_at_once(&self, task: &Task) -> bool {
        task.from_s == 0.0
            && self.before.is_none()
            && self
                .levels
                .targets
                .iter()
                .all(|target| target.way.is_some_and(|way| way.begin < way.rate))
            && self.later.meets_on_the_way(0, 0.0)
    }

    pub(crate) fn any_conflict(&self, task: &Task) -> bool {
        self.finds(task, false)
    }

    pub(crate) fn all_conflict(&self, task: &Task) -> bool {
        !self.finds(task, true)
    }
}
