//! `--json`: every command with an answer on standard output prints one JSON value.

use std::fs;
use std::path::Path;

use crate::support::{errors, fga_in};
use serde_json::Value;

const ENCOUNTERS: &str = "encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m
1,0,300,0,0,-15,0,0,30
2,0,300,200,0,0,-10,0,30
";

const RECORDING: &str = "NAME, sx, sy, sz, vx, vy, vz, time
[none], [m], [m], [ft], [knot], [knot], [fpm], [s]
own, 0, 0, 1000, 0, 60, 0, 0
other, 0, 3000, 1000, 0, -60, 0, 0
";

const CONFIGURATION: &str = "alerters = A
A_alert_1_region = NEAR
A_alert_1_alerting_time = 60.0 [s]
A_alert_1_detector = det_1
A_det_1_D = 2000 [ft]
A_det_1_H = 250 [ft]
A_load_core_detection_det_1 = CDCylinder
";

/// Standard output as JSON; the command ends with code 0.
fn answer(folder: &Path, arguments: &[&str]) -> Value {
    let output = fga_in(folder, arguments);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{arguments:?}: {}",
        errors(&output)
    );
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{arguments:?}: {error}: {:?}", output.stdout))
}

#[test]
fn every_answer_is_json_where_json_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("e.csv"), ENCOUNTERS).unwrap();
    for kind in ["scenario", "campaign", "vehicle"] {
        assert_eq!(answer(at, &["init", kind, "--json"])["kind"], kind);
    }
    assert_eq!(answer(at, &["check", "e.csv", "--json"])["usable"], true);
    assert_eq!(answer(at, &["batch", "e.csv", "--json"])["separated"], 2);
    assert_eq!(answer(at, &["oracle", "e.csv", "--json"])["avoidable"], 2);
    let flown = answer(at, &["run", "scenario.toml", "--json", "--out", "flown"]);
    assert_eq!(flown["separated"], true);
    let exported = answer(at, &["export", "flown", "--format", "kml", "--json"]);
    assert_eq!(exported["files"][0], "flown/flight.kml");
    let part = |part, out| {
        let arguments = ["--encounters", "6", "--shard", part, "--out", out, "--json"];
        answer(
            at,
            &[&["campaign", "run", "campaign.toml"][..], &arguments].concat(),
        )
    };
    assert_eq!(part("1/2", "a")["complete"], true);
    part("2/2", "b");
    let merged = answer(
        at,
        &["campaign", "merge", "a", "b", "--out", "ab", "--json"],
    );
    assert_eq!(merged["rows"][0]["encounters"], 6);
    let shown = ["campaign", "show", "ab", "--encounter", "3", "--json"];
    assert!(answer(at, &shown)["end_s"].is_number());
}

#[test]
fn alerts_and_bands_answer_in_json() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("r.daa"), RECORDING).unwrap();
    fs::write(at.join("c.conf"), CONFIGURATION).unwrap();
    for command in ["alerts", "bands"] {
        let answer = answer(at, &[command, "r.daa", "--config", "c.conf", "--json"]);
        assert_eq!(answer["instants"], 1, "{command}");
    }
}
