//! A table of many runs, sortable and filterable, from which each run's page is opened.

use serde::Serialize;

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
    /// The runs, in any order.
    pub rows: Vec<ListingRow>,
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
