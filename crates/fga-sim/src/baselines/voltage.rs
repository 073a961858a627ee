//! Modified voltage potential.
//!
//! M. Eby, A self-organizational approach for resolving air traffic conflicts, Lincoln Laboratory
//! Journal 7 (1994), in the form of J. Hoekstra, R. van Gent, R. Ruigrok, Designing for safety:
//! the free flight air traffic management concept, Reliability Engineering and System Safety 75
//! (2002): the method displaces the predicted point of closest approach to the edge of the protected
//! volume, along the line from the intruder to it, in the time that is left; the displacements of
//! all conflicts add up. Here in three dimensions, and the aircraft does all of it.

use fga::Vec3;

use super::Steering;
use super::view::LOWERED;
use super::view::{Sphere, View, flattened, levelled};

/// The method's settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VoltagePotential {
    /// Later conflicts do not count, seconds.
    pub look_ahead_s: f64,
    /// Factor on the protected radii.
    pub inflation: f64,
}

impl Default for VoltagePotential {
    fn default() -> Self {
        Self {
            look_ahead_s: 5.0,
            inflation: 4.0,
        }
    }
}

impl VoltagePotential {
    fn conflict_s(&self, sphere: &Sphere, velocity: Vec3) -> Option<f64> {
        sphere
            .entry_s(velocity)
            .filter(|entry_s| *entry_s <= self.look_ahead_s)
    }

    /// The sum of the changes of velocity, or `None` without a conflict.
    fn displacement(&self, spheres: impl Iterator<Item = Sphere>, velocity: Vec3) -> Option<Vec3> {
        /// Miss distance below which the side is chosen: to the right, metres.
        const COLLINEAR_M: f64 = 0.1;
        /// Shortest time to act in, seconds.
        const SHORTEST_S: f64 = 0.5;
        let mut sum = None;
        for sphere in spheres.map(|sphere| sphere.inflated(self.inflation)) {
            let Some(entry_s) = self.conflict_s(&sphere, velocity) else {
                continue;
            };
            let (distance, radius) = (sphere.offset_m.length(), sphere.radius_m);
            let (time_s, mut miss) = sphere.closest(velocity);
            if time_s <= 0.0 {
                // Inside and already leaving: straight away from the centre.
                let away = -sphere.offset_m.normalize_or_zero();
                *sum.get_or_insert(Vec3::ZERO) += away * velocity.length();
                continue;
            }
            if miss.length() < COLLINEAR_M {
                let ahead = sphere.offset_m.normalize_or_zero();
                miss = Vec3::new(-ahead.y, ahead.x, 0.0).normalize_or_zero() * COLLINEAR_M;
            }
            let missed = miss.length();
            // Aims along the tangent of the volume, not at its edge abeam of the point of closest approach:
            // that path would still cut the volume before it.
            let aim = if entry_s > 0.0 && missed < distance {
                let opening = libm::asin((radius / distance).min(1.0));
                radius / libm::cos(opening - libm::asin(missed / distance))
            } else {
                radius
            };
            let push = (aim - missed).max(0.0) / time_s.max(SHORTEST_S);
            *sum.get_or_insert(Vec3::ZERO) -= miss.normalize_or_zero() * push;
        }
        sum
    }
}

impl Steering for VoltagePotential {
    fn steer(&mut self, view: &View<'_>) -> Option<Vec3> {
        let Some(change) = self.displacement(view.spheres.iter().copied(), view.velocity_mps)
        else {
            // Resolved: keep the resolution until the mission is free.
            let threatened = view.spheres.iter().any(|sphere| {
                let sphere = sphere.inflated(self.inflation);
                self.conflict_s(&sphere, view.preferred_mps).is_some()
            });
            return threatened.then_some(view.velocity_mps);
        };
        let chosen = view.velocity_mps + change;
        if view.can_climb_along(chosen) {
            return Some(chosen);
        }
        // Too steep: turning alone, with the steepest climb.
        let level = levelled(view.velocity_mps);
        let turned = level
            + self
                .displacement(flattened(view.spheres), level)
                .unwrap_or(Vec3::ZERO);
        Some(turned + Vec3::Z * chosen.z.signum() * turned.length())
    }

    fn lowered(&self) -> f64 {
        LOWERED
    }
}
