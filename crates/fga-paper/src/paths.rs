//! Path lengths round a static obstacle and the manoeuvre itself (§3.3, §3.4.3, Fig. 8 and 9).
//!
//! Everything is in the plane. s is the distance by which the straight course misses the centre; the
//! turn away goes to the side on which the aircraft passes it. Abeam is the line through the centre
//! across the initial course (S–S' in Fig. 8).

use crate::timing::Geometry;

mod comparison;
mod obstacle;

pub use comparison::{
    least_detection_ratio, length_1_bound_m, length_1_m, length_2_m, length_3_bound_m, length_3_m,
};
pub use obstacle::{PathArc, RoundObstacle, deviation_rad};

/// Turn radius of a turn that begins now and passes a static obstacle at exactly `d_m`, metres:
/// ρ = (`r_0`² − `d_m`²) / (2 (`d_m` − s)), Eq. 16 solved for ρ with `t_a` = 0.
///
/// It chooses a radius above `ρ_min` (§3.3): begin early, turn gently, keep the wanted
/// distance. For a wider separation give a larger `d_m`. `None` if the turn would have to be
/// tighter than `least_radius_m`, or if nothing threatens.
pub fn turn_radius_for_separation_m(encounter: &Geometry, least_radius_m: f64) -> Option<f64> {
    let (a, s, d) = (encounter.along_m, encounter.across_m, encounter.radius_m);
    if !encounter.is_threat() || !least_radius_m.is_finite() || least_radius_m <= 0.0 {
        return None;
    }
    let radius_m = (a * a + s * s - d * d) / (2.0 * (d - s));
    (radius_m.is_finite() && radius_m >= least_radius_m).then_some(radius_m)
}

#[cfg(test)]
mod tests;
