//! Cells and tables that the safety case and the league share.

use super::{Lost, WorstCase};
use crate::report::{Cell, Column, Table};

pub(crate) fn ratio(lost: &Lost) -> Cell {
    lost.ratio
        .map_or(Cell::Empty, |ratio| Cell::Estimate(ratio, 3))
}

pub(crate) fn count(count: u64) -> Cell {
    Cell::Number(count as f64, 0)
}

pub(crate) fn number(value: Option<f64>, decimals: usize) -> Cell {
    value.map_or(Cell::Empty, |value| Cell::Number(value, decimals))
}

/// Names and values.
pub(crate) fn facts<'a>(rows: impl Iterator<Item = &'a (String, String)>) -> Table {
    let cells = rows.map(|(name, value)| vec![Cell::Text(name.clone()), Cell::Text(value.clone())]);
    Table {
        caption: String::new(),
        columns: vec![Column::text("what"), Column::text("value")],
        rows: cells.collect(),
    }
}

/// The worst encounters, each with a link to its replay.
pub(crate) fn worst(cases: &[WorstCase], caption: &str) -> Table {
    let separation = |pair: Option<(f64, f64)>| {
        pair.map_or(Cell::Empty, |(horizontal_m, vertical_m)| {
            Cell::Text(format!("{horizontal_m:.0}, {vertical_m:.0}"))
        })
    };
    let rows = cases.iter().map(|worst| {
        vec![
            Cell::Link {
                text: worst.encounter.clone(),
                href: worst.href.clone(),
            },
            Cell::Text(worst.policy.clone()),
            Cell::Text(worst.what.clone()),
            separation(worst.separation_m[0]),
            separation(worst.separation_m[1]),
        ]
    });
    Table {
        caption: caption.into(),
        columns: vec![
            Column::text("encounter"),
            Column::text("policy"),
            Column::text("what"),
            Column::number("without"),
            Column::number("as flown"),
        ],
        rows: rows.collect(),
    }
}
