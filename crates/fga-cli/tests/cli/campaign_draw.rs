//! `fga campaign draw`: what it writes flies again.

use std::fs;
use std::process::Command;

use crate::aircraft_campaign::{MODELED, run, written};
use crate::support::{self, columns, errors, fga_in, rows};

/// The ground and the zones of drawn encounters go with them: flown as a folder or as a source, they give the same flights, and the oracle
/// knows them too.
#[test]
fn drawn_ground_and_zones_fly_again() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let cells = "cells = [\"ridges:2:200-500:20-60\", \"corridor:1:300-500:20-60\", \"threats:1:300-500:20-60\"]";
    let file = format!("policies = [\"turn-aware\"]\nencounters = 6\nseeds = [7]\n{cells}\n");
    fs::write(at.join("bounded.toml"), file).unwrap();
    fs::write(
        at.join("again.toml"),
        "policies = [\"turn-aware\"]\nseeds = [7]\nfiles = [\"drawn\"]\n",
    )
    .unwrap();
    for arguments in [
        &[
            "campaign",
            "run",
            "bounded.toml",
            "--oracle",
            "--csv",
            "--out",
            "flown",
        ][..],
        &["campaign", "draw", "bounded.toml", "--out", "drawn"],
        &["check", "drawn"],
        &[
            "batch", "drawn", "--seed", "7", "--replay", "1", "--out", "batch",
        ],
        &["oracle", "drawn", "--out", "oracle"],
        &["campaign", "run", "again.toml", "--csv", "--out", "again"],
    ] {
        let output = fga_in(at, arguments);
        assert!(output.status.success(), "{}", errors(&output));
    }
    let flown = support::columns(&at.join("flown/results.csv"));
    let batch = support::columns(&at.join("batch/results.csv"));
    let again = support::columns(&at.join("again/results.csv"));
    for name in [
        "min_margin_m",
        "max_cross_track_m",
        "min_terrain_clearance_m",
        "min_zone_margin_m",
    ] {
        let expected = format!("{:?}", flown[name]);
        assert_eq!(format!("{:?}", batch[name]), expected, "{name}");
        assert_eq!(format!("{:?}", again[name]), expected, "{name}");
    }
    let is_known =
        |name: &str| -> Vec<bool> { flown[name].iter().map(|value| value.is_finite()).collect() };
    let every_third = |first: usize| (0..6).map(|at| at % 3 == first).collect::<Vec<_>>();
    assert_eq!(is_known("min_terrain_clearance_m"), every_third(0));
    assert_eq!(is_known("min_zone_margin_m"), every_third(1));
    // The campaign's search ends at 0.1 m, as the answer to avoidable does.
    let best_m = support::columns(&at.join("oracle/oracle.csv"))["best_margin_m"].clone();
    let keeps = |margins_m: &[f64]| {
        margins_m
            .iter()
            .map(|margin_m| *margin_m >= 0.1)
            .collect::<Vec<_>>()
    };
    assert_eq!(keeps(&best_m), keeps(&flown["oracle_margin_m"]));

    // What is missing or cannot be is refused, never flown without.
    let one = at.join("drawn/surroundings/00000003.json");
    let text = fs::read_to_string(&one).unwrap();
    for (content, expected) in [
        (
            Some(text.replace("\"columns\":161", "\"columns\":160")),
            "holds ground that cannot be",
        ),
        (
            Some(text.replace("\"spacing_m\":[25.0", "\"spacing\":[25.0")),
            "unknown field",
        ),
        (Some(text[..text.len() / 2].to_owned()), "EOF while parsing"),
        (None, "cannot be read"),
    ] {
        match content {
            Some(content) => fs::write(&one, content).unwrap(),
            None => fs::remove_file(&one).unwrap(),
        }
        let output = fga_in(at, &["batch", "drawn", "--out", "batch"]);
        assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
        assert!(errors(&output).contains(expected), "{}", errors(&output));
    }
    // A draw without them leaves none behind.
    let draw = ["campaign", "draw", "again.toml", "--out", "drawn"];
    let plain = "policies = [\"none\"]\nencounters = 2\nseeds = [7]\ncells = [\"threats:1:300-500:20-60\"]\n";
    fs::write(at.join("again.toml"), plain).unwrap();
    assert!(fga_in(at, &draw).status.success());
    assert!(!at.join("drawn/surroundings").exists());
}

#[test]
fn drawn_encounters_fly_alike_as_recordings() {
    let folder = written();
    let at = folder.path();
    run(
        at,
        &MODELED,
        &["--encounters", "12", "--csv", "--out", "flown"],
    );
    let draw = ["campaign", "draw", "modeled.toml", "--encounters", "12"];
    run(at, &draw, &["--out", "drawn"]);
    let again = [
        "campaign",
        "run",
        "recorded.toml",
        "--recordings",
        "drawn/recordings",
    ];
    run(at, &again, &["--csv", "--out", "again"]);
    let [flown, again] = ["flown", "again"].map(|out| columns(&at.join(out).join("results.csv")));
    assert_eq!(flown["min_margin_m"].len(), 24);
    for (a, b) in flown["nominal_horizontal_m"]
        .iter()
        .zip(&again["nominal_horizontal_m"])
    {
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
    let list = rows(&at.join("drawn/drawn.csv"));
    for (row, weight) in list.iter().zip(flown["weight"].iter().step_by(2)) {
        let drawn: f64 = row["weight"].parse().unwrap();
        assert!((drawn - weight).abs() < 1e-6);
    }
    // A table of another kind in the place of the results: one sentence.
    fs::copy(
        at.join("drawn/tracks.parquet"),
        at.join("flown/results.parquet"),
    )
    .unwrap();
    let output = fga_in(at, &["campaign", "report", "flown"]);
    assert_eq!(output.status.code(), Some(1));
    let said = errors(&output);
    assert!(
        said.contains("results.parquet: cannot be used: has other columns: column 2 is")
            && said.contains("expected \"source_encounter\" as a campaign has it")
            && said.lines().count() == 1,
        "{said}"
    );
}

#[cfg(unix)]
#[test]
fn a_draw_that_fails_leaves_the_earlier_one() {
    let folder = written();
    let at = folder.path();
    let draw = ["campaign", "draw", "modeled.toml", "--out", "drawn"];
    run(at, &draw, &["--encounters", "2"]);
    let there = || {
        let mut files: Vec<_> = ["drawn", "drawn/recordings"]
            .iter()
            .flat_map(|each| fs::read_dir(at.join(each)).unwrap())
            .map(|entry| entry.unwrap().path())
            .collect();
        files.sort();
        files
    };
    let before = there();
    // Room for each recording but not for the table of all.
    let output = Command::new("sh")
        .current_dir(at)
        .arg("-c")
        .arg("trap '' XFSZ; ulimit -f 100; exec \"$0\" \"$@\"")
        .arg(env!("CARGO_BIN_EXE_fga"))
        .args(draw)
        .args(["--encounters", "40"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
    assert!(
        errors(&output).contains("tracks.parquet cannot be written"),
        "{}",
        errors(&output)
    );
    assert_eq!(before, there());
}
