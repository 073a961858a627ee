//! A trained operator who follows the direction bands of a detect-and-avoid display.
//!
//! Once a second the operator looks at alerts and bands. When a corrective alert has lasted for the
//! response delay, the aircraft turns to the edge of the band on the preferred side and a buffer
//! beyond it, level, at the vehicle's bank. It keeps the direction until bands cover it, and leaves it
//! when the alert is over and the mission's direction is free of bands. The volumes come from the
//! standard, whatever the vehicle file protects. The operator changes only the direction, because that
//! is what a remote pilot usually has clearance for.

use core::f64::consts::{PI, TAU};

use fga::Vec3;
use fga::angle::wrap_pi;
use fga_alerts::{
    Aircraft, AircraftId, AircraftState, AlertSettings, ManeuverSide, Monitor, Quantity, Region,
    Resolution, schemes,
};

use super::{Steering, View};

/// From the corrective alert to the first turn, seconds: the delay in trials with operators who
/// coordinate nothing (DO-365 assumes 5 s for a warning).
const RESPONSE_S: f64 = 5.0;

/// How far beyond the edge of a band the operator turns, radians.
const BUFFER_RAD: f64 = 5.0 * PI / 180.0;

/// Time between two looks at the display, seconds.
const LOOK_S: f64 = 1.0;

/// The volumes and times of the display.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Display {
    /// ASTM F3442, four levels.
    F3442,
    /// DO-365B, en route.
    Do365,
}

impl Display {
    fn settings(self, turn_rate_radps: f64) -> AlertSettings {
        let settings = match self {
            Self::F3442 => schemes::f3442(),
            Self::Do365 => schemes::do_365b(),
        };
        AlertSettings {
            turn_rate_radps,
            ..settings
        }
    }
}

/// The operator.
#[derive(Debug)]
pub struct Operator {
    display: Display,
    monitor: Option<Monitor>,
    time_s: f64,
    next_look_s: f64,
    /// Start of the corrective alert, seconds.
    alerted_s: Option<f64>,
    /// The direction flown, radians clockwise from north.
    target_rad: Option<f64>,
}

impl Operator {
    /// An operator who has seen nothing yet.
    pub const fn new(display: Display) -> Self {
        Self {
            display,
            monitor: None,
            time_s: 0.0,
            next_look_s: 0.0,
            alerted_s: None,
            target_rad: None,
        }
    }

    /// Looks at the display.
    fn look(&mut self, view: &View<'_>) {
        let turn_rate_radps = view.vehicle.airspeed_mps / view.vehicle.turn_radius_m;
        let (display, time_s) = (self.display, self.time_s);
        let monitor = self
            .monitor
            .get_or_insert_with(|| Monitor::new(display.settings(turn_rate_radps)));
        let ownship = Aircraft::new(
            AircraftId(u64::MAX),
            AircraftState {
                position_m: Vec3::ZERO,
                velocity_mps: view.velocity_mps,
            },
        );
        let traffic: Vec<Aircraft> = view
            .spheres
            .iter()
            .map(|sphere| {
                Aircraft::new(
                    AircraftId(sphere.id.into()),
                    AircraftState {
                        position_m: sphere.offset_m,
                        velocity_mps: sphere.velocity_mps,
                    },
                )
            })
            .collect();
        // Obstacles were checked: a refused state means no alert.
        let shown = [Quantity::Direction];
        if monitor
            .step_for(&shown, time_s, &ownship, &traffic)
            .is_err()
        {
            return;
        }
        let corrective = monitor.settings().corrective_level(0).unwrap_or(1);
        let bands = monitor.bands(Quantity::Direction);
        let is_covered = |compass_rad: f64| {
            matches!(
                bands.region_at(compass_rad),
                Some(Region::Mid | Region::Near)
            )
        };
        if monitor.highest_level() < corrective {
            self.alerted_s = None;
            if !is_covered(compass_rad(view.preferred_mps)) {
                self.target_rad = None;
            } else if let Some(target_rad) = self.target_rad
                && is_covered(target_rad)
            {
                self.target_rad = turned(bands.preferred(), bands.resolution(bands.preferred()));
            }
            return;
        }
        let since_s = *self.alerted_s.get_or_insert(time_s);
        let responds = self.target_rad.is_some() || time_s - since_s >= RESPONSE_S;
        if responds && self.target_rad.is_none_or(is_covered) {
            let preferred = bands.preferred();
            let other = match preferred {
                ManeuverSide::Low => ManeuverSide::High,
                ManeuverSide::High => ManeuverSide::Low,
            };
            // Without a way out on either side the operator keeps the direction.
            self.target_rad = turned(preferred, bands.resolution(preferred))
                .or_else(|| turned(other, bands.resolution(other)))
                .or(self.target_rad);
        }
    }
}

/// A resolution with the buffer.
fn turned(way: ManeuverSide, resolution: Resolution) -> Option<f64> {
    let Resolution::Value(edge_rad) = resolution else {
        return None;
    };
    let buffer_rad = match way {
        ManeuverSide::Low => -BUFFER_RAD,
        ManeuverSide::High => BUFFER_RAD,
    };
    Some(libm::fmod(edge_rad + buffer_rad + TAU, TAU))
}

/// Direction of a velocity, radians clockwise from north, in `[0, 2π)`.
fn compass_rad(velocity_mps: Vec3) -> f64 {
    let compass_rad = wrap_pi(libm::atan2(velocity_mps.x, velocity_mps.y));
    if compass_rad < 0.0 {
        compass_rad + TAU
    } else {
        compass_rad
    }
}

impl Steering for Operator {
    fn restart(&mut self) {
        *self = Self::new(self.display);
    }

    fn steer(&mut self, view: &View<'_>) -> Option<Vec3> {
        if self.time_s >= self.next_look_s - 1e-9 {
            self.next_look_s = self.time_s + LOOK_S;
            self.look(view);
        }
        self.time_s += view.period_s;
        let (sin, cos) = libm::sincos(self.target_rad?);
        Some(Vec3::new(sin, cos, 0.0) * view.speed_mps())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::{RelativeRoute, Sphere};
    use fga::vehicle::Vehicle;

    fn view<'a>(spheres: &'a [Sphere], vehicle: &'a Vehicle) -> View<'a> {
        View {
            velocity_mps: Vec3::X * 50.0,
            preferred_mps: Vec3::X * 50.0,
            route: RelativeRoute {
                foot_m: Vec3::ZERO,
                along: Vec3::X,
            },
            spheres,
            vehicle,
            period_s: 1.0,
        }
    }

    #[test]
    fn the_operator_turns_after_the_delay_to_the_edge_of_the_band_and_back_when_it_is_over() {
        let vehicle = Vehicle {
            airspeed_mps: 50.0,
            ..Vehicle::table_4()
        };
        let mut operator = Operator::new(Display::F3442);
        let head_on = |distance_m: f64| {
            [Sphere {
                id: 3,
                offset_m: Vec3::new(distance_m, -100.0, 0.0),
                velocity_mps: Vec3::X * -50.0,
                radius_m: 600.0,
            }]
        };
        // The corrective level of F3442 begins 30 s before the volume: 3,610 m at 100 m/s.
        assert_eq!(operator.steer(&view(&head_on(6000.0), &vehicle)), None);
        let mut first = None;
        for second in 0..8 {
            let spheres = head_on(3500.0 - 100.0 * f64::from(second));
            if operator.steer(&view(&spheres, &vehicle)).is_some() {
                first.get_or_insert(second);
            }
        }
        // Two looks of four must agree: the alert stands from the second one on, 1 s, then come 5 s.
        assert_eq!(first, Some(6));
        let velocity = operator.steer(&view(&head_on(2700.0), &vehicle)).unwrap();
        // The intruder passes on the right: the nearer edge is on the left.
        assert!(velocity.y > 0.0 && velocity.z == 0.0, "{velocity}");
        for _ in 0..12 {
            operator.steer(&view(&[], &vehicle));
        }
        assert_eq!(operator.steer(&view(&[], &vehicle)), None);
    }
}
