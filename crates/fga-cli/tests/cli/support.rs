//! Common parts of the command tests: running the program, reading its files.
#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(unreachable_pub, reason = "a module shared by several test programs")]

#[path = "../../../fga-sim/tests/sim/data.rs"]
mod data;

use core::fmt::Write as _;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};

pub(crate) use data::data;

/// The folder of the repository.
pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Runs `fga` with these arguments in `folder`.
pub fn fga_in(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fga"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("the program starts")
}

/// Standard error as text.
pub fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Checks every decision of a log against the published schema with an independent validator, and
/// returns their number. Without Python or its `jsonschema` the check skips, except in continuous
/// integration, where that is a failure.
pub fn decisions_follow_their_schema(log: &Path) -> usize {
    const SCRIPT: &str = "
import json, sys
from jsonschema import Draft202012Validator
schema = json.load(open(sys.argv[1]))
Draft202012Validator.check_schema(schema)
check = Draft202012Validator(schema)
for line in map(json.loads, open(sys.argv[2])):
    if 'decision' in (line.get('event'), line.get('kind')):
        check.validate(line)
";
    let text = std::fs::read_to_string(log).expect("a log");
    let is_decision = |line: &&str| {
        let line: serde_json::Value = serde_json::from_str(line).expect("JSON");
        line["event"] == "decision" || line["kind"] == "decision"
    };
    let count = text.lines().filter(is_decision).count();
    let interpreter = std::env::var("FGA_PYTHON").unwrap_or_else(|_| "python3".into());
    let python = |arguments: &[&std::ffi::OsStr]| {
        Command::new(&interpreter)
            .arg("-c")
            .args(arguments)
            .output()
    };
    if !python(&["import jsonschema".as_ref()]).is_ok_and(|output| output.status.success()) {
        let missing = format!("{interpreter} has no module jsonschema (FGA_PYTHON names another)");
        assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
        eprintln!("skipped: {missing}");
        return count;
    }
    let schema = repository().join("docs/schema/decision.schema.json");
    let output = python(&[SCRIPT.as_ref(), schema.as_ref(), log.as_ref()]).expect("Python");
    assert!(output.status.success(), "{}", errors(&output));
    count
}

/// The rows of a CSV file by the names of their columns.
pub fn rows(path: &Path) -> Vec<HashMap<String, String>> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            assert_eq!(fields.len(), names.len(), "{line}");
            names
                .iter()
                .zip(fields)
                .map(|(name, field)| ((*name).to_owned(), field.to_owned()))
                .collect()
        })
        .collect()
}

/// A CSV file of numbers: its columns by name. Fields that are not numbers become NaN.
pub fn columns(path: &Path) -> HashMap<String, Vec<f64>> {
    let text = std::fs::read_to_string(path).expect("the file is there");
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let mut columns: HashMap<String, Vec<f64>> = names
        .iter()
        .map(|name| ((*name).to_string(), Vec::new()))
        .collect();
    for line in lines {
        for (name, field) in names.iter().zip(line.split(',')) {
            let value = match field {
                "true" => 1.0,
                "false" => 0.0,
                other => other.parse().unwrap_or(f64::NAN),
            };
            columns.get_mut(*name).expect("a column").push(value);
        }
    }
    columns
}

/// A generator of encounters for tests: numbers from a linear congruence, obstacles that meet the
/// line along +x at 15 m/s within some tens of metres.
pub fn encounters(count: u32, seed: u64) -> String {
    let mut state = seed
        .wrapping_mul(2_862_933_555_777_941_757)
        .wrapping_add(3_037_000_493);
    let mut unit = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let value = (state >> 11) as f64 / (1_u64 << 53) as f64;
        value
    };
    let mut text = String::from("encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m\n");
    for encounter in 0..count {
        let obstacles = 1 + u32::from(unit() > 0.33) + u32::from(unit() > 0.5);
        for obstacle in 0..obstacles {
            let meeting_s = 6.0 + 20.0 * unit();
            let speed = if unit() < 0.3 { 0.0 } else { 40.0 * unit() };
            let course = (unit() - 0.5) * core::f64::consts::TAU;
            let climb = 2.0 * (unit() - 0.5);
            let velocity = [
                speed * course.cos(),
                speed * course.sin(),
                climb * f64::from(u8::from(speed > 0.0)),
            ];
            let meeting = [
                15.0 * meeting_s,
                80.0 * (unit() - 0.5),
                50.0 * (unit() - 0.5),
            ];
            let at: Vec<String> = meeting
                .iter()
                .zip(velocity)
                .map(|(place, rate)| format!("{:.4}", place - rate * meeting_s))
                .collect();
            let radius_m = 10.0 + 25.0 * unit();
            let _ = writeln!(
                text,
                "{encounter},{obstacle},{},{:.4},{:.4},{:.4},{radius_m:.1}",
                at.join(","),
                velocity[0],
                velocity[1],
                velocity[2]
            );
        }
    }
    text
}

/// Presses Ctrl-C for a running program.
pub(crate) fn interrupt(running: &Child) {
    let process = running.id().to_string();
    let signal = Command::new("kill").args(["-INT", &process]).status();
    assert!(signal.is_ok_and(|status| status.success()));
}
