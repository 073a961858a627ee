//! BaseStation lines: a recorded log, damaged lines, and a round trip.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "tests fail by panicking"
)]

use crate::common::data;
use fga_formats::tally::LeftOut;
use fga_formats::traffic::sbs::{self, LineStream, Log};
use fga_formats::traffic::{Altitude, Callsign, NON_ICAO, TrafficReport};
use proptest::prelude::*;
use std::collections::{HashMap, HashSet};
use std::io::Read;

/// The figures of the log (216 aircraft, 44 with 2104 positions) come from splitting its lines at
/// commas in another language.
#[test]
fn every_aircraft_of_a_recorded_log_is_found() {
    let Some(path) = data("adsb/stratux-es.log.gz") else {
        return;
    };
    let mut addresses = HashSet::new();
    let mut places: HashMap<u32, Vec<[f64; 2]>> = HashMap::new();
    let mut last_s = 0.0;
    let mut lines = 0;
    let unpacked = flate2::read::MultiGzDecoder::new(std::fs::File::open(path).unwrap());
    let mut log = Log::new(unpacked);
    for recorded in &mut log {
        assert!(recorded.time_s >= last_s, "{} {last_s}", recorded.time_s);
        last_s = recorded.time_s;
        lines += 1;
        // Every line has the address, even without other content.
        addresses.insert(recorded.line.split(',').nth(4).unwrap().to_owned());
        if let Ok(report) = recorded.report
            && let Some(place) = report.place_deg
        {
            places.entry(report.address).or_default().push(place);
        }
    }
    assert_eq!(lines, 44_478);
    assert_eq!(addresses.len(), 216);
    assert_eq!(places.len(), 44);
    assert_eq!(places.values().map(Vec::len).sum::<usize>(), 2104);
    // Where they were: around Lake Erie.
    let all = || places.values().flatten();
    assert!(all().all(|p| (41.49..43.26).contains(&p[0]) && (-85.55..-82.68).contains(&p[1])));
    // Restarts of the recorder cut one line and left zeros in another.
    assert_eq!(log.tally().lost(), 2);
    assert_eq!(log.tally().left_out(LeftOut::CutShort), 1);
    assert_eq!(log.tally().left_out(LeftOut::TooLong), 1);
    // With its three START lines.
    assert_eq!(log.tally().read(), 44_481);
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
        let mut stream = LineStream::default();
        let mut reports = Vec::new();
        for part in bytes.chunks(size) {
            stream.push(part, |report| reports.push(report));
        }
        (reports, stream.tally())
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
fn what_cannot_be_used_is_counted_by_its_reason() {
    use LeftOut::{CutShort, NoAddress, NotNeeded, TooLong, UnknownKind, UnreadableField};
    let good = "MSG,3,,,A1B2C3,,,,,,,1000,,,10.0,20.0,,,,,,0";
    for (line, reason) in [
        ("", NotNeeded),
        ("\r", NotNeeded),
        ("hello", UnknownKind),
        ("*8D4840D6202CC371C32CE0576098;", UnknownKind),
        ("START,Wed Sep 2 04:23:37 +0000 UTC 2015", NotNeeded),
        ("STA,,5,179,400AE7,10103,,,,,RM", NotNeeded),
        (
            "AIR,,496,5906,400F01,27931,2010/02/19,18:06:07.128,,",
            NotNeeded,
        ),
        ("MSG,8,,,A1B2C3,,,,,,,,,,,,,,,,,", NotNeeded),
        ("MSG,6,,,A1B2C3,,,,,,,,,,,,,1200,0,0,0,", NotNeeded),
        ("MSG,3,,,A1B2C3,,,,,,,1000,,,10.0,20.", CutShort),
        (
            "MSG,33,,,A1B2C3,,,,,,,1000,,,10.0,20.0,,,,,,0",
            UnreadableField,
        ),
        ("MSG,3,,,XYZ,,,,,,,1000,,,10.0,20.0,,,,,,0", NoAddress),
        ("MSG,3,,,,,,,,,,1000,,,10.0,20.0,,,,,,0", NoAddress),
        ("MSG,3,,,~~A1B2C3,,,,,,,1000,,,10.0,20.0,,,,,,0", NoAddress),
        ("MSG,3,,,1A1B2C3,,,,,,,1000,,,10.0,20.0,,,,,,0", NoAddress),
        (
            "MSG,3,,,A1B2C3,,,,,,,NaN,,,10.0,20.0,,,,,,0",
            UnreadableField,
        ),
        (
            "MSG,3,,,A1B2C3,,,,,,,1000,,,91.0,20.0,,,,,,0",
            UnreadableField,
        ),
        (
            "MSG,3,,,A1B2C3,,,,,,,1e9,,,10.0,20.0,,,,,,0",
            UnreadableField,
        ),
        (
            "MSG,3,,,A1B2C3,,,,,,,1000,,,10.0,20.0,,,,,,0MSG,3",
            UnreadableField,
        ),
        (
            "MSG,3,1,1,A1B2C3,1,2024/01/01,00:00:00.000,2024/01/01,00:01:00.000,,1000,,,10.0,20.0,,,,,,0",
            LeftOut::TooOld,
        ),
    ] {
        let mut stream = LineStream::default();
        stream.push(line.as_bytes(), |report| panic!("{line}: {report:?}"));
        stream.push(b"\n", |report| panic!("{line}: {report:?}"));
        assert_eq!(stream.tally().left_out(reason), 1, "{line}");
        assert_eq!(stream.tally().read(), 1, "{line}");
    }
    // A line without end takes no more memory and spoils only itself.
    let mut stream = LineStream::default();
    let mut reports = 0;
    stream.push(&vec![b'x'; 1 << 20], |_| reports += 1);
    // It counts before its end, which may never come.
    assert_eq!(stream.tally().left_out(TooLong), 1);
    stream.push(b"\n", |_| reports += 1);
    stream.push(good.as_bytes(), |_| reports += 1);
    stream.push(b"\r\n", |_| reports += 1);
    stream.push(b"MSG,3,,,A1", |_| reports += 1);
    stream.reconnect();
    assert_eq!((reports, stream.tally().used), (1, 1));
    assert_eq!(stream.tally().left_out(TooLong), 1);
    assert_eq!(stream.tally().left_out(CutShort), 1);
}

/// The line that a receiver sends, and the same in the plain form: 22 fields without additions.
fn same(other: &str, plain: &str) {
    let [other_report, report] = [other, plain].map(|line| sbs::parse_line(line.as_bytes()));
    assert_eq!(other_report.unwrap(), report.unwrap(), "{other}");
}

#[test]
fn t1_geometric_suffix_of_base_station_is_read() {
    let line = "MSG,3,1,1,AA0001,1,,,,,,5825H,100,90,45.0,5.0,-640H,,0,0,0,0";
    let report = sbs::parse_line(line.as_bytes()).unwrap();
    assert_eq!(report.altitude, Some(Altitude::Ellipsoid(5825.0 * 0.3048)));
    assert!((report.climb_mps.unwrap() + 640.0 * 0.3048 / 60.0).abs() < 1e-12);
    // Without a difference to the pressure the same programs write the bare altitude.
    let report = sbs::parse_line(line.replace('H', "").as_bytes()).unwrap();
    assert_eq!(report.altitude, Some(Altitude::Pressure(5825.0 * 0.3048)));
}

#[test]
fn t1_more_fields_other_words_and_quotes_are_read() {
    let plain = "MSG,3,1,1,AA0001,1,,,,,N1,5825,100,90,45.0,5.0,-640,1200,0,0,0,0";
    for line in [
        // readsb with its signal and category.
        format!("{plain},-20.1,A1"),
        format!("{plain},,"),
        // Virtual Radar Server, and whatever comes next.
        plain.replace("MSG", "MLAT"),
        plain.replace("MSG", "ADSC"),
        plain.replace(",N1,", ",\"N1\","),
        // The recorder's time of Stratux.
        format!("2936535519,{plain}"),
        format!("{plain}\r"),
        plain.replace("AA0001", "aa0001"),
        plain.replace("5825", "5825.0"),
        // Not every sender fills the type.
        plain.replace("MSG,3", "MSG,"),
    ] {
        same(&line, plain);
    }
    // A comma in quotes: mlat-client.
    let quoted = plain.replace(",N1,", ",\"N,1\",");
    same(&quoted, &plain.replace(",N1,", ",,"));
    // mlat-client's extended form ends with the stations and the error, σ in metres.
    let mlat = format!("{},4,,120", plain.replace("MSG", "MLAT"));
    let report = sbs::parse_line(mlat.as_bytes()).unwrap();
    assert!((report.position_error_m.unwrap() - 120.0 * 2.4477).abs() < 1e-9);
    let report = sbs::parse_line(mlat.replace("120", "").as_bytes()).unwrap();
    assert_eq!(report.position_error_m, None);
}

#[test]
fn t1_addresses_of_others_than_the_icao_are_read_and_kept_apart() {
    let line = |address: &str| {
        let line = format!("MSG,3,1,1,{address},1,,,,,,1000,,,45.0,5.0,,,0,0,0,0");
        sbs::parse_line(line.as_bytes()).unwrap().address
    };
    assert_eq!(line("AA0002"), 0xAA_0002);
    assert_eq!(line("~AA0002"), 0xAA_0002 | NON_ICAO);
    assert_eq!(line("~aa0002"), 0xAA_0002 | NON_ICAO);
    assert_eq!(line("~1"), 1 | NON_ICAO);
}

#[test]
fn t1_the_time_of_reception_gives_the_age() {
    let age_s = |received: &str, sent: &str| {
        let line = format!("MSG,3,1,1,AA0001,1,{received},{sent},,1000,,,45.0,5.0,,,0,0,0,0");
        sbs::parse_line(line.as_bytes()).map(|report| report.age_s)
    };
    let age = age_s("2026/04/30,23:59:58.500", "2026/05/01,00:00:00.250").unwrap();
    assert!((age - 1.75).abs() < 1e-6, "{age}");
    assert_eq!(age_s(",", "2026/05/01,00:00:00.250"), Ok(0.0));
    // A clock that is wrong says nothing about an age.
    assert_eq!(
        age_s("2026/05/01,00:00:01.000", "2026/05/01,00:00:00.250"),
        Ok(0.0)
    );
    assert_eq!(
        age_s("2026/05/01,00:00:01.000", "2026/05/01,02:00:00.250"),
        Ok(0.0)
    );
}

#[test]
fn t1_recorded_lines_keep_their_times_over_the_end_of_a_month() {
    let mut text = String::new();
    for (date, time) in [
        ("2026/04/30", "23:59:58.000"),
        ("2026/04/30", "23:59:59.1000"),
        ("2026/05/01", "00:00:01.500"),
    ] {
        let line = format!("MSG,3,1,1,AA0001,1,{date},{time},{date},{time}");
        text.push_str(&line);
        text.push_str(",,1000,,,45.0,5.0,,,0,0,0,0\n\n");
    }
    text.push_str("MSG,3,1,1,AA0001,1,,,,,,1000,,,45.0,5.0,,,0,0,0,0\n");
    let mut log = Log::new(text.as_bytes());
    let times_s: Vec<f64> = (&mut log).map(|line| line.time_s).collect();
    // date -u -d '2026-04-30 23:59:58' +%s
    assert_eq!(
        times_s,
        [0.0, 2.0, 3.5].map(|after_s| 1_777_593_598.0 + after_s)
    );
    let tally = log.tally();
    assert_eq!((tally.used, tally.read()), (3, 7));
    assert_eq!(tally.left_out(LeftOut::NoTime), 1);
}

proptest! {
    /// Whatever comes, every line is in exactly one count, for a stream and for a recording.
    #[test]
    fn every_line_is_counted_once(
        garbage in proptest::collection::vec(any::<u8>(), 0..600),
        text in "((MSG|MLAT|AIR|[0-9]{1,21},MSG)(,[0-9]{0,2}){3},~?[0-9A-F]{0,7}(,[-.:/0-9eNH]{0,10}){0,20}\n){0,4}",
        cuts in proptest::collection::vec((0..120_usize, any::<u8>()), 0..6),
    ) {
        let mut bytes = text.into_bytes();
        let plain = "MSG,3,1,1,AA0001,1,2026/04/30,23:59:58.000,2026/04/30,23:59:58.000,N1,5825,100,90,45.0,5.0,-640,1200,0,0,0,0,-20.1,A1\r\n";
        for (at, byte) in cuts {
            // A good line with one byte changed, and one cut off there.
            let mut line = plain.as_bytes().to_vec();
            let at = at % line.len();
            line[at] = byte;
            bytes.extend(&line);
            bytes.extend(&plain.as_bytes()[..at]);
            bytes.push(b'\n');
        }
        bytes.extend(garbage);
        bytes.push(b'\n');
        let lines = bytes.split(|byte| *byte == b'\n').count() as u64 - 1;
        let mut stream = LineStream::default();
        let mut reports = 0;
        stream.push(&bytes, |_| reports += 1);
        let tally = stream.tally();
        prop_assert_eq!((tally.read(), tally.used), (lines, reports));
        let by_reason: u64 = LeftOut::all().map(|reason| tally.left_out(reason)).sum();
        prop_assert_eq!(tally.used + by_reason, lines);
        let mut log = Log::new(bytes.as_slice());
        let used = (&mut log).filter(|line| line.report.is_ok()).count() as u64;
        prop_assert_eq!((log.tally().read(), log.tally().used), (lines, used));
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
        LineStream::default().push(&lines, |report| found.push(report));
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

#[test]
fn a_time_with_numbers_out_of_range_is_no_time() {
    for time in [
        "4294967295:59:59.000",
        "10:4294967295:00.000",
        "24:00:00.000",
        "10:00:00.x",
    ] {
        let line = format!("MSG,3,1,1,4CA2D6,1,2026/01/01,{time},,,,3700,,,45.0,5.0,,,0,0,0,0\n");
        let mut log = Log::new(line.as_bytes());
        assert_eq!((&mut log).count(), 0, "{time}");
        assert_eq!(log.tally().left_out(LeftOut::NoTime), 1, "{time}");
    }
}
