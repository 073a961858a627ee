//! Encounters drawn at random: the cells of Table 4 and families that are hard.
//!
//! The aircraft starts at the origin, level, along +x. An obstacle is a *threat* if it and the
//! aircraft, both on constant courses, come closer than its protected radius. Every encounter has its
//! own random stream (`ChaCha8`, stream = its number), so it can be drawn alone and does not depend on
//! the previous ones. Numbers become floats by plain IEEE operations and `libm`, so an encounter is the
//! same on every machine.

mod family;
pub mod fleet;
pub mod modeled;
pub(crate) mod parse;
pub(crate) mod random;

pub use family::{Family, Range};
pub use random::Random;

use fga::Vec3;
use fga::situation::{Obstacle, ProtectedVolume};
use fga_formats::encounters::Encounter;

use crate::oracle::{
    AVOIDABLE_MARGIN_M, OracleObstacle, OracleSettings, OracleStart, OracleVehicle, Stages,
    best_margin,
};

/// Objects that are no threat, among which the threats hide (§2.3 (5)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bystanders {
    /// Their number, both ends included.
    pub count: (u32, u32),
    /// Their distances from the aircraft at the start, metres.
    pub distance_m: Range,
}

impl Bystanders {
    /// The number that makes `threats` 20–30 % of all objects.
    pub fn of_section_2_3(threats: u32) -> Self {
        Self {
            count: ((threats * 7).div_ceil(3), threats * 4),
            distance_m: Range(100.0, 500.0),
        }
    }
}

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
    /// Objects that are no threat.
    pub bystanders: Option<Bystanders>,
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

    /// The encounter with this number.
    pub fn encounter(&self, number: u64) -> Encounter {
        let mut random = Random::new(self.seed, number);
        let mut obstacles = loop {
            let drawn = self.family.draw(self, &mut random);
            if self.clear_at_start(&drawn) && self.suits(&drawn) {
                break drawn;
            }
        };
        if let Some(bystanders) = self.bystanders {
            let count = random.count(bystanders.count.0, bystanders.count.1);
            for _ in 0..count {
                obstacles.push(self.bystander(&bystanders, &mut random));
            }
        }
        let volume = ProtectedVolume::Sphere {
            radius_m: self.radius_m,
        };
        Encounter {
            id: number,
            obstacles: obstacles
                .into_iter()
                .zip(0..)
                .map(|(body, id)| {
                    Obstacle::straight(id, body.position_m, body.velocity_mps, volume)
                })
                .collect(),
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

    fn clear_at_start(&self, bodies: &[Body]) -> bool {
        bodies
            .iter()
            .all(|body| body.position_m.dot(body.position_m) > self.radius_m * self.radius_m)
    }

    /// Whether the draw suits the family; only pincers require more than their shape.
    fn suits(&self, bodies: &[Body]) -> bool {
        let Family::Pincer { .. } = self.family else {
            return true;
        };
        let mut vehicle = OracleVehicle::table_4();
        vehicle.course_rate_radps *= self.airspeed_mps / vehicle.airspeed_mps;
        vehicle.airspeed_mps = self.airspeed_mps;
        if self.planar {
            vehicle = vehicle.planar();
        }
        let obstacles: Vec<_> = bodies
            .iter()
            .map(|b| OracleObstacle::sphere(b.position_m, b.velocity_mps, self.radius_m))
            .collect();
        let margin = |stages, enough_m| {
            best_margin(
                &OracleStart::ORIGIN,
                &vehicle,
                &obstacles,
                &OracleSettings {
                    stages,
                    enough_m: Some(enough_m),
                    ..OracleSettings::default()
                },
            )
            .best_margin_m
        };
        // Where one turn loses by more, two turns hardly ever save it.
        let one = margin(Stages::One, 0.0);
        (-5.0..0.0).contains(&one) && margin(Stages::Two, AVOIDABLE_MARGIN_M) >= AVOIDABLE_MARGIN_M
    }

    fn bystander(&self, bystanders: &Bystanders, random: &mut Random) -> Body {
        loop {
            let distance_m = random.within(bystanders.distance_m);
            let body = Body {
                position_m: random.direction(self.planar) * distance_m,
                velocity_mps: random.direction(self.planar) * random.within(Range(0.0, 60.0)),
            };
            if distance_m > self.radius_m && !self.is_threat(&body) {
                return body;
            }
        }
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
