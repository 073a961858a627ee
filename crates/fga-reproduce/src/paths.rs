//! §3.4.3, Fig. 9: is the path shorter when the manoeuvre starts at `t_c` and not at `t_0`?

use core::fmt::Write as _;

use fga_campaign::campaign::Row;
use fga_formats::atomic;
use fga_report::interval::Estimate;
use fga_report::plot::{Axis, LineChart, LinePoint, PlotLine};
use fga_report::report::{Cell, Column, Reading, Section, SectionBlock, Table};

use crate::ReproduceError;
use crate::Setting;
use crate::flights::{Flights, PLANAR, fly};

/// Early and late starts.
const POLICIES: [&str; 4] = [
    "published --start t0",
    "published --start tc",
    "turn-aware --start t0",
    "turn-aware --start latest",
];

const NAMES: [&str; 4] = [
    "published, t_0",
    "published, t_c",
    "turn-aware, at once",
    "turn-aware, latest",
];

/// Initial distances of the flights, metres.
const SEEN_M: [u32; 6] = [100, 150, 200, 300, 400, 500];

/// Protected radius of the sweep, metres.
const RADIUS_M: f64 = 30.0;

/// Turn radii of the sweep over protected radius: `k_1`.
const TURN_RATIOS: [f64; 3] = [0.5, 1.0, 2.0];

/// The two paths of Fig. 9 past a static obstacle dead ahead, from U to D beside it.
#[expect(
    clippy::struct_field_names,
    reason = "the unit, as everywhere in this project"
)]
struct ComparedPaths {
    /// From Q, where the late turn begins, to D: `L_1`, metres.
    late_m: f64,
    /// The straight way from U to Q, metres.
    approach_m: f64,
    /// From U to D with the turn at once: `L_3`, metres.
    early_m: f64,
}

impl ComparedPaths {
    /// `None` where the turn cannot begin late enough for a comparison: nearer than the critical
    /// distance of `t_L`.
    fn of(distance_m: f64, turn_m: f64) -> Option<Self> {
        let sum_m = turn_m + RADIUS_M;
        // The turn's circle touches the protected one: its centre is ρ beside the course.
        let tangent_m = libm::sqrt(sum_m * sum_m - turn_m * turn_m);
        let approach_m = distance_m - tangent_m;
        // Turn, straight along the inner tangent of both circles, round the obstacle to D.
        let centres_m = libm::hypot(distance_m, turn_m);
        let heading_rad = libm::asin(sum_m / centres_m) - libm::atan2(turn_m, distance_m);
        let straight_m = libm::sqrt(centres_m * centres_m - sum_m * sum_m);
        (approach_m >= 0.0).then(|| Self {
            late_m: sum_m * libm::acos(turn_m / sum_m),
            approach_m,
            early_m: sum_m * heading_rad + straight_m,
        })
    }
}

/// The section.
pub(crate) fn section(setting: &Setting<'_>) -> Result<Section, ReproduceError> {
    let title = "L_1 < L_3 (§3.4.3, Fig. 9): starting at t_c or at t_0";
    setting.begin(title)?;
    let mut blocks = vec![SectionBlock::Paragraph(
        "By geometry: one static obstacle dead ahead, protected radius 30 m, turn radius k_1 times \
         as large. L_1 is counted from Q, where the late turn begins, L_3 from U, where the \
         obstacle is seen; with the straight way from U to Q added both begin in the same place."
            .into(),
    )];
    blocks.extend(geometry_charts());
    let cells: Vec<String> = SEEN_M
        .iter()
        .map(|seen| format!("threats:1:{seen}:0{PLANAR}"))
        .collect();
    let flights = fly(setting, &cells, &POLICIES)?;
    let flown: Vec<[CellPaths; 2]> = (0..SEEN_M.len())
        .map(|cell| MEASURES.map(|measure| CellPaths::of(&flights, cell, &measure)))
        .collect();
    blocks.push(SectionBlock::Paragraph(
        "Flown: one static obstacle drawn anywhere across the course, in the plane; the encounters \
         in which all four flights stayed separated and came back to the line."
            .into(),
    ));
    for (index, measure) in MEASURES.iter().enumerate() {
        blocks.push(SectionBlock::Figure {
            svg: flown_chart(&flown, index).to_svg(),
            caption: format!("Mean {} with 95 % intervals.", measure.label),
        });
    }
    blocks.push(SectionBlock::Table(table(&flown)));
    atomic::write(&setting.data().join("paths.csv"), csv(&flown))?;
    blocks.push(SectionBlock::Reading(reading(&flown)));
    blocks.push(SectionBlock::Files(vec![(
        "data/paths.csv".into(),
        "every mean".into(),
    )]));
    Ok(Section {
        title: title.into(),
        blocks,
    })
}

/// Distances of the geometric sweep, metres.
fn sweep() -> impl Iterator<Item = f64> {
    (6..=60).map(|tens| f64::from(tens) * 10.0)
}

fn geometry_charts() -> [SectionBlock; 2] {
    let chart = |title: &str, y: &str, value: fn(&ComparedPaths) -> f64| LineChart {
        title: title.into(),
        x: Axis::linear("initial distance (m)"),
        y: Axis::linear(y),
        lines: TURN_RATIOS
            .iter()
            .map(|ratio| PlotLine {
                name: format!("k_1 = {ratio}"),
                points: sweep()
                    .filter_map(|x| {
                        let compared = ComparedPaths::of(x, ratio * RADIUS_M)?;
                        Some(LinePoint {
                            x,
                            y: Estimate::exact(value(&compared)),
                        })
                    })
                    .collect(),
            })
            .collect(),
        claims: Vec::new(),
    };
    [
        SectionBlock::Figure {
            svg: chart(
                "Away from the heading: L_3 less L_1",
                "start at t_0 longer by (m)",
                |c| c.early_m - c.late_m,
            )
            .to_svg(),
            caption:
                "As the paper counts: above 0 the late start is away from the heading for less."
                    .into(),
        },
        SectionBlock::Figure {
            svg: chart(
                "Whole path from U to D: L_3 less (U to Q and L_1)",
                "start at t_0 longer by (m)",
                |c| c.early_m - c.late_m - c.approach_m,
            )
            .to_svg(),
            caption: "Both counted from U: below 0 the late start is the longer path.".into(),
        },
    ]
}

/// A measure of the cost of a manoeuvre.
struct PathMeasure {
    label: &'static str,
    decimals: usize,
    value: fn(&Row) -> Option<f64>,
}

const MEASURES: [PathMeasure; 2] = [
    PathMeasure {
        label: "time away (s)",
        decimals: 2,
        value: Row::time_away_s,
    },
    PathMeasure {
        label: "extra path (m)",
        decimals: 2,
        value: |row| Some(row.extra_path_m),
    },
];

/// One measure in one cell.
struct CellPaths {
    encounters: usize,
    /// Mean of each policy.
    means: [Option<Estimate>; POLICIES.len()],
    /// Mean of early less late, of each of the two kinds of policy.
    differences: [Option<Estimate>; 2],
}

impl CellPaths {
    fn of(flights: &Flights, cell: usize, measure: &PathMeasure) -> Self {
        let rows: Vec<&Vec<Row>> = flights
            .rows
            .iter()
            .filter(|rows| rows.first().is_some_and(|row| row.source as usize == cell))
            .filter(|rows| {
                rows.iter().all(|row| {
                    row.separated && row.rejoined_s.is_some() && (measure.value)(row).is_some()
                })
            })
            .collect();
        let value = |rows: &Vec<Row>, policy: usize| {
            rows.get(policy).and_then(measure.value).unwrap_or(f64::NAN)
        };
        let mean = |of: &dyn Fn(&Vec<Row>) -> f64| {
            let values: Vec<f64> = rows.iter().map(|rows| of(rows)).collect();
            Estimate::mean(&values)
        };
        Self {
            encounters: rows.len(),
            means: core::array::from_fn(|policy| mean(&|rows| value(rows, policy))),
            differences: core::array::from_fn(|kind| {
                mean(&|rows| value(rows, 2 * kind) - value(rows, 2 * kind + 1))
            }),
        }
    }
}

fn flown_chart(flown: &[[CellPaths; 2]], measure: usize) -> LineChart {
    let label = MEASURES[measure].label;
    LineChart {
        title: format!("One static obstacle: {label}"),
        x: Axis::linear("initial distance (m)"),
        y: Axis::linear(label),
        lines: NAMES
            .iter()
            .enumerate()
            .map(|(policy, name)| PlotLine {
                name: (*name).to_owned(),
                points: SEEN_M
                    .iter()
                    .zip(flown)
                    .filter_map(|(seen, cell)| {
                        Some(LinePoint {
                            x: f64::from(*seen),
                            y: cell[measure].means[policy]?,
                        })
                    })
                    .collect(),
            })
            .collect(),
        claims: Vec::new(),
    }
}

fn table(flown: &[[CellPaths; 2]]) -> Table {
    let mut columns = vec![
        Column::text("first seen at"),
        Column::text("mean"),
        Column::number("encounters"),
    ];
    columns.extend(NAMES.map(Column::number));
    columns
        .extend(["published: early less late", "turn-aware: early less late"].map(Column::number));
    let mut rows = Vec::new();
    for (seen, cell) in SEEN_M.iter().zip(flown) {
        for (measure, flown) in MEASURES.iter().zip(cell) {
            let mut row = vec![
                Cell::Text(format!("{seen} m")),
                Cell::Text(measure.label.into()),
                Cell::Number(flown.encounters as f64, 0),
            ];
            for value in flown.means.iter().chain(&flown.differences) {
                row.push(value.map_or(Cell::Empty, |e| Cell::Estimate(e, measure.decimals)));
            }
            rows.push(row);
        }
    }
    Table {
        caption: "Means with 95 % intervals, on identical encounters.".into(),
        columns,
        rows,
    }
}

fn csv(flown: &[[CellPaths; 2]]) -> String {
    let mut csv = String::from("first_seen_m,measure,series,encounters,mean,low,high\n");
    for (seen, cell) in SEEN_M.iter().zip(flown) {
        for (measure, flown) in MEASURES.iter().zip(cell) {
            for (name, mean) in NAMES.iter().zip(&flown.means) {
                if let Some(e) = mean {
                    let _ = writeln!(
                        csv,
                        "{seen},{},\"{name}\",{},{:.6},{:.6},{:.6}",
                        measure.label, flown.encounters, e.value, e.low, e.high
                    );
                }
            }
        }
    }
    csv
}

fn reading(flown: &[[CellPaths; 2]]) -> Reading {
    // Cells in which the early start costs more, or less, by more than the interval.
    let dearer = |measure: usize, kind: usize| {
        let all = || {
            flown
                .iter()
                .filter_map(|cell| cell[measure].differences[kind])
        };
        format!(
            "larger at t_0 in {}, smaller in {} of {} cells",
            all().filter(|e| e.low > 0.0).count(),
            all().filter(|e| e.high < 0.0).count(),
            all().count()
        )
    };
    let both = |kind: usize| {
        format!(
            "Beyond the interval the time away is {}; the extra path is {}.",
            dearer(0, kind),
            dearer(1, kind)
        )
    };
    let swept = || {
        TURN_RATIOS
            .iter()
            .flat_map(|ratio| sweep().filter_map(move |x| ComparedPaths::of(x, ratio * RADIUS_M)))
    };
    let of = swept().count();
    let away = swept().filter(|c| c.late_m < c.early_m).count();
    let whole = swept()
        .filter(|c| c.late_m + c.approach_m < c.early_m)
        .count();
    let example = ComparedPaths::of(300.0, 30.0).map_or_else(String::new, |c| {
        format!(
            " (head-on from 300 m with Table 4: {:.1} against {:.1} m)",
            c.approach_m + c.late_m,
            c.early_m
        )
    });
    Reading {
        paper: "L_1 < L_3: a manoeuvre started at t_c leaves the heading for a shorter time than one started at t_0; so FGA has the shorter path.".into(),
        published: both(0),
        turn_aware: both(1),
        oracle: "Not asked: it looks for a margin, not a length.".into(),
        reading: format!(
            "By geometry the claim holds for the time away from the heading in {away} of {of} points of \
             the sweep, and for the whole path in {whole} of them{example}: waiting keeps the heading \
             longer and does not shorten the way."
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_paths_by_hand() {
        // ρ = d = 30, seen at 300 m: the late turn begins √(60² − 30²) = 51.96 m before the centre
        // and turns by 60°; the early one leads along a tangent of 295.47 m at 5.77°.
        let compared = ComparedPaths::of(300.0, 30.0).unwrap();
        assert!((compared.late_m - 60.0 * core::f64::consts::FRAC_PI_3).abs() < 1e-9);
        assert!((compared.approach_m - 248.038_475_8).abs() < 1e-6);
        assert!((compared.early_m - 301.51).abs() < 0.02);
        assert!(ComparedPaths::of(50.0, 30.0).is_none());
    }
}
