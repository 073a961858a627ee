//! The commit of a build, in repositories made for it.

#[path = "../git.rs"]
mod git;

use std::fs;
use std::path::Path;
use std::process::Command;

#[test]
fn n6_the_commit_is_one_or_says_that_it_is_unknown() {
    let commit = fga_build::COMMIT;
    assert!(commit == "unknown" || git::is_commit(commit), "{commit}");
    let version = format!("{} ({commit})", env!("CARGO_PKG_VERSION"));
    assert_eq!(fga_build::VERSION, version);
}

fn run_git(at: &Path, arguments: &[&str]) {
    let author = ["-c", "user.name=t", "-c", "user.email=t@example.org"];
    let output = Command::new("git")
        .arg("-C")
        .arg(at)
        .args(author)
        .args(arguments)
        .output();
    assert!(output.unwrap().status.success(), "{arguments:?}");
}

/// Sources that differ from their commit are another build, until the change is committed or taken back.
#[test]
fn n6_sources_that_are_changed_are_dirty() {
    if Command::new("git").arg("--version").output().is_err() {
        assert!(std::env::var_os("CI").is_none(), "git is missing");
        eprintln!("git is missing: skipped");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    assert!(git::of_git(at).is_none());
    let source = at.join("crates/a/src/lib.rs");
    let test = at.join("crates/a/tests/a.rs");
    for file in [&source, &test, &at.join("Cargo.toml"), &at.join("page.md")] {
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, "one").unwrap();
    }
    run_git(at, &["init", "-q"]);
    run_git(at, &["add", "."]);
    run_git(at, &["commit", "-qm", "one"]);
    let (clean, files) = git::of_git(at).unwrap();
    assert!(git::is_commit(&clean) && !clean.ends_with("-dirty"));
    assert!(files.contains(&source) && !files.contains(&test));
    assert!(git::of_git(&at.join("crates")).is_none());
    for (file, is_dirty) in [
        (&source, true),
        (&test, false),
        (&at.join("page.md"), false),
    ] {
        fs::write(file, "two").unwrap();
        let (commit, _) = git::of_git(at).unwrap();
        assert_eq!(commit.ends_with("-dirty"), is_dirty, "{}", file.display());
        assert!(commit.starts_with(&clean));
        fs::write(file, "one").unwrap();
    }
    assert_eq!(git::of_git(at).unwrap().0, clean);
    fs::write(&source, "two").unwrap();
    run_git(at, &["add", "."]);
    assert!(git::of_git(at).unwrap().0.ends_with("-dirty"));
    run_git(at, &["commit", "-qm", "two"]);
    let (next, _) = git::of_git(at).unwrap();
    assert!(next != clean && !next.ends_with("-dirty"));
}
