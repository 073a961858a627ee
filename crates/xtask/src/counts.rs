//! A committed table of counts, `crate,quantity,number` a line. A number only falls.

use alloc::collections::{BTreeMap, BTreeSet};
use core::fmt::Write as _;
use std::fs;
use std::path::Path;

const HEADER: &str = "crate,quantity,number";

/// Numbers by crate and quantity.
pub(crate) type CountTable = BTreeMap<(String, String), usize>;

/// Compares counts with a table; with `write`, writes those that fell before. The error names the rows that differ.
pub(crate) fn check(path: &Path, now: &CountTable, write: bool) -> Result<(), String> {
    let unusable = |error| format!("{}: {error}", path.display());
    let mut known = read(&fs::read_to_string(path).map_err(unusable)?)
        .map_err(|line| format!("{}:{line}: expected {HEADER}", path.display()))?;
    if write {
        known.retain(|row, _| now.contains_key(row));
        for (row, number) in now {
            let known = known.entry(row.clone()).or_insert(*number);
            *known = (*known).min(*number);
        }
        let mut text = format!("{HEADER}\n");
        for ((name, quantity), number) in &known {
            let _ = writeln!(text, "{name},{quantity},{number}");
        }
        fs::write(path, text).map_err(unusable)?;
    }
    compare(now, &known)
}

/// Names the rows that differ.
fn compare(now: &CountTable, known: &CountTable) -> Result<(), String> {
    let mut off = String::new();
    for row in now.keys().chain(known.keys()).collect::<BTreeSet<_>>() {
        let (found, expected) = (now.get(row), known.get(row));
        if found != expected {
            let show = |number: Option<&usize>| number.map_or("none".to_owned(), usize::to_string);
            let (name, quantity) = row;
            let (found, expected) = (show(found), show(expected));
            let _ = write!(
                off,
                "\n  {name}, {quantity}: {found}, the table has {expected}"
            );
        }
    }
    if off.is_empty() { Ok(()) } else { Err(off) }
}

/// The rows of a table, or the number of the first line without a row.
fn read(text: &str) -> Result<CountTable, usize> {
    let rows = text.lines().skip(1).map(|line| {
        let mut cells = line.split(',');
        let row = (cells.next()?.to_owned(), cells.next()?.to_owned());
        Some((row, cells.next()?.parse().ok()?))
    });
    let rows = rows.zip(2..);
    rows.map(|(row, number)| row.ok_or(number)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_that_differs_is_named() {
        let row =
            |number: usize| CountTable::from([(("a".to_owned(), "lines".to_owned()), number)]);
        assert_eq!(compare(&row(3), &row(3)), Ok(()));
        let off = compare(&row(4), &row(3)).expect_err("more");
        assert!(off.contains("a, lines: 4, the table has 3"), "{off}");
        let off = compare(&row(3), &CountTable::new()).expect_err("new");
        assert!(off.contains("a, lines: 3, the table has none"), "{off}");
        assert!(read("crate,quantity,number\na,lines\n").is_err());
    }
}
