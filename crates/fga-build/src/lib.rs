//! Which build of fga is this?
//!
//! The programs alone depend on this crate and pass the commit on when they start, so that a new commit compiles it and
//! them, and nothing else.

/// The commit that the sources are of, with `-dirty` behind it where they were changed since, or `unknown` for sources without git and
/// without `FGA_COMMIT`.
pub const COMMIT: &str = env!("FGA_COMMIT");

/// Version and commit, as `fga --version` prints them.
pub const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("FGA_COMMIT"), ")");
