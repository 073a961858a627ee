//! Where the third-party inputs are, and a flight.

#[cfg(feature = "export")]
pub(crate) mod flight;

use std::path::PathBuf;

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
