//! The obstacles for the certificate, together.

use super::hazard::{Hazard, Obstruction};
use super::zones::{Fixed, Zones};
use crate::list::List;
use crate::meter::Meter;
use crate::situation::Mission;

/// Most hazards of a [`Hazards`].
pub const MAX_HAZARDS: usize = 128;

/// Hazards that a unit of work looks at.
const LOOKED_AT: usize = 4;

/// Obstacles of one kind, and what is fixed beside them.
pub trait HazardSet {
    /// One of them.
    type Each: Obstruction;

    /// Shows each until `visit` returns false. Returns whether none did, and the meter did not refuse it.
    fn each(&self, meter: &Meter, visit: impl FnMut(&Self::Each) -> bool) -> bool;

    /// What is fixed over the ground beside them.
    fn fixed(&self) -> Option<Fixed<'_>> {
        None
    }
}

impl HazardSet for [Hazard] {
    type Each = Hazard;

    #[inline]
    fn each(&self, meter: &Meter, visit: impl FnMut(&Hazard) -> bool) -> bool {
        meter.take(self.len().div_ceil(LOOKED_AT).max(1)) && self.iter().all(visit)
    }
}

impl HazardSet for Fixed<'_> {
    type Each = Self;

    #[inline]
    fn each(&self, _: &Meter, mut visit: impl FnMut(&Self) -> bool) -> bool {
        self.is_empty() || visit(self)
    }
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

impl HazardSet for Around<'_> {
    type Each = Hazard;

    #[inline]
    fn each(&self, meter: &Meter, visit: impl FnMut(&Hazard) -> bool) -> bool {
        self.rows.each(meter, visit)
    }

    fn fixed(&self) -> Option<Fixed<'_>> {
        Some(self.fixed)
    }
}
