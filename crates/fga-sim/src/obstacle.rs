//! Obstacles as they really are, and the reports about them.

use fga::Vec3;
use fga::situation::{Movement, ObstacleKind, ProtectedVolume, Uncertainty};

use crate::track::Track;

/// An obstacle as it really is.
#[derive(Debug, Clone, PartialEq)]
pub struct WorldObstacle {
    /// Identifier for the avoider, unique within the world.
    pub id: u32,
    /// Its true motion.
    pub track: Track,
    /// The protected volume.
    pub volume: ProtectedVolume,
    /// Its nature.
    pub kind: ObstacleKind,
    /// The avoider's expectation of its motion.
    pub movement: Movement,
    /// The reports about it, times increasing; empty if the aircraft sees its true motion.
    pub reports: Vec<TrackReport>,
    /// σ of each component of its position on the chart, metres, for an obstacle that the aircraft knows from a chart; the
    /// sensor's errors and limits do not concern it.
    pub charted_sigma_m: Option<f64>,
    /// The aircraft does not see it before this time, seconds.
    pub appears_s: f64,
    /// The aircraft does not see it before it first comes within this distance, metres; then it stays known.
    pub first_seen_m: Option<f64>,
}

impl WorldObstacle {
    /// An obstacle of no particular kind that keeps its velocity, known from the start.
    pub const fn new(id: u32, track: Track, volume: ProtectedVolume) -> Self {
        Self {
            id,
            track,
            volume,
            kind: ObstacleKind::Unknown,
            movement: Movement::Straight,
            reports: Vec::new(),
            charted_sigma_m: None,
            appears_s: 0.0,
            first_seen_m: None,
        }
    }
}

/// A row of a recording, as a report.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackReport {
    /// Seconds since the start of the run.
    pub time_s: f64,
    /// Position then, metres.
    pub position_m: Vec3,
    /// Velocity over the ground then, metres per second.
    pub velocity_mps: Vec3,
    /// Standard deviations of both.
    pub uncertainty: Uncertainty,
    /// How long it has been carried on in a straight line, seconds.
    pub age_s: f64,
}

impl TrackReport {
    /// The report carried on in a straight line for a time, seconds.
    #[must_use]
    pub fn carried_on(&self, for_s: f64) -> Self {
        let Uncertainty {
            position_m,
            velocity_mps,
        } = self.uncertainty;
        Self {
            time_s: self.time_s + for_s,
            age_s: self.age_s + for_s,
            position_m: self.position_m + self.velocity_mps * for_s,
            uncertainty: Uncertainty {
                position_m: position_m + velocity_mps * for_s,
                velocity_mps,
            },
            ..*self
        }
    }
}

/// A report is extrapolated in a straight line for this long, seconds; then the obstacle is missing
/// until its next report.
pub(crate) const CARRIED_ON_S: f64 = 2.0;

impl WorldObstacle {
    /// What is known of it at a time; `None` if unknown.
    ///
    /// Later reports do not count; after the last report the obstacle is gone.
    pub fn known_at(&self, time_s: f64) -> Option<TrackReport> {
        if self.reports.is_empty() {
            let (position_m, velocity_mps) = self.track.at(time_s)?;
            return Some(TrackReport {
                time_s,
                position_m,
                velocity_mps,
                uncertainty: Uncertainty::default(),
                age_s: 0.0,
            });
        }
        let heard = self.reports.partition_point(|r| r.time_s <= time_s + 1e-9);
        let last = self.reports.get(heard.checked_sub(1)?)?;
        // A decision on a row's time may come before it by a rounding: an age below zero would be no obstacle.
        let since_s = (time_s - last.time_s).max(0.0);
        let is_gone = heard == self.reports.len() && since_s > 1e-9;
        (!is_gone && since_s <= CARRIED_ON_S).then(|| last.carried_on(since_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga::situation::ProtectedVolume;

    #[test]
    fn a_report_a_rounding_ahead_is_known_and_has_no_age() {
        let report = |time_s: f64| TrackReport {
            time_s,
            position_m: Vec3::X,
            velocity_mps: Vec3::Y,
            uncertainty: Uncertainty {
                position_m: 0.0,
                velocity_mps: 1.0,
            },
            age_s: 0.0,
        };
        let volume = ProtectedVolume::Sphere { radius_m: 1.0 };
        let mut aircraft = WorldObstacle::new(1, Track::straight(Vec3::X, Vec3::Y), volume);
        aircraft.reports = vec![report(0.0), report(124.6), report(125.1)];
        for before_s in [0.0, 1e-12, 5e-10] {
            let known = aircraft.known_at(124.6 - before_s).unwrap();
            assert_eq!((known.age_s, known.uncertainty.position_m), (0.0, 0.0));
        }
        assert!((aircraft.known_at(124.9).unwrap().age_s - 0.3).abs() < 1e-9);
    }
}
