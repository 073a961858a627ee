//! Who else is there: reports from several sources become one list of obstacles.
//!
//! | module | question |
//! |---|---|
//! | [`report`] | what did one message say? |
//! | [`identity`] | who sent a report, and of which aircraft is it? |
//! | [`class`] | what kind of aircraft is it, so how much room does it get? |
//! | [`defect`] | what do reports lack, and what does the operator read? |
//! | [`receiver`] | what do the receivers on the network say? |
//! | [`remote_id`] | what do unmanned aircraft broadcast? |
//! | [`table`] | which reports are of one aircraft, and which aircraft are kept? |
//! | [`track`] | where is it now, and how well is that known? |
//! | `motion` | do its positions bear out its velocity? |
//! | [`threat`] | which aircraft matter most? |
//! | [`own`] | is it the vehicle's own transponder? |
//! | [`vertical`] | how high is it above the same level as the vehicle? |
//! | [`fence`] | which obstacles stand for the vehicle's fence, floor and ceiling? |

pub mod class;
pub mod defect;
pub mod fence;
pub mod identity;
pub(crate) mod motion;
pub mod own;
pub mod receiver;
pub mod remote_id;
pub mod report;
pub mod table;
pub mod threat;
pub mod track;
pub mod vertical;

pub use class::{AircraftClass, Volumes};
pub use defect::{Defect, Defects};
pub use report::{AltitudeReference, PlaceReport, ReportSender, ReportSource};
pub use table::TrackTable;
pub use track::AircraftTrack;
