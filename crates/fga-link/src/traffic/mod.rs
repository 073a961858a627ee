//! Who else is there: reports from several sources become one list of obstacles.
//!
//! | module | question |
//! |---|---|
//! | [`report`] | what did one message say? |
//! | [`receiver`] | what do the receivers on the network say? |
//! | [`table`] | which aircraft is it, where is it now, and how well is that known? |
//! | [`fence`] | which obstacles stand for the vehicle's fence, floor and ceiling? |

pub mod fence;
pub mod receiver;
pub mod report;
pub mod table;

pub use report::{Report, Source};
pub use table::{Track, TrackTable};
