//! Other programs.

use std::path::Path;
use std::process::Command;

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
