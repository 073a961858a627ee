//! Configurations of the standards.

use crate::hysteresis::HysteresisSettings;
use crate::quantity::PerManeuver;
use crate::settings::{AlertLevel, AlertSettings, Alerter, Region};
use crate::units::{DEGREE_RAD, FOOT_M, KNOT_MPS, NAUTICAL_MILE_M};
use crate::volume::{Cylinder, Volume, WellClear};
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;

fn level(volume: Volume, alerting_s: f64, early_alerting_s: f64, region: Region) -> AlertLevel {
    AlertLevel {
        volume,
        alerting_s,
        early_alerting_s,
        region,
        spread: PerManeuver::default(),
    }
}

/// Preventive, corrective and warning levels of a well-clear volume.
fn three_levels(name: &str, preventive: WellClear, volume: WellClear, s: [f64; 4]) -> Alerter {
    let [alert_s, early_s, warning_s, early_warning_s] = s;
    Alerter {
        name: String::from(name),
        levels: vec![
            level(
                Volume::WellClear(preventive),
                alert_s,
                early_s,
                Region::None,
            ),
            level(Volume::WellClear(volume), alert_s, early_s, Region::Mid),
            level(
                Volume::WellClear(volume),
                warning_s,
                early_warning_s,
                Region::Near,
            ),
        ],
    }
}

/// RTCA DO-365B without deviations: en route, terminal area and non-cooperative, one alerter each.
pub fn do_365b() -> AlertSettings {
    AlertSettings {
        recovery_distance_m: 0.66 * NAUTICAL_MILE_M,
        recovery_height_m: 450.0 * FOOT_M,
        shrinks_recovery: true,
        hysteresis: HysteresisSettings {
            memory_s: 5.0,
            persistence_s: 4.0,
            agreeing: 2,
            remembered: 4,
        },
        bands_persist: true,
        resolution_persistence: PerManeuver {
            direction: 15.0 * DEGREE_RAD,
            horizontal_speed: 100.0 * KNOT_MPS,
            vertical_speed: 250.0 * FOOT_M / 60.0,
            altitude: 250.0 * FOOT_M,
        },
        ownship_centric: false,
        corrective_region: Region::Mid,
        alerters: vec![
            three_levels(
                "DWC_Phase_I",
                WellClear::EN_ROUTE_PREVENTIVE,
                WellClear::EN_ROUTE,
                [55.0, 75.0, 25.0, 55.0],
            ),
            three_levels(
                "DWC_Phase_II",
                WellClear::TERMINAL,
                WellClear::TERMINAL,
                [45.0, 75.0, 45.0, 75.0],
            ),
            three_levels(
                "DWC_Non_Coop",
                WellClear::NON_COOPERATIVE,
                WellClear::NON_COOPERATIVE,
                [55.0, 110.0, 25.0, 90.0],
            ),
        ],
        ..AlertSettings::default()
    }
}

/// Four levels for small aircraft near the ground, around the volume of ASTM F3442.
///
/// ASTM F3442 names the volume (2,000 ft, 250 ft) and leaves alerting to the system: the four
/// levels are this project's, with their times before the entry into the volume.
///
/// | level | meaning | volume | time |
/// |---|---|---|---|
/// | 1 | traffic: look out | F3442, doubled | 60 s |
/// | 2 | preventive: do not turn into it | F3442 | 45 s |
/// | 3 | corrective: manoeuvre soon | F3442 | 30 s |
/// | 4 | warning: manoeuvre now | F3442 | 15 s |
pub fn f3442() -> AlertSettings {
    let volume = Cylinder::F3442;
    let wide = Cylinder::new(2.0 * volume.radius_m, 2.0 * volume.half_height_m);
    let levels: Vec<AlertLevel> = [
        (wide, 60.0, Region::None),
        (volume, 45.0, Region::Far),
        (volume, 30.0, Region::Mid),
        (volume, 15.0, Region::Near),
    ]
    .into_iter()
    .map(|(cylinder, time_s, region)| {
        level(Volume::Cylinder(cylinder), time_s, time_s + 5.0, region)
    })
    .collect();
    AlertSettings {
        lookahead_s: 90.0,
        recovery_distance_m: volume.radius_m,
        recovery_height_m: volume.half_height_m,
        corrective_region: Region::Mid,
        alerters: vec![Alerter {
            name: String::from("F3442"),
            levels,
        }],
        ..do_365b()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aircraft::{Aircraft, AircraftId, AircraftState};
    use crate::monitor::Monitor;
    use glam::DVec3;

    #[test]
    fn f3442_alerts_level_by_level_as_the_volume_comes_nearer() {
        let at = |id, y_m, speed_mps| {
            let state = AircraftState {
                position_m: DVec3::new(0.0, y_m, 100.0),
                velocity_mps: DVec3::new(0.0, speed_mps, 0.0),
            };
            Aircraft::new(AircraftId(id), state)
        };
        // Head-on at 50 m/s; the aircraft enters the volume at 609.6 m.
        let level_at = |time_s: f64| {
            let mut monitor = Monitor::new(f3442());
            let distance_m = Cylinder::F3442.radius_m + 50.0 * time_s;
            let (own, other) = (at(0, 0.0, 20.0), at(1, distance_m, -30.0));
            monitor.step(0.0, &own, &[other]).unwrap();
            monitor.highest_level()
        };
        assert_eq!(
            [80.0, 50.0, 40.0, 20.0, 10.0].map(level_at),
            [0, 1, 2, 3, 4]
        );
    }
}
