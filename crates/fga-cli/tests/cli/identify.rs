//! `fga identify`: a log in, a vehicle file out.

use core::fmt::Write as _;
use std::fs;

use crate::support::{data, errors, fga_in};
use serde_json::Value;

/// Steps of the bank that a plant follows after 0.3 s with a time constant of 0.6 s.
fn log() -> String {
    let mut text = "t_s,airspeed_mps,bank_command_rad,bank_rad,course_rad,climb_rad\n".to_owned();
    let command = |step: usize| {
        let banks: [f64; 6] = [0.0, 30.0, 0.0, -30.0, 20.0, -20.0];
        banks[step / 6000 % 6].to_radians()
    };
    let (mut bank, mut course) = (0.0_f64, 0.0_f64);
    for step in 0..48_000_usize {
        if step % 50 == 0 {
            let time_s = step as f64 / 1000.0;
            let climb = 0.1 * (time_s / 5.0).sin();
            writeln!(
                text,
                "{time_s},20,{},{bank},{course},{climb}",
                command(step)
            )
            .unwrap();
        }
        bank += (command(step.saturating_sub(300)) - bank) / 0.6 / 1000.0;
        course += 0.9 * 9.80665 * bank.tan() / 20.0 / 1000.0;
    }
    text
}

#[test]
fn a_log_becomes_a_vehicle_file_that_can_be_used() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    fs::write(here.join("steps.csv"), log()).unwrap();
    let output = fga_in(
        here,
        &[
            "identify",
            "steps.csv",
            "--out",
            "v.toml",
            "--json",
            "--radius-m",
            "40",
        ],
    );
    assert!(output.status.success(), "{}", errors(&output));
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    let figure = |name: &str| answer["figures"][name]["value"].as_f64().unwrap();
    assert!((figure("dead_time_s") - 0.3).abs() < 0.06, "{answer}");
    assert!(
        (figure("bank_time_constant_s") - 0.6).abs() < 0.06,
        "{answer}"
    );
    assert!((figure("turn_rate_factor") - 0.9).abs() < 0.02, "{answer}");
    assert_eq!(answer["file"], "v.toml");
    let checked = fga_in(here, &["check", "v.toml"]);
    assert!(checked.status.success(), "{}", errors(&checked));
    let printed = fga_in(here, &["identify", "steps.csv", "--radius-m", "40"]);
    assert_eq!(printed.stdout, fs::read(here.join("v.toml")).unwrap());
    let figures = fga_in(here, &["identify", "steps.csv", "--json"]);
    let shown: Value = serde_json::from_slice(&figures.stdout).unwrap();
    assert_eq!(shown["figures"], answer["figures"]);
    assert!(shown["file"].is_null(), "{shown}");
}

#[test]
fn a_log_that_cannot_be_used_is_one_sentence_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    fs::write(
        here.join("level.csv"),
        log().lines().take(115).collect::<Vec<_>>().join("\n"),
    )
    .unwrap();
    fs::write(here.join("steps.csv"), log()).unwrap();
    for (arguments, expected) in [
        (vec!["none.bin"], "none.bin: cannot be read"),
        (
            vec!["level.csv"],
            "fga: level.csv: has 0 windows of 6 s in which",
        ),
        (
            vec!["steps.csv", "--radius-m", "-1"],
            "fga: radius_m is -1, expected a positive number",
        ),
        (
            vec!["steps.csv", "--half-height-m", "nan"],
            "fga: half_height_m is NaN, expected a positive number",
        ),
    ] {
        let arguments = [vec!["identify", "--out", "v.toml"], arguments].concat();
        let output = fga_in(here, &arguments);
        assert_eq!(output.status.code(), Some(1));
        let said = errors(&output);
        assert!(
            said.contains(expected) && said.lines().count() == 1,
            "{said}"
        );
    }
    assert!(!here.join("v.toml").exists());
}

#[test]
fn a_telemetry_log_of_one_row_a_second_is_refused_with_its_rate() {
    let Some(log) = data("trials/rates-never-asked.tlog.gz") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let output = fga_in(
        folder.path(),
        &["identify", log.canonicalize().unwrap().to_str().unwrap()],
    );
    assert_eq!(output.status.code(), Some(1));
    assert!(
        errors(&output)
            .contains("has the commanded bank every 1.000 s (NAV_CONTROLLER_OUTPUT.nav_roll), expected it at least every 0.25 s"),
        "{}",
        errors(&output)
    );
}
