//! Many worlds side by side for policies that learn: numbers in, numbers out, one decision period a step.
//!
//! Each world is a drawn encounter: the aircraft on its line along +x, obstacles around it. An observation
//! holds [`OWN`] numbers of the aircraft and [`EACH`] for each of the nearest known obstacles, in the frame of
//! its course: x forward, y left, z up.
//!
//! | place | number | unit |
//! |---|---|---|
//! | 0, 1 | distance beside the line, positive to the left; height above it | m |
//! | 2, 3 | sine and cosine of the course from the line | |
//! | 4, 5 | climb angle, bank angle | rad |
//! | 6 | airspeed | m/s |
//! | then, for each obstacle, 0 | 1 if there is one, else all its numbers are 0 | |
//! | 1–3 | its position from the aircraft | m |
//! | 4–6 | its velocity over the ground less the aircraft's | m/s |
//! | 7, 8 | radius and half height of its volume | m |
//!
//! An action is two numbers from −1 to 1: the turn from the present course, as a share of 90° to the left, and
//! the climb angle, as a share of the limit up or down. A number that is not finite holds the present value.
//!
//! The reward of a step is minus the distance from the line, as a share of 500 m, times the period in
//! seconds; entering a volume costs [`ENTERED_REWARD`] and ends the flight.

use fga::Vec3;
use fga::angle::direction;
use fga::avoider::{Decision, Reason, SettingsError, State};
use fga::maneuver::Maneuver;
use fga::situation::{Obstacle, Ownship};
use fga_sim::engine::SteppedFlight;
use fga_sim::policy::PolicyChoice;
use fga_sim::shield::Shield;
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::world::World;

use crate::batch::{BatchSettings, empty_world, populate};
use crate::encounters::EncounterSource;

/// Numbers of the aircraft in an observation.
pub const OWN: usize = 7;

/// Numbers of each obstacle in an observation.
pub const EACH: usize = 9;

/// Reward of entering a protected volume.
pub const ENTERED_REWARD: f64 = -100.0;

/// The distance from the line with a reward of −1 per second, metres.
const FAR_M: f64 = 500.0;

/// The settings.
#[derive(Debug, Clone, PartialEq)]
pub struct WorldsSettings {
    /// The encounters; their airspeed and radius belong to the aircraft.
    pub source: EncounterSource,
    /// The aircraft.
    pub model: VehicleModel,
    /// Longest flight, seconds.
    pub horizon_s: f64,
    /// Obstacles in an observation.
    pub seen: usize,
    /// Whether a shield filters the actions.
    pub shielded: bool,
}

/// The result of a step for one world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stepped {
    /// The reward.
    pub reward: f64,
    /// Whether the aircraft entered a protected volume.
    pub terminated: bool,
    /// Whether the flight ended otherwise: back on the line with everything passed, or at its longest.
    pub truncated: bool,
    /// Whether the shield flew instead of the action.
    pub engaged: bool,
}

impl Stepped {
    /// No flight.
    pub const STILL: Self = Self {
        reward: 0.0,
        terminated: false,
        truncated: false,
        engaged: false,
    };
}

/// One of the worlds.
#[derive(Debug)]
struct WorldPlace {
    flight: SteppedFlight,
    shield: Option<Shield>,
}

/// Worlds side by side.
#[derive(Debug)]
pub struct Worlds {
    settings: WorldsSettings,
    empty: World,
    places: Vec<WorldPlace>,
    nearest: Vec<(f64, Obstacle)>,
}

/// Reasons why worlds cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum WorldsError {
    /// Settings or limits that the core refuses.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The wind is too strong to hold the line.
    #[error("the wind does not let the line be flown at an airspeed of {0} m/s, expected less")]
    Wind(f64),
    /// An encounter that cannot be drawn.
    #[error("{0}")]
    Drawn(String),
}

impl Worlds {
    /// `count` worlds, which show encounters 0 to `count` − 1 until a reset.
    ///
    /// # Errors
    /// Settings that the core refuses, a wind that is too strong for the line, or encounters that cannot be drawn.
    pub fn new(mut settings: WorldsSettings, count: usize) -> Result<Self, WorldsError> {
        let model = &settings.model;
        settings.source = settings.source.around(model);
        let batch = BatchSettings {
            horizon_s: settings.horizon_s,
            seed: settings.source.seed,
            ..BatchSettings::of(model.clone(), PolicyChoice::default())
        };
        let empty = empty_world(&batch).ok_or(WorldsError::Wind(model.vehicle.airspeed_mps))?;
        batch.policy.pilot(&empty.settings, &empty.vehicle)?;
        let mut worlds = Self {
            places: Vec::with_capacity(count),
            nearest: Vec::new(),
            empty,
            settings,
        };
        for number in (0..).take(count) {
            let flight = SteppedFlight::new(worlds.drawn(number)?);
            let shield = worlds
                .settings
                .shielded
                .then(|| {
                    let vehicle = worlds.settings.model.vehicle;
                    Shield::new(worlds.empty.settings.avoider, vehicle)
                })
                .transpose()?;
            worlds.places.push(WorldPlace { flight, shield });
        }
        Ok(worlds)
    }

    /// Number of worlds.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Length of an observation.
    pub const fn observed(&self) -> usize {
        OWN + EACH * self.settings.seen
    }

    fn drawn(&self, number: u64) -> Result<World, WorldsError> {
        let source = &self.settings.source;
        let encounter = source.encounter(number).map_err(WorldsError::Drawn)?;
        let mut world = self.empty.clone();
        populate(&mut world, &encounter, &self.settings.model.protection);
        source.scenery(number).place(&mut world);
        Ok(world)
    }

    /// Loads the encounter with this number into a world; ignores an unknown world.
    ///
    /// # Errors
    /// An encounter that cannot be drawn.
    pub fn reset(&mut self, index: usize, number: u64) -> Result<(), WorldsError> {
        let world = self.drawn(number)?;
        if let Some(place) = self.places.get_mut(index) {
            place.flight.restart(world);
            if let Some(shield) = &mut place.shield {
                shield.restart();
            }
        }
        Ok(())
    }

    /// Writes the observation of a world into `into`, which has [`Worlds::observed`] places.
    pub fn observe(&mut self, index: usize, into: &mut [f32]) {
        into.fill(0.0);
        let Some(place) = self.places.get(index) else {
            return;
        };
        let own = place.flight.ownship();
        let [forward, left] = axes(own);
        write(into, &of_aircraft(own));
        let Some(situation) = place.flight.situation() else {
            return;
        };
        let ground_mps = own.velocity_mps() + situation.wind_mps;
        self.nearest.clear();
        let known = situation.obstacles.iter();
        self.nearest.extend(known.map(|obstacle| {
            let distance_m = obstacle.position_m.distance(own.position_m);
            (distance_m - obstacle.volume.bounding_radius_m(), obstacle)
        }));
        self.nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        let rows = into.get_mut(OWN..).unwrap_or_default();
        for (row, (_, obstacle)) in rows.chunks_exact_mut(EACH).zip(&self.nearest) {
            let from = obstacle.position_m - own.position_m;
            let relative = obstacle.velocity_mps - ground_mps;
            let values = [
                1.0,
                from.dot(forward),
                from.dot(left),
                from.z,
                relative.dot(forward),
                relative.dot(left),
                relative.z,
                obstacle.volume.radius_m(),
                obstacle.volume.half_height_m(),
            ];
            write(row, &values);
        }
    }

    /// Flies an action in a world until the next decision. An ended flight stays at its end.
    pub fn step(&mut self, index: usize, turn: f64, climb: f64) -> Stepped {
        let mut stepped = Stepped {
            truncated: true,
            ..Stepped::STILL
        };
        let vehicle = &self.settings.model.vehicle;
        let Some(place) = self.places.get_mut(index) else {
            return stepped;
        };
        if place.flight.situation().is_none() {
            return stepped;
        }
        let own = place.flight.ownship();
        let turn_rad = if turn.is_finite() {
            turn.clamp(-1.0, 1.0) * core::f64::consts::FRAC_PI_2
        } else {
            0.0
        };
        let climb_rad = if climb >= 0.0 {
            climb.min(1.0) * vehicle.climb_max_rad
        } else if climb < 0.0 {
            climb.max(-1.0) * -vehicle.climb_min_rad
        } else {
            own.climb_rad
        };
        let wish = Maneuver::turn(0.0, own.course_rad + turn_rad, climb_rad);
        let shielded = (place.shield.as_mut())
            .and_then(|shield| (place.flight).show(|situation| shield.step(situation, &wish)));
        stepped.engaged = shielded.as_ref().is_some_and(|shielded| shielded.engaged);
        let decision = shielded.map_or_else(
            || Decision::new(State::Cruise, &wish, Reason::Clear),
            |shielded| shielded.decision,
        );
        let goes_on = place.flight.advance(&decision, &mut ());
        let off_m = libm::hypot(
            place.flight.ownship().position_m.y,
            place.flight.ownship().position_m.z,
        );
        let period_s = self.empty.settings.avoider.decision_period_s;
        stepped.reward = -period_s * (off_m / FAR_M).min(1.0);
        let mut separations = place.flight.separations();
        stepped.terminated = separations.any(|s| s.margin().value_m < 0.0);
        stepped.truncated = !goes_on && !stepped.terminated;
        if stepped.terminated {
            stepped.reward += ENTERED_REWARD;
        }
        stepped
    }
}

/// Forward and left, level, of an aircraft.
fn axes(own: &Ownship) -> [Vec3; 2] {
    let forward = direction(own.course_rad, 0.0);
    [forward, Vec3::new(-forward.y, forward.x, 0.0)]
}

fn of_aircraft(own: &Ownship) -> [f64; OWN] {
    [
        own.position_m.y,
        own.position_m.z,
        libm::sin(own.course_rad),
        libm::cos(own.course_rad),
        own.climb_rad,
        own.bank_rad,
        own.airspeed_mps,
    ]
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "policies that learn take f32"
)]
fn write(into: &mut [f32], values: &[f64]) {
    for (place, value) in into.iter_mut().zip(values) {
        *place = *value as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worlds(shielded: bool) -> Worlds {
        let settings = WorldsSettings {
            source: EncounterSource::parse("threats:1:300:5-20", 3).unwrap(),
            model: VehicleModel::built_in().unwrap(),
            horizon_s: 60.0,
            seen: 2,
            shielded,
        };
        Worlds::new(settings, 8).unwrap()
    }

    #[test]
    fn holding_the_course_enters_what_threatens_and_the_shield_prevents_it() {
        let fly = |shielded| {
            let mut worlds = worlds(shielded);
            (0..worlds.len())
                .filter(|index| {
                    loop {
                        let stepped = worlds.step(*index, 0.0, 0.0);
                        if stepped.terminated || stepped.truncated {
                            break stepped.terminated;
                        }
                    }
                })
                .count()
        };
        assert_eq!(fly(false), 8, "each of them threatens");
        assert_eq!(fly(true), 0);
    }

    #[test]
    fn an_observation_shows_the_obstacle_where_it_is() {
        let mut worlds = worlds(false);
        let mut seen = vec![0.0; worlds.observed()];
        worlds.observe(0, &mut seen);
        let obstacle = worlds.settings.source.encounter(0).unwrap().obstacles[0];
        assert_eq!(seen[OWN], 1.0);
        let distance_m = seen[OWN + 1].hypot(seen[OWN + 2]).hypot(seen[OWN + 3]);
        assert!((f64::from(distance_m) - obstacle.position_m.length()).abs() < 0.01);
        assert!(seen[OWN + EACH..].iter().all(|value| *value == 0.0));
        assert_eq!(seen[6], 15.0);
    }
}
