//! The values of a quantity that a manoeuvre can reach.

use crate::aircraft::State;
use crate::almost::Closeness::Edge;
use crate::almost::wrapped;
use crate::bands::intervals::Intervals;
use crate::settings::{PerManeuver, Reach, Settings};
use core::f64::consts::TAU;

/// The quantity that a manoeuvre changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Direction of flight, radians clockwise from north.
    Direction,
    /// Horizontal speed, metres per second.
    HorizontalSpeed,
    /// Vertical speed, metres per second.
    VerticalSpeed,
    /// Altitude, metres.
    Altitude,
}

impl Quantity {
    /// All four, in the order of tables.
    pub const ALL: [Self; 4] = [
        Self::Direction,
        Self::HorizontalSpeed,
        Self::VerticalSpeed,
        Self::Altitude,
    ];

    /// The quantity's value of an aircraft.
    pub fn of(self, state: &State) -> f64 {
        match self {
            Self::Direction => state.direction_rad(),
            Self::HorizontalSpeed => state.speed_mps(),
            Self::VerticalSpeed => state.velocity_mps.z,
            Self::Altitude => state.position_m.z,
        }
    }

    pub(crate) const fn modulus(self) -> f64 {
        match self {
            Self::Direction => TAU,
            _ => 0.0,
        }
    }

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

impl<T: Copy> PerManeuver<T> {
    /// The value for a quantity.
    pub fn get(&self, quantity: Quantity) -> T {
        match quantity {
            Quantity::Direction => self.direction,
            Quantity::HorizontalSpeed => self.horizontal_speed,
            Quantity::VerticalSpeed => self.vertical_speed,
            Quantity::Altitude => self.altitude,
        }
    }
}

/// The values in reach from the current one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
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

impl Span {
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
        let mut whole = Intervals::default();
        if self.is_circular {
            whole.add(0.0, self.modulus);
        } else if self.modulus == 0.0 || self.min < self.max {
            whole.add(self.min, self.max);
        } else {
            whole.add(self.min, self.modulus);
            whole.add(0.0, self.max);
        }
        whole
    }

    /// Adds the searched values between two, on a circular scale around it.
    pub(crate) fn add_free(&self, free: &mut Intervals, low: f64, high: f64) {
        if Edge.same(low, high) {
            return;
        }
        if self.modulus == 0.0 {
            free.add(low.max(self.min), high.min(self.max));
            return;
        }
        let (low, high) = (wrapped(low, self.modulus), wrapped(high, self.modulus));
        let mut part = Intervals::default();
        if low < high {
            part.add(low, high);
        } else if !Edge.same(low, high) {
            part.add(0.0, high);
            part.add(low, self.modulus);
        }
        let whole = self.whole();
        if part.is_empty() {
            // Once around the circle.
            part = whole;
        } else if !self.is_circular && !whole.is_empty() {
            part.intersect(&whole);
        }
        free.unite(&part);
    }
}
