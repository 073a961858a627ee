//! The lines on which the ownship flies to the values of a span, and which values it reaches without conflict.

use crate::aircraft::AircraftState;
use crate::bands::guard::Guard;
use crate::bands::level::{LevelLeg, legs_to};
use crate::bands::path::{FlownLine, steps};
use crate::bands::span::BandSpan;
use crate::quantity::Quantity;
use crate::settings::AlertSettings;
use alloc::vec::Vec;
use core::iter::repeat_n;

/// The ways to the values of a span.
pub(crate) enum Ways {
    /// The line after each step from the current value, down and up; the way there leads over all steps before, each
    /// of the same time.
    Steps {
        sides: [Vec<FlownLine>; 2],
        step_s: f64,
    },
    /// The legs to each altitude, in growing order.
    Altitudes(Vec<Vec<LevelLeg>>),
}

impl Ways {
    /// The ways from a state to the values of a span.
    pub(super) fn new(settings: &AlertSettings, ownship: &AircraftState, span: &BandSpan) -> Self {
        if span.quantity == Quantity::Altitude {
            let legs = |target_m| legs_to(target_m, settings, ownship, span.at_once);
            return Self::Altitudes(span.values().map(legs).collect());
        }
        let (sides, step_s) = steps(settings, ownship, span);
        Self::Steps { sides, step_s }
    }

    /// Whether each value is reached without conflict, in growing order. `watched` says what counts besides the line
    /// after a step: of the way to the next step 1 for all of it and 0 for its begin, `None` for nothing.
    pub(super) fn free_values(&self, guard: &Guard, watched: Option<f64>) -> Vec<bool> {
        let (sides, step_s) = match self {
            Self::Steps { sides, step_s } => (sides, *step_s),
            Self::Altitudes(ways) => {
                let is_blocked = |(line, until_s): &LevelLeg| match until_s {
                    None => guard.stops(line, 0.0),
                    Some(until_s) => guard.blocks(line, *until_s),
                };
                // Altitudes beyond the horizon have the same legs.
                let alike = ways.chunk_by(|a, b| a == b);
                let free = alike.flat_map(|ways| {
                    let mut legs = ways.iter().take(1).flatten();
                    repeat_n(!legs.any(is_blocked), ways.len())
                });
                return free.collect();
            }
        };
        let coast_s = watched.filter(|_| step_s > 0.0).map(|part| part * step_s);
        let stops = |line: &FlownLine| coast_s.is_some_and(|coast_s| guard.stops(line, coast_s));
        // As far as nothing stops the manoeuvre.
        let reach = |line: &FlownLine| (!stops(line)).then(|| !guard.blocks(line, f64::INFINITY));
        let [down, up] = sides.each_ref().map(|lines| {
            let mut free: Vec<bool> = lines.iter().map_while(reach).collect();
            free.resize(lines.len(), false);
            free
        });
        // Both sides begin with the current value.
        down.into_iter().skip(1).rev().chain(up).collect()
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
            let mut state = AircraftState::default();
            state.position_m.z = height_m;
            Aircraft::new(AircraftId(id), state)
        };
        monitor.step(0.0, &at(0, 500.0), &[at(1, 510.0)]).unwrap();
        assert!(!monitor.bands(Quantity::Altitude).bands().is_empty());
    }
}
