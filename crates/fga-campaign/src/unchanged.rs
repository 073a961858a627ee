//! Files that must be as they were when a campaign began.

use std::path::Path;

use fga_formats::InputError;
use fga_formats::error::read_bytes;
use fga_sim::fingerprint::fingerprint;

/// Reads a file of which a campaign knows the fingerprint.
///
/// # Errors
/// An unreadable file, or one with another fingerprint.
pub(crate) fn read_same(path: &Path, sha256: &str) -> Result<Vec<u8>, InputError> {
    let bytes = read_bytes(path)?;
    if fingerprint(&bytes) == sha256 {
        Ok(bytes)
    } else {
        Err(changed(path))
    }
}

/// An error about a file that is another one than a campaign knows.
pub(crate) fn changed(path: &Path) -> InputError {
    let message = "is not the file that the campaign was begun with";
    InputError::in_file(path, message)
}
