//! Alert levels and bands over time.

mod input;

use crate::aircraft::{Aircraft, AircraftId, Pair, State};
use crate::almost::Closeness::Rounding;
use crate::bands::meeting::Met;
use crate::bands::span::Quantity;
use crate::bands::{Contribution, Picture, QuantityBands, Terminal, meets_within_spread};
use crate::hysteresis::{Held, HysteresisSettings};
use crate::loss::Loss;
use crate::settings::{AlertLevel, Region, Settings, TerminalGuidance};
use alloc::vec::Vec;
use input::{check, pair_of};

pub use input::StepError;

/// The alert about one aircraft.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Alert {
    /// The aircraft.
    pub id: AircraftId,
    /// The alerter that judges it, counted from 0; `None` for none.
    pub alerter: Option<usize>,
    /// The level, 0 for no alert; `None` without an alerter.
    pub level: Option<usize>,
}

/// Future states of the aircraft, which the caller knows or assumes.
pub trait Ahead {
    /// The ownship's state after a time, seconds, in the frame of the step.
    fn ownship(&self, after_s: f64) -> State;
    /// An aircraft's state after a time, by its index in the traffic.
    fn intruder(&self, index: usize, after_s: f64) -> State;
}

/// The time at which a maneuver must begin to stay out of the corrective volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LastTime {
    /// No conflict is predicted.
    NoConflict,
    /// No manoeuvre stays out of the volume any more.
    Passed,
    /// Seconds from now.
    In(f64),
}

/// Alert levels and bands over time.
#[derive(Debug, Clone)]
pub struct Monitor {
    settings: Settings,
    time_s: f64,
    ownship: Option<Aircraft>,
    traffic: Vec<Aircraft>,
    alert_memory: Vec<(AircraftId, Held)>,
    terminal_memory: Vec<(AircraftId, Held)>,
    slow_memory: Held,
    alerters: Vec<Option<usize>>,
    alerts: Vec<Alert>,
    conflicts: [Vec<Contribution>; 3],
    times: [Loss; 3],
    terminal: Terminal,
    is_slow: bool,
    bands: [QuantityBands; 4],
}

/// Adds a raw level to the memory of an aircraft, new or known; returns the level that holds.
fn remember(
    memories: &mut Vec<(AircraftId, Held)>,
    id: AircraftId,
    raw: i8,
    time_s: f64,
    settings: &HysteresisSettings,
) -> i8 {
    if let Some((_, held)) = memories.iter_mut().find(|(known, _)| *known == id) {
        return held.take(raw, time_s, settings);
    }
    let mut held = Held::default();
    let level = held.take(raw, time_s, settings);
    memories.push((id, held));
    level
}

impl Monitor {
    /// A monitor without memory.
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            time_s: 0.0,
            ownship: None,
            traffic: Vec::new(),
            alert_memory: Vec::new(),
            terminal_memory: Vec::new(),
            slow_memory: Held::default(),
            alerters: Vec::new(),
            alerts: Vec::new(),
            conflicts: Default::default(),
            times: [Loss::NEVER; 3],
            terminal: Terminal::Outside,
            is_slow: false,
            bands: Quantity::ALL.map(QuantityBands::new),
        }
    }

    /// The settings.
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Takes the aircraft of one time; afterwards alerts and bands describe this time.
    ///
    /// States are in one local frame, velocities through the air. A time that goes back, another
    /// ownship or a gap longer than the settings' memory restarts the monitor.
    ///
    /// # Errors
    /// A number that is not finite, or an id that appears twice.
    pub fn step(
        &mut self,
        time_s: f64,
        ownship: &Aircraft,
        traffic: &[Aircraft],
    ) -> Result<(), StepError> {
        self.find_levels(time_s, ownship, traffic)?;
        self.find_conflicts(ownship);
        self.watch_terminal();
        let mut bands = core::mem::replace(&mut self.bands, Quantity::ALL.map(QuantityBands::new));
        if let Some(picture) = self.picture() {
            for quantity in &mut bands {
                quantity.update(&picture);
            }
        }
        self.bands = bands;
        Ok(())
    }

    /// Takes the aircraft of one time only for the alert levels; afterwards there are no bands.
    ///
    /// # Errors
    /// As [`Monitor::step`].
    pub fn step_levels(
        &mut self,
        time_s: f64,
        ownship: &Aircraft,
        traffic: &[Aircraft],
    ) -> Result<(), StepError> {
        self.find_levels(time_s, ownship, traffic)?;
        self.bands = Quantity::ALL.map(QuantityBands::new);
        Ok(())
    }

    /// Finds the levels of this time.
    fn find_levels(
        &mut self,
        time_s: f64,
        ownship: &Aircraft,
        traffic: &[Aircraft],
    ) -> Result<(), StepError> {
        check(time_s, ownship, traffic)?;
        let goes_on = self.ownship.is_some_and(|before| {
            before.id == ownship.id
                && time_s >= self.time_s
                && time_s - self.time_s <= self.settings.hysteresis.memory_s
        });
        if !goes_on {
            self.forget();
        }
        self.time_s = time_s;
        self.ownship = Some(*ownship);
        self.traffic.clear();
        self.traffic.extend_from_slice(traffic);
        self.choose_alerters(ownship);
        self.slow(ownship);
        self.alert(ownship);
        Ok(())
    }

    /// Forgets everything.
    fn forget(&mut self) {
        self.alert_memory.clear();
        self.terminal_memory.clear();
        self.slow_memory = Held::default();
        for quantity in &mut self.bands {
            quantity.forget();
        }
    }

    fn picture(&self) -> Option<Picture<'_>> {
        Some(Picture {
            settings: &self.settings,
            time_s: self.time_s,
            ownship: self.ownship.as_ref()?,
            traffic: &self.traffic,
            alerters: &self.alerters,
            conflicts: &self.conflicts,
            times: &self.times,
            terminal: self.terminal,
            is_slow: self.is_slow,
        })
    }

    /// Whether an aircraft is in the terminal area, with memory.
    fn is_in_terminal(&mut self, aircraft: &Aircraft) -> bool {
        let area = &self.settings.terminal;
        let on = area.guidance != TerminalGuidance::Off
            && area.alerter.is_some()
            && area.radius_m > 0.0
            && area.height_m > 0.0;
        if !on {
            return false;
        }
        let inside = aircraft
            .terminal_distance_m
            .is_some_and(|distance_m| Rounding.at_most(distance_m, area.radius_m))
            && Rounding.at_most(aircraft.state.position_m.z, area.height_m);
        let (time_s, hysteresis) = (self.time_s, self.settings.hysteresis);
        let memories = &mut self.terminal_memory;
        remember(memories, aircraft.id, i8::from(inside), time_s, &hysteresis) == 1
    }

    /// Chooses the alerter that judges each aircraft.
    fn choose_alerters(&mut self, ownship: &Aircraft) {
        let count = self.settings.alerters.len();
        let known = |alerter: Option<usize>| alerter.filter(|index| *index < count);
        let terminal = known(self.settings.terminal.alerter);
        self.alerters.clear();
        if self.settings.ownship_centric {
            let inside = self.is_in_terminal(ownship);
            let alerter = if inside {
                terminal
            } else {
                known(ownship.alerter)
            };
            self.alerters.resize(self.traffic.len(), alerter);
            return;
        }
        for index in 0..self.traffic.len() {
            let Some(aircraft) = self.traffic.get(index).copied() else {
                continue;
            };
            let inside = self.is_in_terminal(&aircraft);
            self.alerters.push(if inside {
                terminal
            } else {
                known(aircraft.alerter)
            });
        }
    }

    fn slow(&mut self, ownship: &Aircraft) {
        let raw = i8::from(ownship.state.speed_mps() < self.settings.least_airspeed_mps);
        let hysteresis = self.settings.hysteresis;
        self.is_slow = self.slow_memory.take(raw, self.time_s, &hysteresis) > 0;
    }

    /// Finds the alert level of every aircraft.
    fn alert(&mut self, ownship: &Aircraft) {
        self.alerts.clear();
        // Manoeuvres within a spread count as outside of the terminal area.
        self.terminal = Terminal::Outside;
        for index in 0..self.traffic.len() {
            let Some(aircraft) = self.traffic.get(index).copied() else {
                continue;
            };
            let alerter = self.alerters.get(index).copied().flatten();
            let level = alerter.map(|alerter| {
                let raw = self.raw_level(ownship, index, &aircraft, alerter);
                let hysteresis = self.settings.hysteresis;
                let time_s = self.time_s;
                remember(
                    &mut self.alert_memory,
                    aircraft.id,
                    raw,
                    time_s,
                    &hysteresis,
                )
            });
            self.alerts.push(Alert {
                id: aircraft.id,
                alerter,
                level: level.and_then(|level| usize::try_from(level).ok()),
            });
        }
    }

    fn raw_level(
        &self,
        ownship: &Aircraft,
        index: usize,
        aircraft: &Aircraft,
        alerter: usize,
    ) -> i8 {
        let before = self
            .alert_memory
            .iter()
            .find(|(id, _)| *id == aircraft.id)
            .and_then(|(_, held)| held.last())
            .filter(|(last_s, _)| *last_s < self.time_s);
        let Some(alerter) = self.settings.alerters.get(alerter) else {
            return 0;
        };
        let pair = pair_of(ownship, aircraft);
        (1_i8..)
            .zip(&alerter.levels)
            .filter(|(number, level)| {
                let is_on = before.is_some_and(|(_, last)| last == *number);
                self.is_alerted(&pair, index, level, is_on)
            })
            .map(|(number, _)| number)
            .last()
            .unwrap_or(0)
    }

    fn is_alerted(&self, pair: &Pair, index: usize, level: &AlertLevel, is_on: bool) -> bool {
        let time_s = if is_on {
            level.early_alerting_s
        } else {
            level.alerting_s
        };
        let loss = level.volume.violation(pair, 0.0, self.settings.lookahead_s);
        if loss.begins_before(time_s) {
            return true;
        }
        Quantity::ALL.into_iter().any(|quantity| {
            let spread = level.spread.get(quantity);
            if spread <= 0.0 {
                return false;
            }
            let Some(picture) = self.picture() else {
                return false;
            };
            picture.met(index).is_some_and(|met| {
                meets_within_spread(&picture, quantity, spread, &met, &level.volume, time_s)
            })
        })
    }

    /// Finds the aircraft in conflict, region by region.
    fn find_conflicts(&mut self, ownship: &Aircraft) {
        let lookahead_s = self.settings.lookahead_s;
        for (place, region) in Region::CONFLICTS.into_iter().enumerate() {
            let (Some(list), Some(times)) =
                (self.conflicts.get_mut(place), self.times.get_mut(place))
            else {
                continue;
            };
            list.clear();
            *times = Loss::NEVER;
            for (intruder, (aircraft, alerter)) in
                self.traffic.iter().zip(&self.alerters).enumerate()
            {
                let found = alerter.and_then(|index| {
                    let alerter = self.settings.alerters.get(index)?;
                    let number = alerter.level_for(region)?;
                    Some((index, number, alerter.level(number)?))
                });
                let Some((alerter, number, level)) = found else {
                    continue;
                };
                let held = self
                    .alert_memory
                    .iter()
                    .find(|(id, _)| *id == aircraft.id)
                    .map(|(_, held)| held);
                let stays_on = held.is_some_and(|held| {
                    held.rose_s().is_some_and(|rose_s| rose_s < self.time_s)
                        && held
                            .last()
                            .is_some_and(|(_, last)| usize::try_from(last) == Ok(number))
                });
                let time_s = if stays_on {
                    level.early_alerting_s
                } else {
                    level.alerting_s
                };
                let loss = level
                    .volume
                    .violation(&pair_of(ownship, aircraft), 0.0, lookahead_s);
                if !loss.is_conflict() {
                    continue;
                }
                if loss.begins_before(time_s) {
                    list.push(Contribution {
                        intruder,
                        alerter,
                        level: number,
                        horizon_s: lookahead_s,
                    });
                }
                times.entry_s = times.entry_s.min(loss.entry_s);
                times.exit_s = times.exit_s.max(loss.exit_s);
            }
        }
    }

    /// Updates the state of the terminal area.
    fn watch_terminal(&mut self) {
        let area = &self.settings.terminal;
        self.terminal = Terminal::Outside;
        let (TerminalGuidance::Departing | TerminalGuidance::Landing, Some(alerter)) =
            (area.guidance, area.alerter)
        else {
            return;
        };
        if !self.alerters.contains(&Some(alerter)) {
            return;
        }
        // Special guidance begins with a conflict above the corrective region.
        let corrective = self
            .settings
            .corrective_region
            .conflict_index()
            .unwrap_or(0);
        let above = self.conflicts.iter().take(corrective);
        self.terminal = if above.into_iter().any(|list| !list.is_empty()) {
            Terminal::Guided
        } else {
            Terminal::Inside
        };
    }

    /// The alert about each aircraft, in the order of the traffic.
    pub fn alerts(&self) -> &[Alert] {
        &self.alerts
    }

    /// The highest level of any aircraft.
    pub fn highest_level(&self) -> usize {
        self.alerts
            .iter()
            .filter_map(|alert| alert.level)
            .max()
            .unwrap_or(0)
    }

    /// Whether an aircraft of the traffic, or the ownship, is in the terminal area and whether its
    /// guidance is on.
    pub fn terminal(&self) -> (bool, bool) {
        (
            self.terminal != Terminal::Outside,
            self.terminal == Terminal::Guided,
        )
    }

    /// Aircraft (indices in the traffic) whose predicted violation alerts in a region.
    pub fn conflicts(&self, region: Region) -> impl Iterator<Item = usize> + '_ {
        region
            .conflict_index()
            .and_then(|index| self.conflicts.get(index))
            .into_iter()
            .flatten()
            .map(|contribution| contribution.intruder)
    }

    /// From the first entry into a region's volume to the last exit, over all aircraft.
    pub fn conflict_times(&self, region: Region) -> Loss {
        region
            .conflict_index()
            .and_then(|index| self.times.get(index))
            .copied()
            .unwrap_or(Loss::NEVER)
    }

    /// The violation of a level's volume by an aircraft of the traffic; `None` for an unknown level.
    pub fn violation(&self, index: usize, level: usize) -> Option<Loss> {
        let alerter = self.alerters.get(index).copied().flatten()?;
        let level = self.settings.alerters.get(alerter)?.level(level)?;
        let pair = pair_of(self.ownship.as_ref()?, self.traffic.get(index)?);
        Some(
            level
                .volume
                .violation(&pair, 0.0, self.settings.lookahead_s),
        )
    }

    /// The bands of a quantity.
    pub fn bands(&self, quantity: Quantity) -> &QuantityBands {
        let [direction, horizontal_speed, vertical_speed, altitude] = &self.bands;
        match quantity {
            Quantity::Direction => direction,
            Quantity::HorizontalSpeed => horizontal_speed,
            Quantity::VerticalSpeed => vertical_speed,
            Quantity::Altitude => altitude,
        }
    }

    /// The last time at which a maneuver of a quantity stays out of the corrective volume of an
    /// aircraft, to half a second.
    pub fn last_time(&mut self, quantity: Quantity, index: usize, ahead: &impl Ahead) -> LastTime {
        let fresh = QuantityBands::new(quantity);
        let mut bands = core::mem::replace(self.bands_mut(quantity), fresh);
        let last = self
            .search_last_time(&mut bands, index, ahead)
            .unwrap_or(LastTime::NoConflict);
        *self.bands_mut(quantity) = bands;
        last
    }

    fn bands_mut(&mut self, quantity: Quantity) -> &mut QuantityBands {
        let [direction, horizontal_speed, vertical_speed, altitude] = &mut self.bands;
        match quantity {
            Quantity::Direction => direction,
            Quantity::HorizontalSpeed => horizontal_speed,
            Quantity::VerticalSpeed => vertical_speed,
            Quantity::Altitude => altitude,
        }
    }

    fn search_last_time(
        &self,
        bands: &mut QuantityBands,
        index: usize,
        ahead: &impl Ahead,
    ) -> Option<LastTime> {
        let picture = self.picture()?;
        let alerter = self.alerters.get(index).copied().flatten()?;
        let number = self.settings.corrective_level(alerter)?;
        let volume = &self.settings.alerters.get(alerter)?.level(number)?.volume;
        if !bands.is_computed() {
            return None;
        }
        let loss = self.violation(index, number)?;
        if !loss.is_conflict() {
            return None;
        }
        if loss.entry_s == 0.0 {
            return Some(LastTime::Passed);
        }
        let deviation = picture.met(index)?.deviation;
        let (mut possible_s, mut too_late_s) = (0.0, loss.entry_s);
        let mut tried_s = possible_s;
        while too_late_s - possible_s > 0.5 {
            let ownship = ahead.ownship(tried_s);
            let intruder = ahead.intruder(index, tried_s);
            let met = Met {
                settings: &self.settings,
                intruder,
                deviation,
            };
            let pair = Pair {
                ownship,
                intruder,
                deviation,
            };
            let is_late = volume.conflicts(&pair, 0.0, 0.0)
                || bands.is_blocked(&picture, &ownship, &met, volume);
            if is_late {
                too_late_s = tried_s;
            } else {
                possible_s = tried_s;
            }
            tried_s = f64::midpoint(too_late_s, possible_s);
        }
        Some(if possible_s == 0.0 {
            LastTime::Passed
        } else {
            LastTime::In(possible_s)
        })
    }
}
