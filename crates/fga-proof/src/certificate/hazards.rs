//! The obstacles for the certificate, together.

use super::hazard::Hazard;
use super::zones::{Fixed, Zones};
use crate::list::List;
use crate::meter::Meter;
use crate::situation::Mission;

/// Most hazards of a [`Hazards`].
pub const MAX_HAZARDS: usize = 128;

/// Obstructions that a unit of work looks at.
const LOOKED_AT: usize = 4;

/// Shows each of some obstructions until `visit` returns false. Returns whether none did, and the meter did not refuse it.
#[inline]
pub fn each<O>(all: &[O], meter: &Meter, visit: impl FnMut(&O) -> bool) -> bool {
    meter.take(all.len().div_ceil(LOOKED_AT).max(1)) && all.iter().all(visit)
}

/// Hazards one by one.
pub type Rows = List<Hazard, MAX_HAZARDS>;

/// A set of hazards of fixed capacity.
#[derive(Debug, Clone)]
pub struct Hazards {
    rows: Rows,
    /// The zones, which are no rows: certificates of flights count these too.
    pub zones: Zones,
}

impl Default for Hazards {
    fn default() -> Self {
        Self::new()
    }
}

impl Hazards {
    /// No hazards.
    pub const fn new() -> Self {
        Self {
            rows: Rows::new(Hazard::NONE),
            zones: Zones::NONE,
        }
    }

    /// Forgets all hazards that are rows.
    pub const fn clear(&mut self) {
        self.rows.clear();
    }

    /// The hazards one by one.
    #[inline]
    pub fn rows(&self) -> &[Hazard] {
        &self.rows
    }

    /// The hazards, and the zones and the ground of a mission.
    pub fn over<'a>(&'a self, mission: &'a Mission<'a>) -> Around<'a> {
        Around {
            rows: &self.rows,
            fixed: self.zones.over(mission),
        }
    }

    /// Puts a hazard at an index: replaces one, or appends behind the last one. False for any other
    /// index.
    pub fn put(&mut self, place: usize, hazard: Hazard) -> bool {
        self.rows.put(place, hazard)
    }
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
    /// Hazards alone.
    pub const fn only(rows: &'a [Hazard]) -> Self {
        let fixed = Zones::NONE.over(&Mission::NONE);
        Self { rows, fixed }
    }
}
