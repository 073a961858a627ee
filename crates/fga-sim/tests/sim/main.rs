//! The simulated world: plant, oracle, missions, sources of encounters. One program, so that both cores are
//! busy to its end: `cargo test -p fga-sim --test sim oracle::` runs the tests of one file.

extern crate alloc;

mod belief;
mod bounded;
mod certificates;
mod charted;
mod data;
mod dead_time;
mod departures;
mod difference;
mod drawn;
mod encounters;
mod ground;
mod identification;
mod judged;
mod lost_once;
mod missions;
mod modeled;
mod oracle;
mod plant;
#[path = "../../../fga-proof/tests/common/random.rs"]
mod random;
mod stands;
mod start_time;
mod trials;
mod way_round;
mod zones;
