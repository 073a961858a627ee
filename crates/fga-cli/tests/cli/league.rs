//! `fga league`: one page about every policy, the same bytes again, resumable, open to a program of one's own.

use core::fmt::Write as _;
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::Command;

use crate::support::{data, errors, fga_in, interrupt, rows};

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
    // The default policy counts its work; what is not known is empty, not 0.
    let standings = rows(&place.join("one/league.csv"));
    let works = standings.iter().map(|row| &row["work_most"]);
    let [none, default, mvp] = works.collect::<Vec<_>>()[..] else {
        panic!("three policies");
    };
    assert!(none.is_empty() && mvp.is_empty());
    assert!(default.parse::<f64>().unwrap() > 100.0, "{default}");
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
    // A changed program under the same name makes the league fly again.
    for (body, fails) in [("echo '{}'", false), ("exit 1", true)] {
        write(body);
        let done = league(place, "out", &policies);
        assert!(done.status.success(), "{}", errors(&done));
        let standings = rows(&place.join("out/league.csv"));
        assert_eq!(standings.len(), 2);
        let failed = if fails { "24" } else { "0" };
        let told = errors(&done).contains("policy pipe:./own.sh failed in ");
        assert_eq!(told, fails, "{}", errors(&done));
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
    // Read, this file looks well; opened with the policies it cannot be flown.
    let straight = "policies = [\"none\"]\ncells = [\"head-on:300:30\"]\nintruders = \"orca\"\n";
    fs::write(folder.path().join("straight.toml"), straight).unwrap();
    let model = "data/encounter-models/uncor_1200only_fwse_v1p2.txt";
    fs::create_dir_all(folder.path().join("data/encounter-models")).unwrap();
    fs::write(folder.path().join(model), "no model").unwrap();
    for (arguments, what) in [
        (&["--sets", "lunar"][..], "there is no set \"lunar\""),
        (&["--sets", "drawn-1hz,lunar"], "there is no set \"lunar\""),
        (
            &["--sets", "drawn-1hz,drawn-1hz"],
            "set drawn-1hz is named twice",
        ),
        (&["--sets", "none.toml", "--policy", "none"], "none.toml"),
        (&["--sets", "drawn-1hz,none.toml"], "none.toml"),
        (
            &["--sets", "drawn-1hz,straight.toml"],
            "expected recordings or a model alone",
        ),
        (
            &["--sets", "fleet-1hz,low-altitude-1hz", "--data", "data"],
            "uncor_1200only_fwse_v1p2.txt",
        ),
        (&["--encounters", "-5"], "expected a whole number from 1"),
        (&["--policy", "nobody"], "unknown policy \"nobody\""),
        (
            &["--policy", "orca", "--policy", "orca"],
            "policy orca is named twice",
        ),
        (&["--data", "nowhere"], "is no folder"),
        (
            &["--intruders", "nobody"],
            "arduplane-rules, pipe:PROGRAM, or itself",
        ),
        (
            &["--intruders", "orca", "--intruders", "orca"],
            "intruders orca are named twice",
        ),
        (
            &["--intruders", "itself", "--intruders", "itself"],
            "intruders itself are named twice",
        ),
    ] {
        let done = fga_in(folder.path(), &[&["league"], arguments].concat());
        assert_eq!(done.status.code(), Some(1), "{arguments:?}");
        assert!(errors(&done).contains(what), "{}", errors(&done));
        assert_eq!(errors(&done).lines().count(), 1, "{}", errors(&done));
        assert!(!folder.path().join("out").exists(), "{arguments:?}");
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

/// Two recordings in which light aircraft meet head-on at 56 m/s, level, a row a second: 50 m and 5 km aside.
fn meetings(folder: &Path) {
    fs::create_dir_all(folder).unwrap();
    for (name, aside_m) in [("near.daa", 50.0), ("far.daa", 5000.0)] {
        let mut text =
            "NAME, sx, sy, sz, vx, vy, vz, time\n[none], [m], [m], [m], [m/s], [m/s], [m/s], [s]\n"
                .to_owned();
        for time_s in 0..=140 {
            let flown_m = 56.0 * f64::from(time_s);
            let _ = writeln!(text, "own, {flown_m}, 0, 600, 56, 0, 0, {time_s}");
            let other_m = 7840.0 - flown_m;
            let _ = writeln!(
                text,
                "other, {other_m}, {aside_m}, 600, -56, 0, 0, {time_s}"
            );
        }
        fs::write(folder.join(name), text).unwrap();
    }
}

#[test]
fn intruders_react_and_the_page_sets_policies_against_reactions() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    meetings(&place.join("data/flown"));
    let arguments = |out: &'static str| {
        let mut all = vec![
            "league",
            "--data",
            "data",
            "--sets",
            "flown,drawn-1hz",
            "--out",
            out,
        ];
        all.extend(["--encounters", "10", "--worst", "1"]);
        all.extend(["--policy", "none", "--policy", "turn-aware"]);
        all.extend(["--intruders", "right-of-way", "--intruders", "turn-aware"]);
        all
    };
    let done = fga_in(place, &arguments("one"));
    assert!(done.status.success(), "{}", errors(&done));
    assert!(errors(&done).contains("drawn-1hz with reactions: its obstacles fly straight"));
    let standings = rows(&place.join("one/league.csv"));
    let of = |intruders: &str, policy: &str, column: &str| -> u64 {
        let row = standings.iter().find(|row| {
            row["set"] == "flown" && row["intruders"] == intruders && row["policy"] == policy
        });
        row.unwrap()[column].parse().unwrap()
    };
    // What happens if neither does anything is the same for all.
    for intruders in ["none", "right-of-way", "turn-aware"] {
        for policy in ["none", "turn-aware"] {
            assert_eq!(of(intruders, policy, "nmac_nominal"), 1);
            assert_eq!(of(intruders, policy, "encounters"), 2);
        }
    }
    assert_eq!(of("none", "none", "nmac"), 1);
    for (intruders, policy) in [
        ("right-of-way", "none"),
        ("turn-aware", "none"),
        ("none", "turn-aware"),
        ("right-of-way", "turn-aware"),
        ("turn-aware", "turn-aware"),
    ] {
        assert_eq!(of(intruders, policy, "nmac"), 0, "{intruders} {policy}");
    }
    let page = fs::read_to_string(place.join("one/league.html")).unwrap();
    for what in [
        "Policies against reactions",
        "flown, intruders right-of-way",
        "react by the policy right-of-way",
    ] {
        assert!(page.contains(what), "{what}");
    }
    // The page shows the flight that the league counted.
    let shown = fga_in(
        place,
        &[
            "campaign",
            "show",
            "one/flown+right-of-way/none",
            "--encounter",
            "1",
            "--out",
            "shown",
            "--json",
        ],
    );
    assert!(shown.status.success(), "{}", errors(&shown));
    let again = fga_in(place, &arguments("two"));
    assert!(again.status.success(), "{}", errors(&again));
    assert_eq!(files(&place.join("one")), files(&place.join("two")));
}

/// A fleet of which nobody does anything loses well clear; one that flies the default policy does less often.
#[test]
fn a_fleet_flies_one_policy_and_every_replay_has_two() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let arguments = |out: &'static str, threads: &'static str| {
        let mut all = vec![
            "league",
            "--sets",
            "fleet-1hz",
            "--encounters",
            "6",
            "--out",
            out,
        ];
        all.extend([
            "--policy",
            "none",
            "--policy",
            "turn-aware",
            "--policy",
            "mvp",
        ]);
        all.extend([
            "--intruders",
            "itself",
            "--worst",
            "1",
            "--threads",
            threads,
        ]);
        all
    };
    for (out, threads) in [("one", "1"), ("two", "2")] {
        let done = fga_in(place, &arguments(out, threads));
        assert!(done.status.success(), "{}", errors(&done));
    }
    assert_eq!(files(&place.join("one")), files(&place.join("two")));
    let standings = rows(&place.join("one/league.csv"));
    assert_eq!(standings.len(), 3);
    for row in &standings {
        assert_eq!(
            (row["intruders"].as_str(), row["encounters"].as_str()),
            ("itself", "6")
        );
        assert_eq!(row["lowc_nominal"], standings[0]["lowc_nominal"]);
    }
    let lost = |place: usize| standings[place]["lowc"].parse::<u64>().unwrap();
    assert_eq!(standings[0]["lowc"], standings[0]["lowc_nominal"]);
    assert!(lost(1) < lost(0), "{} of {}", lost(1), lost(0));
    let page = fs::read_to_string(place.join("one/league.html")).unwrap();
    assert!(
        page.contains("react by the policy of the row")
            && page.contains("stand for what drew them")
    );
    // The default policy has the first other one that acts beside it; the others have the default one.
    for (policy, both) in [
        ("turn-aware", ["turn-aware", "mvp"]),
        ("mvp", ["mvp", "turn-aware"]),
    ] {
        let worst = place
            .join("one/fleet-1hz+itself")
            .join(policy)
            .join("worst");
        let replay = fs::read_dir(worst).unwrap().next().unwrap().unwrap().path();
        let text = fs::read_to_string(replay).unwrap();
        for name in both {
            assert!(
                text.contains(&format!("\"name\":\"{name}\"")),
                "{policy}: {name}"
            );
        }
    }
    // Times are kept with each campaign: a league that goes on still has all of them.
    let timed = fs::read_to_string(place.join("one/timing.csv")).unwrap();
    let again = fga_in(place, &arguments("one", "2"));
    assert!(again.status.success(), "{}", errors(&again));
    assert_eq!(
        fs::read_to_string(place.join("one/timing.csv")).unwrap(),
        timed
    );
    assert_eq!(timed.lines().count(), 4, "{timed}");
}

#[test]
fn a_campaign_with_reactions_says_what_it_cannot_fly() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    meetings(&place.join("flights"));
    let campaign = |text: &str| {
        let text = format!("policies = [\"none\"]\n{text}\n");
        fs::write(place.join("mine.toml"), text).unwrap();
        fga_in(place, &["campaign", "run", "mine.toml", "--out", "out"])
    };
    for (text, what) in [
        (
            "intruders = \"nobody\"\nrecordings = [\"flights\"]",
            "mine.toml, line 2: intruders: unknown policy",
        ),
        (
            "intruders = \"orca\"\ncells = [\"wall-gap\"]",
            "obstacles that fly straight",
        ),
        (
            "intruders = 3\nrecordings = [\"flights\"]",
            "mine.toml, line 2",
        ),
    ] {
        let done = campaign(text);
        assert_eq!(done.status.code(), Some(1), "{}", errors(&done));
        assert!(errors(&done).contains(what), "{}", errors(&done));
        assert_eq!(errors(&done).lines().count(), 1, "{}", errors(&done));
    }
    let done = campaign("intruders = \"see-and-avoid\"\nrecordings = [\"flights\"]");
    assert!(done.status.success(), "{}", errors(&done));
}

/// Ctrl-C while the recording of a set is read, which comes through a pipe: one is enough.
#[test]
fn an_interrupt_ends_a_league_that_reads() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let set = "policies = [\"none\"]\nrecordings = [\"slow.daa\"]\n";
    fs::write(at.join("set.toml"), set).unwrap();
    let pipe = at.join("slow.daa");
    let made = Command::new("mkfifo").arg(&pipe).status();
    assert!(made.is_ok_and(|status| status.success()));
    let mut running = Command::new(env!("CARGO_BIN_EXE_fga"))
        .current_dir(at)
        .args(["league", "--sets", "set.toml", "--policy", "none"])
        .spawn()
        .unwrap();
    // It opens once the program reads.
    let recording = fs::OpenOptions::new().write(true).open(&pipe).unwrap();
    interrupt(&running);
    // A program that goes on comes to the end of the recording.
    drop(recording);
    assert_eq!(running.wait().unwrap().signal(), Some(2));
}
