//! What is asked of a manoeuvre.

use crate::avoider::Avoider;

/// The separation that a manoeuvre must keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Demand {
    /// Share of the bounds of aircraft that it withstands; 1 without aircraft.
    pub(super) share: f64,
    /// Distance beyond every volume, metres.
    pub(super) margin_m: f64,
    /// How far ahead, seconds.
    pub(super) horizon_s: f64,
}

impl Avoider {
    /// All that is wanted, over the horizon of the settings.
    pub(super) const fn demand(&self) -> Demand {
        Demand {
            share: 1.0,
            margin_m: self.wanted_m,
            horizon_s: self.settings.horizon_s,
        }
    }
}
