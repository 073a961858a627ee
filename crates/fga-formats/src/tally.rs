//! How much of an input a reader used, and why it left out the rest.

use core::ops::AddAssign;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Why a part of an input is not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LeftOut {
    /// Intact, but nothing in it is needed: a heartbeat, a squawk, a message of another system.
    NotNeeded,
    /// Of a kind that the reader does not know.
    UnknownKind,
    /// It ends too early.
    CutShort,
    /// It has no end within the longest accepted length.
    TooLong,
    /// Its checksum is wrong.
    WrongChecksum,
    /// A field does not hold what the format says.
    UnreadableField,
    /// It does not say which aircraft it is about.
    NoAddress,
    /// It has no time.
    NoTime,
    /// It has no position.
    NoPosition,
    /// It has a position, but no altitude is known.
    NoAltitude,
    /// The aircraft says that it is on the ground.
    OnGround,
    /// It was too old when it came.
    TooOld,
    /// The same aircraft has another one of the same time.
    SameTime,
    /// The aircraft has no other within reach: a track needs two.
    Alone,
    /// No aircraft gets there from the positions before and after it.
    Jump,
}

/// All reasons with their name in files and their words behind a number.
const REASONS: [(LeftOut, &str, &str); 15] = [
    (LeftOut::NotNeeded, "not_needed", "without use here"),
    (LeftOut::UnknownKind, "unknown_kind", "of an unknown kind"),
    (LeftOut::CutShort, "cut_short", "cut short"),
    (LeftOut::TooLong, "too_long", "too long"),
    (
        LeftOut::WrongChecksum,
        "wrong_checksum",
        "with a wrong checksum",
    ),
    (
        LeftOut::UnreadableField,
        "unreadable_field",
        "with an unreadable field",
    ),
    (LeftOut::NoAddress, "no_address", "without an address"),
    (LeftOut::NoTime, "no_time", "without a time"),
    (LeftOut::NoPosition, "no_position", "without a position"),
    (LeftOut::NoAltitude, "no_altitude", "without an altitude"),
    (LeftOut::OnGround, "on_ground", "on the ground"),
    (LeftOut::TooOld, "too_old", "too old"),
    (LeftOut::SameTime, "same_time", "of a time given twice"),
    (LeftOut::Alone, "alone", "alone in their track"),
    (LeftOut::Jump, "jump", "out of reach"),
];

impl LeftOut {
    /// Every reason.
    pub fn all() -> impl Iterator<Item = Self> {
        REASONS.iter().map(|(reason, ..)| *reason)
    }

    /// The name in files.
    pub fn name(self) -> &'static str {
        REASONS.get(self as usize).map_or("", |(_, name, _)| name)
    }

    /// The words behind a number, as in "3 cut short".
    pub fn words(self) -> &'static str {
        REASONS.get(self as usize).map_or("", |(_, _, words)| words)
    }
}

/// Counts of an input's parts (lines, messages, rows): each part is in exactly one of them.
///
/// ```
/// use fga_formats::tally::{LeftOut, Tally};
///
/// let mut tally = Tally::default();
/// tally.used += 722;
/// tally.leave_out(LeftOut::CutShort);
/// tally.leave_out(LeftOut::NoAltitude);
/// assert_eq!(tally.read(), 724);
/// assert_eq!(tally.words("lines").unwrap(), "2 of 724 lines: 1 cut short, 1 without an altitude");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(into = "Map<String, Value>", from = "Map<String, Value>")]
pub struct Tally {
    /// Parts that were used.
    pub used: u64,
    left_out: [u64; REASONS.len()],
}

impl Tally {
    /// Parts that were all used.
    pub fn all_used(used: u64) -> Self {
        Self {
            used,
            ..Self::default()
        }
    }

    /// Takes part after part of bytes, each by its length and what became of it; the bytes between are damaged, one part up to the next.
    pub(crate) fn walk<'a>(
        bytes: &'a [u8],
        damage: LeftOut,
        mut take: impl FnMut(&'a [u8]) -> Option<(usize, Result<(), LeftOut>)>,
    ) -> Self {
        let mut tally = Self::default();
        let (mut at, mut is_damaged) = (0, false);
        while let Some(rest) = bytes.get(at..).filter(|rest| !rest.is_empty()) {
            let taken = take(rest);
            at += taken.map_or(1, |(length, _)| length);
            if let Some((_, result)) = taken {
                if is_damaged {
                    tally.leave_out(damage);
                }
                tally.take(&result);
            }
            is_damaged = taken.is_none();
        }
        if is_damaged {
            tally.leave_out(LeftOut::CutShort);
        }
        tally
    }

    /// Counts a part that is not used.
    pub fn leave_out(&mut self, reason: LeftOut) {
        if let Some(count) = self.left_out.get_mut(reason as usize) {
            *count += 1;
        }
    }

    /// Counts a part by its result.
    pub fn take<T>(&mut self, result: &Result<T, LeftOut>) {
        match result {
            Ok(_) => self.used += 1,
            Err(reason) => self.leave_out(*reason),
        }
    }

    /// Moves a part from those used to those left out.
    pub fn refuse(&mut self, reason: LeftOut) {
        self.used = self.used.saturating_sub(1);
        self.leave_out(reason);
    }

    /// Parts left out for a reason.
    pub fn left_out(&self, reason: LeftOut) -> u64 {
        self.left_out.get(reason as usize).copied().unwrap_or(0)
    }

    /// The reasons that occurred, with their counts.
    pub fn reasons(&self) -> impl Iterator<Item = (LeftOut, u64)> {
        LeftOut::all()
            .zip(self.left_out)
            .filter(|(_, count)| *count > 0)
    }

    /// Parts that were needed and could not be used.
    pub fn lost(&self) -> u64 {
        let all: u64 = self.left_out.iter().sum();
        all - self.left_out(LeftOut::NotNeeded)
    }

    /// All parts.
    pub fn read(&self) -> u64 {
        self.used + self.left_out.iter().sum::<u64>()
    }

    /// Parts that were needed and could not be used, in words, with their name in the plural; `None` if
    /// there are none.
    pub fn words(&self, parts: &str) -> Option<String> {
        if self.lost() == 0 {
            return None;
        }
        let lost = self
            .reasons()
            .filter(|(reason, _)| *reason != LeftOut::NotNeeded);
        let lost: Vec<String> = lost
            .map(|(reason, count)| format!("{count} {}", reason.words()))
            .collect();
        Some(format!(
            "{} of {} {parts}: {}",
            self.lost(),
            self.read(),
            lost.join(", ")
        ))
    }

    /// The counts by the names of their reasons.
    pub fn to_json(&self) -> Map<String, Value> {
        self.reasons()
            .map(|(reason, count)| (reason.name().to_owned(), count.into()))
            .collect()
    }
}

impl AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        self.used += other.used;
        for (count, more) in self.left_out.iter_mut().zip(other.left_out) {
            *count += more;
        }
    }
}

impl From<Tally> for Map<String, Value> {
    fn from(tally: Tally) -> Self {
        let mut map = tally.to_json();
        map.insert("used".into(), tally.used.into());
        map
    }
}

impl From<Map<String, Value>> for Tally {
    fn from(map: Map<String, Value>) -> Self {
        let count = |name: &str| map.get(name).and_then(Value::as_u64).unwrap_or(0);
        Self {
            used: count("used"),
            left_out: REASONS.map(|(_, name, _)| count(name)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_stand_at_their_places_and_are_read_back() {
        let mut tally = Tally::default();
        for (place, (reason, name, _)) in REASONS.iter().enumerate() {
            assert_eq!((*reason as usize, reason.name()), (place, *name));
            tally.leave_out(*reason);
        }
        tally.used = 3;
        assert_eq!(tally.read(), 3 + REASONS.len() as u64);
        let text = serde_json::to_string(&tally).unwrap();
        assert_eq!(serde_json::from_str::<Tally>(&text).unwrap(), tally);
    }
}
