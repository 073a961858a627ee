//! What the program writes about a flight or a campaign, to the byte, for whoever flies without it.

use std::path::Path;

use fga_formats::OutputError;
use fga_sim::campaign::{Assembled, Campaign, CampaignError, Folder, Manifest, Summary};
use fga_sim::run::RunLog;
use serde_json::{Value, json};

use crate::provenance::Provenance;
use crate::{campaign, replay_page, run, run_files};

/// What this build was made for; it stands in `run.json` and in the table of a campaign.
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

/// The replay page of a flight, with others laid over it.
pub fn replay_page(log: &RunLog, overlaid: &[RunLog]) -> String {
    replay_page::page(core::iter::once(log).chain(overlaid))
}

/// Writes what `fga run` writes about a flight of `input`, whose fingerprint is `input_sha256`.
///
/// # Errors
/// A folder that cannot be written.
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

/// Writes everything about a campaign whose blocks were put together, and gives its table its name;
/// the blocks in the folder are taken away then. What it says together.
///
/// # Errors
/// A folder that cannot be written, or settings that the core refuses.
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
