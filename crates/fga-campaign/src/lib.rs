//! Many flights of [`fga_sim`]: encounters drawn or read, each flown in closed loop, and what they show together.
//!
//! Frame: x east, y north, z up; course from +x towards +y; left is positive.
//!
//! | module | question |
//! |---|---|
//! | [`encounters`] | which encounters does a generator make? |
//! | [`drawn`], [`recorded`] | which encounters do files hold? |
//! | [`batch`] | what is the result of many encounters? |
//! | [`campaign`] | what is the result of millions of drawn encounters, policy by policy? |
//! | [`stress`] | in which likely motions of an intruder does a policy fail? |
//! | [`worlds`] | what do many worlds show to policies that learn? |
//! | [`oracle`] | can any manoeuvre save an encounter of a file? |

extern crate alloc;

pub mod batch;
pub mod campaign;
mod corrupt;
pub mod drawn;
pub mod encounters;
pub mod oracle;
pub mod recorded;
pub mod stress;
mod unchanged;
mod values;
pub mod worlds;
