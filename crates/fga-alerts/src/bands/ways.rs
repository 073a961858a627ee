//! The ways to the values of a span.

use crate::aircraft::State;
use crate::bands::level::Levels;
use crate::bands::path::{Fan, Lines};
use crate::bands::span::{Quantity, Span};
use crate::settings::Settings;

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
    /// Finds the ways of a quantity; `slow` where turns take no time.
    pub(crate) fn fill(
        &mut self,
        quantity: Quantity,
        settings: &Settings,
        ownship: &State,
        span: &Span,
        slow: bool,
    ) {
        match (quantity, self) {
            (Quantity::Altitude, Self::Levels(levels)) => {
                let instantaneous = quantity.is_instantaneous(settings, false);
                levels.fill(settings, ownship, span, instantaneous);
            }
            (Quantity::Altitude, ways) => {
                *ways = Self::Levels(Levels::default());
                ways.fill(quantity, settings, ownship, span, slow);
            }
            (_, Self::Fan(fan)) => fan.fill(quantity, settings, ownship, span, slow),
            (_, ways) => {
                *ways = Self::default();
                ways.fill(quantity, settings, ownship, span, slow);
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
