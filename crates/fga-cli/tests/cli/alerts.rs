//! `fga alerts` and `fga bands`: the reference's outputs, and wrong input.

use core::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::support::{data, errors, fga_in};

/// One alerter.
pub(crate) const CONFIGURATION: &str = "lookahead_time = 180.0 [s]
corrective_region = NEAR
alerters = A
A_alert_1_region = NEAR
A_alert_1_alerting_time = 60.0 [s]
A_alert_1_detector = det_1
A_det_1_D = 2000 [ft]
A_det_1_H = 250 [ft]
A_load_core_detection_det_1 = CDCylinder
";

const RECORDING: &str = "NAME, sx, sy, sz, vx, vy, vz, time
[none], [m], [m], [ft], [knot], [knot], [fpm], [s]
own, 0, 0, 1000, 0, 60, 0, 0
other, 0, 3000, 1000, 0, -60, 0, 0
";

/// Whether `diff` finds two files equal.
fn diff(a: &Path, b: &Path) -> bool {
    let output = Command::new("diff").arg(a).arg(b).output();
    output.expect("diff is installed").status.success()
}

#[test]
fn tables_of_h1_equal_the_reference_by_diff() {
    let (Some(recording), Some(configuration), Some(alerts), Some(bands)) = (
        data("daidalus/H1.daa"),
        data("daidalus/DO_365B_no_SUM.conf"),
        data("daidalus/gold/DaidalusqAlerting-no_sum.csv"),
        data("daidalus/gold/DaidalusBatch-no_sum.out"),
    ) else {
        return;
    };
    // The first line of the bands holds the file's name as given.
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path().join("C++");
    fs::create_dir(&here).unwrap();
    fs::create_dir(folder.path().join("Scenarios")).unwrap();
    fs::copy(recording, folder.path().join("Scenarios/H1.daa")).unwrap();
    let configuration = configuration.canonicalize().unwrap();
    let configuration = configuration.to_str().unwrap();
    for command in ["alerts", "bands"] {
        let output = fga_in(
            &here,
            &[
                command,
                "../Scenarios/H1.daa",
                "--config",
                configuration,
                "--out",
                "out",
            ],
        );
        assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    }
    assert!(diff(&here.join("out/alerts.csv"), &alerts));
    assert!(diff(&here.join("out/bands.out"), &bands));
}

#[test]
fn a_cylinder_alerts_when_its_time_has_come() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.daa"), RECORDING).unwrap();
    fs::write(folder.path().join("c.conf"), CONFIGURATION).unwrap();
    let output = fga_in(
        folder.path(),
        &["alerts", "a.daa", "--config", "c.conf", "--out", "o"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    let table = fs::read_to_string(folder.path().join("o/alerts.csv")).unwrap();
    let row: Vec<&str> = table.lines().nth(2).unwrap().split(", ").collect();
    // 3000 m − 609.6 m at 120 kn.
    let expected_s = (3000.0 - 609.6) / (120.0 * 1852.0 / 3600.0);
    assert_eq!(row[4], "1", "38.7 s are within 60 s");
    assert!((row[5].parse::<f64>().unwrap() - expected_s).abs() < 1e-5);
}

#[test]
fn wrong_input_is_one_sentence_and_exit_code_1() {
    let folder = tempfile::tempdir().unwrap();
    let one_only = RECORDING
        .lines()
        .filter(|line| !line.starts_with("other"))
        .collect::<Vec<_>>()
        .join("\n");
    let cases = [
        (
            RECORDING.to_owned(),
            format!("{CONFIGURATION}lookahead = 3 [s]\n"),
            "c.conf, line 10: the key lookahead is unknown",
        ),
        (
            RECORDING.to_owned(),
            CONFIGURATION.replace("2000 [ft]", "2000 [furlong]"),
            "c.conf, line 7: A_det_1_D has the unknown unit \"furlong\", expected a length unit",
        ),
        (
            RECORDING.to_owned(),
            CONFIGURATION.replace("180.0 [s]", "180.0 [ft]"),
            "c.conf, line 1: lookahead_time has the unit \"ft\" of a length, expected a time unit",
        ),
        (RECORDING.to_owned(), String::new(), "c.conf: is empty"),
        (String::new(), CONFIGURATION.to_owned(), "a.daa: is empty"),
        (
            one_only,
            CONFIGURATION.to_owned(),
            "a.daa: holds one aircraft only",
        ),
        (
            RECORDING.replace("3000", "NaN"),
            CONFIGURATION.to_owned(),
            "a.daa, line 4: column sy holds \"NaN\", expected a finite number",
        ),
    ];
    for (recording, configuration, expected) in cases {
        fs::write(folder.path().join("a.daa"), recording).unwrap();
        fs::write(folder.path().join("c.conf"), configuration).unwrap();
        for command in ["alerts", "bands"] {
            let output = fga_in(
                folder.path(),
                &[command, "a.daa", "--config", "c.conf", "--out", "o"],
            );
            assert_eq!(output.status.code(), Some(1));
            let message = errors(&output);
            assert!(message.contains(expected), "{message}");
            assert_eq!(message.lines().count(), 1, "{message}");
        }
    }
}

#[test]
fn the_replay_page_shows_alerts_and_bands_where_a_configuration_is_given() {
    let mut recording = String::from(
        "NAME, sx, sy, sz, vx, vy, vz, time\n[none], [m], [m], [m], [m/s], [m/s], [m/s], [s]\n",
    );
    for second in 0..=60 {
        let along_m = 50.0 * f64::from(second);
        let _ = writeln!(recording, "own, 0, {along_m}, 1000, 0, 50, 0, {second}");
        let ahead_m = 8000.0 - along_m;
        let _ = writeln!(recording, "other, 0, {ahead_m}, 1000, 0, -50, 0, {second}");
    }
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("r.daa"), recording).unwrap();
    fs::write(at.join("c.conf"), CONFIGURATION).unwrap();
    let page = |more: &[&str]| {
        let vehicle = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../vehicles/general-aviation.toml"
        );
        let command = [
            "run",
            "r.daa",
            "--policy",
            "none",
            "--vehicle",
            vehicle,
            "--out",
            "out",
        ];
        fga_in(at, &[&command, more].concat());
        let page = fs::read_to_string(at.join("out/replay.html")).unwrap();
        let (_, data) = page.split_once("id=\"data\">").unwrap();
        let (data, _) = data.split_once("</script>").unwrap();
        serde_json::from_str::<serde_json::Value>(data).unwrap()
    };
    assert!(page(&[])["runs"][0]["guidance"].is_null());
    let run = &page(&["--config", "c.conf"])["runs"][0];
    assert_eq!(run["levels"], 1);
    let records = run["guidance"].as_array().unwrap();
    // The volume of 2,000 ft is violated in 60 s from 6,609.6 m on, 13.9 s after the begin.
    let rose_s = records.iter().find(|record| record["level"] == 1).unwrap()["t"].as_f64();
    assert!((13.8..15.2).contains(&rose_s.unwrap()), "{rose_s:?}");
    let later = records
        .iter()
        .find(|record| record["t"].as_f64() > Some(25.0))
        .unwrap();
    // North lies in a band that is near (3).
    let directions = later["bands"][0].as_array().unwrap();
    assert_eq!(directions[0][0], 0.0);
    assert_eq!(directions[0][2], 3, "{directions:?}");
    assert_eq!(later["who"][0][1], 1);
}
