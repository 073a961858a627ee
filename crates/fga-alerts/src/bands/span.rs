//! The values of a quantity that a manoeuvre can reach.

use crate::aircraft::State;
use crate::almost::Closeness::Edge;
use crate::almost::wrapped;
use crate::bands::intervals::Intervals;
use crate::quantity::Quantity;
use crate::settings::{Reach, Settings};
use core::f64::consts::TAU;

impl Quantity {
    /// Whether a manoeuvre of the quantity is instantaneous.
    pub(crate) fn is_instantaneous(self, settings: &Settings, slow: bool) -> bool {
        match self {
            Self::Direction => {
                slow || (settings.turn_rate_radps == 0.0 && settings.bank_rad == 0.0)
            }
            Self::HorizontalSpeed => settings.horizontal_acceleration_mps2 == 0.0,
            Self::VerticalSpeed => settings.vertical_acceleration_mps2 == 0.0,
            Self::Altitude => {
                settings.vertical_rate_mps == 0.0 || settings.vertical_acceleration_mps2 == 0.0
            }
        }
    }

    fn reach(self, settings: &Settings) -> Reach {
        match self {
            Self::Direction => Reach {
                least: 0.0,
                greatest: TAU,
                below: settings.left_rad,
                above: settings.right_rad,
                step: settings.direction_step_rad,
            },
            Self::HorizontalSpeed => settings.horizontal_speed,
            Self::VerticalSpeed => settings.vertical_speed,
            Self::Altitude => settings.altitude,
        }
    }
}

/// The values in reach from the current one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BandSpan {
    pub(crate) quantity: Quantity,
    /// The current value.
    pub(crate) value: f64,
    /// The whole scale.
    pub(crate) bounds: (f64, f64),
    /// Least searched value.
    pub(crate) min: f64,
    /// Greatest searched value; below `min` if the span crosses north.
    pub(crate) max: f64,
    /// Length of a circular scale, else 0.
    pub(crate) modulus: f64,
    /// Whether the span has every direction.
    pub(crate) is_circular: bool,
    /// Distance between the searched values.
    pub(crate) step: f64,
    /// Steps down (left).
    pub(crate) steps_down: usize,
    /// Steps up (right).
    pub(crate) steps_up: usize,
}

/// Most steps; a finer step only costs time.
pub(super) const MOST_STEPS: f64 = 1e5;

impl BandSpan {
    /// The span around an aircraft's value; `None` for a value outside of the scale.
    ///
    /// `around` overrides the searched range below and above the value.
    pub(crate) fn of(
        quantity: Quantity,
        settings: &Settings,
        ownship: &State,
        around: Option<(f64, f64)>,
    ) -> Option<Self> {
        let value = quantity.of(ownship);
        let reach = quantity.reach(settings);
        let modulus = quantity.modulus();
        let (below, above) = around
            .filter(|around| *around != (0.0, 0.0))
            .unwrap_or((reach.below, reach.above));
        if reach.step <= 0.0 || !value.is_finite() {
            return None;
        }
        let (mut min, mut max) = (reach.least, reach.greatest);
        if (below, above) != (0.0, 0.0) {
            if below >= 0.0 {
                min = wrapped(value - below, modulus);
            }
            if above >= 0.0 {
                max = wrapped(value + above, modulus);
            }
            if modulus == 0.0 {
                min = min.max(reach.least);
                max = max.min(reach.greatest);
            }
        }
        let is_circular = modulus > 0.0 && (min - max).abs() < reach.step * 0.25;
        let inside = (min <= value && value <= max && min != max)
            || (modulus > 0.0
                && (is_circular
                    || (0.0..=max).contains(&value)
                    || (min..=modulus).contains(&value)));
        let steps = |searched: f64, to_end: f64| {
            let distance = if is_circular {
                modulus / 2.0
            } else if searched > 0.0 {
                searched
            } else {
                wrapped(to_end, modulus)
            };
            let mut count = libm::ceil(distance / reach.step).clamp(0.0, MOST_STEPS);
            let passed = count * reach.step;
            if modulus > 0.0 && Edge.less(modulus / 2.0, passed) {
                count -= 1.0;
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "casts of floats saturate, and there are at most 100,000"
            )]
            let count = count as usize;
            count
        };
        inside.then(|| Self {
            quantity,
            value,
            bounds: (reach.least, reach.greatest),
            min,
            max,
            modulus,
            is_circular,
            step: reach.step,
            steps_down: steps(below, value - min),
            steps_up: steps(above, max - value),
        })
    }

    /// The whole searched range.
    pub(crate) fn whole(&self) -> Intervals {
        if self.is_circular {
            Intervals::around(0.0, self.modulus, self.modulus)
        } else {
            Intervals::around(self.min, self.max, self.modulus)
        }
    }

    /// The searched values between two, on a circular scale around it.
    pub(crate) fn between(&self, low: f64, high: f64) -> Intervals {
        if Edge.same(low, high) {
            return Intervals::default();
        }
        let mut between = self.whole();
        let (low, high) = (wrapped(low, self.modulus), wrapped(high, self.modulus));
        // The same value twice is once around the circle.
        if !Edge.same(low, high) {
            between.intersect(&Intervals::around(low, high, self.modulus));
        }
        between
    }
}
