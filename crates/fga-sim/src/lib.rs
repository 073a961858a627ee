//! The simulated world around [`fga`], for one flight: plant, sensor, scenarios, recordings, other policies. [`fga_judge`]
//! measures it.
//!
//! Frame: x east, y north, z up; course from +x towards +y; left is positive. With wind, the
//! plant's angles are through the air and logged samples have angles over the ground.
//!
//! | module | question |
//! |---|---|
//! | [`scenario`], [`recording`] | which flight does a file describe? |
//! | [`vehicle_file`] | which aircraft does a file describe? |
//! | [`identification`] | which aircraft does a flight log show? |
//! | [`plan`] | which flight, with the names of things? |
//! | [`world`] | which parts make one flight? |
//! | [`obstacle`] | what is in the way, and what do reports say about it? |
//! | [`wind`] | which way to fly a line in a wind? |
//! | [`plant`] | how does the aircraft really fly? |
//! | [`sensor`] | what does the aircraft know of it? |
//! | [`progress`] | which line does a mission ask for? |
//! | [`settings`] | which settings for decisions does a vehicle file give? |
//! | [`policy`] | which policy has this name? |
//! | [`mission_pilot`] | which pilot flies the mission and avoids nothing? |
//! | [`way_round`] | can the policy `circle` keep the obstacles of a scenario? |
//! | [`ahead`] | how does a pilot decide when a command takes effect later? |
//! | [`shield`] | may any policy fly, as long as a way out remains? |
//! | [`engine`] | what is the result of a flight? |
//! | [`reaction`] | where does an intruder fly that has a policy of its own? |
//! | [`run`] | what happened in one flight, with everything logged? |
//! | [`baselines`] | what would others fly? |
//! | [`own`] | what would a policy outside of this crate fly? |
//! | [`fingerprint`] | are two files the same? |
//! | [`whole`] | which count or index is a real number? |

extern crate alloc;

pub use fga_judge::{fine, separation, track};

pub mod ahead;
pub mod baselines;
pub mod engine;
pub mod fingerprint;
pub mod identification;
pub mod mission_pilot;
pub mod obstacle;
pub mod own;
pub mod plan;
pub mod plant;
pub mod policy;
mod policy_pilot;
pub mod progress;
pub mod reaction;
pub mod recording;
pub mod run;
pub mod scenario;
pub mod sensor;
pub mod settings;
pub mod shield;
pub mod tracker;
pub mod vehicle_file;
pub mod way_round;
pub mod whole;
pub mod wind;
pub mod world;
pub mod zone;
