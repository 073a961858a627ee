//! Algorithm 4 and Eq. 59 as printed; corrected: [`crate::algorithm_4`].

use crate::algorithm_4::{PWM_NEUTRAL_US, PWM_RANGE_US};

/// Line 17: √((`d_m` + ρ)² + (r sin θ + ρ)²), a sum under the root.
pub fn critical_along_m(turn_radius_m: f64, radius_m: f64, distance_m: f64, bias_rad: f64) -> f64 {
    libm::hypot(
        radius_m + turn_radius_m,
        distance_m * libm::sin(bias_rad) + turn_radius_m,
    )
}

/// Line 19: `t_c` = `d_c` / V, the time to fly `d_c` and not the time until the aircraft reaches it.
pub fn critical_timer_s(critical_along_m: f64, airspeed_mps: f64) -> f64 {
    critical_along_m / airspeed_mps
}

/// Lines 24, 25: wait while r ≤ `d_c` and t ≥ `t_c`.
pub fn is_waiting(
    range_m: f64,
    critical_along_m: f64,
    elapsed_s: f64,
    critical_timer_s: f64,
) -> bool {
    range_m <= critical_along_m && elapsed_s >= critical_timer_s
}

/// Lines 31, 32: dir = sign(heading − bearing), not wrapped; the sign of 0 is 0.
pub fn turn_direction(heading_rad: f64, bearing_rad: f64) -> f64 {
    let difference_rad = heading_rad - bearing_rad;
    if difference_rad == 0.0 {
        0.0
    } else {
        difference_rad.signum()
    }
}

/// Line 35 with Eq. 59: 1500 + 500 dir φ/`φ_max`, with the direction of the first turn.
pub fn second_turn_pwm_us(direction: f64, bank_rad: f64, bank_max_rad: f64) -> f64 {
    PWM_NEUTRAL_US + PWM_RANGE_US * direction * bank_rad / bank_max_rad
}
