//! The simulated world: plant, missions, zones, terrain. One program, so that both cores are
//! busy to its end: `cargo test -p fga-sim --test sim plant::` runs the tests of one file.

extern crate alloc;

mod certificates;
mod charted;
mod data;
mod difference;
mod ground;
mod identification;
mod judged;
mod missions;
mod plant;
#[path = "../../../fga-proof/tests/common/random.rs"]
mod random;
mod way_round;
mod zones;
