//! Which build wrote a file?
//!
//! A program says its commit once, when it starts; results carry it. A library that is used without a program has none.

use std::sync::OnceLock;

static COMMIT: OnceLock<&'static str> = OnceLock::new();

/// Says the commit of the program; a second call changes nothing.
pub fn set_commit(commit: &'static str) {
    let _ = COMMIT.set(commit);
}

/// The commit of the program, or `unknown`.
pub fn commit() -> &'static str {
    COMMIT.get().copied().unwrap_or(UNKNOWN)
}

/// The commit of a program that does not know it.
pub const UNKNOWN: &str = "unknown";
