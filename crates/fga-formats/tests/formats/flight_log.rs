//! Logs that are made here, byte by byte, from a flight whose figures are known.
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "logs hold small whole numbers"
)]

use fga_formats::flight_log::{COLUMNS, FlightLog, parse};
use std::path::Path;

/// Time, airspeed, commanded bank, bank, course and climb, in the units of [`COLUMNS`].
fn flight(rows: usize, period_s: f64) -> Vec<[f64; 6]> {
    (0..rows)
        .map(|row| {
            let time_s = row as f64 * period_s;
            let bank = 0.4 * libm::sin(time_s);
            [time_s, 20.0, bank + 0.05, bank, 0.3 * time_s, 0.1]
        })
        .collect()
}

fn csv(rows: &[[f64; 6]]) -> String {
    let mut text = format!("{}\n", COLUMNS.join(","));
    for row in rows {
        text += &row.map(|value| value.to_string()).join(",");
        text += "\n";
    }
    text
}

fn parsed(bytes: &[u8]) -> Result<FlightLog, String> {
    parse(bytes, Path::new("log")).map_err(|error| error.to_string())
}

fn near(log: &FlightLog, rows: &[[f64; 6]], within: f64) {
    let piece = &log.pieces[0];
    assert_eq!(log.pieces.len(), 1);
    assert!(
        piece.len() + 3 >= rows.len(),
        "{} of {}",
        piece.len(),
        rows.len()
    );
    for (index, bank) in piece.bank_rad.iter().enumerate() {
        let row = rows[index];
        assert!((piece.airspeed_mps[index] - row[1]).abs() < within);
        assert!(
            (piece.bank_command_rad[index] - row[2]).abs() < within,
            "row {index}"
        );
        assert!((bank - row[3]).abs() < within, "row {index}");
        let turned = piece.course_rad[index] - piece.course_rad[0];
        assert!(
            (turned - (row[4] - rows[0][4])).abs() < within,
            "row {index}"
        );
        assert!(
            (piece.climb_rad[index] - row[5]).abs() < within,
            "row {index}"
        );
    }
}

#[test]
fn columns_at_a_steady_rate_are_taken_as_they_are() {
    let rows = flight(300, 0.05);
    let log = parsed(csv(&rows).as_bytes()).unwrap();
    assert!((log.period_s - 0.05).abs() < 1e-9);
    assert_eq!(log.pieces[0].len(), 300);
    near(&log, &rows, 1e-9);
}

#[test]
fn a_gap_and_time_on_the_ground_split_a_log() {
    let mut rows = flight(900, 0.05);
    rows.retain(|row| !(10.0..13.0).contains(&row[0]));
    for row in &mut rows {
        if (25.0..26.0).contains(&row[0]) {
            row[1] = 2.0;
        }
    }
    let log = parsed(csv(&rows).as_bytes()).unwrap();
    let starts: Vec<f64> = log
        .pieces
        .iter()
        .map(|piece| piece.start_s.round())
        .collect();
    assert_eq!(starts, [0.0, 13.0, 26.0]);
}

#[test]
fn wrong_columns_are_said_in_a_sentence() {
    let rows = flight(300, 0.05);
    for (text, expected) in [
        (String::new(), "log: is empty, expected the columns t_s,"),
        (
            "t_s,airspeed_mps\n0,1\n".into(),
            "log, line 1: the column bank_command_rad is missing, expected the columns t_s,airspeed_mps,bank_command_rad,bank_rad,course_rad,climb_rad",
        ),
        (
            csv(&rows).replace("\n0.05,20,", "\n0.05,x,"),
            "log, line 3: column airspeed_mps holds \"x\", expected a finite number",
        ),
        (csv(&rows[..20]), "log: has 20 rows, expected at least 50"),
        (
            csv(&[&rows[..], &rows[..1]].concat()),
            "log: has the time 0 s after 14.95",
        ),
        (
            csv(&flight(300, 0.5)),
            "log: has the commanded bank every 0.500 s (a column), expected it at least every 0.25 s",
        ),
    ] {
        let found = parsed(text.as_bytes()).unwrap_err();
        assert!(found.starts_with(expected), "{found}");
    }
}

/// A message that says what messages of a kind hold.
fn format(kind: u8, name: &str, codes: &str, labels: &str) -> Vec<u8> {
    let length: usize = 3 + codes
        .bytes()
        .map(|code| {
            if code == b'Q' {
                8
            } else if code == b'B' {
                1
            } else if code == b'c' {
                2
            } else {
                4
            }
        })
        .sum::<usize>();
    let mut bytes = vec![0xa3, 0x95, 128, kind, length as u8];
    for (text, width) in [(name, 4), (codes, 16), (labels, 64)] {
        let mut field = text.as_bytes().to_vec();
        field.resize(width, 0);
        bytes.extend(field);
    }
    bytes
}

fn dataflash(rows: &[[f64; 6]]) -> Vec<u8> {
    let mut bytes = format(10, "ATT", "Qccff", "TimeUS,DesRoll,Roll,Pitch,Yaw");
    bytes.extend(format(11, "ARSP", "QBf", "TimeUS,I,Airspeed"));
    bytes.extend(format(12, "XKF1", "QBf", "TimeUS,C,VD"));
    for row in rows {
        let time_us = ((row[0] + 100.0) * 1e6) as u64;
        let hundredths = |angle: f64| ((-angle).to_degrees() * 100.0).round() as i16;
        bytes.extend([0xa3, 0x95, 10]);
        bytes.extend(time_us.to_le_bytes());
        bytes.extend(hundredths(row[2]).to_le_bytes());
        bytes.extend(hundredths(row[3]).to_le_bytes());
        bytes.extend(0.0f32.to_le_bytes());
        bytes.extend(((90.0 - row[4].to_degrees()).rem_euclid(360.0) as f32).to_le_bytes());
        for (instance, airspeed) in [(0, row[1]), (1, 3.0 * row[1])] {
            bytes.extend([0xa3, 0x95, 11]);
            bytes.extend(time_us.to_le_bytes());
            bytes.push(instance);
            bytes.extend((airspeed as f32).to_le_bytes());
        }
        bytes.extend([0xa3, 0x95, 12]);
        bytes.extend(time_us.to_le_bytes());
        bytes.push(0);
        bytes.extend(((-row[1] * row[5].sin()) as f32).to_le_bytes());
    }
    bytes
}

#[test]
fn a_dataflash_log_says_what_the_columns_say() {
    let rows = flight(300, 0.05);
    let log = parsed(&dataflash(&rows)).unwrap();
    near(&log, &rows, 2e-4);
    assert!((log.pieces[0].start_s - 100.0).abs() < 1e-9);
}

#[test]
fn a_damaged_dataflash_log_loses_only_what_is_damaged() {
    let rows = flight(300, 0.05);
    let mut bytes = dataflash(&rows);
    bytes.splice(4000..4007, [0xa3, 0x95, 0xff]);
    bytes.truncate(bytes.len() - 5);
    near(&parsed(&bytes).unwrap(), &rows[..299], 0.03);
}

#[test]
fn a_log_without_airspeed_names_the_message() {
    let bytes = format(10, "ATT", "Qccff", "TimeUS,DesRoll,Roll,Pitch,Yaw");
    let found = parsed(&bytes).unwrap_err();
    assert_eq!(
        found,
        "log: has no airspeed, expected ARSP.Airspeed or CTUN.As"
    );
}

/// A frame of version 2 with the zeros at its end left out, with the time before it.
fn frame(time_us: u64, message: u8, seed: u8, floats: &[f32]) -> Vec<u8> {
    let mut payload: Vec<u8> = floats
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    while payload.len() > 1 && payload.last() == Some(&0) {
        payload.pop();
    }
    let mut body = vec![payload.len() as u8, 0, 0, 0, 7, 1, message, 0, 0];
    body.extend(payload);
    let sum = mcrf4xx(&body, seed);
    [
        &time_us.to_be_bytes()[..],
        &[0xfd],
        &body,
        &sum.to_le_bytes(),
    ]
    .concat()
}

/// The checksum bit by bit.
fn mcrf4xx(bytes: &[u8], seed: u8) -> u16 {
    let mut crc = 0xffff_u16;
    for byte in bytes.iter().chain([&seed]) {
        crc ^= u16::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 {
                (crc >> 1) ^ 0x8408
            } else {
                crc >> 1
            };
        }
    }
    crc
}

fn tlog(rows: &[[f64; 6]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for row in rows {
        let time_us = 1_700_000_000_000_000 + (row[0] * 1e6) as u64;
        let [_, airspeed, command, bank, course, climb] = row.map(|value| value as f32);
        let yaw = (core::f32::consts::FRAC_PI_2 - course).rem_euclid(core::f32::consts::TAU);
        bytes.extend(frame(
            time_us,
            30,
            39,
            &[1.0, -bank, 0.0, yaw, 0.0, 0.0, 0.0],
        ));
        bytes.extend(frame(time_us, 62, 183, &[(-command).to_degrees(), 0.0]));
        bytes.extend(frame(
            time_us,
            74,
            20,
            &[airspeed, 25.0, 100.0, airspeed * climb.sin()],
        ));
    }
    bytes
}

#[test]
fn a_telemetry_log_says_what_the_columns_say() {
    let rows = flight(300, 0.1);
    let log = parsed(&tlog(&rows)).unwrap();
    near(&log, &rows, 2e-4);
}

#[test]
fn a_frame_with_a_wrong_checksum_is_left_out() {
    let rows = flight(300, 0.1);
    let mut bytes = tlog(&rows);
    let third = bytes.len() / 3;
    for byte in &mut bytes[third..third + 3] {
        *byte ^= 0x5a;
    }
    near(&parsed(&bytes).unwrap(), &rows, 0.05);
}

#[test]
fn no_bytes_of_a_log_make_it_panic() {
    let rows = flight(120, 0.1);
    for bytes in [dataflash(&rows), tlog(&rows), csv(&rows).into_bytes()] {
        let mut state = 1_u32;
        for _ in 0..300 {
            let mut damaged = bytes.clone();
            for _ in 0..8 {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let place = (state >> 8) as usize % damaged.len();
                damaged[place] = (state >> 24) as u8;
            }
            let _ = parsed(&damaged);
        }
    }
}
