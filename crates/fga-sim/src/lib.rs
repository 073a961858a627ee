//! The simulated world around [`fga`]: plant, sensor, separation, scenarios, recordings, batches.
//!
//! Frame: x east, y north, z up; course from +x towards +y; left is positive. With wind, the
//! plant's angles are those through the air; logged samples have those over the ground.
//!
//! | module | question |
//! |---|---|
//! | [`scenario`], [`recording`] | which flight does a file describe? |
//! | [`vehicle_file`] | which aircraft does a file describe? |
//! | [`plan`] | what is to be flown, with the names of things? |
//! | [`world`] | what is one flight made of? |
//! | [`obstacle`] | what is in the way, and what is heard of it? |
//! | [`wind`] | which way to fly a line in a wind? |
//! | [`plant`] | how does the aircraft really fly? |
//! | [`track`] | where is an obstacle really? |
//! | [`sensor`] | what does the aircraft know of it? |
//! | [`separation`] | how close did they really come? |
//! | [`progress`] | how far along the mission, and how far beside it? |
//! | [`settings`] | what does a vehicle file say about deciding? |
//! | [`policy`] | which policy is meant by a name? |
//! | [`ahead`] | how is decided where a command takes effect only later? |
//! | [`shield`] | may any policy fly, as long as a way out remains? |
//! | [`worlds`] | what do many worlds show to policies that learn? |
//! | [`engine`] | what comes of a flight? |
//! | [`run`] | what happened in one flight, with everything logged? |
//! | [`batch`] | what comes of many encounters? |
//! | [`baselines`] | what would others fly? |
//! | [`campaign`] | what comes of millions of drawn encounters, policy by policy? |
//! | [`encounters`] | which encounters does a generator make? |
//! | [`fine`] | what does a manoeuvre really lead to? |
//! | [`oracle`] | can an encounter be saved at all? |

extern crate alloc;

pub mod ahead;
pub mod baselines;
pub mod batch;
pub mod campaign;
pub mod encounters;
pub mod engine;
pub mod fine;
mod fingerprint;
pub mod obstacle;
pub mod oracle;
pub mod plan;
pub mod plant;
pub mod policy;
pub mod progress;
pub mod recording;
pub mod run;
pub mod scenario;
pub mod sensor;
pub mod separation;
pub mod settings;
pub mod shield;
pub mod toml_input;
pub mod track;
pub mod tracker;
pub mod vehicle_file;
pub mod wind;
pub mod world;
pub mod worlds;
