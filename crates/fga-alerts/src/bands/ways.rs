//! The lines on which the ownship flies to the values of a span, and which values it reaches without conflict.

use crate::aircraft::State;
use crate::bands::intervals::Intervals;
use crate::bands::level::LevelChange;
use crate::bands::meeting::{Guard, Meeting, Met};
use crate::bands::path::{Line, steps};
use crate::bands::picture::Picture;
use crate::bands::span::{Quantity, Span};
use crate::volume::Volume;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

/// The ways to the values of a span.
pub(crate) struct Ways {
    legs: Vec<Leg>,
    kind: Kind,
}

/// A line on a way.
struct Leg {
    line: Line,
    /// Until when the ownship flies it, seconds; `None` for a moment.
    until_s: Option<f64>,
}

/// How legs make ways.
enum Kind {
    /// Each leg ends one step's way, which leads over all steps between it and the current value.
    Steps { now: usize, step_s: f64 },
    /// The legs of each altitude, and whether the current one is among those searched.
    Altitudes {
        ways: Vec<Range<usize>>,
        is_inside: bool,
    },
}

/// What counts on the way to a step, besides the line after it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Between {
    /// The whole way.
    Way,
    /// The begin of each step.
    Steps,
    Nothing,
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "casts of floats saturate, and more steps than i32 holds are never asked for"
)]
const fn int(value: f64) -> i32 {
    value as i32
}

impl Ways {
    /// The ways from a state to the values of a span.
    pub(super) fn new(picture: &Picture, ownship: &State, span: &Span) -> Self {
        let settings = &picture.settings;
        let at_once = span
            .quantity
            .is_instantaneous(settings, picture.turns_at_once());
        if span.quantity != Quantity::Altitude {
            let (lines, step_s) = steps(settings, ownship, span, at_once);
            let until_s = Some(f64::INFINITY);
            let legs = lines
                .into_iter()
                .map(|line| Leg { line, until_s })
                .collect();
            let now = span.steps_down;
            return Self {
                legs,
                kind: Kind::Steps { now, step_s },
            };
        }
        let (mut legs, mut ways) = (Vec::new(), Vec::<Range<usize>>::new());
        let mut last = None;
        for step in 0..=int(libm::floor((span.max - span.min) / span.step)) + 1 {
            let target_m = span.min + f64::from(step) * span.step;
            let change = LevelChange::to(target_m, settings, ownship);
            let from = legs.len();
            let mut take = |line, until_s| legs.push(Leg { line, until_s });
            let is_known = |last| change.is_flown_as(&last, settings.lookahead_s);
            let way = if at_once {
                take(
                    LevelChange::instantly(target_m, ownship),
                    Some(f64::INFINITY),
                );
                None
            } else if last.is_some_and(is_known) {
                // Altitudes beyond the horizon are flown to alike.
                ways.last().cloned()
            } else {
                change.fly(settings.lookahead_s, take);
                None
            };
            ways.push(way.unwrap_or(from..legs.len()));
            last = Some(change);
        }
        let height_m = ownship.position_m.z;
        let is_inside = height_m >= span.min && height_m <= span.max;
        Self {
            legs,
            kind: Kind::Altitudes { ways, is_inside },
        }
    }

    /// A volume of an intruder on all lines.
    pub(super) fn meeting<'a>(&self, met: &Met<'a>, volume: &'a Volume) -> Meeting<'a> {
        Meeting::new(met, volume, self.legs.iter().map(|leg| &leg.line))
    }

    /// Whether each value, in growing order, is reached without conflict.
    fn free_values(&self, guard: &Guard, between: Between) -> Vec<bool> {
        let (now, step_s) = match &self.kind {
            Kind::Steps { now, step_s } => (*now, *step_s),
            Kind::Altitudes { ways, .. } => {
                let is_free = |way: &Range<usize>| {
                    let mut legs = way
                        .clone()
                        .zip(self.legs.get(way.clone()).unwrap_or_default());
                    legs.all(|(index, leg)| !meets(guard, index, leg))
                };
                let alike = ways.chunk_by(|a, b| a == b);
                let free = alike.flat_map(|ways| {
                    core::iter::repeat_n(ways.first().is_some_and(is_free), ways.len())
                });
                return free.collect();
            }
        };
        let watches = step_s > 0.0 && between != Between::Nothing;
        let coast_s = if between == Between::Way { step_s } else { 0.0 };
        let mut free = vec![false; self.legs.len()];
        // From the current value to both sides, as far as nothing stops the manoeuvre.
        for side in [-1, 1] {
            for steps in 0.. {
                let index = now.checked_add_signed(side * steps);
                let Some((index, leg)) =
                    index.and_then(|index| Some((index, self.legs.get(index)?)))
                else {
                    break;
                };
                let order = (steps as f64).partial_cmp(&(guard.change_s / step_s));
                if watches && guard.stops(index, &leg.line, order, coast_s) {
                    break;
                }
                if let Some(free) = free.get_mut(index) {
                    *free = !guard.blocks(index, &leg.line, f64::INFINITY);
                }
            }
        }
        free
    }

    /// The values that are reached without conflict, where two neighbours are.
    pub(super) fn free(&self, guard: &Guard, span: &Span) -> Intervals {
        let (base, first) = match self.kind {
            Kind::Steps { now, .. } => (span.value, -(now as f64)),
            Kind::Altitudes { .. } => (span.min, 0.0),
        };
        let values = self.free_values(guard, Between::Way);
        let mut free = Intervals::default();
        let mut start = 0;
        for part in values.chunk_by(|a, b| a == b) {
            let end = start + part.len() - 1;
            if part.first() == Some(&true) && end > start {
                let value = |index: usize| span.step * (first + index as f64) + base;
                span.add_free(&mut free, value(start), value(end));
            }
            start = end + 1;
        }
        free
    }

    /// Whether a manoeuvre to any value leads into a volume, or on the way beyond it.
    pub(super) fn any_conflict(&self, guard: &Guard) -> bool {
        self.free_values(guard, Between::Nothing).contains(&false)
    }

    /// Whether no manoeuvre leads past a volume: none does from an altitude that is not searched.
    pub(super) fn all_conflict(&self, guard: &Guard) -> bool {
        matches!(
            self.kind,
            Kind::Altitudes {
                is_inside: false,
                ..
            }
        ) || !self.free_values(guard, Between::Steps).contains(&true)
    }
}

/// Whether the ownship meets a volume on a leg to an altitude.
fn meets(guard: &Guard, index: usize, leg: &Leg) -> bool {
    let line = &leg.line;
    match leg.until_s {
        None => guard.stops(index, line, line.since_s.partial_cmp(&guard.change_s), 0.0),
        Some(until_s) => guard.blocks(index, line, until_s),
    }
}
