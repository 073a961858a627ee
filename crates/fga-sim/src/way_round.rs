//! Can the policy `circle` keep the volumes of the obstacles at rest on a mission? Asked before the flight.

use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga_paper::pilot::{PaperPilot, Rule};

use crate::plan::Plan;
use crate::policy::PolicyChoice;

/// Slower obstacles are at rest, metres per second.
const AT_REST_MPS: f64 = 1.0;

/// Why the policy `circle` cannot keep the volume of an obstacle at rest that a leg of the mission enters, as one sentence;
/// `None` where it can, and for other policies.
pub fn refusal(policy: &PolicyChoice, plan: &Plan) -> Option<String> {
    if *policy != PolicyChoice::Paper(Rule::Circle) {
        return None;
    }
    let world = &plan.world;
    let pilot = PaperPilot::new(world.settings.of_paper(Rule::Circle), world.vehicle).ok()?;
    let seen_m = world.settings.avoider.surveillance_radius_m;
    let wind_mps = world.wind_mps.with_z(0.0);
    for leg in world.mission_m.windows(2) {
        let (from_m, to_m) = (leg[0].with_z(0.0), leg[1].with_z(0.0));
        let Some(along) = (to_m - from_m).try_normalize() else {
            continue;
        };
        let left = Vec3::new(-along.y, along.x, 0.0);
        for (obstacle, name) in world.obstacles.iter().zip(&plan.names) {
            let Some((at_m, moving_mps)) = obstacle.track.at(0.0) else {
                continue;
            };
            let offset_m = at_m - leg[0];
            let (along_m, left_m) = (offset_m.dot(along), offset_m.dot(left));
            let share = (along_m / from_m.distance(to_m)).clamp(0.0, 1.0);
            let above_m = offset_m.z - share * (leg[1].z - leg[0].z);
            let kept_m = match obstacle.volume {
                ProtectedVolume::Sphere { radius_m } => {
                    libm::sqrt((radius_m * radius_m - above_m * above_m).max(0.0))
                }
                ProtectedVolume::Cylinder {
                    radius_m,
                    half_height_m,
                } => {
                    if above_m.abs() < half_height_m {
                        radius_m
                    } else {
                        0.0
                    }
                }
            };
            let enters_m = along_m - libm::sqrt((kept_m * kept_m - left_m * left_m).max(0.0));
            let is_entered =
                left_m.abs() < kept_m && enters_m > 0.0 && enters_m < from_m.distance(to_m);
            if moving_mps.length() > AT_REST_MPS || !is_entered {
                continue;
            }
            let Some(sight_m) = pilot.sight_for_circle_m(along, left_m, kept_m, wind_mps) else {
                return Some(format!(
                    "policy circle cannot keep {kept_m:.0} m from {name} in {:.1} m/s of wind at an airspeed of {:.1} \
                     m/s, expected less wind or another policy",
                    wind_mps.length(),
                    world.vehicle.airspeed_mps
                ));
            };
            // The command takes effect after the dead time, and a decision comes once a period.
            let late_s =
                world.vehicle.response.dead_time_s + world.settings.avoider.decision_period_s;
            let needed_m = sight_m + late_s * (world.vehicle.airspeed_mps + wind_mps.length());
            let charted = obstacle.charted_sigma_m.is_some();
            let sensor_m = if charted {
                f64::INFINITY
            } else {
                world.sensor.range_m
            };
            let first_m = obstacle.first_seen_m.unwrap_or(f64::INFINITY);
            let found_m = seen_m
                .min(sensor_m)
                .min(first_m)
                .min(libm::hypot(along_m, left_m));
            if found_m < needed_m {
                return Some(format!(
                    "policy circle cannot keep {kept_m:.0} m from {name}: it begins {needed_m:.0} m before the centre, \
                     which is known {found_m:.0} m before, expected surveillance_radius_m, the sensor's range and the \
                     leg before it to be longer"
                ));
            }
        }
    }
    None
}
