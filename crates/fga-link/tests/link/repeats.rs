//! A log repeats its flight: the program flies in real time with a receiver beside the link, and the replay of its log says the same, line
//! by line.
#![allow(
    clippy::std_instead_of_alloc,
    clippy::std_instead_of_core,
    reason = "a test program"
)]

use std::fs::{self, File};
use std::io::Write as _;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use fga::Vec3;
use fga_formats::geodesy::Geodetic;
use fga_link::fly::{FlyOptions, fly};
use fga_link::player::{PlayedState, sbs_lines};
use fga_link::replay::{Replayed, differences, replay};
use fga_link::steps::Step;
use fga_link::tlog::{TlogReader, TlogWriter};
use fga_link::{Companion, Config};
use serde_json::Value;

use crate::common::live::{self, Live};

/// A receiver that reports an aircraft which passes the vehicle, every 0.7 s; its address.
fn receiver() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    thread::spawn(move || {
        let Ok((mut reader, _)) = listener.accept() else {
            return;
        };
        let since = Instant::now();
        loop {
            let time_s = since.elapsed().as_secs_f64();
            let place = Geodetic {
                latitude_deg: 37.6189 + (2500.0 - 50.0 * time_s) / 111_000.0,
                longitude_deg: -122.375 + 400.0 / 88_000.0,
                altitude_m: 110.0,
            };
            let sample = PlayedState {
                time_s,
                place,
                velocity_mps: Vec3::new(0.0, -50.0, 0.0),
            };
            let lines = sbs_lines(0x00AB_CDEF, "TEST", &sample);
            if reader.write_all(lines.as_bytes()).is_err() {
                return;
            }
            thread::sleep(Duration::from_millis(700));
        }
    });
    format!("sbs:{address}")
}

/// The file of a folder with an ending.
fn file(folder: &Path, ending: &str) -> PathBuf {
    let files = fs::read_dir(folder).expect("a folder");
    let mut paths = files.map(|file| file.expect("a file").path());
    paths
        .find(|path| path.extension().is_some_and(|found| found == ending))
        .expect("a log")
}

fn replayed(log: &Path, config: &str) -> (Replayed, Vec<Value>) {
    let config = Config::parse(config).expect("a configuration");
    let mut companion = Companion::new(config, false).expect("a companion");
    let mut lines = Vec::new();
    let done = replay(File::open(log).expect("a log"), &mut companion, |line| {
        lines.push(line.clone());
        Ok(())
    });
    (done.expect("a replay"), lines)
}

/// Copies a log without the steps of its flight.
fn write_without_steps(from: &Path, to: &Path) {
    let mut reader = TlogReader::new(File::open(from).expect("a log"));
    let mut writer = TlogWriter::new(File::create(to).expect("a file"));
    while let Some(logged) = reader.next_frame().expect("a frame") {
        if Step::of_message(&logged.frame.message).is_none() {
            let written = writer.write(logged.unix_us, logged.frame.bytes());
            written.expect("a written frame");
        }
    }
}

#[test]
fn a_log_repeats_its_flight_to_the_step() {
    let config = live::config();
    let (log, flown) = repeats_a_flight("repeats", &config);
    // Without its steps, as an older log: the same take-over, at another moment.
    let old = log.with_file_name("old.tlog");
    write_without_steps(&log, &old);
    let (done, repeated) = replayed(&old, &config);
    let taken_s = |lines: &[Value]| {
        let takes = |line: &&Value| line["kind"] == "set-mode" && line["mode"] == "GUIDED";
        lines
            .iter()
            .find(takes)
            .and_then(|line| line["t_s"].as_f64())
    };
    let (flown_s, again_s) = (taken_s(&flown), taken_s(&repeated));
    let off_s = flown_s.zip(again_s).map(|(a, b)| (a - b).abs());
    assert!(
        !done.repeats && off_s.is_some_and(|s| s < 0.3),
        "{flown_s:?} {again_s:?}"
    );
}

#[test]
fn a_log_repeats_a_flight_by_beliefs() {
    let config = format!("{}\n[command]\npolicy = \"belief\"\n", live::config());
    repeats_a_flight("repeats-belief", &config);
}

/// Flies, and repeats the flight from its log; the log, and the lines of its decisions.
fn repeats_a_flight(name: &str, config: &str) -> (PathBuf, Vec<Value>) {
    let live = Live::udp(None, None);
    let out = live::folder(name);
    let options = FlyOptions {
        endpoint: format!("udpout:{}", live.address)
            .parse()
            .expect("an endpoint"),
        config: Config::parse(config).expect("a configuration"),
        traffic: vec![receiver().parse().expect("a receiver")],
        terrain: None,
        dry_run: false,
        out: out.clone(),
        status: false,
        end_program: || panic!("the program must not be ended"),
    };
    let stop = Arc::new(AtomicU32::new(0));
    let flag = Arc::clone(&stop);
    let flight = thread::spawn(move || fly(&options, &flag, &mut |_| {}));
    live.wait_for_maneuver();
    live.wait_for_mission();
    stop.fetch_add(1, Ordering::Relaxed);
    flight.join().expect("no panic").expect("a flight");
    let log = file(&out, "tlog");
    let text = fs::read_to_string(file(&out, "jsonl")).expect("a decision log");
    let flown: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).expect("a line"))
        .collect();
    let (done, repeated) = replayed(&log, config);
    assert!(done.repeats && done.skipped == 0, "{done:?}");
    let decisions = flown.iter().filter(|line| line["kind"] == "decision");
    assert!(decisions.count() > 5);
    for (number, (flown, repeated)) in flown.iter().zip(&repeated).enumerate() {
        assert_eq!(flown, repeated, "line {number}");
    }
    assert_eq!(flown.len(), repeated.len());
    let repeated: Vec<String> = repeated.iter().map(Value::to_string).collect();
    assert_eq!(differences(&text, &repeated), None);
    // Another configuration repeats nothing, and says so.
    let (done, _) = replayed(&log, &format!("{config}\n[traffic]\ndrop_after_s = 10.0\n"));
    assert!(!done.repeats);
    (log, flown)
}
