//! Beast frames: textbook messages, a recorded file against another program, damage.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "tests fail by panicking"
)]

use crate::common::data;
use fga_formats::tally::LeftOut;
use fga_formats::traffic::beast::{Frames, Stream, push_frame};
use fga_formats::traffic::{NON_ICAO, TrafficReport};
use proptest::prelude::*;

fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len())
        .step_by(2)
        .map(|i| u8::from_str_radix(&hex[i..i + 2], 16).unwrap())
        .collect()
}

/// The reports of messages that come one second apart.
fn reports(messages: &[&str]) -> Vec<TrafficReport> {
    let mut stream = Stream::default();
    let mut reports = Vec::new();
    for (message, second) in messages.iter().zip(0_u32..) {
        let mut frame = Vec::new();
        push_frame(&mut frame, 0x1A1A_0000_001A, 0x1A, &bytes(message));
        stream.push(&frame, f64::from(second), |report| reports.push(report));
    }
    reports
}

// Messages and their meaning from J. Sun, "The 1090 Megahertz Riddle", chapters 4 to 7.
#[test]
fn textbook_messages_mean_what_the_book_says() {
    let found = reports(&["8D4840D6202CC371C32CE0576098"]);
    assert_eq!(found[0].address, 0x48_40D6);
    assert_eq!(found[0].callsign.unwrap().as_str(), "KLM1023");

    let found = reports(&[
        "8D40621D58C386435CC412692AD6",
        "8D40621D58C382D690C8AC2863A7",
    ]);
    assert_eq!(found[0].place_deg, None);
    let [latitude, longitude] = found[1].place_deg.unwrap();
    assert!((latitude - 52.257_20).abs() < 1e-5 && (longitude - 3.919_37).abs() < 1e-5);
    assert!((found[1].altitude.unwrap().metres() - 38_000.0 * 0.3048).abs() < 1e-9);
    assert_eq!(found[1].on_ground, Some(false));

    let found = reports(&["8D485020994409940838175B284F"]);
    assert!((found[0].ground_speed_mps.unwrap() / (1852.0 / 3600.0) - 159.20).abs() < 0.01);
    // Track 182.88° is a course of −92.88° from east.
    assert!((found[0].course_rad.unwrap().to_degrees() + 92.88).abs() < 0.01);
    assert!((found[0].climb_mps.unwrap() / 0.00508 + 832.0).abs() < 1e-6);
    // An airspeed message: no velocity over ground, but a climb of −2304 ft/min.
    let found = reports(&["8DA05F219B06B6AF189400CBC33F"]);
    assert_eq!(found[0].ground_speed_mps, None);
    assert!((found[0].climb_mps.unwrap() / 0.00508 + 2304.0).abs() < 1e-6);
}

#[test]
fn damaged_messages_and_old_halves_give_no_position() {
    for bit in 0..112 {
        let mut message = bytes("8D40621D58C386435CC412692AD6");
        message[bit / 8] ^= 1 << (bit % 8);
        let mut frame = Vec::new();
        push_frame(&mut frame, 0, 0, &message);
        Stream::default().push(&frame, 0.0, |report| panic!("bit {bit}: {report:?}"));
    }
    let push = |stream: &mut Stream, message: &str, time_s: f64| {
        let mut frame = Vec::new();
        push_frame(&mut frame, 0, 0, &bytes(message));
        let mut place = None;
        stream.push(&frame, time_s, |report| place = report.place_deg);
        place
    };
    let [odd, even] = [
        "8D40621D58C386435CC412692AD6",
        "8D40621D58C382D690C8AC2863A7",
    ];
    let mut stream = Stream::default();
    assert!(push(&mut stream, odd, 0.0).is_none());
    assert!(push(&mut stream, even, 10.5).is_none());
    assert!(push(&mut stream, odd, 11.0).is_some());
    assert_eq!(stream.aircraft(), 1);
}

#[test]
fn a_recorded_file_is_cut_into_its_frames() {
    let Some(path) = data("adsb/sample_dump1090.bin") else {
        return;
    };
    let recorded = std::fs::read(path).unwrap();
    let mut frames = Frames::default();
    let mut lengths = [0; 15];
    let mut again = Vec::new();
    frames.push(&recorded, |frame| {
        lengths[frame.message.len()] += 1;
        push_frame(&mut again, frame.ticks, frame.signal, frame.message);
    });
    assert_eq!(lengths.iter().sum::<u32>(), 239);
    assert_eq!(again, recorded);
    // Any cuts give the same frames.
    let mut bytewise = Frames::default();
    let mut count = 0;
    for byte in &recorded {
        bytewise.push(&[*byte], |_| count += 1);
    }
    assert_eq!(count, 239);
}

/// A squitter with a right checksum around any content.
fn squitter(format: u8, address: [u8; 3], content: [u8; 7]) -> Vec<u8> {
    let mut message = vec![format << 3 | 5];
    message.extend(address);
    message.extend(content);
    with_parity(message)
}

/// The message with its checksum.
fn with_parity(mut message: Vec<u8>) -> Vec<u8> {
    // Polynomial division bit by bit, as in the book, on the whole message as one number.
    let mut number = message.iter().fold(0_u128, |n, b| n << 8 | u128::from(*b)) << 24;
    for bit in (24..112).rev() {
        if number >> bit & 1 == 1 {
            number ^= 0x1FF_F409 << (bit - 24);
        }
    }
    message.extend(&number.to_be_bytes()[13..]);
    message
}

#[test]
fn t1_another_wire_on_this_port_is_counted() {
    let mut stream = Stream::default();
    let text = "MSG,3,1,1,AA0001,1,,,,,,1000,,,45.0,5.0,,,0,0,0,0\r\n".repeat(100);
    stream.push(text.as_bytes(), 0.0, |report| panic!("{report:?}"));
    let tally = stream.tally();
    assert_eq!(
        (tally.used, tally.lost()),
        (0, text.len().div_ceil(64) as u64)
    );
    // The noise after a frame of a type without use does not belong to the frame.
    let mut stream = Stream::default();
    stream.push(&[0x1A, b'4'], 0.0, |report| panic!("{report:?}"));
    stream.push(&[7; 1000], 0.0, |report| panic!("{report:?}"));
    assert_eq!(stream.tally().lost(), 1000_u64.div_ceil(64) - 1);
    // A wrong checksum, a short message, a settings frame, and a frame that ends too early.
    let mut frames = Vec::new();
    push_frame(&mut frames, 0, 0, &bytes("8D4840D6202CC371C32CE0576099"));
    push_frame(&mut frames, 0, 0, &bytes("5D4840D6202CC3"));
    frames.extend([0x1A, b'4', 1, 2, 3]);
    push_frame(&mut frames, 0, 0, &bytes("8D4840D6202CC371C32CE0576098"));
    frames.extend([0x1A, b'3', 1, 2, 3]);
    let mut stream = Stream::default();
    stream.push(&frames, 0.0, |_| {});
    stream.reconnect();
    let tally = stream.tally();
    assert_eq!((tally.read(), tally.used), (5, 1));
    assert_eq!(tally.left_out(LeftOut::WrongChecksum), 1);
    assert_eq!(tally.left_out(LeftOut::CutShort), 1);
}

#[test]
fn t1_addresses_of_others_than_the_icao_are_read() {
    // Downlink format 18: the control field says whose the address is.
    for (control, expected) in [
        (0, Some(0xA0_0001)),
        (1, Some(0xA0_0001 | NON_ICAO)),
        (4, None),
    ] {
        let mut message = squitter(18, [0xA0, 0, 1], [0x20, 0x2C, 0xC3, 0x71, 0xC3, 0x2C, 0xE0]);
        message.truncate(11);
        message[0] = 18 << 3 | control;
        let mut frame = Vec::new();
        push_frame(&mut frame, 0, 0, &with_parity(message));
        let mut found = None;
        Stream::default().push(&frame, 0.0, |report| found = Some(report.address));
        assert_eq!(found, expected, "{control}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn any_bytes_are_taken(bytes in proptest::collection::vec(prop_oneof![Just(0x1A_u8), b'1'..=b'4', any::<u8>()], 0..400)) {
        let mut stream = Stream::default();
        let mut used = 0;
        stream.push(&bytes, 0.0, |_| used += 1);
        stream.reconnect();
        // Each beginning of a frame is in one count, and so is what is outside.
        let (mut begun, mut is_escaped) = (0, false);
        for byte in &bytes {
            let was_escaped = core::mem::replace(&mut is_escaped, *byte == 0x1A);
            if was_escaped {
                is_escaped = false;
                begun += u64::from(*byte != 0x1A);
            }
        }
        let tally = stream.tally();
        let outside = tally.left_out(LeftOut::UnknownKind);
        prop_assert_eq!((tally.read() - outside, tally.used), (begun, used));
    }

    #[test]
    fn any_whole_message_gives_finite_numbers(
        content: [u8; 7], other: [u8; 7], format in 17..19_u8, address in 1..5_u8, step in -20.0..20.0_f64,
    ) {
        let mut stream = Stream::default();
        for (content, time_s) in [(content, 0.0), (other, step)] {
            let mut frame = Vec::new();
            push_frame(&mut frame, 0, 0, &squitter(format, [0xA0, 0, address], content));
            stream.push(&frame, time_s, |report| {
                assert!(report.place_deg.is_none_or(|[a, b]| a.abs() <= 90.0 && b.abs() <= 180.0));
                assert!(report.ground_speed_mps.is_none_or(|v| (0.0..3000.0).contains(&v)));
                assert!(report.course_rad.is_none_or(f64::is_finite));
                assert!(report.altitude.is_none_or(|a| a.metres().is_finite()));
            });
        }
    }
}

#[test]
fn memory_is_bounded_however_many_aircraft_there_are() {
    let mut stream = Stream::default();
    let content = [0x58, 0xC3, 0x86, 0x43, 0x5C, 0xC4, 0x12];
    for number in 0..60_000_u16 {
        let [high, low] = number.to_be_bytes();
        let mut frame = Vec::new();
        push_frame(&mut frame, 0, 0, &squitter(17, [1, high, low], content));
        stream.push(&frame, 1.0, |_| {});
        assert!(stream.aircraft() <= 32_768);
    }
    assert!(stream.aircraft() >= 16_384);
    // Even after a flood the book's pair gives its position.
    let mut found = None;
    for message in [
        "8D40621D58C386435CC412692AD6",
        "8D40621D58C382D690C8AC2863A7",
    ] {
        let mut frame = Vec::new();
        push_frame(&mut frame, 0, 0, &bytes(message));
        stream.push(&frame, 2.0, |report| found = report.place_deg.or(found));
    }
    assert!(found.is_some());
}

/// The same file decoded by pyModeS 3.6.1: one aircraft that squitters; pairs of messages give two
/// positions.
#[test]
fn a_recorded_file_means_what_another_decoder_says() {
    let Some(path) = data("adsb/sample_dump1090.bin") else {
        return;
    };
    let recorded = std::fs::read(path).unwrap();
    let mut timed = Vec::new();
    Frames::default().push(&recorded, |frame| {
        let mut again = Vec::new();
        push_frame(&mut again, frame.ticks, frame.signal, frame.message);
        #[expect(clippy::cast_precision_loss, reason = "some minutes of a 12 MHz clock")]
        timed.push((frame.ticks as f64 / 12e6, again));
    });
    let start_s = timed[0].0;
    let mut stream = Stream::default();
    let mut found = Vec::new();
    for (time_s, frame) in &timed {
        stream.push(frame, *time_s, |report| {
            found.push((time_s - start_s, report));
        });
    }
    assert!(found.iter().all(|(_, report)| report.address == 0x48_520A));
    let callsign = found
        .iter()
        .find_map(|(_, report)| report.callsign)
        .unwrap();
    assert_eq!(callsign.as_str(), "TRA89M");
    let place_at = |time_s: f64| {
        let near = found
            .iter()
            .find(|(at_s, _)| (at_s - time_s).abs() < 1e-3)
            .unwrap();
        assert!((near.1.altitude.unwrap().metres() - 38_000.0 * 0.3048).abs() < 1e-9);
        assert_eq!(near.1.containment_m, Some(185.2));
        near.1.place_deg
    };
    for (time_s, latitude, longitude) in [
        (5.7951, 43.644_212_625_794_49, 1.231_515_066_964_285_6),
        (12.6747, 43.656_646_728_515_625, 1.229_638_387_990_552_4),
    ] {
        let [a, b] = place_at(time_s).unwrap();
        assert!(
            (a - latitude).abs() < 1e-9 && (b - longitude).abs() < 1e-9,
            "{a} {b}"
        );
    }
    assert_eq!(place_at(4.8451), None);
    for (_, report) in &found {
        if let Some(speed_mps) = report.ground_speed_mps {
            // pyModeS gives whole knots.
            assert!((speed_mps * 3600.0 / 1852.0 - 395.0).abs() < 1.0);
            let compass_deg = 90.0 - report.course_rad.unwrap().to_degrees();
            assert!(
                (compass_deg - (353.755_834_6 - 360.0)).abs() < 1e-6,
                "{compass_deg}"
            );
            assert_eq!(report.velocity_error_mps, Some(10.0));
        }
    }
}

/// A squitter of 0x123456 with a right checksum.
fn whole(content: [u8; 7]) -> [u8; 14] {
    let mut message = [0; 14];
    message[..4].copy_from_slice(&[0x8D, 0x12, 0x34, 0x56]);
    message[4..11].copy_from_slice(&content);
    // Division of the bits one by one.
    let mut bits: Vec<bool> = (0..112)
        .map(|n| message[n / 8] >> (7 - n % 8) & 1 != 0)
        .collect();
    let generator: Vec<bool> = (0..25)
        .map(|n| 0x1FF_F409_u32 >> (24 - n) & 1 != 0)
        .collect();
    for at in 0..88 {
        let (first, rest) = bits[at..].split_first_mut().expect("a bit");
        if *first {
            for (bit, divisor) in rest.iter_mut().zip(&generator[1..]) {
                *bit ^= divisor;
            }
        }
    }
    for (at, bit) in bits.iter().enumerate().skip(88) {
        message[at / 8] |= u8::from(*bit) << (7 - at % 8);
    }
    message
}

fn reports_of(messages: &[[u8; 14]]) -> Vec<TrafficReport> {
    let mut bytes = Vec::new();
    for message in messages {
        push_frame(&mut bytes, 0, 0, message);
    }
    let mut found = Vec::new();
    Stream::default().push(&bytes, 0.0, |report| found.push(report));
    found
}

/// DO-260B, 2.2.3.2.7.2: version 2, supplement A, `NACp` 9, GVA 2, SIL 3; and 2.2.3.2.7.1.
#[test]
fn quality_is_read_from_status_messages() {
    let status = [0xF8, 0, 0, 0, 0, 0b0101_1001, 0b1011_0000];
    let state = [0xEA, 0, 0, 0, 1, 0b0001_1000, 0];
    let old = [0xF8, 0, 0, 0, 0, 0b0001_1001, 0b1011_0000];
    let on_ground = [0xF9, 0, 0, 0, 0, 0b0101_1001, 0b1011_0000];
    let found = reports_of(&[status, state, old, on_ground].map(whole));
    assert_eq!(found.len(), 2, "{found:?}");
    assert_eq!(found[0].address, 0x12_3456);
    assert_eq!(found[0].position_error_m, Some(30.0));
    assert_eq!(found[0].source_integrity, Some(3));
    assert_eq!(found[1].position_error_m, Some(92.6));
    assert_eq!(found[1].source_integrity, Some(2));
}

/// J. Sun, "The 1090 Megahertz Riddle", on target state and status: `NACp` 9, SIL 3.
#[test]
fn the_books_target_state_tells_its_quality() {
    let message = u128::from_str_radix("8DA05629EA21485CBF3F8CADAEEB", 16).unwrap();
    let bytes: [u8; 14] = message.to_be_bytes()[2..].try_into().unwrap();
    let found = reports_of(&[bytes]);
    assert_eq!(found[0].address, 0xA0_5629);
    assert_eq!(found[0].position_error_m, Some(30.0));
    assert_eq!(found[0].source_integrity, Some(3));
}

/// Kind 11 contains the position within 185.2 m, or with both supplements within 75 m; kind 18
/// gives no bound.
#[test]
fn the_supplements_narrow_the_containment() {
    let place = [0x59, 0xC3, 0x86, 0x43, 0x5C, 0xC4, 0x12];
    let plain = [0x58, 0xC3, 0x86, 0x43, 0x5C, 0xC4, 0x12];
    let none = [0x90, 0xC3, 0x86, 0x43, 0x5C, 0xC4, 0x12];
    let status = [0xF8, 0, 0, 0, 0, 0b0101_1001, 0b1011_0000];
    let found = reports_of(&[place, status, place, plain, none].map(whole));
    let contained: Vec<Option<f64>> = found.iter().map(|r| r.containment_m).collect();
    assert_eq!(
        contained,
        [
            Some(185.2),
            None,
            Some(75.0),
            Some(185.2),
            Some(f64::INFINITY)
        ]
    );
}
