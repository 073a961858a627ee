//! Asks the [oracle](fga_judge::oracle) about worlds and about encounters of a batch.

mod airspace;
mod judge;
mod tracks;

pub use fga_judge::oracle::*;

pub use airspace::airspace_of;
pub use judge::Judge;
pub use tracks::{TracksAnswer, best_margin_of_tracks};
