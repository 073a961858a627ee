//! `fga reproduce`: flies the paper's evaluation again and shows its claims beside the results.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use fga_formats::atomic;
use fga_reproduce::{ReproduceError, Setting, reproduce};
use serde_json::json;

use crate::common::{AnswerArgs, ThreadArgs, interrupted, watch_for_interrupt};
use crate::failure::Failure;

/// Options of `fga reproduce`.
#[derive(Args, Debug)]
pub(crate) struct ReproduceArgs {
    /// Number of encounters for each point of a curve.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..))]
    encounters: u64,
    /// Master seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Folder for the report and its data.
    #[arg(long, value_name = "DIR", default_value = "out/reproduce")]
    out: PathBuf,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    answer: AnswerArgs,
}

impl From<ReproduceError> for Failure {
    fn from(error: ReproduceError) -> Self {
        match error {
            ReproduceError::Input(message) => Self::Input(message),
            ReproduceError::Output(error) => Self::Output(error),
            ReproduceError::Stopped => Self::Interrupted,
        }
    }
}

/// Flies everything and writes `report.html` and `data/`.
pub(crate) fn run(args: &ReproduceArgs) -> Result<ExitCode, Failure> {
    atomic::prepare_folder(&args.out)?;
    watch_for_interrupt();
    let page = args.threads.install(|| {
        reproduce(&Setting {
            encounters: args.encounters,
            seed: args.seed,
            folder: &args.out,
            announce: &|what| eprintln!("{what}"),
            goes_on: &|| !interrupted(),
        })
    })??;
    args.answer.print(
        || format!("report in {}\n", page.display()),
        &json!({ "report": page.display().to_string() }),
    )?;
    Ok(ExitCode::SUCCESS)
}
