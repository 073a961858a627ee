//! `fga batch` and `fga oracle` on aircraft with tracks: folders of recordings, what `fga campaign draw` writes,
//! and damaged files.

use core::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::support::{columns, errors, fga_in};

const MODEL: &str = include_str!("../../../fga-campaign/tests/models/uncorrelated.txt");

const VEHICLE: &str = include_str!("../../../../vehicles/general-aviation.toml");

/// Two aircraft head-on at 50 m/s each, `apart_m` from each other at the start, with these miss distances.
fn head_on(apart_m: f64, aside_m: f64, above_m: f64) -> String {
    let mut text = String::from(
        "NAME, sx, sy, sz, vx, vy, vz, time\n[none], [m], [m], [m], [m/s], [m/s], [m/s], [s]\n",
    );
    for second in 0..=90 {
        let along_m = f64::from(second) * 50.0;
        let _ = writeln!(text, "own, {along_m}, 0, 1000, 50, 0, 0, {second}");
        let (x, z) = (apart_m - along_m, 1000.0 + above_m);
        let _ = writeln!(text, "its, {x}, {aside_m}, {z}, -50, 0, 0, {second}");
    }
    text
}

/// A folder with recordings, a campaign of a model, and an aircraft with a noisy sensor.
fn written() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::create_dir(at.join("flights")).unwrap();
    for (name, recording) in [
        ("a-near", head_on(6000.0, 50.0, 10.0)),
        ("b-wide", head_on(6000.0, 400.0, 60.0)),
        ("c-late", head_on(400.0, 0.0, 0.0)),
    ] {
        fs::write(at.join(format!("flights/{name}.daa")), recording).unwrap();
    }
    fs::write(at.join("ga.toml"), VEHICLE).unwrap();
    let noisy = "\n[noise]\nposition_m = 15.0\nvelocity_mps = 1.0\n";
    fs::write(at.join("noisy.toml"), format!("{VEHICLE}{noisy}")).unwrap();
    fs::write(at.join("m.txt"), MODEL).unwrap();
    let model = "[[model]]\nfile = 'm.txt'\ncpa_s = 60\nduration_s = 80\n";
    let campaign = "policies = ['none', 'turn-aware']\nvehicle = 'noisy.toml'\n";
    fs::write(
        at.join("modeled.toml"),
        format!("{campaign}encounters = 12\nseeds = [5]\n{model}"),
    )
    .unwrap();
    fs::write(at.join("again.toml"), campaign).unwrap();
    folder
}

fn run(at: &Path, command: &[&str]) {
    let output = fga_in(at, command);
    assert!(output.status.success(), "{command:?}: {}", errors(&output));
}

fn text(at: &Path, file: &str) -> String {
    fs::read_to_string(at.join(file)).unwrap()
}

/// Signed distance to the cylinder of the vehicle file, 152.4 m and ±30.48 m.
fn margin(aside_m: f64, above_m: f64) -> f64 {
    let (wall, face) = (aside_m - 152.4, above_m - 30.48);
    if wall > 0.0 && face > 0.0 {
        wall.hypot(face)
    } else {
        wall.max(face)
    }
}

#[test]
fn a_folder_of_recordings_gives_a_row_for_each_with_its_name() {
    let folder = written();
    let at = folder.path();
    let batch = ["batch", "flights", "--vehicle", "ga.toml"];
    run(
        at,
        &[&batch[..], &["--policy", "none", "--out", "none"]].concat(),
    );
    let rows: Vec<Vec<String>> = text(at, "none/results.csv")
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect();
    assert_eq!(rows[0].last().unwrap(), "name");
    let names: Vec<&str> = rows[1..].iter().map(|row| row[9].as_str()).collect();
    assert_eq!(names, ["a-near", "b-wide", "c-late"]);
    let margins = &columns(&at.join("none/results.csv"))["min_margin_m"];
    let by_hand = [margin(50.0, 10.0), margin(400.0, 60.0), margin(0.0, 0.0)];
    for (found, expected) in margins.iter().zip(by_hand) {
        assert!((found - expected).abs() < 1e-3, "{found} {expected}");
    }
    for (out, threads) in [("one", "1"), ("two", "2")] {
        run(
            at,
            &[
                &batch[..],
                &["--threads", threads, "--out", out, "--replay", "1"],
            ]
            .concat(),
        );
    }
    assert_eq!(text(at, "one/results.csv"), text(at, "two/results.csv"));
    let margins = &columns(&at.join("one/results.csv"))["min_margin_m"];
    assert!(margins[0] >= 0.0 && margins[1] > 200.0 && margins[2] < 0.0);
    // The worst of them has its page.
    assert!(at.join("one/replay/2.html").is_file());
    // One file stands for itself, and a horizon ends its flight.
    let one = ["batch", "flights/a-near.daa", "--horizon", "20"];
    run(
        at,
        &[&one[..], &["--policy", "none", "--out", "short"]].concat(),
    );
    let margins = &columns(&at.join("short/results.csv"))["min_margin_m"];
    // 4,000 m apart after 20 s.
    let expected = (4000.0_f64.hypot(50.0)) - 152.4;
    assert!((margins[0] - expected).abs() < 1.0, "{margins:?}");
}

#[test]
fn a_damaged_recording_is_named_and_counted_and_the_rest_is_flown() {
    let folder = written();
    let at = folder.path();
    let damaged = head_on(6000.0, 0.0, 0.0).replace("-50, 0, 0, 7\n", "-50, 0, x, 7\n");
    fs::write(at.join("flights/b-damaged.daa"), damaged).unwrap();
    for command in ["batch", "oracle"] {
        let strict = [
            command,
            "flights",
            "--vehicle",
            "ga.toml",
            "--out",
            "strict",
        ];
        let output = fga_in(at, &strict);
        let said = errors(&output);
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(
            said.contains("left out: flights/b-damaged.daa, line 18: column vz holds \"x\""),
            "{said}"
        );
        assert!(
            said.contains("1 of 4 recordings cannot be used and were left out"),
            "{said}"
        );
        let lax = [command, "flights", "--vehicle", "ga.toml", "--out", "lax"];
        run(at, &[&lax[..], &["--skip-damaged"]].concat());
        let file = if command == "batch" {
            "results"
        } else {
            "oracle"
        };
        let rows = text(at, &format!("strict/{file}.csv"));
        assert_eq!(rows.lines().count(), 4);
        assert_eq!(rows, text(at, &format!("lax/{file}.csv")));
    }
    // Alone it is the error itself.
    let output = fga_in(at, &["batch", "flights/b-damaged.daa"]);
    assert_eq!(output.status.code(), Some(1));
    let said = errors(&output);
    assert!(
        said.starts_with("fga: flights/b-damaged.daa, line 18"),
        "{said}"
    );
}

/// Everything but where an encounter comes from.
fn results(at: &Path, file: &str, without: &[&str]) -> Vec<Vec<String>> {
    let text = text(at, file);
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines
        .map(|line| {
            names
                .iter()
                .zip(line.split(','))
                .filter(|(name, _)| !without.contains(name))
                .map(|(_, field)| field.to_owned())
                .collect()
        })
        .collect()
}

#[test]
fn what_was_drawn_flies_again_with_the_same_result() {
    let folder = written();
    let at = folder.path();
    run(
        at,
        &["campaign", "run", "modeled.toml", "--csv", "--out", "flown"],
    );
    run(at, &["campaign", "draw", "modeled.toml", "--out", "drawn"]);
    let origin = ["source", "source_encounter", "name"];
    let flown = results(at, "flown/results.csv", &origin);
    assert_eq!(flown.len(), 24);
    // Seeds, weights and sensor noise are those of the draw, to the last digit.
    for drawn in ["drawn", "drawn/tracks.parquet", "drawn/recordings"] {
        let again = ["campaign", "run", "again.toml", "--recordings", drawn];
        run(at, &[&again[..], &["--csv", "--out", "again"]].concat());
        assert_eq!(flown, results(at, "again/results.csv", &origin), "{drawn}");
        fs::remove_dir_all(at.join("again")).unwrap();
    }
    let shown = columns(&at.join("flown/results.csv"));
    let batch = [
        "batch",
        "drawn",
        "--vehicle",
        "noisy.toml",
        "--out",
        "batch",
    ];
    run(at, &batch);
    let batch = columns(&at.join("batch/results.csv"));
    for column in ["min_margin_m", "max_cross_track_m", "extra_path_m"] {
        let expected: Vec<f64> = shown[column].iter().skip(1).step_by(2).copied().collect();
        assert_eq!(expected, batch[column], "{column}");
    }
    // A second draw into the folder replaces the first one.
    let fewer = ["campaign", "draw", "modeled.toml", "--encounters", "3"];
    run(at, &[&fewer[..], &["--out", "drawn"]].concat());
    assert_eq!(
        fs::read_dir(at.join("drawn/recordings")).unwrap().count(),
        3
    );
}

/// Drawn files had neither, so that what was drawn flew in still air and as if positions were exact.
#[test]
fn wind_and_deviations_of_a_recording_are_drawn_with_it() {
    let folder = written();
    let at = folder.path();
    let mut windy = String::from(
        "NAME, sx, sy, sz, vx, vy, vz, time, heading, airspeed, s_EW_std, s_NS_std, s_EN_std, sz_std, \
         v_EW_std, v_NS_std, v_EN_std, vz_std\n\
         [none], [m], [m], [m], [m/s], [m/s], [m/s], [s], [deg], [m/s], [m], [m], [m], [m], [m/s], [m/s], \
         [m/s], [m/s]\n",
    );
    for second in 0..=90 {
        let along_m = f64::from(second) * 50.0;
        // Wind that veers a little; one row does not know it.
        let air = if second == 3 {
            "-, -".to_owned()
        } else {
            format!("{}, 47.3", 83.1 + 0.01 * f64::from(second))
        };
        let still = "0, 0, 0, 0, 0, 0, 0, 0";
        let _ = writeln!(
            windy,
            "own, {along_m}, 0, 1000, 50, 0, 0, {second}, {air}, {still}"
        );
        let x_m = 6000.0 - along_m;
        let known = "91.7, 70.3, -12.1, 20, 1.3, 1.1, 0.3, 0.7";
        let _ = writeln!(
            windy,
            "its, {x_m}, 50, 1010, -50, 0, 0, {second}, -, -, {known}"
        );
    }
    fs::create_dir(at.join("windy")).unwrap();
    fs::write(at.join("windy/one.daa"), windy).unwrap();
    let recorded = |folder: &str, out: &str| {
        let command = ["campaign", "run", "again.toml", "--recordings", folder];
        run(at, &[&command[..], &["--csv", "--out", out]].concat());
        results(
            at,
            &format!("{out}/results.csv"),
            &["source", "source_encounter", "name", "seed"],
        )
    };
    let flown = recorded("windy", "flown");
    let draw = ["campaign", "draw", "again.toml", "--recordings", "windy"];
    run(at, &[&draw[..], &["--out", "drawn"]].concat());
    for (index, drawn) in ["drawn/tracks.parquet", "drawn/recordings"]
        .iter()
        .enumerate()
    {
        assert_eq!(flown, recorded(drawn, &format!("again{index}")), "{drawn}");
    }
    // Both count: in still air, or with exact positions, it flies otherwise.
    let text = text(at, "drawn/recordings/00000000.daa");
    let header = text.lines().find(|line| line.starts_with("NAME")).unwrap();
    for names in [["air_vx", "heading"], ["s_EW_std", "s_NS_std"]] {
        let mut without = header.to_owned();
        for name in names {
            without = without.replace(name, &format!("no-{name}"));
        }
        fs::create_dir(at.join(names[0])).unwrap();
        fs::write(
            at.join(names[0]).join("one.daa"),
            text.replace(header, &without),
        )
        .unwrap();
        assert_ne!(
            flown,
            recorded(names[0], &format!("without-{}", names[0])),
            "{names:?}"
        );
    }
}

#[test]
fn obstacles_around_a_line_are_drawn_as_parquet_too() {
    let folder = written();
    let at = folder.path();
    let cells = "policies = ['turn-aware']\nencounters = 6\ncells = ['threats:2:300:5-20']\n";
    fs::write(at.join("cells.toml"), cells).unwrap();
    run(at, &["campaign", "draw", "cells.toml", "--out", "drawn"]);
    for (input, out) in [
        ("drawn/encounters.csv", "csv"),
        ("drawn/encounters.parquet", "parquet"),
        ("drawn", "folder"),
    ] {
        run(at, &["batch", input, "--out", out]);
        assert_eq!(
            text(at, "csv/results.csv"),
            text(at, &format!("{out}/results.csv"))
        );
    }
    let files = "policies = ['turn-aware']\nfiles = ['drawn/encounters.parquet']\n";
    fs::write(at.join("files.toml"), files).unwrap();
    run(
        at,
        &["campaign", "run", "files.toml", "--csv", "--out", "files"],
    );
    run(
        at,
        &["campaign", "run", "cells.toml", "--csv", "--out", "cells"],
    );
    let origin = ["source", "source_encounter", "seed"];
    assert_eq!(
        results(at, "cells/results.csv", &origin),
        results(at, "files/results.csv", &origin)
    );
}

/// An intruder passes at 100 m after 60 s, turns back and passes at 10 m after 200 s. An earlier version judged only the
/// second meeting.
#[test]
fn the_oracle_begins_before_the_first_of_two_losses() {
    let mut text = String::from(
        "NAME, sx, sy, sz, vx, vy, vz, time\n[none], [m], [m], [m], [m/s], [m/s], [m/s], [s]\n",
    );
    for second in 0..=240 {
        let time_s = f64::from(second);
        let _ = writeln!(text, "own, {}, 0, 1000, 50, 0, 0, {second}", 50.0 * time_s);
        // Towards the ownship at 50 m/s, then after it at 93 m/s, and always level with it.
        let (x, y, vx) = if time_s < 90.0 {
            (6000.0 - 50.0 * time_s, 100.0, -50.0)
        } else {
            (10_000.0 + 92.8 * (time_s - 200.0), 10.0, 92.8)
        };
        let _ = writeln!(text, "its, {x}, {y}, 1000, {vx}, 0, 0, {second}");
    }
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::create_dir(at.join("flights")).unwrap();
    fs::write(at.join("flights/twice.daa"), text).unwrap();
    fs::write(at.join("ga.toml"), VEHICLE).unwrap();
    run(
        at,
        &["oracle", "flights", "--vehicle", "ga.toml", "--out", "out"],
    );
    let answer = self::text(at, "out/oracle.csv");
    let row: Vec<&str> = answer.lines().nth(1).unwrap().split(',').collect();
    let start_s: f64 = row[4].parse().unwrap();
    assert!((17.0..20.0).contains(&start_s), "{answer}");
}

/// Two aircraft that meet after 60 s can stay apart; two that are 400 m apart and head-on at 100 m/s cannot, even
/// for who knows how the other will fly.
#[test]
fn the_oracle_judges_tracks_and_says_what_it_knows_of_them() {
    let folder = written();
    let at = folder.path();
    run(
        at,
        &["oracle", "flights", "--vehicle", "ga.toml", "--out", "out"],
    );
    let rows: Vec<Vec<String>> = text(at, "out/oracle.csv")
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect();
    assert_eq!(
        rows[0],
        [
            "encounter",
            "avoidable",
            "best_margin_m",
            "name",
            "start_s",
            "knows"
        ]
    );
    let judged: Vec<&str> = rows[1..].iter().map(|row| row[1].as_str()).collect();
    assert_eq!(judged, ["true", "true", "false"]);
    // The search begins two thirds of its 60 s before the first loss, or before the closest approach at 60 s.
    let starts: Vec<&str> = rows[1..].iter().map(|row| row[4].as_str()).collect();
    assert_eq!(starts, ["19.000", "20.000", "0.000"]);
    assert!(rows[1..].iter().all(|row| row[5] == "whole tracks"));
    // A campaign asks the same.
    let campaign = ["campaign", "run", "again.toml", "--recordings", "flights"];
    let more = [
        "--vehicle",
        "ga.toml",
        "--oracle",
        "--csv",
        "--out",
        "asked",
    ];
    run(at, &[&campaign[..], &more].concat());
    let asked = results(at, "asked/results.csv", &[]);
    let header = text(at, "asked/results.csv");
    let place = header
        .split(',')
        .position(|name| name == "avoidable")
        .unwrap();
    let judged: Vec<&str> = asked.iter().map(|row| row[place].as_str()).collect();
    assert_eq!(judged, ["true", "true", "true", "true", "false", "false"]);
}

#[test]
fn folders_and_tables_that_are_no_encounters_are_refused_in_one_sentence() {
    let folder = written();
    let at = folder.path();
    fs::create_dir(at.join("empty")).unwrap();
    fs::write(at.join("empty/notes.md"), "nothing").unwrap();
    fs::create_dir(at.join("both")).unwrap();
    for name in ["encounters.parquet", "tracks.parquet"] {
        fs::write(at.join("both").join(name), "PAR1").unwrap();
    }
    for (input, expected) in [
        ("empty", "holds no recordings, expected files that end in"),
        (
            "both",
            "holds obstacles around a line as well as aircraft with tracks",
        ),
        ("both/tracks.parquet", "is no readable Parquet file"),
        ("missing", "cannot be read"),
    ] {
        for command in ["batch", "oracle"] {
            let output = fga_in(at, &[command, input, "--out", "out"]);
            let said = errors(&output);
            assert_eq!(output.status.code(), Some(1), "{input}: {said}");
            assert!(said.contains(expected), "{input}: {said}");
            assert_eq!(said.lines().count(), 1, "{said}");
        }
    }
}
