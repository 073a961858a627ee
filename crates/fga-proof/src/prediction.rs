//! The path of the aircraft under a manoeuvre.
//!
//! | question | answer |
//! |---|---|
//! | how does the vehicle move under one command? | [`Flyer`] |
//! | where does the manoeuvre lead? | [`FlightPath`] |

mod drift;
mod motion;
mod path;
mod roll;

pub use motion::{Flyer, MotionState, Piece};
pub use path::{CHORD_BOW_M, FlightPath, MAX_NODES, Node, flown};
pub use roll::GAUSS;
