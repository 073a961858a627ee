//! The league: every policy over sets of encounters, as one page.

use crate::interval::Estimate;
use crate::report::{Cell, Column, ReportPage, Section, SectionBlock, Table};
use crate::safety_case::cells::{self, count, facts, left, needless_of_clear, number, ratio};
use crate::safety_case::{Lost, PolicyCase, WorstCase};

/// Everything on the page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct League {
    /// Origin of the results.
    pub facts: Vec<(String, String)>,
    /// Sets that were not flown and policies that do not take part, and why.
    pub left_out: Vec<String>,
    /// The sets.
    pub sets: Vec<LeagueSet>,
}

/// A set of encounters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LeagueSet {
    /// Its name.
    pub name: String,
    /// The policy by which its intruders react; none fly their tracks.
    pub intruders: Option<String>,
    /// What it is, a paragraph each.
    pub about: Vec<String>,
    /// Whether its encounters are of aircraft, with losses as the standards count them.
    pub has_aircraft: bool,
    /// The policies, in the order of the table.
    pub standings: Vec<Standing>,
    /// The worst encounters.
    pub worst: Vec<WorstCase>,
    /// The assumptions: name, value.
    pub assumed: Vec<(String, String)>,
}

/// The results of a policy in a set.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Standing {
    /// What the standards count.
    pub case: PolicyCase,
    /// Encounters flown.
    pub encounters: u64,
    /// Would have entered a protected volume with course and altitude held, or as recorded.
    pub threatened: u64,
    /// Entered one.
    pub entered: u64,
    /// Entered one that holding would not have entered.
    pub caused: u64,
    /// Manoeuvred although holding would have entered none.
    pub needless: u64,
    /// Manoeuvred.
    pub manoeuvred: u64,
    /// Manoeuvred, and back on the mission at the end.
    pub rejoined: u64,
    /// Largest distances from the mission of flights with a manoeuvre: median and 90 %, metres.
    pub cross_track_m: [Option<f64>; 2],
    /// Extra paths of flights with a manoeuvre: median, metres.
    pub extra_path_m: Option<f64>,
    /// Times away of flights with a manoeuvre: median, seconds.
    pub away_s: Option<f64>,
    /// Largest works of a decision: median and most of the flights; `None` for a policy that counts none.
    pub work: [Option<f64>; 2],
    /// SHA-256 of its `results.parquet`.
    pub sha256: String,
}

impl League {
    /// The page as one HTML file.
    pub fn to_html(&self) -> String {
        let mut report = ReportPage::new("League of policies");
        report.summary = "Every policy over the same encounters, in the same plant, under the same limits and with the same sight, \
             judged by code apart from all of them."
            .into();
        report.facts.clone_from(&self.facts);
        report.sections = self.reactions().into_iter().collect();
        report
            .sections
            .extend(self.sets.iter().map(LeagueSet::section));
        report
            .sections
            .extend(self.sets.iter().map(LeagueSet::evidence));
        report.sections.push(self.limitations());
        report.to_html()
    }

    /// Each policy against each reaction, for the sets that were flown with several; `None` without one.
    fn reactions(&self) -> Option<Section> {
        let tables: Vec<SectionBlock> = self
            .sets
            .iter()
            .filter(|set| set.intruders.is_none())
            .filter_map(|set| {
                let columns: Vec<&LeagueSet> = self
                    .sets
                    .iter()
                    .filter(|other| other.name == set.name)
                    .collect();
                (columns.len() > 1).then(|| SectionBlock::Table(matrix(set, &columns)))
            })
            .collect();
        let title = "Policies against reactions of the intruders";
        (!tables.is_empty()).then(|| Section::new(title, tables))
    }

    fn limitations(&self) -> Section {
        let mut blocks: Vec<SectionBlock> = self
            .left_out
            .iter()
            .cloned()
            .map(SectionBlock::Paragraph)
            .collect();
        blocks.push(SectionBlock::Paragraph(
            "Where a set does not say how, intruders do not react. A loss of well clear or a near mid-air collision counts whoever makes it. Recorded encounters were flown on \
             purpose: they are a stress set, no airspace. Settings of the baselines were searched on other encounters than these (docs/baselines.md); \
             the default policy was developed with the recorded ones at hand. Decision times differ from run to run: they are in timing.csv."
                .into(),
        ));
        Section::new("What is left out, and what this is no evidence of", blocks)
    }
}

/// Losses left: a row for each policy, a column for each reaction.
fn matrix(set: &LeagueSet, columns: &[&LeagueSet]) -> Table {
    let rows = set.standings.iter().map(|standing| {
        let policy = &standing.case.policy;
        let cells = columns.iter().map(|column| {
            let there = column.standings.iter().find(|s| s.case.policy == *policy);
            there.map_or(Cell::Empty, |standing| {
                let case = &standing.case;
                Cell::Text(format!("{}, {}", case.nmac.flown, case.lowc.flown))
            })
        });
        core::iter::once(Cell::Text(policy.clone()))
            .chain(cells)
            .collect()
    });
    let of = |lost: fn(&PolicyCase) -> &Lost| {
        let first = set.standings.first();
        first.map_or(0, |standing| lost(&standing.case).nominal)
    };
    let names = columns.iter().map(|column| match &column.intruders {
        None => Column::text("intruders do not react"),
        Some(intruders) => Column::text(intruders),
    });
    Table {
        caption: format!(
            "{}: NMAC and LoWC left, of {} and {} if neither aircraft does anything.",
            set.name,
            of(|case| &case.nmac),
            of(|case| &case.lowc),
        ),
        rows: rows.collect(),
        columns: core::iter::once(Column::text("policy"))
            .chain(names)
            .collect(),
    }
}

impl LeagueSet {
    /// The name with the reaction.
    pub fn title(&self) -> String {
        match &self.intruders {
            None => self.name.clone(),
            Some(intruders) => format!("{}, intruders {intruders}", self.name),
        }
    }

    fn section(&self) -> Section {
        let mut blocks: Vec<SectionBlock> = self
            .about
            .iter()
            .cloned()
            .map(SectionBlock::Paragraph)
            .collect();
        if self.has_aircraft {
            blocks.push(SectionBlock::Table(self.losses()));
        }
        blocks.push(SectionBlock::Table(self.volume()));
        if !self.worst.is_empty() {
            let caption = "The worst encounters of each policy. Each leads to its replay, which also shows the default policy, and beside the default policy the \
                 first other one of the table that acts. Separations of aircraft: least horizontal, and vertical at that time, m.";
            blocks.push(SectionBlock::Table(cells::worst(&self.worst, caption)));
        }
        Section::new(self.title(), blocks)
    }

    fn losses(&self) -> Table {
        Table::of(
            self.standings.iter().map(|standing| &standing.case),
            "Losses left with the policy, of those without any; risk ratios of weighted counts with their 95 % interval. NMAC: closer than 500 ft and \
             100 ft. LoWC: closer than 2,000 ft and 250 ft (ASTM F3442). Induced: lost with the policy only. Needless: acted though well clear \
             without it. Restless: more than three changes between away and back.",
            [
                (Column::text("policy"), |case| Cell::text(&case.policy)),
                (Column::number("NMAC"), |case| left(&case.nmac)),
                (Column::number("NMAC risk ratio"), |case| ratio(&case.nmac)),
                (Column::number("LoWC"), |case| left(&case.lowc)),
                (Column::number("LoWC risk ratio"), |case| ratio(&case.lowc)),
                (Column::number("DO-365B risk ratio"), |case| {
                    ratio(&case.do365)
                }),
                (Column::number("induced"), |case| {
                    count(case.nmac.induced + case.lowc.induced)
                }),
                (Column::number("needless"), needless_of_clear),
                (Column::number("restless"), |case| count(case.restless)),
            ],
        )
    }

    fn volume(&self) -> Table {
        let entered = |it: &Standing| Cell::text(format!("{} of {}", it.entered, it.threatened));
        let share = |it: &Standing| {
            Estimate::wilson(it.entered, it.encounters).map_or(Cell::Empty, Cell::Share)
        };
        let needless = |it: &Standing| {
            let clear = it.encounters - it.threatened;
            Cell::text(format!("{} of {clear}", it.needless))
        };
        Table::of(
            &self.standings,
            "The protected volume of the vehicle file, and what it costs to keep it. Entered: with the policy, of those that holding course and \
             altitude (or the recorded flight) enters; share of all encounters with its 95 % interval. Cross-track distance, extra path and time \
             away: of flights with a manoeuvre. Work: the largest decision of a flight, median and most of the flights (to 1 %), in units of 100 to 180 \
             instructions; only decisions of the core count their work, others stand empty. Failed: encounters in which a policy of one’s own raised, hung or answered wrongly.",
            [
                (Column::text("policy"), |it| Cell::text(&it.case.policy)),
                (Column::number("entered"), entered),
                (Column::number("of all (%)"), share),
                (Column::number("caused"), |it| count(it.caused)),
                (Column::number("needless"), needless),
                (Column::number("cross-track median (m)"), |it| {
                    number(it.cross_track_m[0], 0)
                }),
                (Column::number("90 % (m)"), |it| {
                    number(it.cross_track_m[1], 0)
                }),
                (Column::number("extra path median (m)"), |it| {
                    number(it.extra_path_m, 0)
                }),
                (Column::number("away median (s)"), |it| number(it.away_s, 0)),
                (Column::number("work median"), |it| number(it.work[0], 0)),
                (Column::number("work most"), |it| number(it.work[1], 0)),
                (Column::number("not back"), |it| {
                    count(it.manoeuvred - it.rejoined)
                }),
                (Column::number("failed"), |it| count(it.case.failed)),
            ],
        )
    }

    fn evidence(&self) -> Section {
        let results = self.standings.iter().map(|standing| {
            (
                format!("results of {}", standing.case.policy),
                format!("SHA-256 {}", standing.sha256),
            )
        });
        let results: Vec<(String, String)> = results.collect();
        let title = format!("{}: conditions and results", self.title());
        let table = facts(self.assumed.iter().chain(&results));
        Section::new(title, vec![SectionBlock::Table(table)])
    }
}
