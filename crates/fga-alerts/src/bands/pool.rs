//! Windows of fans, computed once for each intruder and volume of a step.

use crate::bands::path::Fan;
use crate::bands::search::{Met, Windows};
use crate::settings::Settings;
use crate::volume::{Cylinder, Volume};
use alloc::vec::Vec;

/// The volume of a set of windows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Key {
    Level { alerter: usize, level: usize },
    Cylinder(Cylinder),
}

/// Windows of fans, computed once for each intruder and volume of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct WindowPool {
    keys: Vec<(usize, Key)>,
    windows: Vec<Windows>,
}

impl WindowPool {
    pub(super) fn clear(&mut self) {
        self.keys.clear();
    }

    /// The index of the windows of an intruder and a volume.
    pub(super) fn ensure(
        &mut self,
        intruder: usize,
        key: Key,
        met: &Met,
        volume: &Volume,
        fan: &Fan,
    ) -> usize {
        if let Some(place) = self.keys.iter().position(|known| *known == (intruder, key)) {
            return place;
        }
        let place = self.keys.len();
        if self.windows.len() <= place {
            self.windows.push(Windows::default());
        }
        if let Some(windows) = self.windows.get_mut(place) {
            windows.fill(met, volume, fan);
        }
        self.keys.push((intruder, key));
        place
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
