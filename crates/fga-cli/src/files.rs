//! The program's output files about a flight or a campaign, for callers without a process.

use std::path::Path;

use fga_formats::OutputError;
use fga_sim::campaign::{Assembled, Campaign, CampaignError, Folder, Manifest, Summary};
use fga_sim::run::RunLog;
use serde_json::{Value, json};

use crate::provenance::Provenance;
use crate::{campaign, replay_page, run, run_files};

/// The target of this build, for `run.json` and the table of a campaign.
pub const TARGET: &str = env!("FGA_TARGET");

/// The summary of a flight: what `fga run --json` prints.
pub fn summary(log: &RunLog) -> Value {
    run::summary(log)
}

/// `track.csv` of a flight.
pub fn track_csv(log: &RunLog) -> Vec<u8> {
    run_files::track_csv(log)
}

/// `events.jsonl` of a flight.
pub fn events_jsonl(log: &RunLog) -> String {
    run_files::events_jsonl(&run_files::events(log))
}

/// The replay page of a flight, with further flights in the same scene.
pub fn replay_page(log: &RunLog, overlaid: &[RunLog]) -> String {
    replay_page::page(core::iter::once(log).chain(overlaid))
}

/// Writes the files of `fga run` for a flight of `input`, whose fingerprint is `input_sha256`.
///
/// # Errors
/// An unwritable folder.
pub fn write_run(
    folder: &Path,
    (input, input_sha256): (&Path, &str),
    log: &RunLog,
    overlaid: &[RunLog],
) -> Result<(), OutputError> {
    fga_formats::atomic::prepare_folder(folder)?;
    let document = run::document(&Provenance::begin(), (input, input_sha256), log, overlaid);
    run_files::write(folder, log, overlaid, &document)
}

/// Writes everything about a campaign from its merged blocks, gives the table its name and removes the
/// blocks. Returns the summary.
///
/// # Errors
/// An unwritable folder, or settings that the core refuses.
pub fn finish_campaign(
    folder: &Folder,
    campaign: &Campaign,
    manifest: &Manifest,
    assembled: Assembled,
) -> Result<Summary, CampaignError> {
    let provenance = Provenance::begin();
    campaign::finish(
        folder,
        campaign,
        manifest,
        assembled,
        &provenance,
        json!({}),
    )
}
