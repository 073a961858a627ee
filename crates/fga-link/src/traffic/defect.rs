//! What reports lack: counted for each defect, and one text to the operator for each.

use alloc::collections::BTreeSet;

use super::identity::TrackKey;

/// Most aircraft counted for each defect; more of them change no text.
const MOST_AIRCRAFT: usize = 256;

/// A defect of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Defect {
    /// No position, or one that the sender marks as invalid: not avoided.
    NoPosition,
    /// A position older than `traffic.drop_after_s`: not avoided.
    Old,
    /// No altitude, or one marked as invalid: avoided at its last altitude for a while, then at every altitude near ours.
    NoAltitude,
    /// A velocity that contradicts its positions: avoided with the motion that the positions show.
    FalseVelocity,
}

impl Defect {
    /// All defects.
    pub const ALL: [Self; 4] = [
        Self::NoPosition,
        Self::Old,
        Self::NoAltitude,
        Self::FalseVelocity,
    ];

    /// Name in logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NoPosition => "no-position",
            Self::Old => "old",
            Self::NoAltitude => "no-altitude",
            Self::FalseVelocity => "false-velocity",
        }
    }

    /// Whether an aircraft with it is avoided all the same.
    pub const fn is_bounded(self) -> bool {
        matches!(self, Self::NoAltitude | Self::FalseVelocity)
    }

    fn words(self, aircraft: usize) -> String {
        match self {
            Self::NoPosition => format!("fga: {aircraft} aircraft without position, unseen"),
            Self::Old => format!("fga: {aircraft} aircraft with old reports, unseen"),
            Self::NoAltitude => format!("fga: {aircraft} aircraft without altitude, ours taken"),
            Self::FalseVelocity => format!("fga: {aircraft} aircraft with a false velocity"),
        }
    }
}

/// The defects heard so far.
#[derive(Debug, Clone, Default)]
pub struct Defects {
    reports: [u64; Defect::ALL.len()],
    told: [bool; Defect::ALL.len()],
    aircraft: BTreeSet<(Defect, TrackKey)>,
}

impl Defects {
    /// Counts a defect of a report; returns the text for the operator when it is the first of its kind that is near.
    pub fn count(&mut self, defect: Defect, key: TrackKey, is_near: bool) -> Option<String> {
        if let Some(reports) = self.reports.get_mut(defect as usize) {
            *reports = reports.saturating_add(1);
        }
        let aircraft = self.aircraft(defect);
        if aircraft < MOST_AIRCRAFT {
            self.aircraft.insert((defect, key));
        }
        let told = self.told.get_mut(defect as usize)?;
        (is_near && !core::mem::replace(told, true)).then(|| defect.words(self.aircraft(defect)))
    }

    /// Number of reports with a defect.
    pub fn reports(&self, defect: Defect) -> u64 {
        self.reports.get(defect as usize).copied().unwrap_or(0)
    }

    /// Number of aircraft with a defect.
    pub fn aircraft(&self, defect: Defect) -> usize {
        let of_it = self.aircraft.iter().filter(|(other, _)| *other == defect);
        of_it.count()
    }

    /// Number of aircraft that cannot be avoided.
    pub fn unseen(&self) -> usize {
        let unbounded = Defect::ALL
            .into_iter()
            .filter(|defect| !defect.is_bounded());
        unbounded.map(|defect| self.aircraft(defect)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_defect_is_told_once_and_fits_into_one_message() {
        let mut defects = Defects::default();
        for defect in Defect::ALL {
            assert_eq!(
                defects.count(defect, TrackKey::Address(1), false),
                None,
                "far"
            );
            let words = defects.count(defect, TrackKey::Address(2), true).unwrap();
            assert!(words.contains("2 aircraft"), "{words}");
            assert!(defect.words(MOST_AIRCRAFT).len() <= 50, "{words}");
            for icao in 0..10_000 {
                assert_eq!(defects.count(defect, TrackKey::Address(icao), true), None);
            }
            assert_eq!(defects.reports(defect), 10_002);
            assert_eq!(defects.aircraft(defect), MOST_AIRCRAFT);
        }
    }
}
