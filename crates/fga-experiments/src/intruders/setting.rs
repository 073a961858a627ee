//! What all encounters share.

use fga::vehicle::{Response, Vehicle};

/// Time between two decisions, seconds.
pub(crate) const PERIOD_S: f64 = 0.1;

/// The aircraft of Table 4: 15 m/s, radius 30 m, climb ±15° at 0.2 rad/s.
pub(crate) const VEHICLE: Vehicle = Vehicle {
    airspeed_mps: 15.0,
    turn_radius_m: 30.0,
    climb_min_rad: -0.261_799_387_799_149_4,
    climb_max_rad: 0.261_799_387_799_149_4,
    climb_rate_radps: 0.2,
    response: Response {
        dead_time_s: 0.0,
        bank_time_constant_s: 0.0,
        turn_rate_factor: 1.0,
    },
};

/// Radius of every protected sphere, metres.
pub(crate) const RADIUS_M: f64 = 30.0;
