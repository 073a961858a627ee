//! Adaptive stress testing: a search for the likeliest motions of an intruder, and losses of its reports, in which a policy
//! enters the protected volume.
//!
//! A motion is a point z of a standard normal distribution in as many dimensions as it has parameters ([`Parameter`]); each parameter is
//! a quantile of a usual distribution, within the bounds that the policy is told ([`MovementBounds`]). The cross-entropy
//! method (Rubinstein 1999; Lee et al. 2015 for collision avoidance) flies batches of motions, and draws the next batch near those
//! that came nearest to a failure. One flight in ten is drawn from the usual distribution, so that the weights of the flights are
//! bounded and their sum estimates the probability of a loss. In the end each parameter that a failure does not
//! need is set to its median; the other parameters explain the failure.

mod motion;
mod urgency;

pub use motion::{Motion, PARAMETERS, Parameter};

use fga::avoider::SettingsError;
use fga::situation::MovementBounds;
use rayon::prelude::*;

use crate::batch::{self, BatchSettings, empty_world};
use crate::encounters::random::Random;
use crate::engine::Engine;
use crate::oracle::{AVOIDABLE_MARGIN_M, OracleSettings, best_margin_of_tracks};
use crate::own::FailureKind;
use crate::policy::PolicyChoice;
use crate::run::{Plan, RunLog};
use crate::track::{Track, TrackPoint};
use crate::vehicle_file::VehicleModel;
use crate::world::World;
use urgency::Urgency;

/// Flights of a batch.
const BATCH: usize = 200;

/// Share of the flights that are drawn from the usual distribution.
const USUAL_SHARE: f64 = 0.1;

/// Share of a batch near which the next one is drawn.
const ELITE_SHARE: f64 = 0.1;

/// Weight of a batch's own mean and spread in those of the next one.
const SMOOTHING: f64 = 0.6;

/// Least spread of a parameter, in standard deviations of its usual distribution.
const LEAST_SPREAD: f64 = 0.3;

/// Two failures nearer than this are the same one.
const SAME_FAILURE: f64 = 1.0;

/// Failures that are simplified and shown.
const SHOWN: usize = 10;

/// Longest flight, seconds.
const HORIZON_S: f64 = 180.0;

/// What is tested.
#[derive(Debug, Clone)]
pub struct Stress {
    /// The aircraft.
    pub model: VehicleModel,
    /// The policy.
    pub policy: PolicyChoice,
    /// The bounds of the intruder, which the policy knows.
    pub bounds: MovementBounds,
    /// Flights, besides those that simplify failures.
    pub flights: usize,
    /// Master seed.
    pub seed: u64,
}

/// A point of the standard normal distribution.
type Point = [f64; PARAMETERS.len()];

/// A motion in which the policy entered the volume.
#[derive(Debug, Clone, PartialEq)]
pub struct StressFailure {
    /// The motion.
    pub motion: Motion,
    /// Its distance from the most usual motion, in standard deviations: the less, the likelier.
    pub distance: f64,
    /// Parameters that are not at their median, by their place in [`PARAMETERS`].
    pub needed: Vec<usize>,
    /// Least signed distance to the volume, metres.
    pub margin_m: f64,
    /// Whether a manoeuvre with the whole motion known keeps out.
    pub avoidable: bool,
    /// How a policy of one's own failed in it.
    pub policy_failure: Option<FailureKind>,
}

impl StressFailure {
    /// The density of its motion over that of the most usual one.
    pub fn relative_density(&self) -> f64 {
        libm::exp(-0.5 * self.distance * self.distance)
    }
}

/// What the search found.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Flights of the search.
    pub flights: usize,
    /// Motions that begin too near to say anything; they are no failures.
    pub too_near: usize,
    /// Flights that entered the volume.
    pub entered: usize,
    /// Number of the first of them, from 1.
    pub first: Option<usize>,
    /// Estimated probability of entering the volume under the usual distribution, and its standard error.
    pub probability: (f64, f64),
    /// Flights that simplified failures.
    pub simplifying: usize,
    /// The likeliest failures, the likeliest first.
    pub failures: Vec<StressFailure>,
}

/// The normal distribution from which a batch is drawn.
struct Proposal {
    mean: Point,
    spread: Point,
}

impl Proposal {
    /// Its density over the usual one's, for the mixture of both.
    fn weight(&self, point: &Point) -> f64 {
        let mut exponent = 0.0;
        for ((z, mean), spread) in point.iter().zip(&self.mean).zip(&self.spread) {
            let own = (z - mean) / spread;
            exponent += 0.5 * (z * z - own * own) - libm::log(*spread);
        }
        1.0 / (USUAL_SHARE + (1.0 - USUAL_SHARE) * libm::exp(exponent))
    }

    fn draw(&self, random: &mut Random) -> Point {
        let is_usual = random.unit() < USUAL_SHARE;
        core::array::from_fn(|place| {
            let z = normal(random);
            if is_usual {
                z
            } else {
                self.mean[place] + self.spread[place] * z
            }
        })
    }

    /// Moves to the elite of a batch.
    fn follow(&mut self, elite: &[(Point, f64)]) {
        let total: f64 = elite.iter().map(|(_, weight)| weight).sum();
        if total <= 0.0 {
            return;
        }
        for place in 0..PARAMETERS.len() {
            let mean = elite.iter().map(|(z, w)| z[place] * w).sum::<f64>() / total;
            let square = |z: &Point| (z[place] - mean) * (z[place] - mean);
            let variance = elite.iter().map(|(z, w)| square(z) * w).sum::<f64>() / total;
            let spread = libm::sqrt(variance).max(LEAST_SPREAD);
            self.mean[place] += SMOOTHING * (mean - self.mean[place]);
            self.spread[place] += SMOOTHING * (spread - self.spread[place]);
        }
    }
}

/// A number of the standard normal distribution (Box and Muller).
fn normal(random: &mut Random) -> f64 {
    let radius = libm::sqrt(-2.0 * libm::log(1.0 - random.unit()));
    radius * libm::cos(core::f64::consts::TAU * random.unit())
}

/// A flown point.
struct FlownPoint {
    point: Point,
    weight: f64,
    margin_m: f64,
    /// Infinite where the motion begins too near.
    rank: f64,
}

/// Searches on the threads of the current pool; `go_on` is asked now and then, and ends the search early; `show` gets the number of flights
/// flown.
///
/// # Errors
/// Settings or limits that the core refuses, or a wind that is too strong for the line, as one sentence.
pub fn search(
    stress: &Stress,
    go_on: &(impl Fn() -> bool + Sync),
    show: &mut (dyn FnMut(usize) + Send),
) -> Result<Found, String> {
    let test = Test::new(stress)?;
    let mut proposal = Proposal {
        mean: [0.0; PARAMETERS.len()],
        spread: [1.0; PARAMETERS.len()],
    };
    let mut flown: Vec<FlownPoint> = Vec::with_capacity(stress.flights);
    while flown.len() < stress.flights && go_on() {
        let first = flown.len();
        show(first);
        let count = BATCH.min(stress.flights - first);
        let batch: Vec<FlownPoint> = (first..first + count)
            .into_par_iter()
            .map_init(Engine::new, |engine, number| {
                let mut random = Random::new(stress.seed, number as u64);
                let point = proposal.draw(&mut random);
                let flight = test.fly(engine, &point)?;
                Ok(FlownPoint {
                    weight: proposal.weight(&point),
                    margin_m: flight.margin_m,
                    rank: flight.rank(),
                    point,
                })
            })
            .collect::<Result<_, SettingsError>>()
            .map_err(|error| error.to_string())?;
        let mut ranks: Vec<f64> = batch.iter().map(|one| one.rank).collect();
        ranks.sort_by(f64::total_cmp);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a place in the batch"
        )]
        let place = (ELITE_SHARE * count as f64) as usize;
        let level = ranks.get(place).copied().unwrap_or(0.0).max(0.0);
        // Until enough motions of a batch fail, the ranks alone choose; from then on the likeliest failures do.
        let is_weighted = level <= 0.0;
        let elite: Vec<(Point, f64)> = batch
            .iter()
            .filter(|one| one.rank <= level && one.rank.is_finite())
            .map(|one| (one.point, if is_weighted { one.weight } else { 1.0 }))
            .collect();
        proposal.follow(&elite);
        flown.extend(batch);
    }
    let is_entered = |one: &FlownPoint| one.margin_m < 0.0;
    let sums = flown
        .iter()
        .map(|one| if is_entered(one) { one.weight } else { 0.0 });
    let count = flown.len().max(1) as f64;
    let mean = sums.clone().sum::<f64>() / count;
    let variance = sums
        .map(|weight| (weight - mean) * (weight - mean))
        .sum::<f64>()
        / count;
    let mut failures: Vec<&FlownPoint> = flown.iter().filter(|one| is_entered(one)).collect();
    failures.sort_by(|a, b| distance(&a.point).total_cmp(&distance(&b.point)));
    let (failures, simplifying) = test
        .simplified(&failures)
        .map_err(|error| error.to_string())?;
    Ok(Found {
        flights: flown.len(),
        too_near: flown
            .iter()
            .filter(|one| one.margin_m.is_infinite())
            .count(),
        entered: flown.iter().filter(|one| is_entered(one)).count(),
        first: flown.iter().position(is_entered).map(|place| place + 1),
        probability: (mean, libm::sqrt(variance / count)),
        simplifying,
        failures,
    })
}

/// Flies a motion again and logs everything.
///
/// # Errors
/// As [`search`].
pub fn show(stress: &Stress, motion: &Motion) -> Result<RunLog, String> {
    let test = Test::new(stress)?;
    let plan = Plan {
        name: "stress".into(),
        description: motion.in_words(),
        names: vec!["intruder".into()],
        frame: None,
        time_offset_s: 0.0,
        model: stress.model.clone(),
        world: test.world_of(motion),
    };
    batch::show(plan, &stress.policy).map_err(|error| error.to_string())
}

/// Length from the most usual motion.
fn distance(point: &Point) -> f64 {
    libm::sqrt(point.iter().map(|z| z * z).sum())
}

/// The result of a motion.
struct Flight {
    /// Least signed distance to the volume, metres; infinite where the motion begins too near.
    margin_m: f64,
    /// Least time to the entry of the volume that both would have had on straight lines, seconds.
    entry_s: f64,
    failure: Option<FailureKind>,
}

impl Flight {
    /// How near it came to a failure, the nearest least: a failure by its margin, which is negative; another flight by how few seconds
    /// before the entry the policy was still on a course into the volume. The margins of those do not say it: a policy that departs
    /// least keeps hardly more than the volume.
    fn rank(&self) -> f64 {
        if self.margin_m < 0.0 || self.margin_m.is_infinite() {
            self.margin_m
        } else {
            self.entry_s.min(1e6)
        }
    }
}

/// The test of one policy.
struct Test<'a> {
    stress: &'a Stress,
    world: World,
}

impl<'a> Test<'a> {
    fn new(stress: &'a Stress) -> Result<Self, String> {
        let settings = BatchSettings {
            model: stress.model.clone(),
            policy: stress.policy.clone(),
            horizon_s: HORIZON_S,
            seed: stress.seed,
            tracks: false,
        };
        let world = empty_world(&settings).ok_or(
            "the wind is too strong for the vehicle, expected one in which it holds a line",
        )?;
        // Checks the settings once; the same ones fly every motion.
        let checked = stress.policy.pilot(&world.settings, &world.vehicle);
        checked.map_err(|error| error.to_string())?;
        Ok(Self { stress, world })
    }

    fn motion(&self, point: &Point) -> Motion {
        let stress = self.stress;
        Motion::of(
            point,
            &stress.bounds,
            &stress.model.vehicle,
            &stress.model.protection,
        )
    }

    fn world_of(&self, motion: &Motion) -> World {
        let mut world = self.world.clone();
        let protection = self.stress.model.protection;
        world.obstacles = vec![motion.intruder(self.stress.bounds, protection, HORIZON_S)];
        world
    }

    fn fly(&self, engine: &mut Engine, point: &Point) -> Result<Flight, SettingsError> {
        let motion = self.motion(point);
        if motion.begins_too_near(&self.stress.model.protection) {
            return Ok(Flight {
                margin_m: f64::INFINITY,
                entry_s: f64::INFINITY,
                failure: None,
            });
        }
        let world = self.world_of(&motion);
        let mut pilot = self.stress.policy.pilot(&world.settings, &world.vehicle)?;
        let mut urgency = Urgency::of(&world.obstacles);
        let outcome = engine.fly(&world, pilot.as_mut(), &mut urgency);
        Ok(Flight {
            margin_m: outcome.min_margin_m,
            entry_s: urgency.least_s(),
            failure: pilot.failure(),
        })
    }

    /// Failures that differ, each with as many parameters at their median as it allows, and the flights that took.
    fn simplified(
        &self,
        failures: &[&FlownPoint],
    ) -> Result<(Vec<StressFailure>, usize), SettingsError> {
        let mut distinct: Vec<&Point> = Vec::new();
        for one in failures {
            let apart = |other: &&Point| {
                let between: Point = core::array::from_fn(|place| one.point[place] - other[place]);
                distance(&between) >= SAME_FAILURE
            };
            if distinct.len() < SHOWN && distinct.iter().all(apart) {
                distinct.push(&one.point);
            }
        }
        let each: Vec<(StressFailure, usize)> = distinct
            .par_iter()
            .map_init(Engine::new, |engine, point| self.simplify(engine, point))
            .collect::<Result<_, _>>()?;
        let flights = each.iter().map(|(_, flights)| flights).sum();
        let mut failures: Vec<StressFailure> = Vec::new();
        for (failure, _) in each {
            // Two may have become the same.
            if !failures.iter().any(|other| other.motion == failure.motion) {
                failures.push(failure);
            }
        }
        failures.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        Ok((failures, flights))
    }

    fn simplify(
        &self,
        engine: &mut Engine,
        point: &Point,
    ) -> Result<(StressFailure, usize), SettingsError> {
        let mut point = *point;
        let mut flight = self.fly(engine, &point)?;
        let mut order: Vec<usize> = (0..point.len()).collect();
        // The least usual ones first: they are worth most.
        order.sort_by(|a, b| point[*b].abs().total_cmp(&point[*a].abs()));
        for &place in &order {
            let mut simpler = point;
            simpler[place] = 0.0;
            let simplified = self.fly(engine, &simpler)?;
            if simplified.margin_m < 0.0 {
                (point, flight) = (simpler, simplified);
            }
        }
        let motion = self.motion(&point);
        let mut world = self.world_of(&motion);
        // The oracle leaves the line of the mission, which has an end for it.
        let line = |time_s: f64| TrackPoint {
            time_s,
            position_m: fga::Vec3::X * (self.stress.model.vehicle.airspeed_mps * time_s),
        };
        world.recorded = Track::through(vec![line(0.0), line(HORIZON_S)]);
        let oracle = OracleSettings {
            enough_m: Some(AVOIDABLE_MARGIN_M),
            ..OracleSettings::default()
        };
        let best = best_margin_of_tracks(&world, &oracle);
        let failure = StressFailure {
            distance: distance(&point),
            needed: (0..point.len())
                .filter(|place| point[*place] != 0.0)
                .collect(),
            margin_m: flight.margin_m,
            avoidable: best.is_some_and(|answer| answer.best_margin_m >= AVOIDABLE_MARGIN_M),
            policy_failure: flight.failure,
            motion,
        };
        Ok((failure, order.len() + 1))
    }
}

#[cfg(test)]
mod tests;
