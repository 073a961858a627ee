//! Input of the benches: crowds of obstacles, and encounters flown cycle by cycle.
//!
//! `RUSTFLAGS="-C target-cpu=x86-64-v3" cargo bench -p fga-bench` measures all of it; `docs/benchmarks/`
//! keeps results with their machine.

pub mod cycles;

mod crowd;
mod flight;

pub use crowd::{Crowd, ownship};
pub use flight::{Cycle, fly, settings, vehicle};
