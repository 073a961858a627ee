//! The page on ArduPlane runs as written: the aircraft that its commands send are met, avoided and left behind, and its
//! mission is one.

use crate::common::{GOOD, Intruder, World};
use fga_emulator::PlaneMode;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_formats::missions;
use fga_formats::traffic::sbs;
use fga_link::player::{PlayerLine, sbs_lines};
use fga_link::traffic::ReportSource;
use fga_link::traffic::receiver::Joiner;

const PAGE: &str = include_str!("../../../../docs/how-to-arduplane.md");
/// The volume around a crewed aircraft, metres.
const PROTECTED_M: f64 = 152.4;

/// The page's `--line` arguments.
fn lines() -> impl Iterator<Item = &'static str> {
    let ends = |letter: char| letter.is_whitespace() || letter == '`';
    let after = PAGE.split("--line ").skip(1);
    after.map(move |rest| rest.split(ends).next().unwrap_or_default())
}

#[test]
fn n9_the_aircraft_of_the_page_are_met_and_avoided() {
    assert_eq!(lines().count(), 2);
    for text in lines() {
        let line: PlayerLine = text.parse().expect("a line");
        // The configuration of `fga init link`: the defaults.
        let volume = "[volumes.crewed]\nradius_m = 152.4\nhalf_height_m = 30.48\n";
        let mut world = World::new(volume, GOOD, 3);
        let home = *world.emulator.home();
        let home = Geodetic::new(home.latitude_deg, home.longitude_deg, home.altitude_m);
        let frame = LocalFrame::new(home.expect("a place"), Earth::Wgs84);
        let begin = line.0.at(0.0).expect("a sample");
        // The bench reports nothing of it: the receiver does.
        let mut unseen = Intruder::straight(
            line.0.icao,
            frame.to_local_m(begin.place).to_array(),
            begin.velocity_mps.to_array(),
        );
        unseen.shown_m = 0.0;
        world.add(unseen);
        let mut joiner = Joiner::new(ReportSource::Sbs);
        let mut due_s = 0.0;
        while world.time_s < 170.0 {
            world.step();
            if world.time_s < due_s {
                continue;
            }
            due_s = world.time_s + 1.0;
            let sample = line.0.at(world.time_s).expect("a sample");
            for line in sbs_lines(line.0.icao, &line.0.callsign, &sample).lines() {
                let message = sbs::parse_line(line.as_bytes()).expect("a line");
                if let Some(report) = joiner.take(&message, world.time_s) {
                    world.companion.take_report(&report, world.time_s);
                }
            }
        }
        let (least_m, at_s) = world.least_m[0];
        eprintln!("{text}: least {least_m:.1} m at {at_s:.1} s");
        assert!(least_m >= PROTECTED_M, "{text}: {least_m} m at {at_s} s");
        assert_eq!(world.companion.counts().maneuvers, 1, "{text}");
        assert_eq!(world.mode(), PlaneMode::Auto, "{text}");
    }
}

#[test]
fn n9_the_mission_of_the_page_is_one() {
    let list = PAGE
        .split("```\n")
        .find(|block| block.starts_with("QGC WPL"));
    let path = std::path::Path::new("north.waypoints");
    let mission = missions::parse(list.expect("a mission"), path).expect("a mission");
    assert_eq!(mission.holds(), "2 waypoints, 0 fences, 0 rally points");
    let [from, .., to] = mission.waypoints[..] else {
        panic!("{mission:?}");
    };
    // Over the emulator's field, which the page names, and 5 km on.
    let home = fga_emulator::EmulatorSettings::default().home;
    let custom = format!(
        "{},{},{},0",
        home.latitude_deg, home.longitude_deg, home.altitude_m
    );
    assert!(PAGE.contains(&custom), "{custom}");
    assert_eq!(from.place.latitude_deg, home.latitude_deg);
    assert!((from.place.distance_m(to.place) - 5000.0).abs() < 20.0);
}
