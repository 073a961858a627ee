//! The recorded BaseStation log through the tracks: every aircraft with positions has a track, and
//! positions agree with a decode that shares no code with the program. Memory stays bounded over many
//! rounds.

use alloc::collections::BTreeMap;
use fga::Vec3;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::traffic::sbs;
use fga_link::Config;
use fga_link::player::LoggedLine;
use fga_link::traffic::receiver::Joiner;
use fga_link::traffic::{ReportSource, TrackTable};

/// Last airborne position of each aircraft whose altitude is known by then: plain text handling.
fn independent(lines: &[LoggedLine]) -> BTreeMap<u32, (f64, f64, f64)> {
    let mut altitude: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
    let mut last = BTreeMap::new();
    for line in lines {
        let fields: Vec<&str> = line.line.split(',').collect();
        let Some(address) = fields
            .get(4)
            .and_then(|text| u32::from_str_radix(text, 16).ok())
        else {
            continue;
        };
        let number = |index: usize| fields.get(index).and_then(|text| text.parse::<f64>().ok());
        if let Some(feet) = number(11) {
            altitude.insert(address, (feet, line.time_s));
        }
        let recent = altitude
            .get(&address)
            .is_some_and(|(_, at_s)| line.time_s - at_s < 15.0);
        if let (Some(latitude), Some(longitude), true) = (number(14), number(15), recent) {
            last.insert(address, (line.time_s, latitude, longitude));
        }
    }
    last
}

#[test]
fn every_aircraft_with_positions_is_tracked_where_it_is() {
    let Some(lines) = crate::common::sbs_log() else {
        return;
    };
    let expected = independent(&lines);
    assert!(expected.len() >= 40, "{}", expected.len());
    let mut joiner = Joiner::new(ReportSource::Sbs);
    let config = Config::default();
    let mut tracks = TrackTable::new(&config.traffic, None);
    let origin = Geodetic::new(43.98, -88.55, 300.0).expect("valid");
    let (mut frame, mut seen) = (LocalFrame::new(origin, Earth::Wgs84), BTreeMap::new());
    let mut first = true;
    for line in &lines {
        let Ok(message) = sbs::parse_line(line.line.as_bytes()) else {
            continue;
        };
        let Some(report) = joiner.take(&message, line.time_s) else {
            continue;
        };
        if first {
            // The frame of a flight stands where the flight is.
            frame = LocalFrame::new(report.place, Earth::Wgs84);
            first = false;
        }
        tracks.take(&report, &frame, line.time_s);
        if let Some(track) = tracks
            .tracks()
            .iter()
            .find(|track| track.icao == report.icao)
        {
            let reported_m = frame.to_local_m(report.place);
            let off_m = track.position_m(line.time_s).distance(reported_m);
            seen.insert(report.icao, (line.time_s, off_m));
        }
        tracks.tidy(line.time_s, None);
    }
    for (address, (at_s, _, _)) in &expected {
        let (last_s, _) = seen
            .get(address)
            .unwrap_or_else(|| panic!("{address:06X} not tracked"));
        assert!(
            (last_s - at_s).abs() < 1e-6,
            "{address:06X}: {last_s} and {at_s}"
        );
    }
    let mut off: Vec<f64> = seen.values().map(|(_, off_m)| *off_m).collect();
    off.sort_by(f64::total_cmp);
    eprintln!(
        "{} aircraft; off: median {:.1} m, largest {:.1} m",
        off.len(),
        off[off.len() / 2],
        off[off.len() - 1]
    );
    // An airliner flies 250 m in a second, and lines carry no time of validity.
    assert!(off[off.len() / 2] < 30.0);
}

#[test]
fn played_for_hours_it_does_not_grow() {
    let Some(lines) = crate::common::sbs_log() else {
        return;
    };
    let mut joiner = Joiner::new(ReportSource::Sbs);
    let config = Config::default();
    let mut tracks = TrackTable::new(&config.traffic, None);
    let frame = LocalFrame::new(
        Geodetic::new(40.0, -90.0, 0.0).expect("valid"),
        Earth::Wgs84,
    );
    let length_s = lines.last().expect("lines").time_s + 60.0;
    let mut most = 0;
    // Two rounds of 45 minutes each.
    for round in 0..2_u8 {
        for line in &lines {
            let now_s = f64::from(round) * length_s + line.time_s;
            if let Ok(message) = sbs::parse_line(line.line.as_bytes())
                && let Some(report) = joiner.take(&message, now_s)
            {
                tracks.take(&report, &frame, now_s);
                tracks.tidy(now_s, Some((Vec3::ZERO, Vec3::X * 25.0)));
            }
            most = most.max(tracks.tracks().len());
        }
    }
    eprintln!("at most {most} tracks and {} aircraft", joiner.aircraft());
    assert!(most <= 60);
    assert!(joiner.aircraft() <= 216);
}
