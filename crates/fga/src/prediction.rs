//! The path of the aircraft under a manoeuvre.
//!
//! | question | answer |
//! |---|---|
//! | how does the vehicle move under one command? | [`Flyer`] |
//! | where does the manoeuvre lead? | [`FlightPath`] |

mod bend;
mod motion;
mod path;
mod roll;

pub(crate) use bend::{Bend, Exit};
pub(crate) use motion::{ArcSteps, Piece};
pub use motion::{Flyer, MotionState, Target};
pub(crate) use path::{CHORD_BOW_M, chords, flown, for_each_piece, while_flown, whole};
pub use path::{FlightPath, MAX_NODES, Node};
