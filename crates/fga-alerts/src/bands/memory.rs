//! The memory of bands: M of N, persistence of a conflict band, preferred resolution.

use crate::almost::Closeness::Edge;
use crate::almost::wrapped;
use crate::bands::colors::{Band, Colors, Edge2, band_at, is_left_of};
use crate::hysteresis::MOfN;
use crate::settings::{Region, Settings};
use alloc::vec::Vec;

/// The side of a manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Way {
    /// Left or down.
    #[default]
    Low,
    /// Right or up.
    High,
}

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

/// The colors seen on both sides of a value.
#[derive(Debug, Clone, PartialEq)]
struct Votes {
    at: f64,
    left: MOfN,
    right: MOfN,
}

/// The conflict band in which the ownship flies.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Entered {
    region: Region,
    low: f64,
    high: f64,
}

/// The memory of the bands of one quantity.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Memory {
    last_s: Option<f64>,
    votes: Vec<Votes>,
    entered: Option<Entered>,
    /// Start of the persistence of a conflict band.
    entered_since_s: Option<f64>,
    preferred: Way,
    preferred_since_s: Option<f64>,
    low: Side,
    high: Side,
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

fn order(color: Option<Region>) -> i8 {
    color.map_or(-1, Region::order)
}

impl Memory {
    pub(crate) fn preferred(&self) -> Way {
        self.preferred
    }

    pub(crate) fn resolution(&self, way: Way) -> Resolution {
        match way {
            Way::Low => self.low.kept,
            Way::High => self.high.kept,
        }
    }

    /// Forgets everything but the last shown resolutions.
    pub(crate) fn forget(&mut self) {
        *self = Self {
            low: self.low,
            high: self.high,
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
            self.enter(bands, index, step.modulus);
        }
        self.resolve(bands, index, step);
    }

    /// Lets M of the last N colors decide, value by value.
    fn vote(&mut self, colors: &mut Colors, settings: &Settings) {
        let hysteresis = &settings.hysteresis;
        let (m, n) = (hysteresis.agreeing, hysteresis.remembered);
        if hysteresis.memory_s <= 0.0 || m == 0 || m > n {
            return;
        }
        if self.votes.is_empty() {
            self.votes = colors
                .0
                .iter()
                .map(|edge| Votes {
                    at: edge.at,
                    left: MOfN::new(m, n, order(edge.left)),
                    right: MOfN::new(m, n, order(edge.right)),
                })
                .collect();
        }
        let (mut v, mut c) = (0, 0);
        while let (Some(votes), Some(edge)) = (self.votes.get_mut(v), colors.0.get_mut(c)) {
            if Edge.same(votes.at, edge.at) {
                edge.left = Region::from_order(votes.left.take(order(edge.left)));
                edge.right = Region::from_order(votes.right.take(order(edge.right)));
                v += 1;
                c += 1;
            } else if votes.at < edge.at {
                let (at, color) = (votes.at, edge.left);
                colors.0.insert(
                    c,
                    Edge2 {
                        left: color,
                        at,
                        right: color,
                    },
                );
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
        let mut index = 0;
        self.votes.retain(|votes| {
            let inner = index > 0 && index < last;
            index += 1;
            !(inner && votes.left.has_seen_the_same(&votes.right))
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
        let is_recent = self
            .entered_since_s
            .is_some_and(|since_s| step.time_s >= since_s && step.time_s - since_s < persistence_s);
        if is_recent && now.order() < entered.region.order() {
            colors.paint_around(entered.low, entered.high, step.modulus, entered.region);
        } else if now.is_conflict() && now.order() > entered.region.order() {
            self.entered_since_s = Some(step.time_s);
        }
    }

    /// Remembers the conflict band of the value.
    fn enter(&mut self, bands: &[Band], index: Option<usize>, modulus: f64) {
        let here = index.and_then(|index| Some((index, bands.get(index)?)));
        let found = here.and_then(|(index, band)| {
            let region = band.region.filter(|region| region.is_conflict())?;
            let (first, last) = (bands.first()?, bands.last()?);
            let joins = modulus > 0.0 && first.region == last.region;
            let at_start = modulus > 0.0 && index == 0;
            let at_end = modulus > 0.0 && index + 1 == bands.len();
            Some(Entered {
                region,
                low: if at_start && joins {
                    last.low
                } else {
                    band.low
                },
                high: if at_end && !at_start && joins {
                    first.high
                } else {
                    band.high
                },
            })
        });
        self.entered = found;
        if found.is_none() {
            self.entered_since_s = None;
        }
    }

    fn resolve(&mut self, bands: &[Band], index: Option<usize>, step: &Step) {
        let corrective = step.settings.corrective_region;
        let found = nearest_ways_out(bands, index, step, corrective);
        self.low.now = found.low;
        self.high.now = found.high;
        self.keep_resolutions(bands, &found, step);
        self.prefer(step);
    }

    /// Whether the memory of resolutions continues, and its start.
    fn remembered_since_s(&self, step: &Step) -> Option<f64> {
        let usable = step.settings.hysteresis.memory_s > 0.0 && step.tolerance > 0.0;
        self.preferred_since_s.filter(|_| usable)
    }

    fn keep_resolutions(&mut self, bands: &[Band], found: &NearestWays, step: &Step) {
        let since_s = self
            .remembered_since_s(step)
            .filter(|since_s| step.time_s > *since_s);
        let Some(since_s) = since_s else {
            for side in [&mut self.low, &mut self.high] {
                side.kept = side.now;
                side.kept_shrinkings = step.shrinkings;
            }
            self.preferred_since_s = None;
            return;
        };
        let is_recent = step.time_s - since_s < step.settings.hysteresis.persistence_s;
        let goes_up = self.preferred == Way::High;
        let corrective = step.settings.corrective_region;
        let sides = [
            (Way::High, &mut self.high, found.high_index),
            (Way::Low, &mut self.low, found.low_index),
        ];
        for (way, side, start) in sides {
            let kept_index = match (side.now.value(), side.kept.value()) {
                (Some(now), Some(kept)) => {
                    let (ordered, distance) = match way {
                        Way::High => (
                            is_left_of(step.value, kept, step.modulus),
                            wrapped(kept - now, step.modulus),
                        ),
                        Way::Low => (
                            is_left_of(kept, step.value, step.modulus),
                            wrapped(now - kept, step.modulus),
                        ),
                    };
                    let stays = is_recent
                        || side.kept_shrinkings < step.shrinkings
                        || Edge.less(distance, step.tolerance);
                    if ordered && stays {
                        band_at(bands, kept, step.modulus)
                    } else {
                        None
                    }
                }
                _ => None,
            };
            let still_out = kept_index.is_some_and(|kept| {
                is_way_out_from_to(bands, corrective, goes_up, start, kept, step.modulus)
            });
            if !still_out {
                side.kept = side.now;
                side.kept_shrinkings = step.shrinkings;
            }
        }
    }

    fn switch(&mut self, way: Way, step: &Step) {
        self.preferred = way;
        self.preferred_since_s = Some(step.time_s);
        for side in [&mut self.low, &mut self.high] {
            if step.shrinkings <= side.kept_shrinkings {
                side.kept = side.now;
            }
        }
    }

    fn prefer(&mut self, step: &Step) {
        match (self.low.now.value(), self.high.now.value()) {
            (None, None) => {
                self.preferred_since_s = None;
                self.preferred = Way::Low;
            }
            (Some(_), None) => {
                if self.preferred == Way::High {
                    self.switch(Way::Low, step);
                }
            }
            (None, Some(_)) => {
                if self.preferred == Way::Low {
                    self.switch(Way::High, step);
                }
            }
            (Some(low), Some(high)) => {
                let up = wrapped(high - step.value, step.modulus);
                let down = wrapped(step.value - low, step.modulus);
                let nearer = if Edge.at_most(up, down) {
                    Way::High
                } else {
                    Way::Low
                };
                let since_s = self
                    .remembered_since_s(step)
                    .filter(|since_s| step.time_s >= *since_s);
                let Some(since_s) = since_s else {
                    self.preferred = nearer;
                    self.preferred_since_s = Some(step.time_s);
                    return;
                };
                let is_recent = step.time_s - since_s < step.settings.hysteresis.persistence_s;
                let is_close = (up - down).abs() < step.tolerance;
                let shrank_less = match self.preferred {
                    Way::High => self.low.kept_shrinkings > self.high.kept_shrinkings,
                    Way::Low => self.high.kept_shrinkings > self.low.kept_shrinkings,
                };
                if !is_recent && !is_close && !shrank_less && nearer != self.preferred {
                    self.switch(nearer, step);
                }
            }
        }
    }
}

/// The nearest resolutions and their bands.
struct NearestWays {
    low: Resolution,
    high: Resolution,
    low_index: Option<usize>,
    high_index: Option<usize>,
}

fn is_corrective(region: Option<Region>, corrective: Region) -> bool {
    region.is_some_and(|region| region.is_conflict() && region.severity() >= corrective.severity())
}

fn nearest_ways_out(
    bands: &[Band],
    index: Option<usize>,
    step: &Step,
    corrective: Region,
) -> NearestWays {
    let mut ways = NearestWays {
        low: Resolution::Unneeded,
        high: Resolution::Unneeded,
        low_index: index,
        high_index: index,
    };
    let here = index.and_then(|index| bands.get(index));
    let (Some(start), Some(here)) = (index, here) else {
        return ways;
    };
    if !is_corrective(here.region, corrective) {
        return ways;
    }
    let last = bands.len() - 1;
    let around = step.modulus > 0.0;
    let walk = |way: Way| -> Option<usize> {
        let mut at = start;
        loop {
            let band = bands.get(at)?;
            if !is_corrective(band.region, corrective) {
                return Some(at);
            }
            let goes_on = match way {
                Way::Low => is_left_of(band.low, step.value, step.modulus),
                Way::High => is_left_of(step.value, band.high, step.modulus),
            };
            if !goes_on {
                return None;
            }
            at = match way {
                Way::Low if at == 0 && around => last,
                Way::Low => at.checked_sub(1)?,
                Way::High if at == last && around => 0,
                Way::High => at + 1,
            };
            if at == start {
                return None;
            }
        }
    };
    ways.low_index = walk(Way::Low);
    ways.high_index = walk(Way::High);
    let flyable = |index: Option<usize>| {
        let index = index?;
        let band = bands.get(index)?;
        band.region.map(|_| (index, *band))
    };
    ways.low = match flyable(ways.low_index) {
        Some((index, _)) if index == last && around => Resolution::Value(0.0),
        Some((_, band)) => Resolution::Value(band.high),
        None => Resolution::Unavailable,
    };
    ways.high = match flyable(ways.high_index) {
        Some((_, band)) => Resolution::Value(band.low),
        None => Resolution::Unavailable,
    };
    ways
}

/// Whether every band from one to another is a resolution.
fn is_way_out_from_to(
    bands: &[Band],
    corrective: Region,
    goes_up: bool,
    from: Option<usize>,
    to: usize,
    modulus: f64,
) -> bool {
    let is_out = |band: &Band| {
        band.region
            .is_some_and(|region| region.severity() < corrective.severity())
    };
    let Some(mut at) = from else {
        return false;
    };
    // Each step passes one band, so a walk around ends.
    for _ in 0..=bands.len() {
        if at == to || !bands.get(at).is_some_and(is_out) {
            break;
        }
        at = if goes_up {
            if at + 1 == bands.len() && modulus > 0.0 {
                0
            } else {
                at + 1
            }
        } else if at == 0 {
            if modulus > 0.0 {
                bands.len() - 1
            } else {
                return false;
            }
        } else {
            at - 1
        };
    }
    bands.get(at).is_some_and(is_out)
}
