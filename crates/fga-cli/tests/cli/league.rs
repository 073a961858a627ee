//! `fga league`: one page about every policy, the same bytes again, resumable, open to a program of one's own.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;

use crate::support::{data, errors, fga_in, rows};

const BESIDES: [&str; 6] = ["--sets", "drawn-1hz", "--encounters", "24", "--worst", "1"];

fn league(folder: &Path, out: &str, more: &[&str]) -> std::process::Output {
    let mut arguments = vec!["league", "--out", out];
    arguments.extend(BESIDES);
    arguments.extend(more);
    fga_in(folder, &arguments)
}

fn files(folder: &Path) -> Vec<Vec<u8>> {
    let names = ["league.html", "league.parquet", "league.csv"];
    names
        .map(|name| fs::read(folder.join(name)).unwrap())
        .to_vec()
}

#[test]
fn the_same_league_has_the_same_bytes_and_is_not_flown_twice() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let policies = [
        "--policy",
        "none",
        "--policy",
        "turn-aware",
        "--policy",
        "mvp",
    ];
    for (out, threads) in [("one", "1"), ("two", "2")] {
        let done = league(
            place,
            out,
            &[&policies[..], &["--threads", threads]].concat(),
        );
        assert!(done.status.success(), "{}", errors(&done));
    }
    let first = files(&place.join("one"));
    assert_eq!(first, files(&place.join("two")));
    let page = String::from_utf8(first[0].clone()).unwrap();
    for what in [
        "drawn-1hz",
        "turn-aware",
        "mvp",
        "commit",
        "seeds",
        "SHA-256",
        "a look each 1 s",
    ] {
        assert!(page.contains(what), "{what}");
    }
    // Every replay of the page is there.
    let links: Vec<&str> = page
        .split("href=\"drawn-1hz/")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .collect();
    assert!(!links.is_empty());
    for link in links {
        assert!(place.join("one/drawn-1hz").join(link).is_file(), "{link}");
    }
    // What is complete stays as it is: its table would not be written again.
    let table = place.join("one/drawn-1hz/mvp/results.parquet");
    let written = fs::metadata(&table).unwrap().modified().unwrap();
    let done = league(place, "one", &policies);
    assert!(done.status.success(), "{}", errors(&done));
    assert_eq!(files(&place.join("one")), first);
    assert_eq!(fs::metadata(&table).unwrap().modified().unwrap(), written);
}

#[test]
fn a_program_joins_a_league_and_its_failures_stand_there() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let write = |body: &str| {
        let text = format!("#!/bin/sh\nwhile read -r line; do\n{body}\ndone\n");
        fs::write(place.join("own.sh"), text).unwrap();
        fs::set_permissions(place.join("own.sh"), fs::Permissions::from_mode(0o755)).unwrap();
    };
    let policies = ["--policy", "none", "--policy", "pipe:./own.sh"];
    let mut seen = Vec::new();
    // Another program under the same name flies anew.
    for (body, fails) in [("echo '{}'", false), ("exit 1", true)] {
        write(body);
        let done = league(place, "out", &policies);
        assert!(done.status.success(), "{}", errors(&done));
        let standings = rows(&place.join("out/league.csv"));
        assert_eq!(standings.len(), 2);
        let failed = if fails { "24" } else { "0" };
        assert_eq!(standings[1]["policy_failures"], failed);
        // Both fly the mission.
        for column in ["entered", "threatened", "encounters"] {
            assert_eq!(standings[0][column], standings[1][column]);
        }
        seen.push(standings[1]["results_sha256"].clone());
    }
    assert_ne!(seen[0], seen[1]);
}

#[test]
fn sets_and_policies_that_are_not_there_are_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, what) in [
        (&["--sets", "lunar"][..], "there is no set \"lunar\""),
        (
            &["--sets", "drawn-1hz,drawn-1hz"],
            "set drawn-1hz is named twice",
        ),
        (&["--sets", "none.toml", "--policy", "none"], "none.toml"),
        (&["--policy", "nobody"], "unknown policy \"nobody\""),
        (
            &["--policy", "orca", "--policy", "orca"],
            "policy orca is named twice",
        ),
        (&["--data", "nowhere"], "is no folder"),
    ] {
        let done = fga_in(folder.path(), &[&["league"], arguments].concat());
        assert_eq!(done.status.code(), Some(1), "{arguments:?}");
        assert!(errors(&done).contains(what), "{}", errors(&done));
        assert_eq!(errors(&done).lines().count(), 1, "{}", errors(&done));
    }
}

#[test]
fn recorded_encounters_have_losses_and_risk_ratios() {
    let Some(flown) = data("flown") else { return };
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    // Two recordings are enough to see the columns.
    fs::create_dir_all(place.join("data/flown")).unwrap();
    for name in ["NRC_Intercept1.daa", "NRC_Intercept101.daa"] {
        fs::copy(flown.join(name), place.join("data/flown").join(name)).unwrap();
    }
    let arguments = [
        "league",
        "--data",
        "data",
        "--sets",
        "flown-1hz",
        "--policy",
        "none",
        "--policy",
        "turn-aware",
    ];
    let done = fga_in(place, &arguments);
    assert!(done.status.success(), "{}", errors(&done));
    let standings = rows(&place.join("out/league/league.csv"));
    for column in ["nmac_nominal", "lowc_nominal"] {
        assert_eq!(standings[0][column], standings[1][column]);
    }
    assert_eq!(standings[0]["lowc"], standings[0]["lowc_nominal"]);
    assert_eq!(standings[0]["encounters"], "2");
}
