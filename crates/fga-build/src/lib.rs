//! Which build of fga is this?
//!
//! The programs alone depend on this crate and pass the commit on when they start, so that a new commit compiles it and
//! them, and nothing else.

/// The commit that the sources are of, or `unknown` for sources without git and without `FGA_COMMIT`. Changes that are not
/// committed are not seen.
pub const COMMIT: &str = env!("FGA_COMMIT");

/// Version and commit, as `fga --version` prints them.
pub const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("FGA_COMMIT"), ")");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn n6_the_commit_is_one_or_says_that_it_is_unknown() {
        let is_digit = |byte: u8| byte.is_ascii_hexdigit();
        assert!(
            COMMIT == "unknown" || (COMMIT.len() >= 7 && COMMIT.bytes().all(is_digit)),
            "{COMMIT}"
        );
        assert_eq!(VERSION, format!("{} ({COMMIT})", env!("CARGO_PKG_VERSION")));
    }
}
