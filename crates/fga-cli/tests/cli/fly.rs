//! `fga fly` as a program in real time, with the ArduPlane-like emulator: signals, a full disk, a held
//! terminal, a frozen browser, a sudden end. Each test is named after a way in which an earlier version
//! lost the vehicle or its mode.
#![allow(clippy::pedantic, reason = "a bench in real time")]

use core::net::SocketAddr;
use core::time::Duration;
use std::fs;
use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Instant, SystemTime};

use crate::live::{self, AHEAD_M, Live, RADIUS_M};
use crate::support::decisions_follow_their_schema;
use fga_emulator::PlaneMode;

/// The program; it ends with the test.
struct Program(Child);

impl Drop for Program {
    fn drop(&mut self) {
        drop(self.0.kill());
        drop(self.0.wait());
    }
}

impl Program {
    fn signal(&self, name: &str) {
        let done = Command::new("sh")
            .args(["-c", &format!("kill -{name} {}", self.0.id())])
            .status();
        assert!(done.is_ok_and(|status| status.success()));
    }

    fn ended(&mut self) -> ExitStatus {
        let since = Instant::now();
        loop {
            if let Some(status) = self.0.try_wait().expect("a child") {
                return status;
            }
            assert!(since.elapsed() < Duration::from_secs(20), "it does not end");
            thread::sleep(Duration::from_millis(20));
        }
    }
}

/// `fga fly` for a vehicle, run by a shell line that ends in `exec "$@"`.
fn command(shell: &str, live: &Live, folder: &Path, more: &[&str]) -> Command {
    let config = folder.join("fly.toml");
    fs::write(&config, live::config()).expect("a configuration");
    let mut command = Command::new("sh");
    command
        .args(["-c", shell, "sh", env!("CARGO_BIN_EXE_fga"), "fly"])
        .args(["--connect", &format!("udpout:{}", live.address)])
        .arg("--config")
        .arg(config)
        .arg("--out")
        .arg(folder.join("out"))
        .args(more)
        .stdin(Stdio::null());
    command
}

fn start(live: &Live, folder: &Path) -> Program {
    let child = command("exec \"$@\"", live, folder, &["--quiet"]).spawn();
    Program(child.expect("the program starts"))
}

/// The aircraft passes the disc without touching it, with one command of a mode out and at most one
/// back. Other tests check the way back.
fn avoids(live: &Live) {
    passes(live);
    assert!(live.commands().len() <= 2, "{:?}", live.commands());
}

fn passes(live: &Live) {
    live.wait_until("the other side of the disc", |live| {
        live.emulator().plant().position_m()[1] > AHEAD_M + RADIUS_M + 10.0
    });
    assert!(live.least_m() >= RADIUS_M, "{}", live.least_m());
}

#[test]
fn sigint_sigterm_sighup_hand_back_alike() {
    // Each in a thread of its own: a manoeuvre does not wait for what another flight is looked at.
    let ends = |signal: &str| {
        let live = Live::udp(None, None);
        let folder = live::folder(&format!("signal-{signal}"));
        let mut program = start(&live, &folder);
        live.wait_for_maneuver();
        program.signal(signal);
        assert!(program.ended().success(), "{signal}");
        assert_eq!(live.mode(), PlaneMode::Auto, "{signal}");
        let written = fs::read_dir(folder.join("out"));
        let log = written
            .expect("a folder")
            .map(|entry| entry.expect("an entry").path())
            .find(|path| path.extension().is_some_and(|ending| ending == "jsonl"));
        let log = log.expect("a log of decisions");
        assert!(decisions_follow_their_schema(&log) > 3, "{signal}");
        assert!(
            live.was_told("fga: program ends, restores the mode"),
            "{signal}"
        );
    };
    thread::scope(|scope| {
        for signal in ["INT", "TERM", "HUP"] {
            scope.spawn(move || ends(signal));
        }
    });
}

#[test]
fn stopped_and_continued_after_the_pilots_choice() {
    let live = Live::udp(None, None);
    let program = start(&live, &live::folder("stopped"));
    live.wait_for_maneuver();
    program.signal("STOP");
    thread::sleep(Duration::from_millis(300));
    live.emulator().pilot_mode(PlaneMode::Manual);
    thread::sleep(Duration::from_secs(6));
    let before = live.commands();
    program.signal("CONT");
    thread::sleep(Duration::from_secs(4));
    assert_eq!(live.mode(), PlaneMode::Manual);
    assert_eq!(live.commands(), before);
}

#[test]
fn stopped_and_continued_without_a_pilot_the_mode_is_given_back() {
    let live = Live::udp(None, None);
    let program = start(&live, &live::folder("stopped-alone"));
    live.wait_for_maneuver();
    program.signal("STOP");
    thread::sleep(Duration::from_secs(5));
    program.signal("CONT");
    live.wait_until("AUTO", |live| live.mode() == PlaneMode::Auto);
}

#[test]
fn kill_9_in_command_and_restarted_one_second_later() {
    let live = Live::udp(None, None);
    let folder = live::folder("killed");
    let program = start(&live, &folder);
    live.wait_for_maneuver();
    program.signal("KILL");
    thread::sleep(Duration::from_secs(1));
    let _program = start(&live, &folder);
    live.wait_until("words", |live| {
        live.was_told("fga: restarted, goes on avoiding")
            || live.was_told("fga: restarted, restores the mode")
    });
    passes(&live);
}

#[test]
fn standard_error_into_a_pipe_that_nobody_reads_and_a_closed_one() {
    let (stalled, closed) = (Live::udp(None, None), Live::udp(None, None));
    let (_reader, mut writer) = std::io::pipe().expect("a pipe");
    // A pipe holds 64 KiB: the next byte waits for a reader.
    writer.write_all(&[b'.'; 65_536]).expect("room");
    let folder = live::folder("stalled");
    let child = command("exec \"$@\"", &stalled, &folder, &[])
        .stderr(writer)
        .spawn();
    let mut program = Program(child.expect("the program starts"));
    let folder = live::folder("closed");
    let child = command("exec \"$@\" 2>&-", &closed, &folder, &[]).spawn();
    let mut other = Program(child.expect("the program starts"));
    avoids(&stalled);
    avoids(&closed);
    program.signal("TERM");
    assert!(program.ended().success(), "it ends without a reader");
    other.signal("TERM");
    assert!(other.ended().success());
}

/// The vehicle passes the texts on to its other links, where perhaps nobody looks: the terminal shows them too.
#[test]
fn the_terminal_shows_what_the_operator_reads() {
    let live = Live::udp(None, None);
    let folder = live::folder("words");
    let said = folder.join("said.txt");
    let mut command = command("exec \"$@\"", &live, &folder, &[]);
    let child = command.stderr(fs::File::create(&said).expect("a file"));
    let mut program = Program(child.spawn().expect("the program starts"));
    avoids(&live);
    program.signal("TERM");
    assert!(program.ended().success());
    let said = fs::read_to_string(&said).expect("a file");
    let begins = |words: &str| said.lines().filter(|line| line.starts_with(words)).count();
    assert_eq!(begins("fga: avoiding "), 1, "{said}");
    assert_eq!(begins("fga: ready"), 1, "{said}");
}

#[test]
fn disk_full_in_a_manoeuvre_and_a_restart_on_the_full_disk() {
    // A file may grow to 48 KiB: reached after some seconds.
    let growing = Live::udp(None, None);
    let folder = live::folder("disk-grows");
    let shell = "trap '' XFSZ; ulimit -f 96; exec \"$@\"";
    let child = command(shell, &growing, &folder, &["--quiet"]).spawn();
    let mut program = Program(child.expect("the program starts"));
    // And a disk without any room: every write there fails with ENOSPC.
    let full = Live::udp(None, None);
    let folder = live::folder("disk-full");
    fs::create_dir_all(folder.join("out")).expect("a folder");
    let now_s = SystemTime::now()
        .duration_since(SystemTime::UNIX_EPOCH)
        .expect("a clock")
        .as_secs();
    for second in now_s..now_s + 60 {
        for ending in ["tlog", "jsonl"] {
            let path = folder.join(format!("out/fly-{second}.{ending}"));
            std::os::unix::fs::symlink("/dev/full", path).expect("a link");
        }
    }
    let mut other = start(&full, &folder);
    avoids(&growing);
    avoids(&full);
    assert!(growing.was_told("fga: log stopped: file too large"));
    assert!(full.was_told("fga: log stopped: disk full"));
    for program in [&mut program, &mut other] {
        assert!(
            program.0.try_wait().expect("a child").is_none(),
            "it flies on"
        );
        program.signal("TERM");
        assert!(program.ended().success());
    }
}

#[test]
fn the_folder_of_the_log_removed_in_a_manoeuvre() {
    let live = Live::udp(None, None);
    let folder = live::folder("removed");
    let _program = start(&live, &folder);
    live.wait_for_maneuver();
    fs::remove_dir_all(folder.join("out")).expect("removed");
    avoids(&live);
    live.wait_until("words", |live| {
        live.was_told("fga: log stopped: no such folder")
    });
}

fn free_address() -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    listener.local_addr().expect("an address")
}

/// A browser that asks for the flight and then reads nothing.
fn frozen_browser(address: SocketAddr) -> TcpStream {
    let since = Instant::now();
    let mut stream = loop {
        match TcpStream::connect(address) {
            Ok(stream) => break stream,
            Err(error) => assert!(since.elapsed() < Duration::from_secs(20), "{error}"),
        }
        thread::sleep(Duration::from_millis(50));
    };
    let request = format!(
        "GET /live HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    );
    stream.write_all(request.as_bytes()).expect("a request");
    let mut answer = [0; 12];
    stream.read_exact(&mut answer).expect("an answer");
    assert_eq!(&answer, b"HTTP/1.1 101", "the flight is shown");
    stream
}

#[test]
fn a_browser_that_is_frozen() {
    let live = Live::udp(None, None);
    let folder: PathBuf = live::folder("browser");
    let address = free_address();
    let listen = address.to_string();
    let more = ["--quiet", "--live", "--listen", &listen];
    let child = command("exec \"$@\"", &live, &folder, &more).spawn();
    let mut program = Program(child.expect("the program starts"));
    let _frozen: Vec<TcpStream> = (0..3).map(|_| frozen_browser(address)).collect();
    avoids(&live);
    program.signal("TERM");
    assert!(program.ended().success());
}

/// Level ground at 10 m in the tile of the emulator's home.
fn level_tile(folder: &Path) {
    let heights = 10_i16.to_be_bytes().repeat(1201 * 1201);
    fs::write(folder.join("N37W123.hgt"), heights).expect("a tile");
}

#[test]
fn the_live_page_has_the_height_above_the_ground() {
    let live = Live::udp(None, None);
    let folder: PathBuf = live::folder("above-ground");
    level_tile(&folder);
    let address = free_address();
    let listen = address.to_string();
    let more = ["--quiet", "--live", "--listen", &listen];
    let mut command = command("exec \"$@\"", &live, &folder, &more);
    let terrain = "\n[terrain]\nfile = \"N37W123.hgt\"\nclearance_m = 30.0\n";
    fs::write(folder.join("fly.toml"), live::config() + terrain).expect("a configuration");
    let _program = Program(command.spawn().expect("the program starts"));
    let mut browser = frozen_browser(address);
    let mut heard = String::new();
    let since = Instant::now();
    // 104 m above the sea, over 10 m.
    while !heard.contains("\"94 m above ground") {
        assert!(since.elapsed() < Duration::from_secs(60), "{heard}");
        let mut bytes = [0; 4096];
        let count = browser.read(&mut bytes).expect("messages");
        heard += &String::from_utf8_lossy(&bytes[..count]);
    }
}

/// Resident memory of a process, bytes.
#[cfg(target_os = "linux")]
fn memory(process: u32) -> u64 {
    let text = fs::read_to_string(format!("/proc/{process}/statm")).expect("statm");
    let pages: u64 = text
        .split_whitespace()
        .nth(1)
        .and_then(|pages| pages.parse().ok())
        .expect("resident pages");
    pages * 4096
}

/// An earlier version held 0.65 MB for each connection, until the process was killed in GUIDED.
#[cfg(target_os = "linux")]
#[test]
fn l3_a_thousand_idle_and_a_thousand_greedy_browsers() {
    let live = Live::udp(None, None);
    let folder: PathBuf = live::folder("crowd");
    let address = free_address();
    let listen = address.to_string();
    let more = ["--quiet", "--live", "--listen", &listen];
    let child = command("exec \"$@\"", &live, &folder, &more).spawn();
    let mut program = Program(child.expect("the program starts"));
    // It answers.
    drop(frozen_browser(address));
    let before = memory(program.0.id());
    let request = format!("GET / HTTP/1.1\r\nHost: {address}\r\n\r\n");
    // As many at once as this process may have descriptors for.
    let crowd: Vec<TcpStream> = (0..2000)
        .map_while(|number| {
            let mut stream = TcpStream::connect(address).ok()?;
            if number % 2 == 1 {
                // One without room is closed already.
                let _ = stream.write_all(request.as_bytes());
            }
            Some(stream)
        })
        .collect();
    avoids(&live);
    let cost = memory(program.0.id()).saturating_sub(before);
    eprintln!(
        "{} connections: {cost} bytes, the flight in it",
        crowd.len()
    );
    assert!(cost < 20_000_000, "{cost} bytes");
    program.signal("TERM");
    assert!(program.ended().success());
}

/// `fga fly --replay` refused a log that `fga check` and `fga identify` read.
#[test]
fn l14_a_compressed_log_is_read_and_one_without_decisions_or_damaged_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut log = Vec::new();
    let mut writer = fga_link::tlog::TlogWriter::new(&mut log);
    for second in 0..3 {
        let beat = mavlink::dialects::ardupilotmega::MavMessage::HEARTBEAT(Default::default());
        let raw = fga_link::wire::encode(mavlink::MavHeader::default(), &beat, None);
        let at_us = 1_700_000_000_000_000 + second * 1_000_000;
        writer.write(at_us, raw.raw_bytes()).unwrap();
    }
    log.truncate(log.len() - 2);
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(&log).unwrap();
    let packed = packed.finish().unwrap();
    let replay = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_fga"))
            .args(["fly", "--replay"])
            .arg(path)
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), said)
    };
    for (name, bytes) in [("a.tlog", &log), ("a.tlog.gz", &packed)] {
        let (code, said) = replay(name, bytes);
        assert_eq!(code, Some(1), "{said}");
        let expected =
            "holds no decision (2 frames, 1 not understood), expected the log of a flight";
        assert!(said.trim().ends_with(expected), "{said}");
    }
    let (code, said) = replay("cut.tlog.gz", &packed[..packed.len() - 9]);
    assert_eq!(code, Some(1), "{said}");
    assert!(
        said.contains("damaged gzip data") && said.lines().count() == 1,
        "{said}"
    );
}

/// A port that nobody listens on.
fn free_port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    listener.local_addr().expect("an address").port()
}

/// The number behind some words.
fn number_after(said: &str, words: &str) -> f64 {
    let (_, rest) = said.split_once(words).unwrap_or_else(|| panic!("{said}"));
    let number = rest.split_whitespace().find_map(|word| word.parse().ok());
    number.unwrap_or_else(|| panic!("{said}"))
}

/// The first manoeuvre, by the command of the page, towards an intruder that is nearer.
#[test]
fn emulate_flies_a_first_manoeuvre_and_says_the_least_separation() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_fga"))
        .args(["emulate", "--fly", "--seconds", "300"])
        .args(["--serve", &format!("tcpin:127.0.0.1:{}", free_port())])
        .args(["--intruder", "ABC123,37.6350,-122.375,104,180,25"])
        .current_dir(folder.path())
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    let changes: Vec<&str> = said.lines().filter(|l| l.contains("emulator: ")).collect();
    assert!(changes[0].contains("Guided") && changes[1].contains("Auto"));
    // The companion says it from reports, the emulator from the places.
    let reported_m = number_after(&said, "least separation ");
    let true_m = number_after(&said, "least distance to ABC123 ");
    assert!(true_m >= 152.4, "{said}");
    assert!(said.contains("fga: avoiding ABC123, "), "{said}");
    assert!((reported_m - true_m).abs() < 15.0, "{said}");
    let logs = fs::read_dir(folder.path().join("out/fly")).unwrap();
    let logs = logs.map(|entry| entry.unwrap().path());
    let log = logs.filter(|path| path.extension().is_some_and(|ending| ending == "tlog"));
    replay_is_compared(&log.last().unwrap());
}

/// The replay of a flight's log says whether it decides as the flight did.
fn replay_is_compared(log: &Path) {
    let replayed_with = |code: i32, options: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_fga"));
        command.args(["fly", "--replay"]).arg(log).args(options);
        let output = command.output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{said}");
        assert!(!output.stdout.is_empty());
        said
    };
    let replayed = |code: i32| replayed_with(code, &[]);
    let flown = log.with_extension("jsonl");
    let text = fs::read_to_string(&flown).unwrap();
    let count = text.lines().count();
    let said = replayed(0);
    assert!(
        said.contains(&format!("; all {count} lines are those of ")),
        "{said}"
    );
    fs::write(
        &flown,
        text.replacen("\"kind\":\"decision\"", "\"kind\":\"x\"", 1),
    )
    .unwrap();
    let said = replayed(1);
    assert!(
        said.contains("decides otherwise than its flight in 1 of the lines"),
        "{said}"
    );
    assert!(
        said.contains(": kind is \"x\" in the flight, \"decision\" in the replay"),
        "{said}"
    );
    // Where there is nothing to compare with, that is a failure too.
    let refused = |said: &str, begin: &Path, why: &str| {
        let begins = said.starts_with(&format!("fga: {}: ", begin.display()));
        let ends = said.trim().ends_with(": no decision was compared");
        assert!(begins && ends && said.contains(why), "{said}");
    };
    let other = replayed_with(1, &["--policy", "belief"]);
    refused(&other, log, "was flown with another configuration");
    fs::remove_file(&flown).unwrap();
    refused(&replayed(1), &flown, "expected the flight's decision log");
    let bytes = fs::read(log).unwrap();
    fs::write(log, bytes.repeat(2)).unwrap();
    assert!(replayed(1).contains("another flight begins in the log"));
    let mut frames = fga_link::tlog::TlogReader::new(bytes.as_slice());
    let mut stepless = fga_link::tlog::TlogWriter::new(fs::File::create(log).unwrap());
    while let Some(logged) = frames.next_frame().unwrap() {
        if fga_link::steps::Step::of_message(&logged.frame.message).is_none() {
            let written = stepless.write(logged.unix_us, logged.frame.bytes());
            written.unwrap();
        }
    }
    stepless.flush().unwrap();
    refused(&replayed(1), log, "holds no steps of the program");
}

#[test]
fn traffic_counts_the_lines_that_it_served() {
    let port = free_port();
    let child = Command::new(env!("CARGO_BIN_EXE_fga"))
        .args(["traffic", "--serve-sbs", &format!("127.0.0.1:{port}")])
        .args(["--line", "ABC123,37.6350,-122.375,104,180,25"])
        .stderr(Stdio::piped())
        .spawn();
    let mut program = Program(child.expect("the program starts"));
    let since = Instant::now();
    let mut reader = loop {
        match TcpStream::connect(("127.0.0.1", port)) {
            Ok(reader) => break reader,
            Err(error) => assert!(since.elapsed() < Duration::from_secs(20), "{error}"),
        }
        thread::sleep(Duration::from_millis(20));
    };
    let mut heard = [0; 200];
    reader.read_exact(&mut heard).unwrap();
    program.signal("INT");
    assert!(program.ended().success());
    let mut said = String::new();
    let errors = program.0.stderr.as_mut().expect("a pipe");
    errors.read_to_string(&mut said).unwrap();
    assert!(number_after(&said, "") >= 2.0, "{said}");
    assert!(said.ends_with(" lines sent to 1 reader\n"), "{said}");
}
