//! `fga run`: scenarios, recordings, exit codes and wrong input.

use std::fs;
use std::path::Path;

use crate::support::{columns, data, decisions_follow_their_schema, errors, fga_in, repository};

const MAST: &str = "name = 'past-a-mast'
duration_s = 60.0
[mission]
waypoints_m = [[0, 0, 100], [600, 0, 100]]
[[obstacle]]
name = 'mast'
position_m = [300, 5, 100]
";

fn summary(output: &std::process::Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).expect("JSON on standard output")
}

#[test]
fn a_scenario_is_flown_and_everything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mast.toml"), MAST).unwrap();
    let output = fga_in(folder.path(), &["run", "mast.toml", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    let summary = summary(&output);
    assert_eq!(summary["separated"], true);
    assert!(summary["min_separation_m"].as_f64().unwrap() >= 30.0);
    assert!(
        summary["obstacles"][0]["min_separation_m"]
            .as_f64()
            .unwrap()
            >= 30.0
    );
    assert!(summary["rejoined_s"].is_number());
    // Without --out the results are in out/<name of the input>.
    let out = folder.path().join("out/mast");
    let track = columns(&out.join("track.csv"));
    assert_eq!(track["t_s"][0], 0.0);
    assert!(
        (track["y_m"].last().unwrap()).abs() < 1.0,
        "back on the leg"
    );
    let header = fs::read_to_string(out.join("track.csv")).unwrap();
    assert!(header.starts_with("t_s,x_m,y_m,z_m,course_rad,climb_rad,bank_rad,state\n"));
    assert!(
        fs::read_to_string(out.join("overview.svg"))
            .unwrap()
            .contains("<svg")
    );
    let run: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("run.json")).unwrap()).unwrap();
    let conflicts = summary["conflicts"].as_array().unwrap();
    assert_eq!(conflicts.len(), 1, "one mast, one conflict");
    assert_eq!(conflicts[0]["threat_s"], summary["threat_s"]);
    assert_eq!(conflicts[0]["rejoined_s"], summary["rejoined_s"]);
    for key in ["version", "configuration_hash", "seed", "target", "wall_s"] {
        assert!(!run[key].is_null(), "{key}");
    }
    for line in fs::read_to_string(out.join("events.jsonl"))
        .unwrap()
        .lines()
    {
        let event: serde_json::Value = serde_json::from_str(line).unwrap();
        assert!(event["t_s"].is_number() && event["text"].is_string());
    }
    assert!(decisions_follow_their_schema(&out.join("events.jsonl")) > 3);
}

const CROSSING: &str = "name = 'crossing'
duration_s = 20.0
[mission]
waypoints_m = [[0, 0, 100], [600, 0, 100]]
[[obstacle]]
name = 'N1'
movement = 'uas'
position_m = [450, -300, 100]
velocity_mps = [-5, 15, 0]
";

#[test]
fn a_flight_on_beliefs_writes_the_futures_it_weighs() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("crossing.toml"), CROSSING).unwrap();
    let flown = |policy| {
        let output = fga_in(
            folder.path(),
            &["run", "crossing.toml", "--policy", policy, "--out", policy],
        );
        assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
        let flight = fs::read(folder.path().join(policy).join("flight.json")).unwrap();
        serde_json::from_slice::<serde_json::Value>(&flight).unwrap()
    };
    assert!(flown("turn-aware").get("futures").is_none());
    let flight = flown("belief");
    let futures = flight["futures"].as_array().unwrap();
    assert!(futures.len() > 5, "{}", futures.len());
    let mut last_s = f64::NEG_INFINITY;
    for one in futures {
        assert_eq!(one["obstacle"], "N1");
        let time_s = one["time_s"].as_f64().unwrap();
        assert!(time_s - last_s > 0.99, "{last_s} s, {time_s} s");
        last_s = time_s;
        let ways = one["ways"].as_array().unwrap();
        let weights = ways.iter().map(|way| way["weight"].as_f64().unwrap());
        let sum: f64 = weights.sum();
        assert!((sum - 1.0).abs() < 1e-3, "{sum}");
        for way in ways {
            assert_eq!(way["points_m"].as_array().unwrap().len(), 13);
        }
        // Reports are exact, and it flies straight: it is where it is said to be now.
        let x_m = ways[0]["points_m"][0][0].as_f64().unwrap();
        assert!(
            (x_m - (450.0 - 5.0 * time_s)).abs() < 5.0,
            "{x_m} m at {time_s} s"
        );
    }
    let log = folder.path().join("belief/events.jsonl");
    assert!(decisions_follow_their_schema(&log) > 3);
    let text = fs::read_to_string(log).unwrap();
    assert!(text.contains("\"p_loss\":"), "{text}");
}

#[test]
fn a_lost_scenario_ends_with_code_2() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mast.toml"), MAST).unwrap();
    let output = fga_in(
        folder.path(),
        &["run", "mast.toml", "--policy", "none", "--json"],
    );
    assert_eq!(output.status.code(), Some(2));
    let summary = summary(&output);
    assert_eq!(summary["separated"], false);
    assert!((summary["min_margin_m"].as_f64().unwrap() + 25.0).abs() < 1e-9);
}

#[test]
fn two_runs_write_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("mast.toml"),
        format!("{MAST}\n[noise]\nposition_m = 2.0\n"),
    )
    .unwrap();
    for out in ["a", "b"] {
        fga_in(folder.path(), &["run", "mast.toml", "--out", out]);
    }
    for name in ["track.csv", "events.jsonl", "overview.svg"] {
        let read = |out: &str| fs::read(folder.path().join(out).join(name)).unwrap();
        assert!(read("a") == read("b"), "{name} differs");
    }
}

#[test]
fn the_first_flight_collides_without_avoidance_and_comes_back_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = repository().join("scenarios/first-flight.toml");
    let scenario = scenario.to_str().unwrap();
    let none = fga_in(
        folder.path(),
        &["run", scenario, "--policy", "none", "--json", "--out", "n"],
    );
    assert_eq!(none.status.code(), Some(2), "{}", errors(&none));
    let flown = fga_in(folder.path(), &["run", scenario, "--json", "--out", "f"]);
    assert_eq!(flown.status.code(), Some(0), "{}", errors(&flown));
    assert_eq!(summary(&flown)["mission_flown"], true);
}

#[test]
fn every_shipped_scenario_is_flown() {
    let folder = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(repository().join("scenarios")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|ending| ending != "toml") {
            continue;
        }
        let output = fga_in(
            folder.path(),
            &[
                "run",
                path.to_str().unwrap(),
                "--policy",
                "none",
                "--out",
                "o",
            ],
        );
        let lost = path.file_stem().unwrap() != "fig-03";
        let expected = if lost { 2 } else { 0 };
        assert_eq!(
            output.status.code(),
            Some(expected),
            "{}: {}",
            path.display(),
            errors(&output)
        );
    }
}

/// The rows of one aircraft of a recording, read by the test: latitude, longitude in radians, altitude in
/// metres, time in seconds.
fn recorded(path: &Path, name: &str, time_column: usize) -> Vec<[f64; 4]> {
    fs::read_to_string(path)
        .unwrap()
        .lines()
        .filter_map(|line| {
            let fields: Vec<&str> = line.split(',').map(str::trim).collect();
            let number = |k: usize| fields.get(k)?.parse::<f64>().ok();
            (fields[0] == name).then_some(())?;
            Some([
                number(1)?.to_radians(),
                number(2)?.to_radians(),
                number(3)? * 0.3048,
                number(time_column)?,
            ])
        })
        .collect()
}

/// The least separation of two recorded aircraft, linear between rows, on the sphere on which a
/// minute of arc is a nautical mile, by the haversine's chord.
fn least_separation(own: &[[f64; 4]], other: &[[f64; 4]]) -> f64 {
    let radius = 1852.0 * 60.0 * 180.0 / core::f64::consts::PI;
    let offset = |a: &[f64; 4], b: &[f64; 4]| {
        let middle = 0.5 * (a[0] + b[0]);
        [
            (b[1] - a[1]) * middle.cos() * radius,
            (b[0] - a[0]) * radius,
            b[2] - a[2],
        ]
    };
    let mut least = f64::INFINITY;
    let offsets: Vec<[f64; 3]> = own.iter().zip(other).map(|(a, b)| offset(a, b)).collect();
    for pair in offsets.windows(2) {
        for k in 0..=1000 {
            let share = f64::from(k) / 1000.0;
            let at = [0, 1, 2].map(|i| pair[0][i] + share * (pair[1][i] - pair[0][i]));
            least = least.min((at[0] * at[0] + at[1] * at[1] + at[2] * at[2]).sqrt());
        }
    }
    least
}

#[test]
fn recordings_keep_their_separations() {
    let vehicle = repository().join("vehicles/general-aviation.toml");
    let folder = tempfile::tempdir().unwrap();
    for (name, time_column) in [("C0_0_120", 9), ("C1_0_120", 9), ("H1", 7)] {
        let Some(path) = data(&format!("daidalus/{name}.daa")) else {
            return;
        };
        let output = fga_in(
            folder.path(),
            &[
                "run",
                path.to_str().unwrap(),
                "--policy",
                "none",
                "--vehicle",
                vehicle.to_str().unwrap(),
                "--json",
                "--out",
                "o",
            ],
        );
        let found = summary(&output)["min_separation_m"].as_f64().unwrap();
        let own = recorded(&path, "Ownship", time_column);
        let other = recorded(&path, "Intruder", time_column);
        assert!(own.len() > 100 && own.len() == other.len());
        let expected = least_separation(&own, &other);
        eprintln!("{name}: {found:.3} m, computed from the file {expected:.3} m");
        let allowed = (0.005 * expected).max(0.25);
        assert!(
            (found - expected).abs() <= allowed,
            "{name}: {found} against {expected}"
        );
    }
}

#[test]
fn a_recorded_ownship_manoeuvres_at_its_recorded_airspeed() {
    let Some(path) = data("daidalus/H1.daa") else {
        return;
    };
    let vehicle = repository().join("vehicles/general-aviation.toml");
    let folder = tempfile::tempdir().unwrap();
    let output = fga_in(
        folder.path(),
        &[
            "run",
            path.to_str().unwrap(),
            "--vehicle",
            vehicle.to_str().unwrap(),
            "--json",
            "--out",
            "o",
        ],
    );
    let summary = summary(&output);
    assert!(output.status.code().is_some(), "{}", errors(&output));
    let track = columns(&folder.path().join("o/track.csv"));
    // 200 knots, recorded.
    for k in 1..track["t_s"].len() {
        let step: f64 = ["x_m", "y_m", "z_m"]
            .iter()
            .map(|c| (track[*c][k] - track[*c][k - 1]).powi(2))
            .sum::<f64>()
            .sqrt();
        let time = track["t_s"][k] - track["t_s"][k - 1];
        if time > 0.05 {
            assert!(
                (step / time / (200.0 * 1852.0 / 3600.0) - 1.0).abs() < 0.01,
                "{}",
                step / time
            );
        }
    }
    assert!(summary["min_margin_m"].is_number());
}

#[test]
fn wrong_input_is_one_sentence_with_code_1() {
    let folder = tempfile::tempdir().unwrap();
    let daa = "NAME lat lon alt trk gs vs time\n[none] [deg] [deg] [ft] [deg] [knot] [fpm] [s]\n\
               A, 40, -74, 1000, 0, 100, 0, 0\nA, 40.01, -74, 1000, 0, 100, 0, 10\n";
    for (name, text, expected) in [
        (
            "a.toml",
            MAST.replace("duration_s", "duration_ms"),
            "line 2",
        ),
        (
            "a.toml",
            MAST.replace(", [600, 0, 100]", ""),
            "line 4: mission has 1 waypoint",
        ),
        (
            "a.toml",
            MAST.replace("300, 5", "3, 5"),
            "on top of the aircraft",
        ),
        (
            "a.toml",
            format!("{MAST}radius_m = -1\n"),
            "line 8: radius_m is -1",
        ),
        (
            "a.toml",
            format!("{MAST}id = 5\n[[obstacle]]\nid = 5\nposition_m = [500, 90, 100]\n"),
            "number 5 is used twice",
        ),
        (
            "a.toml",
            format!("vehicle = 'missing.toml'\n{MAST}"),
            "missing.toml",
        ),
        ("a.daa", daa.replace("[ft]", "[furlong]"), "line 2"),
        ("a.daa", daa.replace(" gs", ""), "a.daa"),
        ("a.daa", daa.replace("0, 10\n", "0, -10\n"), "line 4"),
        ("a.daa", String::new(), "empty"),
        (
            "a.txt",
            String::new(),
            "expected a .toml scenario, a .daa recording or a mission",
        ),
    ] {
        fs::write(folder.path().join(name), &text).unwrap();
        let output = fga_in(folder.path(), &["run", name, "--out", "o"]);
        let message = errors(&output);
        assert_eq!(output.status.code(), Some(1), "{name}: {message}");
        assert_eq!(message.trim_end().lines().count(), 1, "{message}");
        assert!(message.contains(expected), "{message} lacks {expected}");
        assert!(!folder.path().join("o").exists(), "{message}");
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn wrong_usage_is_code_1_and_help_is_code_0() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mast.toml"), MAST).unwrap();
    fs::write(folder.path().join("a-file"), "").unwrap();
    for (arguments, expected) in [
        (vec!["fly-to-the-moon"], "fly-to-the-moon"),
        (vec!["run"], "FILE"),
        (vec!["run", "missing.toml"], "missing.toml: cannot be read"),
        (
            vec!["run", "mast.toml", "--policy", "luck"],
            "unknown policy",
        ),
        (
            vec!["run", "mast.toml", "--policy", "none", "--start", "t0"],
            "no start time",
        ),
        (
            vec!["run", "mast.toml", "--out", "a-file/below"],
            "a-file/below cannot be written",
        ),
        (vec!["batch", "missing.csv"], "missing.csv: cannot be read"),
        (
            vec!["batch", "mast.toml", "--horizon", "-3"],
            "positive number of seconds",
        ),
        (vec!["batch", "mast.toml", "--threads", "0"], "threads"),
    ] {
        let output = fga_in(folder.path(), &arguments);
        let message = errors(&output);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{message} lacks {expected}");
    }
    assert_eq!(fga_in(folder.path(), &["--help"]).status.code(), Some(0));
    assert_eq!(
        fga_in(folder.path(), &["run", "--help"]).status.code(),
        Some(0)
    );
}

/// Seen too late for its way round, the disc is refused before anything is flown or written.
#[test]
fn d8_circle_refuses_before_the_flight_what_it_cannot_keep() {
    let folder = tempfile::tempdir().unwrap();
    let text = MAST.replace(
        "position_m = [300, 5, 100]",
        "position_m = [300, 5, 100]\nradius_m = 280.0",
    );
    fs::write(folder.path().join("disc.toml"), text).unwrap();
    let arguments = ["run", "disc.toml", "--policy", "circle"];
    let output = fga_in(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(1));
    let said = errors(&output);
    let expected = "fga: disc.toml: policy circle cannot keep 280 m from mast: it begins ";
    let refusals = said.lines().filter(|line| line.starts_with(expected));
    assert_eq!(refusals.count(), 1, "{said}");
    // The other line warns that the disc is seen too late.
    assert!(
        said.lines()
            .all(|line| line.starts_with(expected) || line.contains(": warning: ")),
        "{said}"
    );
    assert!(!folder.path().join("out").exists());
}

/// Two waypoints that the flight never came near are missed, and the mission is not flown, though it comes back to its last leg.
#[test]
fn d9_orca_missed_waypoints_of_the_first_flight() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = repository().join("scenarios/first-flight.toml");
    let arguments = [
        "run",
        scenario.to_str().unwrap(),
        "--policy",
        "orca",
        "--json",
    ];
    let summary = summary(&fga_in(folder.path(), &arguments));
    assert_eq!(summary["mission_flown"], false, "{summary}");
    assert!(
        summary["waypoints_missed"].as_u64().unwrap() >= 2,
        "{summary}"
    );
    assert!(summary["rejoined_s"].is_number(), "{summary}");
}

#[test]
fn a_flight_among_zones_keeps_to_them_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = repository().join("scenarios/fenced-valley.toml");
    let text = fs::read_to_string(&scenario).unwrap();
    let flown = fga_in(
        folder.path(),
        &["run", scenario.to_str().unwrap(), "--out", "f"],
    );
    assert_eq!(flown.status.code(), Some(0), "{}", errors(&flown));
    let words = String::from_utf8_lossy(&flown.stdout).into_owned();
    let page = fs::read_to_string(repository().join("docs/how-to-zones.md")).unwrap();
    let quoted: Vec<&str> = page
        .lines()
        .filter(|line| line.starts_with("zone "))
        .collect();
    assert_eq!(quoted.len(), 3);
    for line in quoted {
        assert!(words.contains(line), "{line}: {words}");
    }
    for (file, holds) in [("overview.svg", "village"), ("replay.html", "\"zones\":[")] {
        let file = fs::read_to_string(folder.path().join("f").join(file)).unwrap();
        assert!(file.contains(holds));
    }
    // By expected cost it keeps to them too: an aircraft that is beyond the surveillance radius does not count.
    let by_cost = &["--policy", "belief", "--json", "--out", "b"];
    let scenario = ["run", scenario.to_str().unwrap()];
    let flown = fga_in(folder.path(), &[&scenario[..], by_cost].concat());
    assert_eq!(flown.status.code(), Some(0), "{}", errors(&flown));
    let zones = &summary(&flown)["zones"];
    assert!((0..3).all(|zone| zones[zone]["kept"] == true), "{zones}");
    let events = fs::read_to_string(folder.path().join("b/events.jsonl")).unwrap();
    let words = "least margin 1000.0 m";
    assert!(
        !events.contains(words),
        "nobody and no zone was in the proof"
    );
    // A mission over the village is flown; a warning comes before the flight.
    let vehicles = repository().join("vehicles");
    let text = text.replace("../vehicles", vehicles.to_str().unwrap());
    let across = text.replace(
        "[[0, 0, 100], [1400, 0, 100]",
        "[[0, -100, 100], [1400, -100, 100]",
    );
    fs::write(folder.path().join("across.toml"), across).unwrap();
    let told = "leg 1 of the mission enters village: it is flown as it is given";
    let checked = fga_in(folder.path(), &["check", "across.toml"]);
    let words = String::from_utf8_lossy(&checked.stdout).into_owned() + &errors(&checked);
    assert!(words.contains(told), "{words}");
    let flown = fga_in(
        folder.path(),
        &["run", "across.toml", "--json", "--out", "a"],
    );
    assert_eq!(flown.status.code(), Some(2), "{}", errors(&flown));
    assert!(errors(&flown).contains(told), "{}", errors(&flown));
    let zones = &summary(&flown)["zones"];
    assert_eq!(
        (&zones[0]["kept"], &zones[1]["kept"]),
        (&true.into(), &false.into())
    );
    assert!(zones[1]["min_margin_m"].as_f64().unwrap() < -50.0);
    // Other policies know none.
    let published = ["run", "across.toml", "--policy", "published", "--out", "p"];
    let flown = fga_in(folder.path(), &published);
    let told = "warning: published --start tc knows no zones, which only judge its flight";
    assert!(errors(&flown).contains(told), "{}", errors(&flown));
}

#[test]
fn a_wrong_zone_is_one_sentence_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let good = "name = 'a'\nduration_s = 60.0\n[mission]\nwaypoints_m = [[0, 0, 0], [900, 0, 0]]\n";
    for (zone, expected) in [
        (
            "polygon_m = [[0, 50], [9, 50]]",
            "line 8: yard: polygon has 2 corners, expected 3 to 256",
        ),
        (
            "polygon_m = [[0, 50], [9, nan], [0, 60]]",
            "line 8: yard: corner 2 is out of range",
        ),
        (
            "polygon_m = [[0, 50], [9, 50], [9, 60], [0, 50]]",
            "line 8: yard: corner 4 lies on corner 1",
        ),
        (
            "polygon_m = [[0, 50], [9, 60], [9, 50], [0, 60]]",
            "line 8: yard: polygon crosses itself: edge 1",
        ),
        (
            "center_m = [0, 50]",
            "yard has no outline, expected polygon_m",
        ),
        (
            "center_m = [0, 50]\nradius_m = -2",
            "line 9: radius_m is -2, expected a positive number",
        ),
        (
            "center_m = [0, 50]\nradius_m = 1e308",
            "a number from 0 to 10000000",
        ),
        ("radius_m = 5", "a circle has no centre"),
        (
            "polygon_deg = [[0, 0], [0, 1], [1, 1]]",
            "expected an [origin]",
        ),
        (
            "center_m = [0, 50]\nradius_m = 2\nfloor_m = 9\nceiling_m = 3",
            "ceiling_m is 3, expected",
        ),
        (
            "center_m = [0, 50]\nradius_m = 2\npolygon_m = [[0, 50]]",
            "yard has more than one outline",
        ),
    ] {
        let text = format!("{good}[[zone]]\nname = 'yard'\nkind = 'keep-out'\n{zone}\n");
        fs::write(folder.path().join("z.toml"), text).unwrap();
        let checked = fga_in(folder.path(), &["check", "z.toml"]);
        assert_eq!(checked.status.code(), Some(1));
        let told = errors(&checked);
        assert!(
            told.contains(expected) && told.trim().lines().count() == 1,
            "{zone}: {told}"
        );
    }
}

/// Two scenarios of one name in two folders: the second one's results get a number, and each flown again keeps its folder.
#[test]
fn results_of_another_scenario_are_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for place in ["one", "two"] {
        fs::create_dir(at.join(place)).unwrap();
        let made = fga_in(at, &["init", "scenario", &format!("{place}/a.toml")]);
        assert!(made.status.success(), "{}", errors(&made));
    }
    let fly = |input: &str| {
        let flown = fga_in(at, &["run", input]);
        assert!(flown.status.success(), "{}", errors(&flown));
        let said = String::from_utf8_lossy(&flown.stdout).into_owned();
        let last = said.lines().last().unwrap_or_default().to_owned();
        (last, errors(&flown))
    };
    for _ in 0..2 {
        assert_eq!(fly("one/a.toml").0, "results in out/a");
        let (last, said) = fly("two/a.toml");
        assert_eq!(last, "results in out/a-2");
        assert!(
            said.contains("out/a holds results of another input"),
            "{said}"
        );
    }
    // A folder that is named is the user's to overwrite.
    let named = fga_in(at, &["run", "two/a.toml", "--out", "out/a"]);
    assert!(named.status.success(), "{}", errors(&named));
}
