//! Encounters drawn at random: the cells of Table 4 and families that are hard.
//!
//! The aircraft starts at the origin, level, along +x. An obstacle is a *threat* if it and the
//! aircraft, both on constant courses, come closer than its protected radius. Every encounter has its
//! own random stream (`ChaCha8`, stream = its number), so it can be drawn alone and does not depend on
//! the previous ones. Numbers become floats by plain IEEE operations and `libm`, so an encounter is the
//! same on every machine.

mod draw;
mod family;
pub mod fleet;
pub mod modeled;
pub(crate) mod parse;
pub(crate) mod random;
mod scenery;
mod source;

pub use family::{DrawnThreats, Family, Landscape, Range};
pub use random::Random;
pub use scenery::Scenery;
pub use source::{Body, EncounterSource};

use draw::LATEST_MEETING_S;
use fga::situation::{Obstacle, ProtectedVolume};
use fga_formats::encounters::Encounter;

use crate::oracle::{
    AVOIDABLE_MARGIN_M, OracleObstacle, OracleSettings, OracleStart, OracleVehicle, Stages,
    best_margin,
};

impl EncounterSource {
    /// The encounter with this number.
    ///
    /// # Errors
    /// One sentence where hardly any draw suits, as with threats that are too far away to be met.
    pub fn encounter(&self, number: u64) -> Result<Encounter, String> {
        self.encounter_while(number, &|| true)
    }

    /// The same, and an error where `go_on` ends a draw that takes long.
    pub(crate) fn encounter_while(
        &self,
        number: u64,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Encounter, String> {
        let mut random = Random::with_stop(self.seed, number, go_on);
        let obstacles = self.obstacles(&mut random).ok_or_else(|| {
            format!(
                "hardly any draw has obstacles outside of their radius of {} m that meet the aircraft, which flies at \
                 {} m/s, within {LATEST_MEETING_S} s, expected other distances or speeds",
                self.radius_m, self.airspeed_mps
            )
        })?;
        let volume = ProtectedVolume::Sphere {
            radius_m: self.radius_m,
        };
        Ok(Encounter {
            id: number,
            obstacles: obstacles
                .into_iter()
                .zip(0..)
                .map(|(body, id)| {
                    Obstacle::straight(id, body.position_m, body.velocity_mps, volume)
                })
                .collect(),
        })
    }

    /// Draws until the draw suits.
    fn obstacles(&self, random: &mut Random) -> Option<Vec<Body>> {
        let mut obstacles = loop {
            random.again()?;
            let drawn = self.family.draw(self, random)?;
            if self.clear_at_start(&drawn) && self.suits(&drawn) {
                break drawn;
            }
        };
        if let Some(threats) = self.bystanders {
            // The threats are 20 to 30 % of all objects.
            for _ in 0..random.count((threats * 7).div_ceil(3), threats * 4) {
                obstacles.push(self.bystander(random)?);
            }
        }
        Some(obstacles)
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

    fn bystander(&self, random: &mut Random) -> Option<Body> {
        loop {
            random.again()?;
            let distance_m = random.within(Range(100.0, 500.0));
            let body = Body {
                position_m: random.direction(self.planar) * distance_m,
                velocity_mps: random.direction(self.planar) * random.within(Range(0.0, 60.0)),
            };
            if distance_m > self.radius_m && !self.is_threat(&body) {
                return Some(body);
            }
        }
    }
}
