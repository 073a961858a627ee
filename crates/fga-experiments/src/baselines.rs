//! Searches the settings of the baselines, for a grid of settings of one method: the share of encounters
//! kept separated in the cells of Table 4 and in harder families, and the share that also came back to the
//! line, which chooses the best setting, because a method that turns away from everything for ever avoids
//! nothing.
//!
//! Every setting flies a sixth of the encounters, the best five then all of them.
//!
//! METHOD is the name of a baseline; `lowered` for the offset by which the velocity methods see an
//! obstacle at their own height lower; or `all` for every policy with its shipped settings, and the
//! oracle.

use clap::Args;
use fga::vehicle::Vehicle;
use fga_campaign::batch::{BatchSettings, empty_world, populate};
use fga_campaign::encounters::{DrawnThreats, EncounterSource, Family, Range};
use fga_campaign::oracle::{OracleSettings, OracleStart, OracleVehicle, best_margin};
use fga_sim::baselines::{
    Baseline, BaselinePilot, Cube, Orca, PotentialField, Steering, VelocityObstacles, View,
    VoltagePotential, Waypoints,
};
use fga_sim::engine::{Engine, Outcome};
use fga_sim::policy::{Pilot, PolicyChoice, PolicySettings};
use fga_sim::vehicle_file::VehicleModel;
use rayon::prelude::*;

use crate::common::{model, oracle_obstacles};

/// Seed of the search.
const SEARCH_SEED: u64 = 20_240_229;

/// Seed of the comparison, unknown to the search.
const COMPARISON_SEED: u64 = 7;

/// Every setting flies this part of the encounters, and the best few fly all of them.
const FIRST_SHARE: u64 = 6;
const FINALISTS: usize = 5;

/// Longest flight, seconds; a return to the line must come before its end.
const HORIZON_S: f64 = 60.0;

fn cells(seed: u64) -> Vec<(&'static str, EncounterSource)> {
    let threats = |count, near: f64, far: f64, slow: f64, fast: f64| {
        Family::Threats(DrawnThreats {
            count,
            first_seen_m: Range(near, far),
            speed_mps: Range(slow, fast),
        })
    };
    let source = |family, planar| EncounterSource::table_4(family, planar, seed);
    vec![
        (
            "1 static",
            source(threats(1, 300.0, 300.0, 0.0, 0.0), false),
        ),
        (
            "1 15-30",
            source(threats(1, 300.0, 300.0, 15.0, 30.0), false),
        ),
        ("2 0-15", source(threats(2, 300.0, 300.0, 0.0, 15.0), false)),
        (
            "2 15-30",
            source(threats(2, 300.0, 300.0, 15.0, 30.0), false),
        ),
        (
            "2 45-60",
            source(threats(2, 300.0, 300.0, 45.0, 60.0), false),
        ),
        (
            "3 45-60",
            source(threats(3, 300.0, 300.0, 45.0, 60.0), false),
        ),
        (
            "2 45-60 near",
            source(threats(2, 100.0, 500.0, 45.0, 60.0), false),
        ),
        (
            "pl 3 45-60",
            source(threats(3, 300.0, 300.0, 45.0, 60.0), true),
        ),
        (
            "pl 3 15-30 near",
            source(threats(3, 100.0, 500.0, 15.0, 30.0), true),
        ),
        ("pl wall", source(Family::Wall { gap: false }, true)),
        ("pl stream", source(Family::Stream { count: 12 }, true)),
    ]
}

type Factory = Box<dyn Fn(&PolicySettings, &Vehicle) -> Box<dyn Pilot + Send> + Sync>;

fn with<S: Steering + Clone + Send + Sync + 'static>(method: S) -> Factory {
    Box::new(move |settings, vehicle| {
        Box::new(
            BaselinePilot::new(method.clone(), &settings.avoider, *vehicle)
                .expect("settings of Table 4"),
        )
    })
}

/// A method that sees obstacles at its own height this much lower, in protected radii.
#[derive(Clone)]
struct Lowered<S>(S, f64);

impl<S: Steering> Steering for Lowered<S> {
    fn steer(&mut self, view: &View<'_>) -> Option<fga::Vec3> {
        self.0.steer(view)
    }

    fn lowered(&self) -> f64 {
        self.1
    }
}

/// Every policy with its shipped settings.
fn all() -> Result<Vec<(String, Factory)>, String> {
    let baselines = Baseline::ALL.iter().map(|baseline| baseline.name());
    ["none"]
        .into_iter()
        .chain(baselines)
        .chain(["turn-aware"])
        .map(|name| {
            let choice = PolicyChoice::parse(name, None)?;
            let shown = choice.name();
            let factory: Factory = Box::new(move |settings, vehicle| {
                choice
                    .pilot(settings, vehicle)
                    .expect("settings of Table 4")
            });
            Ok((shown, factory))
        })
        .collect()
}

/// The velocity methods, with several offsets of obstacles at their own height.
fn lowered() -> Vec<(String, Factory)> {
    let mut list = Vec::new();
    for share in [0.0, 0.01, 0.02, 0.05, 0.1, 0.2] {
        let orca = Lowered(Orca::default(), share);
        list.push((format!("orca {share}"), with(orca)));
        let voltage = Lowered(VoltagePotential::default(), share);
        list.push((format!("mvp {share}"), with(voltage)));
        let obstacles = Lowered(VelocityObstacles::default(), share);
        list.push((format!("velocity-obstacles {share}"), with(obstacles)));
    }
    list
}

fn candidates(method: &str) -> Result<Vec<(String, Factory)>, String> {
    let mut list: Vec<(String, Factory)> = Vec::new();
    if method == "all" {
        return all();
    }
    if method == "lowered" {
        return Ok(lowered());
    }
    match Baseline::parse(method) {
        Some(Baseline::PotentialField) => {
            for gain in [4.0, 16.0, 64.0, 256.0, 1000.0, 4000.0] {
                for reach in [3.0, 5.0, 8.0, 15.0] {
                    list.push((
                        format!("{gain} {reach}"),
                        with(PotentialField { gain, reach }),
                    ));
                }
            }
        }
        Some(Baseline::Orca) => {
            for horizon_s in [3.0, 5.0, 10.0, 20.0] {
                for inflation in [1.1, 1.4, 2.0, 2.5, 3.0] {
                    let method = Orca {
                        horizon_s,
                        inflation,
                    };
                    list.push((format!("{horizon_s} {inflation}"), with(method)));
                }
            }
        }
        Some(Baseline::VoltagePotential) => {
            for look_ahead_s in [5.0, 10.0, 20.0, 60.0] {
                for inflation in [2.0, 2.5, 3.0, 4.0, 5.0] {
                    let method = VoltagePotential {
                        look_ahead_s,
                        inflation,
                    };
                    list.push((format!("{look_ahead_s} {inflation}"), with(method)));
                }
            }
        }
        Some(Baseline::VelocityObstacles) => {
            for horizon_s in [5.0, 10.0, 20.0] {
                for inflation in [1.1, 1.4, 2.0, 2.5, 3.0] {
                    for collision_cost in [200.0, 2000.0] {
                        let method = VelocityObstacles {
                            horizon_s,
                            inflation,
                            collision_cost,
                            ..VelocityObstacles::default()
                        };
                        list.push((
                            format!("{horizon_s} {inflation} {collision_cost}"),
                            with(method),
                        ));
                    }
                }
            }
        }
        Some(Baseline::WaypointGreedy | Baseline::WaypointOptimal) => {
            for half_edge_m in [60.0, 90.0, 120.0, 160.0] {
                for inflation in [1.05, 1.2, 1.4, 1.7] {
                    for (points, goal_m) in [(5, 200.0), (5, 300.0), (5, 500.0), (9, 300.0)] {
                        let cube = Cube {
                            half_edge_m,
                            points,
                            inflation,
                            goal_m,
                        };
                        let extended = (method == "waypoint-optimal").then_some(60);
                        list.push((
                            format!("{half_edge_m} {inflation} {points} {goal_m}"),
                            with(Waypoints::new(cube, extended)),
                        ));
                    }
                }
            }
        }
        // Those that keep to the numbers of their source.
        Some(_) => return Err(format!("{method} has no settings to search")),
        None => return Err(format!("unknown method {method}")),
    }
    Ok(list)
}

/// The result of a setting's flights, for each cell and over all.
struct Scores {
    /// Per cent kept separated, by cell.
    separated: Vec<f64>,
    /// Per cent separated and back, mean of the cells.
    back: f64,
    decision_us: f64,
    aside_m: f64,
    extra_m: f64,
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn fly(
    factory: &Factory,
    cells: &[(&str, EncounterSource)],
    model: &VehicleModel,
    count: u64,
) -> Result<Scores, String> {
    let mut separated = Vec::new();
    let (mut back, mut times) = (Vec::new(), Vec::new());
    let (mut aside, mut extra) = (Vec::new(), Vec::new());
    for (_, source) in cells {
        let mut model = model.clone();
        if source.planar {
            (model.vehicle.climb_min_rad, model.vehicle.climb_max_rad) = (0.0, 0.0);
        }
        let settings = BatchSettings {
            horizon_s: HORIZON_S,
            seed: 1,
            ..BatchSettings::of(model, PolicyChoice::default())
        };
        let world = empty_world(&settings).ok_or("no wind is set")?;
        let flown: Vec<(Outcome, u64)> = (0..count)
            .into_par_iter()
            .map_init(
                || (Engine::new(), world.clone()),
                |(engine, world), number| {
                    let encounter = source.encounter(number)?;
                    populate(world, &encounter, &settings.model.protection);
                    let mut pilot = factory(&world.settings, &world.vehicle);
                    let outcome = engine.fly(world, pilot.as_mut(), &mut ());
                    let elapsed = engine.elapsed_ns();
                    let mean = elapsed.iter().sum::<u64>() / elapsed.len().max(1) as u64;
                    Ok((outcome, mean))
                },
            )
            .collect::<Result<_, String>>()?;
        let share = |of: &dyn Fn(&Outcome) -> bool| {
            100.0 * flown.iter().filter(|(o, _)| of(o)).count() as f64 / count as f64
        };
        separated.push(share(&|o| o.separated()));
        back.push(share(&|o| o.separated() && o.end_s < HORIZON_S));
        times.extend(flown.iter().map(|(_, ns)| *ns as f64 / 1000.0));
        aside.extend(flown.iter().map(|(o, _)| o.max_cross_track_m));
        extra.extend(flown.iter().map(|(o, _)| o.extra_path_m));
    }
    Ok(Scores {
        separated,
        back: mean(&back),
        decision_us: mean(&times),
        aside_m: mean(&aside),
        extra_m: mean(&extra),
    })
}

fn print_row(name: &str, scores: &Scores) {
    print!(
        "{name:<24}{:>7.1}{:>7.1}{:>9.2}{:>9.1}{:>9.1}",
        mean(&scores.separated),
        scores.back,
        scores.decision_us,
        scores.aside_m,
        scores.extra_m
    );
    for share in &scores.separated {
        print!("{share:>17.1}");
    }
    println!();
}

/// Options of `baselines`.
#[derive(Args, Debug)]
pub(crate) struct BaselinesArgs {
    /// Name of a baseline, `lowered` or `all`.
    #[arg(default_value = "all")]
    method: String,
    /// Encounters in each cell.
    #[arg(default_value_t = 300)]
    count: u64,
}

/// Prints a row for each setting, or for each policy.
pub(crate) fn run(args: &BaselinesArgs) -> Result<(), String> {
    let (method, count) = (args.method.as_str(), args.count);
    let model = model(false)?;
    let cells = cells(if method == "all" {
        COMPARISON_SEED
    } else {
        SEARCH_SEED
    });
    print!(
        "{:<24}{:>7}{:>7}{:>9}{:>9}{:>9}",
        "settings", "mean", "back", "us", "aside_m", "extra_m"
    );
    for (name, _) in &cells {
        print!("{name:>17}");
    }
    println!();
    let candidates = candidates(method)?;
    if method == "all" || method == "lowered" {
        for (name, factory) in &candidates {
            print_row(name, &fly(factory, &cells, &model, count)?);
        }
        if method == "all" {
            print_oracle(&cells, &model.vehicle, count)?;
        }
        return Ok(());
    }
    // All settings on some of the encounters, the best of them on all.
    let mut first = Vec::new();
    for (name, factory) in &candidates {
        let scores = fly(factory, &cells, &model, count.div_ceil(FIRST_SHARE))?;
        print_row(name, &scores);
        first.push((scores.back, name, factory));
    }
    first.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("the best {FINALISTS}, on {count} encounters a cell:");
    for (_, name, factory) in first.iter().take(FINALISTS) {
        print_row(name, &fly(factory, &cells, &model, count)?);
    }
    Ok(())
}

/// The share of each cell that any manoeuvre keeps separated.
fn print_oracle(
    cells: &[(&str, EncounterSource)],
    vehicle: &Vehicle,
    count: u64,
) -> Result<(), String> {
    let settings = OracleSettings {
        horizon_s: HORIZON_S,
        enough_m: Some(0.5),
        ..OracleSettings::default()
    };
    let shares: Vec<f64> = cells
        .iter()
        .map(|(_, source)| {
            let vehicle = OracleVehicle::from(vehicle);
            let vehicle = if source.planar {
                vehicle.planar()
            } else {
                vehicle
            };
            let saved = (0..count)
                .into_par_iter()
                .map(|number| {
                    let obstacles = oracle_obstacles(&source.encounter(number)?);
                    let best = best_margin(&OracleStart::ORIGIN, &vehicle, &obstacles, &settings);
                    Ok(u64::from(best.best_margin_m >= 0.0))
                })
                .sum::<Result<u64, String>>()?;
            Ok(100.0 * saved as f64 / count as f64)
        })
        .collect::<Result<_, String>>()?;
    let mean = shares.iter().sum::<f64>() / shares.len().max(1) as f64;
    print!("{:<24}{mean:>7.1}{:>34}", "oracle", "");
    for share in shares {
        print!("{share:>17.1}");
    }
    println!();
    Ok(())
}
