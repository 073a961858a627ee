//! Finds the steps of a manoeuvre that lead into a conflict.

use crate::aircraft::{Pair, PairDeviation, State};
use crate::almost::Closeness::Rounding;
use crate::bands::intervals::Intervals;
use crate::bands::path::{Fan, LevelChange, Line};
use crate::bands::span::{Quantity, Span};
use crate::loss::Loss;
use crate::settings::Settings;
use crate::volume::Volume;
use alloc::vec::Vec;

/// The volumes to avoid: one from a time on, another one until then.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Task<'a> {
    /// The volume that counts from `from_s` on.
    pub(crate) volume: &'a Volume,
    /// The volume that counts until `from_s`, in recovery.
    pub(crate) before: Option<&'a Volume>,
    /// Start of the volume, seconds.
    pub(crate) from_s: f64,
    /// End of the search, seconds.
    pub(crate) until_s: f64,
}

/// An intruder for the ownship's manoeuvres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Met<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) intruder: &'a State,
    pub(crate) deviation: PairDeviation,
}

impl Met<'_> {
    fn pair(&self, line: &Line) -> Pair {
        Pair {
            ownship: line.state,
            intruder: *self.intruder,
            deviation: self.deviation,
        }
    }

    /// When the line meets the volume; `None` if that depends on the requested time.
    fn window(&self, volume: &Volume, line: &Line) -> Option<Loss> {
        if !line.exists() {
            return Some(Loss::NEVER);
        }
        volume.window(&self.pair(line), self.settings.lookahead_s + 1.0)
    }

    fn meets(
        &self,
        volume: &Volume,
        line: &Line,
        window: Option<Loss>,
        from_s: f64,
        to_s: f64,
    ) -> bool {
        match window {
            Some(window) if Rounding.same(from_s, to_s) => window.is_on_at(from_s),
            Some(window) => from_s <= to_s && window.conflicts_within(from_s, to_s),
            None => volume.conflicts(&self.pair(line), from_s, to_s),
        }
    }

    /// Whether the line violates the volume between two times, once the ownship is on it.
    fn meets_later(
        &self,
        volume: &Volume,
        line: &Line,
        window: Option<Loss>,
        from_s: f64,
        until_s: f64,
    ) -> bool {
        let until_s = until_s.min(self.settings.lookahead_s);
        line.since_s <= until_s
            && from_s <= until_s
            && self.meets(volume, line, window, from_s.max(line.since_s), until_s)
    }

    /// Whether the ownship violates the volume at the time at which it reaches the line, or in
    /// the `coast_s` after it.
    fn meets_on_the_way(
        &self,
        volume: &Volume,
        line: &Line,
        window: Option<Loss>,
        coast_s: f64,
    ) -> bool {
        line.since_s < self.settings.lookahead_s
            && self.meets(volume, line, window, line.since_s, line.since_s + coast_s)
    }

    /// End of the checked time of a manoeuvre that ends at a time.
    fn horizon_s(&self, until_s: f64, maneuver_s: f64) -> f64 {
        if self.settings.counts_maneuver_time {
            until_s
        } else {
            until_s + maneuver_s
        }
    }
}

/// The windows in which the lines of a fan violate one volume of one intruder.
#[derive(Debug, Clone, Default)]
pub(crate) struct Windows([Vec<Option<Loss>>; 2]);

impl Windows {
    pub(crate) fn fill(&mut self, met: &Met, volume: &Volume, fan: &Fan) {
        for (windows, lines) in self.0.iter_mut().zip(&fan.sides) {
            windows.clear();
            windows.extend(lines.iter().map(|line| met.window(volume, line)));
        }
    }
}

/// A fan of manoeuvres against one intruder.
pub(crate) struct FanSearch<'a> {
    pub(crate) met: Met<'a>,
    pub(crate) fan: &'a Fan,
    /// Windows of the task's volume.
    pub(crate) windows: &'a Windows,
    /// Windows of the task's earlier volume.
    pub(crate) before: Option<&'a Windows>,
}

/// One side of a fan.
struct SideSearch<'a> {
    met: &'a Met<'a>,
    lines: &'a [Line],
    windows: &'a [Option<Loss>],
    before: &'a [Option<Loss>],
    step_s: f64,
    task: &'a Task<'a>,
}

impl FanSearch<'_> {
    fn sides<'b>(&'b self, task: &'b Task<'b>) -> [SideSearch<'b>; 2] {
        let [low, high] = &self.fan.sides;
        let [low_windows, high_windows] = &self.windows.0;
        let before = |side: usize| {
            self.before
                .and_then(|windows| windows.0.get(side))
                .map_or(&[][..], Vec::as_slice)
        };
        let side = |lines, windows, index| SideSearch {
            met: &self.met,
            lines,
            windows,
            before: before(index),
            step_s: self.fan.step_s,
            task,
        };
        [side(low, low_windows, 0), side(high, high_windows, 1)]
    }

    /// Whether any manoeuvre leads into the volume.
    pub(crate) fn any_conflict(&self, task: &Task) -> bool {
        self.sides(task).iter().any(SideSearch::any_conflict)
    }

    /// Whether no manoeuvre leads past the volume.
    pub(crate) fn all_conflict(&self, task: &Task) -> bool {
        !self.sides(task).iter().any(SideSearch::finds_a_way)
    }

    /// The values without conflict.
    pub(crate) fn free(&self, task: &Task, span: &Span, free: &mut Intervals) {
        let [low, high] = self.sides(task);
        let mut runs: Vec<[i32; 2]> = Vec::new();
        low.free_runs(|first, last| runs.push([-last, -first]));
        runs.reverse();
        high.free_runs(|first, last| {
            match runs.last_mut() {
                // Both sides begin at the current value.
                Some(run) if runs_join(*run, first) => run[1] = last,
                _ => runs.push([first, last]),
            }
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

/// Whether a run on the high side continues one on the low side.
fn runs_join([begin, end]: [i32; 2], first: i32) -> bool {
    begin <= 0 && end <= 0 && first - end <= 1
}

impl SideSearch<'_> {
    fn each(&self) -> impl Iterator<Item = (&Line, Option<Loss>, Option<Loss>)> {
        self.lines.iter().enumerate().map(|(k, line)| {
            (
                line,
                self.windows.get(k).copied().flatten(),
                self.before.get(k).copied().flatten(),
            )
        })
    }

    /// Whether the straight line after a step is free of conflicts.
    fn leads_past(&self, line: &Line, window: Option<Loss>, before: Option<Loss>) -> bool {
        let task = self.task;
        let until_s = if self.step_s == 0.0 {
            task.until_s
        } else {
            self.met.horizon_s(task.until_s, line.since_s)
        };
        let meets = self
            .met
            .meets_later(task.volume, line, window, task.from_s, until_s);
        let meets_before = task
            .before
            .is_some_and(|volume| self.met.meets_later(volume, line, before, 0.0, task.from_s));
        !meets && !meets_before
    }

    fn any_conflict(&self) -> bool {
        self.each()
            .any(|(line, window, before)| !self.leads_past(line, window, before))
    }

    /// Number of steps before the manoeuvre itself violates the volume.
    fn flyable_steps(&self) -> usize {
        let task = self.task;
        let (met, step_s) = (self.met, self.step_s);
        if step_s == 0.0 {
            return self.lines.len();
        }
        // The volume counts from the first step at or after `from_s`, the earlier one until then.
        let first = libm::ceil(task.from_s / step_s);
        let last = libm::floor(met.settings.lookahead_s / step_s);
        let last_before = libm::floor(task.from_s / step_s);
        self.each()
            .enumerate()
            .position(|(k, (line, window, before))| {
                let k = k as f64;
                let stops = |volume, window| met.meets_on_the_way(volume, line, window, step_s);
                (first <= k && k <= last && stops(task.volume, window))
                    || task
                        .before
                        .is_some_and(|volume| k <= last_before && stops(volume, before))
            })
            .unwrap_or(self.lines.len())
    }

    /// Calls `take` for each run of steps without conflict.
    fn free_runs(&self, mut take: impl FnMut(i32, i32)) {
        let steps = self.flyable_steps();
        let mut first = None;
        let mut last = 0;
        for (k, (line, window, before)) in (0_i32..).zip(self.each().take(steps)) {
            if self.leads_past(line, window, before) {
                first.get_or_insert(k);
                last = k;
            } else if let Some(first) = first.take() {
                take(first, last);
            }
        }
        if let Some(first) = first
            && first != last
        {
            take(first, last);
        }
    }

    /// Whether some step is reachable and leads past.
    fn finds_a_way(&self) -> bool {
        let task = self.task;
        for (line, window, before) in self.each() {
            if self.step_s > 0.0 {
                let at_s = line.since_s;
                let violates =
                    |volume, window| self.met.meets_on_the_way(volume, line, window, 0.0);
                if (task.from_s <= at_s && violates(task.volume, window))
                    || task
                        .before
                        .is_some_and(|volume| at_s <= task.from_s && violates(volume, before))
                {
                    return false;
                }
            }
            if self.leads_past(line, window, before) {
                return true;
            }
        }
        false
    }
}

/// Altitude manoeuvres against one intruder.
pub(crate) struct LevelSearch<'a> {
    pub(crate) met: Met<'a>,
    pub(crate) ownship: &'a State,
    pub(crate) instantaneous: bool,
}

impl LevelSearch<'_> {
    fn meets_at(&self, volume: &Volume, line: &Line) -> bool {
        let window = self.met.window(volume, line);
        self.met.meets_on_the_way(volume, line, window, 0.0)
    }

    fn meets_later(&self, volume: &Volume, line: &Line, from_s: f64, until_s: f64) -> bool {
        let window = self.met.window(volume, line);
        self.met.meets_later(volume, line, window, from_s, until_s)
    }

    /// Whether the way to an altitude is free of conflicts.
    pub(crate) fn leads_past(&self, target_m: f64, task: &Task) -> bool {
        if self.instantaneous {
            let line = LevelChange::instantly(target_m, self.ownship);
            return self.line_leads_past(&line, task, task.until_s);
        }
        let change = LevelChange::to(target_m, self.met.settings, self.ownship);
        let (t1, t2) = (change.rate_since_s, change.rate_until_s);
        let t3 = change.level_since_s + 1.0;
        if !(t1.is_finite() && t2.is_finite() && t3.is_finite()) {
            return self.line_leads_past(&change.line_at(0.0), task, task.until_s);
        }
        let horizon_s = self.met.settings.lookahead_s;
        let seconds = |first: f64, last: f64| {
            let (first, last) = (first.max(0.0), last.min(horizon_s));
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "not negative and at most the horizon"
            )]
            let count = if last < first {
                0
            } else {
                (last - first) as usize + 1
            };
            (0..count).map(move |i| first + i as f64)
        };
        let violates = |time_s: f64| {
            let line = change.line_at(time_s);
            (task.from_s <= time_s && self.meets_at(task.volume, &line))
                || task
                    .before
                    .is_some_and(|volume| time_s <= task.from_s && self.meets_at(volume, &line))
        };
        if seconds(0.0, libm::floor(t1)).any(violates) {
            return false;
        }
        let holding = change.line_at(t1.max(0.0));
        let until_s = self.met.horizon_s(task.until_s, t1.max(0.0)).min(t2);
        if (t2 >= task.from_s && self.meets_later(task.volume, &holding, task.from_s, until_s))
            || (t2 >= 0.0
                && task.before.is_some_and(|volume| {
                    self.meets_later(volume, &holding, 0.0, task.from_s.min(t2))
                }))
        {
            return false;
        }
        if seconds(libm::ceil(t2), libm::floor(t3)).any(violates) {
            return false;
        }
        let level = change.line_at(t3.max(0.0));
        let until_s = self.met.horizon_s(task.until_s, t3.max(0.0));
        self.line_leads_past(&level, task, until_s)
    }

    fn line_leads_past(&self, line: &Line, task: &Task, until_s: f64) -> bool {
        !self.meets_later(task.volume, line, task.from_s, until_s)
            && !task
                .before
                .is_some_and(|volume| self.meets_later(volume, line, 0.0, task.from_s))
    }

    /// Whether the way to an altitude is free of conflicts, using one result for all altitudes beyond the
    /// horizon: the ways to them are the same.
    fn leads_past_or_known(
        &self,
        target_m: f64,
        task: &Task,
        known: &mut [Option<bool>; 2],
    ) -> bool {
        if self.instantaneous {
            return self.leads_past(target_m, task);
        }
        let settings = self.met.settings;
        let height_m = self.ownship.position_m.z;
        let climb_mps = self.ownship.velocity_mps.z.abs();
        let rate_mps = settings.vertical_rate_mps.max(climb_mps);
        // Stopping, accelerating and levelling out take less than three braking ways.
        let braking_m = rate_mps * rate_mps / settings.vertical_acceleration_mps2;
        let beyond_m = rate_mps * settings.lookahead_s + 3.0 * braking_m;
        let is_beyond = (target_m - height_m).abs() > beyond_m;
        let [down, up] = known;
        let known = if target_m >= height_m { up } else { down };
        match *known {
            Some(free) if is_beyond => free,
            _ => {
                let free = self.leads_past(target_m, task);
                if is_beyond {
                    *known = Some(free);
                }
                free
            }
        }
    }

    /// Number of searched altitudes of a span, less one.
    fn last_step(span: &Span) -> i32 {
        int(libm::floor((span.max - span.min) / span.step)) + 1
    }

    fn target_m(span: &Span, step: i32) -> f64 {
        span.min + f64::from(step) * span.step
    }

    /// The altitudes without conflict.
    pub(crate) fn free(&self, task: &Task, span: &Span, free: &mut Intervals) {
        free.clear();
        let last = Self::last_step(span);
        let mut first = None;
        let add = |free: &mut Intervals, first: i32, last: i32| {
            if first != last {
                span.add_free(
                    free,
                    span.step * f64::from(first) + span.min,
                    span.step * f64::from(last) + span.min,
                );
            }
        };
        let mut known = [None; 2];
        for step in 0..=last {
            if self.leads_past_or_known(Self::target_m(span, step), task, &mut known) {
                first.get_or_insert(step);
            } else if let Some(first) = first.take() {
                add(free, first, step - 1);
            }
        }
        if let Some(first) = first {
            add(free, first, last);
        }
    }

    /// Whether some altitude from the current one upwards, or downwards, is `wanted`: free or not.
    fn finds(&self, task: &Task, span: &Span, wanted_free: bool) -> bool {
        let height_m = self.ownship.position_m.z;
        if height_m < span.min || height_m > span.max {
            return false;
        }
        let up_from = int(libm::ceil(height_m - span.min) / span.step);
        let down_from = int(libm::floor((height_m - span.min) / span.step));
        let mut known = [None; 2];
        let mut is_wanted = |step: i32| {
            let target_m = Self::target_m(span, step);
            self.leads_past_or_known(target_m, task, &mut known) == wanted_free
        };
        (up_from..=Self::last_step(span)).any(&mut is_wanted)
            || (0..=down_from).rev().any(&mut is_wanted)
    }

    pub(crate) fn any_conflict(&self, task: &Task, span: &Span) -> bool {
        self.finds(task, span, false)
    }

    pub(crate) fn all_conflict(&self, task: &Task, span: &Span) -> bool {
        !self.finds(task, span, true)
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "casts of floats saturate, and more steps than i32 holds are never asked for"
)]
fn int(value: f64) -> i32 {
    value as i32
}

/// Whether the search of a quantity goes altitude by altitude.
pub(crate) const fn is_level(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::Altitude)
}
