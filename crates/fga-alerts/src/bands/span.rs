//! The values of a quantity that a manoeuvre can reach.

use crate::aircraft::AircraftState;
use crate::almost::Closeness::Edge;
use crate::almost::wrapped;
use crate::picture::Picture;
use crate::quantity::Quantity;
use crate::settings::{AlertSettings, ValueRange};
use crate::units::GRAVITY_MPS2;
use core::f64::consts::{FRAC_PI_2, TAU};

/// Speed for the computation of turns: a standing aircraft turns nowhere.
pub(super) fn turning_speed_mps(settings: &AlertSettings, ownship: &AircraftState) -> f64 {
    let least_mps = settings.horizontal_speed.step;
    let least_mps = least_mps.max(settings.least_airspeed_mps);
    least_mps.max(ownship.speed_mps())
}

/// Whole numbers from one to another.
pub(super) fn counted(first: f64, last: f64) -> impl Iterator<Item = f64> {
    core::iter::successors(Some(first), |count| Some(count + 1.0))
        .take_while(move |count| *count <= last)
}

impl Quantity {
    /// Change of the quantity per second; 0 for a manoeuvre that takes no time.
    pub(super) fn rate(self, settings: &AlertSettings, ownship: &AircraftState) -> f64 {
        match self {
            Self::Direction if settings.turn_rate_radps == 0.0 && settings.bank_rad != 0.0 => {
                GRAVITY_MPS2 * libm::tan(settings.bank_rad.min(FRAC_PI_2))
                    / turning_speed_mps(settings, ownship)
            }
            Self::Direction => settings.turn_rate_radps,
            Self::HorizontalSpeed => settings.horizontal_acceleration_mps2,
            Self::Altitude if settings.vertical_rate_mps == 0.0 => 0.0,
            Self::VerticalSpeed | Self::Altitude => settings.vertical_acceleration_mps2,
        }
    }

    fn reach(self, settings: &AlertSettings) -> ValueRange {
        match self {
            Self::Direction => ValueRange {
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
    /// First and last value in reach; the first is the greater one if the reach crosses north.
    pub(crate) reach: (f64, f64),
    /// The same of the search, which goes around the circle if they are less than a quarter of a step apart.
    pub(crate) searched: (f64, f64),
    /// Length of a circular scale, else 0.
    pub(crate) modulus: f64,
    /// Distance between the searched values.
    pub(crate) step: f64,
    /// The value from which steps are counted: the current one, of altitudes the least.
    base: f64,
    /// Count of the first searched value, not above 0.
    pub(crate) first: f64,
    /// Count of the last searched value.
    pub(crate) last: f64,
    /// Whether a manoeuvre takes no time.
    pub(crate) at_once: bool,
}

/// Most steps to a side; a finer step only costs time.
const MOST_STEPS: f64 = 1e5;

impl BandSpan {
    /// The span around the ownship's value; `None` for a value outside of the scale.
    ///
    /// `around` overrides the searched range below and above the value.
    pub(crate) fn of(
        quantity: Quantity,
        picture: &Picture,
        around: Option<(f64, f64)>,
    ) -> Option<Self> {
        let (settings, ownship) = (&picture.settings, &picture.ownship.state);
        let value = quantity.of(ownship);
        let reach = quantity.reach(settings);
        let modulus = quantity.modulus();
        let (below, above) = around.unwrap_or((reach.below, reach.above));
        if reach.step <= 0.0 || !value.is_finite() {
            return None;
        }
        let bounds = (reach.least, reach.greatest);
        let (mut min, mut max) = bounds;
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
        let is_inside = if modulus > 0.0 {
            is_circular || min <= value || value <= max
        } else {
            min < max && (min..=max).contains(&value)
        };
        let steps = |searched: f64, to_end: f64| {
            let distance = if is_circular {
                modulus / 2.0
            } else if searched > 0.0 {
                searched
            } else {
                wrapped(to_end, modulus)
            };
            let count = libm::ceil(distance / reach.step).clamp(0.0, MOST_STEPS);
            let is_beyond = modulus > 0.0 && Edge.less(modulus / 2.0, count * reach.step);
            if is_beyond { count - 1.0 } else { count }
        };
        let (base, first, last) = if quantity == Quantity::Altitude {
            let steps = libm::floor((max - min) / reach.step).min(MOST_STEPS);
            (min, 0.0, steps + 1.0)
        } else {
            (value, -steps(below, value - min), steps(above, max - value))
        };
        let turns_at_once = quantity == Quantity::Direction && picture.turns_at_once();
        is_inside.then(|| Self {
            quantity,
            value,
            bounds,
            reach: (min, max),
            searched: if is_circular { bounds } else { (min, max) },
            modulus,
            step: reach.step,
            base,
            first,
            last,
            at_once: turns_at_once || quantity.rate(settings, ownship) == 0.0,
        })
    }

    /// The searched values in growing order; on a circular scale without a jump at north.
    pub(crate) fn values(&self) -> impl Iterator<Item = f64> {
        counted(self.first, self.last).map(|count| self.step * count + self.base)
    }
}
