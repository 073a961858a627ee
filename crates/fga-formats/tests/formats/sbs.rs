//! BaseStation lines: a recorded log, damaged lines, and a round trip.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "tests fail by panicking"
)]

use crate::common::data;
use fga_formats::traffic::sbs::{self, Recording, Stream};
use fga_formats::traffic::{Altitude, Callsign, TrafficReport};
use proptest::prelude::*;
use std::collections::{HashMap, HashSet};
use std::io::{BufReader, Read};

/// The figures of the log (216 aircraft, 44 with 2104 positions) come from splitting its lines at
/// commas in another language.
#[test]
fn every_aircraft_of_a_recorded_log_is_found() {
    let Some(path) = data("adsb/stratux-es.log.gz") else {
        return;
    };
    let mut stream = Stream::new();
    let mut addresses = HashSet::new();
    let mut places: HashMap<u32, Vec<[f64; 2]>> = HashMap::new();
    let mut last_s = 0.0;
    let mut lines = 0;
    for recorded in Recording::open(&path).unwrap() {
        assert!(recorded.time_s >= last_s, "{} {last_s}", recorded.time_s);
        last_s = recorded.time_s;
        lines += 1;
        // Every line has the address, even without other content.
        let text = String::from_utf8(recorded.line.clone()).unwrap();
        addresses.insert(text.split(',').nth(4).unwrap().to_owned());
        stream.push(&recorded.line, |_| {});
        stream.push(b"\r\n", |report| {
            if let Some(place) = report.place_deg {
                places.entry(report.address).or_default().push(place);
            }
        });
    }
    assert_eq!(lines, 44_478);
    assert_eq!(addresses.len(), 216);
    assert_eq!(places.len(), 44);
    assert_eq!(places.values().map(Vec::len).sum::<usize>(), 2104);
    // Where they were: around Lake Erie.
    let all = || places.values().flatten();
    assert!(all().all(|p| (41.49..43.26).contains(&p[0]) && (-85.55..-82.68).contains(&p[1])));
    // A restart of the recorder cut one line.
    assert_eq!(stream.counts().damaged, 1);
    // Four pieces, the longest three of 2673, 2451 and 2117 s.
    assert!((7200.0..7400.0).contains(&last_s), "{last_s}");
}

#[test]
fn a_stream_is_the_same_however_it_is_cut() {
    let Some(path) = data("adsb/stratux-es.log.gz") else {
        return;
    };
    let mut bytes = Vec::new();
    flate2::read::MultiGzDecoder::new(std::fs::File::open(path).unwrap())
        .take(400_000)
        .read_to_end(&mut bytes)
        .unwrap();
    let collect = |size: usize| {
        let mut stream = Stream::new();
        let mut reports = Vec::new();
        for part in bytes.chunks(size) {
            stream.push(part, |report| reports.push(report));
        }
        (reports, stream.counts())
    };
    let whole = collect(usize::MAX);
    assert!(whole.0.len() > 3000);
    for size in [1, 7, 1460] {
        assert_eq!(collect(size), whole);
    }
}

#[test]
fn fields_have_their_units() {
    let line = b"MSG,4,1,1,A1B2C3,1,2026/01/01,00:00:00.000,2026/01/01,00:00:00.000,,,100,90,,,-600,,0,0,0,-1";
    let report = sbs::parse_line(line).unwrap();
    assert_eq!(report.address, 0xA1_B2C3);
    assert!((report.ground_speed_mps.unwrap() - 51.444_444_444).abs() < 1e-6);
    assert!((report.climb_mps.unwrap() + 3.048).abs() < 1e-12);
    assert_eq!(report.course_rad, Some(0.0));
    assert_eq!(report.on_ground, Some(true));
    let [east, north] = report.ground_velocity_mps().unwrap();
    assert!((east - 51.444_444_444).abs() < 1e-6 && north.abs() < 1e-12);
    let line = b"MSG,1,,,A1B2C3,,,,,,N123AB  ,,,,,,,,,,,";
    let report = sbs::parse_line(line).unwrap();
    assert_eq!(report.callsign.unwrap().as_str(), "N123AB");
    // Zero latitude and longitude stand for no position.
    let line = b"MSG,3,,,A1B2C3,,,,,,,1000,,,0.0,0.0,,,,,,0";
    assert_eq!(sbs::parse_line(line).unwrap().place_deg, None);
}

#[test]
fn damaged_lines_are_skipped_and_counted() {
    let good = "MSG,3,,,A1B2C3,,,,,,,1000,,,10.0,20.0,,,,,,0";
    for (line, damaged) in [
        ("", 0),
        ("hello", 0),
        ("STA,,5,179,400AE7,10103,,,,,RM", 0),
        ("MSG,8,,,A1B2C3,,,,,,,,,,,,,,,,,", 0),
        ("MSG,3,,,A1B2C3,,,,,,,1000,,,10.0,20.", 1),
        ("MSG,9,,,A1B2C3,,,,,,,1000,,,10.0,20.0,,,,,,0", 1),
        ("MSG,3,,,XYZ,,,,,,,1000,,,10.0,20.0,,,,,,0", 1),
        ("MSG,3,,,1A1B2C3,,,,,,,1000,,,10.0,20.0,,,,,,0", 1),
        ("MSG,3,,,A1B2C3,,,,,,,NaN,,,10.0,20.0,,,,,,0", 1),
        ("MSG,3,,,A1B2C3,,,,,,,1000,,,91.0,20.0,,,,,,0", 1),
        ("MSG,3,,,A1B2C3,,,,,,,1e9,,,10.0,20.0,,,,,,0", 1),
    ] {
        let mut stream = Stream::new();
        stream.push(line.as_bytes(), |report| panic!("{line}: {report:?}"));
        stream.push(b"\n", |report| panic!("{line}: {report:?}"));
        assert_eq!(stream.counts().damaged, damaged, "{line}");
    }
    // A line without end takes no more memory and spoils only itself.
    let mut stream = Stream::new();
    let mut reports = 0;
    stream.push(&vec![b'x'; 1 << 20], |_| reports += 1);
    stream.push(b"\n", |_| reports += 1);
    stream.push(good.as_bytes(), |_| reports += 1);
    stream.push(b"\r\n", |_| reports += 1);
    assert_eq!((reports, stream.counts().damaged), (1, 1));
}

proptest! {
    #[test]
    fn any_bytes_are_taken(bytes in proptest::collection::vec(any::<u8>(), 0..2000), text in "(MSG,[0-9],,,[0-9A-F]{6}[-,.0-9eN]{0,60}\n){0,4}") {
        let mut stream = Stream::new();
        stream.push(&bytes, |_| {});
        stream.push(text.as_bytes(), |_| {});
        let _ = Recording::new(BufReader::new(bytes.as_slice())).count();
        let _ = Recording::new(BufReader::new(text.as_bytes())).count();
    }

    #[test]
    fn sent_reports_are_read_back(
        address in 1..0xFF_FFFF_u32, latitude in -90.0..90.0_f64, longitude in 0.1..180.0_f64,
        altitude in -300.0..15_000.0_f64, speed in 0.0..300.0_f64, course in -3.1..3.1_f64, climb in -20.0..20.0_f64,
    ) {
        let sent = TrafficReport {
            address,
            callsign: Callsign::new("N1 AB"),
            place_deg: Some([latitude, longitude]),
            altitude: Some(Altitude::Pressure(altitude)),
            ground_speed_mps: Some(speed),
            course_rad: Some(course),
            climb_mps: Some(climb),
            on_ground: Some(false),
            ..TrafficReport::default()
        };
        let mut lines = Vec::new();
        sbs::push_lines(&mut lines, &sent);
        let mut found = Vec::new();
        Stream::new().push(&lines, |report| found.push(report));
        prop_assert_eq!(found.len(), 3);
        prop_assert!(found.iter().all(|report| report.address == address && report.on_ground == Some(false)));
        prop_assert_eq!(found[0].callsign, sent.callsign);
        let [a, b] = found[1].place_deg.unwrap();
        prop_assert!((a - latitude).abs() < 6e-7 && (b - longitude).abs() < 6e-7);
        prop_assert!((found[1].altitude.unwrap().metres() - altitude).abs() < 0.16);
        prop_assert!((found[2].ground_speed_mps.unwrap() - speed).abs() < 0.03);
        prop_assert!((found[2].course_rad.unwrap() - course).abs() < 0.001);
        prop_assert!((found[2].climb_mps.unwrap() - climb).abs() < 0.003);
    }
}
