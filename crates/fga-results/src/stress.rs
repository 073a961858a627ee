//! The results of a stress test: a page, a table of failures, their replays.

use core::fmt::Write as _;
use std::path::Path;

use fga_formats::atomic;
use fga_formats::words::counted;
use fga_report::report::{Block, Cell, Column, Report, Section, Table};
use fga_sim::campaign::{CampaignError, Stamp};
use fga_sim::own::FailureKind;
use fga_sim::stress::{Found, PARAMETERS, Stress, StressFailure, show};
use serde_json::{Value, json};

use crate::named_rows::{Row, csv, objects, rounded};
use crate::provenance::TARGET;
use crate::replay_page;

/// What was written.
#[derive(Debug)]
pub struct Written {
    /// The result in words.
    pub words: String,
    /// The result as JSON.
    pub document: Value,
}

/// Writes `stress.html`, `failures.csv`, `stress.json` and a replay of each failure into a folder.
///
/// # Errors
/// A folder that cannot be written, or settings that the core refuses.
pub fn write(stress: &Stress, found: &Found, folder: &Path) -> Result<Written, CampaignError> {
    atomic::prepare_folder(folder)?;
    let replays = folder.join("replay");
    for (number, failure) in (1..).zip(&found.failures) {
        atomic::prepare_folder(&replays)?;
        let log = show(stress, &failure.motion).map_err(CampaignError::Other)?;
        atomic::write(
            &replays.join(format!("{number}.html")),
            replay_page::page([&log]),
        )?;
    }
    let rows: Vec<Row<&str>> = (1..)
        .zip(&found.failures)
        .map(|(number, failure)| row(number, failure))
        .collect();
    atomic::write(&folder.join("failures.csv"), csv(&rows))?;
    let document = document(stress, found, rows);
    atomic::write(&folder.join("stress.json"), format!("{document:#}\n"))?;
    atomic::write(&folder.join("stress.html"), page(stress, found))?;
    let mut words = result(stress, found);
    for failure in &found.failures {
        let _ = writeln!(words, "- {}", in_words(failure));
    }
    let _ = writeln!(words, "page in {}", folder.join("stress.html").display());
    Ok(Written { words, document })
}

fn row<'a>(number: usize, failure: &StressFailure) -> Row<&'a str> {
    let mut row: Row<&str> = vec![
        ("failure", json!(number)),
        ("deviations", json!(rounded(failure.distance))),
        ("relative_density", json!(failure.relative_density())),
        ("margin_m", json!(rounded(failure.margin_m))),
        ("avoidable", json!(failure.avoidable)),
        (
            "policy_failure",
            json!(failure.policy_failure.map(FailureKind::name)),
        ),
    ];
    let values = PARAMETERS.iter().zip(failure.motion.values);
    row.extend(values.map(|(parameter, value)| (parameter.name, json!(rounded(value)))));
    row
}

fn document(stress: &Stress, found: &Found, rows: Vec<Row<&str>>) -> Value {
    let stamp = Stamp::of_this_build(TARGET);
    // Flights that all keep out give no estimate.
    let estimate = (found.entered > 0).then_some(found.probability);
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "commit": stamp.commit,
        "target": stamp.target,
        "policy": stress.policy.name(),
        "vehicle": stress.model.name,
        "seed": stress.seed,
        "flights": found.flights,
        "too_near": found.too_near,
        "entered": found.entered,
        "first": found.first,
        "probability": estimate.map(|(probability, _)| probability),
        "probability_standard_error": estimate.map(|(_, error)| error),
        "simplifying_flights": found.simplifying,
        "failures": objects(rows),
    })
}

/// What the search found, in sentences that end with a line break.
fn result(stress: &Stress, found: &Found) -> String {
    let mut text = format!(
        "policy {}, vehicle {}, seed {}: {}, {} with the protected volume entered{}\n",
        stress.policy.name(),
        stress.model.name,
        stress.seed,
        counted(found.flights as u64, "flight"),
        found.entered,
        found.first.map_or_else(String::new, |first| format!(
            ", the first of them flight {first}"
        ))
    );
    if found.failures.is_empty() {
        let _ = writeln!(
            text,
            "no failure was found; that is no proof that there is none, and no estimate of a probability"
        );
    } else {
        let (probability, error) = found.probability;
        let _ = writeln!(
            text,
            "probability of entering it under the usual motions: {probability:.2e}, standard error {error:.1e}"
        );
        let _ = writeln!(
            text,
            "the likeliest failures, simplified with {}:",
            counted(found.simplifying as u64, "more flight")
        );
    }
    text
}

fn in_words(failure: &StressFailure) -> String {
    format!(
        "{:.2} standard deviations from the most usual motion, entered by {:.1} m, {}: {}",
        failure.distance,
        -failure.margin_m,
        if failure.avoidable {
            "avoidable"
        } else {
            "not avoidable even with the whole motion known"
        },
        failure.motion.in_words()
    )
}

fn page(stress: &Stress, found: &Found) -> String {
    let stamp = Stamp::of_this_build(TARGET);
    let mut report = Report::new(&format!("Stress test of {}", stress.policy.name()));
    report.summary = "The likeliest motions of one intruder, and losses of its reports, in which the policy enters the protected volume, found by the cross-entropy method."
        .into();
    report.facts = vec![
        ("version".into(), env!("CARGO_PKG_VERSION").into()),
        ("commit".into(), stamp.commit),
        ("target".into(), stamp.target),
        ("vehicle".into(), stress.model.name.clone()),
        ("seed".into(), stress.seed.to_string()),
    ];
    let failures = (1..).zip(&found.failures).map(|(number, failure)| {
        let needed = failure
            .needed
            .iter()
            .filter_map(|place| PARAMETERS.get(*place));
        vec![
            Cell::Link {
                text: number.to_string(),
                href: format!("replay/{number}.html"),
            },
            Cell::Number(failure.distance, 2),
            Cell::Number(failure.margin_m, 1),
            Cell::Text(if failure.avoidable { "yes" } else { "no" }.into()),
            Cell::Text(failure.policy_failure.map_or("", FailureKind::name).into()),
            Cell::Text(failure.motion.in_words()),
            Cell::Text(
                needed
                    .map(|parameter| parameter.name)
                    .collect::<Vec<_>>()
                    .join(", "),
            ),
        ]
    });
    let parameters = PARAMETERS.iter().map(|parameter| {
        vec![
            Cell::Text(parameter.name.into()),
            Cell::Text(parameter.usually.into()),
        ]
    });
    report.sections = vec![
        Section {
            title: "The likeliest failures".into(),
            blocks: vec![
                Block::Paragraph(result(stress, found)),
                Block::Table(Table {
                    caption: "Each leads to its replay. Deviations: distance from the most usual motion, in standard deviations; the less, the likelier. \
                         Avoidable: the oracle, which knows the whole motion, finds a manoeuvre that keeps out. Needed: the parameters that are not at \
                         their medians; without any one of them the policy keeps out."
                        .into(),
                    columns: vec![
                        Column::text("failure"),
                        Column::number("deviations"),
                        Column::number("margin (m)"),
                        Column::text("avoidable"),
                        Column::text("policy failed"),
                        Column::text("the intruder"),
                        Column::text("needed"),
                    ],
                    rows: failures.collect(),
                }),
            ],
        },
        Section {
            title: "What is searched".into(),
            blocks: vec![
                Block::Paragraph(format!(
                    "The ownship flies straight on its mission and hears the intruder once a second, without noise. The intruder keeps to bounds that the policy knows: turns of \
                     {:.0} °/s and {:.0}°, {:.1} m/s of climb. {} motions began within three radii of the ownship and count as no failure. Gusts are not searched.",
                    stress.bounds.turn_rate_radps.to_degrees(),
                    stress.bounds.turn_rad.to_degrees(),
                    stress.bounds.climb_change_mps,
                    found.too_near
                )),
                Block::Table(Table {
                    caption: "The parameters and their usual distributions: assumptions, not measurements.".into(),
                    columns: vec![Column::text("parameter"), Column::text("usually")],
                    rows: parameters.collect(),
                }),
            ],
        },
    ];
    report.to_html()
}
