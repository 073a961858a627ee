//! Routes, for tests.

use crate::{Route, Turner};
use fga_proof::Vec3;
use fga_proof::meter::Meter;
use fga_proof::situation::Mission;
use fga_proof::vehicle::Vehicle;

/// Shows the route of a vehicle in a wind along a mission.
pub(crate) fn along<T>(
    vehicle: &Vehicle,
    wind_mps: Vec3,
    mission: &Mission<'_>,
    look: impl FnOnce(&Route<'_>) -> T,
) -> T {
    look(&Route {
        mission,
        flyer: &Turner::new(vehicle),
        wind_mps,
        climb_limits_rad: (vehicle.climb_min_rad, vehicle.climb_max_rad),
        meter: &Meter::unlimited(),
    })
}

/// The same of the vehicle of Table 4 in still air: 15 m/s, 30 m.
pub(crate) fn table_4<T>(waypoints_m: &[(f64, f64)], look: impl FnOnce(&Route<'_>) -> T) -> T {
    let waypoints_m: alloc::vec::Vec<Vec3> = waypoints_m
        .iter()
        .map(|(x, y)| Vec3::new(*x, *y, 0.0))
        .collect();
    let mission = Mission::new(&waypoints_m);
    along(&Vehicle::table_4(), Vec3::ZERO, &mission, look)
}
