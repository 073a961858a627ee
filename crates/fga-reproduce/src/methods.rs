//! Every method on identical encounters: the paper's, its baselines, the peers.

use core::fmt::Write as _;

use fga_campaign::campaign::Totals;
use fga_formats::atomic;
use fga_report::interval::Estimate;
use fga_report::plot::{Axis, BarChart, BarSeries};
use fga_report::report::{Cell, Column, Reading, Section, SectionBlock, Table};

use crate::ReproduceError;
use crate::flights::{Flights, METHODS, PLANAR, fly, method};
use crate::{Setting, shorter, times};

/// The methods except the first, with their names in a chart.
const SHORT: [&str; METHODS.len() - 1] = [
    "publ. t_c",
    "publ. t_0",
    "turn-aw.",
    "pot. field",
    "greedy",
    "optimal",
    "orca",
    "mvp",
    "vel. obst.",
];

/// Speeds of §2.3 and obstacles at rest, metres per second.
const SPEEDS: [&str; 5] = ["0", "15-20", "35-40", "55-60", "0-60"];

/// Tables 5 and 6, the "67 % shorter" claim, and all methods side by side.
pub(crate) fn sections(setting: &Setting<'_>) -> Result<Vec<Section>, ReproduceError> {
    setting.begin("Tables 5 and 6: computing time of a case")?;
    let table_5 = |speed: &str| -> Vec<String> {
        (1..=3)
            .map(|count| format!("threats:{count}:300:{speed}"))
            .collect()
    };
    let still = fly(setting, &table_5("0"), &METHODS)?;
    let moving = fly(setting, &table_5("0-60"), &METHODS)?;
    let grid = |speeds: &[&str], ending: &str| -> Vec<String> {
        let cells = |speed: &&str| {
            let speed = (*speed).to_owned();
            let ending = ending.to_owned();
            (1..=3).map(move |count| format!("threats:{count}:100-500:{speed}{ending}"))
        };
        speeds.iter().flat_map(cells).collect()
    };
    setting.begin("Section 2.3: every method on identical encounters")?;
    let space = fly(setting, &grid(&SPEEDS, ""), &METHODS)?;
    let plane = fly(setting, &grid(&SPEEDS, PLANAR), &METHODS)?;
    let among = fly(setting, &grid(&["0", "0-60"], ",bystanders"), &METHODS)?;
    Ok(vec![
        times::section(setting, &still, &moving)?,
        shorter::section(setting, &still, &moving)?,
        side_by_side(
            setting,
            &[
                ("in space, seen at 300 m", &[&still, &moving]),
                ("in space, 100–500 m", &[&space]),
                ("in the plane, 100–500 m", &[&plane]),
                ("among 10–20 objects", &[&among]),
            ],
        )?,
    ])
}

/// Share saved of the encounters that the oracle saves.
fn saved(totals: &Totals) -> Option<Estimate> {
    Estimate::wilson(totals.saved_of_avoidable, totals.avoidable)
}

/// A group of cells with a name for the chart.
type Group<'a> = (&'a str, &'a [&'a Flights]);

fn side_by_side(setting: &Setting<'_>, groups: &[Group<'_>]) -> Result<Section, ReproduceError> {
    let flights = || {
        groups
            .iter()
            .flat_map(|(_, flights)| flights.iter().copied())
    };
    let cells = || {
        flights().flat_map(|flights| (0..flights.cells().len()).map(move |cell| (flights, cell)))
    };
    let mut csv = String::from("cell,method,encounters,avoidable,saved_of_avoidable,separated\n");
    let mut rows = Vec::new();
    let mut standing = MethodStanding::default();
    for (flights, cell) in cells() {
        let name = flights.cells().get(cell).map_or("", String::as_str);
        let mut row = vec![
            Cell::Text(name.into()),
            flights.avoidable(cell).map_or(Cell::Empty, Cell::Share),
        ];
        for (index, method) in METHODS.iter().enumerate().skip(1) {
            let totals = flights.totals(index, cell);
            row.push(totals.and_then(saved).map_or(Cell::Empty, Cell::Share));
            if let Some(t) = totals {
                let _ = writeln!(
                    csv,
                    "\"{name}\",{method},{},{},{},{}",
                    t.encounters, t.avoidable, t.saved_of_avoidable, t.separated
                );
            }
        }
        standing.take(flights, cell, name);
        rows.push(row);
    }
    atomic::write(&setting.data().join("methods.csv"), csv)?;
    let columns = [Column::text("cell"), Column::number("oracle: avoidable")];
    Ok(Section {
        title: "Section 2.3: every method on identical encounters".into(),
        blocks: vec![
            SectionBlock::Paragraph(
                "Threats first seen at 300 m and at 100 to 500 m all round, standing and in the speed \
                 ranges of section 2.3, in space, in the plane (where the aircraft is forbidden to climb), \
                 and among bystanders (10 to 20 objects in all). A cell is named threats:COUNT:FIRST \
                 SEEN:SPEED. All methods fly the same aircraft under the same limits; their settings were \
                 searched for these encounters."
                    .into(),
            ),
            SectionBlock::Figure {
                svg: chart(groups).to_svg(),
                caption: "Share saved of what the oracle saves, all cells of a kind together, with 95 % \
                     intervals."
                    .into(),
            },
            SectionBlock::Table(Table {
                caption: "Share saved of the encounters that the oracle saves (%), with 95 % intervals.".into(),
                columns: columns
                    .into_iter()
                    .chain(METHODS.iter().skip(1).map(|name| Column::number(name)))
                    .collect(),
                rows,
            }),
            SectionBlock::Reading(standing.reading()),
            SectionBlock::Files(vec![("data/methods.csv".into(), "every count".into())]),
        ],
    })
}

fn chart(groups: &[Group<'_>]) -> BarChart {
    let of_group = |flights: &[&Flights], method: usize| {
        let (mut saved, mut avoidable) = (0, 0);
        for flights in flights {
            for cell in 0..flights.cells().len() {
                if let Some(totals) = flights.totals(method, cell) {
                    saved += totals.saved_of_avoidable;
                    avoidable += totals.avoidable;
                }
            }
        }
        Estimate::wilson(saved, avoidable)
    };
    BarChart {
        title: "Share saved of the avoidable encounters".into(),
        groups_label: "method, as in the table".into(),
        groups: SHORT.map(str::to_owned).into(),
        y: Axis::percent("saved of the avoidable (%)"),
        series: groups
            .iter()
            .map(|(name, flights)| BarSeries {
                name: (*name).to_owned(),
                values: (1..METHODS.len())
                    .map(|method| of_group(flights, method))
                    .collect(),
            })
            .collect(),
    }
}

/// The rank of the turn-aware policy.
#[derive(Default)]
struct MethodStanding {
    cells: usize,
    encounters: u64,
    avoidable: u64,
    saved: [u64; METHODS.len()],
    /// Cells in which another method saves more, and by how many encounters.
    behind: Vec<String>,
}

impl MethodStanding {
    fn take(&mut self, flights: &Flights, cell: usize, name: &str) {
        let counts: Vec<u64> = (0..METHODS.len())
            .map(|method| {
                flights
                    .totals(method, cell)
                    .map_or(0, |totals| totals.saved_of_avoidable)
            })
            .collect();
        self.cells += 1;
        if let Some(totals) = flights.totals(0, cell) {
            self.encounters += totals.encounters;
            self.avoidable += totals.avoidable;
        }
        for (sum, count) in self.saved.iter_mut().zip(&counts) {
            *sum += count;
        }
        let own = counts[method("turn-aware")];
        let best = counts.iter().zip(METHODS).max_by_key(|(count, _)| **count);
        if let Some((count, best)) = best.filter(|(count, _)| **count > own) {
            self.behind
                .push(format!("{name} ({best} {count}, turn-aware {own})"));
        }
    }

    fn share(&self, name: &str) -> String {
        Estimate::wilson(self.saved[method(name)], self.avoidable).map_or_else(
            || "nothing to save".into(),
            |e| {
                format!(
                    "{:.1} % [{:.1}, {:.1}]",
                    100.0 * e.value,
                    100.0 * e.low,
                    100.0 * e.high
                )
            },
        )
    }

    fn reading(&self) -> Reading {
        let others: Vec<String> = METHODS
            .iter()
            .skip(4)
            .map(|name| format!("{name} {}", self.share(name)))
            .collect();
        let behind = if self.behind.is_empty() {
            "no other method saves more than turn-aware in any cell".into()
        } else {
            format!(
                "another method saves more than turn-aware in {} of {} cells: {}",
                self.behind.len(),
                self.cells,
                self.behind.join("; ")
            )
        };
        Reading {
            paper: "Compares computing times only; of success it says that FGA is \"much more efficient at avoiding multiple obstacles than previous methods\".".into(),
            published: format!(
                "Of what can be saved: {} at t_c, {} at t_0.",
                self.share("published --start tc"),
                self.share("published --start t0")
            ),
            turn_aware: format!("{}.", self.share("turn-aware")),
            oracle: format!(
                "{} of {} encounters can be saved.",
                self.avoidable, self.encounters
            ),
            reading: format!(
                "Over all {} cells {behind}; the others save {}.",
                self.cells,
                others.join(", ")
            ),
        }
    }
}
