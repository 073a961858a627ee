//! Cells and tables that the safety case and the league share.

use super::{Lost, PolicyCase, WorstCase};
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

/// Losses as flown, of the losses without avoidance.
pub(crate) fn left(lost: &Lost) -> Cell {
    Cell::text(format!("{} of {}", lost.flown, lost.nominal))
}

/// Encounters in which a policy acted without need, of the encounters that are well clear without avoidance.
pub(crate) fn needless_of_clear(policy: &PolicyCase) -> Cell {
    Cell::text(format!("{} of {}", policy.needless, policy.clear))
}

/// Names and values.
pub(crate) fn facts<'a>(rows: impl Iterator<Item = &'a (String, String)>) -> Table {
    Table::of(
        rows,
        "",
        [
            (Column::text("what"), |(name, _)| Cell::text(name)),
            (Column::text("value"), |(_, value)| Cell::text(value)),
        ],
    )
}

fn separation(pair: Option<(f64, f64)>) -> Cell {
    pair.map_or(Cell::Empty, |(horizontal_m, vertical_m)| {
        Cell::text(format!("{horizontal_m:.0}, {vertical_m:.0}"))
    })
}

/// The worst encounters, each with a link to its replay.
pub(crate) fn worst(cases: &[WorstCase], caption: &str) -> Table {
    let link = |worst: &WorstCase| Cell::Link {
        text: worst.encounter.clone(),
        href: worst.href.clone(),
    };
    Table::of(
        cases,
        caption,
        [
            (Column::text("encounter"), link),
            (Column::text("policy"), |it| Cell::text(&it.policy)),
            (Column::text("what"), |it| Cell::text(&it.what)),
            (Column::number("without"), |it| {
                separation(it.separation_m[0])
            }),
            (Column::number("as flown"), |it| {
                separation(it.separation_m[1])
            }),
        ],
    )
}
