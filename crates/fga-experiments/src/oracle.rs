//! How many encounters does the oracle save, and how long does it take?

use std::time::Instant;

use clap::Args;
use fga_sim::oracle::{OracleSettings, OracleStart, OracleVehicle, Stages, best_margin};

use crate::common::{DrawOptions, oracle_obstacles};

/// Options of `oracle`.
#[derive(Args, Debug)]
pub(crate) struct OracleOptions {
    #[command(flatten)]
    draw: DrawOptions,
    /// Margin at which the search stops, metres; without it the oracle searches for the best one.
    #[arg(long, value_name = "M")]
    enough: Option<f64>,
}

/// Prints the share and the times of each cell.
pub(crate) fn run(args: &OracleOptions) -> Result<(), String> {
    println!("cell,encounters,avoidable_share,one_turn_share,mean_ms,median_ms,max_ms");
    let (count, enough_m) = (args.draw.count, args.enough);
    for (cell, source) in args.draw.sources()? {
        let mut vehicle = OracleVehicle::table_4();
        if source.planar {
            vehicle = vehicle.planar();
        }
        let mut times = Vec::new();
        let (mut saved, mut saved_by_one) = (0_u32, 0_u32);
        for n in 0..count {
            let obstacles = oracle_obstacles(&source.encounter(n));
            let search = |stages| {
                best_margin(
                    &OracleStart::ORIGIN,
                    &vehicle,
                    &obstacles,
                    &OracleSettings {
                        enough_m,
                        stages,
                        ..OracleSettings::default()
                    },
                )
            };
            let start = Instant::now();
            let answer = search(Stages::Two);
            times.push(start.elapsed().as_secs_f64() * 1e3);
            saved += u32::from(answer.avoidable());
            saved_by_one += u32::from(search(Stages::One).avoidable());
        }
        times.sort_by(f64::total_cmp);
        let share = |n: u32| 100.0 * f64::from(n) / count as f64;
        println!(
            "{cell},{count},{:.2},{:.2},{:.3},{:.3},{:.1}",
            share(saved),
            share(saved_by_one),
            times.iter().sum::<f64>() / count as f64,
            times.get(times.len() / 2).copied().unwrap_or(f64::NAN),
            times.last().copied().unwrap_or(f64::NAN)
        );
    }
    Ok(())
}
