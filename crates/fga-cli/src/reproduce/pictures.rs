//! Figs. 16 and 17, and the San Francisco case of Figs. 25 and 26.

use std::path::Path;

use fga_formats::atomic;
use fga_report::report::{Block, Cell, Column, Reading, Section, Table};
use fga_sim::campaign::parse_policy;
use fga_sim::run::{RunLog, fly};
use fga_sim::scenario;
use fga_sim::toml_input::TomlText;
use fga_sim::vehicle_file::VehicleModel;

use super::{Setting, next};
use crate::failure::Failure;
use crate::replay_page;
use crate::run_files::overview;

const RASCAL: &str = include_str!("../../../../vehicles/rascal-110.toml");

struct Case {
    title: &'static str,
    name: &'static str,
    scenario: &'static str,
    rascal: bool,
    policies: &'static [&'static str],
    paper: &'static str,
}

const CASES: [Case; 3] = [
    Case {
        title: "Fig. 16: a static obstacle in three dimensions",
        name: "fig-16",
        scenario: include_str!("../../../../scenarios/fig-16.toml"),
        rascal: false,
        policies: &["published --start t0", "published --start tc", "turn-aware"],
        paper: "The aircraft avoids a single obstacle with minimal deviation, started at t_0 and at t_c.",
    },
    Case {
        title: "Fig. 17: moving obstacles in three dimensions",
        name: "fig-17",
        scenario: include_str!("../../../../scenarios/fig-17.toml"),
        rascal: false,
        policies: &["published --start t0", "published --start tc", "turn-aware"],
        paper: "The aircraft avoids several obstacles and returns to its path, started at t_0 and at t_c.",
    },
    Case {
        title: "Figs. 25 and 26: San Francisco airport",
        name: "sfo",
        scenario: include_str!("../../../../scenarios/sfo.toml"),
        rascal: true,
        policies: &["circle", "turn-aware"],
        paper: "The aircraft flies round a protected radius of 150 m over the runway on every crossing.",
    },
];

/// One section for each case.
pub(super) fn sections(
    setting: &Setting<'_>,
    paper: &VehicleModel,
) -> Result<Vec<Section>, Failure> {
    CASES
        .iter()
        .map(|case| section(case, setting, paper))
        .collect()
}

fn section(case: &Case, setting: &Setting<'_>, paper: &VehicleModel) -> Result<Section, Failure> {
    next(case.title)?;
    let mut blocks = Vec::new();
    let mut rows = Vec::new();
    let mut flown = Vec::new();
    for name in case.policies {
        let log = fly_case(case, name, paper)?;
        let outcome = &log.outcome;
        rows.push(vec![
            Cell::Text((*name).to_owned()),
            Cell::Number(outcome.min_margin_m, 2),
            Cell::Number(outcome.max_cross_track_m, 1),
            Cell::Number(outcome.extra_path_m, 1),
            outcome.start_s.map_or(Cell::Empty, |s| Cell::Number(s, 1)),
            outcome
                .rejoined_s
                .map_or(Cell::Empty, |s| Cell::Number(s, 1)),
        ]);
        let svg = overview(&log).to_svg();
        let file = format!("{}-{}.svg", case.name, name.replace(" --start ", "-"));
        atomic::write(&setting.data.join(&file), &svg)?;
        blocks.push(Block::Figure {
            svg,
            caption: format!("{name} (data/{file})."),
        });
        flown.push((*name, log));
    }
    blocks.insert(
        0,
        Block::Table(Table {
            caption: "What came of it.".into(),
            columns: vec![
                Column::text("policy"),
                Column::number("least margin (m)"),
                Column::number("largest distance from the route (m)"),
                Column::number("extra path (m)"),
                Column::number("began (s)"),
                Column::number("rejoined (s)"),
            ],
            rows,
        }),
    );
    let file = format!("{}-replay.html", case.name);
    let page = replay_page::page(flown.iter().map(|(_, log)| log));
    atomic::write(&setting.data.join(&file), page)?;
    blocks.push(Block::Files(vec![(
        format!("data/{file}"),
        "the flights one over the other, to look at in a browser".into(),
    )]));
    blocks.push(Block::Reading(reading(case, &flown)));
    Ok(Section {
        title: case.title.into(),
        blocks,
    })
}

fn fly_case(case: &Case, policy: &str, paper: &VehicleModel) -> Result<RunLog, Failure> {
    let vehicle = if case.rascal {
        VehicleModel::parse(TomlText::new(Path::new("vehicles/rascal-110.toml"), RASCAL))?
    } else {
        paper.clone()
    };
    let path = format!("scenarios/{}.toml", case.name);
    let plan = scenario::parse(
        TomlText::new(Path::new(&path), case.scenario),
        Some(vehicle),
    )?;
    let policy = parse_policy(policy).map_err(Failure::Input)?;
    Ok(fly(plan, &policy, &mut |_| ())?)
}

fn reading(case: &Case, flown: &[(&str, RunLog)]) -> Reading {
    let words = |(name, log): &(&str, RunLog)| {
        format!(
            "{name}: {}, least margin {:.2} m, extra path {:.1} m",
            if log.outcome.separated() {
                "separated"
            } else {
                "entered the volume"
            },
            log.outcome.min_margin_m,
            log.outcome.extra_path_m
        )
    };
    let of = |own: bool| {
        let told: Vec<String> = flown
            .iter()
            .filter(|(name, _)| (*name == "turn-aware") == own)
            .map(words)
            .collect();
        told.join("; ") + "."
    };
    let separated = flown
        .iter()
        .filter(|(_, log)| log.outcome.separated())
        .count();
    let shortest = flown
        .iter()
        .filter(|(_, log)| log.outcome.separated())
        .min_by(|a, b| {
            a.1.outcome
                .extra_path_m
                .total_cmp(&b.1.outcome.extra_path_m)
        });
    Reading {
        paper: case.paper.into(),
        published: of(false),
        turn_aware: of(true),
        oracle: "Not asked: one flight, not a share.".into(),
        reading: format!(
            "{separated} of {} stay outside the protected volumes{}; the paper's own positions are not \
             given, so the pictures compare in kind only.",
            flown.len(),
            shortest.map_or_else(String::new, |(name, _)| format!(
                ", {name} with the least extra path"
            ))
        ),
    }
}
