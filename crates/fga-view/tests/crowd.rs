//! A crowd of connections costs little memory and few descriptors. One program: it measures its own memory.
#![cfg(target_os = "linux")]

use core::net::{Ipv4Addr, SocketAddr};
use core::time::Duration;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{fs, thread};

use fga_report::replay::{LiveMessage, ReplayRun, ReplaySample};
use fga_view::{Live, ServedFolder, Server};

const ANY_PORT: SocketAddr = SocketAddr::new(core::net::IpAddr::V4(Ipv4Addr::LOCALHOST), 0);
const CROWD: usize = 1000;
/// Most memory that a crowd may cost, bytes.
const MOST_BYTES: u64 = 20_000_000;
const PAGE_BYTES: u64 = 4096;

/// Resident memory of this process, bytes.
fn memory() -> u64 {
    let text = fs::read_to_string("/proc/self/statm").expect("statm");
    let pages = text.split_whitespace().nth(1).expect("resident pages");
    pages.parse::<u64>().expect("a number") * PAGE_BYTES
}

fn descriptors() -> usize {
    fs::read_dir("/proc/self/fd").expect("descriptors").count()
}

/// The whole page, or `None` from a server without room.
fn page(address: SocketAddr) -> Option<String> {
    let mut stream = TcpStream::connect(address).ok()?;
    write!(stream, "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").ok()?;
    let mut answer = String::new();
    stream.read_to_string(&mut answer).ok()?;
    answer.starts_with("HTTP/1.1 200").then_some(answer)
}

fn samples(live: &Live, count: u32) {
    for step in 0..count {
        let sample = ReplaySample {
            t_s: f64::from(step),
            ..ReplaySample::default()
        };
        live.send(&LiveMessage::Sample { run: 0, sample });
    }
}

/// Each test measures the memory of the program: one at a time.
static ALONE: Mutex<()> = Mutex::new(());

fn alone() -> MutexGuard<'static, ()> {
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

#[test]
fn l3_a_thousand_idle_and_a_thousand_greedy_connections_cost_little() {
    let _alone = alone();
    let (server, live) = Server::live(ANY_PORT, "flight").expect("server");
    let address = server.address();
    live.send(&LiveMessage::Run(Box::new(ReplayRun::named("r"))));
    // The history is full before the crowd comes: it is none of the crowd's cost.
    samples(&live, 60_000);
    assert!(page(address).is_some());
    let before = memory();
    let crowds: [(&str, &[&str]); 3] = [
        ("idle", &[""]),
        ("slow", &["GET / HTTP/1.1\r\nHost: localhost\r\nX: "]),
        (
            "greedy",
            &[
                "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n",
                "GET /live HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
                 Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
            ],
        ),
    ];
    for (name, words) in crowds {
        let others = descriptors();
        let mut crowd = Vec::new();
        for number in 0..CROWD {
            // Fewer where this process may not have so many descriptors.
            let Ok(mut stream) = TcpStream::connect(address) else {
                break;
            };
            // A server without room has closed it already.
            let _ = stream.write_all(words[number % words.len()].as_bytes());
            crowd.push(stream);
        }
        samples(&live, 60_000);
        let cost = memory().saturating_sub(before);
        let held = descriptors().saturating_sub(others + crowd.len());
        eprintln!("{} {name}: {cost} bytes, {held} descriptors", crowd.len());
        assert!(cost < MOST_BYTES, "{name}: {cost} bytes");
        assert!(held <= 33, "{name}: {held} descriptors");
    }
    // Once they have gone, there is room again.
    while page(address).is_none() {
        thread::sleep(Duration::from_millis(50));
    }
}

/// Pages of a folder are megabytes: a few at once, however many ask and do not read.
#[test]
fn l3_a_crowd_at_a_folder_costs_a_few_pages() {
    let _alone = alone();
    let folder = tempfile::tempdir().expect("folder");
    fs::write(
        folder.path().join("run.json"),
        "{\"name\":\"n\",\"policy\":\"p\"}",
    )
    .expect("run");
    let page = "x".repeat(2_000_000);
    fs::write(folder.path().join("replay.html"), page).expect("page");
    let folder = ServedFolder::open(folder.path()).expect("open");
    let server = Server::catalogue(ANY_PORT, folder).expect("server");
    let before = memory();
    let crowd: Vec<_> = (0..200)
        .map(|_| {
            let mut stream = TcpStream::connect(server.address()).expect("connect");
            let request = "GET /replay/replay.html HTTP/1.1\r\nHost: localhost\r\n\r\n";
            let _ = stream.write_all(request.as_bytes());
            stream
        })
        .collect();
    thread::sleep(Duration::from_secs(2));
    let cost = memory().saturating_sub(before);
    eprintln!("{} at a folder: {cost} bytes", crowd.len());
    assert!(cost < MOST_BYTES, "{cost} bytes");
}

/// Idle connections end by themselves, so that a browser finds room while they stay open.
#[test]
fn l3_idle_connections_make_room() {
    let _alone = alone();
    let (server, _live) = Server::live(ANY_PORT, "flight").expect("server");
    let idle: Vec<_> = (0..40)
        .map(|_| TcpStream::connect(server.address()).expect("connect"))
        .collect();
    while page(server.address()).is_none() {
        thread::sleep(Duration::from_millis(50));
    }
    drop(idle);
}
