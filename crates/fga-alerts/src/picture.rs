//! From what are alerts and bands computed?

use crate::aircraft::{Aircraft, Pair, PairDeviation};
use crate::loss::Loss;
use crate::quantity::Quantity;
use crate::settings::{AlertLevel, AlertSettings, Region, SlowDirections};
use alloc::vec::Vec;

/// An aircraft that contributes to the bands of a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Contribution {
    /// The aircraft's index in the traffic.
    pub(crate) intruder: usize,
    /// The level of its alerter, counted from 1.
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

/// The input of all bands: the aircraft of one time.
#[derive(Debug, Clone)]
pub(crate) struct Picture {
    pub(crate) settings: AlertSettings,
    pub(crate) time_s: f64,
    pub(crate) ownship: Aircraft,
    pub(crate) traffic: Vec<Aircraft>,
    /// The alerter of each aircraft.
    pub(crate) alerters: Vec<Option<usize>>,
    /// Aircraft in conflict, by region, nearest first.
    pub(crate) conflicts: [Vec<Contribution>; 3],
    /// Time interval with any aircraft in conflict, by region.
    pub(crate) times: [Loss; 3],
    pub(crate) terminal: Terminal,
    /// Whether the ownship is slower than its least airspeed.
    pub(crate) is_slow: bool,
}

impl Picture {
    /// The ownship and an aircraft of the traffic.
    pub(crate) fn pair(&self, intruder: usize) -> Option<Pair> {
        let aircraft = self.traffic.get(intruder)?;
        Some(Pair {
            ownship: self.ownship.state,
            intruder: aircraft.state,
            deviation: PairDeviation::of(&self.ownship.deviation, &aircraft.deviation),
        })
    }

    /// A level, counted from 1, of the alerter that judges an aircraft.
    pub(crate) fn level(&self, intruder: usize, level: usize) -> Option<&AlertLevel> {
        let alerter = self.alerters.get(intruder).copied().flatten()?;
        self.settings.alerters.get(alerter)?.level(level)
    }

    /// The level, counted from 1, by which an aircraft counts for a region.
    pub(crate) fn level_for(&self, intruder: usize, region: Region) -> Option<usize> {
        let alerter = self.alerters.get(intruder).copied().flatten()?;
        self.settings.alerters.get(alerter)?.level_for(region)
    }

    /// The violation of a level's volume by an aircraft.
    pub(crate) fn violation(&self, intruder: usize, level: usize) -> Option<Loss> {
        let pair = self.pair(intruder)?;
        let volume = &self.level(intruder, level)?.volume;
        Some(volume.violation(&pair, 0.0, self.settings.lookahead_s))
    }

    pub(crate) fn turns_at_once(&self) -> bool {
        self.is_slow && self.settings.slow_directions == SlowDirections::Instantaneous
    }

    /// The searched range below and above the value, if the terminal area limits it.
    pub(crate) fn around(&self, quantity: Quantity) -> Option<(f64, f64)> {
        let vertical = matches!(quantity, Quantity::VerticalSpeed | Quantity::Altitude);
        // No descent.
        (vertical && self.terminal == Terminal::Guided).then_some((0.0, -1.0))
    }

    /// Whether any alerter paints a region.
    pub(crate) fn paints(&self, region: Region) -> bool {
        let mut alerters = self.settings.alerters.iter();
        alerters.any(|alerter| alerter.level_for(region).is_some())
    }
}
