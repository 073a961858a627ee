//! Reads TOML with errors that name the file and the line.

use alloc::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use fga_formats::InputError;
use fga_formats::error::toml_sentence;
use serde::de::{DeserializeOwned, IgnoredAny};
use toml::Spanned;

/// A TOML file with its name and text for messages.
#[derive(Debug, Clone, Copy)]
pub struct TomlText<'a> {
    path: &'a Path,
    text: &'a str,
}

impl<'a> TomlText<'a> {
    /// The text of the file `path`.
    pub const fn new(path: &'a Path, text: &'a str) -> Self {
        Self { path, text }
    }

    /// The text itself.
    pub const fn text(&self) -> &'a str {
        self.text
    }

    /// The file's name in messages.
    pub const fn path(&self) -> &'a Path {
        self.path
    }

    /// Reads the text as `T`; unknown keys are errors if `T` says so.
    ///
    /// # Errors
    /// Text that is not TOML or not a `T`, with its line.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, InputError> {
        toml::from_str(self.text).map_err(|error| {
            let message = toml_sentence(error.message());
            match error.span() {
                Some(span) => InputError::at_line(self.path, self.line_of(span.start), message),
                None => InputError::in_file(self.path, message),
            }
        })
    }

    /// The keys of the top level, whatever they hold.
    ///
    /// # Errors
    /// Text that is not TOML, with its line.
    #[expect(
        clippy::zero_sized_map_values,
        reason = "serde reads a table of TOML only as a map"
    )]
    pub fn keys(&self) -> Result<BTreeSet<String>, InputError> {
        let table: BTreeMap<String, IgnoredAny> = self.read()?;
        Ok(table.into_keys().collect())
    }

    fn line_of(&self, byte: usize) -> u64 {
        let before = self.text.get(..byte).unwrap_or_default();
        1 + before.matches('\n').count() as u64
    }

    /// An error about the file as a whole.
    pub fn error(&self, message: impl Into<String>) -> InputError {
        InputError::in_file(self.path, message)
    }

    /// An error about a value in the file.
    pub fn error_at<T>(&self, value: &Spanned<T>, message: impl Into<String>) -> InputError {
        InputError::at_line(self.path, self.line_of(value.span().start), message)
    }

    /// The value, if it is finite.
    ///
    /// # Errors
    /// A value that is not.
    pub fn finite(&self, key: &str, value: &Spanned<f64>) -> Result<f64, InputError> {
        self.checked(key, value, "a finite number", f64::is_finite)
    }

    /// The value, if it is finite and greater than zero.
    ///
    /// # Errors
    /// A value that is not.
    pub fn positive(&self, key: &str, value: &Spanned<f64>) -> Result<f64, InputError> {
        self.checked(key, value, "a positive number", |v| {
            v.is_finite() && v > 0.0
        })
    }

    /// The value, if it is finite and not negative.
    ///
    /// # Errors
    /// A value that is not.
    pub fn not_negative(&self, key: &str, value: &Spanned<f64>) -> Result<f64, InputError> {
        self.checked(key, value, "a number that is not negative", |v| {
            v.is_finite() && v >= 0.0
        })
    }

    /// The value, if it is within the limits.
    ///
    /// # Errors
    /// A value that is not.
    pub fn within(
        &self,
        key: &str,
        value: &Spanned<f64>,
        (low, high): (f64, f64),
    ) -> Result<f64, InputError> {
        self.checked(key, value, &format!("a number from {low} to {high}"), |v| {
            (low..=high).contains(&v)
        })
    }

    fn checked(
        &self,
        key: &str,
        value: &Spanned<f64>,
        expected: &str,
        usable: impl Fn(f64) -> bool,
    ) -> Result<f64, InputError> {
        let found = *value.get_ref();
        if usable(found) {
            Ok(found)
        } else {
            Err(self.error_at(value, format!("{key} is {found}, expected {expected}")))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_read_whatever_they_hold() {
        let text = "seed = 18446744073709551615\n[mission]\nx = [1, 'a']";
        let keys = TomlText::new(Path::new("a"), text).keys().unwrap();
        assert!(keys.iter().eq(["mission", "seed"]));
    }

    #[test]
    fn toml_messages_say_the_limits_of_a_whole_number() {
        #[derive(Debug, serde::Deserialize)]
        struct Keys {
            #[serde(rename = "id")]
            _id: Option<u8>,
            #[serde(rename = "seed")]
            _seed: Option<u64>,
        }
        for (text, expected) in [
            (
                "id = 256",
                "found `256`, expected a whole number from 0 to 255",
            ),
            (
                "seed = -1",
                "found `-1`, expected a whole number from 0 to 18446744073709551615",
            ),
            (
                "seed = 18446744073709551616",
                "the number is too large, expected at most 18446744073709551615",
            ),
            ("id = 1\nid = 2", "the key is given twice, expected it once"),
            ("id = 'a'", "found string \"a\", expected a whole number"),
        ] {
            let error = TomlText::new(Path::new("a"), text).read::<Keys>();
            assert_eq!(error.unwrap_err().message, expected, "{text}");
        }
    }
}
