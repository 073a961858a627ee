//! What is around an aircraft, for the certificate.

use super::hazard::Hazard;
use super::zones::{Fixed, Zones};
use crate::meter::Meter;
use crate::situation::Mission;

/// Most hazards of a decision.
pub const MAX_HAZARDS: usize = 128;

/// Obstructions that a unit of work looks at.
const LOOKED_AT: usize = 4;

/// Shows each of some obstructions until `visit` returns false. Returns whether none did, and the meter did not refuse it.
#[inline]
pub fn each<O>(all: &[O], meter: &Meter, visit: impl FnMut(&O) -> bool) -> bool {
    meter.take(all.len().div_ceil(LOOKED_AT).max(1)) && all.iter().all(visit)
}

/// What is around an aircraft.
#[derive(Debug, Clone, Copy)]
pub struct Around<'a> {
    /// The hazards one by one.
    pub rows: &'a [Hazard],
    /// What is fixed over the ground.
    pub fixed: Fixed<'a>,
}

impl<'a> Around<'a> {
    /// Hazards, the zones of a mission that are near, and its ground.
    pub const fn new(rows: &'a [Hazard], zones: &'a Zones, mission: &'a Mission<'a>) -> Self {
        let fixed = Fixed {
            zones,
            mission: mission.zones,
            ground: mission.ground,
        };
        Self { rows, fixed }
    }

    /// Hazards alone.
    pub const fn only(rows: &'a [Hazard]) -> Self {
        Self::new(rows, &Zones::NONE, &Mission::NONE)
    }
}
