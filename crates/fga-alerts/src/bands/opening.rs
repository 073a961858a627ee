//! Between which times recovery may change from its cylinder to a level's volume on a way, found once for all
//! times that its search tries.
//!
//! A way is free where it leaves the level's volume before the change and meets the cylinder after it. Both are
//! times of its windows; only a change within rounding of one of them asks the exact question again.

use crate::bands::level::Levels;
use crate::bands::met::Meeting;
use crate::bands::path::Fan;
use crate::bands::search::Task;
use alloc::vec::Vec;
use core::ops::Range;

/// A change between two times is free of conflicts; not a number where rounding decides.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Opening {
    from_s: f64,
    until_s: f64,
}

/// The openings of the ways against one aircraft.
#[derive(Debug, Clone, Default)]
pub(super) struct Openings {
    sides: [SideOpenings; 2],
}

/// The openings of one side's steps, or of all altitudes.
#[derive(Debug, Clone, Default)]
pub(super) struct SideOpenings {
    /// The first step with an entry; steps without one are free.
    first: usize,
    openings: Vec<Opening>,
    /// A time that rounding cannot make, seconds.
    clear_s: f64,
}

impl Opening {
    const ALWAYS: Self = Self {
        from_s: f64::NEG_INFINITY,
        until_s: f64::INFINITY,
    };
    const UNCLEAR: Self = Self {
        from_s: f64::NAN,
        until_s: f64::NAN,
    };

    fn and(self, from_s: f64, until_s: f64) -> Self {
        if self.from_s.is_nan() || from_s.is_nan() || until_s.is_nan() {
            return Self::UNCLEAR;
        }
        Self {
            from_s: self.from_s.max(from_s),
            until_s: self.until_s.min(until_s),
        }
    }

    /// The opening of a line on which the ownship is, until which time the volume counts and until which the
    /// cylinder at most.
    fn of_line(
        [later, before]: [&Meeting; 2],
        index: usize,
        until_s: f64,
        before_until_s: f64,
        clear_s: f64,
    ) -> Self {
        let left_s = match later.part(index, until_s) {
            Some((begin_s, end_s)) if end_s - begin_s > clear_s => end_s,
            Some((begin_s, end_s)) if begin_s - end_s <= clear_s => f64::NAN,
            _ => f64::NEG_INFINITY,
        };
        let met_s = match before.part(index, before_until_s) {
            Some((begin_s, end_s)) if end_s - begin_s > clear_s => begin_s,
            Some((begin_s, end_s)) if begin_s - end_s <= clear_s => f64::NAN,
            _ => f64::INFINITY,
        };
        Self::ALWAYS.and(left_s, met_s)
    }
}

impl SideOpenings {
    /// Whether a way is free if recovery changes at a time; `None` where rounding decides.
    #[inline]
    pub(super) fn is_free(&self, index: usize, change_s: f64) -> Option<bool> {
        let place = index.checked_sub(self.first);
        let Some(opening) = place.and_then(|place| self.openings.get(place)) else {
            return Some(true);
        };
        let room_s = (change_s - opening.from_s).min(opening.until_s - change_s);
        if room_s > self.clear_s {
            Some(true)
        } else if room_s < -self.clear_s {
            Some(false)
        } else {
            None
        }
    }
}

impl Openings {
    pub(super) fn side(&self, side: usize) -> Option<&SideOpenings> {
        self.sides.get(side)
    }

    /// Finds the openings of a fan's steps; the task's begin does not count.
    pub(super) fn fill_fan(
        &mut self,
        fan: &Fan,
        later: &[Meeting; 2],
        before: &[Meeting; 2],
        task: &Task,
    ) {
        for ((openings, later), before) in self.sides.iter_mut().zip(later).zip(before) {
            let met = &later.met;
            let lookahead_s = met.settings.lookahead_s;
            let clear_s = clear_s(lookahead_s);
            let live = hull(later.live(), before.live());
            openings.clear_s = clear_s;
            openings.first = live.start;
            openings.openings.clear();
            for index in live {
                let since_s = later.lines.get(index).map_or(0.0, |line| line.since_s);
                let until_s = if fan.step_s == 0.0 {
                    task.until_s
                } else {
                    met.horizon_s(task.until_s, since_s)
                };
                let until_s = until_s.min(lookahead_s);
                let pair = [later, before];
                let opening = Opening::of_line(pair, index, until_s, f64::INFINITY, clear_s);
                openings.openings.push(opening);
            }
        }
    }

    /// Finds the openings of altitudes; the task's begin does not count.
    pub(super) fn fill_levels(
        &mut self,
        levels: &Levels,
        later: &Meeting,
        before: &Meeting,
        task: &Task,
    ) {
        let [openings, _] = &mut self.sides;
        let met = &later.met;
        let lookahead_s = met.settings.lookahead_s;
        let clear_s = clear_s(lookahead_s);
        openings.clear_s = clear_s;
        openings.first = 0;
        openings.openings.clear();
        let live = hull(later.live(), before.live());
        for target in levels.targets() {
            let begin = target.first_line();
            let of_line = |index, until_s: f64, before_until_s| {
                let until_s = until_s.min(lookahead_s);
                Opening::of_line([later, before], index, until_s, before_until_s, clear_s)
            };
            let Some(way) = target.way() else {
                let opening = of_line(begin, task.until_s, f64::INFINITY);
                openings.openings.push(opening);
                continue;
            };
            let (rate, level) = target.rate_and_level();
            let mut opening = Opening::ALWAYS;
            // No line outside of the live ones meets anything.
            if live.start <= level && begin < live.end {
                let until_s = |maneuver_s: f64| met.horizon_s(task.until_s, maneuver_s.max(0.0));
                let (t1, t2, t3) = (way.rate_since_s, way.rate_until_s, way.level_since_s);
                let at_rate = of_line(rate, until_s(t1).min(t2), t2);
                let at_level = of_line(level, until_s(t3), f64::INFINITY);
                opening = at_rate.and(at_level.from_s, at_level.until_s);
                for index in (begin..rate).chain(rate + 1..level) {
                    let since_s = later.lines.get(index).map_or(0.0, |line| line.since_s);
                    if later.meets_on_the_way(index, 0.0) {
                        opening = opening.and(since_s, f64::INFINITY);
                    }
                    if before.meets_on_the_way(index, 0.0) {
                        opening = opening.and(f64::NEG_INFINITY, since_s);
                    }
                }
            }
            openings.openings.push(opening);
        }
    }
}

/// A time that rounding cannot make, seconds.
pub(super) fn clear_s(lookahead_s: f64) -> f64 {
    1e-6 * (1.0 + lookahead_s)
}

/// The least range with both.
pub(super) fn hull(a: Range<usize>, b: Range<usize>) -> Range<usize> {
    if a.is_empty() {
        b
    } else if b.is_empty() {
        a
    } else {
        a.start.min(b.start)..a.end.max(b.end)
    }
}
