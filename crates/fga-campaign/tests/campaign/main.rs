//! Many flights: sources of encounters, the oracle, and policies among drawn encounters. One program, so that both
//! cores are busy to its end: `cargo test -p fga-campaign --test campaign oracle::` runs the tests of one file.

extern crate alloc;

mod belief;
mod bounded;
#[path = "../../../fga-sim/tests/sim/data.rs"]
mod data;
mod dead_time;
mod departures;
mod difference;
mod drawn;
mod encounters;
mod ground;
mod lost_once;
mod modeled;
mod oracle;
#[path = "../../../fga-proof/tests/common/random.rs"]
mod random;
mod shield;
mod stands;
mod start_time;
mod trials;
mod zones;
