//! The content of a receiver's wire is reported and counted: a feed that is not understood never looks like an empty sky.

use core::cell::Cell;
use core::sync::atomic::{AtomicBool, Ordering};
use std::io::Write as _;
use std::net::TcpListener;

use fga_formats::tally::LeftOut;
use fga_formats::traffic::NON_ICAO;
use fga_link::authority::Authority;
use fga_link::traffic::receiver::{self, FeedStatus};
use fga_link::traffic::{AltitudeReference, PlaceReport};

use crate::common::{GOOD, Intruder, World};

/// What a receiver gives of some lines: its reports, and its statuses. Much time passes between two reads, so that every
/// status is passed on.
fn given(text: &str, lines: u64) -> (Vec<PlaceReport>, Vec<FeedStatus>) {
    given_with_clock(text, lines, 11.0)
}

/// The same with a clock that begins at 100 s and goes on by `step_s` whenever it is read.
fn given_with_clock(text: &str, lines: u64, step_s: f64) -> (Vec<PlaceReport>, Vec<FeedStatus>) {
    let server = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = server.local_addr().expect("an address");
    let text = text.to_owned();
    let (done, wait) = std::sync::mpsc::channel();
    let sending = std::thread::spawn(move || {
        let (mut stream, _) = server.accept().expect("a reader");
        stream.write_all(text.as_bytes()).expect("sent");
        // The connection stays until everything is read.
        let _ = wait.recv();
    });
    let endpoint = format!("sbs:{address}").parse().expect("a receiver");
    let (mut reports, mut statuses) = (Vec::new(), Vec::new());
    let stop = AtomicBool::new(false);
    let now_s = Cell::new(100.0);
    receiver::read(
        &endpoint,
        || now_s.replace(now_s.get() + step_s),
        &stop,
        |report| {
            reports.push(report);
            true
        },
        |status| {
            statuses.push(status);
            if status.tally.read() >= lines {
                stop.store(true, Ordering::Relaxed);
            }
            true
        },
    );
    done.send(()).expect("a sender");
    sending.join().expect("sent");
    (reports, statuses)
}

/// Three lines of an aircraft, with this address and altitude, and fields behind the last.
fn lines(word: &str, address: &str, altitude: &str, more: &str) -> String {
    let line = |kind: u8, fields: &str| {
        format!(
            "{word},{kind},1,1,{address},1,2024/01/31,23:59:59.000,2024/02/01,00:00:00.500,{fields},,0,0,0,0{more}\r\n"
        )
    };
    line(1, "N1,,,,,,") + &line(4, ",,97,90,,,0") + &line(3, &format!(",{altitude},,,45.0,5.0,"))
}

#[test]
fn t1_every_form_of_base_station_gives_reports() {
    for (text, icao, altitude) in [
        (
            lines("MSG", "A1B2C3", "2000", ""),
            0xA1_B2C3,
            AltitudeReference::Pressure,
        ),
        (
            lines("MSG", "A1B2C3", "2000H", ""),
            0xA1_B2C3,
            AltitudeReference::Ellipsoid,
        ),
        (
            lines("MSG", "A1B2C3", "2000", ",-20.5,A1"),
            0xA1_B2C3,
            AltitudeReference::Pressure,
        ),
        (
            lines("MLAT", "A1B2C3", "2000", ",4,,100"),
            0xA1_B2C3,
            AltitudeReference::Pressure,
        ),
        (
            lines("MSG", "~A1B2C3", "2000", ""),
            0xA1_B2C3 | NON_ICAO,
            AltitudeReference::Pressure,
        ),
    ] {
        let (reports, statuses) = given_with_clock(&text, 3, 0.0);
        assert_eq!(reports.len(), 1, "{text}");
        let report = &reports[0];
        assert_eq!((report.icao, report.quality.altitude), (icao, altitude));
        assert!((report.place.altitude_m - 609.6).abs() < 1e-9);
        assert!(report.velocity_mps.is_some());
        // The line had waited for 1.5 s.
        assert!((report.valid_s - 98.5).abs() < 1e-6, "{}", report.valid_s);
        assert!(!statuses[0].was_connected && statuses[0].tally.read() == 0);
        let last = statuses.last().expect("a status");
        assert!(last.was_connected);
        assert_eq!(
            (last.tally.used, last.tally.lost(), last.positions),
            (3, 0, 1)
        );
    }
}

/// A world in which the feed has given this from the start, after some time.
fn world_with(status: FeedStatus) -> World {
    let mut world = World::new("", GOOD, 5);
    world.companion.take_feed(status, 0.0);
    world.run_until(20.0);
    world
}

fn texts_with(world: &World, words: &str) -> usize {
    let texts = world.emulator.texts().iter();
    texts.filter(|text| text.contains(words)).count()
}

#[test]
fn t1_a_feed_without_anything_readable_is_told_once_for_each_reason_and_is_not_ready() {
    let text = "nonsense\n".repeat(30)
        + &"MSG,3,1,1,A1B2C3,1,,,,,,5825X,,,45.0,5.0,,,0,0,0,0\n".repeat(30);
    let (reports, statuses) = given(&text, 60);
    assert!(reports.is_empty());
    let last = *statuses.last().expect("a status");
    assert_eq!(last.tally.left_out(LeftOut::UnknownKind), 30);
    assert_eq!(last.tally.left_out(LeftOut::UnreadableField), 30);
    let mut world = world_with(last);
    assert_eq!(world.companion.authority(), Authority::Waiting);
    let texts = world.emulator.texts();
    for words in [
        "of an unknown kind",
        "with an unreadable field",
        "not ready: traffic feed not understood",
    ] {
        assert_eq!(texts_with(&world, words), 1, "{words}: {texts:?}");
    }
    assert!(world.companion.feeds_in_words().contains("60 of 60"));
    // As soon as it is understood, it is ready; what is left out later is told, and costs nothing.
    let mut good = last;
    good.tally.used += 1;
    good.positions += 1;
    world.companion.take_feed(good, 20.0);
    world.run_until(30.0);
    assert_eq!(world.companion.authority(), Authority::Ready);
    good.tally.leave_out(LeftOut::CutShort);
    world.companion.take_feed(good, 30.0);
    world.run_until(35.0);
    assert_eq!(world.companion.authority(), Authority::Ready);
    assert_eq!(texts_with(&world, "traffic feed: 1 cut short"), 1);
}

#[test]
fn t1_a_feed_that_never_came_is_told_and_an_empty_one_is_ready() {
    let (_, statuses) = given("\r\n\r\n", 2);
    let world = world_with(statuses[0]);
    assert_eq!(world.companion.authority(), Authority::Waiting);
    assert_eq!(texts_with(&world, "not ready: no traffic feed"), 1);
    // Heartbeats alone: it says that it has nothing to give.
    let empty = *statuses.last().expect("a status");
    assert_eq!(empty.tally.left_out(LeftOut::NotNeeded), 2);
    let world = world_with(empty);
    assert_eq!(world.companion.authority(), Authority::Ready);
    assert_eq!(world.companion.feeds_in_words(), "");
}

/// A receiver in empty air sends nothing but a heartbeat each minute. One that misses two is named. In flight the companion goes on with the
/// reports of others; on the ground it is not ready.
#[test]
fn t1_a_feed_that_falls_silent_is_told_with_the_time_and_is_not_ready_on_the_ground() {
    let (_, statuses) = given("\r\n\r\n", 2);
    let heard = *statuses.last().expect("a status");
    let mut beating = heard;
    beating.tally.leave_out(LeftOut::NotNeeded);
    let mut world = world_with(heard);
    world.run_until(120.0);
    world.companion.take_feed(beating, world.time_s);
    world.run_until(245.0);
    assert_eq!(texts_with(&world, "no traffic feed"), 0);
    assert_eq!(world.companion.feeds_in_words(), "");
    world.run_until(255.0);
    assert_eq!(texts_with(&world, "fga: no traffic feed for 130 s"), 1);
    let words = world.companion.feeds_in_words();
    assert_eq!(words, " | no traffic feed for 135 s");
    assert_eq!(world.companion.authority(), Authority::Ready);
    world.emulator.set_armed(false);
    world.run_until(260.0);
    assert_eq!(world.companion.authority(), Authority::Waiting);
    assert_eq!(texts_with(&world, "not ready: no traffic feed"), 1);
    // The receiver is heard again, so the operator reads of its next silence too.
    world.companion.take_feed(heard, world.time_s);
    assert_eq!(world.companion.feeds_in_words(), "");
    world.run_until(395.0);
    assert_eq!(texts_with(&world, "fga: no traffic feed for"), 2);
}

/// Call signs and velocities are read, but no position: the altitude is of a form that nobody knows.
#[test]
fn t1_a_feed_whose_positions_cannot_be_read_is_not_ready() {
    let text = lines("MSG", "A1B2C3", "FL020", "").repeat(20);
    let (reports, statuses) = given(&text, 60);
    assert!(reports.is_empty());
    let last = *statuses.last().expect("a status");
    assert_eq!(
        (last.tally.used, last.tally.lost(), last.positions),
        (40, 20, 0)
    );
    let world = world_with(last);
    assert_eq!(world.companion.authority(), Authority::Waiting);
    assert_eq!(
        texts_with(&world, "not ready: traffic feed not understood"),
        1
    );
    // Messages without a position, of transponders without ADS-B, are nothing unusual: a cut line among many.
    let text = lines("MSG", "A1B2C3", "2000", "")
        .replace(",45.0,5.0,", ",,,")
        .repeat(20)
        + "MSG,3\n";
    let (_, statuses) = given(&text, 61);
    let last = *statuses.last().expect("a status");
    assert_eq!(
        (last.tally.used, last.tally.lost(), last.positions),
        (60, 1, 0)
    );
    assert_eq!(world_with(last).companion.authority(), Authority::Ready);
}

/// What goes wrong with a feed in flight takes nothing away: the manoeuvre goes on.
#[test]
fn t1_a_feed_that_is_not_understood_any_more_ends_no_manoeuvre() {
    let mut world = World::new("", GOOD, 5);
    world.add(Intruder::straight(
        0x00AB_CDEF,
        [5.0, 3000.0, 100.0],
        [0.0, -25.0, 0.0],
    ));
    world.run_until(30.0);
    let (_, statuses) = given(&"nonsense\n".repeat(30), 30);
    let broken = *statuses.last().expect("a status");
    while world.time_s < 110.0 {
        world.step();
        if matches!(world.companion.authority(), Authority::InCommand { .. }) {
            world.companion.take_feed(broken, world.time_s);
        }
    }
    assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m[0]);
}
