//! Counts the instructions of a step with valgrind and compares them with a committed table.
//!
//! Counts do not depend on the load of a machine: a change shows when it costs some hundredths more.

use alloc::collections::BTreeMap;
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::command::cargo;
use crate::table::NumberTable;

const TABLE: NumberTable = NumberTable {
    path: "docs/benchmarks/instructions.csv",
    header: "aircraft,obstacles,kind,instructions",
    chore: "instructions",
};

/// Repetitions of each step; a run without any is subtracted.
const TIMES: u32 = 5;

/// The counted aircraft, numbers of obstacles and kinds of steps.
const COUNTED: [(&str, u32, &str); 7] = [
    ("ideal", 3, "quiet"),
    ("ideal", 1, "choosing"),
    ("ideal", 3, "choosing"),
    ("lagged", 1, "choosing"),
    ("lagged", 3, "choosing"),
    ("noisy", 1, "choosing"),
    ("flown", 1, "choosing"),
];

/// Counts, and compares with the table, or writes it with `--write`.
pub(crate) fn check(options: &[&str]) -> Result<(), String> {
    let write = match options {
        [] => false,
        ["--write"] => true,
        _ => return Err("expected cargo xtask instructions, with or without --write".to_owned()),
    };
    if Command::new("valgrind").arg("--version").output().is_err() {
        let sentence = "valgrind is not installed (Debian: valgrind); instructions are not counted";
        if env::var_os("CI").is_some() {
            return Err(sentence.to_owned());
        }
        println!("{sentence}");
        return Ok(());
    }
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let program = build(&root)?;
    let mut counts = BTreeMap::new();
    for (aircraft, obstacles, kind) in COUNTED {
        let (counted, work) = step(&program, aircraft, obstacles, kind)?;
        println!(
            "{aircraft}, {obstacles} obstacles, {kind}: {counted} instructions a step, {work} units of work"
        );
        counts.insert(format!("{aircraft},{obstacles},{kind}"), counted);
    }
    TABLE.check(&root, &counts, write)
}

/// Builds the program that makes the steps.
fn build(root: &Path) -> Result<PathBuf, String> {
    let manifest = root.join("tests/instructions/Cargo.toml");
    let target = root.join("target/instructions");
    let status = cargo()
        .args(["build", "--release", "--quiet", "--manifest-path"])
        .arg(manifest)
        .arg("--target-dir")
        .arg(&target)
        // One set of instructions on every machine.
        .env("RUSTFLAGS", "-C target-cpu=x86-64")
        .status()
        .map_err(|error| format!("cargo: {error}"))?;
    if !status.success() {
        return Err("tests/instructions does not build".to_owned());
    }
    Ok(target.join("release/fga-instructions"))
}

/// Instructions and work of one step of a kind.
fn step(program: &Path, aircraft: &str, obstacles: u32, kind: &str) -> Result<(u64, u64), String> {
    let (with, [steps, work]) = run(program, aircraft, obstacles, kind, TIMES)?;
    let (without, _) = run(program, aircraft, obstacles, kind, 0)?;
    if steps == 0 {
        return Err(format!("no step is {kind} with {aircraft} and {obstacles}"));
    }
    let counted = with.saturating_sub(without) / (steps * u64::from(TIMES));
    Ok((counted, work / steps))
}

/// Instructions of the program, the number of steps that it repeats, and their work.
fn run(
    program: &Path,
    aircraft: &str,
    obstacles: u32,
    kind: &str,
    times: u32,
) -> Result<(u64, [u64; 2]), String> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args([aircraft, &obstacles.to_string(), kind, &times.to_string()])
        .output()
        .map_err(|error| format!("valgrind: {error}"))?;
    let told = String::from_utf8_lossy(&output.stderr);
    let counted = told
        .lines()
        .find_map(|line| line.split_once("Collected :")?.1.trim().parse().ok());
    let printed = String::from_utf8_lossy(&output.stdout);
    let numbers = printed.split_whitespace().map(str::parse);
    let steps: Option<Vec<u64>> = numbers.collect::<Result<_, _>>().ok();
    let steps = steps.and_then(|numbers| numbers.try_into().ok());
    counted
        .zip(steps)
        .ok_or_else(|| format!("valgrind counted nothing: {told}"))
}
