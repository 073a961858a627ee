//! Finds the commit that the sources are of: what `FGA_COMMIT` says, or git.
//!
//! Without both (sources from an archive) it is `unknown`. Git counts only where this repository is its own: an archive that
//! was unpacked inside another repository is not of that one's commit. The script runs again when a source changes, which
//! compiles this crate and the programs, no library.

mod git;

use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=git.rs");
    println!("cargo::rerun-if-env-changed=FGA_COMMIT");
    let commit = std::env::var("FGA_COMMIT")
        .ok()
        .filter(|commit| git::is_commit(commit));
    let commit = commit.or_else(of_git).unwrap_or_else(|| "unknown".into());
    println!("cargo::rustc-env=FGA_COMMIT={commit}");
}

fn of_git() -> Option<String> {
    let root = Path::new(&std::env::var_os("CARGO_MANIFEST_DIR")?).join("../..");
    let (commit, files) = git::of_git(&root)?;
    // A path that is missing would make the script run at each build.
    for file in files.iter().filter(|file| file.exists()) {
        println!("cargo::rerun-if-changed={}", file.display());
    }
    Some(commit)
}
