//! `fga export`: every format from a real run, and its refusals.
#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use core::time::Duration;
use std::net::UdpSocket;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn fga(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fga"))
        .args(arguments)
        .output()
        .unwrap()
}

/// The first scenario, flown into a folder.
fn flown(folder: &Path) -> String {
    let scenario =
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/first-flight.toml");
    let out = folder.to_str().unwrap().to_owned();
    let output = fga(&["run", scenario.to_str().unwrap(), "--out", &out]);
    assert!(
        output.status.code().is_some_and(|code| code != 1),
        "{output:?}"
    );
    out
}

#[test]
fn a_run_is_written_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let run = flown(folder.path());
    for (format, begins) in [
        ("kml", "<?xml version=\"1.0\" encoding=\"UTF-8\"?>"),
        ("czml", "[{"),
        ("geojson", "{"),
        ("mcap", "\u{fffd}MCAP0\r\n"),
        ("gif", "GIF89a"),
    ] {
        let output = fga(&["export", &run, "--format", format]);
        assert!(output.status.success(), "{output:?}");
        let path = folder.path().join(format!("flight.{format}"));
        assert_eq!(
            String::from_utf8(output.stdout).unwrap().trim(),
            path.to_str().unwrap()
        );
        let bytes = std::fs::read(&path).unwrap();
        assert!(bytes.len() > 10_000);
        assert!(
            String::from_utf8_lossy(&bytes[..64]).starts_with(begins),
            "{format}"
        );
        // The same bytes again, at another path.
        let other = folder.path().join("other");
        let output = fga(&[
            "export",
            &run,
            "--format",
            format,
            "--out",
            other.to_str().unwrap(),
        ]);
        assert!(output.status.success(), "{output:?}");
        assert_eq!(std::fs::read(&other).unwrap(), bytes);
    }
    let geojson: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("flight.geojson")).unwrap())
            .unwrap();
    let kinds: Vec<&str> = geojson["features"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|feature| feature["properties"]["kind"].as_str())
        .collect();
    for kind in ["track", "mission", "obstacle", "volume", "event"] {
        assert!(kinds.contains(&kind), "{kind}");
    }
}

#[test]
fn a_wrong_address_of_flightgear_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let run = flown(folder.path());
    let output = fga(&["export", &run, "--flightgear", "foo"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(!folder.path().join("fga.xml").exists());
}

#[test]
fn a_run_is_played_to_a_flight_simulator() {
    let folder = tempfile::tempdir().unwrap();
    let run = flown(folder.path());
    let listener = UdpSocket::bind("127.0.0.1:0").unwrap();
    listener
        .set_read_timeout(Some(Duration::from_secs(10)))
        .unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let reader = std::thread::spawn(move || {
        let mut datagram = [0; 256];
        let (length, _) = listener.recv_from(&mut datagram).unwrap();
        String::from_utf8_lossy(&datagram[..length]).into_owned()
    });
    let output = fga(&["export", &run, "--flightgear", &address, "--speed", "1000"]);
    assert!(output.status.success(), "{output:?}");
    assert_eq!(reader.join().unwrap().trim_end().split('\t').count(), 7);
    assert!(folder.path().join("fga.xml").exists());
}

#[test]
fn wrong_usage_is_refused_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let empty = folder.path().to_str().unwrap();
    for (arguments, message) in [
        (
            vec!["export", empty, "--format", "kmz"],
            "expected kml, czml, geojson, mcap or gif",
        ),
        (
            vec!["export", empty, "--format", "kml"],
            "there is no such file or folder",
        ),
        (vec!["export", empty], "--format"),
    ] {
        let output = fga(&arguments);
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(error.contains(message), "{error}");
    }
}
