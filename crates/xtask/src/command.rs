//! Other programs.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Cargo, as it runs now.
pub(crate) fn cargo() -> Command {
    Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// The program `fga` as a profile builds it.
pub(crate) fn built(root: &Path, profile: &str) -> PathBuf {
    let target = env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    let folder = target.unwrap_or_else(|| root.join("target")).join(profile);
    folder.join(format!("fga{}", env::consts::EXE_SUFFIX))
}

/// What a command printed; it must succeed.
pub(crate) fn ran(command: &mut Command) -> Result<String, String> {
    let output = command
        .output()
        .map_err(|error| format!("{command:?}: {error}"))?;
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        return Ok(printed);
    }
    Err(format!(
        "{command:?}: {printed}{}",
        String::from_utf8_lossy(&output.stderr)
    ))
}

/// The target of this machine.
pub(crate) fn host() -> Result<String, String> {
    let version = ran(Command::new("rustc").arg("-vV"))?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned)
        .ok_or_else(|| "rustc does not name its host".into())
}

/// Whether the core library of a target is installed.
pub(crate) fn has_target(target: &str) -> bool {
    let folder = ran(Command::new("rustc").args(["--print", "target-libdir", "--target", target]));
    folder.is_ok_and(|folder| Path::new(folder.trim()).is_dir())
}
