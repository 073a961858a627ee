//! What the simulated aircraft does otherwise than its pilot believes.

use fga::Vec3;
use fga::situation::Ownship;
use fga::vehicle::Vehicle;
use serde::{Deserialize, Serialize};

/// How the aircraft and the air of a flight differ from the vehicle and the wind that its pilot knows: `[plant]` of a file. `None`
/// is no difference. Simulation and oracle know it, pilots do not.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlantDifference {
    /// Airspeed at the same largest bank angle, metres per second; the pilot is shown that of its vehicle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub airspeed_mps: Option<f64>,
    /// Rate of change of the climb angle, radians per second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub climb_rate_radps: Option<f64>,
    /// Time from a command to its first effect, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dead_time_s: Option<f64>,
    /// Time constant of the bank, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bank_time_constant_s: Option<f64>,
    /// Turn rate over the ideal one of the bank.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn_rate_factor: Option<f64>,
    /// Velocity that the air has beyond the wind: east, north, up, metres per second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wind_error_mps: Option<[f64; 3]>,
}

impl PlantDifference {
    /// None.
    pub const NONE: Self = Self {
        airspeed_mps: None,
        climb_rate_radps: None,
        dead_time_s: None,
        bank_time_constant_s: None,
        turn_rate_factor: None,
        wind_error_mps: None,
    };

    /// With the keys of another one where it has none.
    #[must_use]
    pub fn or(self, other: &Self) -> Self {
        Self {
            airspeed_mps: self.airspeed_mps.or(other.airspeed_mps),
            climb_rate_radps: self.climb_rate_radps.or(other.climb_rate_radps),
            dead_time_s: self.dead_time_s.or(other.dead_time_s),
            bank_time_constant_s: self.bank_time_constant_s.or(other.bank_time_constant_s),
            turn_rate_factor: self.turn_rate_factor.or(other.turn_rate_factor),
            wind_error_mps: self.wind_error_mps.or(other.wind_error_mps),
        }
    }

    /// The aircraft that flies where the pilot knows a vehicle.
    pub fn vehicle(&self, known: &Vehicle) -> Vehicle {
        let mut vehicle = match self.airspeed_mps {
            Some(airspeed_mps) => at_airspeed(known, airspeed_mps),
            None => *known,
        };
        let response = &mut vehicle.response;
        for (value, other) in [
            (&mut vehicle.climb_rate_radps, self.climb_rate_radps),
            (&mut response.dead_time_s, self.dead_time_s),
            (
                &mut response.bank_time_constant_s,
                self.bank_time_constant_s,
            ),
            (&mut response.turn_rate_factor, self.turn_rate_factor),
        ] {
            *value = other.unwrap_or(*value);
        }
        vehicle
    }

    /// The wind that blows where the pilot knows one, metres per second.
    pub fn wind_mps(&self, known_mps: Vec3) -> Vec3 {
        match self.wind_error_mps {
            Some(error_mps) => known_mps + Vec3::from_array(error_mps),
            None => known_mps,
        }
    }

    /// The limits that the pilot is shown of an aircraft that flies, at its present speed, where it knows a vehicle.
    pub fn shown(&self, flies: &Vehicle, known: &Vehicle) -> Vehicle {
        let airspeed_mps = self.shown_mps(flies.airspeed_mps, known);
        Vehicle {
            climb_rate_radps: known.climb_rate_radps,
            response: known.response,
            ..match self.airspeed_mps {
                Some(_) => at_airspeed(flies, airspeed_mps),
                None => *flies,
            }
        }
    }

    /// The same of the state of the aircraft.
    pub fn shown_state(&self, ownship: Ownship, known: &Vehicle) -> Ownship {
        Ownship {
            airspeed_mps: self.shown_mps(ownship.airspeed_mps, known),
            ..ownship
        }
    }

    /// An airspeed as it is shown: wrong by one factor throughout.
    fn shown_mps(&self, airspeed_mps: f64, known: &Vehicle) -> f64 {
        match self.airspeed_mps {
            Some(real_mps) => airspeed_mps * (known.airspeed_mps / real_mps),
            None => airspeed_mps,
        }
    }
}

/// The vehicle at another airspeed, with the same largest bank angle (ρ ∝ V², Eq. 8); unchanged
/// for a speed that is not positive.
pub fn at_airspeed(vehicle: &Vehicle, airspeed_mps: f64) -> Vehicle {
    if !(airspeed_mps.is_finite() && airspeed_mps > 0.0) {
        return *vehicle;
    }
    let ratio = airspeed_mps / vehicle.airspeed_mps;
    Vehicle {
        airspeed_mps,
        turn_radius_m: vehicle.turn_radius_m * ratio * ratio,
        ..*vehicle
    }
}
