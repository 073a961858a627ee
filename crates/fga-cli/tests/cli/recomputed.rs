//! The numbers of recorded encounters against code that shares nothing with the program: the script
//! `tests/recompute/flown.py`, and functions of this file.

use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::support::{data, errors, fga_in, repository, rows};

const CAMPAIGN: &str = "name = 'flown'\npolicies = ['turn-aware']\n";
const POLICY: &str = "turn-aware";

#[test]
fn the_numbers_of_flown_encounters_are_those_of_a_script_that_reads_the_tracks() {
    let Some(recordings) = data("flown") else {
        return;
    };
    let vehicle = repository().join("vehicles/general-aviation-well-clear.toml");
    let vehicle = vehicle.to_str().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let campaign = format!("{CAMPAIGN}vehicle = '{vehicle}'\n");
    fs::write(at.join("flown.toml"), campaign).unwrap();
    let recordings = recordings.canonicalize().unwrap();
    let from = recordings.to_str().unwrap();
    let run = [
        "campaign",
        "run",
        "flown.toml",
        "--recordings",
        from,
        "--csv",
        "--out",
        "campaign",
    ];
    let output = fga_in(at, &run);
    assert!(output.status.success(), "{}", errors(&output));
    for entry in recordings.read_dir().unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|is| is == "daa") {
            let out = format!("runs/{}", path.file_stem().unwrap().to_str().unwrap());
            let recording = path.to_str().unwrap();
            let options = ["--policy", POLICY, "--vehicle", vehicle, "--out", &out];
            // 2 is the exit code of a flight that entered a volume.
            let output = fga_in(at, &[&["run", recording][..], &options[..]].concat());
            assert!(
                matches!(output.status.code(), Some(0 | 2)),
                "{}",
                errors(&output)
            );
        }
    }
    let output = Command::new("python3")
        .arg(repository().join("tests/recompute/flown.py"))
        .args([&recordings, &at.join("campaign"), &at.join("runs")])
        .arg(POLICY)
        .output()
        .expect("python3 is installed");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", errors(&output));
    assert!(said.contains("; 0 differences"), "{said}");
}

/// The results of recordings that are flown as they were recorded.
fn without_avoidance(recordings: &Path) -> Vec<HashMap<String, String>> {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let vehicle = repository().join("vehicles/general-aviation.toml");
    let vehicle = vehicle.display();
    let campaign = format!("name = 'recorded'\npolicies = ['none']\nvehicle = '{vehicle}'\n");
    fs::write(at.join("recorded.toml"), campaign).unwrap();
    let from = recordings.canonicalize().unwrap();
    let options = ["--csv", "--out", "out"];
    let run = [
        "campaign",
        "run",
        "recorded.toml",
        "--recordings",
        from.to_str().unwrap(),
    ];
    let output = fga_in(at, &[&run[..], &options[..]].concat());
    assert!(output.status.success(), "{}", errors(&output));
    rows(&at.join("out/results.csv"))
}

/// An aircraft of a recording: seconds, degrees, degrees, metres.
type Rows = Vec<(f64, f64, f64, f64)>;

/// Both aircraft of a recording, read with code of this test alone.
fn recorded(path: &Path) -> [Rows; 2] {
    let text = fs::read_to_string(path).unwrap();
    let mut names: Vec<String> = Vec::new();
    let mut rows: [Rows; 2] = Default::default();
    for line in text.lines().skip(2) {
        let fields: Vec<&str> = line
            .split(|c: char| c == ',' || c.is_whitespace())
            .filter(|field| !field.is_empty())
            .collect();
        if fields.len() < 8 {
            continue;
        }
        if !names.iter().any(|name| name == fields[0]) {
            names.push(fields[0].to_owned());
        }
        let index = names.iter().position(|name| name == fields[0]).unwrap();
        let number = |place: usize| fields[place].parse::<f64>().unwrap();
        rows[index].push((number(7), number(1), number(2), number(3) * 0.3048));
    }
    rows
}

/// Least horizontal separation and the vertical one at that time, and whether it is below 500 ft and
/// 100 ft, or 2,000 ft and 250 ft, at once; in the plane that touches the sphere of 1' = 1 nmi at the
/// first place, linear between rows, a hundred samples between two times.
fn measured(rows: &[Rows; 2]) -> (f64, f64, bool, bool) {
    const RADIUS_M: f64 = 60.0 * 180.0 / core::f64::consts::PI * 1852.0;
    let origin = rows[0][0];
    let local = |row: &(f64, f64, f64, f64)| {
        let (latitude, from) = (row.1.to_radians(), origin.1.to_radians());
        let east = (row.2 - origin.2).to_radians();
        [
            RADIUS_M * latitude.cos() * east.sin(),
            RADIUS_M * (from.cos() * latitude.sin() - from.sin() * latitude.cos() * east.cos()),
            row.3,
        ]
    };
    let at = |aircraft: &Rows, time_s: f64| {
        let next = aircraft
            .partition_point(|row| row.0 <= time_s)
            .clamp(1, aircraft.len() - 1);
        let (a, b) = (&aircraft[next - 1], &aircraft[next]);
        let share = (time_s - a.0) / (b.0 - a.0);
        let (a, b) = (local(a), local(b));
        [0, 1, 2].map(|axis: usize| a[axis] + share * (b[axis] - a[axis]))
    };
    let [own, its] = rows;
    let from_s = own[0].0.max(its[0].0);
    let to_s = own[own.len() - 1].0.min(its[its.len() - 1].0);
    let mut times: Vec<f64> = own
        .iter()
        .chain(its)
        .map(|row| row.0)
        .filter(|time_s| (from_s..=to_s).contains(time_s))
        .collect();
    times.extend([from_s, to_s]);
    times.sort_by(f64::total_cmp);
    let (mut least_m, mut then_m, mut nmac, mut lowc) = (f64::INFINITY, 0.0, false, false);
    for pair in times.windows(2) {
        for look in 0..=100 {
            let time_s = pair[0] + (pair[1] - pair[0]) * f64::from(look) / 100.0;
            let (a, b) = (at(own, time_s), at(its, time_s));
            let horizontal_m = (a[0] - b[0]).hypot(a[1] - b[1]);
            let vertical_m = (a[2] - b[2]).abs();
            if horizontal_m < least_m {
                (least_m, then_m) = (horizontal_m, vertical_m);
            }
            nmac |= horizontal_m < 152.4 && vertical_m < 30.48;
            lowc |= horizontal_m < 609.6 && vertical_m < 76.2;
        }
    }
    (least_m, then_m, nmac, lowc)
}

#[test]
fn separations_of_every_flown_recording_are_those_of_another_computation() {
    let Some(folder) = data("flown") else {
        return;
    };
    let rows = without_avoidance(&folder);
    assert_eq!(rows.len(), 58);
    let mut counts = (0, 0);
    for row in rows {
        let name = &row["name"];
        let (horizontal_m, vertical_m, nmac, lowc) =
            measured(&recorded(&folder.join(format!("{name}.daa"))));
        let near = |column: &str, value: f64| {
            let found: f64 = row[column].parse().unwrap();
            assert!(
                (found - value).abs() <= 0.01,
                "{name} {column}: {found} {value}"
            );
        };
        near("nominal_horizontal_m", horizontal_m);
        near("nominal_vertical_m", vertical_m);
        near("horizontal_m", horizontal_m);
        assert_eq!(row["nominal_nmac"], nmac.to_string(), "{name}");
        assert_eq!(row["nominal_lowc"], lowc.to_string(), "{name}");
        counts.0 += u32::from(nmac);
        counts.1 += u32::from(lowc);
    }
    assert_eq!(counts, (27, 41));
}

/// DEGAS's check case: head-on at 500 kn each, 2,500 ft aside, a descent of 1,500 ft/min.
#[test]
fn the_check_case_of_degas_loses_well_clear_as_it_should() {
    let Some(file) = data("degas/Headon.csv") else {
        return;
    };
    let row = &without_avoidance(&file)[0];
    let number = |column: &str| -> f64 { row[column].parse().unwrap() };
    // By hand from the columns of the file: 2,500 ft aside; at the closest approach, in the 100th
    // second, 6,000 ft against 8,000 − 25 · 100 ft = 5,500 ft.
    assert!((number("nominal_horizontal_m") - 2500.0 * 0.3048).abs() < 0.5);
    assert!((number("nominal_vertical_m") - 500.0 * 0.3048).abs() < 3.0);
    assert!((number("cpa_s") - 100.0).abs() < 0.5, "{}", number("cpa_s"));
    assert!((number("closing_mps") - 843.0 * 0.3048).abs() < 1.0);
    // Well clear of DO-365B is 0.66 nmi = 4,010 ft, 35 s and 450 ft: the vertical separation is below
    // 450 ft from the 62nd to the 98th second, when τ is within 35 s and the miss 2,500 ft.
    assert_eq!(
        (row["nominal_do365"].as_str(), row["nominal_nmac"].as_str()),
        ("true", "false")
    );
    let severity = number("nominal_severity");
    assert!(severity > 0.0 && severity < 1.0, "{severity}");
}
