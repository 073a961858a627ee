//! Makes the evidence behind the pages' counts again: `cargo xtask evidence` runs every experiment in
//! the size of the pages (hours), `cargo xtask evidence small` a part of each (minutes).
//!
//! Each output goes to `out/evidence/NAME.txt` below its command. The chore fails when an experiment
//! misses its expected count.

use std::fs;
use std::path::Path;
use std::process::Command;

const OUT: &str = "out/evidence";

/// One experiment of `fga-experiments`.
struct Evidence {
    name: &'static str,
    /// Its arguments in the size of the pages.
    full: &'static [&'static str],
    /// Its arguments in the small size.
    small: &'static [&'static str],
    /// Expected start of its last line, if known.
    expected: Option<&'static str>,
}

const EVIDENCE: [Evidence; 12] = [
    Evidence {
        name: "certificates",
        full: &["certificates", "10000000"],
        small: &["certificates", "100000"],
        expected: Some("0 of "),
    },
    Evidence {
        name: "lost",
        full: &["lost", "7", "1000"],
        small: &["lost", "7", "3"],
        expected: Some("all: 0 lost of "),
    },
    Evidence {
        name: "lost-turning",
        full: &["lost", "5", "100", "--turning"],
        small: &["lost", "5", "1", "--turning"],
        expected: None,
    },
    Evidence {
        name: "lost-latest",
        full: &["lost", "9", "200", "--policy", LATEST],
        small: &["lost", "9", "1", "--policy", LATEST],
        expected: None,
    },
    Evidence {
        name: "needless",
        full: &["departures", "needless", "1", "5000"],
        small: &["departures", "needless", "1", "50"],
        expected: None,
    },
    Evidence {
        name: "departures",
        full: &["departures", "compare", "1", "100"],
        small: &["departures", "compare", "1", "1"],
        expected: None,
    },
    Evidence {
        name: "robustness",
        full: &["robustness", "1", "10"],
        small: &["robustness", "1", "1"],
        expected: None,
    },
    Evidence {
        name: "quality",
        full: &["quality", "7", "40"],
        small: &["quality", "7", "10", "threats:3:300:30-45"],
        expected: None,
    },
    Evidence {
        name: "intruders-turning",
        full: &["intruders", "turning", "500"],
        small: &["intruders", "turning", "20"],
        expected: None,
    },
    Evidence {
        name: "families",
        full: &["families", "10000"],
        small: &["families", "100"],
        expected: None,
    },
    Evidence {
        name: "missions-survey",
        full: &["missions", "survey"],
        small: &["missions", "survey"],
        expected: None,
    },
    Evidence {
        name: "missions-curves",
        full: &["missions", "curves"],
        small: &["missions", "curves"],
        expected: None,
    },
];

const LATEST: &str = "turn-aware --start latest";

/// Runs every experiment in one size.
pub(crate) fn make(options: &[&str]) -> Result<(), String> {
    let is_small = match options {
        [] => false,
        ["small"] => true,
        _ => return Err("expected cargo xtask evidence [small]".into()),
    };
    let program = program(is_small)?;
    fs::create_dir_all(OUT).map_err(|error| format!("{OUT}: {error}"))?;
    let mut failed = Vec::new();
    for evidence in &EVIDENCE {
        let arguments = if is_small {
            evidence.small
        } else {
            evidence.full
        };
        eprintln!("{}: fga-experiments {}", evidence.name, arguments.join(" "));
        let output = Command::new(&program)
            .args(arguments)
            .output()
            .map_err(|error| format!("{program}: {error}"))?;
        let errors = String::from_utf8_lossy(&output.stderr);
        if !output.status.success() {
            return Err(format!("{}: {}", evidence.name, errors.trim()));
        }
        let text = String::from_utf8_lossy(&output.stdout);
        let path = Path::new(OUT).join(format!("{}.txt", evidence.name));
        let command = format!("fga-experiments {}\n", arguments.join(" "));
        fs::write(&path, command + &text)
            .map_err(|error| format!("{}: {error}", path.display()))?;
        let last = text.lines().last().unwrap_or_default();
        println!("{}: {last}", evidence.name);
        if evidence
            .expected
            .is_some_and(|begin| !last.starts_with(begin))
        {
            failed.push(evidence.name);
        }
    }
    if failed.is_empty() {
        Ok(())
    } else {
        Err(format!("not as expected: {}; see {OUT}", failed.join(", ")))
    }
}

/// Builds the experiments: in the small size with the tests, as those build them, else for speed.
fn program(is_small: bool) -> Result<String, String> {
    let (arguments, program) = if is_small {
        let with_tests = "test --no-run --workspace --features fga-cli/beast";
        (with_tests, "target/debug/fga-experiments")
    } else {
        let alone = "build --release --package fga-experiments --bin fga-experiments";
        (alone, "target/release/fga-experiments")
    };
    let status = Command::new("cargo")
        .args(arguments.split(' '))
        .status()
        .map_err(|error| format!("cargo does not start: {error}"))?;
    if status.success() {
        Ok(program.into())
    } else {
        Err(format!("cargo build ended with {status}"))
    }
}
