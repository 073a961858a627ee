//! Mutants of the code that decides about the mode: authority, watchdog and clock of the link.
//!
//! `cargo mutants` changes one thing at a time and runs the tests. A mutant that the tests do not notice
//! must be in `crates/fga-link/src/authority/mutants.txt`, with the reason why no test can.

use alloc::collections::BTreeSet;
use std::fs;
use std::process::Command;

const LIST: &str = "crates/fga-link/src/authority/mutants.txt";
const OUT: &str = "target/mutants";

/// Mutated files and the tests that may notice. Tests and printing code stay unchanged.
struct Run {
    name: &'static str,
    files: &'static [&'static str],
    tests: &'static [&'static str],
}

const RUNS: [Run; 2] = [
    // The unit tests and those in scaled time; tests in real time would take hours.
    Run {
        name: "authority",
        files: &[
            "crates/fga-link/src/authority/*.rs",
            "crates/fga-link/src/clock.rs",
            "crates/fga-link/src/restart.rs",
        ],
        tests: &["--lib", "--test", "safety", "--test", "faults"],
    },
    // The threads around them exist only in real time.
    Run {
        name: "guard",
        files: &["crates/fga-link/src/fly/guard.rs"],
        tests: &["--test", "program"],
    },
];

/// A mutant without its line number, which moves.
fn without_place(line: &str) -> String {
    let mut parts = line.splitn(4, ':');
    let (file, what) = (parts.next().unwrap_or_default(), parts.nth(2));
    what.map_or_else(|| line.trim().to_owned(), |what| format!("{file}:{what}"))
}

/// The mutants of the list, without their reasons.
fn argued(text: &str) -> Result<BTreeSet<String>, String> {
    text.lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .map(|line| match line.split_once(" -- ") {
            Some((mutant, reason)) if !reason.trim().is_empty() => Ok(mutant.trim().to_owned()),
            _ => Err(format!("{LIST}: '{line}' has no reason after ' -- '")),
        })
        .collect()
}

/// Runs `cargo mutants`; returns the mutants that no test noticed.
fn survivors(run: &Run) -> Result<BTreeSet<String>, String> {
    let out = format!("{OUT}/{}", run.name);
    let mut command = Command::new("cargo");
    command.args(["mutants", "--package", "fga-link", "--output", &out]);
    for file in run.files {
        command.args(["--file", file]);
    }
    let status = command
        .arg("--")
        .args(run.tests)
        .status()
        .map_err(|error| format!("cargo mutants does not start: {error}"))?;
    // 2: some survived; 3: some did not end, which the tests notice.
    if !matches!(status.code(), Some(0 | 2 | 3)) {
        return Err(format!(
            "cargo mutants ended with {status}; `cargo install cargo-mutants` installs it"
        ));
    }
    let missed = format!("{out}/mutants.out/missed.txt");
    let missed = fs::read_to_string(&missed).map_err(|error| format!("{missed}: {error}"))?;
    Ok(missed.lines().map(without_place).collect())
}

/// Runs `cargo mutants` and compares what survived with the list.
pub(crate) fn check() -> Result<(), String> {
    let known = argued(&fs::read_to_string(LIST).map_err(|error| format!("{LIST}: {error}"))?)?;
    let mut survivors = BTreeSet::new();
    for run in &RUNS {
        survivors.extend(self::survivors(run)?);
    }
    let (new, gone): (Vec<_>, Vec<_>) = (
        survivors.difference(&known).cloned().collect(),
        known.difference(&survivors).cloned().collect(),
    );
    for mutant in &gone {
        eprintln!("caught, but still in {LIST}: {mutant}");
    }
    if new.is_empty() {
        println!("{} survivors, each with a reason", survivors.len());
        return Ok(());
    }
    Err(format!(
        "{} mutants that no test notices:\n{}",
        new.len(),
        new.join("\n")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mutant_is_known_wherever_its_line_moves() {
        assert_eq!(
            without_place("crates/a/src/b.rs:12:34: replace < with <= in C::d"),
            "crates/a/src/b.rs: replace < with <= in C::d"
        );
    }

    #[test]
    fn every_entry_of_the_list_has_a_reason() {
        let list = include_str!("../../fga-link/src/authority/mutants.txt");
        assert!(argued(list).is_ok());
        assert!(argued("a.rs: replace x").is_err());
    }
}
