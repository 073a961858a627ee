//! Logs that are made here, byte by byte, from a flight whose figures are known.
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "logs hold small whole numbers"
)]

use fga_formats::flight_log::{COLUMNS, FlightLog, parse};
use fga_formats::tally::LeftOut;
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
            } else if code == b'c' || code == b'H' {
                2
            } else if code == b'N' {
                16
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

/// A companion without a battery for its clock: 1970 until the network answers, and an hour back later.
#[test]
fn n3_a_clock_that_is_set_splits_a_telemetry_log() {
    let rows = flight(900, 0.1);
    let bytes = tlog(&rows);
    let whole = parsed(&bytes).unwrap();
    let mut set = Vec::new();
    let mut at = 0;
    while let Some(rest) = bytes.get(at..).filter(|rest| !rest.is_empty()) {
        let length = 8 + 12 + usize::from(rest[9]);
        let stamp_us = u64::from_be_bytes(rest[..8].try_into().unwrap());
        let begin_us = u64::from_be_bytes(bytes[..8].try_into().unwrap());
        let after_us = stamp_us - begin_us;
        let from_us = match after_us / 1_000_000 {
            0..30 => 0,
            30..60 => begin_us + 1_780_000_000_000_000,
            _ => begin_us + 1_779_996_400_000_000,
        };
        set.extend((from_us + after_us).to_be_bytes());
        set.extend(&rest[8..length]);
        at += length;
    }
    let found = parsed(&set).unwrap();
    assert_eq!((whole.pieces.len(), found.pieces.len()), (1, 3));
    let seconds = |log: &FlightLog| -> f64 {
        let rows = log.pieces.iter().map(|piece| piece.bank_rad.len());
        rows.map(|rows| f64::from(u32::try_from(rows).unwrap()))
            .sum::<f64>()
            * log.period_s
    };
    assert!(seconds(&whole) - seconds(&found) < 3.0);
    assert_eq!(found.tally, whole.tally);
}

#[test]
fn a_frame_with_a_wrong_checksum_is_left_out() {
    let rows = flight(300, 0.1);
    let mut bytes = tlog(&rows);
    // Behind the time of a frame, which no checksum holds.
    let third = bytes.len() / 3 + 12;
    for byte in &mut bytes[third..third + 3] {
        *byte ^= 0x5a;
    }
    let log = parsed(&bytes).unwrap();
    near(&log, &rows, 0.05);
    // 900 frames, of which one or two are one part of the file.
    assert_eq!(log.tally.left_out(LeftOut::WrongChecksum), 1);
    assert!((898..=900).contains(&log.tally.read()), "{:?}", log.tally);
    assert_eq!(log.tally.read(), log.tally.used + 1);
}

/// Whole messages and the damaged parts between them are each in one count.
#[test]
fn what_a_log_leaves_out_is_counted() {
    let rows = flight(300, 0.1);
    for (bytes, messages) in [(tlog(&rows), 900), (csv(&rows).into_bytes(), 300)] {
        let tally = parsed(&bytes).unwrap().tally;
        assert_eq!((tally.used, tally.lost()), (messages, 0));
    }
    let whole = dataflash(&rows);
    let tally = parsed(&whole).unwrap().tally;
    assert_eq!(tally.lost(), 0);
    // A stray part between two messages, another at the end, and a message of another system.
    let mut bytes = whole.clone();
    bytes.splice(0..0, format(200, "XYZ", "B", "A"));
    bytes.extend([0xa3, 0x95, 200, 7, 1, 2, 3]);
    bytes.extend(format(201, "XYZ", "B", "A"));
    bytes.extend([0xa3, 0x95, 200]);
    let damaged = parsed(&bytes).unwrap().tally;
    assert_eq!(damaged.used, tally.used + 2);
    assert_eq!(
        damaged.left_out(LeftOut::NotNeeded),
        tally.left_out(LeftOut::NotNeeded) + 1
    );
    assert_eq!(damaged.left_out(LeftOut::UnknownKind), 1);
    assert_eq!(damaged.left_out(LeftOut::CutShort), 1);
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

/// A dataflash message of a kind, at a time in seconds.
fn message(kind: u8, time_s: f64, rest: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0xa3, 0x95, kind];
    bytes.extend(((time_s * 1e6) as u64).to_le_bytes());
    bytes.extend(rest);
    bytes
}

/// TAKEOFF, then AUTO with a take-off until 115 s, then a waypoint, then the pilot's own turns from 130 s on.
fn with_phases(rows: &[[f64; 6]], mission: &str) -> Vec<u8> {
    let mut bytes = format(20, "MODE", "QBBB", "TimeUS,Mode,ModeNum,Rsn");
    bytes.extend(format(21, mission, "QHHH", "TimeUS,CTot,CNum,CId"));
    bytes.extend(format(22, "PARM", "QNf", "TimeUS,Name,Value"));
    for (time_s, mode) in [(100.0, 13), (110.0, 10), (130.0, 0)] {
        bytes.extend(message(20, time_s, &[mode, mode, 0]));
    }
    // The listing of the mission when the log begins names nothing that begins.
    let listing = [(99.0, 16_u16), (99.01, 22), (99.02, 21)];
    let begun = [(110.0, 22_u16), (115.0, 16)];
    let listing = listing.into_iter().filter(|_| mission == "CMD");
    for (time_s, command) in listing.chain(begun) {
        let fields = [3_u16, 1, command].map(u16::to_le_bytes).concat();
        bytes.extend(message(21, time_s, &fields));
    }
    for (name, value) in [
        ("ROLL_LIMIT_DEG", 45.0_f32),
        ("TECS_CLMB_MAX", 4.0),
        ("LIM_PITCH_MIN", -2000.0),
    ] {
        let mut field = name.as_bytes().to_vec();
        field.resize(16, 0);
        field.extend(value.to_le_bytes());
        bytes.extend(message(22, 99.0, &field));
    }
    bytes.extend(dataflash(rows));
    bytes
}

#[test]
fn n3_only_what_an_avoider_would_fly_is_kept() {
    for mission in ["MISE", "CMD"] {
        let log = parsed(&with_phases(&flight(900, 0.05), mission)).unwrap();
        let [piece] = &log.pieces[..] else {
            panic!("{mission}: {} pieces", log.pieces.len())
        };
        assert!(
            (piece.start_s - 115.0).abs() < 0.06,
            "{mission}: {}",
            piece.start_s
        );
        let lasts_s = piece.len() as f64 * log.period_s;
        assert!((lasts_s - 15.0).abs() < 0.11, "{mission}: {lasts_s}");
        assert_eq!(log.limits.bank_rad, Some(45.0_f64.to_radians()));
        assert_eq!(log.limits.climb_mps, Some(4.0));
        assert_eq!(log.limits.pitch_min_rad, Some((-20.0_f64).to_radians()));
        assert_eq!(log.limits.sink_mps, None);
    }
}

/// A sensor that is not used or not healthy gives no airspeed; the estimate is taken if it moves.
#[test]
fn n3_a_disabled_airspeed_sensor_is_no_airspeed() {
    let rows = flight(300, 0.05);
    for flag in ["U", "H"] {
        for (swing_mps, expected) in [
            (1.0, None),
            (
                0.0,
                Some("log: never flies: its airspeed sensor is not used"),
            ),
        ] {
            let mut bytes = dataflash(&rows);
            // The same kind of message, described again with a flag, which is 0, where the instance was; and no second sensor.
            let from = format(11, "ARSP", "QBf", "TimeUS,I,Airspeed");
            let to = format(11, "ARSP", "QBf", &format!("TimeUS,{flag},Airspeed"));
            let at = bytes
                .windows(from.len())
                .position(|window| window == from)
                .unwrap();
            bytes.splice(at..at + to.len(), to);
            for at in 0..bytes.len() - 12 {
                if bytes[at..at + 3] == [0xa3, 0x95, 11] {
                    bytes[at + 11] = 0;
                }
            }
            bytes.extend(format(14, "CTUN", "Qf", "TimeUS,As"));
            for row in &rows {
                let airspeed = (25.0 + swing_mps * libm::sin(row[0])) as f32;
                bytes.extend(message(14, row[0] + 100.0, &airspeed.to_le_bytes()));
            }
            match (parsed(&bytes), expected) {
                (Ok(log), None) => assert!((log.pieces[0].airspeed_mps[0] - 25.0).abs() < 0.1),
                (Err(found), Some(expected)) => assert!(found.starts_with(expected), "{found}"),
                (found, _) => panic!("{flag}, {swing_mps}: {found:?}"),
            }
        }
    }
}

#[test]
fn the_airspeed_is_that_of_the_primary_sensor() {
    let rows = flight(300, 0.05);
    let first = parsed(&dataflash(&rows)).unwrap();
    // A row says which sensor is the primary one, or a parameter does.
    let mut bytes = format(11, "ARSP", "QBfB", "TimeUS,I,Airspeed,Pri");
    let plain = dataflash(&rows);
    let mut at = 0;
    while at < plain.len() {
        let length = match plain[at + 2] {
            128 => 89,
            10 => 3 + 8 + 2 + 2 + 4 + 4,
            _ => 3 + 8 + 1 + 4,
        };
        let is_format = plain[at + 2] == 128 && plain[at + 3] == 11;
        if !is_format {
            bytes.extend(&plain[at..at + length]);
        }
        if plain[at + 2] == 11 {
            bytes.push(1);
        }
        at += length;
    }
    let mut parameter = format(15, "PARM", "QNf", "TimeUS,Name,Value");
    let mut name = [0; 16];
    name[..13].copy_from_slice(b"ARSPD_PRIMARY");
    parameter.extend(message(
        15,
        0.0,
        &[&name[..], &1.0_f32.to_le_bytes()].concat(),
    ));
    parameter.extend(plain);
    for bytes in [bytes, parameter] {
        let second = parsed(&bytes).unwrap();
        let ratio = second.pieces[0].airspeed_mps[9] / first.pieces[0].airspeed_mps[9];
        assert!((ratio - 3.0).abs() < 1e-6, "{ratio}");
    }
}

#[test]
fn n3_a_log_of_the_ground_never_flies() {
    let mut rows = flight(300, 0.05);
    for row in &mut rows {
        row[1] = 0.4;
    }
    let found = parsed(&dataflash(&rows)).unwrap_err();
    assert!(
        found.starts_with("log: never flies: its airspeed is below 0.4 m/s"),
        "{found}"
    );
}

/// A message of `ULog`.
pub(crate) fn px4(kind: u8, content: &[u8]) -> Vec<u8> {
    let length = u16::try_from(content.len()).unwrap().to_le_bytes();
    [&length, &[kind][..], content].concat()
}

/// A quaternion of a bank to the left and a course.
fn turned(bank_rad: f64, course_rad: f64) -> [f32; 4] {
    let (roll, yaw) = (
        -0.5 * bank_rad,
        0.5 * (core::f64::consts::FRAC_PI_2 - course_rad),
    );
    let ((s, c), (sy, cy)) = (libm::sincos(roll), libm::sincos(yaw));
    [cy * c, cy * s, sy * s, sy * c].map(|part| part as f32)
}

/// A short log of each kind: PX4's, dataflash, telemetry, CSV.
pub(crate) fn short_logs() -> [Vec<u8>; 4] {
    let rows = flight(120, 0.1);
    [
        px4_log(&rows),
        dataflash(&rows),
        tlog(&rows),
        csv(&rows).into_bytes(),
    ]
}

/// A log of PX4 in a mission: its first seconds disarmed, a second airspeed sensor that is wrong.
fn px4_log(rows: &[[f64; 6]]) -> Vec<u8> {
    let mut bytes = b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0".to_vec();
    bytes.extend(px4(b'B', &[0; 40]));
    for format in [
        "vehicle_attitude:uint64_t timestamp;float[4] q;uint8_t n;uint8_t[3] _padding0;",
        "vehicle_attitude_setpoint:uint64_t timestamp;float[4] q_d;",
        "airspeed:uint64_t timestamp;float true_airspeed_m_s;",
        "vehicle_local_position:uint64_t timestamp;bool v;uint8_t[3] _padding0;float vz;",
        "vehicle_status:uint64_t timestamp;uint8_t nav_state;uint8_t arming_state;uint8_t vehicle_type;",
        "position_setpoint:uint64_t timestamp;uint8_t type;",
        "position_setpoint_triplet:uint64_t timestamp;position_setpoint previous;position_setpoint current;",
    ] {
        bytes.extend(px4(b'F', format.as_bytes()));
    }
    bytes.extend(px4(
        b'P',
        &[b"\x0efloat FW_R_LIM", &55_f32.to_le_bytes()[..]].concat(),
    ));
    let topics: [(u8, u8, &str); 7] = [
        (0, 0, "vehicle_attitude"),
        (0, 1, "vehicle_attitude_setpoint"),
        (0, 2, "airspeed"),
        (1, 3, "airspeed"),
        (0, 4, "vehicle_local_position"),
        (0, 5, "vehicle_status"),
        (0, 6, "position_setpoint_triplet"),
    ];
    for (instance, number, name) in topics {
        bytes.extend(px4(
            b'A',
            &[&[instance, number, 0], name.as_bytes()].concat(),
        ));
    }
    let floats = |values: &[f32]| -> Vec<u8> {
        values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect()
    };
    for row in rows {
        let time = ((1e6 * row[0]) as u64).to_le_bytes();
        let mut data = |number: u8, content: &[u8]| {
            bytes.extend(px4(b'D', &[&[number, 0], &time[..], content].concat()));
        };
        let armed = if row[0] < 2.0 { 1 } else { 2 };
        data(0, &[&floats(&turned(row[3], row[4]))[..], &[7]].concat());
        data(1, &floats(&turned(row[2], 0.0)));
        data(2, &floats(&[row[1] as f32]));
        data(3, &floats(&[99.0]));
        let vz = (-row[1] * libm::sin(row[5])) as f32;
        data(4, &[&[1, 0, 0, 0], &floats(&[vz])[..]].concat());
        data(5, &[3, armed, 2]);
        let kind = if row[0] < 4.0 { 3 } else { 0 };
        data(6, &[&[0; 8], &[9][..], &time, &[kind]].concat());
    }
    bytes
}

#[test]
fn ulog_of_px4_is_read_with_its_mission_and_its_first_sensors() {
    let rows = flight(400, 0.05);
    let bytes = px4_log(&rows);
    let log = parsed(&bytes).unwrap();
    // Disarmed for 2 s, a take-off until 4 s.
    near(&log, &rows[80..], 1e-3);
    assert!((log.pieces[0].start_s - 4.0).abs() < 1e-6);
    assert_eq!(log.limits.bank_rad, Some(55_f64.to_radians()));
    assert_eq!((log.tally.used, log.tally.lost()), (15 + 6 * 400, 0));
    // In the mode of a pilot nothing is flown.
    let status = [&[5, 0][..], &[0; 8], &[3]].concat();
    let mut manual = bytes.clone();
    for at in 0..manual.len() - 11 {
        if manual[at..at + 2] == status[..2] && manual[at - 1] == b'D' && manual[at - 3] == 13 {
            manual[at + 10] = 0;
        }
    }
    assert!(
        parsed(&manual)
            .unwrap_err()
            .contains("has no 5 s of flight")
    );
    // Damage is skipped up to the next synchronization, and counted; so is an end within a message.
    let sync = px4(b'S', &[0x2f, 0x73, 0x13, 0x20, 0x25, 0x0c, 0xbb, 0x12]);
    let message = bytes.len() - rows.len() / 2 * 185;
    let damaged = [
        &bytes[..message],
        b"\xff\xff\xff broken",
        &sync,
        &bytes[message..bytes.len() - 1],
    ]
    .concat();
    let log = parsed(&damaged).unwrap();
    for reason in [LeftOut::UnknownKind, LeftOut::CutShort] {
        assert_eq!(log.tally.left_out(reason), 1);
    }
    let found = parsed(&bytes[..300]).unwrap_err();
    assert!(found.starts_with("log: has no airspeed"), "{found}");
}

/// The vehicle says its commanded bank twice a second; what the companion sends it comes 20 times a second.
#[test]
fn n3_the_log_of_a_companion_has_the_banks_that_it_commanded() {
    let rows = flight(600, 0.05);
    let mut bytes = vec![];
    let mut body = |time_us: u64, message: u8, seed: u8, payload: Vec<u8>| {
        bytes.extend(time_us.to_be_bytes());
        let mut frame = vec![payload.len() as u8, 0, 0, 0, 1, 1, message, 0, 0];
        frame.extend(&payload);
        let sum = mcrf4xx(&frame, seed);
        bytes.push(0xfd);
        bytes.extend(frame);
        bytes.extend(sum.to_le_bytes());
    };
    let floats = |values: &[f32]| {
        values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect::<Vec<u8>>()
    };
    for (index, row) in rows.iter().enumerate() {
        let time_us = ((row[0] + 1e9) * 1e6) as u64;
        // The first third is flown in MANUAL.
        let mode = u32::from(row[0] >= 10.0) * 15;
        if index % 20 == 0 {
            let mut heartbeat = mode.to_le_bytes().to_vec();
            heartbeat.extend([1, 3, 128 + 1, 4, 3]);
            body(time_us, 0, 50, heartbeat);
        }
        body(
            time_us,
            30,
            39,
            floats(&[
                0.0,
                -row[3] as f32,
                0.0,
                (core::f64::consts::FRAC_PI_2 - row[4]) as f32,
                0.0,
                0.0,
                0.0,
            ]),
        );
        body(
            time_us,
            74,
            20,
            floats(&[
                row[1] as f32,
                row[1] as f32,
                100.0,
                (row[1] * row[5].sin()) as f32,
                0.0,
            ]),
        );
        if index % 10 == 0 {
            body(time_us, 62, 183, floats(&[99.0; 6]));
        }
        let (sin, cos) = (-0.5 * row[2]).sin_cos();
        let mut target = floats(&[0.0, cos as f32, sin as f32, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5]);
        target.extend([1, 1, 7]);
        body(time_us, 82, 49, target);
    }
    let log = parsed(&bytes).unwrap();
    let piece = &log.pieces[0];
    assert!(
        (piece.start_s - 1e9 - 10.0).abs() < 0.06,
        "{}",
        piece.start_s
    );
    assert!(
        (piece.len() as f64 * log.period_s - 20.0).abs() < 1.1,
        "{}",
        piece.len()
    );
    let at = 200;
    for (offset, bank) in piece.bank_command_rad.iter().take(300).enumerate() {
        assert!(
            (bank - rows[at + offset][2]).abs() < 1e-2,
            "{offset}: {bank}"
        );
    }
}

/// `pymavlink` reads the logs too: the same airspeeds and banks at the same times.
#[test]
fn logs_are_read_as_pymavlink_reads_them() {
    let script = "import sys, math\n\
        from pymavlink import mavutil\n\
        log=mavutil.mavlink_connection(sys.argv[1])\n\
        air=bank=None\n\
        while (m:=log.recv_match(type=['ATT','ATTITUDE','ARSP','CTUN','VFR_HUD'])) is not None:\n\
        \x20   k=m.get_type()\n\
        \x20   if k=='ATT': bank=-math.radians(m.Roll)\n\
        \x20   if k=='ATTITUDE': bank=-m.roll\n\
        \x20   if k=='ARSP' and m.I==0: air=m.Airspeed\n\
        \x20   if k=='VFR_HUD': air=m.airspeed\n\
        \x20   if None not in (air,bank): print(air,bank); air=bank=None";
    let folder = tempfile::tempdir().unwrap();
    let [_, dataflash, tlog, _] = short_logs();
    for (name, bytes) in [("a.bin", dataflash), ("a.tlog", tlog)] {
        let path = folder.path().join(name);
        std::fs::write(&path, &bytes).unwrap();
        let Some(text) = crate::common::python("pymavlink", script, &[&path]) else {
            return;
        };
        let piece = parse(&bytes, &path).unwrap().pieces.remove(0);
        let rows = text.lines().map(|line| {
            let mut numbers = line.split(' ').map(|word| word.parse::<f64>().unwrap());
            (numbers.next().unwrap(), numbers.next().unwrap())
        });
        let rows: Vec<(f64, f64)> = rows.collect();
        assert!(rows.len() >= piece.len() && piece.len() > 100, "{name}");
        for (index, (airspeed_mps, bank_rad)) in rows.iter().take(piece.len()).enumerate() {
            assert!(
                (piece.airspeed_mps[index] - airspeed_mps).abs() < 1e-5,
                "{name} {index}"
            );
            assert!(
                (piece.bank_rad[index] - bank_rad).abs() < 2e-4,
                "{name} {index}"
            );
        }
    }
}
