//! Receivers over TCP and UDP on loopback: a server's data arrives as reports, whole and in order, and
//! agrees with an independent decode.

use alloc::collections::{BTreeMap, BTreeSet};
use alloc::sync::Arc;
use core::sync::atomic::{AtomicBool, Ordering};
use core::time::Duration;
use std::io::Write as _;
use std::net::{TcpListener, UdpSocket};

use fga_link::traffic::receiver;
use fga_link::traffic::{AltitudeReference, PlaceReport};

/// A receiver's reports from bytes that a server sends in pieces of `piece` bytes, up to the report
/// of `last`, all at one moment.
fn received(kind: &str, bytes: Vec<u8>, piece: usize, last: u32) -> Vec<PlaceReport> {
    let server = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = server.local_addr().expect("an address");
    let sending = std::thread::spawn(move || {
        let (mut stream, _) = server.accept().expect("a reader");
        for part in bytes.chunks(piece) {
            if stream.write_all(part).is_err() {
                // The reader has what it waits for.
                break;
            }
        }
    });
    let endpoint = format!("{kind}:{address}").parse().expect("a receiver");
    let mut reports = Vec::new();
    receiver::read(
        &endpoint,
        || 0.0,
        &AtomicBool::new(false),
        |report| {
            let goes_on = report.icao != last;
            if goes_on {
                reports.push(report);
            }
            goes_on
        },
        |_| true,
    );
    sending.join().expect("sent");
    reports
}

/// One of our own aircraft behind the recording marks its end.
const LAST: u32 = 0x00FF_FFFF;

#[test]
fn a_recorded_sbs_log_arrives_whole() {
    let Some(log) = crate::common::sbs_log() else {
        return;
    };
    // Plain text handling: position lines of airborne aircraft whose altitude is known by then.
    let mut altitude_ft: BTreeMap<u32, f64> = BTreeMap::new();
    let (mut expected, mut text) = (Vec::new(), String::new());
    for line in &log {
        text.push_str(&line.line);
        text.push_str("\r\n");
        let fields: Vec<&str> = line.line.split(',').collect();
        let number = |index: usize| fields.get(index).and_then(|text| text.parse::<f64>().ok());
        let address = fields.get(4).map(|text| u32::from_str_radix(text, 16));
        let Some(Ok(address)) = address else { continue };
        if let Some(feet) = number(11) {
            altitude_ft.insert(address, feet);
        }
        if let (Some(latitude), Some(longitude), Some(feet)) =
            (number(14), number(15), altitude_ft.get(&address))
        {
            expected.push((address, latitude, longitude, feet * 0.3048));
        }
    }
    text.push_str("MSG,3,1,1,FFFFFF,1,,,,,,1000,,,1.0,2.0,,,0,0,0,0\r\n");
    // Pieces that end anywhere in a line.
    let reports = received("sbs", text.into_bytes(), 1447, LAST);
    assert_eq!(reports.len(), expected.len());
    let aircraft: BTreeSet<u32> = reports.iter().map(|r| r.icao).collect();
    assert_eq!(aircraft.len(), 44);
    for (report, (address, latitude, longitude, altitude_m)) in reports.iter().zip(&expected) {
        assert_eq!(report.icao, *address);
        assert!((report.place.latitude_deg - latitude).abs() < 1e-9);
        assert!((report.place.longitude_deg - longitude).abs() < 1e-9);
        assert!((report.place.altitude_m - altitude_m).abs() < 1e-6);
    }
}

/// A unit on board at 45.5° N, 5.25° E: an aircraft 1,200 m north of it and 150 m above, then one that ends the reading.
#[test]
fn sentences_of_flarm_arrive_with_places_of_their_own() {
    let target = |id: &str| format!("PFLAA,0,1200,0,150,1,{id},90,,40,-1.5,1");
    let contents = [
        "GPGGA,120000,4530.000,N,00515.000,E,1,08,1.0,1000.0,M,48.0,M,,".to_owned(),
        target("4B5C6D"),
        target("FFFFFF"),
    ];
    let text = contents.iter().fold(String::new(), |text, content| {
        let sum = content.bytes().fold(0, |sum, byte| sum ^ byte);
        format!("{text}${content}*{sum:02X}\r\n")
    });
    let reports = received("flarm", text.into_bytes(), 7, LAST);
    let [report] = &reports[..] else {
        panic!("{reports:?}");
    };
    assert_eq!(report.icao, 0x004B_5C6D);
    assert_eq!(report.quality.altitude, AltitudeReference::Ellipsoid);
    assert!((report.place.altitude_m - 1198.0).abs() < 1e-9);
    // A minute of latitude has 1,852.2 m here.
    assert!((report.place.latitude_deg - 45.5 - 1200.0 / 1852.2 / 60.0).abs() < 1e-5);
    let velocity_mps = report.velocity_mps.expect("a velocity");
    assert!((velocity_mps.x - 40.0).abs() < 1e-9);
}

/// The traffic report of the specification of GDL 90 (3.5.4), with its checksum, in datagrams of a receiver on board.
#[test]
fn datagrams_of_gdl90_arrive() {
    const MESSAGE: [u8; 32] = [
        0x7E, 0x14, 0x00, 0xAB, 0x45, 0x49, 0x1F, 0xEF, 0x15, 0xA8, 0x89, 0x78, 0x0F, 0x09, 0xA9,
        0x07, 0xB0, 0x01, 0x20, 0x01, 0x4E, 0x38, 0x32, 0x35, 0x56, 0x20, 0x20, 0x20, 0x00, 0x57,
        0xD6, 0x7E,
    ];
    let free = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let address = free.local_addr().expect("an address");
    drop(free);
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&stop);
    let sending = std::thread::spawn(move || {
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
        while !stopped.load(Ordering::Relaxed) {
            // Nobody listens yet, perhaps.
            let _ = socket.send_to(&MESSAGE, address);
            std::thread::sleep(Duration::from_millis(5));
        }
    });
    let endpoint = format!("gdl90:{address}").parse().expect("a receiver");
    let mut reports = Vec::new();
    let take = |report| {
        reports.push(report);
        false
    };
    receiver::read(&endpoint, || 0.0, &AtomicBool::new(false), take, |_| true);
    stop.store(true, Ordering::Relaxed);
    sending.join().expect("sent");
    let [report] = &reports[..] else {
        panic!("{reports:?}");
    };
    assert_eq!(
        (report.icao, report.callsign.as_str()),
        (0x00AB_4549, "N825V")
    );
    assert_eq!(report.quality.altitude, AltitudeReference::Pressure);
    assert!((report.place.altitude_m - 1524.0).abs() < 1e-9);
    let velocity_mps = report.velocity_mps.expect("a velocity");
    assert!((velocity_mps.x - velocity_mps.y).abs() < 1e-9 && velocity_mps.x > 44.0);
}

#[cfg(feature = "beast")]
mod beast {
    use fga_formats::traffic::beast::push_frame;

    use super::received;
    use crate::common::data;

    fn frames(messages: &[&str], into: &mut Vec<u8>) {
        for message in messages {
            let bytes: Vec<u8> = (0..message.len())
                .step_by(2)
                .map(|at| u8::from_str_radix(&message[at..at + 2], 16).expect("hexadecimal"))
                .collect();
            push_frame(into, 0x1A1A_0000_001A, 0x1A, &bytes);
        }
    }

    // J. Sun, "The 1090 Megahertz Riddle", chapter 5: a pair of positions and what it means.
    const PAIR: [&str; 2] = [
        "8D40621D58C386435CC412692AD6",
        "8D40621D58C382D690C8AC2863A7",
    ];

    /// The recording by pyModeS 3.6.1: one aircraft that squitters, TRA89M, with two positions by
    /// pairs of messages; behind it the book's aircraft.
    #[test]
    fn a_recording_and_the_books_messages_mean_what_others_say() {
        let Some(path) = data("adsb/sample_dump1090.bin") else {
            return;
        };
        let mut bytes = std::fs::read(path).expect("readable");
        frames(&PAIR, &mut bytes);
        let reports = received("beast", bytes, 97, 0x40_621D);
        assert!(!reports.is_empty());
        assert!(reports.iter().all(|report| report.icao == 0x48_520A));
        for (latitude, longitude) in [
            (43.644_212_625_794_49, 1.231_515_066_964_285_6),
            (43.656_646_728_515_625, 1.229_638_387_990_552_4),
        ] {
            assert!(
                reports.iter().any(|report| {
                    (report.place.latitude_deg - latitude).abs() < 1e-9
                        && (report.place.longitude_deg - longitude).abs() < 1e-9
                }),
                "{latitude} {longitude}"
            );
        }
        for report in &reports {
            assert!((report.place.altitude_m - 38_000.0 * 0.3048).abs() < 1e-6);
            // 395 kt at 353.76°, as it says of every velocity.
            if let Some(velocity) = report.velocity_mps {
                let knots = libm::hypot(velocity.x, velocity.y) * 3600.0 / 1852.0;
                assert!((knots - 395.0).abs() < 1.0, "{knots}");
                let track = velocity.x.atan2(velocity.y).to_degrees();
                assert!((track + 6.244).abs() < 0.01, "{track}");
            }
        }
        assert!(reports.iter().any(|report| report.callsign == "TRA89M"));
    }

    #[test]
    fn the_books_pair_gives_its_place() {
        let mut bytes = Vec::new();
        frames(&PAIR, &mut bytes);
        frames(
            &[
                "8D485020994409940838175B284F",
                "8D4840D6202CC371C32CE0576098",
            ],
            &mut bytes,
        );
        // A pair of another aircraft ends it: the book's pair under another address.
        let mut last = Vec::new();
        for content in ["58C386435CC412", "58C382D690C8AC"] {
            last.push(squitter(0x00FF_FFFF, content));
        }
        for message in &last {
            push_frame(&mut bytes, 0, 0, message);
        }
        let reports = received("beast", bytes, 5, super::LAST);
        assert_eq!(reports.len(), 1);
        let place = reports[0].place;
        assert_eq!(reports[0].icao, 0x40_621D);
        assert!((place.latitude_deg - 52.257_20).abs() < 1e-5);
        assert!((place.longitude_deg - 3.919_37).abs() < 1e-5);
        assert!((place.altitude_m - 38_000.0 * 0.3048).abs() < 1e-6);
    }

    /// A squitter of an address with a right checksum.
    fn squitter(address: u32, content: &str) -> Vec<u8> {
        let content = u64::from_str_radix(content, 16).expect("hexadecimal");
        let mut message = vec![0x8D];
        message.extend(&address.to_be_bytes()[1..]);
        message.extend(&content.to_be_bytes()[1..]);
        // Polynomial division bit by bit on the whole message as one number.
        let mut number = message.iter().fold(0_u128, |n, b| n << 8 | u128::from(*b)) << 24;
        for bit in (24..112).rev() {
            if number >> bit & 1 == 1 {
                number ^= 0x1FF_F409 << (bit - 24);
            }
        }
        message.extend(&number.to_be_bytes()[13..]);
        message
    }
}
