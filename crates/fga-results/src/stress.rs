//! The results of a stress test: a page, a table of failures, their replays.

use core::fmt::Write as _;
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use fga_campaign::campaign::{CampaignError, CampaignStamp};
use fga_campaign::stress::{FoundEncounter, Stress, StressFailure, StressFlight, search, show};
use fga_formats::words::counted;
use fga_formats::{OutputError, atomic};
use fga_report::report::{Cell, Column, ReportPage, Section, SectionBlock, Table};
use fga_sim::own::FailureKind;
use serde_json::{Value, json};

use crate::named_rows::{NamedRow, csv, objects, rounded};
use crate::provenance::{TARGET, fingerprint};
use crate::replay_page;

/// The results of the flights of a search, for going on with it.
const FLIGHTS: &str = "flights.csv";

/// What was written.
#[derive(Debug)]
pub struct Written {
    /// The result in words.
    pub words: String,
    /// The result as JSON.
    pub document: Value,
}

/// Searches and writes into a folder; a search of the same test that was stopped there goes on, and `None` says that this one was
/// stopped. `show` gets the number of flights flown.
///
/// # Errors
/// As [`search`] and [`write()`].
pub fn run(
    stress: &Stress,
    folder: &Path,
    go_on: &(impl Fn() -> bool + Sync),
    show: &mut (dyn FnMut(usize) + Send),
) -> Result<Option<Written>, CampaignError> {
    atomic::prepare_folder(folder)?;
    let (mut kept, before) = KeptEncounter::open(stress, folder)?;
    let mut done = 0;
    let mut take = |flights: &[StressFlight]| {
        // What was there is there.
        let new = flights.get(before.len().saturating_sub(done)..);
        done += flights.len();
        show(done);
        kept.add(new.unwrap_or_default())
            .map_err(|error| error.to_string())
    };
    let found = search(stress, &before, go_on, &mut take).map_err(CampaignError::Other)?;
    found.map(|found| write(stress, &found, folder)).transpose()
}

/// The file of flights.
struct KeptEncounter {
    path: PathBuf,
    file: File,
}

impl KeptEncounter {
    /// Opens the file for a test; the flights of the same test in it, none of another one.
    fn open(stress: &Stress, folder: &Path) -> Result<(Self, Vec<StressFlight>), OutputError> {
        let path = folder.join(FLIGHTS);
        let head = format!("{}\nmargin_m,entry_s\n", key(stress));
        let there = std::fs::read_to_string(&path).unwrap_or_default();
        let rows = there.strip_prefix(&head).unwrap_or_default();
        // The last line may be torn.
        let flights: Vec<StressFlight> = rows
            .split_inclusive('\n')
            .map_while(|line| {
                let (margin, entry) = line.strip_suffix('\n')?.split_once(',')?;
                Some(StressFlight {
                    margin_m: margin.parse().ok()?,
                    entry_s: entry.parse().ok()?,
                })
            })
            .collect();
        let text: String = flights.iter().map(line).collect();
        atomic::write(&path, head + &text)?;
        let opened = File::options().append(true).open(&path);
        let file = opened.map_err(|error| OutputError::new(&path, error))?;
        Ok((Self { path, file }, flights))
    }

    fn add(&mut self, flights: &[StressFlight]) -> Result<(), OutputError> {
        let text: String = flights.iter().map(line).collect();
        self.file
            .write_all(text.as_bytes())
            .map_err(|error| OutputError::new(&self.path, error))
    }
}

fn line(flight: &StressFlight) -> String {
    format!("{},{}\n", flight.margin_m, flight.entry_s)
}

/// The fingerprint of a test: all that its flights depend on, but for their number.
fn key(stress: &Stress) -> String {
    let stamp = CampaignStamp::of_this_build(TARGET);
    let of = json!([
        env!("CARGO_PKG_VERSION"),
        stamp.commit,
        stamp.target,
        stress.model.sha256,
        stress.policy.name(),
        stress.policy.own().map(|own| own.sha256().to_owned()),
        stress.bounds.turn_rate_radps,
        stress.bounds.turn_rad,
        stress.bounds.climb_change_mps,
        stress.intruders,
        stress.gust_mps,
        stress.seed,
    ]);
    fingerprint(of.to_string().as_bytes())
}

/// Writes `stress.html`, `failures.csv`, `stress.json` and a replay of each failure into a folder.
///
/// # Errors
/// A folder that cannot be written, or settings that the core refuses.
pub fn write(
    stress: &Stress,
    found: &FoundEncounter,
    folder: &Path,
) -> Result<Written, CampaignError> {
    atomic::prepare_folder(folder)?;
    let replays = folder.join("replay");
    for (number, failure) in (1..).zip(&found.failures) {
        atomic::prepare_folder(&replays)?;
        let log = show(stress, &failure.case).map_err(CampaignError::Other)?;
        atomic::write(
            &replays.join(format!("{number}.html")),
            replay_page::page([&log]),
        )?;
    }
    let rows: Vec<NamedRow<String>> = (1..)
        .zip(&found.failures)
        .map(|(number, failure)| row(stress, number, failure))
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

fn row(stress: &Stress, number: usize, failure: &StressFailure) -> NamedRow<String> {
    let first: [(&str, Value); 6] = [
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
    let first = first.into_iter().map(|(name, value)| (name.into(), value));
    let values = stress.parameters().into_iter().zip(failure.case.values());
    first
        .chain(values.map(|((name, _), value)| (name, json!(rounded(value)))))
        .collect()
}

fn document(stress: &Stress, found: &FoundEncounter, rows: Vec<NamedRow<String>>) -> Value {
    let stamp = CampaignStamp::of_this_build(TARGET);
    // Flights that all keep out give no estimate.
    let estimate = (found.entered > 0).then_some(found.probability);
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "commit": stamp.commit,
        "target": stamp.target,
        "policy": stress.policy.name(),
        "vehicle": stress.model.name,
        "seed": stress.seed,
        "intruders": stress.intruders,
        "gust_mps": stress.gust_mps,
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
fn result(stress: &Stress, found: &FoundEncounter) -> String {
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
            "probability of entering it under the usual distributions: {probability:.2e}, standard error {error:.1e}"
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
        "{:.2} standard deviations from the most usual flight, entered by {:.1} m, {}: {}",
        failure.distance,
        -failure.margin_m,
        if failure.avoidable {
            "avoidable"
        } else {
            "not avoidable even with all motions known"
        },
        failure.case.in_words()
    )
}

fn page(stress: &Stress, found: &FoundEncounter) -> String {
    let stamp = CampaignStamp::of_this_build(TARGET);
    let mut report = ReportPage::new(&format!("Stress test of {}", stress.policy.name()));
    report.summary = "The likeliest motions of intruders, losses of their reports, and gusts, in which the policy enters a protected volume, found by the cross-entropy method."
        .into();
    report.facts = vec![
        ("version".into(), env!("CARGO_PKG_VERSION").into()),
        ("commit".into(), stamp.commit),
        ("target".into(), stamp.target),
        ("vehicle".into(), stress.model.name.clone()),
        ("seed".into(), stress.seed.to_string()),
    ];
    let parameters = stress.parameters();
    let failures = (1..).zip(&found.failures).map(|(number, failure)| {
        let needed = failure.needed.iter();
        let needed = needed.filter_map(|place| Some(parameters.get(*place)?.0.as_str()));
        vec![
            Cell::Link {
                text: number.to_string(),
                href: format!("replay/{number}.html"),
            },
            Cell::Number(failure.distance, 2),
            Cell::Number(failure.margin_m, 1),
            Cell::Text(if failure.avoidable { "yes" } else { "no" }.into()),
            Cell::Text(failure.policy_failure.map_or("", FailureKind::name).into()),
            Cell::Text(failure.case.in_words()),
            Cell::Text(needed.collect::<Vec<_>>().join(", ")),
        ]
    });
    let gusts = if stress.gust_mps > 0.0 {
        format!(
            "One gust changes the wind for some time: {} m/s of standard deviation in each component, at most twice that. The policy \
             knows only what it does to the aircraft, and the oracle flies without it.",
            stress.gust_mps
        )
    } else {
        "There are no gusts: the vehicle file knows no drift_mps, and none was given.".into()
    };
    report.sections = vec![
        Section::new(
            "The likeliest failures",
            vec![
                SectionBlock::Paragraph(result(stress, found)),
                SectionBlock::Table(Table {
                    caption: "Each leads to its replay. Deviations: distance from the most usual flight, in standard deviations; the less, the likelier. \
                         Avoidable: the oracle, which knows all motions, finds a manoeuvre that keeps out. Needed: the parameters that are not at \
                         their medians; without any one of them the policy keeps out."
                        .into(),
                    columns: vec![
                        Column::text("failure"),
                        Column::number("deviations"),
                        Column::number("margin (m)"),
                        Column::text("avoidable"),
                        Column::text("policy failed"),
                        Column::text("what happens"),
                        Column::text("needed"),
                    ],
                    rows: failures.collect(),
                }),
            ],
        ),
        Section::new(
            "What is searched",
            vec![
                SectionBlock::Paragraph(format!(
                    "The ownship flies straight on its mission and hears each intruder once a second, without noise. Intruders: {}. Each keeps to bounds that the policy knows: turns of \
                     {:.0} °/s and {:.0}°, {:.1} m/s of climb. {} flights begin within three radii of the ownship and count as no failure. {gusts}",
                    stress.intruders,
                    stress.bounds.turn_rate_radps.to_degrees(),
                    stress.bounds.turn_rad.to_degrees(),
                    stress.bounds.climb_change_mps,
                    found.too_near
                )),
                SectionBlock::Table(Table::of(
                    &parameters,
                    "The parameters and their usual distributions: assumptions, not measurements.",
                    [
                        (Column::text("parameter"), |(name, _)| Cell::text(name)),
                        (Column::text("usually"), |(_, usually)| Cell::text(*usually)),
                    ],
                )),
            ],
        ),
    ];
    report.to_html()
}
