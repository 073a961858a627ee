//! The safety case of a campaign: one page with the tables that a regulator asks for.
//!
//! It says how often a near mid-air collision or a loss of well clear happens with and without the
//! system, against quoted thresholds; what the system does without need; when it warns and acts; how
//! the ratios converge; the worst encounters; the assumptions.

mod cases;
pub(crate) mod cells;
mod course;
mod trace;
mod verdict;

use crate::report::{Cell, Column, ReportPage, Section, SectionBlock, Table};

use cells::{count, facts, left, ratio};
use verdict::{judged, result, verdict, verdicts};

pub use cases::{
    Assumed, ClassCase, LOWC_THRESHOLDS, Lost, NMAC_THRESHOLDS, PolicyCase, Threshold, WorstCase,
};

/// The policy that stands for flights without the system.
const WITHOUT: &str = "none";

/// Everything on the page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SafetyCase {
    /// Name of the campaign.
    pub name: String,
    /// Origin of the results.
    pub facts: Vec<(String, String)>,
    /// Encounters.
    pub encounters: u64,
    /// Effective number of encounters.
    pub effective: f64,
    /// The policies.
    pub policies: Vec<PolicyCase>,
    /// Classes of encounters.
    pub classes: Vec<ClassCase>,
    /// Least horizontal separations without avoidance, metres.
    pub nominal_horizontal_m: Vec<f64>,
    /// Leads of the corrective alert in encounters that lose well clear (ASTM F3442) without avoidance, seconds.
    pub corrective_leads_s: Vec<f64>,
    /// Leads of the warning alert in the same encounters, seconds.
    pub warning_leads_s: Vec<f64>,
    /// The worst encounters.
    pub worst: Vec<WorstCase>,
    /// The assumptions.
    pub assumed: Assumed,
    /// Whether encounters come from models, from recordings, or both; the page says what they represent.
    pub stands_for: Vec<String>,
    /// Whether some of them stand for no airspace, so that no threshold can be judged: encounters that were flown on purpose.
    pub is_stress: bool,
    /// Traffic, aircraft in a cubic kilometre, and the encounters in a flight hour that follow from it.
    pub per_hour: Option<(f64, f64)>,
    /// Source of that traffic.
    pub traffic_source: Option<String>,
    /// How the intruders react, a sentence.
    pub reactions: String,
}

/// The value below which a share of some values lies.
fn quantile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "an index within the list"
    )]
    let index = libm::floor(share * last as f64) as usize;
    sorted.get(index).copied()
}

impl SafetyCase {
    /// The policies that act.
    fn acting(&self) -> impl Iterator<Item = &PolicyCase> {
        let policies = self.policies.iter();
        policies.filter(|policy| policy.policy != WITHOUT)
    }

    /// The page as one HTML file.
    pub fn to_html(&self) -> String {
        let mut report = ReportPage::new(&format!("Safety case: {}", self.name));
        report.summary = "How often there is a near mid-air collision (NMAC) or a loss of well clear (LoWC) with the system, \
             over how often without it, in the same encounters."
            .into();
        report.facts.clone_from(&self.facts);
        report.sections = vec![
            self.evidence(),
            self.conditions(),
            self.encounters(),
            self.table(),
            self.tail(),
            self.effects(),
            self.times(),
            self.by_class(),
            self.worst(),
            self.curves(),
            self.limitations(),
            trace::section(),
        ];
        report.to_html()
    }

    fn evidence(&self) -> Section {
        let system = self.acting().next();
        let is_stress = self.is_stress;
        let first = system.map(|system| result(system, is_stress));
        let mut blocks: Vec<SectionBlock> = first.into_iter().collect();
        blocks.push(SectionBlock::Paragraph(format!(
            "{} encounters (effective number {:.0}), each flown in closed loop by every policy in simulation.",
            self.encounters, self.effective
        )));
        blocks.extend(self.met_by_all().map(SectionBlock::Paragraph));
        Section::new("1. Result", blocks)
    }

    /// Aircraft and sensor.
    fn conditions(&self) -> Section {
        let Assumed {
            conditions,
            sensors,
            ..
        } = &self.assumed;
        let table = facts(conditions.iter().chain(sensors));
        Section::new("2. Conditions and sensor", vec![SectionBlock::Table(table)])
    }

    fn encounters(&self) -> Section {
        let about = self.stands_for.iter().cloned().map(SectionBlock::Paragraph);
        let table = SectionBlock::Table(facts(self.assumed.encounters.iter()));
        Section::new("3. Encounters", about.chain([table]).collect())
    }

    fn limitations(&self) -> Section {
        let text = format!(
            "This is no certification and no flight test. {} The numbers hold for the aircraft and the sensor of section 2 and the encounters of \
             section 3, in simulation. Fewer encounters than section 6 asks for leave intervals wide; a fault that no encounter showed is in no \
             number. The thresholds of section 4 are second-hand.",
            self.reactions
        );
        Section::new("7. Limitations", vec![SectionBlock::Paragraph(text)])
    }

    /// The thresholds that every one of several policies meets, in a sentence.
    fn met_by_all(&self) -> Option<String> {
        let policies: Vec<&PolicyCase> = self.acting().collect();
        let losses = [
            ("NMAC", &NMAC_THRESHOLDS[..]),
            ("LoWC", &LOWC_THRESHOLDS[..]),
        ];
        let mut met = Vec::new();
        for (place, (loss, thresholds)) in losses.into_iter().enumerate() {
            for threshold in thresholds {
                let meets = |policy: &&PolicyCase| {
                    let lost = [&policy.nmac, &policy.lowc][place];
                    lost.ratio
                        .is_some_and(|ratio| verdict(&ratio, threshold) == "met")
                };
                if policies.iter().all(meets) {
                    met.push(format!("{loss} ≤ {:.2}", threshold.ratio));
                }
            }
        }
        (policies.len() > 1 && !met.is_empty() && !self.is_stress).then(|| {
            format!(
                "All {} policies meet {}: these encounters are too easy to rank policies by it.",
                policies.len(),
                met.join(", ")
            )
        })
    }

    fn table(&self) -> Section {
        let against = |loss: &str, thresholds: &[Threshold], of: fn(&PolicyCase) -> &Lost| {
            let mut columns = vec![
                Column::text("policy"),
                Column::number(&format!("{loss} with the system, of without")),
                Column::number("risk ratio"),
            ];
            columns.extend(thresholds.iter().map(|threshold| {
                Column::text(&format!("≤ {:.2} {}", threshold.ratio, threshold.intruders))
            }));
            columns.push(Column::number("induced"));
            let rows = self.policies.iter().map(|policy| {
                let lost = of(policy);
                let mut row = vec![Cell::Text(policy.policy.clone()), left(lost), ratio(lost)];
                row.extend(verdicts(lost, thresholds, self.is_stress));
                row.push(count(lost.induced));
                row
            });
            (columns, rows.collect::<Vec<_>>())
        };
        let (nmac_columns, nmac_rows) = against("NMAC", &NMAC_THRESHOLDS, |policy| &policy.nmac);
        let (lowc_columns, lowc_rows) = against("LoWC", &LOWC_THRESHOLDS, |policy| &policy.lowc);
        Section {
            title: "4. Metrics: risk ratios against quoted thresholds".into(),
            blocks: vec![
                SectionBlock::Paragraph(
                    "Ratio of weighted counts with and without avoidance, 95 % interval. “Met”: the whole interval is \
                     below the threshold; “not shown”: the interval contains it; “stress set”: the encounters stand for no airspace, and \
                     no threshold is judged on them. Induced: lost with the system only."
                        .into(),
                ),
                SectionBlock::Table(Table {
                    caption: "NMAC: closer than 500 ft and 100 ft at once.".into(),
                    columns: nmac_columns,
                    rows: nmac_rows,
                }),
                SectionBlock::Table(Table {
                    caption: "LoWC: closer than 2,000 ft and 250 ft at once (ASTM F3442).".into(),
                    columns: lowc_columns,
                    rows: lowc_rows,
                }),
                SectionBlock::Paragraph(
                    "The thresholds are second-hand: numbers that are quoted for systems like those of ASTM F3442, \
                     not copied from the standard. Check them against the edition that applies to you. \
                     Intervals are by bootstrap over the encounters, and Wilson’s where fewer than ten losses are left, or all."
                        .into(),
                ),
                SectionBlock::Table(self.rates()),
            ]
            .into_iter()
            .chain(self.hourly().map(SectionBlock::Table))
            .collect(),
        }
    }

    fn tail(&self) -> Section {
        let rows: Vec<Vec<Cell>> = self
            .policies
            .iter()
            .filter_map(|policy| {
                let (above, estimate) = policy.nmac.tail?;
                let mut row = vec![
                    Cell::Text(policy.policy.clone()),
                    left(&policy.nmac),
                    count(above),
                    Cell::Estimate(estimate, 4),
                ];
                row.extend(
                    NMAC_THRESHOLDS
                        .iter()
                        .map(|threshold| judged(&estimate, threshold, self.is_stress)),
                );
                Some(row)
            })
            .collect();
        let mut columns = vec![
            Column::text("policy"),
            Column::number("NMAC counted with the system, of without"),
            Column::number("nearest encounters"),
            Column::number("extrapolated risk ratio"),
        ];
        columns.extend(NMAC_THRESHOLDS.iter().map(|threshold| {
            Column::text(&format!("≤ {:.2} {}", threshold.ratio, threshold.intruders))
        }));
        let blocks = if rows.is_empty() {
            vec![SectionBlock::Paragraph(
                "None: there are too few encounters, or so many NMAC are left that counting them is better.".into(),
            )]
        } else {
            vec![
                SectionBlock::Paragraph(
                    "Where hardly any NMAC is left to count, the nearest encounters say how likely one is. Their distances, in units of the NMAC \
                     volume, continue by a generalized Pareto distribution; 95 % interval by bootstrap. This is an extrapolation: a fault that \
                     no encounter showed is not in it."
                        .into(),
                ),
                SectionBlock::Table(Table {
                    caption: "NMAC risk ratio from the tail of the nearest encounters.".into(),
                    columns,
                    rows,
                }),
            ]
        };
        Section::new("4. Metrics: rare near mid-air collisions", blocks)
    }

    /// Losses in a flight hour.
    fn hourly(&self) -> Option<Table> {
        let (per_km3, encounters_per_h) = self.per_hour?;
        let rows = self.policies.iter().map(|policy| {
            let rates = [&policy.nmac, &policy.lowc].map(|lost| [lost.nominal_rate, lost.rate]);
            let cells = rates.into_iter().flatten();
            let cells = cells.map(|rate| {
                let text = if rate > 0.0 {
                    format!("{:.2e}", rate * encounters_per_h)
                } else {
                    "none counted".into()
                };
                Cell::Text(text)
            });
            core::iter::once(Cell::Text(policy.policy.clone()))
                .chain(cells)
                .collect()
        });
        Some(Table {
            caption: format!(
                "Losses in a flight hour among {per_km3} aircraft in a cubic kilometre, as given {}: {encounters_per_h:.3} encounters in an hour, uniform traffic of any heading.",
                self.traffic_source.as_ref().map_or_else(
                    || "without a source".into(),
                    |source| format!("by {source}")
                )
            ),
            rows: rows.collect(),
            columns: without_and_with(),
        })
    }

    fn rates(&self) -> Table {
        let mut columns = without_and_with();
        columns.push(Column::number("risk ratio of DO-365B"));
        Table {
            caption: "Weighted shares of all encounters (%).".into(),
            columns,
            rows: self
                .policies
                .iter()
                .map(|policy| {
                    let mut row = vec![Cell::Text(policy.policy.clone())];
                    for lost in [&policy.nmac, &policy.lowc] {
                        row.push(Cell::Number(100.0 * lost.nominal_rate, 3));
                        row.push(Cell::Number(100.0 * lost.rate, 3));
                    }
                    row.push(ratio(&policy.do365));
                    row
                })
                .collect(),
        }
    }
}

/// The columns of losses without and with each policy.
fn without_and_with() -> Vec<Column> {
    let numbers = ["NMAC without", "NMAC with", "LoWC without", "LoWC with"];
    let policy = core::iter::once(Column::text("policy"));
    policy.chain(numbers.map(Column::number)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interval::Estimate;

    fn estimate(low: f64, high: f64) -> Estimate {
        Estimate {
            value: f64::midpoint(low, high),
            low,
            high,
        }
    }

    #[test]
    fn a_threshold_is_met_only_where_the_whole_interval_is_below() {
        let [cooperative, _] = NMAC_THRESHOLDS;
        assert_eq!(verdict(&estimate(0.0, 0.18), &cooperative), "met");
        assert_eq!(verdict(&estimate(0.1, 0.2), &cooperative), "not shown");
        assert_eq!(verdict(&estimate(0.19, 0.3), &cooperative), "not met");
    }

    /// Of five that lose well clear, two are lost as flown, and one of these only because of the policy: four were given way to.
    #[test]
    fn giving_way_leaves_out_what_the_policy_loses_itself() {
        let policy = PolicyCase {
            policy: "turn-aware".into(),
            lowc: Lost {
                nominal: 5,
                flown: 2,
                induced: 1,
                ..Lost::default()
            },
            action_leads_s: vec![30.0, 12.0, 20.0],
            ..PolicyCase::default()
        };
        let case = SafetyCase {
            policies: vec![policy],
            ..SafetyCase::default()
        };
        let SectionBlock::Table(table) = case.gave_way() else {
            panic!("a table");
        };
        assert_eq!(table.rows[0][1], Cell::Text("4 of 5".into()));
        assert_eq!(table.rows[0][2], cells::number(Some(12.0), 1));
        assert_eq!(table.rows[0][4], cells::number(Some(20.0), 1));
    }

    #[test]
    fn n11_thresholds_that_every_policy_meets_are_said_to_rank_none() {
        let case = |policy: &str, high: f64| PolicyCase {
            policy: policy.into(),
            nmac: Lost {
                ratio: Some(estimate(0.0, high)),
                ..Lost::default()
            },
            ..PolicyCase::default()
        };
        let of = |cases: Vec<PolicyCase>| SafetyCase {
            policies: cases,
            ..SafetyCase::default()
        };
        let mut both = of(vec![case(WITHOUT, 1.0), case("a", 0.1), case("b", 0.1)]);
        let said = both.met_by_all().unwrap();
        assert!(
            said.starts_with("All 2 policies meet NMAC ≤ 0.18"),
            "{said}"
        );
        assert!(both.to_html().contains("too easy to rank policies"));
        // What was flown on purpose meets nothing, and says so instead.
        assert!(both.to_html().contains(">met<") && !both.to_html().contains(">stress set<"));
        both.is_stress = true;
        assert!(!both.to_html().contains(">met<") && both.to_html().contains(">stress set<"));
        assert!(
            !both.to_html().contains("too easy") && !both.to_html().contains("met for the quoted")
        );
        assert_eq!(of(vec![case("a", 0.1), case("b", 0.9)]).met_by_all(), None);
        assert_eq!(of(vec![case("a", 0.1)]).met_by_all(), None);
    }

    #[test]
    fn the_page_is_whole_without_any_encounter_and_escapes_names() {
        let page = SafetyCase {
            name: "<b>".into(),
            ..SafetyCase::default()
        }
        .to_html();
        assert!(page.contains("&lt;b&gt;") && !page.contains("<b>"));
        assert!(page.ends_with("</html>\n"));
        // The page loads nothing.
        assert!(!page.contains("http://") || !page.contains("src="));
    }
}
