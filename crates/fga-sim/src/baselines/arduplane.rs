//! Avoidance by the documented rules of ArduPlane's `AVD_` parameters, re-thought; no code of it, and no autopilot around it.
//!
//! Ten times a second an aircraft is a threat of level high if, with both velocities kept for `AVD_F_TIME`, it comes within `AVD_F_DIST_XY` and
//! `AVD_F_DIST_Z`. Of several the one with the earliest closest approach counts. The action is `AVD_F_ACTION` 3, move
//! horizontally: away from the other one's line of flight, at right angles to it, or straight away from what does not move. The threat ends at the earliest 2 s
//! after it began, and the mission goes on (`AVD_F_RCVRY`).

use fga::Vec3;

use super::Steering;
use super::view::{Sphere, View};

/// `AVD_F_TIME` of ArduPlane, seconds.
const TIME_S: f64 = 30.0;

/// `AVD_F_DIST_Z` of ArduPlane, metres. `AVD_F_DIST_XY` is the protected radius here.
const HEIGHT_M: f64 = 100.0;

/// A threat ends at the earliest this long after the last change, seconds.
const CHANGE_S: f64 = 2.0;

/// A slower obstacle does not move, metres per second.
const STANDS_MPS: f64 = 1.0;

/// The state of the avoidance.
#[derive(Debug, Default)]
pub struct ArduPlaneRules {
    time_s: f64,
    /// Start of the threat, seconds, and the direction away from it.
    away: Option<(f64, Vec3)>,
}

/// Time of the closest approach of a threat of level high, seconds.
fn high(sphere: &Sphere, own_mps: Vec3) -> Option<f64> {
    let relative_mps = sphere.velocity_mps - own_mps;
    let (offset, relative) = (sphere.offset_m.truncate(), relative_mps.truncate());
    let closest_s =
        (-offset.dot(relative) / relative.length_squared().max(1e-9)).clamp(0.0, TIME_S);
    let closest_m = (offset + relative * closest_s).length();
    let (height_m, climb_mps) = (sphere.offset_m.z, relative_mps.z);
    let least_height_m = if height_m * climb_mps >= 0.0 {
        height_m.abs()
    } else {
        // They approach: the least height over the time.
        (height_m.abs() - climb_mps.abs() * TIME_S).max(0.0)
    };
    (closest_m < sphere.radius_m && least_height_m <= HEIGHT_M).then_some(closest_s)
}

/// Level, away from the line of flight of an obstacle.
fn away(sphere: &Sphere) -> Vec3 {
    let from_it_m = -sphere.offset_m;
    let velocity_mps = sphere.velocity_mps;
    let away = if velocity_mps.length() < STANDS_MPS {
        from_it_m
    } else {
        from_it_m - velocity_mps * (from_it_m.dot(velocity_mps) / velocity_mps.length_squared())
    };
    Vec3::new(away.x, away.y, 0.0).normalize_or_zero()
}

impl Steering for ArduPlaneRules {
    fn restart(&mut self) {
        *self = Self::default();
    }

    fn steer(&mut self, view: &View<'_>) -> Option<Vec3> {
        let time_s = self.time_s;
        self.time_s += view.period_s;
        let threats = view.spheres.iter().filter_map(|sphere| {
            let closest_s = high(sphere, view.velocity_mps)?;
            Some((sphere, closest_s))
        });
        self.away = match threats.min_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((sphere, _)) => {
                let since_s = self.away.map_or(time_s, |(since_s, _)| since_s);
                Some((since_s, away(sphere)))
            }
            None => self
                .away
                .filter(|(since_s, _)| time_s - since_s <= CHANGE_S),
        };
        let (_, away) = self.away?;
        // On its line there is no side: it flies on.
        (away != Vec3::ZERO).then(|| away * view.speed_mps())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::RelativeRoute;
    use fga::vehicle::Vehicle;

    fn first(offset_m: Vec3, velocity_mps: Vec3) -> Option<Vec3> {
        let vehicle = Vehicle {
            airspeed_mps: 20.0,
            ..Vehicle::table_4()
        };
        let spheres = [Sphere {
            id: 1,
            offset_m,
            velocity_mps,
            radius_m: 100.0,
        }];
        let view = View {
            velocity_mps: Vec3::X * 20.0,
            preferred_mps: Vec3::X * 20.0,
            route: RelativeRoute {
                foot_m: Vec3::ZERO,
                along: Vec3::X,
            },
            spheres: &spheres,
            vehicle: &vehicle,
            period_s: 0.1,
        };
        ArduPlaneRules::default().steer(&view)
    }

    #[test]
    fn it_flies_at_right_angles_away_from_the_line_of_flight() {
        // Head-on, 50 m to the left of the other one's line: to the right.
        let head_on = first(Vec3::new(900.0, 50.0, 0.0), Vec3::X * -20.0).unwrap();
        assert!(head_on.distance(Vec3::Y * -20.0) < 1e-9, "{head_on}");
        // Beyond 30 s, beyond the height, and past it.
        for offset_m in [
            Vec3::new(1400.0, 50.0, 0.0),
            Vec3::new(900.0, 50.0, 150.0),
            Vec3::new(-200.0, 50.0, 0.0),
        ] {
            assert_eq!(first(offset_m, Vec3::X * -20.0), None, "{offset_m}");
        }
        // What stands: straight away from it.
        let stands = first(Vec3::new(300.0, 40.0, 0.0), Vec3::ZERO).unwrap();
        assert!(stands.x < 0.0 && stands.y < 0.0, "{stands}");
    }
}
