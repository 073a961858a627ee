//! Third-party data that tests read in place.

use std::path::{Path, PathBuf};

/// A file or folder of third-party data, or `None` without it: then the test skips, except in continuous integration, where it fails.
pub(crate) fn data(relative: &str) -> Option<PathBuf> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = std::env::var_os("FGA_DATA")
        .map_or_else(|| repository.join("../shared/data"), PathBuf::from);
    let path = folder.join(relative);
    if path.exists() {
        return Some(path);
    }
    assert!(
        std::env::var("CI").as_deref() != Ok("true"),
        "{} is missing",
        path.display()
    );
    eprintln!("skipped: {} is missing", path.display());
    None
}
