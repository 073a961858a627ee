//! The lines on which the ownship flies to the values of a span, and which values it reaches without conflict.

use crate::aircraft::State;
use crate::bands::guard::Guard;
use crate::bands::intervals::Intervals;
use crate::bands::level::{LevelLeg, legs_to};
use crate::bands::path::{FlownLine, steps};
use crate::bands::span::{BandSpan, MOST_STEPS};
use crate::picture::Picture;
use crate::quantity::Quantity;
use alloc::vec;
use alloc::vec::Vec;
use core::iter::repeat_n;

/// The ways to the values of a span, in growing order.
pub(crate) enum Ways {
    /// The line after each step; the way there leads over all steps from the current value, each of the same time.
    Steps { lines: Vec<FlownLine>, step_s: f64 },
    /// The legs to each altitude.
    Altitudes(Vec<Vec<LevelLeg>>),
}

impl Ways {
    /// The ways from a state to the values of a span.
    pub(super) fn new(picture: &Picture, ownship: &State, span: &BandSpan) -> Self {
        let settings = &picture.settings;
        let at_once = span
            .quantity
            .is_instantaneous(settings, picture.turns_at_once());
        if span.quantity != Quantity::Altitude {
            let (lines, step_s) = steps(settings, ownship, span, at_once);
            return Self::Steps { lines, step_s };
        }
        let steps = libm::floor((span.max - span.min) / span.step).min(MOST_STEPS);
        let steps = (0..).map(f64::from).take_while(|step| *step <= steps + 1.0);
        let legs = steps.map(|step| {
            let target_m = span.min + step * span.step;
            if at_once {
                return vec![LevelLeg::at_once(target_m, ownship)];
            }
            legs_to(target_m, settings, ownship)
        });
        Self::Altitudes(legs.collect())
    }

    /// Whether each value is reached without conflict. `watched` says what counts besides the line after a step: of
    /// the way to the next step 1 for all of it and 0 for its begin, `None` for nothing.
    pub(super) fn free_values(
        &self,
        guard: &Guard,
        span: &BandSpan,
        watched: Option<f64>,
    ) -> Vec<bool> {
        let (lines, step_s, now) = match self {
            Self::Steps { lines, step_s } => (lines, *step_s, span.steps_down),
            Self::Altitudes(ways) => {
                // Altitudes beyond the horizon have the same legs.
                let alike = ways.chunk_by(|a, b| a == b);
                let free = alike.flat_map(|ways| {
                    let mut legs = ways.iter().take(1).flatten();
                    repeat_n(!legs.any(|leg| leg.is_blocked(guard)), ways.len())
                });
                return free.collect();
            }
        };
        let coast_s = watched.filter(|_| step_s > 0.0).map(|part| part * step_s);
        let stops = |line: &FlownLine| coast_s.is_some_and(|coast_s| guard.stops(line, coast_s));
        // From the current value to both sides, as far as nothing stops the manoeuvre.
        let from_now =
            |line: &FlownLine| (!stops(line)).then(|| !guard.blocks(line, f64::INFINITY));
        let (down, up) = (lines.get(..=now), lines.get(now..));
        let down = down.into_iter().flatten().rev().map_while(from_now);
        let up = up.into_iter().flatten().map_while(from_now);
        let mut free: Vec<bool> = down.collect();
        free.resize(now + 1, false);
        free.reverse();
        free.truncate(now);
        free.extend(up);
        free.resize(lines.len(), false);
        free
    }

    /// The values that are reached without conflict, where two neighbours are.
    pub(super) fn free(&self, guard: &Guard, span: &BandSpan) -> Intervals {
        let (base, first) = match self {
            Self::Steps { .. } => (span.value, -(span.steps_down as f64)),
            Self::Altitudes(_) => (span.min, 0.0),
        };
        let value = |index: usize| span.step * (first + index as f64) + base;
        let mut free = Intervals::default();
        let mut start = 0;
        for part in (self.free_values(guard, span, Some(1.0))).chunk_by(|a, b| a == b) {
            let end = start + part.len() - 1;
            if part.first() == Some(&true) && end > start {
                free.unite(&span.between(value(start), value(end)));
            }
            start = end + 1;
        }
        free
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
