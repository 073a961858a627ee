//! The capabilities of the vehicle: coordinated turn, limits, response (Eq. 7–14, Eq. 60).

use core::f64::consts::FRAC_PI_2;

use crate::limit::SettingsError;

/// Standard acceleration of gravity, metres per second squared.
pub const STANDARD_GRAVITY_MPS2: f64 = 9.806_65;

/// Radius of a coordinated turn, metres: ρ = V² / (g tan φ) (Eq. 7, with `φ_max` Eq. 8).
///
/// `None` unless the airspeed is positive and the bank angle lies strictly between 0 and π/2.
///
/// ```
/// // 15 m/s at 30° of bank: 39.7 m, not the 30 m of Table 4, which take 37.4°.
/// let radius_m = fga_proof::vehicle::turn_radius_m(15.0, 30f64.to_radians()).unwrap();
/// assert!((radius_m - 39.74).abs() < 0.01);
/// ```
pub fn turn_radius_m(airspeed_mps: f64, bank_rad: f64) -> Option<f64> {
    let radius_m = airspeed_mps * airspeed_mps / (STANDARD_GRAVITY_MPS2 * libm::tan(bank_rad));
    let is_turn = airspeed_mps > 0.0 && bank_rad > 0.0 && bank_rad < FRAC_PI_2;
    (is_turn && radius_m > 0.0 && radius_m.is_finite()).then_some(radius_m)
}

/// The vehicle's response: the difference between command and flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Dead time before a command has any effect, seconds. The caller asks an avoider about the moment after it, with a situation that
    /// predicts the commands under way until then.
    pub dead_time_s: f64,
    /// Time constant of the first-order bank response, seconds; 0 for a bank that follows at once.
    pub bank_time_constant_s: f64,
    /// Flown course rate over the ideal g·tan φ / V; 1 for the ideal coordinated turn.
    pub turn_rate_factor: f64,
}

impl Response {
    /// At once, with ideal turns.
    pub const IDEAL: Self = Self {
        dead_time_s: 0.0,
        bank_time_constant_s: 0.0,
        turn_rate_factor: 1.0,
    };
}

impl Default for Response {
    fn default() -> Self {
        Self::IDEAL
    }
}

/// The vehicle's limits at its airspeed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vehicle {
    /// Constant total airspeed `V_u`, metres per second.
    pub airspeed_mps: f64,
    /// Least turn radius `ρ_min` of the ideal coordinated turn, metres (Eq. 8).
    pub turn_radius_m: f64,
    /// Steepest descent, radians, at most 0.
    pub climb_min_rad: f64,
    /// Steepest climb, radians, at least 0; both 0 for a vehicle held in the plane.
    pub climb_max_rad: f64,
    /// Rate limit of the climb angle, radians per second.
    pub climb_rate_radps: f64,
    /// Its response to commands.
    pub response: Response,
}

impl Vehicle {
    /// The vehicle of Table 4: 15 m/s, 30 m, climb angle ±15° at 0.2 rad/s, no lag.
    pub const fn table_4() -> Self {
        Self {
            airspeed_mps: 15.0,
            turn_radius_m: 30.0,
            climb_min_rad: -core::f64::consts::PI / 12.0,
            climb_max_rad: core::f64::consts::PI / 12.0,
            climb_rate_radps: 0.2,
            response: Response::IDEAL,
        }
    }

    /// A vehicle held in the plane that turns as tightly as its largest bank angle allows (Eq. 8).
    ///
    /// # Errors
    /// An airspeed that is not positive; a bank angle that does not lie strictly between 0 and π/2.
    pub fn from_bank(airspeed_mps: f64, bank_max_rad: f64) -> Result<Self, SettingsError> {
        let positive = "a positive number";
        SettingsError::unless(airspeed_mps > 0.0, "airspeed_mps", airspeed_mps, positive)?;
        let turn_radius_m = turn_radius_m(airspeed_mps, bank_max_rad).unwrap_or(f64::NAN);
        let (name, expected) = ("bank_max_rad", "above 0, below π/2");
        SettingsError::unless(turn_radius_m > 0.0, name, bank_max_rad, expected)?;
        Ok(Self {
            airspeed_mps,
            turn_radius_m,
            climb_min_rad: 0.0,
            climb_max_rad: 0.0,
            climb_rate_radps: 0.0,
            response: Response::default(),
        })
    }

    /// The same vehicle with limits of its climb angle: `[min, max]` at `rate_radps`.
    #[must_use]
    pub const fn with_climb(self, min_rad: f64, max_rad: f64, rate_radps: f64) -> Self {
        Self {
            climb_min_rad: min_rad,
            climb_max_rad: max_rad,
            climb_rate_radps: rate_radps,
            ..self
        }
    }

    /// Checks every limit: plausible for flight, and predictable in bounded work.
    ///
    /// Ranges: airspeed 1 to 1,000 m/s; turn radius 1 m to 1,000 km, and no turn of more than 10 g; climb
    /// angles to ±80°; climb rate up to 10 rad/s; dead time up to 10 s; time constant of the bank 0, or 0.01 s to
    /// 10 s, in which it turns by at most 1.5 rad; turn-rate factor 0.05 to 2.
    ///
    /// # Errors
    /// The first limit that is not finite or out of range.
    pub fn check(&self) -> Result<(), SettingsError> {
        /// Steepest climb, radians (80°).
        const STEEPEST_RAD: f64 = 80.0 * core::f64::consts::PI / 180.0;
        /// Largest acceleration to the side, in g.
        const MOST_G: f64 = 10.0;
        /// Largest turn in a time constant of the bank, radians: beyond it the bounds of `docs/proof.md` are not tight.
        const MOST_TURN_RAD: f64 = 1.5;
        let response = self.response;
        let tightest_m = self.airspeed_mps * self.airspeed_mps / (STANDARD_GRAVITY_MPS2 * MOST_G);
        let lag_s = response.bank_time_constant_s;
        let lag = if lag_s == 0.0 { 0.0 } else { 0.01 };
        let most_lag_s = f64::min(10.0, MOST_TURN_RAD / self.course_rate_radps());
        let within = |name, value, (low, high): (f64, f64), expected| {
            SettingsError::unless((low..=high).contains(&value), name, value, expected)
        };
        within("airspeed_mps", self.airspeed_mps, (1.0, 1e3), "1 to 1,000")?;
        let (radius_m, radii_m) = (self.turn_radius_m, (tightest_m.max(1.0), 1e6));
        let wide = "1 to 1,000,000, and no turn of more than 10 g";
        within("turn_radius_m", radius_m, radii_m, wide)?;
        let (low_rad, down) = (self.climb_min_rad, "-1.396 (80 degrees) to 0");
        within("climb_min_rad", low_rad, (-STEEPEST_RAD, 0.0), down)?;
        let (high_rad, up) = (self.climb_max_rad, "0 to 1.396 (80 degrees)");
        within("climb_max_rad", high_rad, (0.0, STEEPEST_RAD), up)?;
        let rate_radps = self.climb_rate_radps;
        within("climb_rate_radps", rate_radps, (0.0, 10.0), "0 to 10")?;
        within("dead_time_s", response.dead_time_s, (0.0, 10.0), "0 to 10")?;
        let factor = response.turn_rate_factor;
        within("turn_rate_factor", factor, (0.05, 2.0), "0.05 to 2")?;
        let slow = "0, or 0.01 to 10, and no turn of more than 1.5 rad (86 degrees) in it";
        within("bank_time_constant_s", lag_s, (lag, most_lag_s), slow)
    }

    /// Largest real course rate: factor · V / ρ, radians per second (Eq. 9).
    pub fn course_rate_radps(&self) -> f64 {
        self.response.turn_rate_factor * self.airspeed_mps / self.turn_radius_m
    }

    /// The vehicle of Table 4 with a bank lag and the turn rate of a real aircraft.
    pub const fn lagged(bank_time_constant_s: f64) -> Self {
        let mut vehicle = Self::table_4();
        vehicle.response.bank_time_constant_s = bank_time_constant_s;
        vehicle.response.turn_rate_factor = 0.8;
        vehicle
    }

    /// Whether it may leave its altitude.
    pub fn can_climb(&self) -> bool {
        (self.climb_max_rad > 0.0 || self.climb_min_rad < 0.0) && self.climb_rate_radps > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vehicle_from_its_bank_angle_turns_as_eq_8_says() {
        let vehicle = Vehicle::from_bank(15.0, 30f64.to_radians()).unwrap();
        // 225 / (9.80665 · tan 30°), by hand.
        assert!((vehicle.turn_radius_m - 39.739).abs() < 1e-3);
        assert!(vehicle.check().is_ok() && !vehicle.can_climb());
        assert!(vehicle.with_climb(-0.2, 0.2, 0.1).can_climb());
    }

    #[test]
    fn a_bank_that_lags_behind_the_turn_is_refused() {
        // 15 m/s on 15 m: a radian a second.
        let slow = |lag_s: f64| Vehicle {
            turn_radius_m: 15.0,
            response: Response {
                bank_time_constant_s: lag_s,
                ..Response::IDEAL
            },
            ..Vehicle::table_4()
        };
        assert!(slow(1.49).check().is_ok());
        let refused = slow(1.51).check().unwrap_err();
        assert_eq!(refused.name, "bank_time_constant_s");
    }

    #[test]
    fn table_4_is_valid_and_turns_half_a_radian_a_second() {
        assert!(Vehicle::table_4().check().is_ok());
        assert!((Vehicle::table_4().course_rate_radps() - 0.5).abs() < 1e-12);
    }

    #[test]
    fn limits_out_of_range_are_refused() {
        let good = Vehicle::table_4();
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(
                Vehicle {
                    airspeed_mps: bad,
                    ..good
                }
                .check()
                .is_err()
            );
            assert!(
                Vehicle {
                    turn_radius_m: bad,
                    ..good
                }
                .check()
                .is_err()
            );
            assert!(
                Vehicle {
                    climb_rate_radps: bad,
                    ..good
                }
                .check()
                .is_err()
            );
            assert!(good.with_climb(bad, 0.1, 0.1).check().is_err());
            assert!(good.with_climb(-0.1, bad, 0.1).check().is_err());
            let response = Response {
                dead_time_s: bad,
                ..Response::default()
            };
            assert!(Vehicle { response, ..good }.check().is_err());
        }
        assert!(good.with_climb(0.1, 0.2, 0.1).check().is_err());
        assert!(
            Vehicle {
                airspeed_mps: 0.0,
                ..good
            }
            .check()
            .is_err()
        );
        let flat = Vehicle::from_bank(15.0, 0.0).unwrap_err();
        assert_eq!(flat.name, "bank_max_rad");
        let still = Vehicle::from_bank(f64::NAN, 0.5).unwrap_err();
        assert_eq!(still.name, "airspeed_mps");
    }
}
