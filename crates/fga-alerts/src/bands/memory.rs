//! The memory of bands: M of N, persistence of a conflict band, preferred resolution.

use crate::almost::Closeness::Edge;
use crate::almost::wrapped;
use crate::bands::colors::{Band, Border, Colors, Way, band_at, beside, is_left_of};
use crate::hysteresis::MOfN;
use crate::settings::{Region, Settings};
use alloc::vec::Vec;

/// The nearest resolution to one side.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Resolution {
    /// No conflict needs one.
    #[default]
    Unneeded,
    /// None exists on this side.
    Unavailable,
    /// The nearest value without conflict, SI unit of the scale.
    Value(f64),
}

impl Resolution {
    fn value(self) -> Option<f64> {
        match self {
            Self::Value(value) => Some(value),
            Self::Unneeded | Self::Unavailable => None,
        }
    }
}

/// A color on one side of a value, as it was seen; `None` out of reach.
type Seen = MOfN<Option<Region>>;

/// The colors seen on both sides of a value.
#[derive(Debug, Clone, PartialEq)]
struct Votes {
    at: f64,
    left: Seen,
    right: Seen,
}

/// The memory of the bands of one quantity.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Memory {
    last_s: Option<f64>,
    votes: Vec<Votes>,
    /// The conflict band in which the ownship flies.
    entered: Option<Band>,
    /// Start of the persistence of a conflict band.
    entered_since_s: Option<f64>,
    preferred: Way,
    preferred_since_s: Option<f64>,
    /// To the low and to the high side.
    sides: [Side; 2],
}

/// One side's resolution, present and kept.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Side {
    now: Resolution,
    kept: Resolution,
    /// Number of recovery's shrinkings when the kept one was found.
    kept_shrinkings: i32,
}

/// The input of a step to the memory.
pub(crate) struct Step<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) time_s: f64,
    pub(crate) value: f64,
    pub(crate) modulus: f64,
    /// Largest difference that keeps a preferred resolution.
    pub(crate) tolerance: f64,
    pub(crate) recovers: bool,
    pub(crate) shrinkings: i32,
}

impl Step<'_> {
    /// Whether a band leads into the corrective region's conflict or a nearer one.
    fn is_corrective(&self, band: &Band) -> bool {
        let least = self.settings.corrective_region.severity();
        band.region
            .is_some_and(|region| region.is_conflict() && region.severity() >= least)
    }

    /// Whether a band leads into no conflict or a lesser one.
    fn is_resolution(&self, band: &Band) -> bool {
        let corrective = self.settings.corrective_region.severity();
        band.region
            .is_some_and(|region| region.severity() < corrective)
    }

    /// Whether something that began at a time still persists.
    fn persists(&self, since_s: f64) -> bool {
        self.time_s - since_s < self.settings.hysteresis.persistence_s
    }
}

impl Memory {
    pub(crate) fn preferred(&self) -> Way {
        self.preferred
    }

    pub(crate) fn resolution(&self, way: Way) -> Resolution {
        let [low, high] = self.sides;
        match way {
            Way::Low => low.kept,
            Way::High => high.kept,
        }
    }

    /// Forgets everything but the last shown resolutions.
    pub(crate) fn forget(&mut self) {
        *self = Self {
            sides: self.sides,
            ..Self::default()
        };
    }

    /// Takes the painted line and writes the bands for the display.
    pub(crate) fn take(&mut self, mut colors: Colors, step: &Step, bands: &mut Vec<Band>) {
        let memory_s = step.settings.hysteresis.memory_s;
        let goes_on = self
            .last_s
            .is_some_and(|last_s| step.time_s > last_s && step.time_s - last_s <= memory_s);
        if !goes_on {
            self.forget();
        }
        self.last_s = Some(step.time_s);
        self.vote(&mut colors, step.settings);
        self.persist(&mut colors, step);
        colors.bands_into(step.recovers, bands);
        let index = band_at(bands, step.value, step.modulus);
        if self.entered_since_s.is_some() {
            self.entered = index.and_then(|index| conflict_band(bands, index, step.modulus));
            self.entered_since_s = self.entered_since_s.filter(|_| self.entered.is_some());
        }
        let ways = nearest_ways_out(bands, index, step);
        for (side, (now, _)) in self.sides.iter_mut().zip(ways) {
            side.now = now;
        }
        self.keep_resolutions(bands, ways.map(|(_, index)| index), step);
        self.prefer(step);
    }

    /// Lets M of the last N colors decide, value by value.
    fn vote(&mut self, colors: &mut Colors, settings: &Settings) {
        let hysteresis = &settings.hysteresis;
        let (m, n) = (hysteresis.agreeing, hysteresis.remembered);
        if hysteresis.memory_s <= 0.0 || m == 0 || m > n {
            return;
        }
        if self.votes.is_empty() {
            let votes = colors.0.iter().map(|edge| Votes {
                at: edge.at,
                left: Seen::new(m, n, edge.left, None),
                right: Seen::new(m, n, edge.right, None),
            });
            self.votes = votes.collect();
        }
        let (mut v, mut c) = (0, 0);
        while let (Some(votes), Some(edge)) = (self.votes.get_mut(v), colors.0.get_mut(c)) {
            if Edge.same(votes.at, edge.at) {
                edge.left = votes.left.take(edge.left);
                edge.right = votes.right.take(edge.right);
                v += 1;
                c += 1;
            } else if votes.at < edge.at {
                let (at, left, right) = (votes.at, edge.left, edge.left);
                colors.0.insert(c, Border { left, at, right });
            } else {
                let between = Votes {
                    at: edge.at,
                    left: votes.left.clone(),
                    right: votes.left.clone(),
                };
                self.votes.insert(v, between);
            }
        }
        // A value is no edge when both sides saw the same.
        let last = self.votes.len().saturating_sub(1);
        let mut indices = 0..;
        self.votes.retain(|votes| {
            let is_end = indices
                .next()
                .is_some_and(|index| index == 0 || index == last);
            is_end || !votes.left.has_seen_the_same(&votes.right)
        });
    }

    /// Keeps a conflict band for the persistence time after the ownship enters it.
    fn persist(&mut self, colors: &mut Colors, step: &Step) {
        let settings = step.settings;
        let persistence_s = settings.hysteresis.persistence_s;
        if settings.hysteresis.memory_s <= 0.0 || persistence_s <= 0.0 || !settings.bands_persist {
            return;
        }
        let Some(entered) = self.entered else {
            self.entered_since_s = Some(step.time_s);
            return;
        };
        let Some(now) = colors.at(step.value) else {
            return;
        };
        let since_s = self
            .entered_since_s
            .filter(|since_s| step.time_s >= *since_s);
        if since_s.is_some_and(|since_s| step.persists(since_s)) && Some(now) < entered.region {
            if let Some(region) = entered.region {
                colors.paint_around(entered.low, entered.high, step.modulus, region);
            }
        } else if now.is_conflict() && Some(now) > entered.region {
            self.entered_since_s = Some(step.time_s);
        }
    }

    /// Whether the memory of resolutions continues, and its start.
    fn remembered_since_s(&self, step: &Step) -> Option<f64> {
        let usable = step.settings.hysteresis.memory_s > 0.0 && step.tolerance > 0.0;
        self.preferred_since_s.filter(|_| usable)
    }

    /// Keeps the resolutions shown, while they are still ways out and the memory lasts.
    fn keep_resolutions(&mut self, bands: &[Band], from: [Option<usize>; 2], step: &Step) {
        let since_s = self.remembered_since_s(step);
        let since_s = since_s.filter(|since_s| step.time_s > *since_s);
        if since_s.is_none() {
            self.preferred_since_s = None;
        }
        let preferred = self.preferred;
        let is_kept = |(side, way, from): (&Side, Way, Option<usize>)| {
            let (now, kept) = (side.now.value()?, side.kept.value()?);
            let (is_ordered, distance) = match way {
                Way::High => (is_left_of(step.value, kept, step.modulus), kept - now),
                Way::Low => (is_left_of(kept, step.value, step.modulus), now - kept),
            };
            let stays = step.persists(since_s?)
                || side.kept_shrinkings < step.shrinkings
                || Edge.less(wrapped(distance, step.modulus), step.tolerance);
            let kept = band_at(bands, kept, step.modulus).filter(|_| is_ordered && stays)?;
            is_way_out(bands, preferred, (from?, kept), step).then_some(())
        };
        for ((side, way), from) in self.sides.iter_mut().zip(WAYS).zip(from) {
            if is_kept((side, way, from)).is_none() {
                side.kept = side.now;
                side.kept_shrinkings = step.shrinkings;
            }
        }
    }

    fn switch(&mut self, way: Way, step: &Step) {
        self.preferred = way;
        self.preferred_since_s = Some(step.time_s);
        for side in &mut self.sides {
            if step.shrinkings <= side.kept_shrinkings {
                side.kept = side.now;
            }
        }
    }

    /// Prefers the nearer resolution, unless the other one has been preferred for a short time or is about as near.
    fn prefer(&mut self, step: &Step) {
        let [low, high] = self.sides;
        let (low_value, high_value) = match (low.now.value(), high.now.value()) {
            (Some(low), Some(high)) => (low, high),
            (None, None) => {
                self.preferred_since_s = None;
                self.preferred = Way::Low;
                return;
            }
            (only_low, _) => {
                let only = if only_low.is_some() {
                    Way::Low
                } else {
                    Way::High
                };
                if self.preferred != only {
                    self.switch(only, step);
                }
                return;
            }
        };
        let up = wrapped(high_value - step.value, step.modulus);
        let down = wrapped(step.value - low_value, step.modulus);
        let nearer = if Edge.at_most(up, down) {
            Way::High
        } else {
            Way::Low
        };
        let since_s = self.remembered_since_s(step);
        let Some(since_s) = since_s.filter(|since_s| step.time_s >= *since_s) else {
            self.preferred = nearer;
            self.preferred_since_s = Some(step.time_s);
            return;
        };
        let is_close = (up - down).abs() < step.tolerance;
        let shrank_less = match self.preferred {
            Way::High => low.kept_shrinkings > high.kept_shrinkings,
            Way::Low => high.kept_shrinkings > low.kept_shrinkings,
        };
        if !step.persists(since_s) && !is_close && !shrank_less && nearer != self.preferred {
            self.switch(nearer, step);
        }
    }
}

const WAYS: [Way; 2] = [Way::Low, Way::High];

/// The conflict band at an index. On a circular scale the bands on both sides of north are one band if they have one region.
fn conflict_band(bands: &[Band], index: usize, modulus: f64) -> Option<Band> {
    let (first, last, mut band) = (bands.first()?, bands.last()?, *bands.get(index)?);
    if modulus > 0.0 && first.region == last.region {
        if index == 0 {
            band.low = last.low;
        } else if index + 1 == bands.len() {
            band.high = first.high;
        }
    }
    band.region.is_some_and(Region::is_conflict).then_some(band)
}

/// The nearest resolution to each side, and the band at which the walk there ends.
fn nearest_ways_out(
    bands: &[Band],
    here: Option<usize>,
    step: &Step,
) -> [(Resolution, Option<usize>); 2] {
    let start = here.filter(|here| {
        bands
            .get(*here)
            .is_some_and(|band| step.is_corrective(band))
    });
    let Some(start) = start else {
        return [(Resolution::Unneeded, here); 2];
    };
    WAYS.map(|way| {
        let end = first_way_out(bands, start, way, step);
        let band = end
            .and_then(|end| bands.get(end))
            .filter(|band| band.region.is_some());
        let now = match (band, way) {
            (None, _) => Resolution::Unavailable,
            (Some(band), Way::High) => Resolution::Value(band.low),
            (Some(_), Way::Low) if step.modulus > 0.0 && end == bands.len().checked_sub(1) => {
                Resolution::Value(0.0)
            }
            (Some(band), Way::Low) => Resolution::Value(band.high),
        };
        (now, end)
    })
}

/// The first band to one side that is not corrective; `None` where none is up to the end of the side.
fn first_way_out(bands: &[Band], start: usize, way: Way, step: &Step) -> Option<usize> {
    let mut at = start;
    loop {
        let band = bands.get(at)?;
        if !step.is_corrective(band) {
            return Some(at);
        }
        let goes_on = match way {
            Way::Low => is_left_of(band.low, step.value, step.modulus),
            Way::High => is_left_of(step.value, band.high, step.modulus),
        };
        at = beside(at, way, bands.len(), step.modulus).filter(|at| goes_on && *at != start)?;
    }
}

/// Whether every band from one to another is a resolution.
fn is_way_out(bands: &[Band], way: Way, (from, to): (usize, usize), step: &Step) -> bool {
    let mut at = Some(from);
    // Each step passes one band, so a walk around ends.
    for _ in 0..=bands.len() {
        let band = at.and_then(|at| bands.get(at));
        if !band.is_some_and(|band| step.is_resolution(band)) {
            return false;
        }
        if at == Some(to) {
            return true;
        }
        at = at.and_then(|at| beside(at, way, bands.len(), step.modulus));
    }
    false
}
