//! A table of many runs, sortable and filterable, from which each run's page is opened.

use serde::Serialize;

use crate::page;

/// The built page; `npm run build` in `viewer/` writes it.
const TEMPLATE: &str = include_str!("../assets/list.html");

/// A run in the table.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ListingRow {
    /// What it is called: a file, an encounter's number.
    pub name: String,
    /// The policy that flew it.
    pub policy: String,
    /// Whether every protected volume was kept; `None` where it is not known.
    pub separated: Option<bool>,
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
pub fn render(title: &str, rows: &[ListingRow]) -> String {
    #[derive(Serialize)]
    struct Listing<'a> {
        title: &'a str,
        rows: &'a [ListingRow],
    }
    let data = page::json(&Listing { title, rows });
    page::fill(TEMPLATE, title, &data, "'none'")
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
        let page = render("<i>", &[row]);
        assert!(!page.contains("</script><b>"));
        assert!(page.contains("<title>&lt;i&gt;</title>"));
    }
}
