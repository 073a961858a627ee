//! `fga stress`: searches the likeliest motions of an intruder in which a policy fails.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use fga::situation::MovementBounds;
use fga_results::stress::write;
use fga_sim::campaign::Progress;
use fga_sim::stress::{Stress, search};

use crate::campaign_progress::Display;
use crate::common::{
    AnswerArgs, PolicyArgs, ThreadArgs, VehicleArgs, interrupted, tell_failures,
    watch_for_interrupt,
};
use crate::failure::Failure;

/// What the intruder is.
#[derive(ValueEnum, Debug, Clone, Copy)]
enum Kind {
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
    #[arg(long, value_name = "KIND", value_enum, default_value_t = Kind::Uas)]
    kind: Kind,
    /// Flights of the search, 1 to 1000000.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    flights: u32,
    /// Master seed.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Folder for the results.
    #[arg(long, value_name = "DIR", default_value = "out/stress")]
    out: PathBuf,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// Searches, and writes the page and the replays of the likeliest failures.
pub(crate) fn run(args: &StressArgs) -> Result<ExitCode, Failure> {
    let stress = Stress {
        model: args.vehicle.model()?,
        policy: args.policy.choice()?,
        bounds: match args.kind {
            Kind::Aircraft => MovementBounds::CREWED,
            Kind::Uas => MovementBounds::SMALL_UAS,
        },
        flights: args.flights as usize,
        seed: args.seed,
    };
    fga_formats::atomic::prepare_folder(&args.out)?;
    watch_for_interrupt();
    let mut display = Display::of("flights");
    let begun = std::time::Instant::now();
    let mut show = |done: usize| {
        display.show(&Progress {
            done: done as u64,
            before: 0,
            total: stress.flights as u64,
            elapsed_s: begun.elapsed().as_secs_f64(),
            expected: None,
        });
    };
    let found = args
        .threads
        .install(|| search(&stress, &|| !interrupted(), &mut show))?
        .map_err(Failure::Input)?;
    display.end();
    tell_failures([&stress.policy]);
    if interrupted() {
        return Err(Failure::Interrupted);
    }
    let written = write(&stress, &found, &args.out)?;
    args.answer
        .print(|| written.words.clone(), &written.document)?;
    Ok(ExitCode::SUCCESS)
}
