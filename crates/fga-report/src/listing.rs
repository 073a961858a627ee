//! A table of many runs, sortable and filterable, from which each run's page is opened.

use serde::Serialize;

use crate::interval::Estimate;
use crate::page;

/// The built page; `npm run build` in `viewer/` writes it.
const TEMPLATE: &str = include_str!("../assets/list.html");

/// What a table shows.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Listing {
    /// Heading.
    pub title: String,
    /// What is to be said of it, in a sentence or two; may be empty.
    pub note: String,
    /// How often each policy kept every volume, over all runs, listed or not.
    pub shares: Vec<ListingShare>,
    /// The runs, in any order.
    pub rows: Vec<ListingRow>,
}

/// How often a policy kept every protected volume.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ListingShare {
    /// The policy.
    pub policy: String,
    /// Runs of which it is known whether they kept every volume.
    pub runs: u64,
    /// The share of them that did, with its 95 % interval.
    pub separated: Option<Estimate>,
    /// Runs that some maneuver could have kept, where it was asked.
    pub avoidable: u64,
    /// The share of those that were kept, with its 95 % interval.
    pub saved: Option<Estimate>,
}

/// Counts for a [`ListingShare`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    runs: u64,
    separated: u64,
    avoidable: u64,
    saved: u64,
}

impl Tally {
    /// Takes a run: whether it kept every volume, and whether some maneuver could have.
    pub fn take(&mut self, separated: bool, avoidable: Option<bool>) {
        let could = avoidable == Some(true);
        self.runs += 1;
        self.separated += u64::from(separated);
        self.avoidable += u64::from(could);
        self.saved += u64::from(could && separated);
    }

    /// The shares, with intervals by Wilson.
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

/// The shares of each policy over rows that are all there is, policies in the order of the rows.
pub fn shares_of(rows: &[ListingRow]) -> Vec<ListingShare> {
    let mut tallies: Vec<(&str, Tally)> = Vec::new();
    for row in rows {
        let Some(separated) = row.separated else {
            continue;
        };
        let known = tallies.iter().position(|(policy, _)| *policy == row.policy);
        let place = known.unwrap_or_else(|| {
            tallies.push((&row.policy, Tally::default()));
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

/// A run in the table. A column that no row has anything for is not shown.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ListingRow {
    /// What it is called: a file, an encounter's number.
    pub name: String,
    /// What the encounter was drawn from; may be empty.
    pub source: String,
    /// The policy that flew it.
    pub policy: String,
    /// Whether every protected volume was kept; `None` where it is not known.
    pub separated: Option<bool>,
    /// Whether any manoeuvre could have kept them; `None` where it was not asked.
    pub avoidable: Option<bool>,
    /// The least margin, metres; negative inside a volume.
    pub min_margin_m: Option<f64>,
    /// The largest departure from the mission, metres.
    pub max_cross_track_m: Option<f64>,
    /// What the aircraft flew more than without a manoeuvre, metres.
    pub extra_path_m: Option<f64>,
    /// Where its page is, relative to the table's; `None` where it has none.
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
