//! Three-dimensional velocity obstacles.
//!
//! P. Fiorini, Z. Shiller, Motion planning in dynamic environments using velocity obstacles,
//! International Journal of Robotics Research 17 (1998), extended to three dimensions for aircraft
//! by Y. Jenie, E. van Kampen, C. de Visser, J. Ellerbroek, J. Hoekstra, Three-dimensional
//! velocity obstacle method (2015): the flyable velocity that is nearest to the wanted one outside
//! every obstacle's cone, where a cone counts up to a time horizon. Where none is free, a collision
//! costs more the sooner it comes.

use core::f64::consts::PI;

use fga::Vec3;
use fga::angle::{course_of, direction};

use super::Steering;
use super::view::LOWERED;
use super::view::{Sphere, View};

/// The method's settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityObstacles {
    /// How far ahead collisions count, seconds.
    pub horizon_s: f64,
    /// Factor on the protected radii.
    pub inflation: f64,
    /// Courses tried to either side of the present one, up to half a turn.
    pub courses: u32,
    /// Climb angles tried, at least 2 where the vehicle can climb.
    pub climbs: u32,
    /// Cost of a collision in one second, metres per second of difference from the wish.
    pub collision_cost: f64,
}

impl Default for VelocityObstacles {
    fn default() -> Self {
        Self {
            horizon_s: 20.0,
            inflation: 2.0,
            courses: 36,
            climbs: 7,
            collision_cost: 2000.0,
        }
    }
}

impl VelocityObstacles {
    /// Difference from the wish, plus the price of the soonest collision within the horizon.
    fn cost(&self, spheres: &[Sphere], velocity: Vec3, preferred: Vec3) -> f64 {
        let mut soonest = f64::INFINITY;
        for sphere in spheres {
            match sphere.inflated(self.inflation).entry_s(velocity) {
                // Inside: the faster out the better.
                Some(0.0) => {
                    let outward = -sphere.offset_m.normalize_or_zero();
                    let leaving = (velocity - sphere.velocity_mps).dot(outward);
                    soonest = soonest.min(libm::exp(leaving / 10.0) * 0.01);
                }
                Some(entry_s) if entry_s <= self.horizon_s => soonest = soonest.min(entry_s),
                _ => {}
            }
        }
        let price = if soonest.is_finite() {
            // Any collision is worse than any free direction.
            self.collision_cost / soonest.max(1e-6) + 4.0 * preferred.length()
        } else {
            0.0
        };
        price + velocity.distance(preferred)
    }
}

impl Steering for VelocityObstacles {
    fn steer(&mut self, view: &View<'_>) -> Option<Vec3> {
        let preferred = view.preferred_mps;
        let mut best = (self.cost(view.spheres, preferred, preferred), preferred);
        if best.0 <= 0.0 {
            return None;
        }
        let speed = view.speed_mps();
        let (low, high) = (view.vehicle.climb_min_rad, view.vehicle.climb_max_rad);
        let climbs = if view.vehicle.can_climb() {
            self.climbs.max(2)
        } else {
            1
        };
        let course = course_of(view.velocity_mps);
        for turn in 0..=self.courses {
            let turn_rad = PI * f64::from(turn) / f64::from(self.courses.max(1));
            for signed in [turn_rad, -turn_rad] {
                for climb in 0..climbs {
                    let climb_rad = if climbs == 1 {
                        0.0
                    } else {
                        low + (high - low) * f64::from(climb) / f64::from(climbs - 1)
                    };
                    let velocity = direction(course + signed, climb_rad) * speed;
                    let cost = self.cost(view.spheres, velocity, preferred);
                    if cost < best.0 {
                        best = (cost, velocity);
                    }
                }
            }
        }
        Some(best.1)
    }

    fn lowered(&self) -> f64 {
        LOWERED
    }
}
