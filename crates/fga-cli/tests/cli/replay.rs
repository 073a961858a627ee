//! The replay page of a flight, `fga view` and `fga run --live`.
#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::support::{errors, fga_in};

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

/// Names of the runs of a page, and the number of samples of each.
fn runs(page: &str) -> Vec<(String, usize)> {
    let data = data(page);
    let runs = data["runs"].as_array().unwrap().iter();
    runs.map(|run| {
        let name = run["name"].as_str().unwrap().to_owned();
        (name, run["samples"]["t"].as_str().unwrap().len())
    })
    .collect()
}

#[test]
fn policies_are_laid_over_the_page_of_a_run() {
    let folder = tempfile::tempdir().unwrap();
    scenario(folder.path());
    let overlay = "published --start t0, none";
    let arguments = ["run", "mast.toml", "--overlay", overlay, "--out", "out"];
    let output = fga_in(folder.path(), &arguments);
    assert!(
        output.status.success(),
        "the flown policy says what came of it"
    );
    let page = fs::read_to_string(folder.path().join("out/replay.html")).unwrap();
    let runs = runs(&page);
    let names: Vec<&str> = runs.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["turn-aware", "published --start t0", "none"]);
    assert!(runs.iter().all(|(_, bytes)| *bytes > 100));
    let unled = &data(&page)["runs"][2];
    assert!(
        unled["decisions"][0]["lines"][0]
            .as_str()
            .unwrap()
            .starts_with("No policy")
    );
    assert!(
        unled["events"][0]["text"]
            .as_str()
            .unwrap()
            .starts_with("no policy")
    );
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        told.contains("laid over the replay page: none, least margin -2"),
        "{told}"
    );
    // Nothing else of the run changes.
    let alone = fga_in(folder.path(), &["run", "mast.toml", "--out", "alone"]);
    assert!(alone.status.success());
    for file in ["track.csv", "events.jsonl", "overview.svg", "flight.json"] {
        let read = |out: &str| fs::read(folder.path().join(out).join(file)).unwrap();
        assert!(read("out") == read("alone"), "{file}");
    }
    for (overlay, complaint) in [
        ("turn-aware", "--overlay turn-aware: is flown already"),
        ("none,none", "--overlay none: is flown already"),
        ("nobody", "unknown policy"),
    ] {
        let output = fga_in(folder.path(), &["run", "mast.toml", "--overlay", overlay]);
        assert_eq!(output.status.code(), Some(1));
        assert!(errors(&output).contains(complaint), "{}", errors(&output));
        assert_eq!(errors(&output).lines().count(), 1);
    }
}

/// Encounters of one obstacle each that comes head-on, `aside_m` off the line.
fn head_on(aside_m: &[f64]) -> String {
    let rows = (10..).zip(aside_m);
    let rows = rows.map(|(number, aside_m)| format!("{number},1,600,{aside_m},0,-10,0,0,30"));
    let columns = "encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m";
    let lines: Vec<String> = core::iter::once(columns.to_owned()).chain(rows).collect();
    lines.join("\n") + "\n"
}

fn pages(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_batch_shows_its_worst_encounters() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("e.csv"), head_on(&[25.0, 60.0, 5.0, 29.0, 200.0])).unwrap();
    let batch = |more: &[&str]| {
        let arguments = ["batch", "e.csv", "--policy", "none", "--out", "runs/b"];
        let output = fga_in(at, &[&arguments, more].concat());
        assert!(output.status.success(), "{}", errors(&output));
    };
    batch(&["--tracks", "--replay", "2"]);
    // The aircraft enters by 25 m in encounter 12, by 5 m in encounter 10.
    assert_eq!(pages(&at.join("runs/b/replay")), ["10.html", "12.html"]);
    let page = fs::read_to_string(at.join("runs/b/replay/12.html")).unwrap();
    assert_eq!(data(&page)["title"], "encounter 12");
    let margin_m = data(&page)["runs"][0]["outcome"]["margin"]
        .as_f64()
        .unwrap();
    let results = fs::read_to_string(at.join("runs/b/results.csv")).unwrap();
    let row = results
        .lines()
        .find(|line| line.starts_with("12,"))
        .unwrap();
    let written: f64 = row.split(',').nth(3).unwrap().parse().unwrap();
    assert!((margin_m - written).abs() < 1e-6 && (margin_m + 25.0).abs() < 1e-6);
    let before = fs::read(at.join("runs/b/replay/12.html")).unwrap();
    // Pages of removed results do not stay.
    batch(&["--replay", "1", "--threads", "1"]);
    assert_eq!(pages(&at.join("runs/b/replay")), ["12.html"]);
    assert!(fs::read(at.join("runs/b/replay/12.html")).unwrap() == before);
    let server = serve(at, "runs");
    let table = get(&server.address, "/");
    assert!(table.contains("/replay/b/replay/12.html"), "{table}");
    let page = get(&server.address, "/replay/b/replay/12.html");
    assert!(page.contains("\"title\":\"encounter 12\""));
    drop(server);
    batch(&["--replay", "9"]);
    assert_eq!(pages(&at.join("runs/b/replay")).len(), 5);
    batch(&[]);
    assert!(pages(&at.join("runs/b/replay")).is_empty());
}

/// `fga view` on a free port.
struct Viewed {
    process: Child,
    address: String,
}

fn serve(folder: &Path, path: &str) -> Viewed {
    let mut process = Command::new(env!("CARGO_BIN_EXE_fga"))
        .current_dir(folder)
        .args(["view", path, "--listen", "127.0.0.1:0"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut address = String::new();
    let stdout = process.stdout.take().unwrap();
    BufReader::new(stdout).read_line(&mut address).unwrap();
    Viewed {
        process,
        address: address.trim().to_owned(),
    }
}

impl Drop for Viewed {
    fn drop(&mut self) {
        self.process.kill().unwrap();
        self.process.wait().unwrap();
    }
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
    let server = serve(folder.path(), "runs");
    let table = get(&server.address, "/");
    assert!(table.contains("/replay/none/replay.html"), "{table}");
    assert!(table.contains("\"separated\":false"));
    let page = get(&server.address, "/replay/turn-aware/replay.html");
    assert!(page.contains("id=\"data\""));
    assert!(get(&server.address, "/replay/../mast.toml").starts_with("HTTP/1.1 404"));
    drop(server);
}

/// A campaign flown into `runs/<name>`.
fn campaign(folder: &Path, name: &str, encounters: u32, policies: &str) {
    let text = format!(
        "name = \"{name}\"\nencounters = {encounters}\nseeds = [3]\npolicies = {policies}\n\
         horizon_s = 20\n[[grid]]\nfamily = \"threats\"\ncount = [1, 2]\n\
         first_seen_m = [300]\nspeed_mps = [[15, 30]]\n"
    );
    let file = format!("{name}.toml");
    fs::write(folder.join(&file), text).unwrap();
    let out = format!("runs/{name}");
    let output = fga_in(folder, &["campaign", "run", &file, "--out", &out]);
    assert!(output.status.success(), "{}", errors(&output));
}

#[test]
fn a_campaign_is_listed_and_its_encounters_are_flown_again() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    campaign(at, "two", 40, r#"["published --start t0", "none"]"#);
    let server = serve(at, "runs/two");
    let listing = data(&get(&server.address, "/"));
    assert_eq!(listing["title"], "Campaign two");
    let note = listing["note"].as_str().unwrap();
    assert!(
        note.starts_with("40 of 40 encounters flown, each by 2 policies."),
        "{note}"
    );
    let rows = listing["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 80);
    assert!(rows[0]["source"].as_str().unwrap().contains("threats"));
    let lost = rows
        .iter()
        .find(|row| row["policy"] == "none" && row["separated"] == false)
        .unwrap();
    let link = lost["link"].as_str().unwrap();
    let number = lost["name"].as_str().unwrap();
    let page = get(&server.address, link);
    let seen = runs(&page);
    assert_eq!(
        (seen[0].0.as_str(), seen[1].0.as_str()),
        ("none", "published --start t0")
    );
    let margin = |page: &str| data(page)["runs"][0]["outcome"]["margin"].as_f64().unwrap();
    assert!((margin(&page) - lost["min_margin_m"].as_f64().unwrap()).abs() < 2e-6);
    // The same page as on the command line.
    let show = [
        "campaign",
        "show",
        "runs/two",
        "--encounter",
        number,
        "--policy",
        "none",
    ];
    let more = ["--overlay", "published --start t0", "--out", "shown"];
    let output = fga_in(at, &[&show[..], &more].concat());
    assert!(output.status.success(), "{}", errors(&output));
    let shown = fs::read_to_string(at.join("shown/replay.html")).unwrap();
    assert_eq!(data(&shown), data(&page));
    for key in ["40/0", "0/2", "0", "0/0/0", "-1/0", "campaign.json"] {
        let answer = get(&server.address, &format!("/replay/{key}"));
        assert!(answer.starts_with("HTTP/1.1 404"), "{key}: {answer}");
    }
    drop(server);
}

#[test]
fn of_a_large_campaign_the_worst_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    campaign(at, "large", 5_100, r#"["none"]"#);
    let server = serve(at, "runs/large");
    let listing = data(&get(&server.address, "/"));
    drop(server);
    let note = listing["note"].as_str().unwrap();
    let told = "Of 5100 flights the 5000 with the least margin are listed, 5000 of each policy; those \
                lost although avoidable come first.";
    assert_eq!(
        listing["shares"][0]["runs"], 5_100,
        "all flights, listed or not"
    );
    assert!(note.contains(told), "{note}");
    let rows = listing["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 5_000);
    let margins = |index: usize| rows[index]["min_margin_m"].as_f64().unwrap();
    assert!((1..rows.len()).all(|index| margins(index - 1) <= margins(index)));
    // Incomplete: the table lists the finished part.
    fs::remove_file(at.join("runs/large/results.parquet")).unwrap();
    let server = serve(at, "runs/large");
    let listing = data(&get(&server.address, "/"));
    drop(server);
    assert!(
        listing["note"]
            .as_str()
            .unwrap()
            .starts_with("0 of 5100 encounters flown")
    );
    // Damaged: one sentence.
    fs::write(at.join("runs/large/results.parquet"), "no table").unwrap();
    let output = fga_in(at, &["view", "runs/large", "--listen", "127.0.0.1:0"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        errors(&output).contains("results.parquet: cannot be used"),
        "{}",
        errors(&output)
    );
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
