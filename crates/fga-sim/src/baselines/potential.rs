//! Artificial potential field.
//!
//! O. Khatib, Real-time obstacle avoidance for manipulators and mobile robots, International
//! Journal of Robotics Research 5 (1986): a force of attraction towards the goal and, within a
//! distance ρ₀ of an obstacle's surface, a force of repulsion η (1/ρ − 1/ρ₀)/ρ² away from it. The
//! aircraft turns into the direction of their sum.

use fga::Vec3;

use super::Steering;
use super::view::View;

/// The field's settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PotentialField {
    /// Repulsion η, with an attraction of 1 and lengths in protected radii.
    pub gain: f64,
    /// Reach ρ₀ of the repulsion from the protected surface, in protected radii.
    pub reach: f64,
}

impl Default for PotentialField {
    fn default() -> Self {
        Self {
            gain: 256.0,
            reach: 8.0,
        }
    }
}

impl Steering for PotentialField {
    fn steer(&mut self, view: &View<'_>) -> Option<Vec3> {
        /// Smaller distances to the surface count as this, in protected radii.
        const CLOSEST: f64 = 0.02;
        let wish = view.preferred_mps.normalize_or_zero();
        let mut repulsion = Vec3::ZERO;
        for sphere in view.spheres {
            let distance = sphere.offset_m.length();
            if distance <= 0.0 || sphere.radius_m <= 0.0 {
                continue;
            }
            let surface = ((distance - sphere.radius_m) / sphere.radius_m).max(CLOSEST);
            if surface < self.reach {
                let force = self.gain * (1.0 / surface - 1.0 / self.reach) / (surface * surface);
                repulsion -= sphere.offset_m / distance * force;
            }
        }
        if repulsion == Vec3::ZERO {
            return None;
        }
        // Straight against the wish the field has no side: push it to the right.
        let across = repulsion - wish * repulsion.dot(wish);
        if across.length() < 1e-3 * repulsion.length() {
            let right = Vec3::new(wish.y, -wish.x, 0.0).normalize_or_zero();
            repulsion += right * (0.05 * repulsion.length());
        }
        Some(wish + repulsion)
    }
}
