//! Alerts and bands against the outputs of DAIDALUS.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "tests fail by panicking"
)]

use crate::common::data;
use fga_formats::conf;
use fga_formats::daa::instants;
use fga_formats::daa::tables::{DaaTables, watch};

/// The first line in which two texts differ, and what both have there.
fn first_difference(found: &str, expected: &str) -> Option<(usize, String, String)> {
    let mut lines = (found.lines(), expected.lines(), 1);
    loop {
        let (a, b) = (lines.0.next(), lines.1.next());
        if a.is_none() && b.is_none() {
            return None;
        }
        if a != b {
            let text = |line: Option<&str>| line.unwrap_or("(end)").to_owned();
            return Some((lines.2, text(a), text(b)));
        }
        lines.2 += 1;
    }
}

#[test]
fn alerts_of_h1_equal_the_reference_in_every_printed_digit() {
    let (Some(recording), Some(configuration), Some(gold)) = (
        data("daidalus/H1.daa"),
        data("daidalus/DO_365B_no_SUM.conf"),
        data("daidalus/gold/DaidalusqAlerting-no_sum.csv"),
    ) else {
        return;
    };
    let recording = instants::read(&recording).unwrap();
    let configuration = conf::read(&configuration).unwrap();
    let tables = DaaTables {
        recording: &recording,
        configuration: &configuration,
    };
    let mut found = tables.alerts_head();
    watch(&recording, &configuration, |monitor, scene| {
        tables.alerts_rows(monitor, scene, &mut found);
    })
    .unwrap();
    let gold = std::fs::read_to_string(gold).unwrap();
    assert_eq!(first_difference(&found, &gold), None);
    assert_eq!(found, gold);
}

#[test]
fn bands_of_h1_equal_the_reference_line_by_line() {
    let (Some(recording), Some(configuration), Some(gold)) = (
        data("daidalus/H1.daa"),
        data("daidalus/DO_365B_no_SUM.conf"),
        data("daidalus/gold/DaidalusBatch-no_sum.out"),
    ) else {
        return;
    };
    let recording = instants::read(&recording).unwrap();
    let configuration = conf::read(&configuration).unwrap();
    let tables = DaaTables {
        recording: &recording,
        configuration: &configuration,
    };
    let mut found = DaaTables::bands_head("../Scenarios/H1.daa");
    let mut times = 0;
    watch(&recording, &configuration, |monitor, scene| {
        tables.bands_text(monitor, scene, &mut found);
        times += 1;
    })
    .unwrap();
    let gold = std::fs::read_to_string(gold).unwrap();
    assert_eq!(first_difference(&found, &gold), None);
    assert_eq!(times, 230);
}
