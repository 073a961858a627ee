//! Alert levels and bands over time.

mod input;

use crate::aircraft::{Aircraft, AircraftId, AircraftState, Pair};
use crate::almost::Closeness::Rounding;
use crate::bands::{QuantityBands, meets_within_spread};
use crate::hysteresis::Held;
use crate::loss::Loss;
use crate::picture::{Contribution, Picture, Terminal};
use crate::quantity::Quantity;
use crate::settings::{AlertSettings, Region, TerminalGuidance};
use alloc::collections::BTreeMap;
use alloc::vec;
use alloc::vec::Vec;
use input::check;

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
pub trait FutureStates {
    /// The ownship's state after a time, seconds, in the frame of the step.
    fn ownship(&self, after_s: f64) -> AircraftState;
    /// An aircraft's state after a time, by its index in the traffic.
    fn intruder(&self, index: usize, after_s: f64) -> AircraftState;
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
    picture: Picture,
    /// Levels over time, by aircraft.
    alert_memory: BTreeMap<AircraftId, Held>,
    terminal_memory: BTreeMap<AircraftId, Held>,
    slow_memory: Held,
    alerts: Vec<Alert>,
    bands: [QuantityBands; 4],
}

impl Monitor {
    /// A monitor without memory.
    pub fn new(settings: AlertSettings) -> Self {
        Self {
            picture: Picture {
                settings,
                time_s: 0.0,
                ownship: Aircraft::new(AircraftId(0), AircraftState::default()),
                traffic: Vec::new(),
                alerters: Vec::new(),
                conflicts: Default::default(),
                times: [Loss::NEVER; 3],
                terminal: Terminal::Outside,
                is_slow: false,
            },
            alert_memory: BTreeMap::new(),
            terminal_memory: BTreeMap::new(),
            slow_memory: Held::default(),
            alerts: Vec::new(),
            bands: Quantity::ALL.map(QuantityBands::new),
        }
    }

    /// The settings.
    pub const fn settings(&self) -> &AlertSettings {
        &self.picture.settings
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
        self.step_for(&Quantity::ALL, time_s, ownship, traffic)
    }

    /// The same for the bands of some quantities; afterwards the others have none. With no quantity it finds alert levels only, no conflicts.
    ///
    /// # Errors
    /// As [`Monitor::step`].
    pub fn step_for(
        &mut self,
        quantities: &[Quantity],
        time_s: f64,
        ownship: &Aircraft,
        traffic: &[Aircraft],
    ) -> Result<(), StepError> {
        self.find_levels(time_s, ownship, traffic)?;
        if !quantities.is_empty() {
            self.find_conflicts();
            self.watch_terminal();
        }
        for bands in &mut self.bands {
            if quantities.contains(&bands.quantity()) {
                bands.update(&self.picture);
            } else {
                *bands = QuantityBands::new(bands.quantity());
            }
        }
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
        let picture = &mut self.picture;
        let goes_on = picture.ownship.id == ownship.id
            && time_s >= picture.time_s
            && time_s - picture.time_s <= picture.settings.hysteresis.memory_s;
        if !goes_on {
            self.alert_memory.clear();
            self.terminal_memory.clear();
            self.slow_memory = Held::default();
            for quantity in &mut self.bands {
                quantity.forget();
            }
        }
        picture.time_s = time_s;
        picture.ownship = *ownship;
        picture.traffic.clear();
        picture.traffic.extend_from_slice(traffic);
        let raw = i8::from(ownship.state.speed_mps() < picture.settings.least_airspeed_mps);
        let hysteresis = &picture.settings.hysteresis;
        picture.is_slow = self.slow_memory.take(raw, time_s, hysteresis) > 0;
        self.picture.alerters = if self.picture.settings.ownship_centric {
            vec![self.alerter_of(ownship); traffic.len()]
        } else {
            traffic
                .iter()
                .map(|aircraft| self.alerter_of(aircraft))
                .collect()
        };
        self.alert();
        Ok(())
    }

    /// The alerter that holds where an aircraft is: in the terminal area, with memory, or elsewhere.
    fn alerter_of(&mut self, aircraft: &Aircraft) -> Option<usize> {
        let settings = &self.picture.settings;
        let area = &settings.terminal;
        let mut alerter = aircraft.alerter;
        if area.guidance != TerminalGuidance::Off
            && area.alerter.is_some()
            && area.radius_m > 0.0
            && area.height_m > 0.0
        {
            let distance_m = aircraft.terminal_distance_m;
            let inside = distance_m.is_some_and(|m| Rounding.at_most(m, area.radius_m))
                && Rounding.at_most(aircraft.state.position_m.z, area.height_m);
            let held = self.terminal_memory.entry(aircraft.id).or_default();
            if held.take(i8::from(inside), self.picture.time_s, &settings.hysteresis) == 1 {
                alerter = area.alerter;
            }
        }
        alerter.filter(|index| *index < settings.alerters.len())
    }

    /// Finds the alert level of every aircraft.
    fn alert(&mut self) {
        // Manoeuvres within a spread count as outside of the terminal area.
        self.picture.terminal = Terminal::Outside;
        let picture = &self.picture;
        let alerts = picture.traffic.iter().zip(&picture.alerters).enumerate();
        let alerts = alerts.map(|(index, (aircraft, alerter))| {
            let level = alerter.map(|alerter| {
                let held = self.alert_memory.entry(aircraft.id).or_default();
                let last = held.last.filter(|(last_s, _)| *last_s < picture.time_s);
                let raw = raw_level(picture, index, alerter, last.map(|(_, level)| level));
                held.take(raw, picture.time_s, &picture.settings.hysteresis)
            });
            Alert {
                id: aircraft.id,
                alerter: *alerter,
                level: level.and_then(|level| usize::try_from(level).ok()),
            }
        });
        self.alerts = alerts.collect();
    }

    /// Finds the aircraft in conflict, region by region.
    fn find_conflicts(&mut self) {
        let picture = &self.picture;
        let mut conflicts: [Vec<Contribution>; 3] = Default::default();
        let mut times = [Loss::NEVER; 3];
        let lists = conflicts.iter_mut().zip(&mut times);
        for (region, (list, times)) in Region::CONFLICTS.into_iter().zip(lists) {
            for (intruder, aircraft) in picture.traffic.iter().enumerate() {
                let Some(level) = picture.level_for(intruder, region) else {
                    continue;
                };
                let stays_on = self.alert_memory.get(&aircraft.id).is_some_and(|held| {
                    let last = held.last.and_then(|(_, last)| usize::try_from(last).ok());
                    held.rose_s.is_some_and(|rose_s| rose_s < picture.time_s) && last == Some(level)
                });
                let alert = picture.level(intruder, level);
                let time_s = alert.map_or(0.0, |alert| alert.time_s(stays_on));
                let loss = picture.violation(intruder, level).unwrap_or(Loss::NEVER);
                if loss.begins_before(time_s) {
                    list.push(Contribution {
                        intruder,
                        level,
                        horizon_s: picture.settings.lookahead_s,
                    });
                }
                *times = times.hull(loss);
            }
        }
        (self.picture.conflicts, self.picture.times) = (conflicts, times);
    }

    /// Updates the state of the terminal area.
    fn watch_terminal(&mut self) {
        let picture = &mut self.picture;
        let area = &picture.settings.terminal;
        let is_inside = area.guidance != TerminalGuidance::Off
            && area.alerter.is_some()
            && picture.alerters.contains(&area.alerter);
        // Special guidance begins with a conflict above the corrective region.
        let corrective = picture.settings.corrective_region.conflict_index();
        let mut above = picture.conflicts.iter().take(corrective.unwrap_or(0));
        picture.terminal = if !is_inside {
            Terminal::Outside
        } else if above.any(|list| !list.is_empty()) {
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
        let levels = self.alerts.iter().filter_map(|alert| alert.level);
        levels.max().unwrap_or(0)
    }

    /// Whether an aircraft of the traffic, or the ownship, is in the terminal area and whether its
    /// guidance is on.
    pub fn terminal(&self) -> (bool, bool) {
        let terminal = self.picture.terminal;
        (terminal != Terminal::Outside, terminal == Terminal::Guided)
    }

    /// Aircraft (indices in the traffic) whose predicted violation alerts in a region.
    pub fn conflicts(&self, region: Region) -> impl Iterator<Item = usize> + '_ {
        let conflicts = region.of(&self.picture.conflicts).into_iter().flatten();
        conflicts.map(|contribution| contribution.intruder)
    }

    /// From the first entry into a region's volume to the last exit, over all aircraft.
    pub fn conflict_times(&self, region: Region) -> Loss {
        region
            .of(&self.picture.times)
            .copied()
            .unwrap_or(Loss::NEVER)
    }

    /// The violation of a level's volume by an aircraft of the traffic; `None` for an unknown level.
    pub fn violation(&self, index: usize, level: usize) -> Option<Loss> {
        self.picture.violation(index, level)
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
    pub fn last_time(
        &self,
        quantity: Quantity,
        index: usize,
        ahead: &impl FutureStates,
    ) -> LastTime {
        self.search_last_time(quantity, index, ahead)
            .unwrap_or(LastTime::NoConflict)
    }

    fn search_last_time(
        &self,
        quantity: Quantity,
        index: usize,
        ahead: &impl FutureStates,
    ) -> Option<LastTime> {
        let (picture, bands) = (&self.picture, self.bands(quantity));
        let number = picture.level_for(index, picture.settings.corrective_region)?;
        let volume = &picture.level(index, number)?.volume;
        let loss = picture.violation(index, number)?;
        if bands.bands().is_empty() || !loss.is_conflict() {
            return None;
        }
        if loss.entry_s == 0.0 {
            return Some(LastTime::Passed);
        }
        let pair = picture.pair(index)?;
        let (mut possible_s, mut too_late_s) = (0.0, loss.entry_s);
        let mut tried_s = possible_s;
        while too_late_s - possible_s > 0.5 {
            let pair = Pair {
                ownship: ahead.ownship(tried_s),
                intruder: ahead.intruder(index, tried_s),
                ..pair
            };
            if volume.conflicts(&pair, 0.0, 0.0) || bands.is_blocked(picture, &pair, volume) {
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

/// The highest level of an alerter that alerts of an aircraft, on straight lines or after a manoeuvre within the
/// level's spread; `last` is the level before.
fn raw_level(picture: &Picture, index: usize, alerter: usize, last: Option<i8>) -> i8 {
    let alerter = picture.settings.alerters.get(alerter);
    let (Some(alerter), Some(pair)) = (alerter, picture.pair(index)) else {
        return 0;
    };
    let alerted = (1_i8..).zip(&alerter.levels).filter(|(number, level)| {
        let (volume, time_s) = (&level.volume, level.time_s(last == Some(*number)));
        let loss = volume.violation(&pair, 0.0, picture.settings.lookahead_s);
        let leads_into = |quantity| {
            let spread = level.spread.get(quantity);
            spread > 0.0 && meets_within_spread(picture, quantity, spread, &pair, volume, time_s)
        };
        loss.begins_before(time_s) || Quantity::ALL.into_iter().any(leads_into)
    });
    alerted.last().map_or(0, |(number, _)| number)
}
