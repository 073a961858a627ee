//! The command line of fga: one file per command, each an adapter from files to the libraries.
//!
//! The program `fga` only calls [`main`].

mod alerts;
mod bands;
mod batch;
mod batch_args;
mod batch_input;
mod batch_replays;
mod campaign;
mod campaign_catalogue;
mod campaign_draw;
mod campaign_progress;
mod campaign_report;
mod campaign_source;
mod check;
mod common;
#[cfg(feature = "fly")]
mod emulate;
mod export;
mod failure;
mod file_kind;
#[cfg(feature = "fly")]
mod fly;
#[cfg(feature = "fly")]
mod fly_live;
mod identify;
mod init;
mod league;
mod live;
mod oracle;
#[cfg(feature = "fly")]
mod rc;
mod reproduce;
mod run;
mod shell;
mod stress;
mod terrain;
mod terrain_check;
mod terrain_ground;
#[cfg(feature = "fly")]
mod traffic;
mod unread_kind;
mod view;

extern crate alloc;

use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

use crate::failure::Failure;

/// Real-time 3D collision avoidance for fixed-wing aircraft.
#[derive(Parser)]
#[command(
    name = "fga",
    version = fga_build::VERSION,
    max_term_width = 100,
    after_help = "Exit codes: 0 done; 1 wrong input or usage; 2, only from run: a protected volume, a zone, the ground or an altitude limit was broken; 130 Ctrl-C."
)]
struct Cli {
    #[command(subcommand)]
    command: FgaCommand,
}

#[derive(Subcommand)]
enum FgaCommand {
    /// Fly one scenario or recording in closed loop and show the result.
    Run(run::RunArgs),
    /// Fly the encounters of a file.
    Batch(batch_args::BatchArgs),
    /// Say for each encounter whether any manoeuvre could save it.
    Oracle(oracle::OracleArgs),
    /// Show the alert levels that a DAIDALUS configuration gives a recording.
    Alerts(alerts::AlertsArgs),
    /// Show which manoeuvres lead into a conflict in a recording, as bands.
    Bands(bands::BandsArgs),
    /// Fly drawn encounters by the million under each policy, with results that can be resumed.
    Campaign(campaign::CampaignArgs),
    /// Fly every policy over sets of encounters and write one page: who keeps how many apart, at which cost.
    League(league::LeagueArgs),
    /// Search the likeliest motions of an intruder in which a policy fails.
    Stress(stress::StressArgs),
    /// Fly the paper's evaluation again and write one report.
    Reproduce(reproduce::ReproduceArgs),
    /// Write a run as a file for Google Earth, Cesium, maps or Foxglove, or play it to FlightGear.
    Export(export::ExportArgs),
    /// Show files of heights, cut them, and check a mission against their ground.
    Terrain(terrain::TerrainArgs),
    /// Show a folder of runs, or a campaign, in the browser.
    View(view::ViewArgs),
    /// Fly avoiding manoeuvres on an ArduPlane vehicle over MAVLink.
    #[cfg(feature = "fly")]
    Fly(fly::FlyArgs),
    /// Emulate an ArduPlane-like vehicle and an intruder in real time (it is not ArduPlane).
    #[cfg(feature = "fly")]
    Emulate(emulate::EmulateArgs),
    /// Play intruders as `ADSB_VEHICLE` messages and as BaseStation lines.
    #[cfg(feature = "fly")]
    Traffic(traffic::TrafficArgs),
    /// Fly by keyboard, for tests on the bench.
    #[cfg(feature = "fly")]
    Rc(rc::RcArgs),
    /// Write a vehicle file from a flight log: lag, turn rate and limits, each with an interval.
    Identify(identify::IdentifyArgs),
    /// Write a commented scenario, vehicle, campaign or link file.
    Init(init::InitArgs),
    /// Say whether fga can use a file, without flying it.
    Check(check::CheckArgs),
    /// Print the completion script for a shell.
    Completions(shell::CompletionsArgs),
    /// Write a manual page for each command.
    Man(shell::ManArgs),
}

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    main_with(std::env::args_os())
}

/// Runs the program with these arguments, the first of which is its name.
pub fn main_with(arguments: impl IntoIterator<Item = std::ffi::OsString>) -> ExitCode {
    fga_formats::build::set_commit(fga_build::COMMIT);
    let arguments: Vec<_> = arguments.into_iter().collect();
    let is_json = arguments.iter().any(|argument| argument == "--json");
    let matches = with_negative_numbers(Cli::command()).try_get_matches_from(&arguments);
    let cli = match matches.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) => {
            if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
                let _ = error.print();
                return ExitCode::FAILURE;
            }
            if error.use_stderr() {
                let (told, help) = (one_sentence(&error.to_string()), help_of(&arguments));
                return failed(&Failure::Input(format!("{told} (see {help})")), is_json);
            }
            // A pipe closed while printing help is not an error.
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
    };
    let result = match cli.command {
        FgaCommand::Run(args) => run::run(&args),
        FgaCommand::Batch(args) => batch::run(&args),
        FgaCommand::Oracle(args) => oracle::run(&args),
        FgaCommand::Alerts(args) => alerts::run(&args),
        FgaCommand::Bands(args) => bands::run(&args),
        FgaCommand::Campaign(args) => campaign::run(&args),
        FgaCommand::League(args) => league::run(&args),
        FgaCommand::Stress(args) => stress::run(&args),
        FgaCommand::Reproduce(args) => reproduce::run(&args),
        FgaCommand::Export(args) => export::run(&args),
        FgaCommand::Terrain(args) => terrain::run(&args),
        FgaCommand::View(args) => view::run(&args),
        #[cfg(feature = "fly")]
        FgaCommand::Fly(args) => fly::run(&args),
        #[cfg(feature = "fly")]
        FgaCommand::Emulate(args) => emulate::run(&args),
        #[cfg(feature = "fly")]
        FgaCommand::Traffic(args) => traffic::run(&args),
        #[cfg(feature = "fly")]
        FgaCommand::Rc(args) => rc::run(&args),
        FgaCommand::Identify(args) => identify::run(&args),
        FgaCommand::Init(args) => init::run(&args),
        FgaCommand::Check(args) => check::run(&args),
        FgaCommand::Completions(args) => shell::completions(&args, Cli::command()),
        FgaCommand::Man(args) => shell::man(&args, Cli::command()),
    };
    match result {
        Ok(code) => code,
        Err(Failure::BrokenPipe) => ExitCode::SUCCESS,
        Err(Failure::Interrupted) => {
            eprintln!("fga: interrupted; nothing was written");
            ExitCode::from(130)
        }
        Err(failure) => failed(&failure, is_json),
    }
}

/// Says a failure on standard error, and as JSON where that is asked for.
fn failed(failure: &Failure, is_json: bool) -> ExitCode {
    eprintln!("fga: {failure}");
    if is_json {
        common::print_failure(failure);
    }
    ExitCode::FAILURE
}

/// The same command, whose options take negative numbers too: the limits of an option answer, not the syntax.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let takes = |arg: clap::Arg| {
        let takes_values = arg.get_action().takes_values();
        arg.allow_negative_numbers(takes_values)
    };
    command
        .mut_args(takes)
        .mut_subcommands(with_negative_numbers)
}

/// A message about wrong usage without its layout.
fn one_sentence(message: &str) -> String {
    let told: Vec<&str> = message
        .lines()
        .map(str::trim)
        .take_while(|line| !line.starts_with("Usage:"))
        .filter(|line| !line.is_empty() && !line.starts_with("tip:"))
        .filter(|line| !line.starts_with("For more information"))
        .collect();
    let told = told.join(" ");
    told.strip_prefix("error: ").unwrap_or(&told).to_owned()
}

/// The command that shows the help of the subcommand in these arguments.
fn help_of(arguments: &[std::ffi::OsString]) -> String {
    let mut command = &Cli::command();
    let mut words = "fga".to_owned();
    for argument in arguments.iter().skip(1) {
        let Some(inner) = command.find_subcommand(argument) else {
            break;
        };
        command = inner;
        words = format!("{words} {}", inner.get_name());
    }
    words + " --help"
}
