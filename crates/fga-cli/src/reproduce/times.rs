//! Tables 5 and 6: computing time of a case, all methods in one run.

use core::fmt::Write as _;

use fga_formats::atomic;
use fga_report::report::{Block, Cell, Column, Reading, Section, Table};

use super::flights::fly;
use super::{Setting, next};
use crate::failure::Failure;

/// Every method; the first shows the cost of plant and measuring alone.
const METHODS: [&str; 10] = [
    "none",
    "published --start tc",
    "published --start t0",
    "turn-aware",
    "potential-field",
    "waypoint-greedy",
    "waypoint-optimal",
    "orca",
    "mvp",
    "velocity-obstacles",
];

/// Seconds a case that the paper states: for FGA on static and moving obstacles, and in Table 6.
fn stated(method: &str) -> [Option<f64>; 2] {
    match method {
        "published --start tc" => [Some(0.028), Some(0.030)],
        "potential-field" => [Some(0.082); 2],
        "waypoint-greedy" => [Some(0.18); 2],
        "waypoint-optimal" => [Some(0.3); 2],
        _ => [None; 2],
    }
}

fn cells(speed: &str) -> Vec<String> {
    (1..=3)
        .map(|count| format!("threats:{count}:300:{speed}"))
        .collect()
}

/// Times and shares of all methods.
pub(super) fn section(setting: &Setting<'_>) -> Result<Section, Failure> {
    let title = "Tables 5 and 6: computing time of a case";
    next(title)?;
    let still = fly(setting, &cells("0"), &METHODS, true)?;
    let moving = fly(setting, &cells("0-60"), &METHODS, true)?;
    let milliseconds = |seconds: Option<&f64>| seconds.map_or(f64::NAN, |s| s * 1000.0);
    let mut csv = String::from("method,static_ms,moving_ms\n");
    let mut rows = Vec::new();
    for (index, method) in METHODS.iter().enumerate() {
        let (still_ms, moving_ms) = (
            milliseconds(still.mean_s.get(index)),
            milliseconds(moving.mean_s.get(index)),
        );
        let _ = writeln!(csv, "{method},{still_ms:.6},{moving_ms:.6}");
        let saved = |flights: &super::flights::Flights| {
            let totals = flights
                .summary
                .policies()
                .nth(index)
                .map(|(_, totals)| totals);
            totals
                .and_then(|t| {
                    fga_report::interval::Estimate::wilson(t.saved_of_avoidable, t.avoidable)
                })
                .map_or(Cell::Empty, Cell::Share)
        };
        let [stated_still, stated_moving] =
            stated(method).map(|s| s.map_or(Cell::Empty, |s| Cell::Number(s * 1000.0, 0)));
        rows.push(vec![
            Cell::Text((*method).into()),
            stated_still,
            Cell::Number(still_ms, 3),
            stated_moving,
            Cell::Number(moving_ms, 3),
            saved(&still),
            saved(&moving),
        ]);
    }
    atomic::write(&setting.data.join("tables-5-6.csv"), csv)?;
    let at = |method: &str| METHODS.iter().position(|m| *m == method).unwrap_or(0);
    let ms = |method: &str| {
        format!(
            "{:.3} ms static, {:.3} ms moving",
            milliseconds(still.mean_s.get(at(method))),
            milliseconds(moving.mean_s.get(at(method)))
        )
    };
    let published = moving
        .mean_s
        .get(at("published --start tc"))
        .copied()
        .unwrap_or(f64::NAN);
    let ratio =
        |method: &str| moving.mean_s.get(at(method)).copied().unwrap_or(f64::NAN) / published;
    Ok(Section {
        title: title.into(),
        blocks: vec![
            Block::Table(Table {
                caption: "Mean wall-clock time of a whole closed-loop flight (one to three threats \
                     first seen at 300 m; moving: 0 to 60 m/s), plant and measuring included, all methods \
                     on identical encounters; and the share saved of what the oracle can save."
                    .into(),
                columns: vec![
                    Column::text("method"),
                    Column::number("paper, static (ms)"),
                    Column::number("static (ms)"),
                    Column::number("paper, moving (ms)"),
                    Column::number("moving (ms)"),
                    Column::number("saved, static (%)"),
                    Column::number("saved, moving (%)"),
                ],
                rows,
            }),
            Block::Reading(Reading {
                paper: "0.028 s a static and 0.030 s a moving case; 0.082 s for a potential field, 0.18 s and 0.30 s for two waypoint planners (Matlab, machine not stated).".into(),
                published: ms("published --start tc"),
                turn_aware: ms("turn-aware"),
                oracle: "Not timed: it is a yardstick, not for flight.".into(),
                reading: format!(
                    "Relative to the published algorithm, a moving case takes {:.2} times as long with \
                     the potential field (paper: 2.73), {:.2} and {:.2} times with the two waypoint \
                     planners (6.0 and 10.0), {:.2} times with turn-aware; wall-clock times depend on \
                     the machine and its load, and the planners are this project's reading of one \
                     sentence.",
                    ratio("potential-field"),
                    ratio("waypoint-greedy"),
                    ratio("waypoint-optimal"),
                    ratio("turn-aware")
                ),
            }),
            Block::Files(vec![("data/tables-5-6.csv".into(), "the times".into())]),
        ],
    })
}
