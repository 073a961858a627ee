//! The ways to the values of a span.

use crate::bands::intervals::Intervals;
use crate::bands::level::{LevelSearch, Levels};
use crate::bands::met::Meeting;
use crate::bands::path::{Fan, Lines, Range};
use crate::bands::search::{FanSearch, Task};
use crate::bands::span::{Quantity, Span};
use alloc::vec::Vec;

/// The ways to the values of a span.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Ways {
    /// Step by step from the current value.
    Fan(Fan),
    /// To each altitude.
    Levels(Levels),
}

impl Default for Ways {
    fn default() -> Self {
        Self::Fan(Fan::default())
    }
}

impl Ways {
    /// Finds the ways to the values of a range.
    pub(crate) fn fill(&mut self, range: &Range<'_>) {
        match (range.quantity, self) {
            (Quantity::Altitude, Self::Levels(levels)) => {
                let instantaneous = range.quantity.is_instantaneous(range.settings, false);
                levels.fill(range.settings, range.ownship, range.span, instantaneous);
            }
            (Quantity::Altitude, ways) => {
                *ways = Self::Levels(Levels::default());
                ways.fill(range);
            }
            (_, Self::Fan(fan)) => fan.fill(range),
            (_, ways) => {
                *ways = Self::default();
                ways.fill(range);
            }
        }
    }

    pub(crate) fn lines(&self) -> Lines<'_> {
        match self {
            Self::Fan(fan) => fan.lines(),
            Self::Levels(levels) => Lines {
                sides: [&levels.lines, &[]],
                step_s: 0.0,
            },
        }
    }
}

/// A search of either kind.
pub(super) enum Search<'a> {
    Fan(FanSearch<'a>),
    Level(LevelSearch<'a>),
}

impl Ways {
    /// A search along the ways, past the task's volume and its earlier one.
    pub(super) fn search<'a>(
        &'a self,
        later: &'a [Meeting<'a>; 2],
        before: Option<&'a [Meeting<'a>; 2]>,
    ) -> Search<'a> {
        match self {
            Self::Fan(fan) => Search::Fan(FanSearch {
                later,
                before,
                step_s: fan.step_s,
            }),
            Self::Levels(levels) => {
                let [later, _] = later;
                Search::Level(LevelSearch {
                    levels,
                    later,
                    before: before.map(|[before, _]| before),
                })
            }
        }
    }

    /// Two neighbouring values that lead past the volumes of all aircraft, which count from now on.
    pub(super) fn common_neighbors<'a>(
        &'a self,
        aircraft: &'a [([Meeting<'a>; 2], Task)],
        span: &Span,
    ) -> Option<(f64, f64)> {
        match self {
            Self::Fan(fan) => {
                let searches = aircraft.iter().map(|(later, task)| {
                    let search = FanSearch {
                        later,
                        before: None,
                        step_s: fan.step_s,
                    };
                    (search, *task)
                });
                FanSearch::common_neighbors(&searches.collect::<Vec<_>>(), span)
            }
            Self::Levels(levels) => {
                let searches = aircraft.iter().map(|([later, _], task)| {
                    let search = LevelSearch {
                        levels,
                        later,
                        before: None,
                    };
                    (search, *task)
                });
                LevelSearch::common_neighbors(&searches.collect::<Vec<_>>(), span)
            }
        }
    }
}

impl Search<'_> {
    pub(super) fn any_conflict(&self, task: &Task) -> bool {
        match self {
            Self::Fan(search) => search.any_conflict(task),
            Self::Level(search) => search.any_conflict(task),
        }
    }

    pub(super) fn is_blocked_at_once(&self, task: &Task) -> bool {
        match self {
            Self::Fan(search) => search.is_blocked_at_once(task),
            Self::Level(search) => search.is_blocked_at_once(task),
        }
    }

    pub(super) fn all_conflict(&self, task: &Task) -> bool {
        match self {
            Self::Fan(search) => search.all_conflict(task),
            Self::Level(search) => search.all_conflict(task),
        }
    }

    /// A part of what [`Search::free`] finds; `false` where that is nothing.
    pub(super) fn some_free(&self, task: &Task, span: &Span, free: &mut Intervals) -> bool {
        match self {
            Self::Fan(search) => search.some_free(task, span, free),
            Self::Level(search) => search.some_free(task, span, free),
        }
    }

    pub(super) fn free(&self, task: &Task, span: &Span, free: &mut Intervals) {
        match self {
            Self::Fan(search) => search.free(task, span, free),
            Self::Level(search) => search.free(task, span, free),
        }
    }
}
