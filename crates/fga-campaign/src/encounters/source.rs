//! What encounters are drawn from.

use fga::Vec3;
use fga_sim::vehicle_file::VehicleModel;

use super::family::Family;

/// A cell or family with all parameters of its encounters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EncounterSource {
    /// The family.
    pub family: Family,
    /// Whether everything happens at the aircraft's altitude.
    pub planar: bool,
    /// Protected radius `d_m`, metres.
    pub radius_m: f64,
    /// Airspeed of the aircraft, metres per second.
    pub airspeed_mps: f64,
    /// The number of threats that hide among objects that are no threat (§2.3 (5)), if they do.
    pub bystanders: Option<u32>,
    /// Master seed.
    pub seed: u64,
}

impl EncounterSource {
    /// A cell for Table 4's aircraft: 15 m/s, `d_m` 30 m, no bystanders.
    pub const fn table_4(family: Family, planar: bool, seed: u64) -> Self {
        Self {
            family,
            planar,
            radius_m: 30.0,
            airspeed_mps: 15.0,
            bystanders: None,
            seed,
        }
    }

    /// The same around another aircraft.
    #[must_use]
    pub const fn around(self, model: &VehicleModel) -> Self {
        Self {
            airspeed_mps: model.vehicle.airspeed_mps,
            radius_m: model.protection.radius_m(),
            ..self
        }
    }

    /// Whether a body and the aircraft, both on constant courses, come closer than `d_m`.
    pub fn is_threat(&self, body: &Body) -> bool {
        let relative = body.velocity_mps - Vec3::X * self.airspeed_mps;
        let closing = -body.position_m.dot(relative);
        let speed_squared = relative.dot(relative);
        if closing <= 0.0 || speed_squared <= 0.0 {
            return false;
        }
        let miss = body.position_m + relative * (closing / speed_squared);
        miss.dot(miss) < self.radius_m * self.radius_m
    }
}

/// Position and velocity of an obstacle at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Position, metres.
    pub position_m: Vec3,
    /// Velocity, metres per second.
    pub velocity_mps: Vec3,
}
