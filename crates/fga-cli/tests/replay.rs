//! The replay page of a flight, `fga view` and `fga run --live`.
#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

mod support;

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Stdio};

use support::{errors, fga_in};

const SCENARIO: &str = r#"
name = "</script><b>mast"
duration_s = 60.0

[mission]
waypoints_m = [[0, 0, 100], [600, 0, 100]]

[[obstacle]]
name = "mast"
position_m = [300, 5, 100]
radius_m = 30.0
"#;

fn scenario(folder: &Path) {
    fs::write(folder.join("mast.toml"), SCENARIO).unwrap();
}

/// The data inside a page.
fn data(page: &str) -> serde_json::Value {
    let (_, rest) = page
        .split_once("<script type=\"application/json\" id=\"data\">")
        .unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// The body of the answer to a request.
fn get(address: &str, path: &str) -> String {
    let host = address
        .trim_start_matches("http://")
        .trim_end_matches('/')
        .to_owned();
    let mut stream = TcpStream::connect(&host).unwrap();
    let request = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

#[test]
fn the_page_of_a_run_says_what_was_decided() {
    let folder = tempfile::tempdir().unwrap();
    scenario(folder.path());
    let output = fga_in(folder.path(), &["run", "mast.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", errors(&output));
    let page = fs::read_to_string(folder.path().join("out/replay.html")).unwrap();
    assert!(!page.contains("<b>mast"), "a name is text");
    let data = data(&page);
    let run = &data["runs"][0];
    assert_eq!(run["obstacles"][0]["name"], "mast");
    let decisions = run["decisions"].as_array().unwrap();
    let avoiding = decisions.iter().find(|d| d["state"] == 2).unwrap();
    let lines = avoiding["lines"].to_string();
    assert!(lines.contains("mast") && lines.contains("urn "), "{lines}");
    let kinds: Vec<u64> = avoiding["paths"]
        .as_array()
        .unwrap()
        .iter()
        .map(|path| path["kind"].as_u64().unwrap())
        .collect();
    assert!(kinds.contains(&2), "the chosen one");
    assert!(kinds.contains(&1), "straight on is rejected");
    let back = decisions.iter().find(|d| d["state"] == 3).unwrap();
    assert_eq!(back["paths"][0]["kind"], 3, "the way back");
}

#[test]
fn a_folder_of_runs_is_served() {
    let folder = tempfile::tempdir().unwrap();
    scenario(folder.path());
    for policy in ["none", "turn-aware"] {
        let out = format!("runs/{policy}");
        fga_in(
            folder.path(),
            &["run", "mast.toml", "--policy", policy, "--out", &out],
        );
    }
    let mut server = Command::new(env!("CARGO_BIN_EXE_fga"))
        .current_dir(folder.path())
        .args(["view", "runs", "--listen", "127.0.0.1:0"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut address = String::new();
    let stdout = server.stdout.take().unwrap();
    BufReader::new(stdout).read_line(&mut address).unwrap();
    let table = get(address.trim(), "/");
    assert!(table.contains("/replay/none/replay.html"), "{table}");
    assert!(table.contains("\"separated\":false"));
    let page = get(address.trim(), "/replay/turn-aware/replay.html");
    assert!(page.contains("id=\"data\""));
    assert!(get(address.trim(), "/replay/../mast.toml").starts_with("HTTP/1.1 404"));
    server.kill().unwrap();
    server.wait().unwrap();
}

#[test]
fn a_live_flight_is_served_while_it_is_flown() {
    let folder = tempfile::tempdir().unwrap();
    scenario(folder.path());
    let mut flight = Command::new(env!("CARGO_BIN_EXE_fga"))
        .current_dir(folder.path())
        .args([
            "run",
            "mast.toml",
            "--live",
            "--speed",
            "20",
            "--out",
            "out",
        ])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let stderr = flight.stderr.take().unwrap();
    BufReader::new(stderr).read_line(&mut line).unwrap();
    let address = line.trim().strip_prefix("live at ").unwrap();
    let page = get(address, "/");
    assert!(page.contains("connect-src 'self'"));
    assert_eq!(data(&page)["live"], "/live");
    assert!(flight.wait().unwrap().success());
    assert!(folder.path().join("out/replay.html").is_file());
}
