//! Finds the commit that the sources are of: what `FGA_COMMIT` says, or git.
//!
//! Without both (sources from an archive) it is `unknown`. Git counts only where this repository is its own: an archive that
//! was unpacked inside another repository is not of that one's commit.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=FGA_COMMIT");
    let commit = std::env::var("FGA_COMMIT")
        .ok()
        .filter(|commit| is_commit(commit));
    let commit = commit.or_else(of_git).unwrap_or_else(|| "unknown".into());
    println!("cargo::rustc-env=FGA_COMMIT={commit}");
}

fn is_commit(text: &str) -> bool {
    (7..=64).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

/// The commit that is checked out; the build script runs again when it changes.
fn of_git() -> Option<String> {
    let root = Path::new(&std::env::var_os("CARGO_MANIFEST_DIR")?).join("../..");
    let git = |arguments: &[&str]| {
        let output = Command::new("git")
            .arg("-C")
            .arg(&root)
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
    let branch = git(&["symbolic-ref", "--quiet", "HEAD"]);
    for file in ["HEAD", "logs/HEAD", "packed-refs"]
        .into_iter()
        .chain(branch.as_deref())
    {
        let path = root.join(git(&["rev-parse", "--git-path", file])?);
        // A path that is missing would make the script run at each build.
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    git(&["rev-parse", "HEAD"]).filter(|commit| is_commit(commit))
}
