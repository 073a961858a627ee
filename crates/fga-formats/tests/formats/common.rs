//! Where the third-party inputs are, another reader, and a flight.

#[cfg(feature = "export")]
pub(crate) mod flight;

use std::path::{Path, PathBuf};
use std::process::Command;

/// The path of a third-party input, or `None` (reported on standard error) if it is absent.
///
/// # Panics
/// If it is absent and `CI=true`.
pub(crate) fn data(name: &str) -> Option<PathBuf> {
    let root = std::env::var_os("FGA_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    let path = root.join(name);
    if path.exists() {
        return Some(path);
    }
    let missing = format!("{} is absent (FGA_DATA names its folder)", path.display());
    assert!(
        std::env::var("CI").as_deref() != Ok("true"),
        "in CI every input must be there: {missing}"
    );
    eprintln!("skipped: {missing}");
    None
}

/// Runs a Python script with arguments; `None` without Python or a module that it needs, which is a
/// failure in CI.
pub(crate) fn python(module: &str, script: &str, arguments: &[&Path]) -> Option<String> {
    let interpreter = std::env::var("FGA_PYTHON").unwrap_or_else(|_| "python3".into());
    let there = Command::new(&interpreter)
        .args(["-c", &format!("import {module}")])
        .output()
        .is_ok_and(|output| output.status.success());
    if !there {
        let missing = format!("{interpreter} has no module {module} (FGA_PYTHON names another)");
        assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
        eprintln!("skipped: {missing}");
        return None;
    }
    let output = Command::new(&interpreter)
        .args(["-c", script])
        .args(arguments)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{error}");
    Some(String::from_utf8(output.stdout).unwrap())
}
