//! Shortest paths of bounded curvature to a pose, with altitude within the climb limits.
//!
//! The crate `dubins_paths` gives the words in the plane; a check of the end point of each follows here,
//! because a rounded angle just below zero would otherwise cost a full circle. In altitude
//! the path climbs at one angle along its whole length. Left is anticlockwise from above.

mod clearance;
mod path;

pub use clearance::Clearance;
pub use path::{ClimbLimits, DubinsPath, Pose, Segment, SegmentKind};
