//! Errors of inputs and outputs: one sentence with the file, the line, the found and the expected
//! content.

use core::fmt::Write as _;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Longest number in a message that is not in scientific form, characters: room for the largest whole number of 64 bits.
const LONGEST_NUMBER: usize = 21;

/// The most that is read of what is no regular file, bytes (1 GiB).
const MOST_STREAMED: u64 = 1 << 30;

/// An unusable input, as one sentence.
///
/// ```
/// use fga_formats::InputError;
///
/// let error = InputError::at_line("a.daa", 7, "column lat holds \"x\", expected a number");
/// assert_eq!(error.to_string(), "a.daa, line 7: column lat holds \"x\", expected a number");
/// ```
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}{}: {message}", path.display(), line_part(*line))]
pub struct InputError {
    /// The file, as the user named it.
    pub path: PathBuf,
    /// The line, counted from one, if the error has one.
    pub line: Option<u64>,
    /// The found and the expected content.
    pub message: String,
}

fn line_part(line: Option<u64>) -> String {
    line.map_or_else(String::new, |line| format!(", line {line}"))
}

impl InputError {
    /// An error about the file as a whole.
    pub fn in_file(path: impl Into<PathBuf>, message: impl Into<String>) -> Self {
        Self::at(path, None, message)
    }

    /// An error on one line, counted from one.
    pub fn at_line(path: impl Into<PathBuf>, line: u64, message: impl Into<String>) -> Self {
        Self::at(path, Some(line), message)
    }

    /// An error on a line, counted from one, where the line is known.
    pub(crate) fn at(
        path: impl Into<PathBuf>,
        line: Option<u64>,
        message: impl Into<String>,
    ) -> Self {
        Self {
            path: path.into(),
            line: line.filter(|line| *line > 0),
            message: legible(&message.into()),
        }
    }

    /// JSON that is not what it should be.
    pub(crate) fn json(path: &Path, kind: &str, error: &serde_json::Error) -> Self {
        let line = u64::try_from(error.line()).ok();
        Self::at(
            path,
            line,
            format!("is no {kind}: {}", json_sentence(error)),
        )
    }

    /// A table that is not what it should be.
    pub(crate) fn csv(path: &Path, kind: &str, error: &csv::Error) -> Self {
        if let csv::ErrorKind::Io(error) = error.kind() {
            return Self::unreadable(path, error);
        }
        let line = error.position().map(csv::Position::line);
        let message = format!("is no {kind}: {error}");
        Self::at(path, line, message.replace(char::is_control, " "))
    }

    /// An unreadable file.
    pub fn unreadable(path: impl Into<PathBuf>, error: &io::Error) -> Self {
        Self::in_file(path, format!("cannot be read: {}", reason(error)))
    }
}

/// A failed write, as one sentence.
#[derive(Debug, thiserror::Error)]
#[error("{} cannot be written: {}", path.display(), reason(source))]
pub struct OutputError {
    /// The file or folder.
    pub path: PathBuf,
    /// The error of the operating system.
    #[source]
    pub source: io::Error,
}

impl OutputError {
    /// The error `source` while writing `path`.
    pub fn new(path: impl Into<PathBuf>, source: io::Error) -> Self {
        Self {
            path: path.into(),
            source,
        }
    }
}

/// The reason of an operating-system error in plain words.
pub(crate) fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file or folder".into(),
        io::ErrorKind::PermissionDenied => "permission denied".into(),
        io::ErrorKind::IsADirectory => "it is a folder, expected a file".into(),
        io::ErrorKind::NotADirectory => "a part of its path is a file, expected a folder".into(),
        io::ErrorKind::StorageFull => "the disk is full".into(),
        io::ErrorKind::ReadOnlyFilesystem => "the file system is read-only".into(),
        _ => error.to_string(),
    }
}

/// Reads the bytes of a file; of what is no regular file, as a pipe or a device, at most 1 GiB: it may have no end.
///
/// # Errors
/// An unreadable file, or a pipe or device that gives more than 1 GiB.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, InputError> {
    let is_other = std::fs::metadata(path).is_ok_and(|about| !about.is_file());
    let read = if is_other {
        File::open(path).and_then(|input| bytes_of(input, MOST_STREAMED))
    } else {
        std::fs::read(path)
    };
    read.map_err(|error| InputError::unreadable(path, &error))
}

/// The bytes of an input, at most this many.
fn bytes_of(input: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::other(format!(
            "it is no regular file and gives more than {most} bytes, expected at most that"
        )));
    }
    Ok(bytes)
}

/// Reads a text file; see [`text_of`].
///
/// # Errors
/// An unreadable file.
pub fn read_text(path: &Path) -> Result<String, InputError> {
    Ok(text_of(&read_bytes(path)?))
}

/// The text of a file's bytes: UTF-16 where its byte-order mark begins them, as programs of Windows write it, else UTF-8. Bytes that are
/// neither become replacement characters, and byte-order marks before the text are dropped.
pub fn text_of(bytes: &[u8]) -> String {
    let wide = |pairs: &[u8], of: fn([u8; 2]) -> u16| {
        let units = pairs.as_chunks::<2>().0.iter().copied().map(of);
        let letters = char::decode_utf16(units);
        let letters = letters.map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER));
        letters.collect::<String>().into()
    };
    let text = match bytes {
        [0xff, 0xfe, pairs @ ..] => wide(pairs, u16::from_le_bytes),
        [0xfe, 0xff, pairs @ ..] => wide(pairs, u16::from_be_bytes),
        _ => String::from_utf8_lossy(bytes),
    };
    text.trim_start_matches('\u{feff}').to_owned()
}

/// A message of the TOML reader as one sentence without names of Rust types.
///
/// ```
/// use fga_formats::error::toml_sentence;
///
/// let message = "invalid type: string \"30\", expected f64\n";
/// assert_eq!(toml_sentence(message), "found string \"30\", expected a number");
/// let message = "invalid length 2, expected an array of length 3\n";
/// assert_eq!(toml_sentence(message), "found a list of 2 values, expected 3");
/// ```
pub fn toml_sentence(message: &str) -> String {
    let mut told = message.trim().replace('\n', "; ");
    if told.contains("` as i128, expected ") {
        return format!("the number is too large, expected at most {}", u64::MAX);
    }
    if let Some(found) = told.strip_prefix("invalid value: integer ") {
        // The types of keys that hold a whole number are unsigned or i64.
        for (kind, most) in [
            ("u8", u64::from(u8::MAX)),
            ("u16", u64::from(u16::MAX)),
            ("u32", u64::from(u32::MAX)),
            ("u64", u64::MAX),
        ] {
            if let Some(found) = found.strip_suffix(&format!(", expected {kind}")) {
                return format!("found {found}, expected a whole number from 0 to {most}");
            }
        }
    }
    if let Some(lengths) = told.strip_prefix("invalid length ")
        && let Some((found, expected)) = lengths.split_once(", expected an array of length ")
    {
        let values = if found == "1" { "value" } else { "values" };
        return format!("found a list of {found} {values}, expected {expected}");
    }
    told = told
        .replace("invalid type: ", "found ")
        .replace("invalid float, ", "found no number, ")
        .replace("duplicate key", "the key is given twice, expected it once")
        .replace("unknown variant ", "unknown word ");
    let Some((before, kind)) = told.rsplit_once("expected ") else {
        return told;
    };
    let word = match kind {
        "f64" | "f32" => "a number",
        "u64" | "u32" | "u16" | "u8" | "usize" | "i64" => "a whole number",
        "a sequence" => "a list",
        "a boolean" => "true or false",
        "`nan`" => "a finite number or a word in quotes",
        _ => return told,
    };
    format!("{before}expected {word}")
}

/// A message of the JSON reader, without its place, as [`toml_sentence`] says it.
pub(crate) fn json_sentence(error: &serde_json::Error) -> String {
    let told = error.to_string().replace(char::is_control, " ");
    toml_sentence(told.split(" at line ").next().unwrap_or_default())
}

/// A piece of input for a message: quoted, control characters escaped, at most
/// 40 characters.
pub fn shown(text: &str) -> String {
    let mut out = String::from("\"");
    for character in text.chars().take(40) {
        let _ = write!(out, "{}", character.escape_debug());
    }
    if text.chars().nth(40).is_some() {
        out.push('…');
    }
    out.push('"');
    out
}

/// A message whose numbers of more than 21 characters are in scientific form. Digits of a quoted text or of a fingerprint stay.
///
/// ```
/// use fga_formats::error::legible;
///
/// assert_eq!(legible(&format!("x is {}, expected {}", 1e308, 1e-30)), "x is 1e308, expected 1e-30");
/// ```
pub fn legible(message: &str) -> String {
    let is_digit = |letter: char| letter.is_ascii_digit() || letter == '.';
    let is_near = |letter: char| letter.is_alphanumeric() || letter == '"';
    let mut told = String::new();
    for part in message.split_inclusive(|letter| !is_digit(letter)) {
        let number = part.trim_end_matches(|letter| !is_digit(letter));
        let after = &part[number.len()..];
        match number.parse::<f64>() {
            Ok(value)
                if number.len() > LONGEST_NUMBER
                    && !told.ends_with(is_near)
                    && !after.starts_with(is_near) =>
            {
                let _ = write!(told, "{value:e}{after}");
            }
            _ => told.push_str(part),
        }
    }
    told
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_are_too_long_to_read_are_in_scientific_form() {
        let told = |message: String| InputError::in_file("a", message).message;
        for value in [1e308, 2.5e-300, 1.7e22] {
            assert_eq!(told(format!("is -{value} m.")), format!("is -{value:e} m."));
        }
        assert_eq!(told(format!("is {:.1}", 1e308)), "is 1e308");
        for short in [0.1 + 0.2, 1e20] {
            assert_eq!(told(format!("is {short}")), format!("is {short}"));
        }
        for text in [
            u64::MAX.to_string(),
            format!("{:?}", "1".repeat(40)),
            format!("a{}", "1".repeat(40)),
        ] {
            assert_eq!(told(text.clone()), text);
        }
    }

    #[test]
    fn long_and_odd_text_is_cut_and_escaped() {
        assert_eq!(shown("a\u{1b}[31m\n"), "\"a\\u{1b}[31m\\n\"");
        assert_eq!(shown(&"x".repeat(50)), format!("\"{}…\"", "x".repeat(40)));
    }

    #[test]
    fn an_input_without_an_end_is_an_error() {
        let error = bytes_of(io::repeat(0), 1000).unwrap_err().to_string();
        assert!(error.contains("more than 1000 bytes"), "{error}");
        assert_eq!(bytes_of(io::repeat(7).take(1000), 1000).unwrap(), [7; 1000]);
    }

    #[test]
    fn byte_order_marks_are_no_text() {
        assert_eq!(text_of(b"\xEF\xBB\xBF\xEF\xBB\xBFa\xFF"), "a\u{fffd}");
        assert_eq!(text_of(b"\xFF\xFEa\0\xE4\0\x3D\xD8"), "aä\u{fffd}");
        assert_eq!(text_of(b"\xFE\xFF\0a\0"), "a");
    }

    #[test]
    fn missing_file_is_one_sentence() {
        let error = read_text(Path::new("no/such.daa")).unwrap_err();
        assert_eq!(
            error.to_string(),
            "no/such.daa: cannot be read: there is no such file or folder"
        );
    }
}
