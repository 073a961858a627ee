//! Mutants of the code that decides about the mode: authority, watchdog and clock of the link.
//!
//! `cargo mutants` changes one thing at a time and runs the tests. A mutant that the tests do not notice
//! must be in `crates/fga-link/src/authority/mutants.txt`, with the reason why no test can.

use alloc::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use std::{fs, io};

const LIST: &str = "crates/fga-link/src/authority/mutants.txt";
const OUT: &str = "target/mutants";

/// The modules of the link that decide about the mode. They need no other one but the modes' names, so a crate of their own builds
/// in seconds, where the link takes a minute for each mutant.
const MODULES: [&str; 4] = ["authority", "clock", "mode", "restart"];
const LINK: &str = "crates/fga-link/src";
const CRATE: &str = "target/mutants/crate";
/// What their tests read.
const READ: &str = "docs/fly-reactions.md";

/// Mutated files and the tests that may notice. Tests and printing code stay unchanged.
struct Scope {
    name: &'static str,
    /// The workspace, from the root of the repository.
    at: &'static str,
    options: &'static [&'static str],
    files: &'static [&'static str],
    tests: &'static [&'static str],
}

const RUNS: [Scope; 2] = [
    Scope {
        name: "authority",
        at: CRATE,
        options: &["--in-place"],
        files: &[
            "crates/fga-link/src/authority.rs",
            "crates/fga-link/src/authority/*.rs",
            "crates/fga-link/src/clock.rs",
            "crates/fga-link/src/restart.rs",
        ],
        tests: &["--lib"],
    },
    // The threads around them, which use all of the link.
    Scope {
        name: "guard",
        at: ".",
        // Builds the library's tests alone.
        options: &["--cargo-arg=--lib"],
        files: &["crates/fga-link/src/fly/guard.rs"],
        tests: &["guard"],
    },
];

/// Copies a file or a folder.
fn copy(from: &Path, to: &Path) -> io::Result<()> {
    if !from.is_dir() {
        return fs::copy(from, to).map(drop);
    }
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        copy(&entry.path(), &to.join(entry.file_name()))?;
    }
    Ok(())
}

/// Writes the workspace of the crate with these modules alone, under the paths that they have in the repository.
fn write_crate() -> io::Result<()> {
    let root = Path::new(CRATE);
    let sources = root.join(LINK);
    if root.exists() {
        fs::remove_dir_all(root)?;
    }
    fs::create_dir_all(&sources)?;
    fs::create_dir_all(root.join("docs"))?;
    fs::write(
        root.join("Cargo.toml"),
        "[workspace]\nmembers = [\"crates/fga-link\"]\nresolver = \"3\"\n",
    )?;
    for file in ["Cargo.lock", READ] {
        fs::copy(file, root.join(file))?;
    }
    fs::write(
        root.join("crates/fga-link/Cargo.toml"),
        "[package]\nname = \"fga-link\"\nedition = \"2024\"\n[dependencies]\n\
         serde = { version = \"1\", features = [\"derive\"] }\nserde_json = \"1\"\n",
    )?;
    let modules = MODULES.map(|module| format!("pub mod {module};\n"));
    fs::write(
        sources.join("lib.rs"),
        format!(
            "#![allow(dead_code)]\nextern crate alloc;\n{}",
            modules.concat()
        ),
    )?;
    for module in MODULES {
        for name in [module.to_owned(), format!("{module}.rs")] {
            let from = Path::new(LINK).join(&name);
            if from.exists() {
                copy(&from, &sources.join(&name))?;
            }
        }
    }
    Ok(())
}

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
fn survivors(run: &Scope) -> Result<BTreeSet<String>, String> {
    let out = std::path::absolute(format!("{OUT}/{}", run.name)).map_err(|e| e.to_string())?;
    fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let mut command = Command::new("cargo");
    command
        .current_dir(run.at)
        .args(["mutants", "--package", "fga-link", "--output"])
        .arg(&out)
        .args(run.options);
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
    let missed = out.join("mutants.out/missed.txt");
    let missed =
        fs::read_to_string(&missed).map_err(|error| format!("{}: {error}", missed.display()))?;
    Ok(missed.lines().map(without_place).collect())
}

/// Runs `cargo mutants` and compares what survived with the list.
pub(crate) fn check() -> Result<(), String> {
    let known = argued(&fs::read_to_string(LIST).map_err(|error| format!("{LIST}: {error}"))?)?;
    write_crate().map_err(|error| format!("{CRATE}: {error}"))?;
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
