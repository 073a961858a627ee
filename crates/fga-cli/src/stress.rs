//! `fga stress`: searches the likeliest motions of intruders, and gusts, in which a policy fails.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use fga::situation::MovementBounds;
use fga_campaign::campaign::CampaignProgress;
use fga_campaign::stress::{MOST_INTRUDERS, Stress};
use fga_results::stress::run as fly;

use crate::campaign_progress::ProgressDisplay;
use crate::common::{
    AnswerArgs, PolicyArgs, ThreadArgs, VehicleArgs, interrupted, tell_failures,
    watch_for_interrupt,
};
use crate::failure::Failure;

/// What the intruder is.
#[derive(ValueEnum, Debug, Clone, Copy)]
enum StressKind {
    /// A crewed aircraft: turns of 3 °/s, 60°.
    Aircraft,
    /// A small unmanned aircraft: turns of 15 °/s, 90°.
    Uas,
}

/// Options of `fga stress`.
#[derive(Args, Debug)]
pub(crate) struct StressArgs {
    #[command(flatten)]
    policy: PolicyArgs,
    #[command(flatten)]
    vehicle: VehicleArgs,
    /// The intruder, whose bounds the policy knows.
    #[arg(long, value_name = "KIND", value_enum, default_value_t = StressKind::Uas)]
    kind: StressKind,
    /// Intruders, 1 to 4.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=MOST_INTRUDERS as i64))]
    intruders: u32,
    /// Standard deviation of each component of a gust, m/s, at most 20; without it the vehicle's `drift_mps`. 0: no gusts.
    #[arg(long, value_name = "MPS", value_parser = gust)]
    gust_mps: Option<f64>,
    /// Flights of the search, 1 to 1000000.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    flights: u32,
    /// Master seed.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Folder for the results; a search of the same test in it goes on.
    #[arg(long, value_name = "DIR", default_value = "out/stress")]
    out: PathBuf,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    answer: AnswerArgs,
}

fn gust(text: &str) -> Result<f64, String> {
    let mps = text.parse().ok().filter(|mps| (0.0..=20.0).contains(mps));
    mps.ok_or_else(|| "expected 0 to 20 m/s".into())
}

/// Searches, and writes the page and the replays of the likeliest failures.
pub(crate) fn run(args: &StressArgs) -> Result<ExitCode, Failure> {
    let bounds = match args.kind {
        StressKind::Aircraft => MovementBounds::CREWED,
        StressKind::Uas => MovementBounds::SMALL_UAS,
    };
    let usual = Stress::of(args.vehicle.model()?, args.policy.choice()?, bounds);
    let stress = Stress {
        intruders: args.intruders as usize,
        gust_mps: args.gust_mps.unwrap_or(usual.gust_mps),
        flights: args.flights as usize,
        seed: args.seed,
        ..usual
    };
    watch_for_interrupt();
    let mut display = ProgressDisplay::of("flights");
    let begun = std::time::Instant::now();
    let mut show = |done: usize| {
        display.show(&CampaignProgress {
            done: done as u64,
            before: 0,
            total: stress.flights as u64,
            elapsed_s: begun.elapsed().as_secs_f64(),
            expected: None,
        });
    };
    let written = args
        .threads
        .install(|| fly(&stress, &args.out, &|| !interrupted(), &mut show))??;
    display.end();
    tell_failures([&stress.policy]);
    let Some(written) = written else {
        eprintln!("fga: stopped; the same command goes on");
        return Ok(ExitCode::from(130));
    };
    args.answer
        .print(|| written.words.clone(), &written.document)?;
    Ok(ExitCode::SUCCESS)
}
