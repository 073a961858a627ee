//! The lines `key = value [unit]` of a configuration.

use super::ShownUnit;
use crate::error::{InputError, shown};
use crate::units::{Dimension, Unit};
use alloc::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A value that nothing has read yet.
#[derive(Debug, Clone)]
struct ConfEntry {
    line: u64,
    key: String,
    value: String,
}

/// The lines of a file; reading a key removes it.
#[derive(Debug)]
pub(super) struct Entries {
    path: PathBuf,
    /// By the key in lower case.
    left: BTreeMap<String, ConfEntry>,
}

/// A parsed number.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Number {
    /// The value in SI units.
    pub(super) si: f64,
    /// Its unit, where it has one.
    pub(super) unit: Option<ShownUnit>,
}

/// The numbers that a key accepts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Allowed {
    Any,
    NotNegative,
    Positive,
}

impl Allowed {
    fn contains(self, value: f64) -> bool {
        match self {
            Self::Any => true,
            Self::NotNegative => value >= 0.0,
            Self::Positive => value > 0.0,
        }
    }

    const fn words(self) -> &'static str {
        match self {
            Self::Any => "a finite number",
            Self::NotNegative => "0 or more",
            Self::Positive => "more than 0",
        }
    }
}

impl Entries {
    pub(super) fn parse(text: &str, path: &Path) -> Result<Self, InputError> {
        let mut left: BTreeMap<String, ConfEntry> = BTreeMap::new();
        for (line, number) in text.split('\n').zip(1_u64..) {
            let content = line.split('#').next().unwrap_or_default().trim();
            if content.is_empty() {
                continue;
            }
            let Some((key, value)) = content.split_once('=') else {
                let message = format!("holds {}, expected key = value", shown(content));
                return Err(InputError::at_line(path, number, message));
            };
            let (key, value) = (key.trim(), value.trim());
            let entry = ConfEntry {
                line: number,
                key: key.to_owned(),
                value: value.to_owned(),
            };
            if let Some(first) = left.insert(key.to_ascii_lowercase(), entry) {
                let message = format!(
                    "the key {key} appears twice, expected it once (first on line {})",
                    first.line
                );
                return Err(InputError::at_line(path, number, message));
            }
        }
        if left.is_empty() {
            let message = "is empty, expected lines key = value [unit]";
            return Err(InputError::in_file(path, message));
        }
        Ok(Self {
            path: path.to_owned(),
            left,
        })
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.left.contains_key(&key.to_ascii_lowercase())
    }

    /// Keys that begin with a prefix, without the prefix, in alphabetical order.
    pub(super) fn after(&self, prefix: &str) -> Vec<String> {
        let prefix = prefix.to_ascii_lowercase();
        self.left
            .values()
            .filter_map(|entry| {
                let key = entry.key.to_ascii_lowercase();
                key.strip_prefix(&prefix)
                    .map(|rest| entry.key.get(entry.key.len() - rest.len()..))?
                    .map(str::to_owned)
            })
            .collect()
    }

    /// An error about the value of a taken key.
    pub(super) fn refused(&self, line: u64, message: impl Into<String>) -> InputError {
        InputError::at_line(&self.path, line, message)
    }

    /// An error about the file as a whole.
    pub(super) fn missing(&self, message: impl Into<String>) -> InputError {
        InputError::in_file(&self.path, message)
    }

    /// Takes the text of a key.
    pub(super) fn text(&mut self, key: &str) -> Option<(u64, String)> {
        self.left
            .remove(&key.to_ascii_lowercase())
            .map(|entry| (entry.line, entry.value))
    }

    /// Takes a number of a quantity, or a plain one.
    pub(super) fn number(
        &mut self,
        key: &str,
        quantity: Option<Dimension>,
        allowed: Allowed,
    ) -> Result<Option<Number>, InputError> {
        let Some((line, text)) = self.text(key) else {
            return Ok(None);
        };
        let refused = |message| self.refused(line, format!("{key} {message}"));
        let wrong = |message: String| Err(refused(message));
        let (digits, symbol) = split_unit(&text);
        let value: Option<f64> = digits.parse().ok();
        let Some(value) = value.filter(|value| value.is_finite()) else {
            return wrong(format!("is {}, expected a number", shown(&text)));
        };
        let unit = match quantity {
            Some(dimension) => Unit::of(symbol, dimension).map_err(refused)?,
            None if Unit::is_unspecified(symbol) => None,
            None => {
                let symbol = shown(symbol);
                return wrong(format!("has the unit {symbol}, expected a plain number"));
            }
        };
        if !allowed.contains(value) {
            return wrong(format!("is {}, expected {}", shown(&text), allowed.words()));
        }
        let si = unit.map_or(value, |unit| unit.to_si(value));
        let unit = unit.map(|unit| ShownUnit::new(symbol, unit.factor));
        Ok(Some(Number { si, unit }))
    }

    /// Takes a value that is read from its text.
    fn taken<T>(
        &mut self,
        key: &str,
        of: impl FnOnce(&str) -> Option<T>,
        expected: impl FnOnce() -> String,
    ) -> Result<Option<T>, InputError> {
        let Some((line, text)) = self.text(key) else {
            return Ok(None);
        };
        of(&text).map(Some).ok_or_else(|| {
            let message = format!("{key} is {}, expected {}", shown(&text), expected());
            self.refused(line, message)
        })
    }

    /// Takes a boolean.
    pub(super) fn boolean(&mut self, key: &str) -> Result<Option<bool>, InputError> {
        let of = |text: &str| match text.to_ascii_lowercase().as_str() {
            "true" | "t" => Some(true),
            "false" | "f" => Some(false),
            _ => None,
        };
        self.taken(key, of, || "true or false".into())
    }

    /// Takes a whole number up to a largest one.
    pub(super) fn count(&mut self, key: &str, most: usize) -> Result<Option<usize>, InputError> {
        let of = |text: &str| text.parse().ok().filter(|number| *number <= most);
        self.taken(key, of, || format!("a whole number from 0 to {most}"))
    }

    /// Takes one of several words.
    pub(super) fn word<T: Copy>(
        &mut self,
        key: &str,
        words: &[(&str, T)],
    ) -> Result<Option<T>, InputError> {
        let of = |text: &str| words.iter().find(|(word, _)| *word == text);
        let names = || words.iter().map(|(word, _)| *word).collect::<Vec<_>>();
        let found = self.taken(key, of, || format!("one of {}", names().join(", ")))?;
        Ok(found.map(|(_, value)| *value))
    }

    /// Refuses a file with unread keys.
    pub(super) fn nothing_left(&self) -> Result<(), InputError> {
        match self.left.values().min_by_key(|entry| entry.line) {
            None => Ok(()),
            Some(entry) => Err(self.refused(
                entry.line,
                format!(
                    "the key {} is unknown, expected one of DAIDALUS 2",
                    entry.key
                ),
            )),
        }
    }
}

/// A number's digits and its unit without brackets.
fn split_unit(text: &str) -> (&str, &str) {
    let is_unit = |c: char| !(c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E'));
    let end = text.find(is_unit).unwrap_or(text.len());
    let (digits, unit) = text.split_at(end);
    let unit = unit.trim().trim_start_matches('[').trim_end_matches(']');
    (digits.trim(), unit.trim())
}
