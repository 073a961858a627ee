//! What recovery finds.

use crate::bands::intervals::Intervals;

/// The result of recovery bands, where every manoeuvre leads into the corrective volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Recovery {
    /// A free manoeuvre exists; no search for recovery.
    NotNeeded,
    /// Not even the NMAC volume is avoidable.
    Impossible {
        /// Number of shrinkings of its distances.
        shrinkings: i32,
    },
    /// Well clear again after a time, at a distance.
    Found {
        /// Time until well clear again, seconds.
        time_s: f64,
        /// Horizontal distance kept meanwhile, metres.
        distance_m: f64,
        /// Vertical distance kept meanwhile, metres.
        height_m: f64,
        /// Number of shrinkings of the distances.
        shrinkings: i32,
    },
}

impl Recovery {
    /// Number of shrinkings; −1 without a search for recovery.
    pub const fn shrinkings(self) -> i32 {
        match self {
            Self::NotNeeded => -1,
            Self::Impossible { shrinkings } | Self::Found { shrinkings, .. } => shrinkings,
        }
    }
}

/// The outcome of the search.
pub(super) enum WaysOut {
    /// No search for recovery.
    NotLookedFor,
    /// A free interval is a resolution.
    Same,
    /// The resolutions that replace the free values of the corrective region.
    Other(Intervals),
}
