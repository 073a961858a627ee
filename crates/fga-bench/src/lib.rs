//! What the benches measure: crowds of obstacles, and encounters flown cycle by cycle.
//!
//! `RUSTFLAGS="-C target-cpu=x86-64-v3" cargo bench -p fga-bench` measures all of it; results are kept,
//! with the machine they were measured on, in `docs/benchmarks/`.

pub mod cycles;

mod crowd;
mod flight;

pub use crowd::{Crowd, ownship};
pub use flight::{Cycle, fly, settings, vehicle};
