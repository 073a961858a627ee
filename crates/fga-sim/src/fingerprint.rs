//! Fingerprints of files.

use std::path::Path;

use fga_formats::InputError;
use fga_formats::error::read_bytes;

/// SHA-256 of some bytes, in hexadecimal.
pub fn fingerprint(bytes: &[u8]) -> String {
    use sha2::Digest as _;
    hexadecimal(&sha2::Sha256::digest(bytes))
}

/// Bytes in hexadecimal.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    use core::fmt::Write as _;
    let mut text = String::with_capacity(2 * bytes.len());
    for byte in bytes {
        let _ = write!(text, "{byte:02x}");
    }
    text
}

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
