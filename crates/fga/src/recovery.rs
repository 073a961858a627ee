//! How does it get back to its mission?
//!
//! | question | module |
//! |---|---|
//! | the shortest flyable path to a pose | [`dubins`] (§3: "a Dubins path") |
//! | which waypoint next | [`waypoint`] (Alg. 3, corrected) |

pub mod dubins;
pub mod waypoint;
