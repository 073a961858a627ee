//! The program around the companion, in real time: each test removes something in a manoeuvre and checks who
//! wins. Each is named after a way in which an earlier version lost the vehicle or its mode.
#![allow(
    clippy::std_instead_of_alloc,
    clippy::std_instead_of_core,
    reason = "a test program"
)]

use std::net::UdpSocket;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crate::common::live::{self, Live, ModeCommand, RADIUS_M};
use fga_emulator::PlaneMode;
use fga_formats::terrain::Terrain;
use fga_link::fly::{FlyOptions, fly};
use fga_link::{Companion, Config};

const KEY: &str = "0707070707070707070707070707070707070707070707070707070707070707";

/// The program in a thread of this one.
struct Program {
    stop: Arc<AtomicU32>,
    thread: Option<JoinHandle<std::io::Result<()>>>,
}

impl Program {
    fn start(
        endpoint: &str,
        config: &str,
        out: &Path,
        end_program: fn(),
        watch: impl FnMut(&Companion) + Send + 'static,
    ) -> Self {
        Self::start_over(None, endpoint, config, out, end_program, watch)
    }

    /// The same over ground.
    fn start_over(
        terrain: Option<Arc<Terrain>>,
        endpoint: &str,
        config: &str,
        out: &Path,
        end_program: fn(),
        mut watch: impl FnMut(&Companion) + Send + 'static,
    ) -> Self {
        let options = FlyOptions {
            endpoint: endpoint.parse().expect("an endpoint"),
            config: Config::parse(config).expect("a configuration"),
            traffic: Vec::new(),
            terrain,
            dry_run: false,
            out: out.to_owned(),
            status: false,
            end_program,
        };
        let stop = Arc::new(AtomicU32::new(0));
        let flag = Arc::clone(&stop);
        let thread = thread::spawn(move || fly(&options, &flag, &mut watch));
        Self {
            stop,
            thread: Some(thread),
        }
    }

    fn end(&mut self) -> std::io::Result<()> {
        self.stop.fetch_add(1, Ordering::Relaxed);
        self.thread
            .take()
            .expect("a thread")
            .join()
            .expect("no panic")
    }
}

fn udpout(live: &Live) -> String {
    format!("udpout:{}", live.address)
}

fn never() {
    panic!("the program must not be ended");
}

/// Blocks the deciding thread once a flag is set, until another one is.
#[derive(Clone, Default)]
struct Block(Arc<(AtomicBool, AtomicBool)>);

impl Block {
    fn watch(&self) -> impl FnMut(&Companion) + Send + 'static {
        let flags = Arc::clone(&self.0);
        move |_| {
            while flags.0.load(Ordering::Relaxed) && !flags.1.load(Ordering::Relaxed) {
                thread::sleep(Duration::from_millis(5));
            }
        }
    }

    fn set(&self) {
        self.0.0.store(true, Ordering::Relaxed);
    }

    fn free(&self) {
        self.0.1.store(true, Ordering::Relaxed);
    }
}

#[test]
fn main_thread_blocked_in_a_manoeuvre_and_the_pilot_chooses() {
    static ENDED: AtomicU32 = AtomicU32::new(0);
    let benches: Vec<_> = [
        PlaneMode::Manual,
        PlaneMode::Stabilize,
        PlaneMode::FlyByWireA,
    ]
    .into_iter()
    .map(|mode| {
        let live = Live::udp(None, None);
        let out = live::folder(&format!("blocked-{mode:?}"));
        let block = Block::default();
        let program = Program::start(
            &udpout(&live),
            &live::config(),
            &out,
            || _ = ENDED.fetch_add(1, Ordering::Relaxed),
            block.watch(),
        );
        (mode, live, block, program)
    })
    .collect();
    for (mode, live, block, _) in &benches {
        live.wait_for_maneuver();
        block.set();
        live.emulator().pilot_mode(*mode);
    }
    let commands: Vec<Vec<ModeCommand>> = benches.iter().map(|b| b.1.commands()).collect();
    benches[0]
        .1
        .wait_until("the end of all three programs", |_| {
            ENDED.load(Ordering::Relaxed) == 3
        });
    for ((mode, live, block, mut program), before) in benches.into_iter().zip(commands) {
        assert_eq!(live.mode(), mode);
        assert_eq!(live.commands(), before, "no command after the pilot's");
        block.free();
        drop(program.end());
    }
}

#[test]
fn main_thread_blocked_in_a_manoeuvre_the_mode_is_restored_and_the_program_ends() {
    static ENDED: AtomicU32 = AtomicU32::new(0);
    let live = Live::udp(None, None);
    let out = live::folder("blocked");
    let block = Block::default();
    let mut program = Program::start(
        &udpout(&live),
        &live::config(),
        &out,
        || _ = ENDED.fetch_add(1, Ordering::Relaxed),
        block.watch(),
    );
    live.wait_for_maneuver();
    let before = live.commands().len();
    block.set();
    live.wait_until("the end of the program", |_| {
        ENDED.load(Ordering::Relaxed) == 1
    });
    assert_eq!(live.mode(), PlaneMode::Auto);
    let tries = live.commands().len() - before;
    assert!((1..=6).contains(&tries), "{:?}", live.commands());
    block.free();
    drop(program.end());
}

#[test]
fn main_thread_panicked_in_a_manoeuvre() {
    let live = Live::udp(None, None);
    let out = live::folder("panicked");
    let panics = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&panics);
    let mut program = Program::start(
        &udpout(&live),
        &live::config(),
        &out,
        || {},
        move |_| {
            assert!(!flag.load(Ordering::Relaxed), "as the test wants it");
        },
    );
    live.wait_for_maneuver();
    panics.store(true, Ordering::Relaxed);
    live.wait_until("AUTO", |live| live.mode() == PlaneMode::Auto);
    assert!(program.end().is_err(), "the program ends with an error");
    assert!(!has_note(&out) || live.mode() == PlaneMode::Auto);
}

fn has_note(out: &Path) -> bool {
    out.join("owed-1.json").exists()
}

#[test]
fn the_mode_that_is_owed_is_noted_before_it_is_taken_and_until_it_is_given_back() {
    let live = Live::udp(None, None);
    let out = live::folder("noted");
    let mut program = Program::start(&udpout(&live), &live::config(), &out, never, |_| {});
    while live.commands().is_empty() {
        thread::sleep(Duration::from_millis(1));
    }
    assert!(has_note(&out));
    live.wait_for_mission();
    live.wait_until("no note", |_| !has_note(&out));
    assert!(live.least_m() >= RADIUS_M, "{}", live.least_m());
    // A late answer is asked for again.
    let mut asked: Vec<u32> = live.commands().iter().map(|c| c.asked).collect();
    asked.dedup();
    let there_and_back = [PlaneMode::Guided, PlaneMode::Auto].map(PlaneMode::number);
    assert_eq!(asked, there_and_back, "{:?}", live.commands());
    program.end().expect("an orderly end");
    assert!(live.was_told("fga: program ends"));
}

/// A note of an earlier run whose vehicle has long flown on is gone from the disk before a later run could take the pilot's own GUIDED for it.
#[test]
fn l4_a_note_that_is_history_is_removed_once_its_vehicle_is_heard() {
    let live = Live::udp(None, None);
    let out = live::folder("history");
    let note = |system_id: u8| {
        let text = format!(
            r#"{{"system_id":{system_id},"owned_mode":15,"previous_mode":10,"boot_ms":0}}"#
        );
        std::fs::write(out.join(format!("owed-{system_id}.json")), text).expect("a note");
    };
    note(1);
    note(3);
    let mut program = Program::start(&udpout(&live), &live::config(), &out, never, |_| {});
    live.wait_until("no note", |_| !has_note(&out));
    assert!(live.commands().is_empty(), "before any manoeuvre");
    assert!(out.join("owed-3.json").exists(), "another vehicle's");
    program.end().expect("an orderly end");
}

/// An unwritable folder, also for root: its parent is a file.
fn impossible(name: &str) -> PathBuf {
    let file = live::folder(name).join("file");
    std::fs::write(&file, "").expect("a file");
    file.join("folder")
}

#[test]
fn without_any_disk_it_avoids_all_the_same() {
    let live = Live::udp(None, None);
    let out = impossible("no-disk");
    let mut program = Program::start(&udpout(&live), &live::config(), &out, never, |_| {});
    live.wait_for_mission();
    assert!(live.least_m() >= RADIUS_M, "{}", live.least_m());
    assert!(live.was_told("fga: log stopped:"));
    assert!(live.was_told("fga: note of the mode not kept:"));
    program.end().expect("an orderly end");
}

#[test]
fn eight_one_byte_datagrams_from_eight_ports_with_signing_on() {
    // The companion's port, known before it starts.
    let port = {
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
        socket.local_addr().expect("an address")
    };
    let out = live::folder("strangers");
    let config = format!("[link]\nsigning_key = \"{KEY}\"\n{}", live::config());
    let mut program = Program::start(&format!("udpin:{port}"), &config, &out, never, |_| {});
    let strangers: Vec<UdpSocket> = (0..8)
        .map(|_| UdpSocket::bind("127.0.0.1:0").expect("a port"))
        .collect();
    let speak = |strangers: &[UdpSocket]| {
        for stranger in strangers {
            let _ = stranger.send_to(&[0xFD], port);
        }
    };
    // Before the vehicle, and all the time.
    thread::sleep(Duration::from_millis(200));
    speak(&strangers);
    let live = Live::udp(Some(port), Some([7; 32]));
    while live.emulator().plant().position_m()[1] < live::AHEAD_M + 30.0
        || live.mode() != PlaneMode::Auto
    {
        speak(&strangers);
        thread::sleep(Duration::from_millis(50));
        assert!(
            live.emulator().plant().position_m()[1] < 1500.0,
            "no way back"
        );
    }
    assert!(live.least_m() >= RADIUS_M, "{}", live.least_m());
    for stranger in strangers {
        stranger.set_nonblocking(true).expect("non-blocking");
        assert!(
            stranger.recv(&mut [0; 300]).is_err(),
            "nothing is sent to strangers"
        );
    }
    // What the vehicle sends from now on the companion may not hear before it ends: that would be no replay.
    let recorded = live.sent();
    thread::sleep(Duration::from_secs(1));
    program.end().expect("an orderly end");
    drop(live);

    // The frames of the last minute, replayed to a restarted companion.
    let heard = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&heard);
    let mut program = Program::start(
        &format!("udpin:{port}"),
        &config,
        &out,
        never,
        move |companion| {
            if companion.vehicle_system().is_some() {
                flag.store(true, Ordering::Relaxed);
            }
        },
    );
    thread::sleep(Duration::from_millis(300));
    let replayer = UdpSocket::bind("127.0.0.1:0").expect("a port");
    for frame in recorded.iter().take(2000) {
        let _ = replayer.send_to(frame, port);
        thread::sleep(Duration::from_micros(200));
    }
    thread::sleep(Duration::from_millis(300));
    assert!(!heard.load(Ordering::Relaxed), "a replay is no vehicle");
    replayer.set_nonblocking(true).expect("non-blocking");
    assert!(replayer.recv(&mut [0; 300]).is_err());
    program.end().expect("an orderly end");
}

#[test]
fn tcp_half_open_peer_frozen() {
    let live = Live::tcp();
    let out = live::folder("half-open");
    let mut program = Program::start(
        &format!("tcp:{}", live.address),
        &live::config(),
        &out,
        never,
        |_| {},
    );
    live.wait_until("ready", |live| live.was_told("fga: ready"));
    assert_eq!(live.connections.load(Ordering::Relaxed), 1);
    live.frozen.store(true, Ordering::Relaxed);
    thread::sleep(Duration::from_secs(7));
    live.frozen.store(false, Ordering::Relaxed);
    live.wait_until("a new connection", |live| {
        live.connections.load(Ordering::Relaxed) > 1
    });
    let told = live.emulator().texts().len();
    live.wait_until("texts over it", |live| live.emulator().texts().len() > told);
    program.end().expect("an orderly end");
}

#[test]
fn the_ground_is_made_beside_the_deciding_thread() {
    let live = Live::udp(None, None);
    let out = live::folder("ground");
    let config = format!(
        "{}\n[terrain]\nfile = \"N37W123.hgt\"\nclearance_m = 30.0\n",
        live::config()
    );
    // The mission is 104 m above the sea.
    let terrain = crate::terrain::tile(|_, _| Some(80));
    let endpoint = udpout(&live);
    let mut program = Program::start_over(Some(terrain), &endpoint, &config, &out, never, |_| {});
    live.wait_until("a mission that is too low", |live| {
        live.was_told("24 m above ground: too low") || live.was_told("legs too low")
    });
    live.wait_for_maneuver();
    program.end().expect("an orderly end");
    let mut logs = std::fs::read_dir(&out).expect("a folder").flatten();
    let log = logs.find(|entry| {
        entry
            .path()
            .extension()
            .is_some_and(|ending| ending == "jsonl")
    });
    let log = std::fs::read_to_string(log.expect("a log").path()).expect("text");
    assert!(log.contains("\"above_ground_m\":"), "{log}");
}
