//! The experiments behind the numbers of fga's pages: each flies drawn encounters with the engine
//! and judges them by its separation over continuous time and by the oracle. Neither shares code
//! with the policy. [`flown`], [`missions`] and [`intruders`] measure with code of their own.
//!
//! | experiment | question |
//! |---|---|
//! | [`lost`] | which encounters does the oracle save and a policy lose? |
//! | [`departures`] | how far does the policy depart, when does it begin, does it come back? |
//! | [`robustness`] | how many does the policy save with noise, wind and bank lag? |
//! | [`baselines`] | which settings suit the baselines, and how do all policies compare? |
//! | [`bounds`] | does a flight without traffic differ because of zones, ground and limits of altitude? |
//! | [`corridors`] | is a fence left, and is the aircraft on its way back once the intruder has passed? |
//! | [`certificates`] | does an aircraft ever pass nearer than was certified? |
//! | [`climbs`] | how many does it save when intruders level off, go on climbing or pull up? |
//! | [`quality`] | what does a smaller limit of work cost? |
//! | [`families`] | what goes wrong in strong wind, beside slow traffic, in formations, in gaps that close? |
//! | [`flown`] | how many losses, needless manoeuvres and changes are there on recorded encounters? |
//! | [`ground`] | how many flights come into the ground, leave a fence or enter a volume that an oracle with the same ground keeps? |
//! | [`ground_cost`] | what does choosing a manoeuvre cost over ground? |
//! | [`intruders`] | how many does the policy save when intruders turn, sight is imperfect, air is gusty? |
//! | [`proven`] | is the resilience in a record true? |
//! | [`returns`] | does every aircraft return to its mission once nothing is near? |
//! | [`returns::traps`] | does every aircraft come out of a U of masts, and to the end of its mission? |
//! | [`returns::airspaces`] | do aircraft that all fly fga keep clear of each other, and end their missions? |
//! | [`missions`] | how much of a mission is flown, and does the aircraft come back to it? |

extern crate alloc;

mod baselines;
mod bounds;
mod certificates;
mod climbs;
mod common;
mod corridors;
mod departures;
mod families;
mod flown;
mod ground;
mod ground_cost;
mod intruders;
mod lost;
mod missions;
mod proven;
mod quality;
mod returns;
mod robustness;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Fly the experiments behind the numbers of fga's pages
#[derive(Parser, Debug)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    experiment: Experiment,
}

#[derive(Subcommand, Debug)]
enum Experiment {
    /// Count the encounters that the oracle saves and a policy loses.
    Lost(lost::LostArgs),
    /// Measure departures from the mission, starts and returns.
    Departures(departures::DeparturesArgs),
    /// Count the encounters that the policy saves with noise, wind and bank lag.
    Robustness(robustness::RobustnessArgs),
    /// Search the settings of a baseline, or compare all policies.
    Baselines(baselines::BaselinesArgs),
    /// Count the flights without traffic that differ because of zones, ground and limits of altitude near them.
    Bounds(common::DrawnArgs),
    /// Count the encounters in corridors in which a fence is left, or the aircraft is not on its way back afterwards.
    Corridors(corridors::CorridorArgs),
    /// Count the near mid-air collisions that are left where intruders level off, go on climbing or pull up.
    Climbs(climbs::ClimbsArgs),
    /// Compare certified margins and predicted positions with those of another program.
    Certificates(certificates::CertificatesArgs),
    /// Measure the share that the policy saves, and the work of a step, at several limits of work.
    Quality(quality::QualityArgs),
    /// Count the encounters in strong wind, beside slow traffic, in gaps that close, in which the policy fails.
    Families(families::FamiliesArgs),
    /// Count losses, needless manoeuvres and changes in a folder of recordings of two aircraft.
    Flown(flown::FlownArgs),
    /// Count the flights over ground and among zones that go wrong, and what an oracle with the same ground saves of them.
    Ground(ground::SceneryArgs),
    /// Measure the work and the time of a search over ground and without it.
    GroundCost(ground_cost::CostArgs),
    /// Count the encounters that the policy saves among intruders that turn, with imperfect sight and gusts.
    Intruders(intruders::IntrudersArgs),
    /// Count the claims of a resilience that do not hold when the aircraft do exactly what it covers.
    Proven(common::DrawnArgs),
    /// Count the drawn flights in which an aircraft does not return to its mission once nothing is near.
    Returns(returns::ReturnsArgs),
    /// Count the drawn walls of masts behind which an aircraft does not end its mission.
    Traps(returns::ReturnsArgs),
    /// Count what goes wrong in airspaces in which every aircraft flies fga.
    Airspaces(common::DrawnArgs),
    /// Measure the share of each leg that is flown, and the way back to short and curved legs.
    Missions(missions::MissionsArgs),
}

fn main() -> ExitCode {
    let done = match Arguments::parse().experiment {
        Experiment::Lost(args) => lost::run(&args),
        Experiment::Departures(args) => departures::run(&args),
        Experiment::Robustness(args) => robustness::run(&args),
        Experiment::Baselines(args) => baselines::run(&args),
        Experiment::Bounds(args) => bounds::run(&args),
        Experiment::Corridors(args) => corridors::run(&args),
        Experiment::Climbs(args) => climbs::run(&args),
        Experiment::Certificates(args) => certificates::run(&args),
        Experiment::Quality(args) => quality::run(&args),
        Experiment::Families(args) => families::run(&args),
        Experiment::Flown(args) => flown::run(&args),
        Experiment::Ground(args) => ground::run(&args),
        Experiment::GroundCost(args) => ground_cost::run(&args),
        Experiment::Intruders(args) => {
            intruders::run(&args);
            Ok(())
        }
        Experiment::Proven(args) => {
            proven::run(&args);
            Ok(())
        }
        Experiment::Returns(args) => {
            returns::run(&args);
            Ok(())
        }
        Experiment::Traps(args) => {
            returns::traps::run(&args);
            Ok(())
        }
        Experiment::Airspaces(args) => returns::airspaces::run(&args),
        Experiment::Missions(args) => missions::run(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("fga-experiments: {message}");
            ExitCode::FAILURE
        }
    }
}
