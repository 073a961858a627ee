//! The ownship's path during a manoeuvre, and its straight line afterwards.
//!
//! A manoeuvre consists of steps of its quantity: after each step the ownship may fly straight.
//! Source: Narkawicz, Muñoz, Dutle, "Coordination Logic for Repulsive Resolution
//! Maneuvers", and Muñoz et al., "DAIDALUS: Detect and Avoid Alerting Logic for Unmanned
//! Systems", DASC 2015.

use crate::aircraft::AircraftState;
use crate::bands::span::{BandSpan, counted, turning_speed_mps};
use crate::quantity::Quantity;
use crate::settings::AlertSettings;
use alloc::vec::Vec;
use glam::DVec3;

/// A straight line of the ownship from a time on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FlownLine {
    /// Start of the line, seconds from now.
    pub(crate) since_s: f64,
    /// Its state on the line, extrapolated back to now.
    pub(crate) state: AircraftState,
}

impl FlownLine {
    /// The line of a state at a time.
    pub(super) fn at(since_s: f64, position_m: DVec3, velocity_mps: DVec3) -> Self {
        Self {
            since_s,
            state: AircraftState {
                position_m: position_m - velocity_mps * since_s,
                velocity_mps,
            },
        }
    }
}

/// The lines after each step of a turn or a change of speed, from the current value to either side, and the time of one
/// step, seconds; 0 for a manoeuvre that takes none.
pub(super) fn steps(
    settings: &AlertSettings,
    ownship: &AircraftState,
    span: &BandSpan,
) -> ([Vec<FlownLine>; 2], f64) {
    let mut start = *ownship;
    if span.quantity == Quantity::Direction {
        start.velocity_mps = with_speed(ownship, turning_speed_mps(settings, ownship));
    }
    let step_s = if span.at_once {
        0.0
    } else {
        span.step / span.quantity.rate(settings, ownship)
    };
    let line = |count: f64, side: f64| {
        let (change, time_s) = (side * count * span.step, count * step_s);
        let (position_m, velocity_mps) = match span.quantity {
            _ if count == 0.0 => (start.position_m, start.velocity_mps),
            Quantity::Direction => turned(&start, change, time_s),
            Quantity::HorizontalSpeed => {
                let along_mps2 = side * settings.horizontal_acceleration_mps2;
                accelerated(&start, change, time_s, along_mps2)
            }
            _ => climbing(
                &start,
                change,
                time_s,
                side * settings.vertical_acceleration_mps2,
            ),
        };
        FlownLine::at(time_s, position_m, velocity_mps)
    };
    let down = counted(0.0, -span.first).map(|count| line(count, -1.0));
    let up = counted(0.0, span.last).map(|count| line(count, 1.0));
    ([down.collect(), up.collect()], step_s)
}

/// The velocity with another horizontal speed; north without a direction.
fn with_speed(state: &AircraftState, speed_mps: f64) -> DVec3 {
    let (v, now_mps) = (state.velocity_mps, state.speed_mps());
    if now_mps > 0.0 {
        let factor = speed_mps / now_mps;
        DVec3::new(v.x * factor, v.y * factor, v.z)
    } else {
        DVec3::new(0.0, speed_mps, v.z)
    }
}

/// Position and velocity after a turn; right turns are clockwise from above.
fn turned(start: &AircraftState, turn_rad: f64, time_s: f64) -> (DVec3, DVec3) {
    let (s, v) = (start.position_m, start.velocity_mps);
    let (sin, cos) = libm::sincos(turn_rad);
    let velocity_mps = DVec3::new(v.x * cos + v.y * sin, v.y * cos - v.x * sin, v.z);
    let rate = turn_rad / time_s;
    let position_m = DVec3::new(
        s.x + (v.y - velocity_mps.y) / rate,
        s.y + (velocity_mps.x - v.x) / rate,
        s.z + v.z * time_s,
    );
    (position_m, velocity_mps)
}

/// Position and velocity after an acceleration along the flight. No aircraft flies backwards: such a line has no
/// velocity and meets nothing.
fn accelerated(start: &AircraftState, change_mps: f64, time_s: f64, mps2: f64) -> (DVec3, DVec3) {
    let (s, v, now_mps) = (start.position_m, start.velocity_mps, start.speed_mps());
    if now_mps + change_mps < 0.0 {
        return (s, DVec3::NAN);
    }
    let ahead = if now_mps > 0.0 { v / now_mps } else { DVec3::Y };
    let along_m = way_m(now_mps, mps2, time_s);
    let position_m = (s + ahead * along_m).with_z(s.z + v.z * time_s);
    (position_m, with_speed(start, now_mps + change_mps))
}

/// Position and velocity after a change of the vertical speed.
fn climbing(start: &AircraftState, change_mps: f64, time_s: f64, mps2: f64) -> (DVec3, DVec3) {
    let (s, v) = (start.position_m, start.velocity_mps);
    let climbed_m = way_m(v.z, mps2, time_s);
    let position_m = (s + v * time_s).with_z(s.z + climbed_m);
    (position_m, v.with_z(v.z + change_mps))
}

/// Distance during an acceleration, metres.
pub(super) fn way_m(speed_mps: f64, mps2: f64, time_s: f64) -> f64 {
    speed_mps * time_s + 0.5 * mps2 * time_s * time_s
}
