//! Time of alerts and of the bands of all four quantities, for one, five and twenty intruders.

use core::hint::black_box;
use criterion::Criterion;
use fga_alerts::volume::{Volume, WellClear};
use fga_alerts::{
    Aircraft, AircraftId, AircraftState, AlertLevel, AlertSettings, Alerter, HysteresisSettings,
    Monitor, PerManeuver, Region,
};
use glam::DVec3;

const FOOT_M: f64 = 0.3048;
const KNOT_MPS: f64 = 1852.0 / 3600.0;

/// DO-365B en route, with the memory of its configuration.
fn settings() -> AlertSettings {
    let level = |volume, alerting_s, early_alerting_s, region| AlertLevel {
        volume: Volume::WellClear(volume),
        alerting_s,
        early_alerting_s,
        region,
        spread: PerManeuver::default(),
    };
    AlertSettings {
        recovery_distance_m: 0.66 * 1852.0,
        recovery_height_m: 450.0 * FOOT_M,
        shrinks_recovery: true,
        hysteresis: HysteresisSettings {
            memory_s: 5.0,
            persistence_s: 4.0,
            agreeing: 2,
            remembered: 4,
        },
        bands_persist: true,
        ownship_centric: false,
        corrective_region: Region::Mid,
        alerters: vec![Alerter {
            name: "DWC_Phase_I".into(),
            levels: vec![
                level(WellClear::EN_ROUTE_PREVENTIVE, 55.0, 75.0, Region::None),
                level(WellClear::EN_ROUTE, 55.0, 75.0, Region::Mid),
                level(WellClear::EN_ROUTE, 25.0, 55.0, Region::Near),
            ],
        }],
        ..AlertSettings::default()
    }
}

fn aircraft(id: u64, position_m: DVec3, velocity_mps: DVec3) -> Aircraft {
    let state = AircraftState {
        position_m,
        velocity_mps,
    };
    Aircraft::new(AircraftId(id), state)
}

/// An intruder from ahead, `index` of several spread over a quarter of the sky.
fn intruder(index: u64, distance_m: f64) -> Aircraft {
    let from_rad = 0.15 * index as f64;
    let (sin, cos) = from_rad.sin_cos();
    let towards = DVec3::new(-sin, -cos, 0.0);
    let position_m = DVec3::new(300.0, 0.0, 3000.0 + 30.0 * index as f64) - towards * distance_m;
    aircraft(index + 1, position_m, towards * 200.0 * KNOT_MPS)
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let ownship = aircraft(0, DVec3::new(0.0, 0.0, 3000.0), DVec3::Y * 150.0 * KNOT_MPS);
    for (name, distance_m) in [
        ("far, 160 s", 29_000.0),
        ("corrective, 50 s", 9_000.0),
        ("warning, 20 s", 3_600.0),
        ("lost, recovery", 900.0),
    ] {
        for count in [1, 5, 20] {
            let traffic: Vec<Aircraft> = (0..count)
                .map(|index| intruder(index, distance_m))
                .collect();
            let mut monitor = Monitor::new(settings());
            let mut time_s = 0.0;
            criterion.bench_function(&format!("{name}, {count}"), |bencher| {
                bencher.iter(|| {
                    time_s += 1.0;
                    monitor
                        .step(time_s, black_box(&ownship), black_box(&traffic))
                        .map(|()| monitor.highest_level())
                });
            });
        }
    }
    criterion.final_summary();
}
