//! What commands leave out of their input is counted and said, and every command reads what the others read.

use core::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::support::{errors, fga_in};

/// A log of two aircraft head-on, 9 km apart, a line a second each, with `edit` applied to the lines of the second.
fn log(edit: impl Fn(String) -> String) -> String {
    let mut text = String::new();
    for second in 0..160 {
        let (minute, in_minute) = (second / 60, second % 60);
        let degrees = f64::from(second) * 50.0 / 1852.0 / 60.0;
        for (address, latitude, track) in [("AA0001", degrees, 0), ("AA0002", 0.081 - degrees, 180)]
        {
            let line = format!(
                "MSG,3,1,1,{address},1,2024/04/30,23:{minute:02}:{in_minute:02}.000,,,,1000,97.2,{track},{latitude:.7},5.0,0,,0,0,0,0\n"
            );
            text += &if address == "AA0002" {
                edit(line)
            } else {
                line
            };
        }
    }
    text
}

fn batch(at: &Path, file: &str) -> (i32, Value, String) {
    let output = fga_in(
        at,
        &["batch", file, "--policy", "none", "--out", "out", "--json"],
    );
    let answer = serde_json::from_slice(&output.stdout).unwrap_or_default();
    (output.status.code().unwrap(), answer, errors(&output))
}

#[test]
fn t1_batch_reads_every_form_and_says_what_it_cannot_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (from, to) in [
        ("x", "x"),
        (",1000,", ",1000H,"),
        ("AA0002", "~AA0002"),
        ("MSG", "MLAT"),
        ("0,0,0,0\n", "0,0,0,0,-9,A1\n"),
    ] {
        fs::write(at.join("a.sbs"), log(|line| line.replace(from, to))).unwrap();
        let (code, answer, said) = batch(at, "a.sbs");
        assert_eq!((code, said.as_str()), (0, ""), "{from}");
        assert_eq!(
            (&answer["encounters"], &answer["separated"]),
            (&1.into(), &0.into())
        );
        assert_eq!(answer["left_out"], serde_json::json!({ "recordings": 0 }));
    }
    // One line in ten of the second is of a dialect that nobody knows.
    let mut count = 0;
    let text = log(|line| line.replace(",1000,", ",FL033,"));
    let text: String = text
        .lines()
        .map(|line| {
            count += u32::from(line.contains("FL033"));
            let keep = count % 10 != 0;
            line.replace("FL033", if keep { "1000" } else { "FL033" }) + "\n"
        })
        .collect();
    fs::write(at.join("a.sbs"), text).unwrap();
    let (code, answer, said) = batch(at, "a.sbs");
    assert_eq!(code, 0);
    let expected = "fga: left out: 16 of 320 lines or rows: 16 with an unreadable field\n";
    assert_eq!(said, expected);
    assert_eq!(answer["left_out"]["unreadable_field"], 16);
    let searched = fga_in(at, &["oracle", "a.sbs", "--out", "searched", "--json"]);
    let searched: Value = serde_json::from_slice(&searched.stdout).unwrap();
    assert_eq!(searched["left_out"], answer["left_out"]);
    let run: Value = serde_json::from_slice(&fs::read(at.join("out/run.json")).unwrap()).unwrap();
    assert!(run.to_string().contains("\"unreadable_field\":16"), "{run}");
    // Nothing of it readable: an error with the reason, not an empty sky.
    fs::write(
        at.join("a.sbs"),
        log(|line| line.replace(",1000,", ",FL033,")),
    )
    .unwrap();
    let (code, _, said) = batch(at, "a.sbs");
    assert_eq!(code, 1);
    assert!(said.contains("has 1 aircraft with positions"), "{said}");
    assert!(
        said.contains("left out: 160 of 320 lines: 160 with an unreadable field"),
        "{said}"
    );
}

#[test]
fn t1_campaigns_say_and_keep_what_they_leave_out() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let cut = log(|line| line) + "MSG,3,1,1,AA0001\n\n";
    fs::write(at.join("a.sbs"), cut).unwrap();
    fs::write(at.join("c.toml"), "policies = ['none']\n").unwrap();
    for command in ["run", "draw"] {
        let output = fga_in(
            at,
            &[
                "campaign",
                command,
                "c.toml",
                "--recordings",
                "a.sbs",
                "--out",
                command,
                "--json",
            ],
        );
        let said = errors(&output);
        assert!(output.status.success(), "{said}");
        let expected = "fga: left out: 1 of 322 lines or rows: 1 cut short\n";
        assert!(said.contains(expected), "{said}");
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        let left_out = serde_json::json!({ "cut_short": 1, "not_needed": 1 });
        assert_eq!(answer["left_out"], left_out);
    }
    let table = fs::read(at.join("run/results.parquet")).unwrap();
    let table = String::from_utf8_lossy(&table);
    assert!(table.contains("fga.left_out") && table.contains("\"cut_short\":1"));
}

#[cfg(feature = "fly")]
#[test]
fn t6_traffic_plays_what_batch_reads() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let row = |second: u32, name: &str, latitude: f64| {
        format!(
            r#"{{"timestamp":{},"icao24":"{name}","latitude":{latitude},"longitude":5,"altitude":1000,"groundspeed":97,"track":0}}"#,
            1_700_000_000 + second
        )
    };
    let rows: Vec<String> = (0..30)
        .flat_map(|s| {
            [
                row(s, "aa0001", f64::from(s) * 4e-4),
                row(s, "aa0002", 0.01 + f64::from(s) * 4e-4),
            ]
        })
        .collect();
    let mut columns = String::from("{");
    for (key, values) in [
        (
            "timestamp",
            (0..60)
                .map(|i| (1_700_000_000 + i / 2).to_string())
                .collect::<Vec<_>>(),
        ),
        (
            "icao24",
            (0..60).map(|i| format!("\"aa000{}\"", 1 + i % 2)).collect(),
        ),
        (
            "latitude",
            (0..60)
                .map(|i| format!("{}", f64::from(i) * 1e-4))
                .collect(),
        ),
        ("longitude", vec!["5".to_owned(); 60]),
        ("altitude", vec!["1000".to_owned(); 60]),
    ] {
        let comma = if columns.len() > 1 { "," } else { "" };
        let cells: Vec<String> = values
            .iter()
            .enumerate()
            .map(|(i, v)| format!("\"{i}\":{v}"))
            .collect();
        let _ = write!(columns, "{comma}\"{key}\":{{{}}}", cells.join(","));
    }
    columns.push('}');
    let files = [
        ("plain.sbs", log(|line| line)),
        (
            "readsb.log",
            log(|line| {
                line.replace("AA0002", "~AA0002")
                    .replace(",1000,", ",1000H,")
            }),
        ),
        ("rows.json", format!("[{}]", rows.join(","))),
        ("columns.json", columns),
    ];
    for (name, text) in files {
        fs::write(at.join(name), text).unwrap();
        let output = fga_in(
            at,
            &[
                "traffic",
                name,
                "--to",
                "udpout:127.0.0.1:14998",
                "--speed",
                "1000",
                "--rate",
                "50",
            ],
        );
        let said = errors(&output);
        assert!(output.status.success(), "{name}: {said}");
        assert!(
            said.ends_with("messages sent\n") && !said.starts_with("0 "),
            "{name}: {said}"
        );
        assert!(!said.contains("left out"), "{name}: {said}");
    }
    // What nobody reads is refused in one sentence.
    fs::write(
        at.join("ground.json"),
        format!(
            "[{}]",
            rows.join(",").replace("\"track\":0", "\"onground\":true")
        ),
    )
    .unwrap();
    let output = fga_in(
        at,
        &["traffic", "ground.json", "--to", "udpout:127.0.0.1:14998"],
    );
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(
        errors(&output),
        "fga: left out: 60 of 60 state vectors: 60 on the ground\n\
         fga: ground.json: has no aircraft in the air with a position and an altitude, expected at least one\n"
    );
}

#[test]
fn n11_rows_of_one_second_are_counted_by_alerts_and_bands() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let mut text = "NAME lat lon alt trk gs vs time\n".to_owned();
    for second in 0..5 {
        let _ = write!(
            text,
            "own 0 0.0{second} 1000 90 100 0 {second}\nown 0 0.0{second} 1000 90 100 0 {second}\nits 0 0.2 1000 270 100 0 {second}\n"
        );
    }
    fs::write(at.join("a.daa"), text).unwrap();
    let alerter = "alerters = one\none_alert_1_alerting_time = 55 [s]\none_alert_1_region = NEAR\none_alert_1_detector = d\n\
        one_load_core_detection_d = CDCylinder\none_d_D = 5 [nmi]\none_d_H = 1000 [ft]\n";
    // The key names an alerter that is not there, but nothing uses it.
    fs::write(
        at.join("a.conf"),
        format!("{alerter}dta_logic = 0\ndta_alerter = 3\n"),
    )
    .unwrap();
    for command in ["alerts", "bands"] {
        let output = fga_in(at, &[command, "a.daa", "--config", "a.conf", "--json"]);
        let said = errors(&output);
        assert!(output.status.success(), "{said}");
        assert_eq!(
            said,
            "fga: left out: 5 of 15 rows: 5 of a time given twice\n"
        );
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(
            (&answer["instants"], &answer["left_out"]["same_time"]),
            (&5.into(), &5.into())
        );
    }
    fs::write(
        at.join("a.conf"),
        format!("{alerter}dta_logic = 1\ndta_alerter = 3\n"),
    )
    .unwrap();
    let output = fga_in(at, &["alerts", "a.daa", "--config", "a.conf"]);
    let said = errors(&output);
    assert!(
        said.contains("dta_alerter names none of the 1 alerters"),
        "{said}"
    );
}

/// Every third byte of a drawn table changed in turn, beside the rest of its folder.
#[test]
fn l14_a_corrupt_table_in_a_drawn_folder_is_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(
        at.join("e.csv"),
        "encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m\n0,0,600,0,0,-20,0,0,30\n",
    )
    .unwrap();
    fs::write(
        at.join("c.toml"),
        "policies = ['none']\nfiles = ['e.csv']\n",
    )
    .unwrap();
    let output = fga_in(at, &["campaign", "draw", "c.toml", "--out", "drawn"]);
    assert!(output.status.success(), "{}", errors(&output));
    let path = at.join("drawn/encounters.parquet");
    let good = fs::read(&path).unwrap();
    // The footer, where numbers are that the crate of Parquet believes: every change is read or refused.
    let footer = good.len().saturating_sub(400);
    let mut refused = 0;
    for place in (footer..good.len()).step_by(8) {
        let mut bytes = good.clone();
        bytes[place] = 0xff;
        fs::write(&path, bytes).unwrap();
        let output = fga_in(at, &["batch", "drawn", "--policy", "none", "--out", "out"]);
        let said = errors(&output);
        assert!(!said.contains("panicked"), "{place}: {said}");
        if output.status.code() != Some(0) {
            refused += 1;
            assert_eq!(
                (output.status.code(), said.lines().count()),
                (Some(1), 1),
                "{place}: {said}"
            );
            assert!(said.starts_with("fga: drawn/encounters.parquet"), "{said}");
        }
    }
    assert!(refused > 5, "{refused}");
}

#[test]
fn check_counts_what_it_reads_of_every_kind_of_traffic() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let text = log(|line| line.replace(",1000,", ",FL033,"));
    fs::write(at.join("feed.sbs"), &text).unwrap();
    fs::write(at.join("pair.sbs"), log(|line| line)).unwrap();
    let mut daa = String::from(
        "NAME, lat, lon, alt, trk, gs, vs, time\nnone, deg, deg, ft, deg, knot, fpm, s\n",
    );
    for (name, lon_deg, course_deg, by_deg) in [("A", 0.0, 90, 0.001), ("B", 0.1, 270, -0.001)] {
        for second in 0..3 {
            let at_deg = lon_deg + by_deg * f64::from(second);
            writeln!(
                daa,
                "{name}, 0, {at_deg}, 1000, {course_deg}, 100, 0, {second}"
            )
            .unwrap();
        }
    }
    fs::write(at.join("pair.daa"), daa).unwrap();
    for (file, read, used, unreadable) in [
        ("feed.sbs", 320, 160, Some(160)),
        ("pair.sbs", 320, 320, None),
        ("pair.daa", 6, 6, None),
    ] {
        let output = fga_in(at, &["check", file, "--json"]);
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(answer["usable"], true, "{file}");
        assert_eq!(answer["read"], read, "{file}: {answer}");
        assert_eq!(answer["used"], used, "{file}: {answer}");
        let left_out = answer["left_out"]["unreadable_field"].as_u64();
        assert_eq!(left_out, unreadable, "{file}: {answer}");
    }
    let output = fga_in(at, &["check", "feed.sbs"]);
    let said = String::from_utf8(output.stdout).unwrap();
    let words =
        "feed.sbs: 320 lines or state vectors read, 160 used, 160 with an unreadable field\n";
    assert!(said.contains(words), "{said}");
}
