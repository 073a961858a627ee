//! Turns for the tree, flown once in the frame of their beginning.

use super::flight::OracleFlight;
use super::{OracleManeuver, OracleStart, OracleVehicle};

/// A point on the way from the present climb angle to the commanded one, on a straight course:
/// time, distance along the course and height since its beginning.
#[derive(Clone, Copy, Default)]
pub(super) struct Rise {
    pub(super) time_s: f64,
    pub(super) along: f64,
    pub(super) up: f64,
}

/// The continuation of a turn that ends at this node.
#[derive(Clone, Copy)]
pub(super) struct ArcNode {
    pub(super) time_s: f64,
    pub(super) along: f64,
    pub(super) left: f64,
    pub(super) up: f64,
    pub(super) cos: f64,
    pub(super) sin: f64,
    pub(super) turned_rad: f64,
    /// The way to the commanded climb angle, where it is not there.
    pub(super) rises: Option<[Rise; 4]>,
    /// Climb angle at this node.
    pub(super) climb_rad: f64,
}

/// A left turn in the frame of its beginning, with a change of climb angle.
pub(super) struct TurnArc {
    pub(super) nodes: Vec<ArcNode>,
    pub(super) target: f64,
    pub(super) speed_along: f64,
    pub(super) speed_up: f64,
}

impl TurnArc {
    pub(super) fn new(vehicle: &OracleVehicle, from: f64, target: f64, turns: &[f64]) -> Self {
        let start = OracleStart {
            climb_rad: from,
            ..OracleStart::ORIGIN
        };
        let ideal = OracleVehicle {
            dead_time_s: 0.0,
            bank_time_constant_s: 0.0,
            climb_min_rad: vehicle.climb_min_rad.min(from),
            climb_max_rad: vehicle.climb_max_rad.max(from),
            ..*vehicle
        };
        let (sin_target, cos_target) = libm::sincos(target);
        let last = turns.last().copied().unwrap_or(0.0);
        let turning = OracleFlight::new(
            &start,
            &ideal,
            &OracleManeuver {
                turn1_rad: last + 1e-9,
                climb1_rad: target,
                climb2_rad: target,
                ..OracleManeuver::default()
            },
            last / ideal.course_rate_radps,
        );
        let nodes = turns
            .iter()
            .map(|&turned_rad| {
                let time_s = turned_rad / ideal.course_rate_radps;
                let at = turning.at(time_s);
                let (sin, cos) = libm::sincos(turned_rad);
                let mut node = ArcNode {
                    time_s,
                    along: at.position_m.x,
                    left: at.position_m.y,
                    up: at.position_m.z,
                    cos,
                    sin,
                    turned_rad,
                    rises: None,
                    climb_rad: at.climb_rad,
                };
                node.rise(&ideal, target);
                node
            })
            .collect();
        Self {
            nodes,
            target,
            speed_along: vehicle.airspeed_mps * cos_target,
            speed_up: vehicle.airspeed_mps * sin_target,
        }
    }
}

impl ArcNode {
    pub(super) fn rise(&mut self, vehicle: &OracleVehicle, target: f64) {
        let difference = target - self.climb_rad;
        if difference.abs() < 1e-6 || !vehicle.can_climb() {
            return;
        }
        let whole_s = difference.abs() / vehicle.climb_rate_radps;
        let flight = OracleFlight::new(
            &OracleStart {
                climb_rad: self.climb_rad,
                ..OracleStart::ORIGIN
            },
            vehicle,
            &OracleManeuver {
                climb1_rad: target,
                climb2_rad: target,
                ..OracleManeuver::default()
            },
            whole_s,
        );
        self.rises = Some([0.25, 0.5, 0.75, 1.0].map(|share| {
            let time_s = whole_s * share;
            let at = flight.at(time_s);
            Rise {
                time_s,
                along: at.position_m.x,
                up: at.position_m.z,
            }
        }));
    }

    /// Distance along the course and height `after_s` after the turn ended here.
    pub(super) fn after(&self, arc: &TurnArc, after_s: f64) -> (f64, f64) {
        let mut from = Rise::default();
        for rise in self.rises.iter().flatten() {
            if after_s <= rise.time_s {
                let s = (after_s - from.time_s) / (rise.time_s - from.time_s);
                return (
                    from.along + (rise.along - from.along) * s,
                    from.up + (rise.up - from.up) * s,
                );
            }
            from = *rise;
        }
        let left_s = after_s - from.time_s;
        (
            from.along + arc.speed_along * left_s,
            from.up + arc.speed_up * left_s,
        )
    }

    pub(super) fn climb_after(&self, vehicle: &OracleVehicle, target: f64, after_s: f64) -> f64 {
        let most = vehicle.climb_rate_radps * after_s;
        self.climb_rad + (target - self.climb_rad).clamp(-most, most)
    }
}
