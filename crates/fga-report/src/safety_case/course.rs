//! How the encounters went: what the system does without need, when it warns and acts, how the ratios converge, where the losses
//! lie, and the worst encounters.

use core::fmt::Write as _;

use super::cells::{self, count, left, needless_of_clear, number, ratio};
use super::{LOWC_THRESHOLDS, Lost, NMAC_THRESHOLDS, PolicyCase, SafetyCase, Threshold, quantile};
use crate::plot::{Axis, Cdf, Claim, LineChart, LinePoint, PlotLine, SampleSeries};
use crate::report::{Cell, Column, Section, SectionBlock, Table};

impl SafetyCase {
    pub(super) fn effects(&self) -> Section {
        let table = Table::of(
            &self.policies,
            "Needless: acted though the encounter stays well clear (ASTM F3442) without it. \
             Restless: the track turned from away to back, or the reverse, more than three times. \
             Not back: acted and was not back on its mission when the flight ended. \
             Departures and times are those of encounters in which it acted.",
            [
                (Column::text("policy"), |it| Cell::text(&it.policy)),
                (Column::number("acted"), |it| count(it.acted)),
                (Column::number("needless of clear"), needless_of_clear),
                (Column::number("restless"), |it| count(it.restless)),
                (Column::number("not back"), |it| count(it.not_back)),
                (Column::number("departure median (m)"), |it| {
                    number(quantile(&it.departures_m, 0.5), 0)
                }),
                (Column::number("90 % (m)"), |it| {
                    number(quantile(&it.departures_m, 0.9), 0)
                }),
                (Column::number("off mission median (s)"), |it| {
                    number(quantile(&it.away_s, 0.5), 0)
                }),
            ],
        );
        Section::new(
            "4. Metrics: what it costs",
            vec![SectionBlock::Table(table)],
        )
    }

    pub(super) fn times(&self) -> Section {
        let spread = |name: &str, values: &[f64]| {
            vec![
                Cell::Text(name.into()),
                count(values.len() as u64),
                number(quantile(values, 0.1), 1),
                number(quantile(values, 0.5), 1),
                number(quantile(values, 0.9), 1),
            ]
        };
        let mut rows = vec![
            spread(
                "corrective alert, DO-365B en route",
                &self.corrective_leads_s,
            ),
            spread("warning alert, DO-365B en route", &self.warning_leads_s),
        ];
        for policy in &self.policies {
            let name = format!("first maneuver, {}", policy.policy);
            if !policy.action_leads_s.is_empty() {
                rows.push(spread(&name, &policy.action_leads_s));
            }
        }
        Section {
            title: "4. Metrics: when it warns, acts and gives way".into(),
            blocks: vec![self.gave_way(), SectionBlock::Table(Table {
                caption: "Seconds before the closest approach without avoidance: what 10, 50 and 90 % of the encounters have less of. \
                    Encounters that lose well clear (ASTM F3442) without avoidance."
                    .into(),
                columns: vec![
                    Column::text("what"),
                    Column::number("encounters"),
                    Column::number("10 %"),
                    Column::number("median"),
                    Column::number("90 %"),
                ],
                rows,
            })],
        }
    }

    /// In how many encounters the aircraft gave way, and how long before.
    pub(super) fn gave_way(&self) -> SectionBlock {
        let kept = |it: &PolicyCase| {
            let kept = (it.lowc.nominal + it.lowc.induced).saturating_sub(it.lowc.flown);
            Cell::text(format!("{kept} of {}", it.lowc.nominal))
        };
        SectionBlock::Table(Table::of(
            self.acting(),
            "Giving way, as the proposed 14 CFR Part 108 (2025) asks of unmanned aircraft: encounters that lose well clear (ASTM F3442) without avoidance in \
             which the aircraft kept well clear of every other one, and seconds from its first maneuver to the closest approach without avoidance: least, \
             10 % and median.",
            [
                (Column::text("policy"), |it| Cell::text(&it.policy)),
                (Column::number("gave way"), kept),
                (Column::number("least (s)"), |it| {
                    number(quantile(&it.action_leads_s, 0.0), 1)
                }),
                (Column::number("10 %"), |it| {
                    number(quantile(&it.action_leads_s, 0.1), 1)
                }),
                (Column::number("median"), |it| {
                    number(quantile(&it.action_leads_s, 0.5), 1)
                }),
            ],
        ))
    }

    pub(super) fn curves(&self) -> Section {
        let converging = |title: &str, thresholds: &[Threshold], of: fn(&PolicyCase) -> &Lost| {
            let lines: Vec<PlotLine> = self
                .acting()
                .map(|policy| PlotLine {
                    name: policy.policy.clone(),
                    points: of(policy)
                        .convergence
                        .iter()
                        .map(|(encounters, estimate)| LinePoint {
                            x: *encounters as f64,
                            y: *estimate,
                        })
                        .collect(),
                })
                .collect();
            let first = lines.iter().filter_map(|line| line.points.first());
            let from = first.map(|point| point.x).fold(f64::INFINITY, f64::min);
            let chart = LineChart {
                title: title.into(),
                x: Axis::log("encounters"),
                y: Axis::linear("risk ratio"),
                claims: thresholds
                    .iter()
                    .filter(|_| from.is_finite())
                    .map(|threshold| Claim {
                        label: format!("{} {:.2}", threshold.intruders, threshold.ratio),
                        from,
                        to: self.encounters as f64,
                        y: threshold.ratio,
                    })
                    .collect(),
                lines,
            };
            chart.to_svg()
        };
        let series = |name: &str, values: &[f64]| SampleSeries {
            name: name.into(),
            values: values.to_vec(),
        };
        let mut separations = vec![series("without avoidance", &self.nominal_horizontal_m)];
        let acting = self.acting();
        separations.extend(acting.map(|policy| series(&policy.policy, &policy.horizontal_m)));
        let separations = Cdf {
            title: "Least horizontal separation".into(),
            x: Axis::linear("least horizontal separation (m)"),
            series: separations,
            limits: vec![(152.4, "500 ft".into()), (609.6, "2,000 ft".into())],
        };
        Section {
            title: "6. Convergence and separations".into(),
            blocks: vec![
                SectionBlock::Figure {
                    svg: converging("NMAC risk ratio", &NMAC_THRESHOLDS, |policy| &policy.nmac),
                    caption: self.width_words("NMAC", |policy| &policy.nmac),
                },
                SectionBlock::Figure {
                    svg: converging("LoWC risk ratio", &LOWC_THRESHOLDS, |policy| &policy.lowc),
                    caption: self.width_words("LoWC", |policy| &policy.lowc),
                },
                SectionBlock::Figure {
                    svg: separations.to_svg(),
                    caption: "Cumulative share of encounters, each counted once. Altitude is not in this picture: \
                        a small horizontal separation is no loss where the vertical one is kept."
                        .into(),
                },
            ],
        }
    }

    /// Whether the intervals are narrow enough, in words.
    fn width_words(&self, loss: &str, of: fn(&PolicyCase) -> &Lost) -> String {
        let mut text =
            format!("Ratio of {loss} after growing numbers of encounters, with its 95 % interval.");
        for policy in self.acting() {
            if let Some(ratio) = of(policy).ratio {
                let half = 0.5 * (ratio.high - ratio.low);
                let enough = if half <= 0.05 {
                    "narrow enough (0.05)"
                } else {
                    "more encounters are needed for 0.05"
                };
                let _ = write!(text, " {}: half width {half:.3}, {enough}.", policy.policy);
            }
        }
        text
    }

    pub(super) fn by_class(&self) -> Section {
        let table = Table::of(
            &self.classes,
            "Head-on: directions at least 150° apart; overtaking: at most 30°. Speeds are those of the intruder over the ground \
             at the closest approach without avoidance.",
            [
                (Column::text("policy"), |it| Cell::text(&it.policy)),
                (Column::text("class"), |it| Cell::text(&it.class)),
                (Column::number("encounters"), |it| count(it.encounters)),
                (Column::number("NMAC with, of without"), |it| left(&it.nmac)),
                (Column::number("ratio"), |it| ratio(&it.nmac)),
                (Column::number("LoWC with, of without"), |it| left(&it.lowc)),
                (Column::number("ratio"), |it| ratio(&it.lowc)),
            ],
        );
        Section::new(
            "4. Metrics: by class of encounter",
            vec![SectionBlock::Table(table)],
        )
    }

    pub(super) fn worst(&self) -> Section {
        let caption = "Each leads to its replay. Separations: least horizontal, and vertical at that time, m.";
        let table = cells::worst(&self.worst, caption);
        Section::new("5. The worst encounters", vec![SectionBlock::Table(table)])
    }
}
