//! Altitude manoeuvres: accelerate, hold the rate, level out.

use crate::aircraft::State;
use crate::bands::guard::Guard;
use crate::bands::path::{FlownLine, way_m};
use crate::settings::Settings;
use alloc::vec::Vec;

/// A line on the way to an altitude.
#[derive(PartialEq)]
pub(crate) struct LevelLeg {
    line: FlownLine,
    /// Until when the ownship flies it, seconds; `None` for a moment while the vertical speed changes.
    until_s: Option<f64>,
}

impl LevelLeg {
    /// The line of an altitude that is reached at once.
    pub(super) fn at_once(target_m: f64, ownship: &State) -> Self {
        let (s, v) = (ownship.position_m, ownship.velocity_mps);
        let line = FlownLine::at(0.0, s.with_z(target_m), v.with_z(0.0));
        let until_s = Some(f64::INFINITY);
        Self { line, until_s }
    }

    /// Whether the ownship meets a volume on it.
    pub(super) fn is_blocked(&self, guard: &Guard) -> bool {
        match self.until_s {
            None => guard.stops(&self.line, 0.0),
            Some(until_s) => guard.blocks(&self.line, until_s),
        }
    }
}

/// The legs of a climb or descent to an altitude up to the horizon, in the order in which they are flown; while the
/// vertical speed changes each second counts. The settings' vertical rate and acceleration are positive.
pub(super) fn legs_to(target_m: f64, settings: &Settings, ownship: &State) -> Vec<LevelLeg> {
    let (s, v) = (ownship.position_m, ownship.velocity_mps);
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
    let flown = |since_s, until_s| LevelLeg {
        line: line_at(since_s),
        until_s,
    };
    if !t3.is_finite() {
        return [flown(0.0, Some(f64::INFINITY))].into();
    }
    let level_s = t3 + 1.0;
    let first = seconds(0.0, libm::floor(t1)).map(|time_s| flown(time_s, None));
    let second = seconds(libm::ceil(t2), libm::floor(level_s)).map(|time_s| flown(time_s, None));
    first
        .chain([flown(t1, Some(t2.min(horizon_s)))])
        .chain(second)
        .chain([flown(level_s, Some(horizon_s))])
        .take_while(|leg| leg.line.since_s <= horizon_s)
        .collect()
}

/// Whole seconds from one to another.
fn seconds(first_s: f64, last_s: f64) -> impl Iterator<Item = f64> {
    core::iter::successors(Some(first_s), |second_s| Some(second_s + 1.0))
        .take_while(move |second_s| *second_s <= last_s)
}
