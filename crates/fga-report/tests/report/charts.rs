//! Charts and a report to draw, with plausible numbers of campaigns.

use fga_report::interval::Estimate;
use fga_report::plot::{
    Axis, BarChart, BarSeries, BoxChart, BoxSpread, Cdf, Claim, Histogram, LineChart, LinePoint,
    PlotLine, SampleSeries, SpreadRow,
};
use fga_report::report::{Cell, Column, Reading, ReportPage, Section, SectionBlock, Table};

const POLICIES: [&str; 7] = [
    "oracle",
    "turn-aware",
    "published t0",
    "published tc",
    "ORCA",
    "modified voltage potential",
    "potential field",
];

/// A success share that falls with difficulty, worse for later policies.
fn share(policy: usize, difficulty: f64) -> Estimate {
    let skill = 9.0 - 1.3 * policy as f64;
    let share = 1.0 / (1.0 + libm::exp(difficulty * 6.0 - skill));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "0 to 300"
    )]
    let successes = (share * 300.0) as u64;
    Estimate::wilson(successes, 300).expect("300 trials")
}

/// A deterministic sample around `middle` with a long upper tail.
fn sample(seed: u32, count: usize, middle: f64) -> Vec<f64> {
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1_u32 << 24)
    };
    (0..count)
        .map(|_| {
            let normal: f64 = (0..12).map(|_| random()).sum::<f64>() - 6.0;
            middle * libm::exp(0.35 * normal)
        })
        .collect()
}

fn success_against_distance() -> LineChart {
    LineChart {
        title: "Two obstacles at 15 to 30 m/s: separated against first-seen distance".into(),
        x: Axis::linear("first-seen distance (m)"),
        y: Axis::percent("separated (%)"),
        lines: POLICIES
            .iter()
            .enumerate()
            .map(|(policy, name)| PlotLine {
                name: (*name).into(),
                points: (1..=9)
                    .map(|i| {
                        let x = 50.0 * f64::from(i) + 50.0;
                        LinePoint {
                            x,
                            y: share(policy, 1.7 - x / 300.0),
                        }
                    })
                    .collect(),
            })
            .collect(),
        claims: vec![Claim {
            label: "paper: about 95 %".into(),
            from: 300.0,
            to: 400.0,
            y: 0.95,
        }],
    }
}

fn bars() -> BarChart {
    let groups = ["0", "0–15", "15–30", "30–45", "45–60"];
    BarChart {
        title: "Separated by obstacle speed, three obstacles first seen at 300 m".into(),
        groups_label: "obstacle speed (m/s)".into(),
        groups: groups.iter().map(|g| (*g).to_owned()).collect(),
        y: Axis::percent("separated (%)"),
        series: POLICIES
            .iter()
            .enumerate()
            .map(|(policy, name)| BarSeries {
                name: (*name).into(),
                values: (0..groups.len())
                    .map(|g| (g + policy != 9).then(|| share(policy, 0.4 + 0.2 * g as f64)))
                    .collect(),
            })
            .collect(),
    }
}

fn margins(count: usize) -> Vec<SampleSeries> {
    (0..3)
        .map(|policy| SampleSeries {
            name: POLICIES[policy + 1].into(),
            values: sample(
                7 + u32::try_from(policy).expect("small"),
                count,
                40.0 - 5.0 * policy as f64,
            ),
        })
        .collect()
}

fn decision_times() -> BoxChart {
    let middles = [4.1, 1.3, 1.2, 8.0, 0.9, 0.4];
    let rows = POLICIES[1..]
        .iter()
        .zip(middles)
        .enumerate()
        .map(|(i, (name, middle))| SpreadRow {
            name: (*name).into(),
            spread: BoxSpread::of(&mut sample(u32::try_from(i).expect("small"), 2000, middle))
                .expect("not empty"),
        })
        .collect();
    BoxChart {
        title: "Decision times, 1 to 3 threats".into(),
        x: Axis::log("time of one decision (µs)"),
        rows,
        limits: vec![(28_000.0, "paper: 28 ms".into())],
    }
}

pub(crate) fn all() -> Vec<(&'static str, String)> {
    let limits = vec![(30.0, "protected radius".to_owned())];
    vec![
        ("lines", success_against_distance().to_svg()),
        ("bars", bars().to_svg()),
        (
            "cdf",
            Cdf {
                title: "Least separation".into(),
                x: Axis {
                    range: Some((0.0, 100.0)),
                    ..Axis::linear("least separation (m)")
                },
                series: margins(20_000),
                limits: limits.clone(),
            }
            .to_svg(),
        ),
        (
            "histogram",
            Histogram {
                title: "Least separation".into(),
                x: Axis {
                    range: Some((0.0, 100.0)),
                    ..Axis::linear("least separation (m)")
                },
                bins: 40,
                series: margins(2000),
                limits,
            }
            .to_svg(),
        ),
        ("times", decision_times().to_svg()),
        (
            "scaling",
            LineChart {
                title: "Threat detection".into(),
                x: Axis::log("obstacles"),
                y: Axis::log("time (µs)"),
                lines: vec![PlotLine {
                    name: "detection".into(),
                    points: [1.0, 3.0, 10.0, 100.0, 1000.0, 10_000.0]
                        .iter()
                        .map(|n| LinePoint {
                            x: *n,
                            y: Estimate::exact(0.008 * n),
                        })
                        .collect(),
                }],
                claims: Vec::new(),
            }
            .to_svg(),
        ),
        (
            "nothing",
            LineChart {
                title: "An empty campaign".into(),
                x: Axis::log("obstacles"),
                y: Axis::linear("time (µs)"),
                lines: Vec::new(),
                claims: Vec::new(),
            }
            .to_svg(),
        ),
    ]
}

pub(crate) fn report() -> ReportPage {
    let charts = all();
    let figure = |name: &str| {
        SectionBlock::Figure {
        svg: charts
            .iter()
            .find(|c| c.0 == name)
            .map(|c| c.1.clone())
            .unwrap_or_default(),
        caption: "Shares of 300 encounters with 95 % Wilson intervals; the dashed bar is what the paper states.".into(),
    }
    };
    ReportPage {
        title: "The paper's evaluation, run again".into(),
        summary: "Every table and figure of the paper: what it states, what the published algorithm gives and what is possible.".into(),
        facts: vec![
            ("version".into(), "0.1.0".into()),
            ("seed".into(), "1".into()),
            ("configuration".into(), "5b6e0c8d <&> \"x\"".into()),
        ],
        sections: vec![
            Section {
                title: "Success against initial distance (Fig. 12)".into(),
                blocks: vec![
                    SectionBlock::Paragraph("Two obstacles on a threatening course at first sight.".into()),
                    figure("lines"),
                    SectionBlock::Table(Table {
                        caption: "Separated encounters.".into(),
                        columns: vec![
                            Column::text("policy"),
                            Column::number("separated (%)"),
                            Column::number("median decision (µs)"),
                        ],
                        rows: (0..7)
                            .map(|policy| {
                                vec![
                                    Cell::Text(POLICIES[policy].into()),
                                    Cell::Share(share(policy, 0.8)),
                                    if policy == 0 { Cell::Empty } else { Cell::Number(1.5 * policy as f64, 2) },
                                ]
                            })
                            .collect(),
                    }),
                    SectionBlock::Reading(Reading {
                        paper: "about 95 % for two obstacles no faster than 15 m/s".into(),
                        published: "44 % started at the critical time, 100 % at first sight".into(),
                        turn_aware: "100 %".into(),
                        oracle: "100 %".into(),
                        reading: "The claim holds for a start at first sight, not for one at the printed critical time.".into(),
                    }),
                    SectionBlock::Files(vec![("data/fig12.csv".into(), "the numbers".into())]),
                ],
            },
            Section {
                title: "Decision times (Table 6)".into(),
                blocks: vec![figure("times"), figure("bars")],
            },
        ],
    }
}
