//! Altitude manoeuvres: accelerate, hold the rate, level out.

use crate::aircraft::AircraftState;
use crate::bands::path::{FlownLine, way_m};
use crate::bands::span::counted;
use crate::settings::AlertSettings;
use alloc::vec::Vec;

/// A line on the way to an altitude, and until when the ownship flies it, seconds; `None` for a moment while the
/// vertical speed changes.
pub(super) type LevelLeg = (FlownLine, Option<f64>);

/// The legs of a climb or descent to an altitude up to the horizon, in the order in which they are flown; while the
/// vertical speed changes each second counts. The settings' vertical rate and acceleration are positive.
pub(super) fn legs_to(
    target_m: f64,
    settings: &AlertSettings,
    ownship: &AircraftState,
    at_once: bool,
) -> Vec<LevelLeg> {
    let (s, v) = (ownship.position_m, ownship.velocity_mps);
    if at_once {
        let line = FlownLine::at(0.0, s.with_z(target_m), v.with_z(0.0));
        return [(line, Some(f64::INFINITY))].into();
    }
    let horizon_s = settings.lookahead_s;
    let mps2 = settings.vertical_acceleration_mps2;
    let mut sign = if target_m >= s.z { 1.0 } else { -1.0 };
    if sign * v.z > 0.0 && sign * (target_m - s.z) < v.z * v.z / (2.0 * mps2) {
        // It comes back from where its climb stops.
        sign = -sign;
    }
    let (to_go_m, climb_mps) = (sign * (target_m - s.z), sign * v.z);
    let rate_mps = settings.vertical_rate_mps.abs().max(climb_mps);
    let changing_m = (rate_mps * rate_mps - 0.5 * climb_mps * climb_mps) / mps2;
    let (rate_mps, hold_s) = if to_go_m >= changing_m {
        (rate_mps, (to_go_m - changing_m) / rate_mps)
    } else {
        // The rate is out of reach.
        let square = mps2 * to_go_m + 0.5 * climb_mps * climb_mps;
        (libm::sqrt(square.max(0.0)), 0.0)
    };
    // The rate is flown between the first two times, the altitude is reached at the third.
    let t1 = (rate_mps - climb_mps) / mps2;
    let t2 = t1 + hold_s;
    let t3 = t2 + rate_mps / mps2;
    let line_at = |time_s: f64| {
        let (accelerating_s, braking_s) = (time_s.min(t1), (time_s - t2).max(0.0));
        let (first_mps2, second_mps2) = (sign * mps2, -sign * mps2);
        let held_s = time_s - accelerating_s - braking_s;
        let held_mps = v.z + first_mps2 * accelerating_s;
        let held_m = way_m(v.z, first_mps2, accelerating_s) + held_mps * held_s;
        let (height_m, climb_mps) = if time_s > t3 {
            (target_m, 0.0)
        } else {
            (
                s.z + held_m + way_m(held_mps, second_mps2, braking_s),
                held_mps + second_mps2 * braking_s,
            )
        };
        let position_m = (s + v * time_s).with_z(height_m);
        FlownLine::at(time_s, position_m, v.with_z(climb_mps))
    };
    if !t3.is_finite() {
        return [(line_at(0.0), Some(f64::INFINITY))].into();
    }
    let level_s = t3 + 1.0;
    let moments = |from_s, to_s| counted(from_s, to_s).map(|time_s| (line_at(time_s), None));
    moments(0.0, libm::floor(t1))
        .chain([(line_at(t1), Some(t2.min(horizon_s)))])
        .chain(moments(libm::ceil(t2), libm::floor(level_s)))
        .chain([(line_at(level_s), Some(horizon_s))])
        .take_while(|(line, _)| line.since_s <= horizon_s)
        .collect()
}
