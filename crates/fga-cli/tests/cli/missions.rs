//! Missions of ground stations, and what `fga check` and `fga run` say about usable files.

use std::fs;
use std::path::Path;

use crate::support::{data, errors, fga_in, repository};

/// Home, and two waypoints 1,112 m apart.
const LIST: &str = "QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t45.0\t5.0\t100\t1
1\t0\t3\t16\t0\t0\t0\t0\t45.01\t5.0\t100\t1
2\t0\t3\t16\t0\t0\t0\t0\t45.02\t5.01\t100\t1
3\t0\t3\t178\t0\t18\t0\t0\t0\t0\t0\t1
";

/// What a command says, on both outputs.
fn said(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = fga_in(folder, arguments);
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &errors(&output);
    assert_eq!(output.status.code(), Some(code), "{text}");
    text
}

#[test]
fn n8_a_mission_is_checked_flown_and_made_a_scenario() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("mission.waypoints"), LIST).unwrap();
    assert!(said(at, &["init", "vehicle"], 0).contains("written"));
    let checked = said(at, &["check", "mission.waypoints"], 0);
    assert!(
        checked.contains("a usable mission: 3 waypoints"),
        "{checked}"
    );
    assert!(checked.contains("DO_CHANGE_SPEED 1"), "{checked}");
    let flown = said(
        at,
        &["run", "mission.waypoints", "--vehicle", "vehicle.toml"],
        0,
    );
    assert!(flown.contains("mission flown to its end"), "{flown}");
    assert!(flown.contains("DO_CHANGE_SPEED 1"), "{flown}");
    let made = said(
        at,
        &[
            "init",
            "scenario",
            "made.toml",
            "--from",
            "mission.waypoints",
        ],
        0,
    );
    assert!(made.contains("DO_CHANGE_SPEED 1"), "{made}");
    assert!(said(at, &["check", "made.toml"], 0).contains("a usable scenario file: 3 waypoints"));
    let flown = said(at, &["run", "made.toml"], 0);
    assert!(flown.contains("mission flown to its end"), "{flown}");
    let refused = said(
        at,
        &["init", "vehicle", "v.toml", "--from", "mission.waypoints"],
        1,
    );
    assert!(refused.contains("expected fga init scenario"), "{refused}");
    assert!(!at.join("v.toml").exists());
    // A file of fences alone is a usable one, and no mission.
    let fence = "QGC WPL 110\n1 0 3 5003 90 0 0 0 45 5 0 1\n";
    fs::write(at.join("fence.waypoints"), fence).unwrap();
    assert!(
        said(at, &["check", "fence.waypoints"], 0).contains("0 waypoints, 1 fence, 0 rally points")
    );
    assert!(said(at, &["run", "fence.waypoints"], 1).contains("expected a mission"));
}

/// Home in the valley of `scenarios/ridge.tif`, and two waypoints above the ground.
const ABOVE_GROUND: &str = "QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t47.3\t10.5\t800\t1
1\t0\t10\t16\t0\t0\t0\t0\t47.3\t10.51\t120\t1
2\t0\t10\t16\t0\t0\t0\t0\t47.302\t10.53\t150\t1
";

#[test]
fn a_mission_above_the_ground_is_flown_over_the_heights_that_are_given() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::copy(
        repository().join("scenarios/ridge.tif"),
        at.join("ridge.tif"),
    )
    .unwrap();
    fs::write(at.join("low.waypoints"), ABOVE_GROUND).unwrap();
    let checked = said(at, &["check", "low.waypoints"], 0);
    assert!(
        checked.contains("3 waypoints above the ground: fga run --terrain"),
        "{checked}"
    );
    let refused = said(at, &["run", "low.waypoints"], 1);
    assert!(
        refused.contains("has 3 waypoints above the ground, expected --terrain"),
        "{refused}"
    );
    let run = [
        "run",
        "low.waypoints",
        "--terrain",
        "ridge.tif",
        "--out",
        "flown",
    ];
    let flown = said(at, &run, 0);
    assert!(flown.contains("mission flown to its end"), "{flown}");
    assert!(
        flown.contains("3 waypoints above the ground, with "),
        "{flown}"
    );
    let least_m = flown.split_once("ground: least height ").unwrap().1;
    let least_m: f64 = least_m.split_once(" m at").unwrap().0.parse().unwrap();
    assert!((110.0..=125.0).contains(&least_m), "{flown}");
    // The scenario that is made of it flies the same.
    let made = [
        "init",
        "scenario",
        "made.toml",
        "--from",
        "low.waypoints",
        "--terrain",
        "ridge.tif",
    ];
    said(at, &made, 0);
    let again = said(at, &["run", "made.toml"], 0);
    assert!(
        again.contains(&format!("least height {least_m} m")),
        "{again}"
    );
    let clear = [
        "terrain",
        "check",
        "ridge.tif",
        "--mission",
        "low.waypoints",
        "--clearance",
        "90",
    ];
    assert!(said(at, &clear, 0).contains("clear"), "no answer");
    // Heights are for missions.
    let refused = said(at, &["run", "made.toml", "--terrain", "ridge.tif"], 1);
    assert!(refused.contains("is no mission"), "{refused}");
}

/// A mission whose items have no places of their own, as those of a take-off on the spot, and an empty one.
#[test]
fn a_mission_without_places_is_read_and_an_empty_one_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let list = "QGC WPL 110\n0 1 0 16 0 0 0 0 0 0 0 1\n1 0 3 22 0 0 0 0 0 0 40 1\n";
    fs::write(at.join("up.waypoints"), list).unwrap();
    let checked = said(at, &["check", "up.waypoints"], 0);
    assert!(checked.contains("the take-off is not flown"), "{checked}");
    assert!(
        checked.contains("not for fga run: holds 0 waypoints"),
        "{checked}"
    );
    fs::write(at.join("empty.waypoints"), "QGC WPL 110\n").unwrap();
    assert!(said(at, &["check", "empty.waypoints"], 1).contains("holds 0 waypoints"));
}

#[test]
fn n8_check_knows_every_kind_that_a_command_reads() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("c.conf"), crate::alerts::CONFIGURATION).unwrap();
    fs::write(at.join("mission.waypoints"), LIST).unwrap();
    said(at, &["run", "mission.waypoints", "--out", "flown"], 0);
    for (file, kind) in [
        ("c.conf", "configuration of DAIDALUS"),
        ("flown", "finished flight"),
        ("flown/flight.json", "finished flight"),
    ] {
        let checked = said(at, &["check", file], 0);
        assert!(checked.contains(&format!("a usable {kind}")), "{checked}");
    }
    for (file, kind) in [
        ("json_columns.json.gz", "recording"),
        ("sbs_plain.sbs.gz", "recording"),
        ("mission.plan", "mission"),
        ("mission.waypoints", "mission"),
    ] {
        if let Some(path) = data(&format!("trials/2026-11-25/{file}")) {
            let checked = said(at, &["check", &path.display().to_string()], 0);
            let expected = format!("a usable {kind}");
            assert!(checked.contains(&expected), "{checked}");
        }
    }
}

#[test]
fn n1_a_surveillance_radius_that_is_too_small_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let vehicle = |key: &str| {
        format!(
            "name = 'x8'\nairspeed_mps = 18.0\nmax_bank_deg = 45.0\n{key}[protection]\nradius_m = 150\nhalf_height_m = 50\n\
             [response]\nbank_time_constant_s = 0.5\nturn_rate_factor = 0.75\ndead_time_s = 0.3\n"
        )
    };
    fs::write(
        at.join("near.toml"),
        vehicle("surveillance_radius_m = 300\n"),
    )
    .unwrap();
    fs::write(at.join("derived.toml"), vehicle("")).unwrap();
    fs::write(
        at.join("head-on.toml"),
        "name = 'head-on'\nduration_s = 300\n[mission]\nwaypoints_m = [[0,0,100],[4000,0,100]]\n\
         [[obstacle]]\nname = 'D-EABC'\nmovement = 'aircraft'\nposition_m = [4500,0,100]\nvelocity_mps = [-45,0,0]\n",
    )
    .unwrap();
    let warned = said(at, &["run", "head-on.toml", "--vehicle", "near.toml"], 2);
    assert!(
        warned.contains("surveillance_radius_m is 300 m, too near for D-EABC"),
        "{warned}"
    );
    let warned = said(at, &["check", "near.toml"], 0);
    assert!(
        warned.contains("too near for crewed traffic at 90 m/s"),
        "{warned}"
    );
    let kept = said(at, &["run", "head-on.toml", "--vehicle", "derived.toml"], 0);
    assert!(!kept.contains("warning"), "{kept}");
}

#[test]
fn n5_what_cannot_be_flown_is_said_beforehand() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let scenario = |rest: &str| format!("name = 'a'\nduration_s = 300.0\n{rest}");
    for (name, text, expected) in [
        (
            "long.toml",
            "[mission]\nwaypoints_m = [[0,0,100],[40000,0,100]]\n",
            "its 40.0 km take 2667 s at 15 m/s, duration_s is 300",
        ),
        (
            "steep.toml",
            "[mission]\nwaypoints_m = [[0,0,100],[100,0,200],[900,0,200]]\n",
            "leg 1 cannot be flown: it needs a climb angle of 45.0 degrees",
        ),
        (
            "wind.toml",
            "[wind]\neast_mps = 16.0\n[mission]\nwaypoints_m = [[0,0,100],[900,0,100],[0,0,100]]\n",
            "leg 2 cannot be flown: the wind of 16.0 m/s is too strong",
        ),
        (
            "covered.toml",
            "[mission]\nwaypoints_m = [[0,0,100],[900,0,100]]\n[[obstacle]]\nname = 'mast'\nposition_m = [900,10,100]\n",
            "waypoint 2 lies inside the protected volume of mast",
        ),
        (
            "absent.toml",
            "[mission]\nwaypoints_m = [[0,0,100],[900,0,100]]\n[[obstacle]]\nname = 'N1'\nposition_m = [0,900,100]\nappears_s = 400.0\n",
            "N1 appears at 400 s, after the flight: duration_s is 300",
        ),
    ] {
        fs::write(at.join(name), scenario(text)).unwrap();
        let checked = said(at, &["check", name], 0);
        assert!(checked.contains(expected), "{checked}");
        let warnings = checked
            .lines()
            .filter(|line| line.contains("warning: "))
            .count();
        assert!(warnings >= 1, "{checked}");
        let flown = fga_in(at, &["run", name]);
        assert!(errors(&flown).contains(expected), "{}", errors(&flown));
    }
}

#[test]
fn exchanged_coordinates_are_refused_and_nothing_is_flown() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let text = "name = 'a'\nduration_s = 300.0\n[origin]\nlatitude_deg = 47.4\nlongitude_deg = 8.5\n[mission]\n\
                waypoints_deg = [[47.4, 8.5, 100], [8.51, 47.41, 100]]\n";
    fs::write(at.join("swapped.toml"), text).unwrap();
    for command in ["check", "run"] {
        let said = said(at, &[command, "swapped.toml"], 1);
        assert!(
            said.contains("swapped.toml: waypoint 2 is")
                && said.contains("with latitude and longitude exchanged it would be"),
            "{said}"
        );
    }
    assert!(!at.join("out").exists());
    // In JSON the sentence is in the answer.
    let answer = fga_in(at, &["check", "swapped.toml", "--json"]);
    assert_eq!(answer.status.code(), Some(1));
    let value: serde_json::Value = serde_json::from_slice(&answer.stdout).unwrap();
    assert!(
        value["error"]
            .as_str()
            .unwrap()
            .contains("waypoint 2 is 4944 km")
    );
}

#[test]
fn l12_surveillance_within_the_protected_radius_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let vehicle = "name = 'a'\nairspeed_mps = 15\nturn_radius_m = 30\nsurveillance_radius_m = 50\n[protection]\nradius_m = 60\n";
    fs::write(at.join("v.toml"), vehicle).unwrap();
    let refused = said(at, &["check", "v.toml"], 1);
    assert!(
        refused.contains("v.toml, line 4: surveillance_radius_m is 50, expected more than"),
        "{refused}"
    );
    if cfg!(feature = "fly") {
        fs::write(
            at.join("l.toml"),
            "[protection]\nradius_m = 60.0\nsurveillance_m = 50.0\n",
        )
        .unwrap();
        let refused = said(at, &["check", "l.toml"], 1);
        assert!(
            refused.contains("l.toml, line 3: protection.surveillance_m is 50"),
            "{refused}"
        );
        fs::write(at.join("s.toml"), "[protection]\nradius_m = 60.0\n").unwrap();
        let warned = said(at, &["check", "s.toml"], 0);
        assert!(
            warned.contains("less than a near mid-air collision"),
            "{warned}"
        );
    }
}

#[test]
fn n6_results_name_the_commit_and_merging_refuses_another_build() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let version = said(at, &["--version"], 0);
    let commit = version.split(['(', ')']).nth(1).unwrap().to_owned();
    assert!(commit == "unknown" || commit.len() >= 7, "{version}");
    fs::write(
        at.join("small.toml"),
        "policies = ['none']\nencounters = 16\n[[grid]]\nfamily = 'threats'\ncount = [1]\nfirst_seen_m = [300]\nspeed_mps = [20]\n",
    )
    .unwrap();
    for (shard, out) in [("1/2", "a"), ("2/2", "b")] {
        said(
            at,
            &[
                "campaign",
                "run",
                "small.toml",
                "--shard",
                shard,
                "--out",
                out,
            ],
            0,
        );
    }
    let run = |out: &str| at.join(out).join("campaign.json");
    let manifest = fs::read_to_string(run("b")).unwrap();
    assert!(manifest.contains(&commit), "{manifest}");
    let other = manifest.replace(
        &format!("\"commit\": \"{commit}\""),
        "\"commit\": \"0123456789abcdef\"",
    );
    assert_ne!(other, manifest);
    fs::write(run("b"), other).unwrap();
    let merge = ["campaign", "merge", "a", "b", "--out", "ab"];
    let refused = said(at, &merge, 1);
    assert!(refused.contains("by commit 0123456789abcdef"), "{refused}");
    assert!(!at.join("ab/results.parquet").exists());
    fs::write(run("b"), manifest).unwrap();
    said(at, &merge, 0);
    let document = fs::read_to_string(at.join("ab/run.json")).unwrap();
    assert!(
        document.contains(&format!("\"commit\": \"{commit}\"")),
        "{document}"
    );
    let table = fs::read(at.join("ab/results.parquet")).unwrap();
    assert!(table.windows(10).any(|bytes| bytes == b"fga.commit"));
}

/// A mission to the other side of the earth was flown to its end in half an hour, on the plane of its beginning; a plan without items
/// was usable; a height was reported as a latitude.
#[test]
fn n8_a_mission_that_no_plane_holds_is_refused_with_its_item() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let refused = |list: &str, expected: &str| {
        fs::write(at.join("m.waypoints"), list).unwrap();
        for command in [&["check", "m.waypoints"][..], &["run", "m.waypoints"]] {
            let text = said(at, command, 1);
            assert!(
                text.contains(expected) && text.lines().count() == 1,
                "{text}"
            );
        }
    };
    refused(
        &LIST.replace("45.02\t5.01", "-45.0\t-175.0"),
        "item 2 is 20002 km from where the mission begins",
    );
    refused(
        &LIST.replace("5.01\t100", "5.01\t1e8"),
        "item 2 is at latitude 45.02, longitude 5.01, altitude 100000100.0 m",
    );
    refused(
        "QGC WPL 110\n",
        "holds 0 waypoints, 0 fences, 0 rally points, expected a mission",
    );
    let scenario = "[origin]\nlatitude_deg = 45.0\nlongitude_deg = 5.0\naltitude_m = 0.0\n\
                    [mission]\nwaypoints_deg = [[45.0, 5.0, 100.0], [-45.0, -175.0, 100.0]]\n";
    fs::write(
        at.join("s.toml"),
        format!("name = \"far\"\nduration_s = 60\n{scenario}"),
    )
    .unwrap();
    let text = said(at, &["check", "s.toml"], 1);
    assert!(text.contains("20002 km from the origin"), "{text}");
}

#[test]
fn fences_of_a_mission_are_zones_of_its_flight() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let plan = |corners: &str| {
        format!(
            r#"{{"fileType": "Plan", "mission": {{"plannedHomePosition": [47.0, 8.0, 500.0], "items": [
            {{"type": "SimpleItem", "command": 16, "frame": 3, "params": [0, 0, 0, null, 47.0, 8.0, 60.0]}},
            {{"type": "SimpleItem", "command": 16, "frame": 3, "params": [0, 0, 0, null, 47.01, 8.0, 60.0]}}]}},
            "geoFence": {{"circles": [{{"circle": {{"center": [47.005, 8.004], "radius": 90.0}}, "inclusion": false}}],
            "polygons": [{{"polygon": [{corners}], "inclusion": true}}]}}}}"#
        )
    };
    let fence = "[46.99, 7.99], [47.02, 7.99], [47.02, 8.01], [46.99, 8.01]";
    fs::write(at.join("m.plan"), plan(fence)).unwrap();
    let flown = said(at, &["run", "m.plan"], 0);
    assert!(
        flown.contains("zone fence 1 (keep out): least distance"),
        "{flown}"
    );
    assert!(
        flown.contains("zone fence 2 (keep in): least distance"),
        "{flown}"
    );
    let made = said(at, &["init", "scenario", "m.toml", "--from", "m.plan"], 0);
    assert!(!made.contains("fence"), "{made}");
    assert!(said(at, &["check", "m.toml"], 0).contains("2 zones"));
    // One that the mission leaves, and one that crosses itself.
    fs::write(
        at.join("short.plan"),
        plan(&fence.replace("47.02", "47.005")),
    )
    .unwrap();
    let told = "leg 1 of the mission leaves fence 2";
    assert!(said(at, &["check", "short.plan"], 0).contains(told));
    fs::write(
        at.join("tie.plan"),
        plan("[46.99, 7.99], [47.02, 8.01], [47.02, 7.99], [46.99, 8.01]"),
    )
    .unwrap();
    for command in ["check", "run"] {
        assert!(said(at, &[command, "tie.plan"], 1).contains("fence 2: polygon crosses itself"));
    }
}

/// Whatever a `[[zone]]` reads, `fga check` reads too.
#[test]
fn areas_of_zones_are_checked_by_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let ring = "[[8.0, 47.0], [8.1, 47.0], [8.1, 47.1], [8.0, 47.0]]";
    let geojson = format!(
        r#"{{"type": "FeatureCollection", "features": [{{"type": "Feature", "properties": null, "geometry": {{"type": "Polygon", "coordinates": [{ring}]}}}}]}}"#
    );
    for name in ["a.geojson", "a.json"] {
        fs::write(at.join(name), &geojson).unwrap();
        let words = "a usable file of areas for [[zone]]: 1 area";
        assert!(said(at, &["check", name], 0).contains(words));
    }
    fs::write(at.join("a.kml"), "<kml><Placemark>").unwrap();
    assert!(said(at, &["check", "a.kml"], 1).contains("a.kml, line 1: is no KML"));
    // What a [[zone]] refuses, wherever its flight begins.
    let crossing = "[[8.0, 47.0], [8.1, 47.1], [8.1, 47.0], [8.0, 47.1], [8.0, 47.0]]";
    let apart = format!("{ring}, [[8.3, 47.0], [8.4, 47.0], [8.4, 47.1], [8.3, 47.0]]");
    let mercator = r#""crs": {"name": "EPSG:3857"}, "features""#;
    for (text, words) in [
        (
            geojson.replace(ring, crossing),
            "area 1 (no name): polygon crosses itself",
        ),
        (
            geojson.replace(ring, &apart),
            "area 1 (no name): hole 1 is not inside of the outline",
        ),
        (geojson.replace("\"features\"", mercator), "expected WGS 84"),
    ] {
        fs::write(at.join("wrong.geojson"), text).unwrap();
        let said = said(at, &["check", "wrong.geojson"], 1);
        assert!(said.contains(words), "{said}");
    }
}

/// The old name of an obstacle's nature is read and named once; both names are refused.
#[test]
fn the_old_name_of_an_obstacles_nature_is_read_and_named_once() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let of = |obstacle: &str| {
        format!(
            "name = 'a'\nduration_s = 60.0\n[mission]\nwaypoints_m = [[0,0,100],[600,0,100]]\n{}{}",
            format_args!("[[obstacle]]\nposition_m = [300,90,100]\n{obstacle}\n"),
            format_args!("[[obstacle]]\nposition_m = [400,90,100]\n{obstacle}\n"),
        )
    };
    fs::write(at.join("old.toml"), of("kind = 'natural-barrier'")).unwrap();
    fs::write(at.join("new.toml"), of("nature = 'natural-barrier'")).unwrap();
    let old = said(at, &["check", "old.toml"], 0);
    assert_eq!(old.matches("is called nature now").count(), 1, "{old}");
    assert!(!said(at, &["check", "new.toml"], 0).contains("warning"));
    let flown = |name: &str| {
        let flown = fga_in(at, &["run", name, "--out", name.trim_end_matches(".toml")]);
        assert!(flown.status.success(), "{}", errors(&flown));
        fs::read(at.join(name.trim_end_matches(".toml")).join("track.csv")).unwrap()
    };
    assert_eq!(flown("old.toml"), flown("new.toml"));
    fs::write(
        at.join("both.toml"),
        of("kind = 'unknown'\nnature = 'unknown'"),
    )
    .unwrap();
    let both = said(at, &["check", "both.toml"], 1);
    assert!(both.contains("line 7: kind and nature are given"), "{both}");
}
