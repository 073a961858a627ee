//! `fga reproduce`: one report that opens offline, with its data.

use std::fs;

use crate::support::{errors, fga_in};

#[test]
fn the_report_is_whole_and_opens_offline() {
    let folder = tempfile::tempdir().unwrap();
    let output = fga_in(
        folder.path(),
        &["reproduce", "--encounters", "1", "--out", "r"],
    );
    assert!(output.status.success(), "{}", errors(&output));
    let page = fs::read_to_string(folder.path().join("r/report.html")).unwrap();
    for part in [
        "Table 4",
        "Tables 3 and 7",
        "Fig. 12",
        "Fig. 13",
        "Figs. 14 and 15",
        "Bound 1 (Eq. 26–30)",
        "Bounds 1 to 3 (Eq. 26–53)",
        "L_1 &lt; L_3",
        "Tables 5 and 6",
        "67 % shorter",
        "Section 2.3",
        "Fig. 16",
        "Fig. 17",
        "San Francisco",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("<script") && !page.contains("<link") && !page.contains("src=\"http"));
    for file in [
        "fig-12.csv",
        "fig-13.csv",
        "fig-14-15.csv",
        "bound-1.csv",
        "bounds.csv",
        "paths.csv",
        "tables-5-6.csv",
        "shorter.csv",
        "methods.csv",
        "sfo-circle.kml",
        "sfo-turn-aware.kml",
        "run.json",
        "fig-16-replay.html",
        "fig-17-replay.html",
        "sfo-replay.html",
    ] {
        assert!(folder.path().join("r/data").join(file).exists(), "{file}");
    }
    // The flights of a figure share one page, which the report links to.
    assert!(page.contains("href=\"data/fig-17-replay.html\""));
    let replay = fs::read_to_string(folder.path().join("r/data/fig-17-replay.html")).unwrap();
    for policy in ["published --start t0", "published --start tc", "turn-aware"] {
        assert!(
            replay.contains(&format!("\"name\":\"{policy}\"")),
            "{policy}"
        );
    }
    // Every point has all four series, and no share is outside its interval.
    let csv = fs::read_to_string(folder.path().join("r/data/fig-14-15.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 3 * 4 * 4);
    for line in csv.lines().skip(1) {
        let numbers: Vec<f64> = line
            .rsplitn(4, ',')
            .take(3)
            .map(|n| n.parse().unwrap())
            .collect();
        assert!(
            numbers[2] >= numbers[1] && numbers[0] >= numbers[2],
            "{line}"
        );
    }
}
