//! Resolutions where every manoeuvre leads into the corrective volume.

use crate::aircraft::AircraftState;
use crate::bands::colors::Colors;
use crate::bands::search::BandSearch;
use crate::picture::Contribution;
use crate::settings::AlertSettings;
use crate::units::FOOT_M;
use crate::volume::{Advisory, Cylinder, Sensitivity};
use alloc::vec::Vec;

/// The result of recovery bands, where every manoeuvre leads into the corrective volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Recovery {
    /// A free manoeuvre exists; no search for recovery.
    NotNeeded,
    /// Not even the NMAC volume is avoidable.
    Impossible {
        /// Number of shrinkings of its distances.
        shrinkings: i32,
    },
    /// Well clear again after a time, at a distance.
    Found {
        /// Time until well clear again, seconds.
        time_s: f64,
        /// Horizontal distance kept meanwhile, metres.
        distance_m: f64,
        /// Vertical distance kept meanwhile, metres.
        height_m: f64,
        /// Number of shrinkings of the distances.
        shrinkings: i32,
    },
}

impl Recovery {
    /// Number of shrinkings; −1 without a search for recovery.
    pub const fn shrinkings(self) -> i32 {
        match self {
            Self::NotNeeded => -1,
            Self::Impossible { shrinkings } | Self::Found { shrinkings, .. } => shrinkings,
        }
    }
}

/// At the default factor this many shrinkings reach the NMAC volume from any distance.
const MOST_SHRINKINGS: usize = 1000;

/// An altitude in the lowest level that has resolution advisories, metres.
const LOWEST_ADVISORY_M: f64 = 1001.0 * FOOT_M;

impl BandSearch<'_> {
    /// Searches the resolutions of a certain conflict with these aircraft, and the conflicts that remain.
    pub(super) fn recover(&self, aircraft: &[Contribution]) -> (Recovery, Colors) {
        let settings = &self.picture.settings;
        let nmac = Cylinder::new(settings.nmac_distance_m, settings.nmac_height_m);
        let past_nmac = self.conflicts(aircraft, Some((nmac, f64::INFINITY)));
        let distances = distances(settings, &self.picture.ownship.state);
        if distances.is_empty() || past_nmac.is_closed() {
            return (Recovery::Impossible { shrinkings: 0 }, past_nmac);
        }
        for (&kept, shrinkings) in distances.iter().zip(0..) {
            if self
                .conflicts(aircraft, Some((kept, f64::INFINITY)))
                .is_closed()
            {
                continue;
            }
            let (time_s, ways_out) = self.way_back(aircraft, kept);
            if !ways_out.is_closed() {
                let found = Recovery::Found {
                    time_s,
                    distance_m: kept.radius_m,
                    height_m: kept.half_height_m,
                    shrinkings,
                };
                return (found, ways_out);
            }
        }
        let most = i32::try_from(distances.len()).unwrap_or(i32::MAX);
        let shrinkings = if settings.shrinks_recovery { most } else { 0 };
        (
            Recovery::Impossible { shrinkings },
            Colors::closed(self.span),
        )
    }

    /// The earliest time, to half a second, after which well clear is possible again, and the conflicts with the
    /// cylinder until then and with each aircraft's own volume afterwards.
    fn way_back(&self, aircraft: &[Contribution], kept: Cylinder) -> (f64, Colors) {
        let settings = &self.picture.settings;
        let conflicts = |change_s| self.conflicts(aircraft, Some((kept, change_s)));
        let (mut blocked_s, mut open_s) = (0.0, settings.lookahead_s + 1.0);
        let mut tried_s = open_s - 1.0;
        while open_s - blocked_s > 0.5 {
            if conflicts(tried_s).is_closed() {
                blocked_s = tried_s;
            } else {
                open_s = tried_s;
            }
            tried_s = f64::midpoint(blocked_s, open_s);
        }
        let time_s = if open_s <= settings.lookahead_s {
            settings
                .lookahead_s
                .min(open_s + settings.recovery_stability_s)
        } else {
            blocked_s
        };
        (time_s, conflicts(time_s))
    }
}

/// The distances of recovery, as they shrink down to the NMAC volume.
fn distances(settings: &AlertSettings, ownship: &AircraftState) -> Vec<Cylinder> {
    let (radius_m, half_height_m) = (settings.nmac_distance_m, settings.nmac_height_m);
    let factor = 1.0 - settings.recovery_shrinking;
    let shrink = |kept: &Cylinder| {
        Some(Cylinder::new(
            radius_m.max(kept.radius_m * factor),
            half_height_m.max(kept.half_height_m * factor),
        ))
    };
    // Shrinking by a factor of zero never ends by itself.
    let most = if settings.shrinks_recovery {
        MOST_SHRINKINGS
    } else {
        1
    };
    core::iter::successors(Some(least_recovery(settings, ownship)), shrink)
        .take_while(|kept| kept.radius_m > radius_m || kept.half_height_m > half_height_m)
        .take(most)
        .collect()
}

/// The first distances of recovery.
fn least_recovery(settings: &AlertSettings, ownship: &AircraftState) -> Cylinder {
    let or_table = |value_m: f64, pick: fn(&Sensitivity) -> f64| {
        if value_m > 0.0 {
            return value_m;
        }
        // Below the third sensitivity level there are no resolution advisories.
        let altitude_m = ownship.position_m.z.max(LOWEST_ADVISORY_M);
        Advisory::resolution().at(altitude_m).map_or(0.0, pick)
    };
    Cylinder::new(
        or_table(settings.recovery_distance_m, |level| level.miss_distance_m),
        or_table(settings.recovery_height_m, |level| level.height_m),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aircraft::{Aircraft, AircraftId};
    use crate::monitor::Monitor;
    use crate::quantity::Quantity;
    use crate::schemes::{do_365b, f3442};
    use crate::settings::Region;
    use glam::DVec3;

    #[test]
    fn recovery_begins_with_directions_behind_that_two_steps_share() {
        let at = |id, x, y, z, vx, vy, vz| {
            let state = AircraftState {
                position_m: DVec3::new(x, y, z),
                velocity_mps: DVec3::new(vx, vy, vz),
            };
            Aircraft::new(AircraftId(id), state)
        };
        let ownship = at(0, 0.0, 0.0, 2330.34, -13.8835, -48.0338, 0.0);
        let traffic = [
            at(1, -700.7271, -1484.7791, 2320.941, -16.0021, 16.5884, 0.0),
            at(
                2, 1361.4174, 2512.1054, 2161.9515, -0.8488, -118.2535, 7.8859,
            ),
        ];
        // 333 steps to either side pass half a turn by 0.007 degrees, which is within the tolerance of an edge.
        let settings = AlertSettings {
            direction_step_rad: 0.540_561_756_f64.to_radians(),
            shrinks_recovery: false,
            alerters: do_365b().alerters,
            ..f3442()
        };
        let mut monitor = Monitor::new(settings);
        monitor.step(0.0, &ownship, &traffic).unwrap();
        let bands = monitor.bands(Quantity::Direction);
        let Recovery::Found { time_s, .. } = bands.recovery() else {
            panic!("{:?}", bands.recovery());
        };
        let behind_rad = ownship.state.direction_rad() - core::f64::consts::PI;
        assert_eq!(bands.region_at(behind_rad), Some(Region::Recovery));
        assert!((time_s - 21.6).abs() < 0.5, "{time_s}");
    }
}
