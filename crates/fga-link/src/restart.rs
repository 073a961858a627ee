//! The note for a restarted program: the owed mode.
//!
//! The program writes the note before it takes a mode, and removes it after the return and once no request for the mode can be
//! on its way any more. The vehicle's clock
//! dates the note, so that it is valid on a computer without a clock.

use serde::{Deserialize, Serialize};

use crate::authority::Owed;
use crate::mode::Mode;

/// An older note has no meaning, milliseconds of the vehicle's clock.
const LIFETIME_MS: u32 = 600_000;

/// Two clocks count the same time with this difference, milliseconds.
const CLOCKS_MS: u32 = 5_000;

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
    /// Whether the owned mode was only requested and the request given up: nothing is owed, but the vehicle may still carry it out.
    #[serde(default)]
    pub given_up: bool,
    /// The mission item that the vehicle was asked to go on with: the commands from there to the next waypoint wait for AUTO.
    #[serde(default)]
    pub item: Option<u16>,
    /// This computer's clock when the note was written, seconds since 1970; 0 if unknown.
    #[serde(default)]
    pub written_unix_s: u64,
    /// The age of the note when it was read, by this computer's clock, seconds.
    #[serde(skip)]
    pub age_s: u64,
}

impl Note {
    /// A note of a debt, at a time of the vehicle's clock.
    pub const fn new(owed: Owed, boot_ms: u32) -> Self {
        Self {
            system_id: owed.system_id,
            owned_mode: owed.owned.0,
            previous_mode: owed.previous.0,
            boot_ms,
            given_up: false,
            item: None,
            written_unix_s: 0,
            age_s: 0,
        }
    }

    /// The note as it was read at a time of this computer's clock. A clock that has been set back makes no note older.
    #[must_use]
    pub const fn read_at(self, unix_s: u64) -> Self {
        let age_s = match self.written_unix_s {
            0 => 0,
            written_s => unix_s.saturating_sub(written_s),
        };
        Self { age_s, ..self }
    }

    /// Whether it is too old for any vehicle.
    pub const fn has_expired(&self) -> bool {
        self.age_s * 1000 > LIFETIME_MS as u64
    }

    /// Whether it concerns this vehicle in this mode. A request that was given up concerns it in every mode.
    pub const fn fits(&self, system_id: u8, mode: Mode) -> bool {
        self.system_id == system_id && (self.given_up || self.owned_mode == mode.0)
    }

    /// Whether it still counts: the vehicle has not restarted since, and little time has passed. A note that is older than its
    /// time on the vehicle's clock is of another vehicle or another flight.
    pub const fn counts(&self, boot_ms: u32) -> bool {
        if boot_ms < self.boot_ms || boot_ms - self.boot_ms > LIFETIME_MS {
            return false;
        }
        self.age_s * 1000 <= (boot_ms - self.boot_ms + CLOCKS_MS) as u64
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
        // A request that was given up may arrive in every mode.
        let given_up = Note {
            given_up: true,
            ..note
        };
        assert!(given_up.fits(3, Mode::AUTO) && !given_up.fits(4, Mode::GUIDED));
        // Written an hour ago, or half a minute before the vehicle's clock says.
        let written = Note {
            written_unix_s: 1_000_000,
            ..note
        };
        assert!(written.read_at(1_003_600).has_expired());
        let read = written.read_at(1_000_030);
        assert!(!read.has_expired() && read.counts(80_000) && !read.counts(60_000));
        assert!(
            written.read_at(0).counts(60_000),
            "a clock that was set back"
        );
        let text = serde_json::to_string(&note).unwrap();
        assert_eq!(serde_json::from_str::<Note>(&text).unwrap(), note);
    }
}
