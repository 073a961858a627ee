//! The summary of a campaign: `summary.csv`, `summary.json`, and the printed table.

use core::fmt::Write as _;
use std::path::Path;

use fga_campaign::campaign::{Campaign, Quantiles, Summary, Totals};
use fga_formats::OutputError;
use fga_formats::atomic;
use fga_formats::words::counted;
use fga_report::interval::Estimate;
use serde_json::{Value, json};

use super::risk;
use crate::named_rows::{csv, objects, rounded};

/// The written quantiles of the distributions.
const SHARES: [(&str, f64); 5] = [
    ("p01", 0.01),
    ("p05", 0.05),
    ("p50", 0.5),
    ("p95", 0.95),
    ("p99", 0.99),
];

/// The source that stands for all sources.
const ALL: &str = "all";

/// One row: names and values in order.
fn row_of(policy: &str, source: &str, totals: &Totals) -> Vec<(String, Value)> {
    let mut row = vec![
        ("policy".to_owned(), json!(policy)),
        ("source".to_owned(), json!(source)),
        ("encounters".to_owned(), json!(totals.encounters)),
        ("threatened".to_owned(), json!(totals.threatened)),
    ];
    let mut share = |name: &str, count: u64, of: u64| {
        let estimate = Estimate::wilson(count, of);
        row.push((name.to_owned(), json!(count)));
        for (end, value) in [
            ("share", estimate.map(|e| e.value)),
            ("low", estimate.map(|e| e.low)),
            ("high", estimate.map(|e| e.high)),
        ] {
            row.push((format!("{name}_{end}"), json!(value.map(rounded))));
        }
    };
    share("separated", totals.separated, totals.encounters);
    share("avoidable", totals.avoidable, totals.asked);
    share(
        "saved_of_avoidable",
        totals.saved_of_avoidable,
        totals.avoidable,
    );
    share(
        "saved_of_lost",
        totals.saved_of_lost,
        totals.asked - totals.avoidable,
    );
    share("manoeuvred", totals.manoeuvred, totals.encounters);
    share(
        "needless",
        totals.needless,
        totals.encounters - totals.threatened,
    );
    share("caused", totals.caused, totals.encounters);
    share("rejoined", totals.rejoined, totals.manoeuvred);
    for (name, unit, quantiles) in distributions(totals) {
        for (label, share) in SHARES {
            row.push((
                format!("{name}_{label}_{unit}"),
                json!(quantiles.at(share).map(rounded)),
            ));
        }
    }
    row
}

fn distributions(totals: &Totals) -> [(&'static str, &'static str, &Quantiles); 4] {
    [
        ("margin", "m", &totals.margin_m),
        ("cross_track", "m", &totals.cross_track_m),
        ("extra_path", "m", &totals.extra_path_m),
        ("time_away", "s", &totals.time_away_s),
    ]
}

fn rows(campaign: &Campaign, summary: &Summary) -> Vec<Vec<(String, Value)>> {
    let name =
        |names: &[String], index: u32| names.get(index as usize).cloned().unwrap_or_default();
    let policies = &campaign.configuration.policies;
    let all = summary
        .policies()
        .map(|(policy, totals)| row_of(&name(policies, policy), ALL, totals));
    let each = summary.sources().map(|(policy, source, totals)| {
        row_of(
            &name(policies, policy),
            &name(campaign.source_names(), source),
            totals,
        )
    });
    all.chain(each).collect()
}

/// The content of `summary.json`: one object for each policy over all sources, then for each source.
pub fn document(campaign: &Campaign, summary: &Summary) -> Value {
    json!({
        "name": campaign.configuration.name,
        "configuration_hash": campaign.hash,
        "rows": objects(rows(campaign, summary)),
        "risk": risk::document(campaign, &summary.risks),
    })
}

/// Writes `summary.csv` and `summary.json`.
///
/// # Errors
/// A folder that cannot be written.
pub fn write(folder: &Path, campaign: &Campaign, summary: &Summary) -> Result<(), OutputError> {
    let rows = rows(campaign, summary);
    atomic::write(&folder.join("summary.csv"), csv(&rows))?;
    let document = document(campaign, summary);
    atomic::write(&folder.join("summary.json"), format!("{document:#}\n"))
}

/// The summary in words.
pub fn in_words(campaign: &Campaign, summary: &Summary, folder: &Path) -> String {
    let configuration = &campaign.configuration;
    let mut text = format!(
        "{}: {} from {}, vehicle {}\n",
        configuration.name,
        counted(configuration.encounters, "encounter"),
        counted(campaign.source_names().len(), "source"),
        campaign.model.name
    );
    let _ = writeln!(
        text,
        "{:<28} {:>24} {:>24} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "policy",
        "separated (%)",
        "saved of avoidable (%)",
        "needless",
        "caused",
        "margin",
        "away (m)",
        "away (s)"
    );
    for (policy, totals) in summary.policies() {
        let name = configuration
            .policies
            .get(policy as usize)
            .map_or("", String::as_str);
        let median = |quantiles: &Quantiles| {
            quantiles
                .at(0.5)
                .map_or_else(|| "-".to_owned(), |value| format!("{value:.1}"))
        };
        let _ = writeln!(
            text,
            "{name:<28} {:>24} {:>24} {:>9} {:>9} {:>9} {:>9} {:>9}",
            percent(Estimate::wilson(totals.separated, totals.encounters)),
            percent(Estimate::wilson(
                totals.saved_of_avoidable,
                totals.avoidable
            )),
            totals.needless,
            totals.caused,
            median(&totals.margin_m),
            median(&totals.cross_track_m),
            median(&totals.time_away_s),
        );
    }
    let _ = writeln!(text, "(95 % intervals by Wilson; margin, away: medians)");
    risk::push_words(&mut text, campaign, &summary.risks);
    let _ = writeln!(text, "results in {}", folder.display());
    text
}

fn percent(estimate: Option<Estimate>) -> String {
    estimate.map_or_else(
        || "-".into(),
        |e| {
            format!(
                "{:.2} [{:.2}, {:.2}]",
                100.0 * e.value,
                100.0 * e.low,
                100.0 * e.high
            )
        },
    )
}
