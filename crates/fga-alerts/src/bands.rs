//! Bands: the values of a quantity at which a manoeuvre leads into a conflict.
//!
//! | part | question |
//! |---|---|
//! | [`span`] | which values can a manoeuvre reach? |
//! | [`path`] | where does the ownship fly meanwhile? |
//! | [`ways`] | along which lines does it reach the values of a span? |
//! | [`met`] | when does a line meet a volume of an intruder? |
//! | [`search`] | which steps meet a conflict? |
//! | [`free`] | which values are free of some aircraft? |
//! | [`level`] | which altitudes meet a conflict? |
//! | [`pool`] | what was computed already in this step? |
//! | [`intervals`] | which values are free? |
//! | [`colors`] | how do regions cover each other? |
//! | [`memory`] | which bands and which preferred side does the display show? |
//! | [`recovery`] | which way leads out where none stays clear? |
//! | [`guards`] | when does recovery change back from its distances to well clear? |
//! | [`steps`] | with which changes back is a step reached and free? |
//! | [`opening`] | between which times may it on one way? |
//! | [`shrinking`] | which distances of recovery need no search? |

pub(crate) mod colors;
mod free;
mod guards;
pub(crate) mod intervals;
mod level;
pub(crate) mod memory;
pub(crate) mod met;
mod opening;
pub(crate) mod path;
mod picture;
mod pool;
mod quantity;
pub(crate) mod recovered;
mod recovery;
pub(crate) mod search;
mod shrinking;
pub(crate) mod span;
mod steps;
mod ways;

pub(crate) use picture::{Contribution, Picture, Terminal};
pub use quantity::QuantityBands;

use crate::aircraft::State;
use crate::bands::colors::{Band, Colors, band_at};
use crate::bands::free::Kept;
use crate::bands::intervals::Intervals;
use crate::bands::memory::{Memory, Resolution, Step, Way};
use crate::bands::met::{Met, meetings, meetings_once};
use crate::bands::path::Range;
use crate::bands::pool::{WindowPool, level_key};
use crate::bands::recovered::{Recovery, WaysOut};
use crate::bands::search::Task;
use crate::bands::span::{Quantity, Span};
use crate::bands::ways::Ways;
use crate::settings::{Region, TerminalGuidance};
use crate::volume::Volume;
use alloc::vec::Vec;

impl QuantityBands {
    pub(crate) fn new(quantity: Quantity) -> Self {
        Self {
            quantity,
            bands: Vec::new(),
            peripheral: Default::default(),
            recovery: Recovery::NotNeeded,
            memory: Memory::default(),
            ways: Ways::default(),
            pool: WindowPool::default(),
            span: None,
        }
    }

    /// Which quantity.
    pub const fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// The bands in growing order; none where the current value lies outside of the scale.
    pub fn bands(&self) -> &[Band] {
        &self.bands
    }

    /// The region at a value; `None` outside of the bands.
    pub fn region_at(&self, value: f64) -> Option<Region> {
        self.span?;
        let index = band_at(&self.bands, value, self.quantity.modulus())?;
        self.bands.get(index)?.region
    }

    /// Aircraft (indices in the traffic) that are not in conflict but would be after a manoeuvre.
    pub fn peripheral(&self, region: Region) -> impl Iterator<Item = usize> + '_ {
        region
            .conflict_index()
            .and_then(|index| self.peripheral.get(index))
            .into_iter()
            .flatten()
            .map(|contribution| contribution.intruder)
    }

    /// The nearest resolution to one side.
    pub fn resolution(&self, way: Way) -> Resolution {
        self.memory.resolution(way)
    }

    /// The preferred side.
    pub fn preferred(&self) -> Way {
        self.memory.preferred()
    }

    /// The result of recovery.
    pub const fn recovery(&self) -> Recovery {
        self.recovery
    }

    /// Whether the current value lies on the scale.
    pub(crate) const fn is_computed(&self) -> bool {
        self.span.is_some()
    }

    pub(crate) fn forget(&mut self) {
        self.memory.forget();
    }

    /// Computes the bands of a step.
    pub(crate) fn update(&mut self, picture: &Picture) {
        self.bands.clear();
        self.recovery = Recovery::NotNeeded;
        for aircraft in &mut self.peripheral {
            aircraft.clear();
        }
        self.pool.clear();
        let settings = picture.settings;
        let ownship = &picture.ownship.state;
        self.span = Span::of(
            self.quantity,
            settings,
            ownship,
            picture.around(self.quantity),
        );
        let Some(span) = self.span else {
            return;
        };
        self.ways.fill(&Range {
            quantity: self.quantity,
            settings,
            ownship,
            span: &span,
            turns_at_once: picture.turns_at_once(),
        });
        // Regions that look further ahead come first: what is free for them is for others.
        for (index, region) in Region::CONFLICTS.into_iter().enumerate().rev() {
            if picture.paints(region) {
                self.find_peripheral(picture, index, region);
            }
        }
        let (colors, recovers) = self.paint(picture, &span);
        let step = Step {
            settings,
            time_s: picture.time_s,
            value: span.value,
            modulus: span.modulus,
            tolerance: settings.resolution_persistence.get(self.quantity),
            recovers,
            shrinkings: self.recovery.shrinkings(),
        };
        self.memory.take(colors, &step, &mut self.bands);
    }

    /// Finds aircraft that only a manoeuvre brings into conflict.
    fn find_peripheral(&mut self, picture: &Picture, index: usize, region: Region) {
        let settings = picture.settings;
        for (intruder, alerter_index) in picture.alerters.iter().enumerate() {
            let Some(alerter_index) = *alerter_index else {
                continue;
            };
            let Some(alerter) = settings.alerters.get(alerter_index) else {
                continue;
            };
            let (Some(number), Some(met)) = (alerter.level_for(region), picture.met(intruder))
            else {
                continue;
            };
            let Some(level) = alerter.level(number) else {
                continue;
            };
            let horizon_s = settings.lookahead_s.min(level.alerting_s);
            let pair = crate::aircraft::Pair {
                ownship: picture.ownship.state,
                intruder: *met.intruder,
                deviation: met.deviation,
            };
            let loss = level.volume.violation(&pair, 0.0, settings.lookahead_s);
            if loss.begins_before(horizon_s) {
                continue;
            }
            let task = Task {
                from_s: 0.0,
                until_s: horizon_s,
            };
            let key = level_key(settings, alerter_index, number);
            let lines = self.ways.lines();
            let place = self.pool.ensure(intruder, (&level.volume, key), lines);
            if self.pool.is_quiet(place, horizon_s) {
                continue;
            }
            let meetings = meetings(&met, &level.volume, lines, self.pool.windows(place));
            let search = self.ways.search(&meetings, None);
            let meets = search.any_conflict(&task);
            if !meets {
                self.pool.keep_quiet(place, horizon_s);
            }
            if meets && let Some(aircraft) = self.peripheral.get_mut(index) {
                aircraft.push(Contribution {
                    intruder,
                    alerter: alerter_index,
                    level: number,
                    horizon_s,
                });
            }
        }
    }

    /// The aircraft that paint a region: in conflict, or only after a manoeuvre.
    fn painting(&self, picture: &Picture, index: usize) -> Vec<Contribution> {
        let in_conflict = picture.conflicts.get(index).into_iter().flatten();
        let peripheral = self.peripheral.get(index).into_iter().flatten();
        in_conflict.chain(peripheral).copied().collect()
    }

    /// Whether the same aircraft paint two regions, by the same volumes within the same times: then the same values
    /// are free.
    fn paints_the_same(&self, picture: &Picture, one: usize, other: usize) -> bool {
        let settings = picture.settings;
        let volume = |contribution: &Contribution| {
            let level = contribution.level(settings);
            level.map(|level| &level.volume)
        };
        let (one, other) = (self.painting(picture, one), self.painting(picture, other));
        one.len() == other.len()
            && one.iter().zip(&other).all(|(one, other)| {
                one.intruder == other.intruder
                    && one.horizon_s == other.horizon_s
                    && volume(one) == volume(other)
            })
    }

    /// Paints the regions; returns whether it looked for recovery.
    fn paint(&mut self, picture: &Picture, span: &Span) -> (Colors, bool) {
        let settings = picture.settings;
        let corrective = settings.corrective_region.conflict_index().unwrap_or(0);
        let mut free: [Intervals; 3] = Default::default();
        let mut recovers = false;
        let mut last = 0;
        let mut looked_at = None;
        for (index, region) in Region::CONFLICTS.into_iter().enumerate() {
            last = index;
            if !picture.paints(region) {
                continue;
            }
            let known = looked_at.filter(|nearer| self.paints_the_same(picture, *nearer, index));
            let known = known.and_then(|nearer| free.get(nearer)).cloned();
            let (found, ways_out) = self.region(picture, span, (index, corrective), known);
            looked_at = Some(index);
            let is_full = found.is_empty();
            if let Some(free) = free.get_mut(index) {
                *free = found;
            }
            recovers = !matches!(ways_out, WaysOut::NotLookedFor);
            if recovers {
                last = corrective;
            }
            if let WaysOut::Other(ways_out) = ways_out
                && let Some(free) = free.get_mut(corrective)
            {
                *free = ways_out;
            }
            if is_full || recovers {
                break;
            }
        }
        let mut colors = Colors::of(span);
        for (region, free) in Region::CONFLICTS.into_iter().zip(&free).take(last + 1) {
            if picture.paints(region) {
                colors.paint_outside(free, region);
                if free.is_empty() {
                    break;
                }
            }
        }
        if recovers && let Some(ways_out) = free.get(last) {
            colors.paint_inside(ways_out, Region::Recovery);
        }
        (colors, recovers)
    }

    /// The free values of one region, perhaps known from another one, and the result of recovery.
    fn region(
        &mut self,
        picture: &Picture,
        span: &Span,
        (index, corrective): (usize, usize),
        known: Option<Intervals>,
    ) -> (Intervals, WaysOut) {
        let settings = picture.settings;
        let landing = picture.terminal == Terminal::Guided
            && settings.terminal.guidance == TerminalGuidance::Landing;
        if self.quantity == Quantity::Direction && landing && index <= corrective {
            return (Intervals::default(), WaysOut::NotLookedFor);
        }
        let painting = self.painting(picture, index);
        let free = known.unwrap_or_else(|| self.free_of(picture, span, &painting, Kept::Own));
        if !settings.recovers.get(self.quantity) {
            return (free, WaysOut::NotLookedFor);
        }
        if index <= corrective && free.is_empty() {
            let ways_out = self.recover(picture, span, corrective);
            return (free, WaysOut::Other(ways_out));
        }
        let instantaneous = self
            .quantity
            .is_instantaneous(settings, picture.turns_at_once());
        let in_conflict_now = picture
            .times
            .get(index)
            .is_some_and(|times| times.entry_s == 0.0);
        if instantaneous && index == corrective && in_conflict_now {
            self.recovery = Recovery::Found {
                time_s: 0.0,
                distance_m: settings.recovery_distance_m,
                height_m: settings.recovery_height_m,
                shrinkings: 0,
            };
            return (free, WaysOut::Same);
        }
        (free, WaysOut::NotLookedFor)
    }

    /// Whether every manoeuvre from a state leads into the volume.
    pub(crate) fn is_blocked(
        &mut self,
        picture: &Picture,
        ownship: &State,
        met: &Met,
        volume: &Volume,
    ) -> bool {
        let settings = picture.settings;
        let Some(base) = self.span else {
            return true;
        };
        let task = Task {
            from_s: 0.0,
            until_s: settings.lookahead_s,
        };
        let mut ways = Ways::default();
        ways.fill(&Range {
            quantity: self.quantity,
            settings,
            ownship,
            span: &base,
            turns_at_once: picture.turns_at_once(),
        });
        let meetings = meetings_once(met, volume, ways.lines());
        ways.search(&meetings, None).all_conflict(&task)
    }
}

/// Whether manoeuvres of a quantity within a spread lead into a volume before a time.
pub(crate) fn meets_within_spread(
    picture: &Picture,
    quantity: Quantity,
    spread: (f64, f64),
    met: &Met,
    volume: &Volume,
    until_s: f64,
) -> bool {
    let ownship = &picture.ownship.state;
    let Some(span) = Span::of(quantity, picture.settings, ownship, Some(spread)) else {
        return false;
    };
    let task = Task {
        from_s: 0.0,
        until_s,
    };
    let mut ways = Ways::default();
    ways.fill(&Range {
        quantity,
        settings: picture.settings,
        ownship,
        span: &span,
        turns_at_once: picture.turns_at_once(),
    });
    let meetings = meetings_once(met, volume, ways.lines());
    ways.search(&meetings, None).any_conflict(&task)
}
