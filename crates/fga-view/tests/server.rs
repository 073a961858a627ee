//! The server over real sockets.

use core::net::{Ipv4Addr, SocketAddr};
use core::time::Duration;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::time::Instant;
use std::{fs, thread};

use fga_report::replay::{LiveMessage, ReplayRun, ReplaySample};
use fga_view::{ServedFolder, Server};

const ANY_PORT: SocketAddr = SocketAddr::new(core::net::IpAddr::V4(Ipv4Addr::LOCALHOST), 0);

/// The whole answer to a raw request for a path.
fn ask(address: SocketAddr, path: &str, host: &str) -> String {
    let mut stream = TcpStream::connect(address).expect("connect");
    write!(
        stream,
        "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"
    )
    .expect("send");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("answer");
    answer
}

fn runs() -> tempfile::TempDir {
    let home = tempfile::tempdir().expect("folder");
    for (name, margin_m) in [("good", "3.5"), ("lost one", "-2.0")] {
        let folder = home.path().join(name);
        fs::create_dir(&folder).expect("create");
        let separated = !margin_m.starts_with('-');
        let document = format!(
            "{{\"name\":\"{name}\",\"policy\":\"p\",\"separated\":{separated},\
             \"min_margin_m\":{margin_m}}}"
        );
        fs::write(folder.join("run.json"), document).expect("write");
        fs::write(folder.join("replay.html"), format!("page of {name}")).expect("write");
    }
    home
}

#[test]
fn the_table_leads_to_the_replays_and_nowhere_else() {
    let home = runs();
    let server = Server::catalogue(ANY_PORT, ServedFolder::open(home.path()).expect("open"))
        .expect("server");
    let address = server.address();
    assert!(address.ip().is_loopback());
    let table = ask(address, "/", "localhost");
    assert!(table.starts_with("HTTP/1.1 200"), "{table}");
    assert!(table.contains("/replay/lost%20one/replay.html"));
    let page = ask(address, "/replay/lost%20one/replay.html", "localhost");
    assert!(page.ends_with("page of lost one"), "{page}");
    assert!(page.contains("content-security-policy: sandbox allow-scripts"));
    for path in [
        "/replay/../run.json",
        "/replay/%2e%2e/%2e%2e/etc/passwd",
        "/replay/good/run.json",
        "/replay/%2Fetc%2Fpasswd",
        "/etc/passwd",
    ] {
        let answer = ask(address, path, "localhost");
        assert!(answer.starts_with("HTTP/1.1 404"), "{path}: {answer}");
    }
    let foreign = ask(address, "/", "evil.example");
    assert!(foreign.starts_with("HTTP/1.1 403"), "{foreign}");
}

#[test]
fn a_single_run_opens_at_once() {
    let home = runs();
    let folder = ServedFolder::open(&home.path().join("good")).expect("open");
    let server = Server::catalogue(ANY_PORT, folder).expect("server");
    let answer = ask(server.address(), "/", "127.0.0.1");
    assert!(answer.contains("location: /replay/replay.html"), "{answer}");
}

fn sample(step: u32) -> LiveMessage {
    LiveMessage::Sample {
        run: 0,
        sample: ReplaySample {
            t_s: f64::from(step),
            ..ReplaySample::default()
        },
    }
}

#[test]
fn a_browser_that_comes_late_gets_the_whole_run() {
    let (server, live) = Server::live(ANY_PORT, "flight").expect("server");
    let page = ask(server.address(), "/", "localhost");
    assert!(page.contains("\"live\":\"/live\""));
    live.send(&LiveMessage::Run(Box::new(ReplayRun::named("r"))));
    live.send(&sample(1));
    let stream = TcpStream::connect(server.address()).expect("connect");
    let url = format!("ws://{}/live", server.address());
    let (mut socket, _) = tungstenite::client(url, stream).expect("handshake");
    let mut read = || socket.read().expect("message").to_string();
    assert!(read().contains("\"type\":\"run\""));
    assert!(read().contains("[1.0,"));
    live.send(&LiveMessage::End {
        run: 0,
        outcome: None,
    });
    assert!(read().contains("\"type\":\"end\""));
}

#[test]
fn a_page_of_another_site_gets_no_socket() {
    let (server, _live) = Server::live(ANY_PORT, "flight").expect("server");
    let mut stream = TcpStream::connect(server.address()).expect("connect");
    write!(
        stream,
        "GET /live HTTP/1.1\r\nHost: localhost\r\nOrigin: http://evil.example\r\n\
         Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    )
    .expect("send");
    let mut start = [0; 12];
    stream.read_exact(&mut start).expect("answer");
    assert_eq!(&start, b"HTTP/1.1 403");
}

#[test]
fn a_browser_that_does_not_read_holds_nobody_up() {
    let (server, live) = Server::live(ANY_PORT, "flight").expect("server");
    let stream = TcpStream::connect(server.address()).expect("connect");
    let url = format!("ws://{}/live", server.address());
    // It listens and never reads.
    let (idle, _) = tungstenite::client(url, stream).expect("handshake");
    while live.listeners() == 0 {
        thread::sleep(Duration::from_millis(5));
    }
    live.send(&LiveMessage::Run(Box::new(ReplayRun::named("r"))));
    // Far more than the channel and the socket's buffers hold: a sender that waits would never
    // return.
    for step in 0..200_000 {
        live.send(&sample(step));
    }
    drop(idle);
    // The server forgets a vanished browser.
    let since = Instant::now();
    while live.listeners() > 0 && since.elapsed() < Duration::from_mins(1) {
        live.send(&sample(200_000));
        thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(live.listeners(), 0);
}
