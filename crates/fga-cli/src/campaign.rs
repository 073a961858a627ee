//! `fga campaign`: draws encounters by the million and flies each under every policy.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Once;

use clap::{Args, Subcommand};
use fga_campaign::campaign::file::{self, Overrides};
use fga_campaign::campaign::{
    Campaign, CampaignError, CampaignStamp, CampaignTask, Folder, Manifest, PolicyTimes, RESULTS,
    Shard, assemble, merge, reread, run as fly,
};
use fga_formats::atomic;
use fga_formats::error::read_text;
use fga_formats::words::{counted, per_second};
use fga_results::campaign::summary::{document as summary_document, in_words};
use fga_results::campaign::{decision_times, document, finish};
use fga_results::flight::summary as flight_summary;
use fga_results::flight_files;
use fga_results::provenance::{Provenance, TARGET};
use fga_sim::policy::PolicyChoice;
use serde_json::{Value, json};

use crate::batch_input::PARTS;
use crate::campaign_draw::{self, DrawArgs};
use crate::campaign_progress::ProgressDisplay;
use crate::campaign_report::{self, ReportArgs};
use crate::campaign_source::SourceArgs;
use crate::common::{
    self, AnswerArgs, OutArgs, OverlayArgs, ThreadArgs, interrupted, tell_failures, tell_left_out,
    watch_for_interrupt,
};
use crate::failure::Failure;

/// Options of `fga campaign`.
#[derive(Args, Debug)]
pub(crate) struct CampaignArgs {
    #[command(subcommand)]
    command: CampaignCommand,
}

#[derive(Subcommand, Debug)]
enum CampaignCommand {
    /// Fly a campaign, or continue one.
    Run(CampaignRunArgs),
    /// Write a campaign's encounters as files, without flying them.
    Draw(DrawArgs),
    /// Merge the parts of a campaign.
    Merge(MergeArgs),
    /// Fly one encounter of a campaign again and write what `fga run` writes.
    Show(ShowArgs),
    /// Write the safety case of a campaign of aircraft as one page, report.html.
    Report(ReportArgs),
}

#[derive(Args, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "one switch each")]
struct CampaignRunArgs {
    /// The campaign file (.toml).
    file: PathBuf,
    /// Number of encounters over all cells; without it the file's number.
    #[arg(long, value_name = "N", value_parser = common::encounters)]
    encounters: Option<u64>,
    /// Continue with the results in the folder; an empty folder starts.
    #[arg(long)]
    resume: bool,
    /// Fly only part K of N, counted from 1; `fga campaign merge` merges the parts.
    #[arg(long, value_name = "K/N", value_parser = Shard::parse)]
    shard: Option<Shard>,
    /// Ask the oracle which encounters any manoeuvre can save.
    #[arg(long)]
    oracle: bool,
    /// Also write results.csv.
    #[arg(long)]
    csv: bool,
    /// A policy instead of the file's, as in "published --start t0"; may be given several times.
    #[arg(long, value_name = "POLICY")]
    policy: Vec<String>,
    /// A vehicle file instead of the one in the campaign file.
    #[arg(long, value_name = "FILE")]
    vehicle: Option<PathBuf>,
    #[command(flatten)]
    sources: SourceArgs,
    /// Exit with 0 although damaged recordings were left out.
    #[arg(long)]
    skip_damaged: bool,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    answer: AnswerArgs,
}

#[derive(Args, Debug)]
struct MergeArgs {
    /// Folders of the parts.
    #[arg(required = true, value_name = "DIR")]
    parts: Vec<PathBuf>,
    /// Folder for the whole campaign.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Also write results.csv.
    #[arg(long)]
    csv: bool,
    #[command(flatten)]
    answer: AnswerArgs,
}

#[derive(Args, Debug)]
struct ShowArgs {
    /// Folder of a campaign.
    folder: PathBuf,
    /// Number of the encounter, from 0.
    #[arg(long, value_name = "N")]
    encounter: u64,
    /// The policy; without it the campaign's first one.
    #[arg(long, value_name = "POLICY")]
    policy: Option<String>,
    /// When a manoeuvre begins: t0, tc, latest, free or Cs=0.5.
    #[arg(long, value_name = "START", requires = "policy")]
    start: Option<String>,
    #[command(flatten)]
    overlay: OverlayArgs,
    /// Folder for the flight; without it out/<name of the folder>-<number>.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    answer: AnswerArgs,
}

impl From<CampaignError> for Failure {
    fn from(error: CampaignError) -> Self {
        match error {
            CampaignError::Output(error) => Self::Output(error),
            other => Self::Input(other.to_string()),
        }
    }
}

/// Runs the subcommand.
pub(crate) fn run(args: &CampaignArgs) -> Result<ExitCode, Failure> {
    match &args.command {
        CampaignCommand::Run(args) => run_campaign(args),
        CampaignCommand::Draw(args) => campaign_draw::run(args),
        CampaignCommand::Merge(args) => merge_parts(args),
        CampaignCommand::Show(args) => show(args),
        CampaignCommand::Report(args) => campaign_report::run(args),
    }
}

fn run_campaign(args: &CampaignRunArgs) -> Result<ExitCode, Failure> {
    let provenance = Provenance::begin();
    let overrides = Overrides {
        encounters: args.encounters,
        policies: args.policy.clone(),
        vehicle: args.vehicle.as_deref().map(read_text).transpose()?,
        oracle: args.oracle,
        ..args.sources.overrides()
    };
    let configuration = file::read(&args.file, &overrides)?;
    tell_left_out(&configuration.damaged, &configuration.tally, PARTS);
    let campaign = Campaign::new(configuration, &args.file)?;
    let task = CampaignTask {
        campaign: &campaign,
        shard: args.shard.unwrap_or(Shard::WHOLE),
        stamp: CampaignStamp::of_this_build(TARGET),
        folder: Folder::at(&args.out.prepare(&args.file)?),
        resume: args.resume,
        is_expected: true,
        ends_begun: true,
    };
    let manifest = task.manifest();
    if args.resume && task.folder.file(RESULTS).exists() {
        finished(&task, &manifest, args.answer)?;
        return verdict(&campaign, args.skip_damaged);
    }
    watch_for_interrupt();
    let mut display = ProgressDisplay::new();
    let told = Once::new();
    let go_on = || {
        if interrupted() {
            told.call_once(|| {
                eprintln!("fga: ends the blocks that are begun; Ctrl-C again ends at once");
            });
        }
        !interrupted()
    };
    let flown = args.threads.install(|| {
        fly(&task, &go_on, &mut |progress| {
            display.show(progress);
        })
    })?;
    display.end();
    tell_failures(&campaign.policies);
    let times = match flown {
        Err(error @ CampaignError::Stopped { .. }) => {
            eprintln!("fga: {error}");
            return Ok(ExitCode::from(130));
        }
        other => other?,
    };
    let fly_s = display.flying_s();
    if times.iter().all(|times| times.encounters == 0) {
        tell_complete(&task.folder);
    }
    let part = task.shard;
    let more = json!({
        "input": args.file.display().to_string(),
        "shard": format!("{}/{}", part.number, part.of),
        "decision_times": decision_times(&campaign, &times, fly_s),
        "left_out": campaign.configuration.left_out(),
    });
    if part != Shard::WHOLE {
        let document = document(&provenance, &manifest, more);
        atomic::write(&task.folder.file("run.json"), format!("{document:#}\n"))?;
        let name = &campaign.configuration.name;
        args.answer.print(
            || {
                format!(
                    "part {}/{} of {name} is complete; put the parts together with fga campaign merge\n",
                    part.number, part.of
                )
            },
            &json!({ "name": name, "shard": format!("{}/{}", part.number, part.of), "complete": true }),
        )?;
        return verdict(&campaign, args.skip_damaged);
    }
    let blocks = task.folder.blocks()?;
    let assembled = assemble(&blocks, &campaign, &task.stamp, &task.folder, args.csv)?;
    let summary = finish(
        &task.folder,
        &campaign,
        &manifest,
        assembled,
        &provenance,
        more,
    )?;
    args.answer.print(
        || {
            let rate = rate(&times, fly_s).unwrap_or_default();
            in_words(&campaign, &summary, task.folder.path()) + &rate
        },
        &with_left_out(&campaign, summary_document(&campaign, &summary)),
    )?;
    verdict(&campaign, args.skip_damaged)
}

/// The folder already holds all results.
fn finished(
    task: &CampaignTask<'_>,
    manifest: &Manifest,
    answer: AnswerArgs,
) -> Result<(), Failure> {
    task.folder.open(manifest, true)?;
    let expected = std::fs::read(task.folder.file("run.json"))
        .ok()
        .and_then(|bytes| serde_json::from_slice::<Value>(&bytes).ok())
        .and_then(|document| Some(document.get("results_sha256")?.as_str()?.to_owned()));
    let assembled = reread(&task.folder, task.campaign, expected.as_deref())?;
    task.folder.remove_blocks()?;
    tell_complete(&task.folder);
    answer.print(
        || in_words(task.campaign, &assembled.summary, task.folder.path()),
        &with_left_out(
            task.campaign,
            summary_document(task.campaign, &assembled.summary),
        ),
    )?;
    Ok(())
}

/// A summary with what was left out of the recordings.
fn with_left_out(campaign: &Campaign, mut summary: Value) -> Value {
    summary["left_out"] = campaign.configuration.left_out().into();
    summary
}

/// Says that earlier runs flew every encounter.
fn tell_complete(folder: &Folder) {
    eprintln!(
        "nothing is left to fly: {} holds every encounter",
        folder.path().display()
    );
}

/// Left-out recordings are an error unless `--skip-damaged` accepts them.
fn verdict(campaign: &Campaign, skip_damaged: bool) -> Result<ExitCode, Failure> {
    let configuration = &campaign.configuration;
    let damaged = configuration.damaged.len();
    if damaged == 0 || skip_damaged {
        return Ok(ExitCode::SUCCESS);
    }
    Err(Failure::Input(format!(
        "{damaged} of {} recordings cannot be used and were left out, the rest is flown; with --skip-damaged that is a success",
        damaged + configuration.recordings.len()
    )))
}

fn rate(times: &[PolicyTimes], fly_s: f64) -> Option<String> {
    let encounters = times.first()?.encounters;
    (encounters > 0).then(|| {
        format!(
            "{} flown in {fly_s:.1} s: {} a second\n",
            counted(encounters, "encounter"),
            per_second(encounters as f64 / fly_s)
        )
    })
}

fn merge_parts(args: &MergeArgs) -> Result<ExitCode, Failure> {
    let provenance = Provenance::begin();
    let parts = merge(&args.parts)?;
    let folder = Folder::at(&args.out);
    if folder.manifest()?.is_some() || folder.file(RESULTS).exists() {
        return Err(Failure::Input(format!(
            "{}: holds a campaign already, expected an empty folder",
            args.out.display()
        )));
    }
    atomic::prepare_folder(&args.out)?;
    let stamp = &parts.manifest.stamp;
    let assembled = assemble(&parts.blocks, &parts.campaign, stamp, &folder, args.csv)?;
    folder.write_manifest(&parts.manifest)?;
    let from: Vec<String> = args.parts.iter().map(|p| p.display().to_string()).collect();
    let more = json!({ "merged_from": from });
    let summary = finish(
        &folder,
        &parts.campaign,
        &parts.manifest,
        assembled,
        &provenance,
        more,
    )?;
    args.answer.print(
        || in_words(&parts.campaign, &summary, folder.path()),
        &summary_document(&parts.campaign, &summary),
    )?;
    Ok(ExitCode::SUCCESS)
}

fn show(args: &ShowArgs) -> Result<ExitCode, Failure> {
    let provenance = Provenance::begin();
    let Some(manifest) = Folder::at(&args.folder).manifest()? else {
        return Err(Failure::Input(format!(
            "{}: holds no campaign, expected a folder that fga campaign run wrote",
            args.folder.display()
        )));
    };
    let campaign = Campaign::new(manifest.configuration.clone(), &args.folder)?;
    let policy = match (&args.policy, campaign.policies.first()) {
        (Some(name), _) => match &args.start {
            Some(start) => PolicyChoice::parse(name, Some(start)),
            None => fga_campaign::campaign::parse_policy(name),
        }
        .map_err(Failure::Input)?,
        (None, Some(first)) => first.clone(),
        (None, None) => PolicyChoice::default(),
    };
    let overlaid = args
        .overlay
        .choices(&policy)?
        .iter()
        .map(|policy| campaign.show(args.encounter, policy))
        .collect::<Result<Vec<_>, _>>()?;
    let log = campaign.show(args.encounter, &policy)?;
    tell_failures([&policy]);
    let folder = args.out.clone().unwrap_or_else(|| {
        let name = args.folder.file_name().unwrap_or("campaign".as_ref());
        Path::new("out").join(format!("{}-{}", name.to_string_lossy(), args.encounter))
    });
    atomic::prepare_folder(&folder)?;
    let configuration = json!({
        "campaign": manifest.configuration_hash,
        "encounter": args.encounter,
        "policy": log.policy,
        "overlay": overlaid.iter().map(|log| log.policy.as_str()).collect::<Vec<_>>(),
    });
    let summary = flight_summary(&log);
    let mut more = summary.clone();
    if let Some(more) = more.as_object_mut() {
        more.insert("input".into(), json!(args.folder.display().to_string()));
        more.insert("seed".into(), json!(log.plan.world.seed));
        more.insert("vehicle".into(), json!(log.plan.model.name));
    }
    let document = provenance.to_json("campaign show", &configuration, more);
    flight_files::write(&folder, &log, &overlaid, &document)?;
    args.answer
        .print(|| crate::run::in_words(&log, &overlaid, &folder), &summary)?;
    Ok(ExitCode::SUCCESS)
}
