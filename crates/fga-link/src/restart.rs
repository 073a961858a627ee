//! The note for a restarted program: the owed mode.
//!
//! The program writes the note before it takes a mode and removes it after the return. The vehicle's clock
//! dates it, so that it does not depend on a computer without a clock.

use serde::{Deserialize, Serialize};

use crate::authority::Owed;
use crate::mode::Mode;

/// An older note has no meaning, milliseconds of the vehicle's clock.
const LIFETIME_MS: u32 = 600_000;

/// The mode owed to a vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Note {
    /// System id of the vehicle.
    pub system_id: u8,
    /// The mode that manoeuvres are flown in.
    pub owned_mode: u32,
    /// The mode from before the manoeuvre.
    pub previous_mode: u32,
    /// The vehicle's time since boot when the mode was taken, milliseconds.
    pub boot_ms: u32,
}

impl Note {
    /// A note of a debt, at a time of the vehicle's clock.
    pub const fn new(owed: Owed, boot_ms: u32) -> Self {
        Self {
            system_id: owed.system_id,
            owned_mode: owed.owned.0,
            previous_mode: owed.previous.0,
            boot_ms,
        }
    }

    /// Whether it concerns this vehicle in this mode.
    pub const fn fits(&self, system_id: u8, mode: Mode) -> bool {
        self.system_id == system_id && self.owned_mode == mode.0
    }

    /// Whether it still counts: the vehicle has not restarted since, and little time has passed.
    pub const fn counts(&self, boot_ms: u32) -> bool {
        boot_ms >= self.boot_ms && boot_ms - self.boot_ms <= LIFETIME_MS
    }

    /// The mode to restore.
    pub const fn previous(&self) -> Mode {
        Mode(self.previous_mode)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_counts_for_its_vehicle_its_mode_and_its_flight() {
        let owed = Owed {
            system_id: 3,
            owned: Mode::GUIDED,
            previous: Mode::AUTO,
        };
        let note = Note::new(owed, 50_000);
        assert!(note.fits(3, Mode::GUIDED));
        assert!(!note.fits(4, Mode::GUIDED) && !note.fits(3, Mode::RTL));
        assert!(note.counts(50_000) && note.counts(650_000));
        assert!(!note.counts(49_999) && !note.counts(650_001));
        let text = serde_json::to_string(&note).unwrap();
        assert_eq!(serde_json::from_str::<Note>(&text).unwrap(), note);
    }
}
