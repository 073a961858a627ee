//! Windows of lines, found at most once for each intruder and volume of a step.

use crate::bands::met::{Places, Windows};
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

/// Windows of lines, found at most once for each intruder and volume of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct WindowPool {
    keys: Vec<(usize, Key)>,
    windows: Vec<Windows>,
    /// Until when no way meets anything, as far as that is known, seconds.
    quiet_s: Vec<f64>,
}

impl WindowPool {
    pub(super) fn clear(&mut self) {
        self.keys.clear();
        self.quiet_s.clear();
    }

    /// The place of the windows of an intruder and a volume; `None` where these depend on the time
    /// that is asked for.
    pub(super) fn ensure(
        &mut self,
        intruder: usize,
        (volume, key): (&Volume, Key),
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
        if let Some(windows) = self.windows.get_mut(place) {
            windows.reset(lines);
        }
        self.keys.push((intruder, key));
        self.quiet_s.push(f64::NEG_INFINITY);
        Some(place)
    }

    /// Whether no way meets anything until a time: it does not if it does not until a later one.
    pub(super) fn is_quiet(&self, place: Option<usize>, until_s: f64) -> bool {
        let quiet_s = place.and_then(|place| self.quiet_s.get(place));
        quiet_s.is_some_and(|quiet_s| until_s <= *quiet_s)
    }

    /// Remembers that no way meets anything until a time.
    pub(super) fn keep_quiet(&mut self, place: Option<usize>, until_s: f64) {
        if let Some(quiet_s) = place.and_then(|place| self.quiet_s.get_mut(place)) {
            *quiet_s = until_s.max(*quiet_s);
        }
    }

    /// The windows at a place.
    pub(super) fn windows(&mut self, place: Option<usize>) -> Option<Places<'_>> {
        self.windows.get_mut(place?).map(Windows::places)
    }

    /// All windows, by their places.
    pub(super) fn all(&mut self) -> Vec<Places<'_>> {
        self.windows.iter_mut().map(Windows::places).collect()
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
