//! The lines on which the ownship flies to the values of a span, and which values it reaches without conflict.

use crate::aircraft::State;
use crate::bands::intervals::Intervals;
use crate::bands::level::LevelChange;
use crate::bands::meeting::{Guard, Meeting, Met};
use crate::bands::path::{Line, steps};
use crate::bands::picture::Picture;
use crate::bands::span::{MOST_STEPS, Quantity, Span};
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
    /// The legs of each altitude.
    Altitudes(Vec<Range<usize>>),
}

#[expect(clippy::cast_possible_truncation, reason = "between 0 and 100,000")]
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
            let legs = lines.into_iter().map(|line| Leg { line, until_s });
            let (legs, now) = (legs.collect(), span.steps_down);
            let kind = Kind::Steps { now, step_s };
            return Self { legs, kind };
        }
        let (mut legs, mut ways) = (Vec::new(), Vec::<Range<usize>>::new());
        let mut last = None;
        let steps = libm::floor((span.max - span.min) / span.step);
        for step in 0..=int(steps.min(MOST_STEPS)) + 1 {
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
        let kind = Kind::Altitudes(ways);
        Self { legs, kind }
    }

    /// A volume of an intruder on all lines.
    pub(super) fn meeting<'a>(&self, met: &Met<'a>, volume: &'a Volume) -> Meeting<'a> {
        Meeting::new(met, volume, self.legs.iter().map(|leg| &leg.line))
    }

    /// Whether each value, in growing order, is reached without conflict. `watched` says what counts besides the line
    /// after a step: of the way to the next step 1 for all of it and 0 for its begin, `None` for nothing.
    fn free_values(&self, guard: &Guard, watched: Option<f64>) -> Vec<bool> {
        match &self.kind {
            Kind::Altitudes(ways) => {
                let alike = ways.chunk_by(|a, b| a == b);
                let free = alike.flat_map(|ways| {
                    let is_free = ways.first().is_some_and(|way| self.leads_past(way, guard));
                    core::iter::repeat_n(is_free, ways.len())
                });
                free.collect()
            }
            Kind::Steps { now, step_s } => {
                let coast_s = watched.filter(|_| *step_s > 0.0).map(|part| part * step_s);
                let mut free = vec![false; self.legs.len()];
                // From the current value to both sides, as far as nothing stops the manoeuvre.
                for side in [-1, 1] {
                    for steps in 0.. {
                        let order = (steps as f64).partial_cmp(&(guard.change_s / step_s));
                        let index = now.wrapping_add_signed(side * steps);
                        let (Some(Leg { line, .. }), Some(free)) =
                            (self.legs.get(index), free.get_mut(index))
                        else {
                            break;
                        };
                        if coast_s.is_some_and(|coast_s| guard.stops(index, line, order, coast_s)) {
                            break;
                        }
                        *free = !guard.blocks(index, line, f64::INFINITY);
                    }
                }
                free
            }
        }
    }

    /// Whether the ownship meets nothing on the legs to an altitude.
    fn leads_past(&self, way: &Range<usize>, guard: &Guard) -> bool {
        let legs = self.legs.get(way.clone()).unwrap_or_default();
        way.clone()
            .zip(legs)
            .all(|(index, Leg { line, until_s })| match until_s {
                None => !guard.stops(index, line, line.since_s.partial_cmp(&guard.change_s), 0.0),
                Some(until_s) => !guard.blocks(index, line, *until_s),
            })
    }

    /// The values that are reached without conflict, where two neighbours are.
    pub(super) fn free(&self, guard: &Guard, span: &Span) -> Intervals {
        let (base, first) = match self.kind {
            Kind::Steps { now, .. } => (span.value, -(now as f64)),
            Kind::Altitudes(_) => (span.min, 0.0),
        };
        let values = self.free_values(guard, Some(1.0));
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
        self.free_values(guard, None).contains(&false)
    }

    /// Whether no manoeuvre leads past a volume.
    pub(super) fn all_conflict(&self, guard: &Guard) -> bool {
        !self.free_values(guard, Some(0.0)).contains(&true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aircraft::{Aircraft, AircraftId};
    use crate::monitor::Monitor;
    use crate::schemes::f3442;

    #[test]
    fn altitude_steps_of_a_micrometre_are_searched_as_far_as_there_is_room() {
        let mut settings = f3442();
        settings.altitude.step = 1e-6;
        let mut monitor = Monitor::new(settings);
        let at = |id, height_m| {
            let mut state = State::default();
            state.position_m.z = height_m;
            Aircraft::new(AircraftId(id), state)
        };
        monitor.step(0.0, &at(0, 500.0), &[at(1, 510.0)]).unwrap();
        assert!(!monitor.bands(Quantity::Altitude).bands().is_empty());
    }
}
