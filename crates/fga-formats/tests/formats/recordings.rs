//! Recorded encounters of every kind: the content of each file, and every refusal.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "tests fail by panicking"
)]

use crate::common::data;
use fga_formats::recordings::{self, Content};
use fga_formats::tally::LeftOut;
use std::path::Path;

const FOOT_M: f64 = 0.3048;

#[test]
fn a_pairing_file_is_read_with_its_units() {
    let text = "NAME,          east,   north,   alt,   trk,    gs,    vs,    time\n\
        unitless,      [ft],   [ft],   [ft],  [rad],  [ftps],  [ftps], [s]\n\
        OWNSHIP, 0.000, 15.621, 2759.320, 0.00, 156.23, 0.00, 0.1\n\
        INTRUDER, 100.0, -50.0, 3000.0, 1.5707963267948966, 100.0, -5.0, 0.1\n";
    let found = recordings::parse(text.as_bytes(), Path::new("1.txt"))
        .unwrap()
        .named;
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
    let found = recordings::parse(text.as_bytes(), Path::new("a.csv"))
        .unwrap()
        .named;
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
    let found = recordings::parse(sbs.as_bytes(), Path::new("r.sbs"))
        .unwrap()
        .named;
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
    let found = recordings::parse(json.as_bytes(), Path::new("j.json"))
        .unwrap()
        .named;
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
        (
            "j.json",
            "[1",
            "j.json, line 1: is no JSON that can be read",
        ),
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
    fga_formats::daa::write(&path, &found.named[0].recording).unwrap();
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
        let found = recordings::read(&path).unwrap().named;
        assert_eq!(found.len(), encounters, "{}", path.display());
        assert_eq!(found[0].recording.aircraft.len(), 2);
    }
    // README of the data: nine pairs come close.
    let Some(path) = data("tracks/calfire.json.gz") else {
        return;
    };
    assert!(recordings::read(&path).unwrap().named.len() >= 5);
}

/// Rows of a log in which the two meet, with `edit` applied to the second.
fn meeting(edit: impl Fn(String) -> String) -> String {
    head_on(
        |address, second, longitude| {
            let (minute, second) = (second / 60, second % 60);
            let line = format!(
                "MSG,3,1,1,{address},1,2024/04/30,23:59:{second:02}.000,2024/04/30,23:{minute:02}:{second:02}.000,,1000,97,90,0.1,{longitude:.7},0,,0,0,0,0\n"
            )
            .replace("23:59:", &format!("23:{minute:02}:"));
            if address == "BBBBBB" {
                edit(line)
            } else {
                line
            }
        },
        "CCCCCC",
    )
}

#[test]
fn t1_pairs_are_found_whatever_the_receiver_writes() {
    let plain = recordings::parse(meeting(|line| line).as_bytes(), Path::new("r.sbs")).unwrap();
    assert_eq!((plain.named.len(), plain.tally.lost()), (1, 0));
    let separation_m = |found: &recordings::Encounters| {
        let recording = &found.named[0].recording;
        let at_s = recording.aircraft[0].samples[0].time_s + 60.0;
        let [own, other] = [0, 1].map(|i: usize| recording.aircraft[i].state_at(at_s).unwrap().0);
        own.distance(other)
    };
    for (edit, name) in [
        ((",1000,", ",1000H,"), "r AAAAAA-BBBBBB"),
        (("BBBBBB", "~BBBBBB"), "r AAAAAA-~BBBBBB"),
        (("MSG", "MLAT"), "r AAAAAA-BBBBBB"),
        (("0,0,0,0", "0,0,0,0,-20.1,A1"), "r AAAAAA-BBBBBB"),
    ] {
        let text = meeting(|line| line.replace(edit.0, edit.1));
        let found = recordings::parse(text.as_bytes(), Path::new("r.sbs")).unwrap();
        assert_eq!(found.named[0].name, name);
        assert_eq!(found.tally, plain.tally, "{edit:?}");
        assert!((separation_m(&found) - separation_m(&plain)).abs() < 1e-9);
    }
    // Over the end of a month of 30 days the log has no gap.
    let text = plain_over_midnight();
    let found = recordings::parse(text.as_bytes(), Path::new("r.sbs")).unwrap();
    assert_eq!(found.named.len(), 1);
    assert!((separation_m(&found) - separation_m(&plain)).abs() < 1e-6);
}

fn plain_over_midnight() -> String {
    head_on(
        |address, second, longitude| {
            let (date, hour) = if second < 60 {
                ("2024/04/30", "23:59")
            } else {
                ("2024/05/01", "00:00")
            };
            let second = second % 60;
            format!(
                "MSG,3,1,1,{address},1,{date},{hour}:{second:02}.000,,,,1000,97,90,0.1,{longitude:.7},0,,0,0,0,0\n"
            )
        },
        "CCCCCC",
    )
}

#[test]
fn t4_positions_without_use_are_counted_by_reason() {
    use fga_formats::tally::LeftOut;
    let mut text = meeting(|line| line);
    for line in [
        // Without any altitude.
        "MSG,3,1,1,DDDDDD,1,2024/04/30,23:01:00.000,,,,,97,90,0.1,0.1,0,,0,0,0,0",
        // Once only.
        "MSG,3,1,1,EEEEEE,1,2024/04/30,23:01:00.000,,,,1000,97,90,0.1,0.1,0,,0,0,0,0",
        // On the ground, also where a later message does not say so.
        "MSG,2,1,1,FFFFF1,1,2024/04/30,23:01:00.000,,,,0,10,90,0.1,0.1,0,,0,0,0,-1",
        "MSG,3,1,1,FFFFF1,1,2024/04/30,23:01:01.000,,,,0,10,90,0.1,0.1,0,,0,0,0,",
        // A second position at one time, a heartbeat, and a line that ends too early.
        "MSG,3,1,1,AAAAAA,1,2024/04/30,23:01:00.000,,,,1000,97,90,0.1,0.1,0,,0,0,0,0",
        "",
        "MSG,3,1,1,AAAAAA,1,2024/04/30,23:01:",
    ] {
        text.push_str(line);
        text.push('\n');
    }
    let found = recordings::parse(text.as_bytes(), Path::new("r.sbs")).unwrap();
    assert_eq!(found.named.len(), 1);
    let tally = found.tally;
    assert_eq!((tally.read(), tally.used, tally.lost()), (367, 360, 6));
    for (reason, count) in [
        (LeftOut::NoAltitude, 1),
        (LeftOut::Alone, 1),
        (LeftOut::OnGround, 2),
        (LeftOut::SameTime, 1),
        (LeftOut::NotNeeded, 1),
        (LeftOut::CutShort, 1),
    ] {
        assert_eq!(tally.left_out(reason), count, "{reason:?}");
    }
}

/// State vectors of two that meet, on the ground or not.
fn states(onground: &str) -> String {
    let rows = head_on(
        |name, second, longitude| {
            format!(
                "{{\"timestamp\":{},\"icao24\":\"{name}\",\"latitude\":0.1,\"longitude\":{longitude:.7},\
                 \"altitude\":1000,\"groundspeed\":97.2,\"track\":90,\"vertical_rate\":0,\"onground\":{onground}}},",
                1_600_000_000 + second
            )
        },
        "CCCCCC",
    );
    format!("[{}]", rows.trim_end_matches(','))
}

#[test]
fn t5_aircraft_on_the_ground_are_no_encounter_in_any_format() {
    let found = recordings::parse(states("false").as_bytes(), Path::new("j.json")).unwrap();
    assert_eq!(found.named.len(), 1);
    let taxiing = meeting(|line| line).replace("0,0,0,0\n", "0,0,0,-1\n");
    for (text, name, parts) in [
        (
            states("true"),
            "j.json",
            "360 of 360 state vectors: 360 on the ground",
        ),
        (
            states("1"),
            "j.json",
            "360 of 360 state vectors: 360 on the ground",
        ),
        (taxiing, "r.sbs", "360 of 360 lines: 360 on the ground"),
    ] {
        let error = recordings::parse(text.as_bytes(), Path::new(name))
            .unwrap_err()
            .to_string();
        assert!(error.contains("has 0 aircraft with positions"), "{error}");
        assert!(error.ends_with(&format!("; left out: {parts}")), "{error}");
    }
}

/// Two aircraft 9 km apart, head-on at 51.4 m/s each, as one instant of a receiver's list.
#[test]
fn t7_an_instant_of_readsb_or_opensky_is_read_and_flies_on() {
    let readsb = r#"{"now":1700000000.1,"messages":100,"aircraft":[
        {"hex":"aa0001","flight":"ONE     ","alt_baro":2000,"alt_geom":2100,"gs":100.0,"track":0.0,"baro_rate":0,"lat":45.0,"lon":5.0,"seen_pos":0.1},
        {"hex":"~aa0002","alt_geom":2000,"gs":100.0,"track":180.0,"lat":45.08,"lon":5.0,"seen_pos":0.1,"seen":0.1},
        {"hex":"aa0003","alt_baro":"ground","gs":3.0,"lat":45.01,"lon":5.0,"seen_pos":0.1},
        {"hex":"aa0004","alt_baro":2000,"gs":3.0,"lat":45.01,"lon":5.0,"seen_pos":80},
        {"hex":"aa0005","alt_baro":2000,"seen":0.1},
        {"alt_baro":2000,"lat":45.01,"lon":5.0},
        {"hex":"aa0006","lat":45.01,"lon":5.0,"seen":0.1}]}"#;
    let opensky = r#"{"time":1700000000,"states":[
        ["aa0001","ONE     ","X",1699999999,1700000000,5.0,45.0,609.6,false,51.444,0.0,0.0,null,640.0,"7000",false,0],
        ["aa0002","TWO     ","X",1699999999,1700000000,5.0,45.08,null,false,51.444,180.0,0.0,null,609.6,"7000",false,0],
        ["aa0003","","X",1699999999,1700000000,5.0,45.01,0,true,3.0,180.0,0.0,null,0,"7000",false,0],
        ["aa0004","","X",1699999900,1700000000,5.0,45.01,600,false,3.0,180.0,0.0,null,0,"7000",false,0],
        ["aa0005","","X",null,1700000000,null,null,600,false,3.0,180.0,0.0,null,0,"7000",false,0],
        [null,"","X",1699999999,1700000000,5.0,45.01,600,false,3.0,180.0,0.0,null,0,"7000",false,0],
        ["aa0006","","X",1699999999,1700000000,5.0,45.01,null,false,3.0,180.0,0.0,null,null,"7000",false,0]]}"#;
    for (text, name) in [(readsb, "a aa0001-~aa0002"), (opensky, "a aa0001-aa0002")] {
        let found = recordings::parse(text.as_bytes(), Path::new("a.json")).unwrap();
        assert_eq!(found.named.len(), 1);
        assert_eq!(found.named[0].name, name);
        assert_eq!(
            found.tally.words("state vectors").unwrap(),
            "5 of 7 state vectors: 1 without an address, 1 without a position, 1 without an altitude, 1 on the ground, 1 too old"
        );
        let aircraft = &found.named[0].recording.aircraft;
        // 8.9 km at 103 m/s: they meet after 86 s.
        let at_s = aircraft[0].samples[0].time_s + 86.4;
        let [a, b] = [0, 1].map(|i: usize| aircraft[i].state_at(at_s).unwrap().0);
        assert!(a.distance(b) < 60.0, "{}", a.distance(b));
    }
    // Several instants in one file, one after the other or as a list: real tracks.
    let later = readsb
        .replace("1700000000.1", "1700000020.1")
        .replace("\"lat\":45.0,", "\"lat\":45.00925,");
    for text in [format!("{readsb}\n{later}"), format!("[{readsb},{later}]")] {
        let found = recordings::parse(text.as_bytes(), Path::new("a.json"));
        let error = found.unwrap_err().to_string();
        assert!(error.contains("has 2 aircraft with positions"), "{error}");
        assert!(error.contains("10 of 14 state vectors"), "{error}");
    }
    let nothing = recordings::parse(br#"{"time":1,"states":null}"#, Path::new("a.json"));
    let error = nothing.unwrap_err().to_string();
    assert!(error.contains("has 0 aircraft with positions"), "{error}");
}

#[test]
fn n11_the_last_of_several_rows_of_a_second_stands_and_is_counted() {
    let text = "NAME sx sy sz vx vy vz time\n[none] [m] [m] [m] [m/s] [m/s] [m/s] [s]\n\
        A 1 2 3 4 5 6 0\nA 2 2 3 4 5 6 0\nB 10 20 30 -4 -5 -6 0\nB 11 20 30 -4 -5 -6 0\nA 5 7 9 4 5 6 1\nB 6 15 24 -4 -5 -6 1\n";
    let found = recordings::parse(text.as_bytes(), Path::new("a.daa")).unwrap();
    let aircraft = &found.named[0].recording.aircraft;
    assert_eq!(aircraft[0].samples.len(), 2);
    assert_eq!(aircraft[0].samples[0].position_m.x, 2.0);
    assert_eq!(aircraft[1].samples[0].position_m.x, 11.0);
    assert_eq!(
        found.tally.words("rows").unwrap(),
        "2 of 6 rows: 2 of a time given twice"
    );
    let instants = fga_formats::daa::instants::parse(text, Path::new("a.daa")).unwrap();
    let counts: Vec<usize> = instants
        .instants
        .iter()
        .map(|at| at.reports.len())
        .collect();
    assert_eq!(counts, [2, 2]);
    assert_eq!(instants.instants[0].reports[0].place.altitude_m(), 3.0);
    assert_eq!(instants.tally, found.tally);
}

/// The trial's inputs, where they are.
#[test]
fn t1_t5_t6_t7_the_inputs_of_a_trial_are_read() {
    for (file, pairs) in [
        ("sbs_plain.sbs.gz", Some(1)),
        ("sbs_gnss_h.sbs.gz", Some(1)),
        ("sbs_gnss_h_third_aircraft.sbs.gz", Some(3)),
        ("sbs_non_icao_tilde.sbs.gz", Some(1)),
        ("json_columns.json.gz", Some(1)),
        ("json_onground.json.gz", None),
        ("opensky_states.json", Some(1)),
        ("readsb_aircraft.json", None),
    ] {
        let Some(path) = data(&format!("trials/2026-11-25/{file}")) else {
            return;
        };
        let found = recordings::read(&path);
        assert_eq!(found.ok().map(|found| found.named.len()), pairs, "{file}");
    }
}

/// A digit that was received wrong: the position is left out and counted, and no way there makes an encounter.
#[test]
fn t1_a_position_out_of_reach_is_left_out_and_counted() {
    use fga_formats::tally::LeftOut;
    let plain = recordings::parse(meeting(|line| line).as_bytes(), Path::new("r.sbs")).unwrap();
    for far in [",,1000,97,90,0.1,50.0,", ",,1000,97,90,-44.1,0.0,"] {
        let text = meeting(|line| {
            if line.contains("23:00:30") {
                let end = line.find(",,1000").unwrap();
                format!("{}{far}0,,0,0,0,0\n", &line[..end])
            } else {
                line
            }
        });
        let found = recordings::parse(text.as_bytes(), Path::new("r.sbs")).unwrap();
        assert_eq!(found.tally.left_out(LeftOut::Jump), 1, "{far}");
        assert_eq!(found.tally.read(), plain.tally.read());
        let [own, other] = [&plain, &found].map(|found| found.named[0].recording.clone());
        let at_s = own.aircraft[1].samples[0].time_s + 30.0;
        let [a, b] = [own, other].map(|it| it.aircraft[1].state_at(at_s).unwrap().0);
        assert!(a.distance(b) < 0.1, "{far}: {a} {b}");
    }
    // Two senders of one address: no position of the mixture is in reach.
    let text = meeting(|line| {
        let other = line.replace(".000", ".500").replace(",0.1,", ",9.1,");
        format!("{line}{other}")
    });
    let error = recordings::parse(text.as_bytes(), Path::new("r.sbs")).unwrap_err();
    assert!(error.message.contains("out of reach"), "{error}");
}

#[test]
fn positions_out_of_reach_go_however_many_follow_each_other() {
    use fga_formats::tally::LeftOut;
    let plain = recordings::parse(meeting(|line| line).as_bytes(), Path::new("r.sbs")).unwrap();
    let span = |found: &recordings::Encounters| found.named[0].recording.aircraft[1].samples.len();
    for many in [2, 5, 15] {
        let text = meeting(|line| {
            let second = |second: u64| line.contains(&format!("23:00:{second:02}"));
            if (30..30 + many).any(second) {
                line.replace(",0.1,", ",7.1,")
            } else {
                line
            }
        });
        let found = recordings::parse(text.as_bytes(), Path::new("r.sbs")).unwrap();
        assert_eq!(found.named.len(), plain.named.len());
        assert_eq!(found.tally.left_out(LeftOut::Jump), many);
        assert_eq!(span(&found) as u64, span(&plain) as u64 - many);
    }
}

#[test]
fn aircraft_of_older_receivers_are_read() {
    let with = |names: [&str; 3]| {
        let aircraft = |hex: &str, lon: f64, track: f64| {
            let [altitude, speed, rate] = names;
            format!(
                r#"{{"hex":"{hex}","{altitude}":3000,"{speed}":100,"track":{track},"{rate}":640,"lat":45.0,"lon":{lon},"seen":0.1}}"#
            )
        };
        let text = format!(
            r#"{{"now":1700000000.0,"aircraft":[{},{},{{"hex":"aa0003","{}":"ground","lat":45.0,"lon":5.0,"seen":0.1}}]}}"#,
            aircraft("aa0001", 4.96, 90.0),
            aircraft("aa0002", 5.04, 270.0),
            names[0],
        );
        recordings::parse(text.as_bytes(), Path::new("a.json")).unwrap()
    };
    let new = with(["alt_baro", "gs", "baro_rate"]);
    assert_eq!(
        (new.named.len(), new.tally.used, new.tally.lost()),
        (1, 2, 1)
    );
    assert_eq!(with(["altitude", "speed", "vert_rate"]), new);
}

#[test]
fn traces_of_readsb_and_the_history_of_opensky_are_read() {
    let trace = |icao: &str, west: f64, track: f64| {
        let rows: Vec<String> = (0..60)
            .map(|second| {
                let lon = west + f64::from(second) * 6.5e-4 * if track < 180.0 { 1.0 } else { -1.0 };
                format!("[{second},45.0,{lon:.6},3000,99.9,{track},0,0,null,\"adsb_icao\",3117,null,null,null]")
            })
            .collect();
        format!(
            r#"{{"icao":"{icao}","timestamp":1700000000,"trace":[{}]}}"#,
            rows.join(",")
        )
    };
    let text = format!(
        "{}\n{}",
        trace("aa0001", 4.98, 90.0),
        trace("aa0002", 5.02, 270.0)
    );
    let found = recordings::parse(text.as_bytes(), Path::new("a.json")).unwrap();
    assert_eq!((found.named.len(), found.tally.used), (1, 120));
    let mut table = String::from(
        "time,icao24,lat,lon,velocity,heading,vertrate,callsign,onground,baroaltitude,geoaltitude,lastposupdate\n",
    );
    for second in 0..60 {
        let [a, b] = [
            4.98 + f64::from(second) * 6.5e-4,
            5.02 - f64::from(second) * 6.5e-4,
        ];
        for (icao, lon, track) in [("aa0001", a, 90.0), ("aa0002", b, 270.0)] {
            let time = 1_700_000_000 + second;
            table += &[
                format!("{time},{icao},45.0,{lon:.6},51.4,{track},0.0"),
                format!(",T,False,914.4,950,{time}.0\n"),
            ]
            .concat();
        }
    }
    table += "1700000060,aa0003,45.0,5.0,0,0,0,,True,,,1700000060.0\n1700000060,,45.0,5.0,0,0,0,,False,914.4,,\n";
    table += "1700000060,aa0004,45.0,x,0,0,0,,False,914.4,,\n1700000060,aa0004,NULL,,0,0,0,,False,914.4,,\n";
    let history = recordings::parse(table.as_bytes(), Path::new("a.csv")).unwrap();
    assert_eq!((history.named.len(), history.tally.used), (1, 120));
    assert_eq!(
        history.tally.words("rows").unwrap(),
        "4 of 124 rows: 1 with an unreadable field, 1 without an address, 1 without a position, 1 on the ground"
    );
    let place =
        |found: &recordings::Encounters| found.named[0].recording.aircraft[1].samples[9].position_m;
    assert!(place(&found).distance(place(&history)) < 0.1);
}

#[test]
fn t1_odd_bytes_and_letters_hide_no_aircraft() {
    let plain = recordings::parse(meeting(|line| line).as_bytes(), Path::new("r.sbs")).unwrap();
    let odd = [
        meeting(|line| line).replace('\n', "\r\n"),
        format!("\u{feff}{}", meeting(|line| line)),
        meeting(|line| line.to_lowercase().replace("msg", "MSG")),
        // Bytes of a program that was stopped while it wrote.
        format!("{}MSG,3,1,1,AAAA\0\0\0\0", meeting(|line| line)),
    ];
    for text in odd {
        let found = recordings::parse(text.as_bytes(), Path::new("r.sbs")).unwrap();
        assert_eq!(found.named, plain.named);
        assert_eq!(found.tally.used, plain.tally.used);
        assert!(found.tally.lost() <= 1);
    }
    // One aircraft, whatever the case of its address.
    let text = states("false");
    let mixed = text.replace(
        "\"BBBBBB\",\"latitude\":0.1,\"longitude\":0.00",
        "\"bbbbbb\",\"latitude\":0.1,\"longitude\":0.00",
    );
    assert_ne!(text, mixed);
    let [plain, mixed] =
        [text, mixed].map(|text| recordings::parse(text.as_bytes(), Path::new("j.json")).unwrap());
    assert_eq!(
        (mixed.named.len(), mixed.tally),
        (plain.named.len(), plain.tally)
    );
    // Nobody's name is no name: these are not one aircraft.
    let nobody = states("false").replacen("CCCCCC", " ", 7);
    let found = recordings::parse(nobody.as_bytes(), Path::new("j.json")).unwrap();
    assert_eq!(
        found.tally.left_out(fga_formats::tally::LeftOut::NoAddress),
        7
    );
}

/// Microseconds taken for milliseconds would put the aircraft into another age, and nanoseconds all at one moment.
#[test]
fn t1_times_in_another_unit_are_refused() {
    for (more, from) in [
        ("000000", 1_600_000_000_000_000_u64),
        ("000000000", 1_600_000_000_000_000_000),
    ] {
        let text = states("false").replace("\"timestamp\":16", "\"timestamp\":16\u{0}");
        let text = text.split('\u{0}').enumerate().map(|(index, part)| {
            if index == 0 {
                part.to_owned()
            } else {
                let (digits, rest) = part.split_at(8);
                format!("{digits}{more}{rest}")
            }
        });
        let text: String = text.collect();
        assert!(text.contains(&from.to_string()), "{}", &text[..100]);
        let error = recordings::parse(text.as_bytes(), Path::new("j.json")).unwrap_err();
        assert!(
            error
                .message
                .contains("expected milliseconds or seconds since 1970"),
            "{error}"
        );
    }
}

/// The true airspeeds are those of `BlueSky` 1.1.1 (`tools/aero.py`, `cas2tas` and `mach2tas`).
#[test]
fn aircraft_of_a_bluesky_scenario_fly_straight_until_a_command_that_is_not_read() {
    let text = "# made\n\n00:00:00.00>ASAS ON\n00:00:00.00>CRE KL1,B744,45.0,4.9,90,FL030,100\n\
        0:00:10>cre KL2 A320 45.0 5.0 270 3000 100\n00:00:10.00>CRE KL3,B744,45,6,0,FL100,250kts\n\
        00:00:10.00>CRE KL4,B744,45,7,0,FL350,M.78\n00:00:20.00>HDG KL4,90\n00:00:40>KL4 ALT FL200\n\
        00:00:40>CRE KL1,B744,45,4,9,90,3\n00:00:40>CRE KL9,B744,EHAM,RWY18L,9,90,3\n00:01>CRE KL8,B744,45,6,9,90,3\n\
        00:00:40>CRE KL7,B744,45,6,9\n00:00:40>\n";
    let path = Path::new("a.scn");
    let recordings::Content::States(received) =
        recordings::parse_content(text.as_bytes(), path).unwrap()
    else {
        panic!("aircraft");
    };
    let of = |name: &str| {
        let mut tracks = received.tracks.iter();
        &tracks.find(|track| track.name == name).unwrap().heard
    };
    for (name, knots, count) in [
        ("KL1", 104.501, 61),
        ("KL3", 288.702, 61),
        ("KL4", 449.607, 2),
    ] {
        let heard = of(name);
        let speed_mps = heard[0].velocity_mps.unwrap().length();
        let expected_mps = knots * 1852.0 / 3600.0;
        assert!(
            (speed_mps - expected_mps).abs() < 0.02,
            "{name}: {speed_mps}"
        );
        let way_m = heard[0].place.distance_m(heard[1].place);
        assert!(
            (way_m / expected_mps / 10.0 - 1.0).abs() < 0.006,
            "{name}: {way_m}"
        );
        assert_eq!(heard.len(), count, "{name}");
    }
    assert_eq!(of("KL2")[0].time_s, 10.0);
    assert!((of("KL2")[0].place.altitude_m - 914.4).abs() < 1e-9);
    let tally = received.tally;
    let counts: Vec<(&str, u64)> = tally
        .reasons()
        .map(|(reason, count)| (reason.name(), count))
        .collect();
    let expected = [
        ("not_needed", 1),
        ("unknown_kind", 2),
        ("cut_short", 2),
        ("unreadable_field", 2),
        ("same_time", 1),
    ];
    assert_eq!((tally.used, &counts[..]), (4, &expected[..]));
    assert_eq!(
        received.notes,
        [
            "not read, ALT (1), ASAS (1), HDG (1): an aircraft flies straight until the first command about it"
        ]
    );
    let pairs = recordings::parse(text.as_bytes(), path).unwrap().named;
    assert_eq!(pairs.len(), 1);
    assert_eq!(pairs[0].name, "a KL1-KL2");
}

#[test]
fn a_log_of_px4_with_traffic_is_an_encounter_of_the_vehicle() {
    use crate::flight_log::px4;
    let mut bytes = b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0".to_vec();
    let own = "vehicle_global_position:uint64_t timestamp;double lat;double lon;float alt;";
    let other = "transponder_report:uint64_t timestamp;double lat;double lon;uint32_t icao_address;float altitude;float heading;\
        float hor_velocity;float ver_velocity;uint16_t flags;uint8_t altitude_type;uint8_t tslc;";
    for (number, format) in [(0_u8, own), (1, other)] {
        bytes.extend(px4(b'F', format.as_bytes()));
        let name = format.split(':').next().unwrap();
        bytes.extend(px4(b'A', &[&[0, number, 0], name.as_bytes()].concat()));
    }
    let degrees = |at: [f64; 2]| at.map(f64::to_le_bytes).concat();
    let floats = |values: &[f32]| {
        values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect()
    };
    for step in 0..600_u32 {
        let time_s = 0.1 * f64::from(step);
        let time = (u64::from(step) * 100_000).to_le_bytes();
        let mut data = |number: u8, content: &[Vec<u8>]| {
            bytes.extend(px4(
                b'D',
                &[&[number, 0], &time[..], &content.concat()].concat(),
            ));
        };
        data(0, &[degrees([47.0, 8.0 + 2e-4 * time_s]), floats(&[500.0])]);
        if step % 10 == 0 {
            // A second old, to the west at 30 m/s; the last three have no place, no altitude, no velocity.
            let flags = match step {
                570 => 0_u16,
                580 => 1,
                590 => 3,
                _ => 15,
            };
            let report: Vec<f32> = vec![520.0, -core::f32::consts::FRAC_PI_2, 30.0, 1.0];
            data(
                1,
                &[
                    degrees([47.001, 8.02 - 4e-4 * (time_s - 1.0)]),
                    0x4B_1234_u32.to_le_bytes().to_vec(),
                    floats(&report),
                    flags.to_le_bytes().to_vec(),
                    vec![0, 1],
                ],
            );
        }
    }
    let Content::States(received) = recordings::parse_content(&bytes, Path::new("a.ulg")).unwrap()
    else {
        panic!("states");
    };
    assert_eq!(received.tracks.len(), 2);
    assert_eq!(received.tracks[0].heard.len(), 300);
    assert_eq!(received.tracks[1].name, "4B1234");
    let first = received.tracks[1].heard[0];
    let velocity_mps = first.velocity_mps.unwrap();
    assert!((first.time_s + 1.0).abs() < 1e-9 && first.place.altitude_m == 520.0);
    assert!((velocity_mps.x + 30.0).abs() < 1e-5 && velocity_mps.y.abs() < 1e-5);
    assert_eq!(received.tracks[1].heard.last().unwrap().velocity_mps, None);
    assert_eq!(received.tally.left_out(LeftOut::NoPosition), 1);
    assert_eq!(received.tally.left_out(LeftOut::NoAltitude), 1);
    assert_eq!(received.notes.len(), 1);
    let encounters = recordings::parse(&bytes, Path::new("a.ulg")).unwrap();
    assert_eq!(encounters.named[0].name, "a (PX4)-4B1234");
    let recording = &encounters.named[0].recording;
    assert_eq!(recording.aircraft[0].name, "(PX4)");
    assert!(recordings::is_recording(&bytes, Path::new("a.ulg")));
}
