//! Scenario, vehicle and campaign files as they are written: their tables, keys and words.
//!
//! The tables hold what the file says, with the place of each value. `fga-sim` and `fga-campaign` check the values and make worlds of
//! them. The tables have a crate of their own because their code is large and rarely runs: it is compiled early, beside
//! other crates, and without optimization.
//!
//! | module | file |
//! |---|---|
//! | [`scenario`] | a mission and its obstacles |
//! | [`vehicle`] | an aircraft, its protected volume, its sensor |
//! | [`campaign`] | a grid of conditions, policies and seeds |
//! | [`sensors`] | a source of a campaign's knowledge about other aircraft |
//! | [`from_mission`] | which scenario flies the mission of a ground station? |
//! | [`surveillance`] | does an aircraft look far enough, by keys of several tables? |
//! | [`text`] | any of them: reads TOML, with errors that name file and line |

extern crate alloc;

pub mod campaign;
pub mod from_mission;
pub mod scenario;
pub mod sensors;
pub mod surveillance;
pub mod text;
pub mod vehicle;

pub use text::TomlText;
