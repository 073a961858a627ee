//! How does it get back to its mission?
//!
//! | question | module |
//! |---|---|
//! | where does it stand on a leg of the mission? | [`leg`] |
//! | which way back onto the leg stays clear? | [`join`] |
//! | the shortest flyable path to a pose | [`dubins`] (§3: "a Dubins path") |
//! | which waypoint next | [`waypoint`] (Alg. 3, corrected) |

pub mod dubins;
pub mod join;
pub mod leg;
pub mod waypoint;
