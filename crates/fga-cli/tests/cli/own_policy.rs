//! Policies of one's own over a pipe: flown as any other, and a failure is said where it happened.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;

use crate::support::{encounters, errors, fga_in, repository, rows};

/// Writes a policy: a shell program whose loop has each situation in `$line`.
fn policy(folder: &Path, name: &str, body: &str) -> String {
    let path = folder.join(name);
    let text = format!("#!/bin/sh\nwhile read -r line; do\n{body}\ndone\n");
    fs::write(&path, text).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    format!("pipe:./{name}")
}

/// Fails where an encounter has a third obstacle, by this line of the shell; else it flies the mission.
fn failing(how: &str) -> String {
    format!("case \"$line\" in *'\"id\":2,'*) {how} ;; *) echo '{{}}' ;; esac")
}

fn folder_with(encounters_count: u32) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("e.csv"), encounters(encounters_count, 7)).unwrap();
    folder
}

/// The lines of `results.csv` without the last column of a policy of one's own.
fn results(folder: &Path, out: &str) -> Vec<String> {
    let text = fs::read_to_string(folder.join(out).join("results.csv")).unwrap();
    let is_own = text.lines().next().unwrap().ends_with(",policy_failure");
    let cut = |line: &str| match line.rsplit_once(',') {
        Some((rest, _)) if is_own => rest.to_owned(),
        _ => line.to_owned(),
    };
    text.lines().map(cut).collect()
}

#[test]
fn a_program_that_leaves_the_mission_alone_flies_as_the_policy_none() {
    let folder = folder_with(30);
    let own = policy(folder.path(), "idle.sh", "echo '{}'");
    for (policy, out) in [("none", "none"), (own.as_str(), "own")] {
        let arguments = ["batch", "e.csv", "--policy", policy, "--out", out];
        let done = fga_in(folder.path(), &arguments);
        assert!(done.status.success(), "{}", errors(&done));
    }
    assert_eq!(
        results(folder.path(), "none"),
        results(folder.path(), "own")
    );
}

#[test]
fn a_policy_that_fails_is_said_for_that_encounter_and_the_others_go_on() {
    let folder = folder_with(12);
    let place = folder.path();
    let none = fga_in(
        place,
        &["batch", "e.csv", "--policy", "none", "--out", "none"],
    );
    assert!(none.status.success());
    let third = fs::read_to_string(place.join("e.csv")).unwrap();
    let has_third = |encounter: &str| third.contains(&format!("\n{encounter},2,"));
    for (name, how, kind) in [
        ("end.sh", "exit 3", "ended"),
        ("shape.sh", "echo left", "wrong-shape"),
        ("number.sh", "echo '{\"course_rad\": NaN}'", "not-finite"),
        ("large.sh", "echo '{\"course_rad\": 1e999}'", "not-finite"),
    ] {
        let own = policy(place, name, &failing(how));
        for threads in ["1", "2"] {
            let arguments = [
                "batch",
                "e.csv",
                "--policy",
                &own,
                "--out",
                "own",
                "--threads",
                threads,
            ];
            let done = fga_in(place, &arguments);
            assert!(done.status.success(), "{}", errors(&done));
            let said = errors(&done);
            assert!(said.contains(&format!("policy {own} failed in")), "{said}");
            // From a failure on the mission is flown.
            assert_eq!(results(place, "own"), results(place, "none"));
            let flown = rows(&place.join("own/results.csv"));
            assert!(flown.iter().any(|row| row["policy_failure"].is_empty()));
            for row in &flown {
                let expected = if has_third(&row["encounter"]) {
                    kind
                } else {
                    ""
                };
                assert_eq!(
                    row["policy_failure"], expected,
                    "{name} {}",
                    row["encounter"]
                );
            }
        }
    }
}

#[test]
fn a_policy_that_hangs_is_ended_at_its_time_limit() {
    let folder = folder_with(2);
    let place = folder.path();
    // The first step has the time that a program takes to start.
    let hangs = "case \"$line\" in *'\"begins\"'*) echo '{}' ;; *) exec sleep 1000 ;; esac";
    policy(place, "hang.sh", hangs);
    let own = "pipe@0.05:./hang.sh";
    let done = fga_in(place, &["batch", "e.csv", "--policy", own, "--out", "own"]);
    assert!(done.status.success(), "{}", errors(&done));
    assert!(
        errors(&done).contains("no answer within 0.05 s"),
        "{}",
        errors(&done)
    );
    for row in rows(&place.join("own/results.csv")) {
        assert_eq!(row["policy_failure"], "timed-out");
    }
}

#[test]
fn a_campaign_flies_a_program_and_goes_on_with_the_same_one_only() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let own = policy(place, "turn.sh", &failing("exit 1"));
    let file = "policies = [\"none\"]\ncells = [\"threats:3:300:15-30\"]\nencounters = 40\n";
    fs::write(place.join("c.toml"), file).unwrap();
    let run = |out: &str, more: &[&str]| {
        let mut arguments = vec![
            "campaign", "run", "c.toml", "--csv", "--policy", &own, "--policy", "none",
        ];
        arguments.extend(["--out", out]);
        arguments.extend(more);
        fga_in(place, &arguments)
    };
    for (out, threads) in [("one", "1"), ("two", "2")] {
        let done = run(out, &["--threads", threads]);
        assert!(done.status.success(), "{}", errors(&done));
    }
    let bytes = |out: &str| fs::read(place.join(out).join("results.parquet")).unwrap();
    assert_eq!(bytes("one"), bytes("two"));
    let flown = rows(&place.join("one/results.csv"));
    for row in &flown {
        let expected = if row["policy"] == own { "ended" } else { "" };
        assert_eq!(row["policy_failure"], expected);
    }
    let shown = [
        "campaign",
        "show",
        "one",
        "--encounter",
        "3",
        "--out",
        "shown",
    ];
    let done = fga_in(place, &shown);
    assert!(done.status.success(), "{}", errors(&done));
    let summary = fs::read_to_string(place.join("shown/run.json")).unwrap();
    assert!(
        summary.contains("\"policy_failure\": \"ended\""),
        "{summary}"
    );
    // Results of another program are not taken for its own.
    policy(place, "turn.sh", "echo '{}'");
    let done = run("one", &["--resume"]);
    assert_eq!(done.status.code(), Some(1));
    assert!(errors(&done).contains("own_sha256"), "{}", errors(&done));
    let done = fga_in(place, &shown);
    assert_eq!(done.status.code(), Some(1));
    assert!(
        errors(&done).contains("another program for pipe:./turn.sh"),
        "{}",
        errors(&done)
    );
}

#[test]
fn the_example_flies_as_its_twin_in_rust_would() {
    let folder = tempfile::tempdir().unwrap();
    let root = repository();
    let own = format!("pipe:{}", root.join("examples/give_way.py").display());
    let scenario = root.join("scenarios/first-flight.toml");
    let done = fga_in(
        folder.path(),
        &[
            "run",
            scenario.to_str().unwrap(),
            "--policy",
            &own,
            "--json",
        ],
    );
    assert!(done.status.success(), "{}", errors(&done));
    let summary: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(summary["separated"], true);
    assert!(summary.get("policy_failure").is_none(), "{summary}");
}

#[test]
fn a_program_that_is_not_there_is_one_sentence() {
    let folder = folder_with(1);
    for (own, what) in [
        ("pipe:./nowhere", "there is no program \"./nowhere\""),
        ("pipe:", "names no program"),
        ("pipe@zero:cat", "time limit of \"zero\""),
    ] {
        let done = fga_in(folder.path(), &["batch", "e.csv", "--policy", own]);
        assert_eq!(done.status.code(), Some(1), "{own}");
        assert!(errors(&done).contains(what), "{}", errors(&done));
        assert_eq!(errors(&done).lines().count(), 1);
    }
}
