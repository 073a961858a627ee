//! The obstacles that matter for a decision, in a buffer of fixed size.

use crate::Vec3;
use crate::certificate::{Hazard, Hazards, MAX_HAZARDS};
use crate::situation::Situation;
use crate::situation::{Obstacle, ProtectedVolume};

/// Most obstacles that a decision takes into account: the most urgent ones.
pub const MAX_TRACKED: usize = MAX_HAZARDS;

/// How far inside a volume the aircraft may come again while it leaves it, as a share of its depth.
const LEAVING_SHARE: f64 = 0.98;

/// What tells whether the obstacles still do what they did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Picture {
    count: usize,
    /// Sum of their velocities, metres per second.
    velocity_mps: Vec3,
}

impl Picture {
    /// Whether obstacles came, went, or turned, by more than the velocities are uncertain.
    pub(super) fn differs_from(&self, other: &Self) -> bool {
        let change_mps = (self.velocity_mps - other.velocity_mps).length();
        self.count != other.count || change_mps > NEWS_MPS
    }
}

/// A change of velocities by this is not noise, metres per second.
const NEWS_MPS: f64 = 3.0;

/// The hazards of one step.
#[derive(Debug, Clone)]
pub struct Tracks {
    hazards: Hazards,
    /// Obstacles within the surveillance radius.
    pub seen: u32,
    /// Whether the aircraft is inside a protected volume.
    pub inside: bool,
    /// Whether some could not be kept.
    pub overflow: bool,
    /// Whether any is known with an uncertainty only.
    pub uncertain: bool,
}

impl Default for Tracks {
    fn default() -> Self {
        Self::new()
    }
}

impl Tracks {
    /// No obstacles.
    pub const fn new() -> Self {
        Self {
            hazards: Hazards::new(),
            seen: 0,
            inside: false,
            overflow: false,
            uncertain: false,
        }
    }

    /// Forgets all obstacles.
    pub fn clear(&mut self) {
        self.hazards.clear();
        self.seen = 0;
        (self.inside, self.overflow, self.uncertain) = (false, false, false);
    }

    /// The hazards.
    pub const fn hazards(&self) -> &Hazards {
        &self.hazards
    }

    /// The obstacles now, to be compared with later.
    pub(super) fn picture(&self) -> Picture {
        let rows = self.hazards.rows();
        Picture {
            count: rows.len(),
            velocity_mps: rows.iter().map(|hazard| hazard.velocity_mps).sum(),
        }
    }

    /// Takes the obstacles within the surveillance radius that could be met within the horizon.
    pub fn load(
        &mut self,
        situation: &Situation<'_>,
        surveillance_radius_m: f64,
        horizon_s: f64,
        sigmas: f64,
    ) {
        self.clear();
        let own = situation.ownship;
        let square = |x: f64| x * x;
        for obstacle in situation.obstacles.iter() {
            if !obstacle.is_valid() {
                continue;
            }
            let offset = obstacle.position_m - own.position_m;
            if offset.length_squared() > square(surveillance_radius_m) {
                continue;
            }
            self.seen += 1;
            if situation.is_out_of_reach(&obstacle, horizon_s) {
                continue;
            }
            self.keep(situation, &obstacle, sigmas);
        }
    }

    fn keep(&mut self, situation: &Situation<'_>, obstacle: &Obstacle, sigmas: f64) {
        let own = situation.ownship.position_m;
        let mut place = self.hazards.rows().len();
        if place >= MAX_TRACKED {
            self.overflow = true;
            let urgency = |hazard: &Hazard| hazard.margin_m(own, 0.0);
            let new = Hazard::new(0, obstacle, situation.wind_mps, sigmas);
            let farthest = self
                .hazards
                .rows()
                .iter()
                .enumerate()
                .max_by(|a, b| urgency(a.1).total_cmp(&urgency(b.1)));
            match farthest {
                Some((index, hazard)) if urgency(hazard) > urgency(&new) => place = index,
                _ => return,
            }
        }
        let index = u32::try_from(place).unwrap_or(u32::MAX);
        let mut hazard = Hazard::new(index, obstacle, situation.wind_mps, sigmas);
        let depth_m = hazard.margin_m(own, 0.0);
        if depth_m < 0.0 {
            self.inside |= obstacle.volume.margin_m(own - obstacle.position_m) < 0.0;
            hazard.volume = relaxed(&hazard.volume, &obstacle.volume, own - obstacle.position_m);
        }
        self.hazards.put(place, hazard);
        let uncertainty = obstacle.uncertainty;
        self.uncertain |= uncertainty.position_m > 0.0 || uncertainty.velocity_mps > 0.0;
    }
}

/// A widened volume that the aircraft is inside of, shrunk so that it is just outside: what is
/// certified against it leads out. While the aircraft is outside the volume itself, it stays as large as
/// that one.
fn relaxed(widened: &ProtectedVolume, itself: &ProtectedVolume, offset_m: Vec3) -> ProtectedVolume {
    let horizontal = libm::sqrt(offset_m.x * offset_m.x + offset_m.y * offset_m.y);
    let outside = itself.margin_m(offset_m) >= 0.0;
    match *widened {
        ProtectedVolume::Sphere { .. } => {
            let leaving_m = LEAVING_SHARE * offset_m.length();
            let least_m = if outside { itself.radius_m() } else { 0.0 };
            ProtectedVolume::Sphere {
                radius_m: leaving_m.max(least_m),
            }
        }
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => {
            let share = (horizontal / radius_m).max(offset_m.z.abs() / half_height_m);
            let mut radius_m = LEAVING_SHARE * share * radius_m;
            let mut half_height_m = LEAVING_SHARE * share * half_height_m;
            if outside {
                let (true_m, true_half_m) = (itself.radius_m(), itself.half_height_m());
                radius_m = radius_m.max(true_m);
                half_height_m = half_height_m.max(true_half_m);
                // Whichever of the two it is beyond keeps it outside.
                if horizontal >= true_m {
                    radius_m = radius_m.min(LEAVING_SHARE * horizontal).max(true_m);
                } else {
                    let above_m = LEAVING_SHARE * offset_m.z.abs();
                    half_height_m = half_height_m.min(above_m).max(true_half_m);
                }
            }
            ProtectedVolume::Cylinder {
                radius_m,
                half_height_m,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Outside the volume itself but within its widened one, the aircraft was shown a smaller volume
    /// than the true one when it was near the surface.
    #[test]
    fn a_relaxed_volume_is_as_large_as_the_true_one_until_that_is_entered() {
        let places = [
            Vec3::new(30.1, 0.0, 0.0),
            Vec3::new(0.0, 31.0, 9.0),
            Vec3::new(3.0, 4.0, 10.05),
            Vec3::new(29.0, 0.0, 11.0),
            Vec3::new(38.0, 0.0, 9.9),
        ];
        let cylinder = ProtectedVolume::Cylinder {
            radius_m: 30.0,
            half_height_m: 10.0,
        };
        let sphere = ProtectedVolume::Sphere { radius_m: 30.0 };
        for offset_m in places {
            for itself in [cylinder, sphere] {
                let widened = itself.grown(12.0);
                if itself.margin_m(offset_m) < 0.0 || widened.margin_m(offset_m) >= 0.0 {
                    continue;
                }
                let shrunk = relaxed(&widened, &itself, offset_m);
                assert!(shrunk.radius_m() >= itself.radius_m(), "{shrunk:?}");
                assert!(
                    shrunk.half_height_m() >= itself.half_height_m(),
                    "{shrunk:?}"
                );
                assert!(shrunk.margin_m(offset_m) >= 0.0, "{shrunk:?} {offset_m}");
            }
        }
    }
}
