//! Files that may be compressed.

use alloc::borrow::Cow;
use std::io::{self, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use crate::error::{InputError, read_bytes, reason, text_of};

/// The most that a file may hold when it is decompressed, bytes (4 GiB).
const MOST: u64 = 4 << 30;

/// The bytes of a file, decompressed if they are gzip data.
///
/// # Errors
/// Damaged gzip data, or more than 4 GiB of it, as one sentence.
pub fn unpacked<'a>(bytes: &'a [u8], path: &Path) -> Result<Cow<'a, [u8]>, InputError> {
    unpacked_to(bytes, path, MOST)
}

/// As [`unpacked`], with at most this many bytes.
fn unpacked_to<'a>(bytes: &'a [u8], path: &Path, most: u64) -> Result<Cow<'a, [u8]>, InputError> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(Cow::Borrowed(bytes));
    }
    let mut plain = Vec::new();
    let mut input = MultiGzDecoder::new(bytes).take(most + 1);
    let read = input.read_to_end(&mut plain);
    let message = match read {
        Ok(_) if plain.len() as u64 <= most => return Ok(Cow::Owned(plain)),
        Ok(_) => {
            format!("holds more than {most} bytes when it is decompressed, expected at most that")
        }
        Err(error) => unread(&error),
    };
    Err(InputError::in_file(path, message))
}

/// Why bytes cannot be read.
pub(crate) fn unread(error: &io::Error) -> String {
    if error.raw_os_error().is_some() {
        return format!("cannot be read: {}", reason(error));
    }
    format!("holds damaged gzip data ({error}), expected a whole file")
}

/// Reads this many bytes, fewer at the end of the input.
pub(crate) fn fill(input: &mut impl Read, bytes: &mut Vec<u8>, count: usize) -> Result<(), String> {
    bytes.clear();
    let read = input.take(count as u64).read_to_end(bytes);
    read.map(|_| ()).map_err(|error| unread(&error))
}

/// The text of a file, decompressed if it is gzip data.
pub(crate) fn read_packed_text(path: &Path) -> Result<String, InputError> {
    Ok(text_of(&unpacked(&read_bytes(path)?, path)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write as _;

    fn packed(plain: &[u8]) -> Vec<u8> {
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        packed.write_all(plain).unwrap();
        packed.finish().unwrap()
    }

    /// In an earlier version the rest was cut off without a word.
    #[test]
    fn more_than_the_limit_is_an_error() {
        let path = Path::new("a.daa.gz");
        let bytes = packed(&[b'x'; 1000]);
        assert_eq!(unpacked_to(&bytes, path, 1000).unwrap().len(), 1000);
        let error = unpacked_to(&bytes, path, 999).unwrap_err().to_string();
        assert!(error.contains("more than 999 bytes"), "{error}");
    }

    #[test]
    fn several_parts_are_one_text_and_plain_bytes_stay_as_they_are() {
        let path = Path::new("a.csv.gz");
        let bytes = [packed(b"one "), packed(b"two")].concat();
        assert_eq!(&*unpacked(&bytes, path).unwrap(), b"one two");
        assert_eq!(&*unpacked(b"plain", path).unwrap(), b"plain");
        let error = unpacked(&bytes[..12], path).unwrap_err().to_string();
        assert!(error.contains("damaged gzip data"), "{error}");
    }
}
