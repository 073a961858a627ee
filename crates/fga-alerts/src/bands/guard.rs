//! When the ownship's lines meet the volumes of one intruder.

use crate::aircraft::Pair;
use crate::bands::path::FlownLine;
use crate::settings::AlertSettings;
use crate::volume::Volume;

/// What the ownship stays out of.
pub(super) struct Guard<'a> {
    settings: &'a AlertSettings,
    /// The intruder, and the ownship as it flies now.
    pair: &'a Pair,
    /// Volumes, and between which times each of them counts, seconds.
    volumes: [(&'a Volume, f64, f64); 2],
    /// Until when lines are looked at, seconds; a manoeuvre's own time comes on top unless the settings count it.
    until_s: f64,
}

impl<'a> Guard<'a> {
    /// A volume; in recovery `kept` instead until a time, for good where that comes after `until_s`.
    pub(super) fn new(
        settings: &'a AlertSettings,
        pair: &'a Pair,
        volume: &'a Volume,
        kept: Option<&'a (Volume, f64)>,
        until_s: f64,
    ) -> Self {
        let (first, change_s) = match kept {
            None => (volume, f64::INFINITY),
            Some((kept, time_s)) if *time_s > until_s => (kept, f64::INFINITY),
            Some((kept, time_s)) => (kept, *time_s),
        };
        Self {
            settings,
            pair,
            volumes: [(first, 0.0, change_s), (volume, change_s, f64::INFINITY)],
            until_s,
        }
    }

    /// Whether the ownship meets a volume on a line between two times, the same one for a moment.
    fn meets(&self, volume: &Volume, line: &FlownLine, from_s: f64, to_s: f64) -> bool {
        let pair = Pair {
            ownship: line.state,
            ..*self.pair
        };
        line.state.is_finite() && volume.conflicts(&pair, from_s, to_s)
    }

    /// Whether the ownship meets a volume in the first seconds of a line, in the course of its manoeuvre.
    pub(super) fn stops(&self, line: &FlownLine, coast_s: f64) -> bool {
        let since_s = line.since_s;
        since_s < self.settings.lookahead_s
            && self.volumes.iter().any(|&(volume, from_s, to_s)| {
                (from_s..=to_s).contains(&since_s)
                    && self.meets(volume, line, since_s, since_s + coast_s)
            })
    }

    /// Whether the ownship meets a volume on a line that it flies until a time or the horizon.
    pub(super) fn blocks(&self, line: &FlownLine, until_s: f64) -> bool {
        let mut horizon_s = self.until_s;
        if !self.settings.counts_maneuver_time {
            horizon_s += line.since_s;
        }
        let end_s = horizon_s.min(until_s).min(self.settings.lookahead_s);
        self.volumes.iter().any(|&(volume, from_s, to_s)| {
            self.meets(volume, line, from_s.max(line.since_s), to_s.min(end_s))
        })
    }
}
