//! Windows of lines, computed once for each intruder and volume of a step.

use crate::bands::met::{Approaches, Asked, Meeting, Met, Windows, meetings_once};
use crate::bands::opening::Openings;
use crate::bands::path::Lines;
use crate::settings::Settings;
use crate::volume::{Cylinder, Volume};
use alloc::vec::Vec;

/// The volume of a set of windows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Key {
    Level { alerter: usize, level: usize },
    Cylinder(Cylinder),
}

/// Windows of lines, computed once for each intruder and volume of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct WindowPool {
    keys: Vec<(usize, Key)>,
    windows: Vec<Windows>,
    /// Aircraft of which the approaches are known.
    known: Vec<usize>,
    approaches: Vec<Approaches>,
    /// The places of two windows and the horizon, seconds, of which the openings are known.
    opened: Vec<((usize, usize), f64)>,
    openings: Vec<Openings>,
}

impl WindowPool {
    pub(super) fn clear(&mut self) {
        self.keys.clear();
        self.known.clear();
        self.opened.clear();
    }

    /// The place of the windows of an intruder and a volume; `None` where these depend on the time
    /// that is asked for.
    pub(super) fn ensure(
        &mut self,
        intruder: usize,
        key: Key,
        met: &Met,
        volume: &Volume,
        lines: Lines,
    ) -> Option<usize> {
        if volume.depends_on_time() {
            return None;
        }
        let known = self.keys.iter().position(|known| *known == (intruder, key));
        if known.is_some() {
            return known;
        }
        let place = self.keys.len();
        if self.windows.len() <= place {
            self.windows.push(Windows::default());
        }
        let at = self.approached(intruder, met, lines);
        if let (Some(windows), Some(approaches)) =
            (self.windows.get_mut(place), self.approaches.get(at))
        {
            // A cylinder of recovery counts from the begin, a level's volume perhaps from later on.
            let asked = match key {
                Key::Level { .. } => Asked::All,
                Key::Cylinder(_) => Asked::UntilMet,
            };
            windows.fill(met, volume, lines, approaches, asked);
        }
        self.keys.push((intruder, key));
        Some(place)
    }

    /// The approaches at an index.
    pub(super) fn approaches(&self, at: usize) -> Option<&Approaches> {
        self.approaches.get(at)
    }

    /// The place of an intruder's approaches.
    pub(super) fn approached(&mut self, intruder: usize, met: &Met, lines: Lines) -> usize {
        if let Some(at) = self.known.iter().position(|known| *known == intruder) {
            return at;
        }
        let at = self.known.len();
        if self.approaches.len() <= at {
            self.approaches.push(Approaches::default());
        }
        if let Some(approaches) = self.approaches.get_mut(at) {
            approaches.fill(met, lines);
        }
        self.known.push(intruder);
        at
    }

    /// How lines meet a volume of which the windows are known, or are found one by one.
    pub(super) fn meetings<'a>(
        &'a self,
        place: Option<usize>,
        met: &Met<'a>,
        volume: &'a Volume,
        lines: Lines<'a>,
    ) -> [Meeting<'a>; 2] {
        place.and_then(|place| self.windows.get(place)).map_or_else(
            || meetings_once(met, volume, lines),
            |windows| windows.of(met, volume, lines),
        )
    }

    /// The place of the openings between the later windows and the earlier ones.
    pub(super) fn ensure_open(
        &mut self,
        places: (usize, usize),
        until_s: f64,
        fill: impl FnOnce(&Self, &mut Openings),
    ) -> usize {
        let key = (places, until_s);
        if let Some(known) = self.opened.iter().position(|known| *known == key) {
            return known;
        }
        let place = self.opened.len();
        let mut openings = self
            .openings
            .get_mut(place)
            .map(core::mem::take)
            .unwrap_or_default();
        fill(self, &mut openings);
        match self.openings.get_mut(place) {
            Some(known) => *known = openings,
            None => self.openings.push(openings),
        }
        self.opened.push(key);
        place
    }

    /// The openings at an index.
    pub(super) fn openings(&self, place: usize) -> Option<&Openings> {
        self.openings.get(place)
    }
}

/// The key of a level's windows: levels of one alerter with the same volume share them.
pub(super) fn level_key(settings: &Settings, alerter: usize, level: usize) -> Key {
    let shared = settings.alerters.get(alerter).and_then(|levels| {
        let volume = &levels.level(level)?.volume;
        levels
            .levels
            .iter()
            .position(|other| other.volume == *volume)
            .map(|index| index + 1)
    });
    Key::Level {
        alerter,
        level: shared.unwrap_or(level),
    }
}
