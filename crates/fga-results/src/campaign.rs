//! The files of a complete campaign.

pub mod risk;
pub mod safety;
pub mod summary;

use fga_campaign::campaign::{
    Assembled, Campaign, CampaignError, Folder, Manifest, PolicyTimes, Summary,
};
use fga_formats::atomic;
use serde_json::{Value, json};

use crate::flight_files;
use crate::provenance::Provenance;

/// Writes everything about a complete campaign; returns its summary.
///
/// # Errors
/// A folder that cannot be written, or settings that the core refuses.
pub fn finish(
    folder: &Folder,
    campaign: &Campaign,
    manifest: &Manifest,
    mut assembled: Assembled,
    provenance: &Provenance,
    mut more: Value,
) -> Result<Summary, CampaignError> {
    write_events(folder, campaign)?;
    summary::write(folder.path(), campaign, &assembled.summary)?;
    risk::write(folder.path(), campaign, &assembled.summary.risks)?;
    if let Some(more) = more.as_object_mut() {
        more.insert("results_sha256".into(), json!(assembled.sha256));
    }
    let document = document(provenance, manifest, more);
    atomic::write(&folder.file("run.json"), format!("{document:#}\n"))?;
    assembled.commit()?;
    folder.remove_blocks()?;
    Ok(assembled.summary)
}

/// The times of the decisions of one run, for its `run.json`: of all policies together, and of each.
pub fn decision_times(campaign: &Campaign, times: &[PolicyTimes], fly_s: f64) -> Value {
    let encounters = times.first().map_or(0, |times| times.encounters);
    let policies: Vec<Value> = campaign
        .configuration
        .policies
        .iter()
        .zip(times)
        .map(|(policy, times)| {
            json!({
                "policy": policy,
                "encounters": times.encounters,
                "decisions": times.decisions,
                "decision_median_us": times.median_us.at(0.5),
                "decision_median_p99_us": times.median_us.at(0.99),
                "decision_max_us": times.max_ns as f64 / 1000.0,
                "flight_mean_us": times.flight_ns as f64 / 1000.0 / times.encounters.max(1) as f64,
            })
        })
        .collect();
    json!({
        "encounters_flown": encounters,
        "flying_s": fly_s,
        "encounters_per_s": encounters as f64 / fly_s,
        "policies": policies,
    })
}

/// Writes the events of the encounters in the key `events`, flown again under every policy.
fn write_events(folder: &Folder, campaign: &Campaign) -> Result<(), CampaignError> {
    let configuration = &campaign.configuration;
    if configuration.events.is_empty() {
        return Ok(());
    }
    let events = folder.file("events");
    atomic::prepare_folder(&events)?;
    for &number in &configuration.events {
        for (name, policy) in configuration.policies.iter().zip(&campaign.policies) {
            let log = campaign.show(number, policy)?;
            let file = format!("{number}-{}.jsonl", name.replace(" --start ", "-"));
            let text = flight_files::events_jsonl(&flight_files::events(&log));
            atomic::write(&events.join(file), text)?;
        }
    }
    Ok(())
}

/// `run.json` of a campaign; `more` adds the command's figures.
pub fn document(provenance: &Provenance, manifest: &Manifest, more: Value) -> Value {
    let configuration = serde_json::to_value(&manifest.configuration).unwrap_or_default();
    let mut document = provenance.to_json("campaign", &configuration, more);
    if let Some(document) = document.as_object_mut() {
        let hash = json!(manifest.configuration_hash);
        document.insert("configuration_hash".into(), hash);
        document.insert("seed".into(), json!(manifest.configuration.seeds));
    }
    document
}
