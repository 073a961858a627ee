//! Recorded encounters of every kind: the content of each file, and every refusal.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "tests fail by panicking"
)]

use crate::common::data;
use fga_formats::recordings;
use std::path::Path;

const FOOT_M: f64 = 0.3048;

#[test]
fn a_pairing_file_is_read_with_its_units() {
    let text = "NAME,          east,   north,   alt,   trk,    gs,    vs,    time\n\
        unitless,      [ft],   [ft],   [ft],  [rad],  [ftps],  [ftps], [s]\n\
        OWNSHIP, 0.000, 15.621, 2759.320, 0.00, 156.23, 0.00, 0.1\n\
        INTRUDER, 100.0, -50.0, 3000.0, 1.5707963267948966, 100.0, -5.0, 0.1\n";
    let found = recordings::parse(text.as_bytes(), Path::new("1.txt")).unwrap();
    assert_eq!((found.len(), found[0].name.as_str()), (1, "1"));
    let [own, other] = &found[0].recording.aircraft[..] else {
        panic!("two aircraft");
    };
    assert!((own.samples[0].position_m.y - 15.621 * FOOT_M).abs() < 1e-9);
    assert!((own.samples[0].velocity_mps.y - 156.23 * FOOT_M).abs() < 1e-9);
    // Track 90° is east.
    assert!((other.samples[0].velocity_mps.x - 100.0 * FOOT_M).abs() < 1e-9);
    assert!((other.samples[0].velocity_mps.z + 5.0 * FOOT_M).abs() < 1e-9);
    assert!((other.samples[0].position_m.z - 3000.0 * FOOT_M).abs() < 1e-9);
}

#[test]
fn a_degas_file_is_two_aircraft_side_by_side() {
    let head = "# xE1,xE2,xN1,xN2,h1,h2,vE1,vE2,vN1,vN2,hdot1,hdot2 [ft, ft/s], 1 Hz; made\n";
    let text =
        format!("{head}0,1000,0,0,500,600,10,-10,0,0,0,1\n10,990,0,0,500,601,10,-10,0,0,0,1\n");
    let found = recordings::parse(text.as_bytes(), Path::new("a.csv")).unwrap();
    let aircraft = &found[0].recording.aircraft;
    assert_eq!(aircraft[1].samples[1].time_s, 1.0);
    assert!((aircraft[1].samples[1].position_m.x - 990.0 * FOOT_M).abs() < 1e-9);
    assert!((aircraft[1].samples[1].position_m.z - 601.0 * FOOT_M).abs() < 1e-9);
    for (text, message) in [
        (
            head.replace("xN1,", ""),
            "a.csv, line 1: names the columns xE1,xE2,xN2,",
        ),
        (
            head.replace("1 Hz", "2 Hz"),
            "a.csv, line 1: has other units or another rate, expected",
        ),
        (head.to_owned(), "a.csv: holds no rows"),
        (
            format!("{head}1,2\n"),
            "a.csv, line 2: has 2 fields, expected 12",
        ),
        (
            format!("{head}1,2,x\n"),
            "a.csv, line 2: holds \"x\", expected a number",
        ),
    ] {
        let error = recordings::parse(text.as_bytes(), Path::new("a.csv"))
            .unwrap_err()
            .to_string();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
}

/// Two aircraft that meet head-on at the 60th second, a row each second; `also` adds a third one.
fn head_on(line: impl Fn(&str, i32, f64) -> String, also: &str) -> String {
    let mut text = String::new();
    for second in 0..120 {
        // 50 m/s east and west along the equator: a minute of arc is 1852 m.
        let degrees = f64::from(second - 60) * 50.0 / 1852.0 / 60.0;
        text.push_str(&line("AAAAAA", second, degrees));
        text.push_str(&line("BBBBBB", second, 0.0005 - degrees));
        text.push_str(&line(also, second, 3.0 - degrees));
    }
    text
}

#[test]
fn received_tracks_are_paired_where_they_come_close() {
    let sbs = head_on(
        |address, second, longitude| {
            format!(
                "{}000000000,MSG,3,1,1,{address},1,,,,,,1000,90,90,0.0,{longitude:.7},0,,0,0,0,0\n",
                second + 1
            )
        },
        "CCCCCC",
    );
    // A latitude of exactly 0 counts; only 0, 0 together is no position.
    let found = recordings::parse(sbs.as_bytes(), Path::new("r.sbs")).unwrap();
    let names: Vec<&str> = found.iter().map(|named| named.name.as_str()).collect();
    assert_eq!(names, ["r AAAAAA-BBBBBB"]);
    let recording = &found[0].recording;
    let [own, other] = [0, 1].map(|i| recording.aircraft[i].state_at(61.0).unwrap().0);
    // 0.0005° of longitude are 55.6 m.
    assert!(
        (own.distance(other) - 55.6).abs() < 0.5,
        "{}",
        own.distance(other)
    );

    let rows = head_on(
        |name, second, longitude| {
            format!(
                "{{\"timestamp\":{},\"icao24\":\"{name}\",\"latitude\":0.1,\"longitude\":{longitude:.7},\
                 \"altitude\":1000,\"groundspeed\":97.2,\"track\":90,\"vertical_rate\":0}},",
                1_600_000_000_000_i64 + i64::from(second) * 1000
            )
        },
        "CCCCCC",
    );
    let json = format!("[{}]", rows.trim_end_matches(','));
    let found = recordings::parse(json.as_bytes(), Path::new("j.json")).unwrap();
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].name, "j AAAAAA-BBBBBB");
}

#[test]
fn columns_of_json_are_the_same_as_rows() {
    let rows = "[{\"timestamp\":1,\"icao24\":\"a\",\"latitude\":1,\"longitude\":2,\"altitude\":0}]";
    let columns = "{\"timestamp\":{\"0\":1},\"icao24\":[\"a\"],\"latitude\":[1],\"longitude\":[2],\"altitude\":{\"0\":0}}";
    for text in [rows, columns] {
        let error = recordings::parse(text.as_bytes(), Path::new("j.json"))
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("j.json: has 1 aircraft with positions, of which no two come within"),
            "{error}"
        );
    }
}

#[test]
fn files_without_an_encounter_are_refused() {
    for (name, text, message) in [
        (
            "a.daa",
            "name lat lon alt trk gs vs time\nA 1 2 3 4 5 6 7\n",
            "a.daa: holds one aircraft only, expected the ownship and at least one more",
        ),
        ("j.json", "[1", "j.json: is no JSON that can be read"),
        (
            "j.json",
            "{\"a\":1}",
            "j.json: is a JSON object of something else",
        ),
        ("j.json", "[{}]", "j.json: state vector 0 has no icao24"),
        (
            "j.json",
            "[{\"icao24\":\"a\",\"timestamp\":\"x\"}]",
            "j.json: state vector 0 has the timestamp",
        ),
        (
            "x.csv",
            "hello\n",
            "x.csv, line 1: the column name|aircraft|id is missing",
        ),
    ] {
        let error = recordings::parse(text.as_bytes(), Path::new(name))
            .unwrap_err()
            .to_string();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("README.md"), "nothing").unwrap();
    let error = recordings::files_of(folder.path()).unwrap_err().to_string();
    assert!(
        error.contains("holds no recordings, expected files that end in .daa"),
        "{error}"
    );
}

#[test]
fn written_recordings_are_read_back() {
    let text = "NAME sx sy sz vx vy vz time\n[none] [m] [m] [m] [m/s] [m/s] [m/s] [s]\n\
        A 1.5 2 3 4 5 6 0\nB 10 20 30 -4 -5 -6 0\nA 5.5 7 9 4 5 6 1\nB 6 15 24 -4 -5 -6 1\n";
    let found = recordings::parse(text.as_bytes(), Path::new("a.daa")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.daa");
    fga_formats::daa::write(&path, &found[0].recording).unwrap();
    assert_eq!(recordings::read(&path).unwrap(), found);
}

#[test]
fn third_party_recordings_are_read() {
    for (path, encounters) in [
        ("pairing/1.txt", 1),
        ("pairing/2.txt", 1),
        ("degas/Headon.csv", 1),
        ("flown/NRC_Intercept1.daa", 1),
    ] {
        let Some(path) = data(path) else { return };
        let found = recordings::read(&path).unwrap();
        assert_eq!(found.len(), encounters, "{}", path.display());
        assert_eq!(found[0].recording.aircraft.len(), 2);
    }
    // README of the data: nine pairs come close.
    let Some(path) = data("tracks/calfire.json.gz") else {
        return;
    };
    assert!(recordings::read(&path).unwrap().len() >= 5);
}
