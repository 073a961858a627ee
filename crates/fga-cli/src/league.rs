//! `fga league`: every policy over sets of encounters, one page.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Once;

use clap::Args;
use fga_campaign::campaign::CampaignError;
use fga_results::league::{Terms, checked_data, data_of_environment, run as fly};

use crate::campaign_progress::ProgressDisplay;
use crate::common::{
    self, AnswerArgs, ThreadArgs, interrupted, tell_failures, watch_for_interrupt,
};
use crate::failure::Failure;

/// Options of `fga league`.
#[derive(Args, Debug)]
pub(crate) struct LeagueArgs {
    /// Sets, as in "flown-1hz,drawn-1hz", or campaign files (.toml); without any all shipped sets whose data are there: flown,
    /// flown-1hz, low-altitude-1hz, correlated-1hz, drawn-1hz, fleet-1hz.
    #[arg(long, value_name = "SETS", value_delimiter = ',')]
    sets: Vec<String>,
    /// A policy, as in "published --start t0" or "pipe:./my-policy"; may be given several times; without any all built-in ones.
    #[arg(long, value_name = "POLICY")]
    policy: Vec<String>,
    /// A policy by which intruders with tracks react, as in "see-and-avoid", or "itself" for the policy of the ownship; may be
    /// given several times. Each set also flies without.
    #[arg(long, value_name = "POLICY")]
    intruders: Vec<String>,
    /// Folder of third-party data; without it `FGA_DATA`.
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Encounters of each set that draws them; without it 1000, and 100 fleets.
    #[arg(long, value_name = "N", value_parser = common::encounters)]
    encounters: Option<u64>,
    /// Number of worst encounters of each policy in each set with a replay.
    #[arg(long, value_name = "N", default_value_t = 3)]
    worst: usize,
    /// Folder for the results; a league in it goes on.
    #[arg(long, value_name = "DIR", default_value = "out/league")]
    out: PathBuf,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// Flies what is missing and writes the page.
pub(crate) fn run(args: &LeagueArgs) -> Result<ExitCode, Failure> {
    let data = args.data.clone().or_else(data_of_environment);
    let terms = Terms {
        sets: args.sets.clone(),
        policies: args.policy.clone(),
        intruders: args.intruders.clone(),
        own: Vec::new(),
        data: data.map(checked_data).transpose()?,
        encounters: args.encounters,
        worst: args.worst,
    };
    // Until the first flight Ctrl-C ends the program at once.
    let watches = Once::new();
    let go_on = || {
        watches.call_once(watch_for_interrupt);
        !interrupted()
    };
    let mut display: Option<(String, ProgressDisplay)> = None;
    let flown = args.threads.install(|| {
        fly(&terms, &args.out, &go_on, &mut |set, policy, progress| {
            let now = format!("{set}, {policy}");
            if display.as_ref().is_none_or(|(name, _)| *name != now) {
                if let Some((_, display)) = display.take() {
                    display.end();
                }
                eprintln!("{now}");
                display = Some((now, ProgressDisplay::new()));
            }
            if let Some((_, display)) = &mut display {
                display.show(progress);
            }
        })
    })?;
    if let Some((_, display)) = display {
        display.end();
    }
    let flown = match flown {
        Err(CampaignError::Stopped { .. }) => {
            eprintln!("fga: stopped; the same command goes on");
            return Ok(ExitCode::from(130));
        }
        other => other?,
    };
    for sentence in &flown.left_out {
        eprintln!("fga: left out: {sentence}");
    }
    tell_failures(&flown.own);
    let answer = serde_json::json!({
        "file": flown.page.display().to_string(),
        "left_out": flown.left_out,
        "standings": flown.rows,
    });
    let words = || format!("{}page in {}\n", flown.words, flown.page.display());
    args.answer.print(words, &answer)?;
    Ok(ExitCode::SUCCESS)
}
