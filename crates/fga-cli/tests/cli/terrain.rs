//! `fga terrain`: what files hold, a part of them, and missions over their ground.

use std::fs;
use std::path::Path;

use crate::support::{errors, fga_in, repository};

/// A mission over the file `strips.tif`, whose formula is in the tests of `fga-formats`; the last leg leaves it.
const MISSION: &str = "QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t46.51\t9.21\t1000\t1
1\t0\t0\t16\t0\t0\t0\t0\t46.51\t9.21\t1500\t1
2\t0\t0\t16\t0\t0\t0\t0\t46.51\t9.31\t1500\t1
3\t0\t0\t16\t0\t0\t0\t0\t46.56\t9.31\t600\t1
4\t0\t0\t16\t0\t0\t0\t0\t46.56\t9.33\t1500\t1
";

fn fixture(name: &str, folder: &Path) {
    let files = repository().join("crates/fga-formats/tests/formats/terrain");
    fs::copy(files.join(name), folder.join(name)).expect("copied");
}

fn said(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = fga_in(folder, arguments);
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &errors(&output);
    assert_eq!(output.status.code(), Some(code), "{text}");
    text
}

fn json(folder: &Path, arguments: &[&str], code: i32) -> serde_json::Value {
    let output = fga_in(folder, arguments);
    assert_eq!(output.status.code(), Some(code), "{}", errors(&output));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn info_says_what_files_hold_and_how_that_is_known() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["strips.tif", "N46E009.DAT"] {
        fixture(name, folder.path());
    }
    let text = said(
        folder.path(),
        &["terrain", "info", "strips.tif", "N46E009.DAT"],
        0,
    );
    for part in [
        "strips.tif: GeoTIFF",
        "latitude 46.50250 to 46.60000, longitude 9.20000 to 9.32250",
        "9.000 x 9.000 seconds of arc, 278.3 m north x 191.4 m east; 40 x 50 heights",
        "mean sea level (EGM96) (the file's GeoKeys)",
        "1 (0.05 %)",
        "16 m (assumed, as of SRTM: the file does not say)",
        "2688 heights in 3 blocks, 1 without heights",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let arguments = [
        "terrain",
        "info",
        "strips.tif",
        "--vertical-error",
        "4",
        "--json",
    ];
    let value = json(folder.path(), &arguments, 0);
    let file = &value["files"][0];
    assert_eq!(file["vertical_error_m"], 4.0);
    assert_eq!(file["vertical_error_source"], "given by the user");
    assert_eq!(
        (&file["holes"], &file["datum"]),
        (&1.into(), &"egm96".into())
    );
    let text = said(folder.path(), &["check", "strips.tif"], 0);
    assert!(
        text.contains("a usable file of heights (GeoTIFF): 40 x 50 heights"),
        "{text}"
    );
}

#[test]
fn a_cut_is_a_file_that_info_reads() {
    let folder = tempfile::tempdir().expect("a folder");
    fixture("strips.tif", folder.path());
    let arguments = |area: &'static str| {
        [
            "terrain",
            "cut",
            "strips.tif",
            "--area",
            area,
            "-o",
            "cut.tif",
        ]
    };
    let text = said(folder.path(), &arguments("46.52,9.22,46.54,9.25"), 0);
    assert!(
        text.contains("cut.tif: 9 x 13 heights of latitude 46.52000 to 46.54000"),
        "{text}"
    );
    let value = json(folder.path(), &["terrain", "info", "cut.tif", "--json"], 0);
    assert_eq!(
        value["files"][0]["vertical_error_source"],
        "the file's metadata"
    );
    for (area, part) in [
        (
            "10,10,11,11",
            "strips.tif: the area latitude 10.00000 to 11.00000",
        ),
        ("46.6,9.2,46.5,9.3", "expected south below north"),
        ("-1,179,1,-179", "across the antimeridian"),
        ("1,2,3", "expected four numbers"),
    ] {
        let text = said(folder.path(), &arguments(area), 1);
        assert!(text.contains(part), "{area}: {text}");
    }
}

#[test]
fn a_mission_is_checked_leg_by_leg_and_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    fixture("strips.tif", folder.path());
    fs::write(folder.path().join("a.waypoints"), MISSION).expect("written");
    let with = |more: &[&'static str]| {
        let mut arguments = vec!["terrain", "check", "strips.tif", "--mission", "a.waypoints"];
        arguments.extend(more);
        arguments
    };
    let value = json(
        folder.path(),
        &with(&["--clearance", "50", "--profile", "p.svg", "--json"]),
        1,
    );
    let clear: Vec<bool> = (0..3)
        .map(|leg| value["legs"][leg]["clear"].as_bool().expect("a bool"))
        .collect();
    assert_eq!(
        (clear, &value["clear"]),
        (vec![true, false, false], &false.into())
    );
    assert!(value["legs"][2]["unknown_m"].as_f64().expect("a length") > 400.0);
    // The formula at the place that the leg names; half a metre is the rounding of the posts.
    let leg = &value["legs"][1];
    let at = |index: usize| leg["at_deg"][index].as_f64().expect("degrees");
    let ground_m =
        700.0 + 400.0 * (7.0 * at(0)).sin() * (5.0 * at(1)).cos() + 90.0 * (40.0 * at(1)).sin();
    assert!((leg["ground_m"].as_f64().expect("a height") - ground_m).abs() < 0.8);
    let text = said(folder.path(), &with(&["--clearance", "50"]), 1);
    let error = text.lines().last().unwrap_or_default();
    assert!(
        error.starts_with("fga: a.waypoints: leg 2 (waypoint 2 to 3) is ")
            && error.ends_with("expected at least 66 m above it: 50 m of clearance and 16 m of vertical error; 2 of 3 legs not clear"),
        "{error}"
    );
    let picture = fs::read_to_string(folder.path().join("p.svg")).expect("a picture");
    assert!(picture.contains("Not clear: 2 of 3 legs") && picture.contains("ground not known"));
    for (arguments, part) in [
        (with(&[]), "--clearance"),
        (
            with(&["--clearance", "-1"]),
            "expected metres from 0 to 10000",
        ),
        (
            with(&["--clearance", "50", "--datum", "ellipsoid"]),
            "expected mean sea level",
        ),
    ] {
        let text = said(folder.path(), &arguments, 1);
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn a_mission_that_clears_the_ground_and_files_alone_pass() {
    let folder = tempfile::tempdir().expect("a folder");
    fixture("strips.tif", folder.path());
    let scenario = "name = 'a'\nduration_s = 100.0\n[origin]\nlatitude_deg = 46.55\nlongitude_deg = 9.22\naltitude_m = 1000\n\
                    [mission]\nwaypoints_m = [[0, 0, 500], [3000, 1000, 500]]\n";
    fs::write(folder.path().join("a.toml"), scenario).expect("written");
    let arguments = [
        "terrain",
        "check",
        "strips.tif",
        "--mission",
        "a.toml",
        "--clearance",
        "50",
    ];
    let text = said(folder.path(), &arguments, 0);
    assert!(
        text.contains("a.toml: 1 leg over ground above mean sea level (EGM96)"),
        "{text}"
    );
    let text = said(folder.path(), &["terrain", "check", "strips.tif"], 0);
    assert_eq!(text, "strips.tif: usable GeoTIFF: 40 x 50 heights\n");
    let local = "name = 'b'\nduration_s = 100.0\n[mission]\nwaypoints_m = [[0, 0, 500], [3000, 1000, 500]]\n";
    fs::write(folder.path().join("b.toml"), local).expect("written");
    let arguments = [
        "terrain",
        "check",
        "strips.tif",
        "--mission",
        "b.toml",
        "--clearance",
        "50",
    ];
    let text = said(folder.path(), &arguments, 1);
    assert!(text.contains("b.toml: has no [origin]"), "{text}");
}

/// A link file with a table of the ground; what a command says of it.
#[cfg(feature = "fly")]
fn of_link(folder: &Path, table: &str, arguments: &[&str], code: i32) -> String {
    let text = format!("[vehicle]\nsystem_id = 1\n[terrain]\n{table}\n");
    fs::write(folder.join("fly.toml"), text).expect("written");
    let told = said(folder, arguments, code);
    assert_eq!(told.trim_end().lines().count(), 1, "{told}");
    told
}

#[cfg(feature = "fly")]
#[test]
fn the_ground_of_a_link_file_is_checked_before_the_flight() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    for name in ["strips.tif", "ellipsoid.tif"] {
        fixture(name, at);
    }
    fs::write(at.join("none.tif"), "no heights").expect("written");
    let flies = [
        "fly",
        "--connect",
        "udpin:127.0.0.1:0",
        "--config",
        "fly.toml",
    ];
    for (table, expected) in [
        (
            "file = 'missing.tif'\nclearance_m = 50.0",
            "missing.tif: cannot be read: there is no such file",
        ),
        ("file = 'none.tif'\nclearance_m = 50.0", "none.tif"),
        (
            "file = 'ellipsoid.tif'\nclearance_m = 50.0",
            "ellipsoid.tif: has heights above the ellipsoid (WGS84), expected mean sea level",
        ),
        ("file = []\nclearance_m = 50.0", "no file is given"),
        (
            "file = 'strips.tif'",
            "fly.toml, line 4: terrain.file is given without terrain.clearance_m",
        ),
        (
            "clearance_m = 50.0",
            "terrain.clearance_m is given without terrain.file or terrain.source",
        ),
        (
            "file = 'strips.tif'\nclearance_m = -5.0",
            "fly.toml, line 5: terrain.clearance_m is -5",
        ),
        (
            "file = 'strips.tif'\nsource = 'ground-station'\nclearance_m = 5.0",
            "expected one of them",
        ),
        ("source = 'nobody'\nclearance_m = 5.0", "fly.toml, line 4:"),
    ] {
        for arguments in [&["check", "fly.toml"][..], &flies] {
            let told = of_link(at, table, arguments, 1);
            assert!(told.contains(expected), "{told}");
        }
    }
    let table = "file = 'strips.tif'\nclearance_m = 50.0";
    let told = of_link(at, table, &["check", "fly.toml"], 0);
    let area = "knows the ground of latitude 46.50250 to 46.60000, longitude 9.20000 to 9.32250";
    assert!(told.contains(area), "{told}");
}
