//! `fga campaign report`: the safety case of a campaign as one page.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use fga_campaign::campaign::{Campaign, Folder, RESULTS};
use fga_formats::atomic;
use fga_results::campaign::safety::with_traffic;
use serde_json::json;

use crate::common::AnswerArgs;
use crate::failure::Failure;

/// Options of `fga campaign report`.
#[derive(Args, Debug)]
pub(crate) struct ReportArgs {
    /// Folder of a campaign.
    folder: PathBuf,
    /// Number of worst encounters of each policy with a replay.
    #[arg(long, value_name = "N", default_value_t = 5)]
    worst: usize,
    /// Density of the traffic, aircraft in a cubic kilometre, for losses in a flight hour; encounters of uncorrelated models only.
    #[arg(long, value_name = "DENSITY", value_parser = density)]
    traffic_per_km3: Option<f64>,
    /// Source of that density, for the page.
    #[arg(long, value_name = "TEXT", requires = "traffic_per_km3")]
    traffic_source: Option<String>,
    #[command(flatten)]
    answer: AnswerArgs,
}

fn density(text: &str) -> Result<f64, String> {
    let density: f64 = text
        .parse()
        .map_err(|_| format!("found {text:?}, expected a number"))?;
    if density > 0.0 && density <= 1000.0 {
        Ok(density)
    } else {
        Err(format!(
            "found {density}, expected above 0 and up to 1000 aircraft in a cubic kilometre"
        ))
    }
}

/// Writes `report.html` and the replays of the worst encounters.
pub(crate) fn run(args: &ReportArgs) -> Result<ExitCode, Failure> {
    let folder = Folder::at(&args.folder);
    let Some(manifest) = folder.manifest()? else {
        return Err(Failure::Input(format!(
            "{}: holds no campaign, expected a folder that fga campaign run wrote",
            args.folder.display()
        )));
    };
    let campaign = Campaign::new(manifest.configuration.clone(), &args.folder)?;
    if !folder.file(RESULTS).exists() {
        return Err(Failure::Input(format!(
            "{}: is not complete, expected a campaign that was flown to its end (--resume goes on)",
            args.folder.display()
        )));
    }
    let configuration = &campaign.configuration;
    if configuration.recordings.is_empty() && configuration.models.is_empty() {
        return Err(Failure::Input(format!(
            "{}: has no encounters of aircraft, expected a campaign with recordings or a [[model]]",
            args.folder.display()
        )));
    }
    let mut case = with_traffic(
        &campaign,
        &manifest,
        &folder,
        (args.worst, None),
        args.traffic_per_km3,
    )?;
    case.traffic_source.clone_from(&args.traffic_source);
    let page = args.folder.join("report.html");
    atomic::write(&page, case.to_html())?;
    args.answer.print(
        || format!("safety case in {}\n", page.display()),
        &json!({ "file": page.display().to_string(), "worst": case.worst.len() }),
    )?;
    Ok(ExitCode::SUCCESS)
}
