//! What git says of the sources: the commit, and whether anything that is compiled differs from it.
//!
//! The build script and its test share this file.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Ends the commit of sources that differ from it, as in `git describe --dirty`.
const DIRTY: &str = "-dirty";

/// What a program is compiled from; tests and pages are not in it.
const SOURCES: [&str; 6] = [
    "Cargo.toml",
    "Cargo.lock",
    "crates",
    ":(exclude,glob)crates/*/tests/**",
    ":(exclude,glob)crates/*/benches/**",
    ":(exclude,glob)**/*.md",
];

/// Whether a text names a commit, with or without changes.
pub(crate) fn is_commit(text: &str) -> bool {
    let digits = text.strip_suffix(DIRTY).unwrap_or(text);
    (7..=64).contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_hexdigit())
}

/// The commit that is checked out at the root of a repository, with `-dirty` where sources differ from it; and the files that
/// decide it. `None` without git, and where the root is not that of a repository.
pub(crate) fn of_git(root: &Path) -> Option<(String, Vec<PathBuf>)> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git")
            .args(["--no-optional-locks", "-C"])
            .arg(root)
            .args(arguments)
            .output()
            .ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_owned())
    };
    let top = git(&["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != root.canonicalize().ok()? {
        return None;
    }
    let commit = git(&["rev-parse", "HEAD"]).filter(|commit| is_commit(commit))?;
    let of_sources = |command: &[&str]| git(&[command, &["--"], &SOURCES].concat());
    let changes = of_sources(&["status", "--porcelain", "--untracked-files=no"])?;
    let branch = git(&["symbolic-ref", "--quiet", "HEAD"]);
    let mut files: Vec<PathBuf> = ["HEAD", "logs/HEAD", "packed-refs"]
        .into_iter()
        .chain(branch.as_deref())
        .filter_map(|file| git(&["rev-parse", "--git-path", file]))
        .map(|file| root.join(file))
        .collect();
    let sources = of_sources(&["ls-files"])?;
    files.extend(sources.lines().map(|file| root.join(file)));
    let end = if changes.is_empty() { "" } else { DIRTY };
    Some((commit + end, files))
}
