//! `fga oracle`: could any manoeuvre save the encounter?

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use fga_formats::OutputError;
use fga_formats::atomic::AtomicFile;
use fga_formats::encounters;
use fga_formats::number::push_fixed;
use fga_sim::oracle::{AVOIDABLE_MARGIN_M, Judge};
use rayon::prelude::*;
use serde_json::json;

use crate::batch::positive_seconds;
use crate::common::{
    AnswerArgs, OutArgs, ThreadArgs, VehicleArgs, interrupted, watch_for_interrupt,
};
use crate::failure::Failure;

/// Encounters searched between two writes.
const BLOCK: usize = 64;

/// Options of `fga oracle`.
#[derive(Args, Debug)]
pub(crate) struct OracleArgs {
    /// Encounters: a CSV file as for `fga batch`.
    encounters: PathBuf,
    #[command(flatten)]
    vehicle: VehicleArgs,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Time over which the margin counts, seconds.
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = positive_seconds, allow_negative_numbers = true)]
    horizon: f64,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// Searches every encounter and writes `oracle.csv`.
pub(crate) fn run(args: &OracleArgs) -> Result<ExitCode, Failure> {
    let model = args.vehicle.model()?;
    let encounters = encounters::read(&args.encounters)?;
    let judge = Judge::new(&model, args.horizon).map_err(Failure::Input)?;
    let folder = args.out.prepare(&args.encounters)?;
    watch_for_interrupt();
    let path = folder.join("oracle.csv");
    let failed = |error| OutputError::new(&path, error);
    let mut file = AtomicFile::create(&path)?;
    writeln!(file, "encounter,avoidable,best_margin_m").map_err(failed)?;
    let mut avoidable = 0_usize;
    let mut line = Vec::new();
    args.threads.install(|| {
        for block in encounters.chunks(BLOCK) {
            let margins: Vec<f64> = block
                .par_iter()
                .map(|encounter| judge.best_margin_m(encounter))
                .collect();
            if interrupted() {
                return Err(Failure::Interrupted);
            }
            for (encounter, margin_m) in block.iter().zip(margins) {
                let is_avoidable = margin_m >= AVOIDABLE_MARGIN_M;
                avoidable += usize::from(is_avoidable);
                line.clear();
                line.extend_from_slice(format!("{},{is_avoidable},", encounter.id).as_bytes());
                push_fixed(&mut line, margin_m, 6);
                line.push(b'\n');
                file.write_all(&line).map_err(failed)?;
            }
        }
        Ok(())
    })??;
    file.commit()?;
    let share = avoidable as f64 / encounters.len() as f64;
    args.answer.print(
        || {
            format!(
                "{} encounters, vehicle {}: {avoidable} avoidable ({:.2} %); results in {}\n",
                encounters.len(),
                model.name,
                100.0 * share,
                folder.display()
            )
        },
        &json!({
            "encounters": encounters.len(),
            "vehicle": model.name,
            "avoidable": avoidable,
            "avoidable_share": share,
            "results": folder.display().to_string(),
        }),
    )?;
    Ok(ExitCode::SUCCESS)
}
