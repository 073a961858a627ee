//! The simulated world around [`fga`]: plant, sensor, scenarios, recordings, batches. [`fga_judge`] measures its flights.
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
//! | [`worlds`] | what do many worlds show to policies that learn? |
//! | [`engine`] | what is the result of a flight? |
//! | [`reaction`] | where does an intruder fly that has a policy of its own? |
//! | [`run`] | what happened in one flight, with everything logged? |
//! | [`batch`] | what is the result of many encounters? |
//! | [`baselines`] | what would others fly? |
//! | [`own`] | what would a policy outside of this crate fly? |
//! | [`campaign`] | what is the result of millions of drawn encounters, policy by policy? |
//! | [`drawn`], [`recorded`] | which encounters do files hold? |
//! | [`encounters`] | which encounters does a generator make? |
//! | [`stress`] | in which likely motions of an intruder does a policy fail? |
//! | [`oracle`] | can any manoeuvre save an encounter of a file? |
//! | [`fingerprint`] | are two files the same? |

extern crate alloc;

pub use fga_judge::{fine, separation, track};

pub mod ahead;
pub mod baselines;
pub mod batch;
pub mod campaign;
mod corrupt;
pub mod drawn;
pub mod encounters;
pub mod engine;
pub mod fingerprint;
pub mod identification;
pub mod mission_pilot;
pub mod obstacle;
pub mod oracle;
pub mod own;
pub mod plan;
pub mod plant;
pub mod policy;
mod policy_pilot;
pub mod progress;
pub mod reaction;
pub mod recorded;
pub mod recording;
pub mod run;
pub mod scenario;
pub mod sensor;
pub mod settings;
pub mod shield;
pub mod stress;
pub mod tracker;
mod values;
pub mod vehicle_file;
pub mod way_round;
mod whole;
pub mod wind;
pub mod world;
pub mod worlds;
pub mod zone;
