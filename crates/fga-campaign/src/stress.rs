//! Adaptive stress testing: a search for the likeliest motions of intruders, losses of their reports, and gusts, in which a policy
//! enters a protected volume.
//!
//! A flight is a point z of a standard normal distribution in as many dimensions as it has parameters ([`MOTION`] for each intruder, and
//! [`GUST`]); each parameter is a quantile of a usual distribution, within the bounds that the policy knows ([`MovementBounds`](fga::situation::MovementBounds), the
//! vehicle's drift). The cross-entropy
//! method (Rubinstein 1999; Lee et al. 2015 for collision avoidance) flies batches, and draws the next batch near those
//! that came nearest to a failure. One flight in ten is drawn from the usual distribution, so that the weights of the flights are
//! bounded and their sum estimates the probability of a loss. In the end each parameter that a failure does not
//! need is set to its median; the other parameters explain the failure.

mod case;
mod motion;
mod proposal;
mod stressed;
mod urgency;

pub use case::StressCase;
pub use motion::{GUST, MOTION, Parameter, StressMotion};
pub use stressed::{MOST_INTRUDERS, Stress};

use fga::avoider::SettingsError;
use fga_judge::track::{Track, TrackPoint};
use fga_sim::engine::Engine;
use fga_sim::own::FailureKind;
use fga_sim::run::{Plan, RunLog};
use fga_sim::whole::whole;
use fga_sim::world::World;
use rayon::prelude::*;

use crate::batch::{self, BatchSettings, empty_world};
use crate::encounters::random::Random;
use crate::oracle::{AVOIDABLE_MARGIN_M, OracleSettings, best_margin_of_tracks};
use proposal::{Proposal, ProposalPoint, distance};
use urgency::StressUrgency;

/// Flights of a batch.
const BATCH: usize = 200;

/// Share of a batch near which the next one is drawn.
const ELITE_SHARE: f64 = 0.1;

/// Two failures nearer than this are the same one.
const SAME_FAILURE: f64 = 1.0;

/// Failures that are simplified and shown.
const SHOWN: usize = 10;

/// Longest flight, seconds.
const HORIZON_S: f64 = 180.0;

/// A flight in which the policy entered a volume.
#[derive(Debug, Clone, PartialEq)]
pub struct StressFailure {
    /// The intruders and the gust.
    pub case: StressCase,
    /// Its distance from the most usual flight, in standard deviations: the less, the likelier.
    pub distance: f64,
    /// Parameters that are not at their median, by their place in [`Stress::parameters`].
    pub needed: Vec<usize>,
    /// Least signed distance to the volume, metres.
    pub margin_m: f64,
    /// Whether a manoeuvre with all motions known keeps out.
    pub avoidable: bool,
    /// How a policy of one's own failed in it.
    pub policy_failure: Option<FailureKind>,
}

impl StressFailure {
    /// The density of its parameters over that of the most usual ones.
    pub fn relative_density(&self) -> f64 {
        libm::exp(-0.5 * self.distance * self.distance)
    }
}

/// What the search found.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundEncounter {
    /// Flights of the search.
    pub flights: usize,
    /// Flights that begin too near to say anything; they are no failures.
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

/// The result of a flight, all that the search needs of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressFlight {
    /// Least signed distance to the volume, metres; infinite where it begins too near.
    pub margin_m: f64,
    /// Least time to the entry of a volume that both would have had on straight lines, seconds; infinite for none.
    pub entry_s: f64,
}

impl StressFlight {
    const TOO_NEAR: Self = Self {
        margin_m: f64::INFINITY,
        entry_s: f64::INFINITY,
    };

    /// How near it came to a failure, the nearest least: a failure by its margin, which is negative; another flight by how few seconds
    /// before the entry the policy was still on a course into the volume. The margin does not rank flights without a failure: a policy
    /// that departs least keeps hardly more than the volume.
    fn rank(&self) -> f64 {
        if self.margin_m < 0.0 || self.margin_m.is_infinite() {
            self.margin_m
        } else {
            self.entry_s.min(1e6)
        }
    }
}

/// A flown point.
struct FlownPoint {
    point: ProposalPoint,
    weight: f64,
    flight: StressFlight,
}

/// Searches on the threads of the current pool. `before` has the results of the first flights of the same test, which are not flown
/// again; `take` gets those of each batch. `go_on` is asked before each batch: the search ends with `None` where it says no.
///
/// # Errors
/// Settings or limits that the core refuses, or a wind that is too strong for the line, as one sentence; an error of `take`.
pub fn search(
    stress: &Stress,
    before: &[StressFlight],
    go_on: &(impl Fn() -> bool + Sync),
    take: &mut (dyn FnMut(&[StressFlight]) -> Result<(), String> + Send),
) -> Result<Option<FoundEncounter>, String> {
    let test = Test::new(stress)?;
    let mut proposal = Proposal::usual(stress.dimensions(), 1.0);
    let mut flown: Vec<FlownPoint> = Vec::with_capacity(stress.flights);
    while flown.len() < stress.flights {
        if !go_on() {
            return Ok(None);
        }
        let first = flown.len();
        let count = BATCH.min(stress.flights - first);
        let batch: Vec<FlownPoint> = (first..first + count)
            .into_par_iter()
            .map_init(Engine::new, |engine, number| {
                let mut random = Random::new(stress.seed, number as u64);
                let point = proposal.draw(&mut random);
                let flight = match before.get(number) {
                    Some(flight) => *flight,
                    None => test.fly(engine, &point)?.0,
                };
                Ok(FlownPoint {
                    weight: proposal.weight(&point),
                    flight,
                    point,
                })
            })
            .collect::<Result<_, SettingsError>>()
            .map_err(|error| error.to_string())?;
        let flights: Vec<StressFlight> = batch.iter().map(|one| one.flight).collect();
        take(&flights)?;
        let mut ranks: Vec<f64> = flights.iter().map(StressFlight::rank).collect();
        ranks.sort_by(f64::total_cmp);
        let place = whole(ELITE_SHARE * count as f64) as usize;
        let level = ranks.get(place).copied().unwrap_or(0.0).max(0.0);
        // Until enough flights of a batch fail, the ranks alone choose; from then on the likeliest failures do.
        let is_weighted = level <= 0.0;
        let elite: Vec<(&ProposalPoint, f64)> = batch
            .iter()
            .filter(|one| one.flight.rank() <= level && one.flight.rank().is_finite())
            .map(|one| (&one.point, if is_weighted { one.weight } else { 1.0 }))
            .collect();
        proposal.follow(&elite);
        flown.extend(batch);
    }
    let is_entered = |one: &FlownPoint| one.flight.margin_m < 0.0;
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
    Ok(Some(FoundEncounter {
        flights: flown.len(),
        too_near: flown
            .iter()
            .filter(|one| one.flight.margin_m.is_infinite())
            .count(),
        entered: flown.iter().filter(|one| is_entered(one)).count(),
        first: flown.iter().position(is_entered).map(|place| place + 1),
        probability: (mean, libm::sqrt(variance / count)),
        simplifying,
        failures,
    }))
}

/// Flies a case again and logs everything.
///
/// # Errors
/// As [`search`].
pub fn show(stress: &Stress, case: &StressCase) -> Result<RunLog, String> {
    let test = Test::new(stress)?;
    let names = (1..=stress.intruders).map(|number| match stress.intruders {
        1 => "intruder".to_owned(),
        _ => format!("intruder {number}"),
    });
    let plan = Plan {
        name: "stress".into(),
        description: case.in_words(),
        names: names.collect(),
        notes: Vec::new(),
        frame: None,
        time_offset_s: 0.0,
        model: stress.model.clone(),
        world: test.world_of(case),
    };
    batch::show(plan, &stress.policy).map_err(|error| error.to_string())
}

/// The test of one policy.
struct Test<'a> {
    stress: &'a Stress,
    world: World,
}

impl<'a> Test<'a> {
    fn new(stress: &'a Stress) -> Result<Self, String> {
        let settings = BatchSettings {
            horizon_s: HORIZON_S,
            seed: stress.seed,
            ..BatchSettings::of(stress.model.clone(), stress.policy.clone())
        };
        let world = empty_world(&settings).ok_or(
            "the wind is too strong for the vehicle, expected one in which it holds a line",
        )?;
        // Checks the settings once; the same ones fly every motion.
        let checked = stress.policy.pilot(&world.settings, &world.vehicle);
        checked.map_err(|error| error.to_string())?;
        Ok(Self { stress, world })
    }

    fn world_of(&self, case: &StressCase) -> World {
        let (bounds, protection) = (self.stress.bounds, self.stress.model.protection);
        let motions = (0..).zip(&case.motions);
        World {
            obstacles: motions
                .map(|(id, motion)| motion.intruder(id, bounds, protection, HORIZON_S))
                .collect(),
            gust: case.gust,
            ..self.world.clone()
        }
    }

    /// The result of a point, and how a policy of one's own failed.
    fn fly(
        &self,
        engine: &mut Engine,
        point: &[f64],
    ) -> Result<(StressFlight, Option<FailureKind>), SettingsError> {
        let case = StressCase::of(point, self.stress);
        let protection = &self.stress.model.protection;
        if case
            .motions
            .iter()
            .any(|motion| motion.begins_too_near(protection))
        {
            return Ok((StressFlight::TOO_NEAR, None));
        }
        let world = self.world_of(&case);
        let mut pilot = self.stress.policy.pilot(&world.settings, &world.vehicle)?;
        let mut urgency = StressUrgency::of(&world.obstacles);
        let outcome = engine.fly(&world, pilot.as_mut(), &mut urgency);
        let flight = StressFlight {
            margin_m: outcome.min_margin_m,
            entry_s: urgency.least_s(),
        };
        Ok((flight, pilot.failure()))
    }

    /// Failures that differ, each with as many parameters at their median as it allows, and the flights that took.
    fn simplified(
        &self,
        failures: &[&FlownPoint],
    ) -> Result<(Vec<StressFailure>, usize), SettingsError> {
        let mut distinct: Vec<&ProposalPoint> = Vec::new();
        for one in failures {
            let apart = |other: &&ProposalPoint| {
                let both = one.point.iter().zip(other.iter());
                let between: ProposalPoint = both.map(|(a, b)| a - b).collect();
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
            if !failures.iter().any(|other| other.case == failure.case) {
                failures.push(failure);
            }
        }
        failures.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        Ok((failures, flights))
    }

    fn simplify(
        &self,
        engine: &mut Engine,
        point: &ProposalPoint,
    ) -> Result<(StressFailure, usize), SettingsError> {
        let mut point = point.clone();
        let mut flown = self.fly(engine, &point)?;
        let mut order: Vec<usize> = (0..point.len()).collect();
        // The least usual ones first: they are worth most.
        order.sort_by(|a, b| point[*b].abs().total_cmp(&point[*a].abs()));
        for &place in &order {
            let mut simpler = point.clone();
            simpler[place] = 0.0;
            let simplified = self.fly(engine, &simpler)?;
            if simplified.0.margin_m < 0.0 {
                (point, flown) = (simpler, simplified);
            }
        }
        let (flight, policy_failure) = flown;
        let case = StressCase::of(&point, self.stress);
        let mut world = self.world_of(&case);
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
            policy_failure,
            case,
        };
        Ok((failure, order.len() + 1))
    }
}

#[cfg(test)]
mod tests;
