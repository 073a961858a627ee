//! Windows of lines, computed once for each intruder and volume of a step.

use crate::bands::met::{Approaches, Asked, Met, Windows};
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
}

impl WindowPool {
    pub(super) fn clear(&mut self) {
        self.keys.clear();
        self.known.clear();
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

    /// The windows at an index.
    pub(super) fn get(&self, place: usize) -> Option<&Windows> {
        self.windows.get(place)
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
