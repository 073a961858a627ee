//! How few seconds before an entry an aircraft was on a course into a volume.

use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga_sim::engine::{DecisionMoment, Observer};
use fga_sim::obstacle::WorldObstacle;

/// Watches a flight among obstacles as they really are.
pub(super) struct StressUrgency<'a> {
    obstacles: &'a [WorldObstacle],
    least_s: f64,
}

impl<'a> StressUrgency<'a> {
    pub(super) const fn of(obstacles: &'a [WorldObstacle]) -> Self {
        Self {
            obstacles,
            least_s: f64::INFINITY,
        }
    }

    /// The least time to an entry at a decision, if nobody had turned any more, seconds; infinite for none.
    pub(super) const fn least_s(&self) -> f64 {
        self.least_s
    }
}

impl Observer for StressUrgency<'_> {
    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let own = &moment.situation.ownship;
        let own_mps = own.velocity_mps() + moment.situation.wind_mps;
        for obstacle in self.obstacles {
            if let Some((at_m, velocity_mps)) = obstacle.track.at(moment.time_s) {
                let entry_s = entry_s(
                    at_m - own.position_m,
                    velocity_mps - own_mps,
                    &obstacle.volume,
                );
                self.least_s = self.least_s.min(entry_s);
            }
        }
    }
}

/// When a point that moves straight enters a volume about the origin, seconds: 0 inside, infinite for never.
fn entry_s(offset_m: Vec3, velocity_mps: Vec3, volume: &ProtectedVolume) -> f64 {
    let level = |v: Vec3| Vec3::new(v.x, v.y, 0.0);
    let (from_s, to_s) = match *volume {
        ProtectedVolume::Sphere { radius_m } => within(offset_m, velocity_mps, radius_m),
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => {
            let across = within(level(offset_m), level(velocity_mps), radius_m);
            let up = within(
                Vec3::Z * offset_m.z,
                Vec3::Z * velocity_mps.z,
                half_height_m,
            );
            (across.0.max(up.0), across.1.min(up.1))
        }
    };
    if from_s <= to_s && to_s >= 0.0 {
        from_s.max(0.0)
    } else {
        f64::INFINITY
    }
}

/// The times between which a point that moves straight is within a distance of the origin; an empty range for never.
fn within(offset_m: Vec3, velocity_mps: Vec3, distance_m: f64) -> (f64, f64) {
    let square = velocity_mps.length_squared();
    let half = offset_m.dot(velocity_mps);
    let outside = offset_m.length_squared() - distance_m * distance_m;
    if square <= 0.0 {
        return if outside <= 0.0 {
            (f64::NEG_INFINITY, f64::INFINITY)
        } else {
            (f64::INFINITY, f64::NEG_INFINITY)
        };
    }
    let root = half * half - square * outside;
    if root < 0.0 {
        return (f64::INFINITY, f64::NEG_INFINITY);
    }
    let root = libm::sqrt(root);
    ((-half - root) / square, (-half + root) / square)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_against_numbers_by_hand() {
        let sphere = ProtectedVolume::Sphere { radius_m: 30.0 };
        let cylinder = ProtectedVolume::Cylinder {
            radius_m: 30.0,
            half_height_m: 10.0,
        };
        let entry = |at: [f64; 3], moves: [f64; 3], volume| {
            entry_s(Vec3::from_array(at), Vec3::from_array(moves), volume)
        };
        // 130 m ahead at 10 m/s: 100 m to the surface.
        assert!((entry([130.0, 0.0, 0.0], [-10.0, 0.0, 0.0], &sphere) - 10.0).abs() < 1e-12);
        assert_eq!(
            entry([130.0, 31.0, 0.0], [-10.0, 0.0, 0.0], &sphere),
            f64::INFINITY
        );
        assert_eq!(
            entry([130.0, 0.0, 0.0], [10.0, 0.0, 0.0], &sphere),
            f64::INFINITY
        );
        assert_eq!(entry([1.0, 0.0, 0.0], [10.0, 0.0, 0.0], &sphere), 0.0);
        // 20 m above, sinking at 1 m/s: within 10 m after 10 s, when it is across at 30 m.
        assert!((entry([130.0, 0.0, 20.0], [-10.0, 0.0, -1.0], &cylinder) - 10.0).abs() < 1e-12);
        assert_eq!(
            entry([130.0, 0.0, 20.0], [-10.0, 0.0, 0.0], &cylinder),
            f64::INFINITY
        );
    }
}
