//! `cargo xtask bytes [--program PATH] [--out DIR]`: the SHA-256 of every result that a refactoring must
//! not change.
//!
//! A fixed set of runs: flights, batches, oracles, recordings and campaigns under every policy. Save its
//! output before a change and after it, and compare with `diff`. Nothing in it depends on the clock.
//! Without the data beside the repository it leaves out the runs on that data, and the list says so.

use core::f64::consts::PI;
use core::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use sha2::{Digest as _, Sha256};

/// Every policy and its start on the command line.
const POLICIES: [(&str, Option<&str>); 15] = [
    ("turn-aware", None),
    ("turn-aware", Some("t0")),
    ("turn-aware", Some("latest")),
    ("turn-aware", Some("Cs=0.5")),
    ("published", None),
    ("published", Some("t0")),
    ("published-literal", None),
    ("circle", None),
    ("none", None),
    ("potential-field", None),
    ("waypoint-greedy", None),
    ("waypoint-optimal", None),
    ("orca", None),
    ("mvp", None),
    ("velocity-obstacles", None),
];

/// Scenarios for every policy.
const SCENARIOS: [&str; 2] = ["first-flight", "fig-10"];

/// Scenarios for the default policy.
const OTHER_SCENARIOS: [&str; 3] = ["fig-05", "fig-17", "sfo"];

/// Vehicles of the batches.
const VEHICLES: [&str; 3] = ["paper", "paper-planar", "rascal-110"];

/// Shipped campaigns and the number of encounters of each.
const CAMPAIGNS: [(&str, &str); 2] = [("table4-static", "400"), ("table4-dynamic", "400")];

/// Files whose bytes must not change.
const KEPT: [&str; 7] = [
    "results.csv",
    "oracle.csv",
    "tracks.csv",
    "track.csv",
    "events.jsonl",
    "alerts.csv",
    "summary.csv",
];

/// Recordings beside the repository.
const RECORDINGS: [&str; 2] = [
    "../shared/data/daidalus/H1.daa",
    "../shared/data/flown/NRC_Intercept1.daa",
];

/// Number of encounters of the batches.
const ENCOUNTERS: u32 = 120;

/// Makes the runs and prints a line for each file: its hash and its name.
pub(crate) fn print(arguments: &[&str]) -> Result<(), String> {
    let (program, out) = options(arguments)?;
    let program = match program {
        Some(path) => path,
        None => build()?,
    };
    let kept = out.is_some();
    let out = out
        .unwrap_or_else(|| std::env::temp_dir().join(format!("fga-bytes-{}", std::process::id())));
    fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let done = runs(&out).and_then(|runs| fly_all(&program, &runs, &out));
    if !kept {
        let _ = fs::remove_dir_all(&out);
    }
    done
}

/// A run of the program: its arguments without `--out`, and the folder of its results.
struct Run {
    arguments: Vec<String>,
    name: String,
}

/// The program and the folder of the results; both are optional.
fn options(arguments: &[&str]) -> Result<(Option<PathBuf>, Option<PathBuf>), String> {
    let (mut program, mut out) = (None, None);
    for pair in arguments.chunks(2) {
        match *pair {
            ["--program", path] => program = Some(PathBuf::from(path)),
            ["--out", path] => out = Some(PathBuf::from(path)),
            _ => {
                return Err(format!(
                    "bytes: found {}, expected --program PATH or --out DIR",
                    pair.join(" ")
                ));
            }
        }
    }
    Ok((program, out))
}

/// Builds the program as in the README.
fn build() -> Result<PathBuf, String> {
    let built = Command::new("cargo")
        .args(["build", "--release", "--package", "fga-cli"])
        .status()
        .map_err(|error| format!("cargo: {error}"))?;
    if built.success() {
        Ok(PathBuf::from("target/release/fga"))
    } else {
        Err("cargo build --release --package fga-cli failed".to_owned())
    }
}

/// All runs, after writing their encounter file into `out`.
fn runs(out: &Path) -> Result<Vec<Run>, String> {
    let encounters = out.join("encounters.csv");
    fs::write(&encounters, encounter_file())
        .map_err(|error| format!("{}: {error}", encounters.display()))?;
    let encounters = encounters.display().to_string();
    let mut runs = Vec::new();
    let mut add = |name: String, arguments: &[&str]| {
        let arguments = arguments
            .iter()
            .map(|&argument| argument.to_owned())
            .collect();
        runs.push(Run { arguments, name });
    };
    for (policy, start) in POLICIES {
        let mut chosen = vec!["--policy", policy];
        chosen.extend(start.iter().flat_map(|start| ["--start", *start]));
        let named = format!(
            "{policy}{}",
            start.map_or_else(String::new, |start| format!("-{start}"))
        );
        for scenario in SCENARIOS {
            let file = format!("scenarios/{scenario}.toml");
            add(
                format!("run/{scenario}/{named}"),
                &[&["run", &file], &chosen[..]].concat(),
            );
        }
        for vehicle in VEHICLES {
            let file = format!("vehicles/{vehicle}.toml");
            let batch = ["batch", &encounters, "--vehicle", &file, "--tracks"];
            add(
                format!("batch/{vehicle}/{named}"),
                &[&batch, &chosen[..]].concat(),
            );
        }
    }
    for scenario in OTHER_SCENARIOS {
        add(
            format!("run/{scenario}/turn-aware"),
            &["run", &format!("scenarios/{scenario}.toml")],
        );
    }
    for vehicle in VEHICLES {
        let file = format!("vehicles/{vehicle}.toml");
        add(
            format!("oracle/{vehicle}"),
            &["oracle", &encounters, "--vehicle", &file],
        );
    }
    for (campaign, count) in CAMPAIGNS {
        let file = format!("campaigns/{campaign}.toml");
        let run = [
            "campaign",
            "run",
            &file,
            "--encounters",
            count,
            "--csv",
            "--oracle",
        ];
        let policies = [
            "--policy",
            "turn-aware",
            "--policy",
            "published",
            "--policy",
            "circle",
        ];
        add(
            format!("campaign/{campaign}"),
            &[&run[..], &policies].concat(),
        );
    }
    for recording in RECORDINGS {
        if Path::new(recording).exists() {
            let name = Path::new(recording)
                .file_stem()
                .unwrap_or_default()
                .display()
                .to_string();
            add(
                format!("recording/{name}"),
                &[
                    "run",
                    recording,
                    "--vehicle",
                    "vehicles/general-aviation.toml",
                ],
            );
        } else {
            println!("{:64}  {recording}: not there, left out", "");
        }
    }
    Ok(runs)
}

/// Encounters of one to three obstacles near the line along +x, at rest or moving, from the numbers of
/// a linear congruential generator.
fn encounter_file() -> String {
    let mut state = 1_u64;
    let mut between = |low: f64, high: f64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let share = f64::from(u32::try_from(state >> 33).unwrap_or(0)) / f64::from(1_u32 << 31);
        low + share * (high - low)
    };
    let mut text = "encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m\n".to_owned();
    for encounter in 0..ENCOUNTERS {
        for obstacle in 0..=encounter % 3 {
            let speed_mps = if encounter % 4 == 0 {
                0.0
            } else {
                between(2.0, 25.0)
            };
            let course_rad = between(-PI, PI);
            let climb_mps = if encounter % 2 == 0 {
                0.0
            } else {
                between(-2.0, 2.0)
            };
            let (met_s, aside_m, above_m) = (
                between(6.0, 18.0),
                between(-20.0, 20.0),
                between(-15.0, 15.0),
            );
            let radius_m = between(15.0, 35.0);
            let (vx, vy) = (
                speed_mps * f64::cos(course_rad),
                speed_mps * f64::sin(course_rad),
            );
            let vz = if speed_mps > 0.0 { climb_mps } else { 0.0 };
            let (x, y, z) = (
                15.0 * met_s - vx * met_s,
                aside_m - vy * met_s,
                above_m - vz * met_s,
            );
            let _ = writeln!(
                text,
                "{encounter},{obstacle},{x:.3},{y:.3},{z:.3},{vx:.3},{vy:.3},{vz:.3},{radius_m:.3}"
            );
        }
    }
    text
}

/// Flies every run and prints the hashes of its files.
fn fly_all(program: &Path, runs: &[Run], out: &Path) -> Result<(), String> {
    for run in runs {
        let folder = out.join(&run.name);
        let _ = fs::remove_dir_all(&folder);
        let flown = Command::new(program)
            .args(&run.arguments)
            .arg("--out")
            .arg(&folder)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .output()
            .map_err(|error| format!("{}: {error}", program.display()))?;
        // 2: the aircraft entered a protected volume, which is a result too.
        if !matches!(flown.status.code(), Some(0 | 2)) {
            let message = String::from_utf8_lossy(&flown.stderr);
            println!("{:64}  {}: {}", "", run.name, message.trim());
            continue;
        }
        let mut files = Vec::new();
        collect(&folder, &mut files)?;
        files.sort();
        for file in files {
            let bytes = fs::read(&file).map_err(|error| format!("{}: {error}", file.display()))?;
            let mut hash = String::with_capacity(64);
            for byte in Sha256::digest(&bytes) {
                let _ = write!(hash, "{byte:02x}");
            }
            let shown = file.strip_prefix(out).unwrap_or(&file);
            println!("{hash}  {}", shown.display());
        }
    }
    Ok(())
}

/// The files below `folder` whose bytes must not change.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), String> {
    let entries = fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    for entry in entries.flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path
            .extension()
            .is_some_and(|extension| extension == "parquet")
            || path
                .file_name()
                .is_some_and(|name| KEPT.iter().any(|kept| name == *kept))
        {
            files.push(path);
        }
    }
    Ok(())
}
