//! Encounters drawn from the models of MIT Lincoln Laboratory.
//!
//! Both aircraft fly second by second as the model draws them: turns, climbs, accelerations. They
//! meet at the closest approach, at [`Pairing::cpa_s`].
//!
//! **Uncorrelated models** draw one aircraft. Traffic of uniform density and any heading passes the
//! ownship; its horizontal closest approaches come at a rate of |v² + r·a| / v for each unit of the
//! plane across the relative velocity v, with r the offset and a the relative acceleration there
//! (Rice's formula for r·v = 0). So the draw takes intruders in proportion to v, the two miss
//! distances are uniform in a cylinder around the ownship, and the weight has the factor 1 + r·a/v².
//! Where that is not positive the aircraft are farthest there, not nearest: the draw is repeated.
//!
//! **The begin.** An intruder that turns or flies alongside may be near at other times too. Where the
//! aircraft begin within the well-clear volume of ASTM F3442, the loss is there before anybody can act,
//! and no system is judged by it: the draw is repeated.
//!
//! **Importance sampling.** Few encounters of the cylinder are near misses. A share of them comes
//! from an inner cylinder instead; the weight is the ratio of the densities, so that every weighted
//! mean holds for the whole cylinder. An encounter's weight is at most
//! 1 / (1 − share).
//!
//! **Correlated models** draw both aircraft and their miss distances. Rotation and translation give
//! them the drawn approach angle and miss distances at the closest approach; `\chi` gives the side,
//! chance gives above or below. The same importance sampling draws a share from encounters with miss
//! distances within the inner cylinder, whose probability is an estimate from 100,000 states.

use core::f64::consts::TAU;

use fga::Vec3;
use fga_alerts::volume::Cylinder;
use fga_alerts::{AircraftState, Pair, PairDeviation};
pub use fga_files::campaign::OwnshipFlight;
use fga_formats::daa::{Recording, Track, TrackSample};
use fga_formats::encounter_model::{EncounterModel, ModelRow};
use fga_formats::tally::Tally;
use serde::{Deserialize, Serialize};

use super::Random;

/// Most draws before an error.
const MOST_DRAWS: u32 = 100_000;

/// States for the estimate of the inner cylinder's probability.
const COUNTED: u32 = 100_000;

/// The largest change of altitude that may pair two aircraft of a model, metres: farther away
/// aircraft fly differently.
const FARTHEST_LAYER_M: f64 = 300.0;

/// Smaller relative speeds have no meaningful closest approach, metres per second.
const SLOWEST_MPS: f64 = 0.5;

/// How two aircraft meet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Pairing {
    /// The ownship's flight; a correlated model draws both.
    pub ownship: OwnshipFlight,
    /// Time of the closest approach, whole seconds.
    pub cpa_s: u32,
    /// Length of the encounter, whole seconds.
    pub duration_s: u32,
    /// Largest miss distances: horizontal, vertical, metres. Uncorrelated models only.
    pub cylinder_m: [f64; 2],
    /// Miss distances of the aimed encounters, metres.
    pub aimed_m: [f64; 2],
    /// Share of the aimed encounters.
    pub aimed_share: f64,
    /// Altitudes of the ownship at the closest approach, metres above ground.
    pub altitude_m: Option<[f64; 2]>,
    /// Speeds of the ownship at the closest approach, metres per second; where it flies straight and level, its
    /// airspeed is drawn from them, each as likely per time of flight.
    pub ownship_speed_mps: Option<[f64; 2]>,
    /// Speeds of the intruder at the closest approach, metres per second.
    pub intruder_speed_mps: Option<[f64; 2]>,
}

impl Default for Pairing {
    fn default() -> Self {
        Self {
            ownship: OwnshipFlight::Vehicle,
            cpa_s: 90,
            duration_s: 120,
            cylinder_m: [2000.0, 400.0],
            // 2,000 ft and 250 ft.
            aimed_m: [609.6, 76.2],
            aimed_share: 0.5,
            altitude_m: None,
            ownship_speed_mps: None,
            intruder_speed_mps: None,
        }
    }
}

impl Pairing {
    /// Checks the keys.
    ///
    /// # Errors
    /// One sentence that names the key.
    pub fn check(&self) -> Result<(), String> {
        if !(2..=3600).contains(&self.duration_s) {
            let found = self.duration_s;
            return Err(format!("duration_s is {found}, expected 2 to 3600"));
        }
        if !(1..self.duration_s).contains(&self.cpa_s) {
            return Err(format!(
                "cpa_s is {}, expected 1 to {}, within duration_s",
                self.cpa_s,
                self.duration_s - 1
            ));
        }
        if !(0.0..=0.99).contains(&self.aimed_share) {
            return Err(format!(
                "aimed_share is {}, expected 0 to 0.99: weights are up to 1 / (1 - aimed_share)",
                self.aimed_share
            ));
        }
        for (name, pair) in [("cylinder_m", self.cylinder_m), ("aimed_m", self.aimed_m)] {
            if !pair.iter().all(|m| *m > 0.0 && *m <= 1e5) {
                return Err(format!(
                    "{name} is {pair:?}, expected two lengths above 0 and up to 100000 m"
                ));
            }
        }
        for (name, range) in [
            ("altitude_m", self.altitude_m),
            ("ownship_speed_mps", self.ownship_speed_mps),
            ("intruder_speed_mps", self.intruder_speed_mps),
        ] {
            if let Some([low, high]) = range
                && !(low < high && low.is_finite() && high.is_finite())
            {
                let found = [low, high];
                return Err(format!("{name} is {found:?}, expected [least, most]"));
            }
        }
        if let (OwnshipFlight::Vehicle, Some([low, high])) = (self.ownship, self.ownship_speed_mps)
            && !(low >= 1.0 && high <= 1000.0)
        {
            return Err(format!(
                "ownship_speed_mps is {:?}, expected airspeeds of 1 to 1000 m/s",
                [low, high]
            ));
        }
        Ok(())
    }

    /// Whether miss distances belong to the aimed encounters.
    fn is_aimed(&self, horizontal_m: f64, vertical_m: f64) -> bool {
        horizontal_m.abs() <= self.aimed_m[0] && vertical_m.abs() <= self.aimed_m[1]
    }
}

/// A drawn encounter: the first aircraft is the ownship.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeledEncounter {
    /// Both aircraft.
    pub recording: Recording,
    /// Number of encounters of the model that it represents.
    pub weight: f64,
}

/// A model as a source of encounters.
#[derive(Debug, Clone)]
pub struct ModelSource {
    model: EncounterModel,
    pairing: Pairing,
    /// The vehicle's airspeed, metres per second.
    airspeed_mps: f64,
    seed: u64,
    /// Probability of the inner cylinder.
    aimed_probability: f64,
}

/// Positions and velocities of an aircraft, second by second.
type ModeledPath = Vec<ModelRow>;

impl ModelSource {
    /// A source of this model.
    ///
    /// # Errors
    /// One sentence about a model that draws neither one aircraft nor two, or about an invalid pairing.
    pub fn new(
        model: EncounterModel,
        pairing: Pairing,
        airspeed_mps: f64,
        seed: u64,
    ) -> Result<Self, String> {
        pairing.check()?;
        let aimed_probability = if model.is_correlated() {
            correlated_share(&model, &pairing)
        } else if model.is_uncorrelated() {
            let share = |axis: usize| (pairing.aimed_m[axis] / pairing.cylinder_m[axis]).min(1.0);
            share(0) * share(1)
        } else {
            return Err(
                "has variables neither of an uncorrelated model (L, v, \\dot v, \\dot h, \\dot \\psi) nor of a correlated one (L, \\chi, \\beta, v_1, v_2, …, hmd, vmd), expected one of them"
                    .into(),
            );
        };
        Ok(Self {
            model,
            pairing,
            airspeed_mps,
            seed,
            aimed_probability,
        })
    }

    /// Radius and half height of the cylinder of its miss distances, metres; a correlated model draws its own.
    pub fn cylinder_m(&self) -> Option<[f64; 2]> {
        (!self.model.is_correlated()).then_some(self.pairing.cylinder_m)
    }

    /// Its master seed.
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// The encounter with this number; it does not depend on the previous ones.
    ///
    /// # Errors
    /// One sentence if no draw of the model suits the pairing.
    pub fn encounter(&self, number: u64) -> Result<ModeledEncounter, String> {
        self.encounter_while(number, &|| true)
    }

    /// The same, and an error where `go_on` ends a draw that takes long.
    pub(crate) fn encounter_while(
        &self,
        number: u64,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<ModeledEncounter, String> {
        let mut random = Random::with_stop(self.seed, number, go_on);
        for _ in 0..MOST_DRAWS {
            if random.again().is_none() {
                break;
            }
            let drawn = if self.model.is_correlated() {
                self.both(&mut random)
            } else {
                self.each(&mut random)
            };
            if let Some((own, intruder, weight)) = drawn
                && self.suits(&own, &intruder)
            {
                let track = |name: &str, rows: &[ModelRow]| Track {
                    name: name.to_owned(),
                    samples: rows.iter().map(sample_of).collect(),
                };
                return Ok(ModeledEncounter {
                    recording: Recording {
                        aircraft: vec![track("ownship", &own), track("intruder", &intruder)],
                        frame: None,
                        parameters: Vec::new(),
                        tally: Tally::default(),
                    },
                    weight,
                });
            }
        }
        Err(format!(
            "none of {MOST_DRAWS} draws suits altitude_m, ownship_speed_mps and intruder_speed_mps and begins well clear, expected limits that the model reaches and a later cpa_s"
        ))
    }

    /// The ratio of the true density and the sampling density of the miss distances.
    fn weight(&self, is_aimed: bool) -> f64 {
        let share = self.pairing.aimed_share;
        if self.aimed_probability <= 0.0 {
            return 1.0;
        }
        let more = if is_aimed {
            share / self.aimed_probability
        } else {
            0.0
        };
        1.0 / (1.0 - share + more)
    }

    /// Miss distances of the cylinder, signed, and their weight.
    fn miss(&self, random: &mut Random) -> (f64, f64, f64) {
        let pairing = &self.pairing;
        let inner = random.unit() < pairing.aimed_share;
        let mut within = |axis: usize| {
            let whole_m = pairing.cylinder_m[axis];
            let most_m = if inner {
                pairing.aimed_m[axis].min(whole_m)
            } else {
                whole_m
            };
            most_m * (2.0 * random.unit() - 1.0)
        };
        let (horizontal_m, vertical_m) = (within(0), within(1));
        let weight = self.weight(pairing.is_aimed(horizontal_m, vertical_m));
        (horizontal_m, vertical_m, weight)
    }

    /// An ownship and an intruder of an uncorrelated model.
    fn each(&self, random: &mut Random) -> Option<(ModeledPath, ModeledPath, f64)> {
        let duration_s = self.pairing.duration_s;
        let at = self.pairing.cpa_s as usize;
        let intruder = self.model.fly(duration_s, &mut || random.unit())?;
        let intruder = turned(&intruder, TAU * random.unit());
        let (mut own, own_fastest_mps) = match self.pairing.ownship {
            OwnshipFlight::Model => (
                self.model.fly(duration_s, &mut || random.unit())?,
                self.model.fastest_mps()?,
            ),
            OwnshipFlight::Vehicle => match self.pairing.ownship_speed_mps {
                Some([least_mps, most_mps]) => {
                    let speed_mps = least_mps + (most_mps - least_mps) * random.unit();
                    (straight(duration_s, speed_mps), most_mps)
                }
                None => (straight(duration_s, self.airspeed_mps), self.airspeed_mps),
            },
        };
        let relative_mps = relative_at(&own, &intruder, at)?;
        let speed_mps = relative_mps.length();
        let fastest_mps = self.model.fastest_mps()? + own_fastest_mps;
        if speed_mps < SLOWEST_MPS || random.unit() * fastest_mps >= speed_mps {
            return None;
        }
        let (horizontal_m, vertical_m, weight) = self.miss(random);
        let across = Vec3::new(-relative_mps.y, relative_mps.x, 0.0) / speed_mps;
        let offset_m = across * horizontal_m;
        let acceleration =
            0.5 * (relative_at(&own, &intruder, at + 1)? - relative_at(&own, &intruder, at - 1)?);
        let bend = 1.0 + offset_m.dot(acceleration) / (speed_mps * speed_mps);
        if bend <= 0.0 {
            return None;
        }
        let mut intruder = intruder;
        let there_m = intruder.get(at)?.position_m;
        if self.pairing.ownship == OwnshipFlight::Vehicle {
            // The ownship flies where the intruder is; the intruder flies as the model has it there.
            let height_m = there_m.z - vertical_m;
            moved(&mut own, Vec3::new(0.0, 0.0, height_m));
        }
        let here_m = own.get(at)?.position_m;
        let shift_m = here_m + offset_m + Vec3::Z * vertical_m - there_m;
        if shift_m.z.abs() > FARTHEST_LAYER_M {
            return None;
        }
        moved(&mut intruder, shift_m);
        Some((own, intruder, weight * bend))
    }

    /// Both aircraft of a correlated model.
    fn both(&self, random: &mut Random) -> Option<(ModeledPath, ModeledPath, f64)> {
        let pairing = &self.pairing;
        let at = pairing.cpa_s as usize;
        let inner = self.aimed_probability > 0.0 && random.unit() < pairing.aimed_share;
        let pair = (0..MOST_DRAWS).find_map(|_| {
            self.model
                .fly_pair(
                    pairing.duration_s,
                    &mut || random.unit(),
                    |miss_m, height_m| !inner || pairing.is_aimed(miss_m, height_m),
                )
                .flatten()
        })?;
        let weight = self.weight(pairing.is_aimed(pair.miss_m, pair.height_m));
        let [own, intruder] = pair.flights;
        let (own_mps, its_mps) = (own.get(at)?.velocity_mps, intruder.get(at)?.velocity_mps);
        let course = |v: Vec3| libm::atan2(v.y, v.x);
        // Clockwise from the first one's heading.
        let turn_rad = course(own_mps) - pair.approach_rad - course(its_mps);
        let mut intruder = turned(&intruder, turn_rad);
        let relative_mps = relative_at(&own, &intruder, at)?;
        let speed_mps = relative_mps.length();
        if speed_mps < SLOWEST_MPS {
            return None;
        }
        let across = Vec3::new(-relative_mps.y, relative_mps.x, 0.0) / speed_mps;
        let side = if (across.dot(own_mps) >= 0.0) == pair.is_ahead {
            1.0
        } else {
            -1.0
        };
        let offset_m = across * (side * pair.miss_m) + Vec3::Z * (random.sign() * pair.height_m);
        let shift_m = own.get(at)?.position_m + offset_m - intruder.get(at)?.position_m;
        moved(&mut intruder, shift_m);
        Some((own, intruder, weight))
    }

    /// Whether two flights begin well clear, stay above ground and are within the limits.
    fn suits(&self, own: &[ModelRow], intruder: &[ModelRow]) -> bool {
        let at = self.pairing.cpa_s as usize;
        let within = |range: Option<[f64; 2]>, value: Option<f64>| {
            range.is_none_or(|[low, high]| value.is_some_and(|v| (low..=high).contains(&v)))
        };
        let speed = |rows: &[ModelRow]| rows.get(at).map(|row| row.velocity_mps.length());
        let altitude_m = own.get(at).map(|row| row.position_m.z);
        own.iter()
            .chain(intruder)
            .all(|row| row.position_m.z >= 0.0)
            && own.first().zip(intruder.first()).is_some_and(begin_clear)
            && within(self.pairing.altitude_m, altitude_m)
            && within(self.pairing.ownship_speed_mps, speed(own))
            && within(self.pairing.intruder_speed_mps, speed(intruder))
    }
}

/// The share of a correlated model's encounters with miss distances of the inner cylinder.
fn correlated_share(model: &EncounterModel, pairing: &Pairing) -> f64 {
    let mut random = Random::new(0, u64::MAX);
    let mut inside = 0_u32;
    for _ in 0..COUNTED {
        // An unwanted pair draws only its state, not its flight.
        let mut is_inside = false;
        let _ = model.fly_pair(0, &mut || random.unit(), |miss_m, height_m| {
            is_inside = pairing.is_aimed(miss_m, height_m);
            false
        });
        inside += u32::from(is_inside);
    }
    f64::from(inside) / f64::from(COUNTED)
}

/// Whether two aircraft are well clear (ASTM F3442) where they begin.
fn begin_clear((own, intruder): (&ModelRow, &ModelRow)) -> bool {
    let state = |row: &ModelRow| AircraftState {
        position_m: row.position_m,
        velocity_mps: row.velocity_mps,
    };
    !Cylinder::F3442.is_violated(&Pair {
        ownship: state(own),
        intruder: state(intruder),
        deviation: PairDeviation::default(),
    })
}

fn sample_of(row: &ModelRow) -> TrackSample {
    TrackSample::new(row.time_s, row.position_m, row.velocity_mps)
}

/// Horizontal velocity of the intruder relative to the ownship in a second.
fn relative_at(own: &[ModelRow], intruder: &[ModelRow], second: usize) -> Option<Vec3> {
    let relative_mps = intruder.get(second)?.velocity_mps - own.get(second)?.velocity_mps;
    Some(Vec3::new(relative_mps.x, relative_mps.y, 0.0))
}

/// A level flight along +x from the origin.
fn straight(duration_s: u32, airspeed_mps: f64) -> ModeledPath {
    (0..=duration_s)
        .map(|second| ModelRow {
            time_s: f64::from(second),
            position_m: Vec3::X * (airspeed_mps * f64::from(second)),
            velocity_mps: Vec3::X * airspeed_mps,
        })
        .collect()
}

/// A flight rotated about the vertical through the origin, anticlockwise.
fn turned(rows: &[ModelRow], angle_rad: f64) -> ModeledPath {
    let (sin, cos) = libm::sincos(angle_rad);
    let turn = |v: Vec3| Vec3::new(v.x * cos - v.y * sin, v.x * sin + v.y * cos, v.z);
    rows.iter()
        .map(|row| ModelRow {
            position_m: turn(row.position_m),
            velocity_mps: turn(row.velocity_mps),
            ..*row
        })
        .collect()
}

fn moved(rows: &mut [ModelRow], shift_m: Vec3) {
    for row in rows {
        row.position_m += shift_m;
    }
}
