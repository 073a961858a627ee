//! The volumes of the standards: when do straight lines violate them?
//!
//! | volume | what violates it | source |
//! |---|---|---|
//! | [`Cylinder`] | closer than a distance and a height at once | NMAC (500 ft, 100 ft), ASTM F3442 (2,000 ft, 250 ft), CD3D |
//! | [`WellClear`] | within a distance or within a time of it, and within a height or a time of co-altitude | RTCA DO-365B: DMOD, τ_mod, HMD, ZTHR |
//! | [`UncertainWellClear`] | the same for any state within the stated deviations | DO-365B with sensor uncertainty mitigation |
//! | [`Advisory`] | TCAS II thresholds by altitude | RTCA DO-185B, tables of sensitivity levels |

mod advisory;
mod cylinder;
mod uncertain;
mod well_clear;

pub use advisory::{Advisory, Sensitivity};
pub use cylinder::Cylinder;
pub use uncertain::{DeviationFactors, UncertainWellClear};
pub use well_clear::{HorizontalTime, VerticalTime, WellClear};

use crate::aircraft::Pair;
use crate::almost::Closeness::Rounding;
use crate::loss::Loss;

/// A volume around an aircraft that others must stay out of.
#[derive(Debug, Clone, PartialEq)]
pub enum Volume {
    /// A cylinder.
    Cylinder(Cylinder),
    /// Well clear in distance and time.
    WellClear(WellClear),
    /// Well clear with deviations.
    Uncertain(UncertainWellClear),
    /// TCAS-like thresholds.
    Advisory(Advisory),
}

impl Volume {
    /// The violation between two times along straight lines, seconds from now, `0 ≤ from_s < to_s`.
    ///
    /// A violation that does not last is [`Loss::NEVER`].
    pub fn violation(&self, pair: &Pair, from_s: f64, to_s: f64) -> Loss {
        match self {
            Self::Cylinder(cylinder) => cylinder.violation(pair, from_s, to_s),
            Self::WellClear(volume) => volume.violation(pair, from_s, to_s),
            Self::Uncertain(volume) => volume.violation(pair, from_s, to_s),
            Self::Advisory(advisory) => advisory.violation(pair, from_s, to_s),
        }
        .if_lasting()
    }

    /// Whether the volume is violated at some time between `from_s` and `to_s`.
    pub(crate) fn conflicts(&self, pair: &Pair, from_s: f64, to_s: f64) -> bool {
        if Rounding.same(from_s, to_s) {
            let loss = self.violation(pair, from_s, from_s + 1.0);
            return loss.is_conflict() && Rounding.same(loss.entry_s, from_s);
        }
        from_s <= to_s && self.violation(pair, from_s, to_s).is_conflict()
    }

    /// The well-clear part, if the volume has one.
    pub fn well_clear(&self) -> Option<&WellClear> {
        match self {
            Self::WellClear(volume) => Some(volume),
            Self::Uncertain(volume) => Some(&volume.volume),
            Self::Cylinder(_) | Self::Advisory(_) => None,
        }
    }
}
