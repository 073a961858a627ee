//! Searches the settings of the baselines: the share of encounters kept separated in the cells of
//! Table 4 and in harder families, for a grid of settings of one method, and the share in which
//! the aircraft came back to its line too, by which the best setting is chosen: turning away from
//! everything for ever is no avoidance.
//!
//! `cargo run --release -p fga-sim --example tune_baselines -- METHOD [ENCOUNTERS]`; METHOD is the
//! name of a baseline, or `all` for every policy with the settings it ships with.

use core::error::Error;

use fga::avoider::Settings;
use fga::kinematics::Vehicle;
use fga_sim::baselines::{
    Baseline, BaselinePilot, Cube, Orca, PotentialField, Steering, VelocityObstacles,
    VoltagePotential, WaypointGreedy, WaypointOptimal,
};
use fga_sim::batch::{BatchSettings, empty_world};
use fga_sim::encounters::{EncounterSource, Family, Range};
use fga_sim::engine::{Engine, Outcome};
use fga_sim::policy::{Pilot, PolicyChoice};
use fga_sim::track::Track;
use fga_sim::vehicle_file::VehicleModel;
use fga_sim::world::WorldObstacle;
use rayon::prelude::*;

/// Seed of the search.
const SEARCH_SEED: u64 = 20_240_229;

/// Seed of the comparison, which the search has not seen.
const COMPARISON_SEED: u64 = 7;

/// Longest flight, seconds; who is not back on the line by then has not come back.
const HORIZON_S: f64 = 60.0;

fn cells(seed: u64) -> Vec<(&'static str, EncounterSource)> {
    let threats = |count, near: f64, far: f64, slow: f64, fast: f64| Family::Threats {
        count,
        first_seen_m: Range(near, far),
        speed_mps: Range(slow, fast),
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

type Factory = Box<dyn Fn(&Settings, &Vehicle) -> Box<dyn Pilot + Send> + Sync>;

fn with<S: Steering + Clone + Send + Sync + 'static>(method: S) -> Factory {
    Box::new(move |settings, vehicle| {
        Box::new(
            BaselinePilot::new(method.clone(), settings, *vehicle).expect("settings of Table 4"),
        )
    })
}

fn candidates(method: &str) -> Result<Vec<(String, Factory)>, String> {
    let mut list: Vec<(String, Factory)> = Vec::new();
    let named = |name: &str, start: Option<&str>| -> Result<(String, Factory), String> {
        let choice = PolicyChoice::parse(name, start)?;
        let factory: Factory = Box::new(move |settings, vehicle| {
            choice
                .pilot(settings, vehicle)
                .expect("settings of Table 4")
        });
        Ok((choice.name(), factory))
    };
    if method == "all" {
        list.push(named("none", None)?);
        for baseline in Baseline::ALL {
            list.push(named(baseline.name(), None)?);
        }
        list.push(named("turn-aware", None)?);
        return Ok(list);
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
            for look_ahead_s in [10.0, 20.0, 60.0] {
                for inflation in [1.1, 1.4, 2.0, 2.5, 3.0] {
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
            for half_edge_m in [45.0, 60.0, 90.0, 120.0] {
                for inflation in [1.05, 1.2, 1.4] {
                    for (points, goal_m) in [(5, 200.0), (5, 300.0), (5, 500.0), (9, 300.0)] {
                        let cube = Cube {
                            half_edge_m,
                            points,
                            inflation,
                            goal_m,
                        };
                        let factory = if method == "waypoint-greedy" {
                            with(WaypointGreedy::new(cube))
                        } else {
                            with(WaypointOptimal::new(cube, 60))
                        };
                        list.push((
                            format!("{half_edge_m} {inflation} {points} {goal_m}"),
                            factory,
                        ));
                    }
                }
            }
        }
        None => return Err(format!("unknown method {method}")),
    }
    Ok(list)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let method = arguments.next().unwrap_or_else(|| "all".into());
    let count: u64 = arguments.next().map_or(Ok(100), |text| text.parse())?;
    let model = VehicleModel::built_in()?;
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
    for (name, factory) in candidates(&method)? {
        let mut shares = Vec::new();
        let (mut back, mut times) = (Vec::new(), Vec::new());
        let (mut aside, mut extra) = (Vec::new(), Vec::new());
        for (_, source) in &cells {
            let mut model = model.clone();
            if source.planar {
                (model.vehicle.climb_min_rad, model.vehicle.climb_max_rad) = (0.0, 0.0);
            }
            let settings = BatchSettings {
                model,
                policy: PolicyChoice::default(),
                horizon_s: HORIZON_S,
                seed: 1,
                tracks: false,
            };
            let world = empty_world(&settings).ok_or("no wind is set")?;
            let flown: Vec<(Outcome, u64)> = (0..count)
                .into_par_iter()
                .map_init(
                    || (Engine::new(), world.clone()),
                    |(engine, world), number| {
                        let encounter = source.encounter(number);
                        world.obstacles = encounter
                            .obstacles
                            .iter()
                            .map(|o| {
                                let track = Track::straight(o.position_m, o.velocity_mps);
                                WorldObstacle::new(o.id, track, o.volume)
                            })
                            .collect();
                        let mut pilot = factory(&world.settings, &world.vehicle);
                        let outcome = engine.fly(world, pilot.as_mut(), &mut ());
                        let elapsed = engine.elapsed_ns();
                        let mean = elapsed.iter().sum::<u64>() / elapsed.len().max(1) as u64;
                        (outcome, mean)
                    },
                )
                .collect();
            let separated = flown.iter().filter(|(o, _)| o.separated()).count();
            shares.push(100.0 * separated as f64 / count as f64);
            let both = flown
                .iter()
                .filter(|(o, _)| o.separated() && o.end_s < HORIZON_S)
                .count();
            back.push(100.0 * both as f64 / count as f64);
            times.extend(flown.iter().map(|(_, ns)| *ns as f64 / 1000.0));
            aside.extend(flown.iter().map(|(o, _)| o.max_cross_track_m));
            extra.extend(flown.iter().map(|(o, _)| o.extra_path_m));
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        print!(
            "{name:<24}{:>7.1}{:>7.1}{:>9.2}{:>9.1}{:>9.1}",
            mean(&shares),
            mean(&back),
            mean(&times),
            mean(&aside),
            mean(&extra)
        );
        for share in shares {
            print!("{share:>17.1}");
        }
        println!();
    }
    Ok(())
}
