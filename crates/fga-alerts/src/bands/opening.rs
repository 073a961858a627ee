//! Between which times recovery may change from its cylinder to a level's volume on a way, found once for all
//! times that its search tries.
//!
//! A way is free where it leaves the level's volume before the change and meets the cylinder after it. Both are
//! times of its windows; only a change within rounding of one of them asks the exact question again.

use crate::bands::level::{Levels, Target};
use crate::bands::met::{Meeting, clear_s};
use crate::loss::{earlier_of, later_of};
use alloc::vec::Vec;

/// A change between two times is free of conflicts; not a number where rounding decides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Opening {
    from_s: f64,
    until_s: f64,
}

/// The times at which some way is free.
#[derive(Debug, Default)]
pub(super) struct Openings {
    sure: Vec<Opening>,
    unsure: Vec<Opening>,
    best_s: f64,
    /// A time that rounding cannot make, seconds.
    pub(super) clear_s: f64,
}

impl Openings {
    pub(super) fn new(lookahead_s: f64) -> Self {
        Self {
            clear_s: clear_s(lookahead_s),
            best_s: f64::INFINITY,
            ..Self::default()
        }
    }

    /// Adds an opening; `is_sure` unless the way counts only perhaps.
    pub(super) fn add(&mut self, opening: Opening, is_sure: bool) {
        let Opening { from_s, until_s } = opening;
        if from_s.is_nan() {
            self.unsure.push(Opening::ALWAYS);
            return;
        }
        if opening.is_over(self.clear_s) {
            return;
        }
        if is_sure && until_s == f64::INFINITY {
            self.best_s = earlier_of(from_s - 2.0 * self.clear_s, self.best_s);
        }
        let openings = if is_sure {
            &mut self.sure
        } else {
            &mut self.unsure
        };
        // Within the hull of two openings each time is inside one of them if their common part is long enough.
        if let Some(last) = openings.last_mut()
            && earlier_of(until_s, last.until_s) - later_of(from_s, last.from_s)
                > 2.0 * self.clear_s
        {
            last.from_s = earlier_of(last.from_s, from_s);
            last.until_s = later_of(last.until_s, until_s);
            return;
        }
        openings.push(opening);
    }

    /// A time at which, and after which, further openings say nothing more than what is known: some way is surely
    /// free from a little later on; infinite for none. How little, [`Self::is_open`] knows.
    pub(super) const fn best_s(&self) -> f64 {
        self.best_s
    }

    /// Whether some way is free if recovery changes at a time; `None` where rounding decides.
    pub(super) fn is_open(&self, change_s: f64) -> Option<bool> {
        let room_s =
            |opening: &Opening| earlier_of(change_s - opening.from_s, opening.until_s - change_s);
        if self
            .sure
            .iter()
            .any(|opening| room_s(opening) > self.clear_s)
        {
            return Some(true);
        }
        // A little before the best time, openings that begin later were left out.
        let mut all = self.sure.iter().chain(&self.unsure);
        all.all(|opening| room_s(opening) < -3.0 * self.clear_s)
            .then_some(false)
    }
}

impl Opening {
    pub(super) const ALWAYS: Self = Self {
        from_s: f64::NEG_INFINITY,
        until_s: f64::INFINITY,
    };
    /// At no time.
    pub(super) const NEVER: Self = Self {
        from_s: f64::INFINITY,
        until_s: f64::NEG_INFINITY,
    };
    const UNCLEAR: Self = Self {
        from_s: f64::NAN,
        until_s: f64::NAN,
    };

    pub(super) fn and(self, from_s: f64, until_s: f64) -> Self {
        if self.from_s.is_nan() || from_s.is_nan() || until_s.is_nan() {
            return Self::UNCLEAR;
        }
        Self {
            from_s: later_of(self.from_s, from_s),
            until_s: earlier_of(self.until_s, until_s),
        }
    }

    /// What both have in common.
    pub(super) fn with(self, other: Self) -> Self {
        self.and(other.from_s, other.until_s)
    }

    /// Whether no time lies between, whatever rounding does.
    pub(super) fn is_over(self, clear_s: f64) -> bool {
        self.until_s - self.from_s < -2.0 * clear_s
    }

    /// Whether it begins at or after a time.
    pub(super) fn begins_after(self, time_s: f64) -> bool {
        self.from_s >= time_s
    }

    /// The part after a time.
    pub(super) fn after(self, from_s: f64) -> Self {
        self.and(from_s, f64::INFINITY)
    }

    /// The part before a time.
    pub(super) fn before(self, until_s: f64) -> Self {
        self.and(f64::NEG_INFINITY, until_s)
    }

    /// The opening of a line where only the cylinder counts.
    pub(super) fn of_cylinder(is_free: bool) -> Self {
        if is_free { Self::ALWAYS } else { Self::NEVER }
    }

    /// The opening of an altitude, of a conflict with this horizon, as far as it is before the best time known.
    pub(super) fn of_target(
        [own, cylinder]: [&Meeting; 2],
        levels: &Levels,
        target: &Target,
        horizon_s: f64,
        best_s: f64,
    ) -> Self {
        let level = target.level();
        let Some(way) = target.way() else {
            let opening = Self::ALWAYS.after(own.left_s(level, horizon_s));
            return opening.before(cylinder.met_s(level, f64::INFINITY));
        };
        let until_s = |maneuver_s: f64| own.met.horizon_s(horizon_s, maneuver_s.max(0.0));
        let (t1, t2, t3) = (way.rate_since_s, way.rate_until_s, way.level_since_s);
        let at_rate_s = own.left_s(way.rate(), until_s(t1).min(t2));
        let at_level_s = own.left_s(level, until_s(t3));
        let mut opening = Self::ALWAYS.after(at_rate_s).after(at_level_s);
        if opening.begins_after(best_s) {
            return Self::NEVER;
        }
        let met_s = cylinder.met_s(way.rate(), t2);
        opening = opening.before(met_s);
        opening = opening.before(cylinder.met_s(level, f64::INFINITY));
        for index in way.early().chain(target.late()) {
            let since_s = levels.lines.get(index).map_or(0.0, |line| line.since_s);
            if own.meets_on_the_way(index, 0.0) {
                opening = opening.after(since_s);
            }
            if cylinder.meets_on_the_way(index, 0.0) {
                opening = opening.before(since_s);
            }
        }
        opening
    }
}
