//! `fga campaign` with aircraft: recordings and encounter models as sources, the counts, the
//! safety case, and the messages about unusable sources.

use core::fmt::Write as _;
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};

use crate::support::{columns, errors, fga_in, rows};

const MODEL: &str = include_str!("../../../fga-campaign/tests/models/uncorrelated.txt");

const CAMPAIGN: &str =
    "name = 'aircraft'\npolicies = ['none', 'turn-aware']\nvehicle = 'ga.toml'\n";

const VEHICLE: &str = include_str!("../../../../vehicles/general-aviation.toml");

/// Two aircraft that meet head-on after 60 s at 50 m/s each, with these miss distances.
fn head_on(aside_m: f64, above_m: f64) -> String {
    let mut text = String::from(
        "NAME, sx, sy, sz, vx, vy, vz, time\n[none], [m], [m], [m], [m/s], [m/s], [m/s], [s]\n",
    );
    for second in 0..=90 {
        let along_m = f64::from(second) * 50.0;
        let _ = writeln!(text, "own, {along_m}, 0, 1000, 50, 0, 0, {second}");
        let (x, z) = (6000.0 - along_m, 1000.0 + above_m);
        let _ = writeln!(text, "its, {x}, {aside_m}, {z}, -50, 0, 0, {second}");
    }
    text
}

/// A folder with a campaign, a vehicle, a model, and recordings: an NMAC, a loss of well clear, a
/// pass well clear.
pub(crate) fn written() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("recorded.toml"), CAMPAIGN).unwrap();
    let model = "[[model]]\nfile = 'm.txt'\ncpa_s = 60\nduration_s = 80\n";
    fs::write(
        at.join("modeled.toml"),
        format!("{CAMPAIGN}encounters = 40\nseeds = [5]\n{model}"),
    )
    .unwrap();
    fs::write(at.join("ga.toml"), VEHICLE).unwrap();
    fs::write(at.join("m.txt"), MODEL).unwrap();
    fs::create_dir(at.join("flights")).unwrap();
    for (name, aside_m, above_m) in [
        ("a-nmac", 50.0, 10.0),
        ("b-lowc", 400.0, 60.0),
        ("c-clear", 100.0, 300.0),
    ] {
        fs::write(
            at.join(format!("flights/{name}.daa")),
            head_on(aside_m, above_m),
        )
        .unwrap();
    }
    fs::write(at.join("flights/README"), "not a recording").unwrap();
    folder
}

const RECORDED: [&str; 5] = [
    "campaign",
    "run",
    "recorded.toml",
    "--recordings",
    "flights",
];
pub(crate) const MODELED: [&str; 3] = ["campaign", "run", "modeled.toml"];

pub(crate) fn run(at: &Path, command: &[&str], more: &[&str]) {
    let output = fga_in(at, &[command, more].concat());
    assert!(output.status.success(), "{}", errors(&output));
}

fn bytes(at: &Path, out: &str) -> Vec<u8> {
    fs::read(at.join(out).join("results.parquet")).unwrap()
}

/// A single flight of a recording is judged as in a campaign, number for number.
#[test]
fn one_flight_has_the_numbers_of_the_standards_too() {
    let folder = written();
    let at = folder.path();
    run(at, &RECORDED, &["--csv", "--out", "out"]);
    for row in rows(&at.join("out/results.csv")) {
        let recording = format!("flights/{}.daa", row["name"]);
        let flight = ["run", &recording, "--vehicle", "ga.toml", "--json"];
        let output = fga_in(at, &[&flight[..], &["--policy", &row["policy"]]].concat());
        let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let standards = summary["standards"].as_object().unwrap();
        assert!(standards.len() > 20, "{standards:?}");
        for (name, value) in standards {
            let shown = &row[name];
            let is_same = match value {
                serde_json::Value::Null => shown.is_empty(),
                serde_json::Value::Number(number) => shown.parse().ok() == number.as_f64(),
                serde_json::Value::Bool(flag) => shown.parse().ok() == Some(*flag),
                other => panic!("{name}: {other}"),
            };
            assert!(
                is_same,
                "{recording}, {}, {name}: {value} {shown}",
                row["policy"]
            );
        }
    }
}

#[test]
fn recordings_are_judged_as_worked_out_by_hand() {
    let folder = written();
    let at = folder.path();
    run(at, &RECORDED, &["--csv", "--out", "out"]);
    let rows = rows(&at.join("out/results.csv"));
    let found: Vec<(&str, &str, &str, &str)> = rows
        .iter()
        .map(|row| {
            (
                row["name"].as_str(),
                row["policy"].as_str(),
                row["nominal_nmac"].as_str(),
                row["nominal_lowc"].as_str(),
            )
        })
        .collect();
    assert_eq!(
        found,
        [
            ("a-nmac", "none", "true", "true"),
            ("a-nmac", "turn-aware", "true", "true"),
            ("b-lowc", "none", "false", "true"),
            ("b-lowc", "turn-aware", "false", "true"),
            ("c-clear", "none", "false", "false"),
            ("c-clear", "turn-aware", "false", "false"),
        ]
    );
    let number = |row: &std::collections::HashMap<String, String>, name: &str| -> f64 {
        row[name]
            .parse()
            .unwrap_or_else(|_| panic!("{name}: {:?}", row[name]))
    };
    for (row, (aside_m, above_m)) in
        rows.iter()
            .step_by(2)
            .zip([(50.0, 10.0), (400.0, 60.0), (100.0, 300.0)])
    {
        assert!((number(row, "nominal_horizontal_m") - aside_m).abs() < 1e-6);
        assert!((number(row, "nominal_vertical_m") - above_m).abs() < 1e-6);
        assert!((number(row, "horizontal_m") - aside_m).abs() < 1e-6);
        assert!((number(row, "cpa_s") - 60.0).abs() < 1e-6);
        assert!((number(row, "closing_mps") - 100.0).abs() < 1e-6);
        assert!((number(row, "crossing_deg") - 180.0).abs() < 1e-6);
        assert_eq!(row["nmac"], row["nominal_nmac"]);
        assert_eq!(
            (row["weight"].as_str(), row["action_s"].as_str()),
            ("1.000000", "")
        );
    }
    // DO-365B alerts once straight lines lose well clear (0.66 nmi, τ 35 s) within 55 s: about 90 s
    // before the closest approach, so at once here.
    assert!(number(&rows[0], "corrective_s") > 55.0);
    // A flight that avoids the NMAC volume of the vehicle file has no NMAC.
    assert_eq!(rows[1]["nmac"], "false");
    assert!(number(&rows[1], "action_s") > 0.0 && number(&rows[1], "changes") >= 1.0);
    let risk = columns(&at.join("out/risk.csv"));
    assert_eq!(risk["encounters"][0], 3.0);
    let text = fs::read_to_string(at.join("out/risk.csv")).unwrap();
    assert!(text.contains("none,all,nmac,3,3.0,1,1,0,"), "{text}");
    assert!(text.contains("turn-aware,all,nmac,3,3.0,1,0,0,"), "{text}");
    assert!(text.contains("none,head-on,lowc,3,3.0,2,2,0,"), "{text}");
}

#[test]
fn the_same_bytes_on_one_and_two_threads_in_parts_and_resumed() {
    let folder = written();
    let at = folder.path();
    for (name, command) in [("r", &RECORDED[..]), ("m", &MODELED[..])] {
        let out = |kind: &str| format!("{name}-{kind}");
        run(at, command, &["--threads", "1", "--out", &out("one")]);
        run(
            at,
            command,
            &["--threads", "2", "--out", &out("two"), "--resume"],
        );
        // One block alone is a whole part; the other part is empty.
        run(at, command, &["--shard", "1/2", "--out", &out("a")]);
        run(at, command, &["--shard", "2/2", "--out", &out("b")]);
        let merge = ["campaign", "merge", &out("a"), &out("b")];
        run(at, &merge, &["--out", &out("merged")]);
        let one = bytes(at, &out("one"));
        assert_eq!(one, bytes(at, &out("two")), "{name}");
        assert_eq!(one, bytes(at, &out("merged")), "{name}");
        let risks = ["one", "two", "merged"]
            .map(|kind| fs::read(at.join(out(kind)).join("risk.csv")).unwrap());
        assert_eq!(risks[0], risks[1]);
        assert_eq!(risks[0], risks[2]);
        // A complete folder can be resumed.
        run(at, command, &["--out", &out("one"), "--resume"]);
        assert_eq!(one, bytes(at, &out("one")));
    }
}

#[test]
fn damaged_recordings_are_named_and_the_rest_is_flown() {
    let folder = written();
    let at = folder.path();
    let damaged = head_on(0.0, 0.0).replace("50, 0, 0, 7\n", "50, 0, x, 7\n");
    fs::write(at.join("flights/b-damaged.daa"), damaged).unwrap();
    let output = fga_in(
        at,
        &[&RECORDED[..], &["--policy", "none", "--out", "out"]].concat(),
    );
    assert_eq!(output.status.code(), Some(1));
    let said = errors(&output);
    assert!(said.contains("left out: "), "{said}");
    assert!(
        said.contains("b-damaged.daa, line 17: column vz holds \"x\""),
        "{said}"
    );
    assert!(
        said.contains("1 of 4 recordings cannot be used and were left out"),
        "{said}"
    );
    assert!(at.join("out/results.parquet").is_file());
    run(
        at,
        &RECORDED,
        &["--policy", "none", "--skip-damaged", "--out", "skipped"],
    );
    assert_eq!(bytes(at, "out"), bytes(at, "skipped"));
}

#[test]
fn wrong_sources_are_refused_in_one_sentence() {
    let folder = written();
    let at = folder.path();
    fs::create_dir(at.join("empty")).unwrap();
    fs::create_dir(at.join("bad")).unwrap();
    fs::write(at.join("bad/a.daa"), "hello\n").unwrap();
    fs::write(at.join("bad/b.daa"), "hello\n").unwrap();
    let with = |name: &str, table: &str| {
        let text = format!("{CAMPAIGN}encounters = 4\n[[model]]\n{table}\n");
        fs::write(at.join(name), text).unwrap();
    };
    with("nofile.toml", "");
    with("share.toml", "file = 'm.txt'\naimed_share = 1.0");
    with("missing.toml", "file = 'missing.txt'");
    with(
        "never.toml",
        "file = 'm.txt'\nintruder_speed_mps = [300, 400]",
    );
    fs::write(
        at.join("missing.txt"),
        MODEL.replace("# N_transition", "# M_transition"),
    )
    .unwrap();
    let cases: [(&[&str], &str); 8] = [
        (
            &["recorded.toml", "--recordings", "empty"],
            "empty: holds no recordings, expected files that end in .daa",
        ),
        (
            &["recorded.toml", "--recordings", "gone"],
            "gone: cannot be read: there is no such file or folder",
        ),
        (
            &["recorded.toml", "--recordings", "bad"],
            "bad: holds 2 recordings, of which none can be used",
        ),
        (
            &["recorded.toml"],
            "recorded.toml: the grid is empty, expected",
        ),
        (
            &["nofile.toml"],
            "nofile.toml, line 5: the model has no file, expected the key file, or --model FILE",
        ),
        (
            &["share.toml"],
            "share.toml, line 5: aimed_share is 1, expected 0 to 0.99",
        ),
        (
            &["missing.toml"],
            "missing.txt: section N_transition is missing, expected it",
        ),
        (
            &["never.toml", "--out", "never"],
            "none of 100000 draws suits altitude_m, ownship_speed_mps and intruder_speed_mps",
        ),
    ];
    for (arguments, message) in cases {
        let output = fga_in(at, &[&["campaign", "run"], arguments].concat());
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        let said = errors(&output);
        assert!(said.contains(message), "{said}\n{message}");
    }
    run(at, &RECORDED, &["--policy", "none", "--out", "out"]);
    fs::write(at.join("flights/a-nmac.daa"), head_on(0.0, 0.0)).unwrap();
    let output = fga_in(at, &["campaign", "show", "out", "--encounter", "0"]);
    assert!(errors(&output).contains("is not the file that the campaign was begun with"));
}

#[test]
fn the_safety_case_is_one_page_with_its_replays() {
    let folder = written();
    let at = folder.path();
    run(at, &RECORDED, &["--out", "out"]);
    run(at, &["campaign", "report", "out"], &["--worst", "2"]);
    let page = fs::read_to_string(at.join("out/report.html")).unwrap();
    for part in [
        "Safety case: aircraft",
        "second-hand",
        "1. Result",
        "2. Conditions and sensor",
        "3. Encounters",
        "4. Metrics",
        "6. Convergence",
        "7. Limitations",
        "recordings_are_judged_as_worked_out_by_hand",
        "0 of 1 NMAC are left with turn-aware",
        "0 of 1",
        "stress set",
        "<svg",
    ] {
        assert!(page.contains(part), "{part}");
    }
    let links: Vec<PathBuf> = page
        .split("href=\"worst/")
        .skip(1)
        .map(|rest| at.join("out/worst").join(rest.split('"').next().unwrap()))
        .collect();
    assert!(!links.is_empty());
    for link in links {
        assert!(link.is_file(), "{}", link.display());
    }
    assert!(!page.contains("<script") && !page.contains("src=\"http"));
    // A campaign of families has no safety case.
    let text = "policies = ['none']\nencounters = 2\ncells = ['wall']\n";
    fs::write(at.join("cells.toml"), text).unwrap();
    run(at, &["campaign", "run", "cells.toml"], &["--out", "cells"]);
    let output = fga_in(at, &["campaign", "report", "cells"]);
    assert!(
        errors(&output)
            .contains("has no encounters of aircraft, expected a campaign with recordings")
    );
}

/// The rates follow from the shares, and scale with the density; recordings stand for no volume of traffic.
#[test]
fn losses_in_a_flight_hour_need_a_density_and_an_uncorrelated_model() {
    let folder = written();
    let at = folder.path();
    run(at, &["campaign", "run", "modeled.toml"], &["--out", "out"]);
    let encounters_per_h = |density: &str| -> f64 {
        let more = [
            "--worst",
            "0",
            "--traffic-per-km3",
            density,
            "--traffic-source",
            "a count",
        ];
        run(at, &["campaign", "report", "out"], &more);
        let page = fs::read_to_string(at.join("out/report.html")).unwrap();
        assert!(page.contains("Losses in a flight hour"));
        let rest = page.split("as given by a count: ").nth(1).unwrap();
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    let (one, ten) = (encounters_per_h("1"), encounters_per_h("10"));
    assert!(one > 0.0 && (ten / one - 10.0).abs() < 1e-3, "{one} {ten}");
    run(at, &["campaign", "report", "out"], &["--worst", "0"]);
    let page = fs::read_to_string(at.join("out/report.html")).unwrap();
    assert!(!page.contains("Losses in a flight hour"));
    run(at, &RECORDED, &["--out", "flown"]);
    for (folder, density, what) in [
        (
            "flown",
            "1",
            "needs encounters of uncorrelated models alone",
        ),
        ("out", "-1", "expected above 0"),
        ("out", "many", "expected a number"),
    ] {
        let option = format!("--traffic-per-km3={density}");
        let output = fga_in(at, &["campaign", "report", folder, &option]);
        assert_eq!(output.status.code(), Some(1), "{density}");
        assert!(errors(&output).contains(what), "{}", errors(&output));
    }
}

/// A policy that ends at once in every flight. Where the file `armed` is, it kills the campaign in flight 300: in the second block.
const KILLS: &str = "#!/bin/sh
if [ -e armed ]; then
  echo flight >> armed
  if [ $(wc -l < armed) = 300 ]; then rm armed; kill -9 $PPID; fi
fi
exit 1
";

/// Killed in the middle (no handler runs), resumed, and in parts of which one was killed too: the same bytes.
#[test]
fn a_campaign_of_models_that_was_killed_goes_on_to_the_same_bytes() {
    let folder = written();
    let at = folder.path();
    fs::write(at.join("kills.sh"), KILLS).unwrap();
    fs::set_permissions(at.join("kills.sh"), fs::Permissions::from_mode(0o755)).unwrap();
    let count = ["--encounters", "600", "--policy", "pipe:./kills.sh"];
    let whole = [&MODELED[..], &count, &["--out", "whole"]].concat();
    run(at, &whole, &[]);
    let killed = |out: &str, shard: &[&str]| {
        let command = [
            &MODELED[..],
            &count,
            &["--threads", "1", "--out", out],
            shard,
        ]
        .concat();
        fs::write(at.join("armed"), "").unwrap();
        let output = fga_in(at, &command);
        assert_eq!(output.status.signal(), Some(9), "{}", errors(&output));
        let blocks = fs::read_dir(at.join(out).join("blocks")).unwrap();
        let names = blocks.map(|entry| entry.unwrap().file_name());
        let finished = names.filter(|name| name.to_string_lossy().starts_with("block-"));
        assert_eq!(finished.count(), 1);
        run(at, &command, &["--resume"]);
    };
    killed("killed", &[]);
    assert_eq!(bytes(at, "whole"), bytes(at, "killed"));
    killed("first", &["--shard", "1/2"]);
    let second = [&MODELED[..], &count, &["--shard", "2/2", "--out", "second"]].concat();
    run(at, &second, &[]);
    run(
        at,
        &["campaign", "merge", "first", "second", "--out", "merged"],
        &[],
    );
    assert_eq!(bytes(at, "whole"), bytes(at, "merged"));
    for file in ["risk.csv", "convergence.csv"] {
        let text = |out: &str| fs::read_to_string(at.join(out).join(file)).unwrap();
        assert_eq!(text("whole"), text("killed"), "{file}");
        assert_eq!(text("whole"), text("merged"), "{file}");
    }
}

/// Two sources instead of the vehicle's: what neither can see nobody avoids.
#[test]
fn sources_of_a_campaign_limit_what_its_policies_know() {
    let folder = written();
    let at = folder.path();
    let with = |name: &str, tables: &str| {
        fs::write(at.join(name), format!("{CAMPAIGN}{tables}")).unwrap();
        let command = ["campaign", "run", name, "--recordings", "flights"];
        fga_in(
            at,
            &[
                &command[..],
                &["--csv", "--out", name.trim_end_matches(".toml")],
            ]
            .concat(),
        )
    };
    let radar = "[[sensor]]\nname = 'radar'\nrange_m = 20.0\n";
    let receiver = |share: f64| {
        format!(
            "[[sensor]]\nname = 'receiver'\nequipped_share = {share:?}\nupdate_rate_hz = 1.0\nposition_sigma_m = 10.0\n\
             altitude_sigma_m = 8.0\nvelocity_sigma_mps = 1.0\nposition_bias_m = 20.0\naltitude_bias_m = 10.0\n\
             dropouts_per_min = 1.0\ndropout_s = 3.0\ncoast_s = 5.0\ndelay_s = 0.5\ndetection_probability = 0.9\ntracked = true\n"
        )
    };
    let blind = with("blind.toml", &format!("{radar}{}", receiver(0.0)));
    assert!(blind.status.success(), "{}", errors(&blind));
    let seeing = with("seeing.toml", &format!("{radar}{}", receiver(1.0)));
    assert!(seeing.status.success(), "{}", errors(&seeing));
    let lost = |out: &str| -> Vec<String> {
        rows(&at.join(out).join("results.csv"))
            .iter()
            .filter(|row| row["policy"] == "turn-aware")
            .map(|row| row["nmac"].clone())
            .collect()
    };
    assert_eq!(lost("blind"), ["true", "false", "false"]);
    assert_eq!(lost("seeing"), ["false", "false", "false"]);
    let report = fga_in(at, &["campaign", "report", "seeing"]);
    assert!(report.status.success(), "{}", errors(&report));
    let page = fs::read_to_string(at.join("seeing/report.html")).unwrap();
    assert!(page.contains("sensor receiver") && page.contains("lasting errors 20 m and 10 m"));
    let wrong = with("wrong.toml", "[[sensor]]\nequipped_share = 2.0\n");
    assert_eq!(wrong.status.code(), Some(1));
    let said = errors(&wrong);
    assert!(
        said.contains("wrong.toml, line 4: equipped_share is 2, expected 0 to 1"),
        "{said}"
    );
}

/// The airspeed of a straight ownship comes from its range, and every speed of it happens.
#[test]
fn ownship_speeds_are_drawn_from_their_range() {
    let folder = written();
    let at = folder.path();
    let model = "[[model]]\nfile = 'm.txt'\ncpa_s = 60\nduration_s = 80\nownship_speed_mps = [15.0, 60.0]\n";
    let text = format!("{CAMPAIGN}encounters = 60\nseeds = [5]\n{model}");
    fs::write(at.join("speeds.toml"), text).unwrap();
    let command = ["campaign", "run", "speeds.toml", "--policy", "none"];
    run(at, &command, &["--csv", "--out", "out"]);
    let speeds = &columns(&at.join("out/results.csv"))["ownship_mps"];
    assert_eq!(speeds.len(), 60);
    assert!(speeds.iter().all(|speed| (15.0..=60.0).contains(speed)));
    let slow = speeds.iter().filter(|speed| **speed < 30.0).count();
    let fast = speeds.iter().filter(|speed| **speed > 45.0).count();
    assert!(slow > 5 && fast > 10, "{slow} slow, {fast} fast");
}

/// Weights that mean nothing are refused, and so is a unit nobody knows.
#[test]
fn weights_and_units_that_mean_nothing_are_refused() {
    let folder = written();
    let at = folder.path();
    for weight in ["0", "-1", "NaN", "inf", "much"] {
        let text = format!("fga_weight = {weight}\n{}", head_on(50.0, 10.0));
        fs::write(at.join("flights/b-lowc.daa"), text).unwrap();
        let output = fga_in(at, &[&RECORDED[..], &["--out", "weights"]].concat());
        assert_eq!(output.status.code(), Some(1));
        let said = errors(&output);
        let expected =
            format!("b-lowc.daa: fga_weight is \"{weight}\", expected a positive number");
        assert!(said.contains(&expected), "{said}");
        assert!(said.contains("1 of 3 recordings cannot be used"), "{said}");
        fs::remove_dir_all(at.join("weights")).unwrap();
    }
    fs::write(at.join("c.conf"), "lookahead_time = 180 [fortnight]\n").unwrap();
    fs::write(at.join("one.daa"), head_on(0.0, 0.0)).unwrap();
    for command in ["alerts", "bands"] {
        let output = fga_in(
            at,
            &[command, "one.daa", "--config", "c.conf", "--out", "out"],
        );
        assert_eq!(output.status.code(), Some(1));
        let said = errors(&output);
        assert!(
            said.contains("c.conf") && said.contains("fortnight"),
            "{said}"
        );
        assert_eq!(said.lines().count(), 1, "{said}");
    }
}
