//! What all bands are computed from.

use crate::aircraft::{Aircraft, PairDeviation};
use crate::bands::meeting::Met;
use crate::bands::span::Quantity;
use crate::loss::Loss;
use crate::settings::{Region, Settings};
use alloc::vec::Vec;

/// An aircraft that contributes to the bands of a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Contribution {
    /// The aircraft's index in the traffic.
    pub(crate) intruder: usize,
    /// The alerter, counted from 0.
    pub(crate) alerter: usize,
    /// The level, counted from 1.
    pub(crate) level: usize,
    /// Horizon, seconds.
    pub(crate) horizon_s: f64,
}

/// The state of the terminal area.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Terminal {
    #[default]
    Outside,
    Inside,
    /// Inside, with the special guidance on.
    Guided,
}

/// The input of all bands.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Picture<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) time_s: f64,
    pub(crate) ownship: &'a Aircraft,
    pub(crate) traffic: &'a [Aircraft],
    /// The alerter of each aircraft.
    pub(crate) alerters: &'a [Option<usize>],
    /// Aircraft in conflict, by region, nearest first.
    pub(crate) conflicts: &'a [Vec<Contribution>; 3],
    /// Time interval with any aircraft in conflict, by region.
    pub(crate) times: &'a [Loss; 3],
    pub(crate) terminal: Terminal,
    /// Whether the ownship is slower than its least airspeed.
    pub(crate) is_slow: bool,
}

impl<'a> Picture<'a> {
    pub(crate) fn met(&self, intruder: usize) -> Option<Met<'a>> {
        let aircraft = self.traffic.get(intruder)?;
        Some(Met {
            settings: self.settings,
            intruder: aircraft.state,
            deviation: PairDeviation::of(&self.ownship.deviation, &aircraft.deviation),
        })
    }

    pub(crate) fn turns_at_once(&self) -> bool {
        self.is_slow
            && self.settings.slow_directions == crate::settings::SlowDirections::Instantaneous
    }

    /// The searched range below and above the value, if the terminal area limits it.
    pub(super) fn around(&self, quantity: Quantity) -> Option<(f64, f64)> {
        let vertical = matches!(quantity, Quantity::VerticalSpeed | Quantity::Altitude);
        // No descent.
        (vertical && self.terminal == Terminal::Guided).then_some((0.0, -1.0))
    }

    /// Whether any alerter paints a region.
    pub(super) fn paints(&self, region: Region) -> bool {
        self.settings
            .alerters
            .iter()
            .any(|alerter| alerter.level_for(region).is_some())
    }
}
