//! Scenario, vehicle and campaign files as they are written: their tables, keys and words.
//!
//! The tables hold what the file says, with the place of each value. `fga-sim` checks the values and makes a world of
//! them. The tables have a crate of their own because their code is large and rarely runs: it is compiled early, beside
//! other crates, and without optimization.
//!
//! | module | file |
//! |---|---|
//! | [`scenario`] | a mission and its obstacles |
//! | [`vehicle`] | an aircraft, its protected volume, its sensor |
//! | [`campaign`] | a grid of conditions, policies and seeds |
//! | [`sensors`] | a source of a campaign's knowledge about other aircraft |
//! | [`text`] | any of them: reads TOML, with errors that name file and line |

extern crate alloc;

pub mod campaign;
pub mod scenario;
pub mod sensors;
pub mod text;
pub mod vehicle;

pub use text::TomlText;
