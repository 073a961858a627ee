//! Bands: the values of a quantity at which a manoeuvre leads into a conflict.
//!
//! | part | question |
//! |---|---|
//! | [`span`] | which values can a manoeuvre reach? |
//! | [`path`], [`level`] | where does the ownship fly meanwhile? |
//! | [`ways`] | along which lines does it reach the values of a span, and which of them without conflict? |
//! | [`guard`] | when does a line meet a volume of an intruder? |
//! | [`search`] | which values are free of conflicts with some aircraft? |
//! | [`recovery`] | which way leads out where none stays clear? |
//! | [`colors`] | how do regions cover each other? |
//! | [`memory`] | which bands and which preferred side does the display show? |

pub(crate) mod colors;
mod guard;
mod level;
pub(crate) mod memory;
pub(crate) mod path;
pub(crate) mod recovery;
mod search;
pub(crate) mod span;
mod ways;

pub(crate) use search::meets_within_spread;

use crate::aircraft::Pair;
use crate::bands::colors::{Band, Colors, ManeuverSide};
use crate::bands::memory::{BandMemory, Resolution, Step};
use crate::bands::recovery::Recovery;
use crate::bands::search::BandSearch;
use crate::bands::span::BandSpan;
use crate::picture::{Contribution, Picture, Terminal};
use crate::quantity::Quantity;
use crate::settings::{Region, TerminalGuidance};
use crate::volume::Volume;
use alloc::vec::Vec;

/// The bands of one quantity.
#[derive(Debug, Clone)]
pub struct QuantityBands {
    quantity: Quantity,
    shown: Colors,
    peripheral: [Vec<Contribution>; 3],
    recovery: Recovery,
    memory: BandMemory,
    span: Option<BandSpan>,
}

impl QuantityBands {
    pub(crate) fn new(quantity: Quantity) -> Self {
        Self {
            quantity,
            shown: Colors::default(),
            peripheral: Default::default(),
            recovery: Recovery::NotNeeded,
            memory: BandMemory::default(),
            span: None,
        }
    }

    /// Which quantity.
    pub const fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// The bands in growing order; none where the current value lies outside of the scale.
    pub fn bands(&self) -> &[Band] {
        &self.shown.bands
    }

    /// The region at a value; `None` outside of the bands.
    pub fn region_at(&self, value: f64) -> Option<Region> {
        self.shown.region_at(value)
    }

    /// Aircraft (indices in the traffic) that are not in conflict but would be after a manoeuvre.
    pub fn peripheral(&self, region: Region) -> impl Iterator<Item = usize> + '_ {
        let aircraft = region.of(&self.peripheral).into_iter().flatten();
        aircraft.map(|contribution| contribution.intruder)
    }

    /// The nearest resolution to one side.
    pub fn resolution(&self, way: ManeuverSide) -> Resolution {
        self.memory.resolution(way)
    }

    /// The preferred side.
    pub fn preferred(&self) -> ManeuverSide {
        self.memory.preferred()
    }

    /// The result of recovery.
    pub const fn recovery(&self) -> Recovery {
        self.recovery
    }

    pub(crate) fn forget(&mut self) {
        self.memory.forget();
    }

    /// Computes the bands of a step.
    pub(crate) fn update(&mut self, picture: &Picture) {
        let memory = core::mem::take(&mut self.memory);
        *self = Self {
            memory,
            ..Self::new(self.quantity)
        };
        let (settings, ownship) = (&picture.settings, &picture.ownship.state);
        let around = picture.around(self.quantity);
        self.span = BandSpan::of(self.quantity, picture, around);
        let Some(span) = self.span else {
            return;
        };
        let search = BandSearch::new(picture, ownship, &span);
        for (aircraft, region) in self.peripheral.iter_mut().zip(Region::CONFLICTS) {
            *aircraft = search.peripheral(region);
        }
        let colors = self.paint(&search);
        let step = Step {
            settings,
            time_s: picture.time_s,
            span: &span,
            recovery: self.recovery,
        };
        self.shown = self.memory.take(colors, &step);
    }

    /// The aircraft that paint a region: in conflict, or only after a manoeuvre.
    fn painting(&self, picture: &Picture, index: usize) -> Vec<Contribution> {
        let in_conflict = picture.conflicts.get(index).into_iter().flatten();
        let peripheral = self.peripheral.get(index).into_iter().flatten();
        in_conflict.chain(peripheral).copied().collect()
    }

    /// Paints the regions, nearest first; where every value leads into one that is not beyond the corrective one, the
    /// values of recovery.
    fn paint(&mut self, search: &BandSearch) -> Colors {
        let BandSearch { picture, span, .. } = *search;
        let settings = &picture.settings;
        let corrective = settings.corrective_region.conflict_index().unwrap_or(0);
        let lands = self.quantity == Quantity::Direction
            && picture.terminal == Terminal::Guided
            && settings.terminal.guidance == TerminalGuidance::Landing;
        let recovers = settings.recovers.get(self.quantity);
        let mut colors = Colors::of(span, span.reach);
        for (index, region) in Region::CONFLICTS.into_iter().enumerate() {
            if !picture.paints(region) {
                continue;
            }
            if lands && index <= corrective {
                colors.paint_where(&Colors::closed(span), Region::Near, region);
                break;
            }
            let conflicts = search.conflicts(&self.painting(picture, index), None);
            let is_closed = conflicts.is_closed();
            if recovers && index <= corrective && is_closed {
                let (recovery, ways_out) = search.recover(&self.painting(picture, corrective));
                self.recovery = recovery;
                let painted = if index == corrective {
                    &ways_out
                } else {
                    &conflicts
                };
                colors.paint_where(painted, Region::Near, region);
                colors.paint_where(&ways_out, Region::None, Region::Recovery);
                break;
            }
            colors.paint_where(&conflicts, Region::Near, region);
            let lost = picture.times.get(index);
            let is_lost = lost.is_some_and(|times| times.entry_s == 0.0);
            if recovers && span.at_once && index == corrective && is_lost {
                self.recovery = Recovery::Found {
                    time_s: 0.0,
                    distance_m: settings.recovery_distance_m,
                    height_m: settings.recovery_height_m,
                    shrinkings: 0,
                };
                colors.paint_where(&conflicts, Region::None, Region::Recovery);
                break;
            }
            if is_closed {
                break;
            }
        }
        colors
    }

    /// Whether every manoeuvre of a pair's ownship leads into the volume; none begins at an altitude that is not
    /// searched.
    pub(crate) fn is_blocked(&self, picture: &Picture, pair: &Pair, volume: &Volume) -> bool {
        let is_searched = |span: &&BandSpan| {
            let (first, last) = span.reach;
            self.quantity != Quantity::Altitude
                || (first..=last).contains(&pair.ownship.position_m.z)
        };
        let span = self.span.as_ref().filter(is_searched);
        span.is_none_or(|span| {
            BandSearch::new(picture, &pair.ownship, span).all_conflict(pair, volume)
        })
    }
}
