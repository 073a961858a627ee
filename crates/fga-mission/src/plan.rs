//! The line of the mission without obstacles.

use crate::Progress;
use fga_proof::Vec3;
use fga_proof::prediction::{Flyer, MotionState, for_each_piece};
use fga_proof::situation::{Mission, Ownship};
use fga_proof::vehicle::Vehicle;

/// Most steps of a planned line.
const MOST_STEPS: u32 = 2_000_000;

/// Flies a mission without obstacles and shows every position on the way: over the ground, metres,
/// about `spacing_m` apart. Returns whether it passed the last waypoint within `limit_s`.
///
/// Legs, corners and turns round come from [`Progress`], so the line is the same for every
/// caller.
pub fn planned_line(
    mission: &Mission<'_>,
    start: &Ownship,
    vehicle: &Vehicle,
    wind_mps: Vec3,
    (spacing_m, limit_s): (f64, f64),
    mut visit: impl FnMut(Vec3),
) -> bool {
    let flyer = Flyer::new(vehicle);
    let climb_limits_rad = (vehicle.climb_min_rad, vehicle.climb_max_rad);
    let step_s = spacing_m / vehicle.airspeed_mps;
    let mut progress = Progress::new();
    let mut state = MotionState::of(start);
    visit(state.position_m);
    for step in 0..MOST_STEPS {
        let time_s = f64::from(step) * step_s;
        progress.update(
            mission,
            &state,
            &flyer,
            wind_mps,
            (time_s, climb_limits_rad),
        );
        if progress.is_complete() {
            return true;
        }
        if time_s >= limit_s {
            break;
        }
        let (maneuver, _) = progress.guidance(mission, &state, &flyer, 2.0 * step_s);
        state = for_each_piece(&flyer, &state, &maneuver, step_s, |_, _, _| ());
        state.position_m += wind_mps * step_s;
        state.time_s = 0.0;
        visit(state.position_m);
    }
    false
}
