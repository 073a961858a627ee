//! What a flight was worth, and what an encounter allowed: measured and searched by code that nothing that decides uses.
//!
//! Of the crates that fly it takes plain types of [`fga_proof`] as they stand: it computes nothing by their functions.
//!
//! | module | question |
//! |---|---|
//! | [`arc`] | where did the aircraft fly? |
//! | [`track`] | where was an obstacle? |
//! | [`separation`] | how close did they really come? |
//! | [`zone`], [`ground`] | how far from zones, and how high above the ground? |
//! | [`progress`] | how far along the mission, and how far beside it? |
//! | [`fine`] | what is the real result of a manoeuvre? |
//! | [`oracle`] | can any manoeuvre save an encounter? |
//!
//! Frame: x east, y north, z up; course from +x towards +y; left is positive.

extern crate alloc;

pub mod arc;
pub mod fine;
pub mod ground;
pub mod oracle;
pub mod progress;
pub mod separation;
pub mod track;
pub mod zone;
