//! A report as one HTML file: sections, tables with intervals, figures and their interpretation.
//!
//! The page opens without a network, has no script, prints, and follows the reader's choice of a
//! light or dark page: figures are inline SVG, and the page's style replaces their neutral colours.
//!
//! # Examples
//!
//! ```
//! use fga_report::interval::Estimate;
//! use fga_report::report::{Cell, Column, ReportPage, Section, SectionBlock, Table};
//!
//! let mut report = ReportPage::new("Success against distance");
//! report.facts.push(("encounters".into(), "300 a row".into()));
//! report.sections.push(Section {
//!     title: "One static obstacle".into(),
//!     blocks: vec![SectionBlock::Table(Table {
//!         caption: "Separated encounters.".into(),
//!         columns: vec![Column::text("policy"), Column::number("separated (%)")],
//!         rows: vec![vec![
//!             Cell::Text("turn-aware".into()),
//!             Cell::Share(Estimate::wilson(300, 300).unwrap()),
//!         ]],
//!     })],
//! });
//! assert!(report.to_html().contains("100.0"));
//! ```

use core::fmt::Write as _;

use crate::interval::Estimate;
use crate::svg::escape;

/// A report.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReportPage {
    /// Heading of the page.
    pub title: String,
    /// A sentence or two about the page, under the heading.
    pub summary: String,
    /// Origin of the results: name, value (version, configuration, seed, target).
    pub facts: Vec<(String, String)>,
    /// The sections; the contents list them too.
    pub sections: Vec<Section>,
}

/// A section with its heading.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Heading.
    pub title: String,
    /// Its blocks, in order.
    pub blocks: Vec<SectionBlock>,
}

/// A block of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum SectionBlock {
    /// Plain text.
    Paragraph(String),
    /// A table.
    Table(Table),
    /// A figure of this crate with its caption.
    Figure {
        /// The output of a `to_svg` of this crate; the page contains it unchanged.
        svg: String,
        /// One or two sentences below it.
        caption: String,
    },
    /// A claim beside its measurement.
    Reading(Reading),
    /// Files beside the page: relative path, content.
    Files(Vec<(String, String)>),
}

/// A claim of the paper beside its measurement, with one sentence of interpretation.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Reading {
    /// The claim of the paper.
    pub paper: String,
    /// The result of the published algorithm.
    pub published: String,
    /// The result of the turn-aware policy.
    pub turn_aware: String,
    /// The limit from the oracle.
    pub oracle: String,
    /// The interpretation.
    pub reading: String,
}

/// A table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Its caption.
    pub caption: String,
    /// Its columns.
    pub columns: Vec<Column>,
    /// Its rows; a missing cell is empty.
    pub rows: Vec<Vec<Cell>>,
}

/// The cell of an item.
pub type CellOf<T> = fn(&T) -> Cell;

impl Section {
    /// A section of some blocks.
    pub fn new(title: impl Into<String>, blocks: Vec<SectionBlock>) -> Self {
        let title = title.into();
        Self { title, blocks }
    }
}

impl Table {
    /// A table with a row for each item; every column has its cell of an item beside it.
    pub fn of<'a, T: 'a, const N: usize>(
        items: impl IntoIterator<Item = &'a T>,
        caption: impl Into<String>,
        columns: [(Column, CellOf<T>); N],
    ) -> Self {
        let items = items.into_iter();
        let rows = items.map(|item| columns.iter().map(|(_, cell)| cell(item)).collect());
        Self {
            caption: caption.into(),
            rows: rows.collect(),
            columns: columns.map(|(column, _)| column).into(),
        }
    }
}

/// The head of a column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Name with unit.
    pub name: String,
    /// Whether its cells are numbers, aligned to the right.
    pub numeric: bool,
}

impl Column {
    /// A column of text.
    pub fn text(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            numeric: false,
        }
    }

    /// A column of numbers.
    pub fn number(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            numeric: true,
        }
    }
}

/// A cell of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Text.
    Text(String),
    /// A number with a fixed number of decimals.
    Number(f64, usize),
    /// A share of 0 to 1, shown in per cent with its interval.
    Share(Estimate),
    /// A value with its interval, with a fixed number of decimals.
    Estimate(Estimate, usize),
    /// A link to a file beside the page.
    Link {
        /// The text of the link.
        text: String,
        /// Relative path.
        href: String,
    },
    /// Not measured.
    Empty,
}

impl Cell {
    /// Text.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    fn html(&self) -> String {
        match self {
            Self::Text(text) => escape(text),
            Self::Number(value, decimals) => number(*value, *decimals),
            Self::Share(share) => interval(
                &Estimate {
                    value: share.value * 100.0,
                    low: share.low * 100.0,
                    high: share.high * 100.0,
                },
                1,
            ),
            Self::Estimate(estimate, decimals) => interval(estimate, *decimals),
            Self::Link { text, href } => {
                format!("<a href=\"{}\">{}</a>", escape(href), escape(text))
            }
            Self::Empty => "–".to_owned(),
        }
    }
}

fn number(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{value:.decimals$}");
    text.strip_prefix('-')
        .map_or(text.clone(), |rest| format!("−{rest}"))
}

fn interval(estimate: &Estimate, decimals: usize) -> String {
    let value = number(estimate.value, decimals);
    if estimate.low == estimate.high {
        return value;
    }
    format!(
        "{value} <small>[{}, {}]</small>",
        number(estimate.low, decimals),
        number(estimate.high, decimals)
    )
}

impl ReportPage {
    /// An empty report.
    pub fn new(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            ..Self::default()
        }
    }

    /// The page as one HTML file.
    pub fn to_html(&self) -> String {
        let mut page = String::new();
        let title = escape(&self.title);
        let _ = write!(
            page,
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
             <h1>{title}</h1>\n"
        );
        if !self.summary.is_empty() {
            let _ = writeln!(page, "<p class=\"summary\">{}</p>", escape(&self.summary));
        }
        if !self.facts.is_empty() {
            page.push_str("<dl class=\"facts\">\n");
            for (name, value) in &self.facts {
                let _ = writeln!(
                    page,
                    "<div><dt>{}</dt><dd>{}</dd></div>",
                    escape(name),
                    escape(value)
                );
            }
            page.push_str("</dl>\n");
        }
        if self.sections.len() > 1 {
            // Titles that have numbers of their own get no second ones.
            let is_numbered =
                |section: &Section| section.title.starts_with(|c: char| c.is_ascii_digit());
            let list = if self.sections.iter().all(is_numbered) {
                "<ol class=\"own\">"
            } else {
                "<ol>"
            };
            let _ = writeln!(page, "<nav aria-label=\"Contents\">\n{list}");
            for (index, section) in self.sections.iter().enumerate() {
                let _ = writeln!(
                    page,
                    "<li><a href=\"#section-{}\">{}</a></li>",
                    index + 1,
                    escape(&section.title)
                );
            }
            page.push_str("</ol>\n</nav>\n");
        }
        for (index, section) in self.sections.iter().enumerate() {
            let _ = writeln!(
                page,
                "<section id=\"section-{}\">\n<h2>{}</h2>",
                index + 1,
                escape(&section.title)
            );
            for block in &section.blocks {
                block.write(&mut page);
            }
            page.push_str("</section>\n");
        }
        page.push_str("</main>\n</body>\n</html>\n");
        page
    }
}

impl SectionBlock {
    fn write(&self, page: &mut String) {
        match self {
            Self::Paragraph(text) => {
                let _ = writeln!(page, "<p>{}</p>", escape(text));
            }
            Self::Table(table) => table.write(page),
            Self::Figure { svg, caption } => {
                let _ = writeln!(
                    page,
                    "<figure>\n{svg}<figcaption>{}</figcaption>\n</figure>",
                    escape(caption)
                );
            }
            Self::Reading(reading) => reading.write(page),
            Self::Files(files) => {
                page.push_str("<ul class=\"files\">\n");
                for (path, what) in files {
                    let _ = writeln!(
                        page,
                        "<li><a href=\"{0}\">{0}</a> {1}</li>",
                        escape(path),
                        escape(what)
                    );
                }
                page.push_str("</ul>\n");
            }
        }
    }
}

/// A table with more columns uses a narrower style.
const WIDE: usize = 6;

/// Text up to this many characters stays on one line.
const SHORT: usize = 30;

impl Table {
    fn write(&self, page: &mut String) {
        // In tables with many numbers the intervals go below the numbers.
        let numbers = self.columns.iter().filter(|c| c.numeric).count();
        let class = if numbers > WIDE {
            "table wide"
        } else {
            "table"
        };
        let _ = writeln!(page, "<div class=\"{class}\"><table>");
        if !self.caption.is_empty() {
            let _ = writeln!(page, "<caption>{}</caption>", escape(&self.caption));
        }
        page.push_str("<thead><tr>");
        for column in &self.columns {
            let class = if column.numeric {
                " class=\"number\""
            } else {
                ""
            };
            let _ = write!(
                page,
                "<th scope=\"col\"{class}>{}</th>",
                escape(&column.name)
            );
        }
        page.push_str("</tr></thead>\n<tbody>\n");
        for row in &self.rows {
            page.push_str("<tr>");
            for (index, column) in self.columns.iter().enumerate() {
                let class = if column.numeric {
                    " class=\"number\""
                } else {
                    ""
                };
                let class = match row.get(index) {
                    Some(Cell::Text(text)) if class.is_empty() && text.chars().count() <= SHORT => {
                        " class=\"short\""
                    }
                    _ => class,
                };
                let cell = row.get(index).map_or_else(String::new, Cell::html);
                let _ = write!(page, "<td{class}>{cell}</td>");
            }
            page.push_str("</tr>\n");
        }
        page.push_str("</tbody>\n</table></div>\n");
    }
}

impl Reading {
    fn write(&self, page: &mut String) {
        page.push_str("<dl class=\"reading\">\n");
        for (name, text) in [
            ("The paper states", &self.paper),
            ("published gives", &self.published),
            ("turn-aware gives", &self.turn_aware),
            ("The oracle allows", &self.oracle),
            ("Interpretation", &self.reading),
        ] {
            if !text.is_empty() {
                let _ = writeln!(page, "<dt>{name}</dt><dd>{}</dd>", escape(text));
            }
        }
        page.push_str("</dl>\n");
    }
}

/// The page's style. In dark mode it exchanges the neutral colours of the figures by their values;
/// the colours of series stay.
const STYLE: &str = "\
:root{color-scheme:light dark;--paper:#ffffff;--ink:#1f2328;--muted:#59636e;--line:#d1d9e0;--soft:#f6f8fa;--link:#0072b2}
@media screen and (prefers-color-scheme:dark){:root{--paper:#14181d;--ink:#e6eaef;--muted:#9aa6b2;--line:#353d47;--soft:#1c2229;--link:#56b4e9}
figure [fill=\"#ffffff\"]{fill:var(--paper)}figure [fill=\"#1f2328\"]{fill:var(--ink)}figure [fill=\"#59636e\"]{fill:var(--muted)}figure [fill=\"#000000\"]{fill:#ffffff}
figure [stroke=\"#ffffff\"]{stroke:var(--paper)}figure [stroke=\"#1f2328\"]{stroke:var(--ink)}figure [stroke=\"#59636e\"]{stroke:var(--muted)}figure [stroke=\"#e3e6ea\"]{stroke:#2a313a}figure [stroke=\"#000000\"]{stroke:#ffffff}
figure [stroke=\"#0072b2\"]{stroke:#3d9bd6}figure [fill=\"#0072b2\"]{fill:#3d9bd6}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif}
main{max-width:56rem;margin:0 auto;padding:2rem 1.25rem 5rem}
h1{font-size:1.9rem;line-height:1.2;margin:0 0 .6rem}
h2{font-size:1.3rem;margin:3rem 0 .8rem;padding-top:.8rem;border-top:1px solid var(--line)}
a{color:var(--link)}
.summary{font-size:1.1rem;margin:.2rem 0 1.2rem}
.facts{display:grid;grid-template-columns:repeat(auto-fill,minmax(12rem,1fr));gap:.5rem 1.5rem;margin:0 0 1.5rem;font-size:.9rem}
.facts dt{color:var(--muted)}.facts dd{margin:0;overflow-wrap:anywhere}
nav{background:var(--soft);border-radius:6px;padding:.4rem .5rem;font-size:.95rem}nav ol{columns:2 18rem;margin:.4rem 0}nav ol.own{list-style:none;padding-left:.6rem}
figure{margin:1.5rem 0;break-inside:avoid}figure svg{display:block;max-width:100%;height:auto;border:1px solid var(--line);border-radius:6px}figure svg svg{border:0}
figcaption,caption{color:var(--muted);font-size:.9rem;text-align:left;margin-top:.5rem}caption{margin:0 0 .4rem}
.table{overflow-x:auto;margin:1.5rem 0}table{border-collapse:collapse;font-size:.92rem;font-variant-numeric:tabular-nums;min-width:50%}
th,td{padding:.35rem .8rem .35rem 0;text-align:left;border-bottom:1px solid var(--line);vertical-align:baseline}th{font-weight:600;vertical-align:bottom}
.number{text-align:right}td.number,.short{white-space:nowrap}td small{color:var(--muted)}
.wide table{font-size:.82rem}.wide th,.wide td{padding-right:.6rem}.wide small{display:block;line-height:1.2}
.reading{display:grid;grid-template-columns:max-content 1fr;gap:.4rem 1.2rem;margin:1.5rem 0;padding:1rem 1.1rem;background:var(--soft);border-radius:6px}
.reading dt{color:var(--muted)}.reading dd{margin:0}.reading dt:last-of-type{color:var(--ink);font-weight:600}.reading dd:last-of-type{font-weight:600}
.files{font-size:.92rem}
@media (max-width:38rem){.reading{grid-template-columns:1fr}.reading dd{margin-bottom:.5rem}}
@media print{nav{display:none}main{max-width:none;padding:0}}
";
