//! Optimal reciprocal collision avoidance in three dimensions, without reciprocity.
//!
//! J. van den Berg, S. Guy, M. Lin, D. Manocha, Reciprocal n-body collision avoidance (2011), by
//! the crate `dodgy_3d`, a port of RVO2-3D. The obstacles do not avoid: all responsibility lies with
//! the aircraft. The method may choose a slower velocity; the aircraft cannot, and flies into its
//! direction at its airspeed.

use alloc::borrow::Cow;

use dodgy_3d::{Agent, AvoidanceOptions};
use fga::Vec3;

use super::Steering;
use super::view::LOWERED;
use super::view::{Sphere, View, flattened, levelled};

/// The method's settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orca {
    /// How far ahead collisions count, seconds.
    pub horizon_s: f64,
    /// Factor on the protected radii.
    pub inflation: f64,
}

impl Default for Orca {
    fn default() -> Self {
        Self {
            horizon_s: 5.0,
            inflation: 2.5,
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the method works in single precision, on offsets of some hundred metres"
)]
fn single(vector: Vec3) -> dodgy_3d::Vec3 {
    dodgy_3d::Vec3::new(vector.x as f32, vector.y as f32, vector.z as f32)
}

impl Orca {
    fn solve(
        &self,
        view: &View<'_>,
        spheres: impl Iterator<Item = Sphere>,
        preferred: Vec3,
        velocity: Vec3,
    ) -> Vec3 {
        #[expect(clippy::cast_possible_truncation, reason = "settings of a few digits")]
        let (speed, period, time_horizon) = (
            view.speed_mps() as f32,
            view.period_s as f32,
            self.horizon_s as f32,
        );
        let own = Agent {
            position: dodgy_3d::Vec3::ZERO,
            velocity: single(velocity),
            radius: 0.0,
            avoidance_responsibility: 1.0,
        };
        let neighbours: Vec<Cow<'_, Agent>> = spheres
            .map(|sphere| {
                // Straight at the centre the method has no side, and inside a volume it draws one
                // at random where the velocities match: a centimetre to the left decides.
                let nudge = if sphere.closest(velocity).1.length() < 0.01 {
                    Vec3::new(-velocity.y, velocity.x, 0.0).normalize_or_zero() * 0.01
                } else {
                    Vec3::ZERO
                };
                #[expect(clippy::cast_possible_truncation, reason = "a length of some metres")]
                let radius = (sphere.radius_m * self.inflation) as f32;
                Cow::Owned(Agent {
                    position: single(sphere.offset_m + nudge),
                    velocity: single(sphere.velocity_mps),
                    radius,
                    avoidance_responsibility: 0.0,
                })
            })
            .collect();
        let chosen = own.compute_avoiding_velocity(
            &neighbours,
            single(preferred),
            speed,
            period,
            &AvoidanceOptions { time_horizon },
        );
        Vec3::new(
            f64::from(chosen.x),
            f64::from(chosen.y),
            f64::from(chosen.z),
        )
    }
}

impl Steering for Orca {
    fn steer(&mut self, view: &View<'_>) -> Option<Vec3> {
        if view.spheres.is_empty() {
            return None;
        }
        let spheres = view.spheres.iter().copied();
        let chosen = self.solve(view, spheres, view.preferred_mps, view.velocity_mps);
        if view.can_climb_along(chosen) {
            return Some(chosen);
        }
        // Too steep: turning alone, with the steepest climb.
        let (preferred, velocity) = (levelled(view.preferred_mps), levelled(view.velocity_mps));
        let turned = self.solve(view, flattened(view.spheres), preferred, velocity);
        Some(turned + Vec3::Z * chosen.z.signum() * turned.length())
    }

    fn lowered(&self) -> f64 {
        LOWERED
    }
}
