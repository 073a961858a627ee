//! Every experiment, small: it ends, prints one row for each cell, and known results hold.

use std::process::Command;

fn experiment(arguments: &[&str]) -> Vec<String> {
    let output = Command::new(env!("CARGO_BIN_EXE_fga-experiments"))
        .args(arguments)
        .output()
        .expect("the program starts");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {errors}");
    let text = String::from_utf8(output.stdout).expect("text");
    text.lines().map(str::to_owned).collect()
}

#[test]
fn the_default_policy_loses_nothing_that_the_oracle_saves() {
    let cells = ["threats:2:300:15-30", "threats:3:100-500:0-15,planar"];
    let rows = experiment(&[&["lost", "11", "40"][..], &cells].concat());
    assert_eq!(rows.len(), 4, "{rows:?}");
    assert!(rows[3].starts_with("all: 0 lost of "), "{rows:?}");
}

#[test]
fn a_policy_that_only_flies_its_mission_loses_what_the_oracle_saves() {
    let rows = experiment(&["lost", "11", "5", "threats:1:300:0-15", "--policy", "none"]);
    assert!(
        rows.last().expect("a row").starts_with("all: 5 lost of 5"),
        "{rows:?}"
    );
}

#[test]
fn an_intruder_that_turns_is_judged_from_its_turn_on() {
    let rows = experiment(&[
        "lost",
        "11",
        "20",
        "threats:2:300:15-30,planar",
        "--turning",
    ]);
    let counts: Vec<u32> = rows[1]
        .split(',')
        .filter_map(|field| field.parse().ok())
        .take(3)
        .collect();
    assert_eq!(counts.iter().sum::<u32>(), 20, "{rows:?}");
}

#[test]
fn departures_robustness_and_baselines_print_their_rows() {
    let cell = "threats:1:300:15-30";
    for mode in ["compare", "oracle", "latest"] {
        assert_eq!(experiment(&["departures", mode, "3", "4", cell]).len(), 2);
    }
    let needless = experiment(&["departures", "needless", "3", "20"]);
    for row in &needless {
        assert!(
            row.contains("20 flown, 0 manoeuvred [], 0 entered"),
            "{row}"
        );
    }
    assert_eq!(experiment(&["robustness", "3", "4", cell]).len(), 3);
    assert!(experiment(&["baselines", "orca", "1"]).len() > 20);
}

#[test]
fn a_wrong_cell_is_one_sentence() {
    let output = Command::new(env!("CARGO_BIN_EXE_fga-experiments"))
        .args(["lost", "1", "1", "threads:1"])
        .output()
        .expect("the program starts");
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(errors.lines().count(), 1, "{errors}");
}

#[test]
fn no_flight_over_ground_and_among_zones_goes_wrong_where_the_oracle_saves_it() {
    let rows = experiment(&["ground", "40"]);
    let all = rows.last().expect("a row");
    assert!(all.starts_with("all: flown 40, "), "{rows:?}");
    let right = "into the ground 0, below the clearance 0, over unknown ground 0, on the wrong side of a zone 0;";
    assert!(all.contains(right), "{rows:?}");
    assert!(all.contains("of them avoidable 0"), "{rows:?}");
}

#[test]
fn no_margin_is_certified_that_another_program_does_not_fly() {
    let rows = experiment(&["certificates", "2000"]);
    assert!(
        rows.last().expect("a row").starts_with("0 of 2000 "),
        "{rows:?}"
    );
}

#[test]
fn in_corridors_no_fence_is_left_and_every_aircraft_comes_back() {
    let rows = experiment(&["corridors", "25", "1"]);
    let counts: Vec<&String> = rows.iter().filter(|row| !row.starts_with(' ')).collect();
    assert_eq!(counts.len(), 3, "{rows:?}");
    for row in counts {
        let is_kept =
            row.contains("fence left 0,") && row.contains("backwards for more than 30 s 0;");
        assert!(is_kept && row.ends_with("not ended 0"), "{row}");
    }
}
