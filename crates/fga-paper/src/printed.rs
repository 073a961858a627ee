//! The printed formulas, kept apart.
//!
//! Only the policy `published-literal` flies on them; it exists for the errata page
//! (`docs/errata.md`). Each function here has a corrected one, named in its documentation, and a
//! test in `tests/errata` with a case in which this one is wrong. Angles are radians, lengths
//! metres, speeds metres per second. Input is not checked; results for numbers that are not finite have
//! no meaning, and nothing panics.

mod algorithm_4;
mod directions;

pub use algorithm_4::{
    critical_along_m, critical_timer_s, is_waiting, second_turn_pwm_us, turn_direction,
};
pub use directions::{LiteralEntry, LiteralGrid, select, separation};

use fga::Vec3;

/// `V_r` = `V_a` − `V_u`, as in the text of §2.2; corrected: [`Relative`](crate::conflict::Relative).
pub fn relative_velocity_mps(ownship_mps: Vec3, obstacle_mps: Vec3) -> Vec3 {
    obstacle_mps - ownship_mps
}

/// Eq. 4: |`θ_t0`| < sin `θ_dm`, an angle against a sine; corrected:
/// [`cone_3d`](crate::conflict::cone_3d).
pub fn in_collision_cone(bias_rad: f64, radius_m: f64, distance_m: f64) -> bool {
    bias_rad.abs() < radius_m / distance_m
}

/// §2.2: the cone's half opening angle atan(`r_min`/`r_0`); corrected: asin, in
/// [`cone_3d`](crate::conflict::cone_3d).
pub fn opening_angle_rad(radius_m: f64, distance_m: f64) -> f64 {
    libm::atan(radius_m / distance_m)
}

/// Alg. 1 lines 5, 6: `r_0` sin `θ_t0` < `d_m`, whether it closes or not; corrected:
/// [`threatens`](crate::conflict::threatens).
pub fn is_dangerous(distance_m: f64, bias_rad: f64, radius_m: f64) -> bool {
    distance_m * libm::sin(bias_rad) < radius_m
}

/// Eq. 19: `t_c` without the minimum with `t_L`; corrected: [`Times`](crate::timing::Times).
pub fn critical_s(
    distance_m: f64,
    bias_rad: f64,
    turn_radius_m: f64,
    radius_m: f64,
    closing_mps: f64,
) -> f64 {
    let (sin, cos) = libm::sincos(bias_rad);
    (distance_m * cos - turn_radius_m - (radius_m - distance_m * sin)) / closing_mps
}

/// Eq. 20: `r_c` = `r_0` − ‖`V_r`‖ `t_c`; corrected: [`Times`](crate::timing::Times).
pub fn critical_distance_m(distance_m: f64, closing_mps: f64, critical_s: f64) -> f64 {
    distance_m - closing_mps * critical_s
}

/// Eq. 29: the least initial distance; corrected:
/// [`least_distance_m`](crate::bounds::least_distance_m).
pub fn least_distance_m(turn_radius_m: f64, radius_m: f64, bias_rad: f64) -> f64 {
    let (sin, cos) = libm::sincos(bias_rad);
    (turn_radius_m + radius_m) / (cos + sin)
}

/// Eq. 38: `V_u` ≤ `V_u` / |sin(`θ_va` − `θ_r1`)|, which every speed satisfies; corrected:
/// [`speed_feasible_2d`](crate::bounds::speed_feasible_2d).
pub fn speed_feasible(airspeed_mps: f64, edge_angle_rad: f64) -> bool {
    airspeed_mps <= airspeed_mps / libm::sin(edge_angle_rad).abs()
}

/// Eq. 39, 40, 43: tan⁻¹(y/x), blind to the quadrant; corrected: `atan2`.
pub fn direction_rad(x: f64, y: f64) -> f64 {
    libm::atan(y / x)
}

/// Eq. 56: √(π/4 (1 + `k_1`)² − 1); corrected:
/// [`least_detection_ratio`](crate::paths::least_detection_ratio).
pub fn least_detection_ratio(turn_ratio: f64) -> f64 {
    let sum = 1.0 + turn_ratio;
    libm::sqrt(core::f64::consts::FRAC_PI_4 * sum * sum - 1.0)
}

/// §3.3: `t_0` > `t_a` > `t_c`; Table 2 has `t_0` < `t_a` < `t_c`.
pub fn is_between(detection_s: f64, avoidance_s: f64, critical_s: f64) -> bool {
    detection_s > avoidance_s && avoidance_s > critical_s
}

/// Alg. 3 line 4: `θ_w` < π; corrected: [`next_waypoint`](crate::waypoint::next_waypoint).
pub fn waypoint_accepted(bias_rad: f64) -> bool {
    bias_rad < core::f64::consts::PI
}

/// Eq. 60 without its units, given metres and metres per second: tan φ = V² / (11.26 ρ); corrected:
/// [`bank_for_radius_rad`](crate::turn::bank_for_radius_rad).
pub fn bank_rad(airspeed_mps: f64, radius_m: f64) -> f64 {
    libm::atan(airspeed_mps * airspeed_mps / (11.26 * radius_m))
}

/// Eq. 44: min of `V_a` |sin(`θ_va` − `θ_r1`)| and `V_a` |sin(`θ_r2` − `θ_va`)|, also where nothing
/// threatens; corrected: [`least_speed_2d_mps`](crate::bounds::least_speed_2d_mps).
pub fn least_speed_mps(
    obstacle_mps: f64,
    obstacle_course_rad: f64,
    right_edge_rad: f64,
    left_edge_rad: f64,
) -> f64 {
    let right_mps = obstacle_mps * libm::sin(obstacle_course_rad - right_edge_rad).abs();
    let left_mps = obstacle_mps * libm::sin(left_edge_rad - obstacle_course_rad).abs();
    right_mps.min(left_mps)
}
