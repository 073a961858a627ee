//! Figs. 12 to 15: success against initial distance, speed and number of obstacles.

use core::fmt::Write as _;

use fga_campaign::campaign::Row;
use fga_formats::atomic;
use fga_report::interval::Estimate;
use fga_report::plot::{Axis, Claim, LineChart, LinePoint, PlotLine};
use fga_report::report::{Cell, Column, Reading, Section, SectionBlock, Table};

use crate::ReproduceError;
use crate::Setting;
use crate::flights::{Flights, fly};

/// The policies in their order.
const POLICIES: [&str; 3] = ["published --start tc", "published --start t0", "turn-aware"];

/// The drawn series: the policies and the oracle.
const NAMES: [&str; 4] = ["published, t_c", "published, t_0", "turn-aware", "oracle"];

/// Index of the turn-aware policy and of the oracle.
const TURN_AWARE: usize = 2;
const ORACLE: usize = 3;

/// The variable of a curve.
struct Curve {
    title: String,
    x_label: &'static str,
    /// Position on the x axis, name in the table, cell.
    points: Vec<(f64, String, String)>,
    claims: Vec<Claim>,
}

/// A figure of the paper.
struct Figure {
    title: &'static str,
    file: &'static str,
    paper: &'static str,
    curves: Vec<Curve>,
}

fn value(flights: &Flights, series: usize, cell: usize) -> Option<Estimate> {
    if series == ORACLE {
        flights.avoidable(cell)
    } else {
        flights.separated(series, cell)
    }
}

/// A cell whose threats are first seen at `seen` and fly at `speed`.
fn cell(count: u32, seen: &str, speed: &str) -> String {
    format!("threats:{count}:{seen}:{speed}")
}

fn over_distance(count: u32, speed: &str, claims: Vec<Claim>, title: String) -> Curve {
    Curve {
        title,
        x_label: "initial distance (m)",
        points: [60, 80, 100, 150, 200, 300, 400]
            .map(|d| {
                (
                    f64::from(d),
                    format!("{d} m"),
                    cell(count, &d.to_string(), speed),
                )
            })
            .into(),
        claims,
    }
}

fn over_speed(count: u32, claims: Vec<Claim>) -> Curve {
    Curve {
        title: format!("{count} moving, first seen at 300 m"),
        x_label: "obstacle speed (m/s)",
        points: [
            ("0-15", 7.5),
            ("15-30", 22.5),
            ("30-45", 37.5),
            ("45-60", 52.5),
        ]
        .map(|(speed, x)| (x, format!("{speed} m/s"), cell(count, "300", speed)))
        .into(),
        claims,
    }
}

fn claim(label: &str, (from, to): (f64, f64), y: f64) -> Claim {
    Claim {
        label: label.into(),
        from,
        to,
        y,
    }
}

fn figures() -> [Figure; 3] {
    let static_curves =
        (1..=3).map(|count| over_distance(count, "0", Vec::new(), format!("{count} static")));
    let slow = vec![claim("paper: about 95 %", (300.0, 400.0), 0.95)];
    let two = vec![
        claim("paper: near 90 %", (0.0, 30.0), 0.9),
        claim("paper: about 60 %", (45.0, 60.0), 0.6),
    ];
    [
        Figure {
            title: "Fig. 12: static obstacles, by initial distance",
            file: "fig-12",
            paper: "Success falls as the initial distance falls and as the number of obstacles rises (no number in the text).",
            curves: static_curves.collect(),
        },
        Figure {
            title: "Fig. 13: two moving obstacles, by initial distance",
            file: "fig-13",
            paper: "95 % where the obstacles are no faster than the aircraft (15 m/s), first seen at 300 to 400 m.",
            curves: vec![
                over_distance(2, "0-15", slow, "two moving, 0-15 m/s".into()),
                over_distance(2, "15-30", Vec::new(), "two moving, 15-30 m/s".into()),
                over_distance(2, "45-60", Vec::new(), "two moving, 45-60 m/s".into()),
            ],
        },
        Figure {
            title: "Figs. 14 and 15: moving obstacles, by speed and number",
            file: "fig-14-15",
            paper: "First seen at 300 m: near 90 % for two obstacles averaging under 30 m/s, about 60 % at 45 to 60 m/s; failure follows speed and number.",
            curves: vec![
                over_speed(1, Vec::new()),
                over_speed(2, two),
                over_speed(3, Vec::new()),
            ],
        },
    ]
}

/// The sections of the four figures.
pub(crate) fn sections(setting: &Setting<'_>) -> Result<Vec<Section>, ReproduceError> {
    figures()
        .iter()
        .map(|figure| section(figure, setting))
        .collect()
}

fn section(figure: &Figure, setting: &Setting<'_>) -> Result<Section, ReproduceError> {
    setting.begin(figure.title)?;
    let mut blocks = Vec::new();
    let mut csv = String::from("curve,x,cell,series,share,low,high\n");
    let mut everything = Comparison::default();
    let mut rows = Vec::new();
    for curve in &figure.curves {
        let cells: Vec<String> = curve
            .points
            .iter()
            .map(|(_, _, cell)| cell.clone())
            .collect();
        let flights = fly(setting, &cells, &POLICIES)?;
        everything.take(&flights);
        everything.take_claims(curve, &flights);
        for (index, (x, name, cell)) in curve.points.iter().enumerate() {
            let mut row = vec![Cell::Text(curve.title.clone()), Cell::Text(name.clone())];
            for (series, label) in NAMES.iter().enumerate() {
                let estimate = value(&flights, series, index);
                row.push(estimate.map_or(Cell::Empty, Cell::Share));
                if let Some(e) = estimate {
                    let _ = writeln!(
                        csv,
                        "\"{}\",{x},{cell},\"{label}\",{:.6},{:.6},{:.6}",
                        curve.title, e.value, e.low, e.high
                    );
                }
            }
            rows.push(row);
        }
        blocks.push(SectionBlock::Figure {
            svg: chart(curve, &flights).to_svg(),
            caption: format!(
                "{}: share kept separated, with 95 % intervals.",
                curve.title
            ),
        });
    }
    let columns = ["curve", "at"].map(Column::text).into_iter();
    blocks.push(SectionBlock::Table(Table {
        caption: "Kept separated (%), with 95 % intervals.".into(),
        columns: columns.chain(NAMES.map(Column::number)).collect(),
        rows,
    }));
    blocks.push(SectionBlock::Reading(everything.reading(figure.paper)));
    let file = format!("{}.csv", figure.file);
    atomic::write(&setting.data().join(&file), csv)?;
    blocks.push(SectionBlock::Files(vec![(
        format!("data/{file}"),
        "every point".into(),
    )]));
    Ok(Section {
        title: figure.title.into(),
        blocks,
    })
}

fn chart(curve: &Curve, flights: &Flights) -> LineChart {
    LineChart {
        title: curve.title.clone(),
        x: Axis::linear(curve.x_label),
        y: Axis::percent("kept separated (%)"),
        lines: NAMES
            .iter()
            .enumerate()
            .map(|(series, name)| PlotLine {
                name: (*name).to_owned(),
                points: curve
                    .points
                    .iter()
                    .enumerate()
                    .filter_map(|(index, (x, _, _))| {
                        Some(LinePoint {
                            x: *x,
                            y: value(flights, series, index)?,
                        })
                    })
                    .collect(),
            })
            .collect(),
        claims: curve.claims.clone(),
    }
}

/// The result over all cells of a figure.
#[derive(Default)]
struct Comparison {
    cells: usize,
    /// Cells in which the oracle's share lies within the turn-aware interval.
    within: Vec<bool>,
    separated: [u64; 3],
    encounters: u64,
    avoidable: u64,
    saved: [u64; 3],
    /// Encounters in which turn-aware keeps more than the oracle found, by more than its resolution.
    beyond: u64,
    worst: Option<(f64, String)>,
    /// The claims of the paper, and whether turn-aware is at least as good at each.
    claims: Vec<(String, bool)>,
}

/// The oracle's resolution, metres.
const FINENESS_M: f64 = 0.05;

impl Comparison {
    fn take(&mut self, flights: &Flights) {
        for (index, cell) in flights.cells().iter().enumerate() {
            let (Some(own), Some(best)) = (
                value(flights, TURN_AWARE, index),
                value(flights, ORACLE, index),
            ) else {
                continue;
            };
            self.cells += 1;
            self.within.push((own.low..=own.high).contains(&best.value));
            let gap = best.value - own.value;
            if self.worst.as_ref().is_none_or(|(worst, _)| gap > *worst) {
                self.worst = Some((gap, cell.clone()));
            }
            for policy in 0..POLICIES.len() {
                if let Some(totals) = flights.totals(policy, index) {
                    self.separated[policy] += totals.separated;
                    self.saved[policy] += totals.saved_of_avoidable;
                    if policy == TURN_AWARE {
                        self.encounters += totals.encounters;
                        self.avoidable += totals.avoidable;
                    }
                }
            }
        }
    }

    fn take_claims(&mut self, curve: &Curve, flights: &Flights) {
        for claim in &curve.claims {
            let met = curve
                .points
                .iter()
                .enumerate()
                .filter(|(_, (x, _, _))| (claim.from..=claim.to).contains(x))
                .filter_map(|(index, _)| value(flights, TURN_AWARE, index))
                .all(|share| share.value >= claim.y);
            let label = claim.label.trim_start_matches("paper: ").to_owned();
            self.claims.push((label, met));
        }
        let beyond = |rows: &&Vec<Row>| {
            rows.get(TURN_AWARE).is_some_and(|row| {
                row.separated
                    && row.avoidable() == Some(false)
                    && row
                        .oracle_margin_m
                        .is_some_and(|oracle_m| row.min_margin_m > oracle_m + FINENESS_M)
            })
        };
        self.beyond += flights.rows.iter().filter(beyond).count() as u64;
    }

    fn share(&self, count: u64) -> String {
        let of = self.encounters.max(1);
        format!(
            "{:.1} % of all {of} encounters",
            100.0 * count as f64 / of as f64
        )
    }

    fn reading(&self, paper: &str) -> Reading {
        let within = self.within.iter().filter(|within| **within).count();
        let saved =
            |policy: usize| 100.0 * self.saved[policy] as f64 / self.avoidable.max(1) as f64;
        let behind = self.worst.as_ref().filter(|(gap, _)| *gap > 0.0);
        let worst = behind.map_or_else(String::new, |(gap, cell)| {
            format!(
                "; the largest gap to the oracle is {:.1} points, in {cell}",
                100.0 * gap
            )
        });
        let beyond = if self.beyond > 0 {
            format!(
                " In {} encounters it keeps a larger margin than the oracle found, so the oracle's \
                 search is not exhaustive there.",
                self.beyond
            )
        } else {
            String::new()
        };
        let mut claims = String::new();
        for (label, met) in &self.claims {
            let verdict = if *met { "reaches" } else { "does not reach" };
            let _ = write!(claims, " It {verdict} the paper's \"{label}\".");
        }
        Reading {
            paper: paper.into(),
            published: format!(
                "Started at t_c: {}; started at t_0: {}.",
                self.share(self.separated[0]),
                self.share(self.separated[1])
            ),
            turn_aware: format!("{}.", self.share(self.separated[TURN_AWARE])),
            oracle: format!("{}.", self.share(self.avoidable)),
            reading: format!(
                "Of what can be saved, the published algorithm saves {:.1} % at t_c and {:.1} % at \
                 t_0, turn-aware {:.1} %; turn-aware is level with the oracle, within its interval, \
                 in {within} of {} points{worst}.{claims}{beyond}",
                saved(0),
                saved(1),
                saved(TURN_AWARE),
                self.cells
            ),
        }
    }
}
