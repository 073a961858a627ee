//! A committed table of numbers by name, `name,number` a line, and the comparison with it.

use alloc::collections::BTreeMap;
use core::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Largest difference from a table, as a share.
const TOLERANCE: f64 = 0.03;

/// A table, by its path from the root of the repository, and the chore that makes it.
pub(crate) struct NumberTable {
    pub(crate) path: &'static str,
    pub(crate) header: &'static str,
    pub(crate) chore: &'static str,
}

impl NumberTable {
    /// Writes numbers, or compares them with those that are committed.
    pub(crate) fn check(
        &self,
        root: &Path,
        numbers: &BTreeMap<String, u64>,
        write: bool,
    ) -> Result<(), String> {
        let path = root.join(self.path);
        let unusable = |error| format!("{}: {error}", self.path);
        if write {
            let mut text = format!("{}\n", self.header);
            for (name, number) in numbers {
                let _ = writeln!(text, "{name},{number}");
            }
            return fs::write(path, text).map_err(unusable);
        }
        self.compare(&fs::read_to_string(path).map_err(unusable)?, numbers)
    }

    /// Names the numbers that differ, and those that are in one of the two only.
    fn compare(&self, text: &str, numbers: &BTreeMap<String, u64>) -> Result<(), String> {
        let table: BTreeMap<&str, u64> = text
            .lines()
            .skip(1)
            .filter_map(|line| line.rsplit_once(','))
            .filter_map(|(name, number)| Some((name, number.parse().ok()?)))
            .collect();
        let mut off = String::new();
        for (name, number) in numbers {
            let known = table.get(name.as_str()).copied();
            let share = known.map_or(f64::INFINITY, |known| *number as f64 / known as f64 - 1.0);
            if share.abs() > TOLERANCE {
                let known = known.map_or("nothing".to_owned(), |known| known.to_string());
                let _ = write!(off, "\n  {name}: {number}, the table has {known}");
            }
        }
        for name in table.keys().filter(|name| !numbers.contains_key(**name)) {
            let _ = write!(off, "\n  {name}: nothing, the table has it");
        }
        if off.is_empty() {
            return Ok(());
        }
        Err(format!(
            "numbers differ from {} by more than {} %:{off}\nwhere that is meant: cargo xtask {} --write",
            self.path,
            100.0 * TOLERANCE,
            self.chore
        ))
    }
}
