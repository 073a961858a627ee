//! `cargo xtask bytes [core] [--program PATH] [--before PATH] [--out DIR]`: the SHA-256 of every result that
//! a refactoring must not change.
//!
//! A fixed set of runs: flights, batches, oracles, recordings and campaigns under every policy; with `core`
//! the smaller set that a change of the decision core must not change: campaigns, scenarios and recordings
//! under the default policy. Prints the hashes, or with `--before`, the program of another build, the files
//! whose hashes differ, and fails if there are any. Nothing in it depends on the clock. Without the
//! third-party data (`FGA_DATA`, or beside the repository) it leaves out the runs on that data, and the list
//! says so. Parquet files name the commit of the program: build both with one value in the
//! variable `FGA_COMMIT`, as in 0000000.

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

/// Recordings among the data.
const RECORDINGS: [&str; 2] = ["daidalus/H1.daa", "flown/NRC_Intercept1.daa"];

/// Campaigns of the set for the core, and the number of encounters of each.
const CORE_CAMPAIGNS: [(&str, &str); 3] = [
    ("campaigns/table4-static.toml", "400"),
    ("campaigns/table4-dynamic.toml", "600"),
    ("crowded.toml", "400"),
];

/// Vehicles of those campaigns.
const CORE_VEHICLES: [&str; 4] = ["paper", "paper-planar", "rascal-110", "apprentice-15e"];

/// Vehicles about which the set for the core flies aircraft that turn and climb.
const AMONG_AIRCRAFT: [&str; 2] = ["long-endurance", "general-aviation-well-clear"];

/// The encounter model of those aircraft, and the recordings with them, among the data.
const MODEL: &str = "encounter-models/uncor_1200only_fwse_v1p2.txt";
const FLOWN: [&str; 4] = [
    "flown/NRC_Intercept1.daa",
    "flown/NRC_Intercept25.daa",
    "flown/NRC_Intercept51.daa",
    "flown/NRC_Intercept77.daa",
];

/// A campaign with more obstacles than the shipped ones, some of them seen with noise.
const CROWDED: &str = "name = \"crowded\"
policies = [\"turn-aware\"]
horizon_s = 60
encounters = 48
[[sensor]]
position_sigma_m = 2
velocity_sigma_mps = 0.3
equipped_share = 0.5
[[sensor]]
equipped_share = 0.9
[[grid]]
family = \"threats\"
count = [3, 6]
first_seen_m = [300, [100, 500]]
speed_mps = [[0, 20], [45, 60]]
planar = [false, true]
[[grid]]
family = \"from-anywhere\"
count = [4]
first_seen_m = [[100, 500]]
speed_mps = [[15, 45]]
bystanders = true
";

/// Number of encounters of the batches.
const ENCOUNTERS: u32 = 120;

/// Makes the runs and prints the hashes of their files, or the files whose hashes differ from another
/// program's.
pub(crate) fn print(arguments: &[&str]) -> Result<(), String> {
    let options = Options::read(arguments)?;
    let program = match options.program {
        Some(path) => path,
        None => build()?,
    };
    let kept = options.out.is_some();
    let out = options
        .out
        .unwrap_or_else(|| std::env::temp_dir().join(format!("fga-bytes-{}", std::process::id())));
    fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let done = (|| {
        let runs = if options.core {
            core_runs(&out)?
        } else {
            runs(&out)?
        };
        let after = fly_all(&program, &runs, &out.join("after"))?;
        match options.before {
            None => {
                for line in after {
                    println!("{line}");
                }
                Ok(())
            }
            Some(before) => compare(&fly_all(&before, &runs, &out.join("before"))?, &after),
        }
    })();
    if !kept {
        let _ = fs::remove_dir_all(&out);
    }
    done
}

/// Prints the lines of two lists that differ; fails if there are any.
fn compare(before: &[String], after: &[String]) -> Result<(), String> {
    let mut differ = 0;
    for (sign, lines, others) in [('-', before, after), ('+', after, before)] {
        for line in lines.iter().filter(|line| !others.contains(line)) {
            println!("{sign} {line}");
            differ += 1;
        }
    }
    if differ > 0 {
        return Err(format!("bytes: {differ} lines differ, expected none"));
    }
    println!("{} files, the same bytes", after.len());
    Ok(())
}

/// A run of the program: its arguments without `--out`, and the folder of its results.
struct ProgramRun {
    arguments: Vec<String>,
    name: String,
}

impl ProgramRun {
    fn new(name: String, arguments: &[&str]) -> Self {
        let arguments = arguments.iter().map(|&text| text.to_owned()).collect();
        Self { arguments, name }
    }
}

/// What the command line asks for.
#[derive(Default)]
struct Options {
    core: bool,
    program: Option<PathBuf>,
    before: Option<PathBuf>,
    out: Option<PathBuf>,
}

impl Options {
    fn read(mut arguments: &[&str]) -> Result<Self, String> {
        let mut options = Self::default();
        if let ["core", rest @ ..] = arguments {
            (options.core, arguments) = (true, rest);
        }
        for pair in arguments.chunks(2) {
            let (option, path) = match *pair {
                ["--program", path] => (&mut options.program, path),
                ["--before", path] => (&mut options.before, path),
                ["--out", path] => (&mut options.out, path),
                _ => {
                    return Err(format!(
                        "bytes: found {}, expected --program PATH, --before PATH or --out DIR",
                        pair.join(" ")
                    ));
                }
            };
            *option = Some(PathBuf::from(path));
        }
        Ok(options)
    }
}

/// The path of a file among the third-party data.
fn data(file: &str) -> String {
    let folder = std::env::var("FGA_DATA").unwrap_or_else(|_| "../shared/data".to_owned());
    format!("{folder}/{file}")
}

/// Whether a file of the data is there; says so if not.
fn is_there(file: &str) -> bool {
    let there = Path::new(file).exists();
    if !there {
        println!("{:64}  {file}: not there, left out", "");
    }
    there
}

/// The runs that a change of the decision core must not change.
fn core_runs(out: &Path) -> Result<Vec<ProgramRun>, String> {
    let crowded = out.join("crowded.toml");
    fs::write(&crowded, CROWDED).map_err(|error| format!("{}: {error}", crowded.display()))?;
    let mut runs = Vec::new();
    let mut campaign = |file: &str, encounters: &str, vehicle: &str, more: &[&str]| {
        let stem = Path::new(file).file_stem().unwrap_or_default().display();
        let name = format!("campaign/{stem}/{vehicle}");
        let vehicle = format!("vehicles/{vehicle}.toml");
        let run = ["campaign", "run", file, "--encounters", encounters, "--csv"];
        let rest = ["--policy", "turn-aware", "--vehicle", &vehicle];
        runs.push(ProgramRun::new(name, &[&run[..], &rest, more].concat()));
    };
    for vehicle in CORE_VEHICLES {
        for (file, encounters) in CORE_CAMPAIGNS {
            let drawn = crowded.display().to_string();
            let file = if file == "crowded.toml" { &drawn } else { file };
            campaign(file, encounters, vehicle, &[]);
        }
    }
    let model = data(MODEL);
    if is_there(&model) {
        for vehicle in AMONG_AIRCRAFT {
            let more = ["--model", &model];
            campaign("campaigns/low-altitude.toml", "160", vehicle, &more);
        }
    }
    let mut scenarios: Vec<PathBuf> = fs::read_dir("scenarios")
        .map_err(|error| format!("scenarios: {error}"))?
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    scenarios.sort();
    for scenario in scenarios {
        let stem = scenario.file_stem().unwrap_or_default().display();
        let file = scenario.display().to_string();
        runs.push(ProgramRun::new(format!("run/{stem}"), &["run", &file]));
    }
    for recording in FLOWN.map(data) {
        if is_there(&recording) {
            let stem = Path::new(&recording).file_stem().unwrap_or_default();
            let vehicle = "vehicles/general-aviation-well-clear.toml";
            let name = format!("recording/{}", stem.display());
            runs.push(ProgramRun::new(
                name,
                &["run", &recording, "--vehicle", vehicle],
            ));
        }
    }
    Ok(runs)
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
fn runs(out: &Path) -> Result<Vec<ProgramRun>, String> {
    let encounters = out.join("encounters.csv");
    fs::write(&encounters, encounter_file())
        .map_err(|error| format!("{}: {error}", encounters.display()))?;
    let encounters = encounters.display().to_string();
    let mut runs = Vec::new();
    let mut add = |name: String, arguments: &[&str]| runs.push(ProgramRun::new(name, arguments));
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
    for recording in RECORDINGS.map(data) {
        if is_there(&recording) {
            let stem = Path::new(&recording).file_stem().unwrap_or_default();
            let vehicle = "vehicles/general-aviation.toml";
            let name = format!("recording/{}", stem.display());
            add(name, &["run", &recording, "--vehicle", vehicle]);
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

/// Flies every run; a line with hash and name for each of its files.
fn fly_all(program: &Path, runs: &[ProgramRun], out: &Path) -> Result<Vec<String>, String> {
    let mut lines = Vec::new();
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
            lines.push(format!("{:64}  {}: {}", "", run.name, message.trim()));
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
            lines.push(format!("{hash}  {}", shown.display()));
        }
    }
    Ok(lines)
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
