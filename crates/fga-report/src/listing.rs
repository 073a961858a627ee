//! A table of many runs, sortable and filterable, which opens each run's page.

use serde::Serialize;

use crate::interval::Estimate;
use crate::page;

/// The built page; `npm run build` in `viewer/` writes it.
const TEMPLATE: &str = include_str!("../assets/list.html");

/// The content of a table.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Listing {
    /// Heading.
    pub title: String,
    /// A sentence or two about the table; may be empty.
    pub note: String,
    /// How often each policy kept every volume clear, over all runs, listed or not.
    pub shares: Vec<ListingShare>,
    /// The runs, in any order.
    pub rows: Vec<ListingRow>,
}

/// How often a policy kept every protected volume clear.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ListingShare {
    /// The policy.
    pub policy: String,
    /// Runs with a known result.
    pub runs: u64,
    /// The share of them with every volume clear, with its 95 % interval.
    pub separated: Option<Estimate>,
    /// Runs that some manoeuvre could save, if an oracle was asked.
    pub avoidable: u64,
    /// The share of these with every volume clear, with its 95 % interval.
    pub saved: Option<Estimate>,
}

/// Counts for a [`ListingShare`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ListingTally {
    runs: u64,
    separated: u64,
    avoidable: u64,
    saved: u64,
}

impl ListingTally {
    /// Adds a run: whether it kept every volume clear, and whether some manoeuvre could.
    pub fn take(&mut self, separated: bool, avoidable: Option<bool>) {
        let could = avoidable == Some(true);
        self.runs += 1;
        self.separated += u64::from(separated);
        self.avoidable += u64::from(could);
        self.saved += u64::from(could && separated);
    }

    /// The shares, with Wilson intervals.
    pub fn shares(self, policy: String) -> ListingShare {
        ListingShare {
            policy,
            runs: self.runs,
            separated: Estimate::wilson(self.separated, self.runs),
            avoidable: self.avoidable,
            saved: Estimate::wilson(self.saved, self.avoidable),
        }
    }
}

/// The shares of each policy over a complete list of rows, policies in the order of the rows.
pub fn shares_of(rows: &[ListingRow]) -> Vec<ListingShare> {
    let mut tallies: Vec<(&str, ListingTally)> = Vec::new();
    for row in rows {
        let Some(separated) = row.separated else {
            continue;
        };
        let known = tallies.iter().position(|(policy, _)| *policy == row.policy);
        let place = known.unwrap_or_else(|| {
            tallies.push((&row.policy, ListingTally::default()));
            tallies.len() - 1
        });
        if let Some((_, tally)) = tallies.get_mut(place) {
            tally.take(separated, row.avoidable);
        }
    }
    tallies
        .into_iter()
        .map(|(policy, tally)| tally.shares(policy.to_owned()))
        .collect()
}

/// A run in the table. A column that is empty in every row does not show.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ListingRow {
    /// Its name: a file, or an encounter's number.
    pub name: String,
    /// The source of the encounter; may be empty.
    pub source: String,
    /// The policy that flew it.
    pub policy: String,
    /// Whether it kept every protected volume clear; `None` if unknown.
    pub separated: Option<bool>,
    /// Whether any manoeuvre could; `None` without an oracle.
    pub avoidable: Option<bool>,
    /// The least margin, metres; negative inside a volume.
    pub min_margin_m: Option<f64>,
    /// The largest departure from the mission, metres.
    pub max_cross_track_m: Option<f64>,
    /// Path flown less the path of the mission, metres.
    pub extra_path_m: Option<f64>,
    /// The address of its page, relative to the table's; `None` without a page.
    pub link: Option<String>,
}

/// Writes the table: lost runs first, then by the worst margin.
#[must_use]
pub fn render(listing: &Listing) -> String {
    page::fill(TEMPLATE, &listing.title, &page::json(listing), "'none'")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_from_a_file_stays_text() {
        let row = ListingRow {
            name: "</script><b>".into(),
            ..ListingRow::default()
        };
        let page = render(&Listing {
            title: "<i>".into(),
            rows: vec![row],
            ..Listing::default()
        });
        assert!(!page.contains("</script><b>"));
        assert!(page.contains("<title>&lt;i&gt;</title>"));
    }
}
