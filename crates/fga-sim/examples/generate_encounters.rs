//! Writes an encounter file for `fga batch`.
//!
//! `generate_encounters CELL SEED COUNT OUT`, with CELL one of
//! `threats:COUNT:SEEN:SPEED`, `from-anywhere:COUNT:SEEN:SPEED`, `head-on:SEEN:SPEED`, `overtaking`, `wall`, `wall-gap`,
//! `stream:COUNT`, `pincer:COUNT`, each with `,planar` and `,bystanders` if wanted; SEEN and SPEED
//! are a number or FROM-TO in metres and metres per second. For instance
//! `generate_encounters threats:3:100-500:45-60,planar 1 2000 cell.csv`.

use core::fmt::Write as _;
use std::process::ExitCode;

use fga_sim::encounters::EncounterSource;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[String]) -> Result<(), String> {
    let [cell, seed, count, out] = arguments else {
        return Err("usage: generate_encounters CELL SEED COUNT OUT".into());
    };
    let number = |text: &str| {
        text.parse::<u64>()
            .map_err(|e| format!("{text}: expected a whole number: {e}"))
    };
    let source = EncounterSource::parse(cell, number(seed)?)?;
    let mut text = String::from("encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m\n");
    for n in 0..number(count)? {
        for o in source.encounter(n).obstacles {
            let (p, v) = (o.position_m, o.velocity_mps);
            writeln!(
                text,
                "{n},{},{},{},{},{},{},{},{}",
                o.id,
                p.x,
                p.y,
                p.z,
                v.x,
                v.y,
                v.z,
                o.volume.radius_m()
            )
            .map_err(|e| e.to_string())?;
        }
    }
    let unfinished = format!("{out}.part");
    std::fs::write(&unfinished, text).map_err(|e| format!("{unfinished}: {e}"))?;
    std::fs::rename(&unfinished, out).map_err(|e| format!("{out}: {e}"))
}
