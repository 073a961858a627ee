//! Avoidable share and time of the oracle over cells.
//!
//! `oracle_rate SEED COUNT ENOUGH CELL…`: ENOUGH is a margin at which the search stops, or `none`.

use std::time::Instant;

use fga_sim::encounters::EncounterSource;
use fga_sim::oracle::{
    OracleObstacle, OracleSettings, OracleStart, OracleVehicle, Stages, best_margin,
};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [seed, count, enough, cells @ ..] = arguments.as_slice() else {
        eprintln!("usage: oracle_rate SEED COUNT ENOUGH CELL…");
        std::process::exit(1);
    };
    let seed: u64 = seed.parse().expect("a seed");
    let count: u64 = count.parse().expect("a count");
    let enough_m = enough.parse().ok();
    println!("cell,encounters,avoidable_share,one_turn_share,mean_ms,median_ms,max_ms");
    for cell in cells {
        let source = EncounterSource::parse(cell, seed).expect("a cell");
        let mut vehicle = OracleVehicle::table_4();
        if source.planar {
            vehicle = vehicle.planar();
        }
        let mut times = Vec::new();
        let (mut saved, mut saved_by_one) = (0_u32, 0_u32);
        for n in 0..count {
            let obstacles: Vec<OracleObstacle> = source
                .encounter(n)
                .obstacles
                .iter()
                .map(OracleObstacle::from)
                .collect();
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
            times[times.len() / 2],
            times[times.len() - 1]
        );
    }
}
