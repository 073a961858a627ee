//! `L_1`, `L_2`, `L_3` and the bound of `k_2` (§3.4.3, Eq. 54–56).

use super::obstacle::{RoundObstacle, deviation_rad, usable};

/// `L_1`: path from Q, where the latest turn begins, round the obstacle to abeam, metres;
/// (ρ + `d_m`) α for ρ ≤ `d_m` (Eq. 55), `L_1'` = ρ (`α_1` + `α_2`) otherwise (Fig. 8(b)).
///
/// `None` unless ρ and `d_m` are positive and 0 ≤ s < `d_m`.
pub fn length_1_m(turn_radius_m: f64, radius_m: f64, across_m: f64) -> Option<f64> {
    RoundObstacle::new(turn_radius_m, radius_m, across_m).map(|round| round.to_abeam_m)
}

/// `L_2`: path from Q to the tangent point B and straight on to abeam, metres: α ρ + `d_m` tan α.
///
/// `None` unless ρ and `d_m` are positive and 0 ≤ s < `d_m`.
pub fn length_2_m(turn_radius_m: f64, radius_m: f64, across_m: f64) -> Option<f64> {
    let alpha_rad = deviation_rad(turn_radius_m, radius_m, across_m)?;
    let length_m = turn_radius_m * alpha_rad + radius_m * libm::tan(alpha_rad);
    length_m.is_finite().then_some(length_m)
}

/// `L_3`: path from U, where the obstacle is seen `along_m` ahead and the turn begins at once: an
/// arc of ρ, a straight tangent, and round the obstacle to abeam, metres (Fig. 9).
///
/// With ρ > `d_m` the last arc has the radius ρ and touches the protected circle abeam.
/// `None` if the turn would begin too late, or if a length is out of range.
pub fn length_3_m(turn_radius_m: f64, radius_m: f64, across_m: f64, along_m: f64) -> Option<f64> {
    if !usable(turn_radius_m, radius_m, across_m) || !along_m.is_finite() || along_m <= 0.0 {
        return None;
    }
    let around_m = radius_m.max(turn_radius_m);
    // From the first circle's centre to the second's, which lies below the obstacle's where ρ > d.
    let rise_m = turn_radius_m + across_m + (around_m - radius_m);
    let (apart_m, sum_m) = (libm::hypot(along_m, rise_m), turn_radius_m + around_m);
    if apart_m < sum_m {
        return None;
    }
    let turn_rad = libm::asin(sum_m / apart_m) - libm::atan2(rise_m, along_m);
    let straight_m = libm::sqrt((apart_m - sum_m) * (apart_m + sum_m));
    let length_m = sum_m * turn_rad + straight_m;
    (turn_rad >= 0.0 && length_m.is_finite()).then_some(length_m)
}

/// `L_30` = √(R² + `d_m`²), metres, below any `L_3` that begins at the distance R head-on (Eq. 54).
///
/// `None` unless both are positive.
pub fn length_3_bound_m(detection_m: f64, radius_m: f64) -> Option<f64> {
    let positive = |value: f64| value.is_finite() && value > 0.0;
    let length_m = libm::hypot(detection_m, radius_m);
    (positive(detection_m) && positive(radius_m) && length_m.is_finite()).then_some(length_m)
}

/// `L_1*` = (ρ + `d_m`) π/2, metres, above any `L_1` with ρ ≤ `d_m` (Eq. 55 with α = π/2).
///
/// `None` unless both are positive.
pub fn length_1_bound_m(turn_radius_m: f64, radius_m: f64) -> Option<f64> {
    usable(turn_radius_m, radius_m, 0.0)
        .then_some((turn_radius_m + radius_m) * core::f64::consts::FRAC_PI_2)
}

/// Bound of `k_2` = R/`d_m` above which `L_30` > `L_1*`, for `k_1` = ρ/`d_m`: √(π²/4 (1 + `k_1`)² − 1)
/// (Eq. 56, corrected: π/2 squared is π²/4).
///
/// `None` for a ratio that is not positive.
pub fn least_detection_ratio(turn_ratio: f64) -> Option<f64> {
    let length = core::f64::consts::FRAC_PI_2 * (1.0 + turn_ratio);
    let ratio = libm::sqrt(length * length - 1.0);
    (turn_ratio > 0.0 && ratio.is_finite()).then_some(ratio)
}
