//! A scale painted with regions.

use crate::almost::Closeness::Edge;
use crate::almost::wrapped;
use crate::bands::intervals::Intervals;
use crate::bands::span::BandSpan;
use crate::settings::Region;
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

/// A part of the scale with one color.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower edge, SI unit of the scale.
    pub low: f64,
    /// Upper edge, SI unit of the scale.
    pub high: f64,
    /// The region of a manoeuvre into it; `None` out of reach.
    pub region: Option<Region>,
}

/// The parts of the whole scale in increasing order; each begins where the one before ends.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Colors(pub(crate) Vec<Band>);

impl Colors {
    /// The scale of a span, free of conflicts.
    pub(crate) fn of(span: &BandSpan) -> Self {
        let (free, min, max, turn) = (Some(Region::None), span.min, span.max, span.modulus);
        let (least, greatest) = span.bounds;
        let is_empty = Edge.same(min, max) || Edge.same(wrapped(max - min, turn), 0.0);
        let parts = if turn > 0.0 && is_empty {
            [(least, greatest, free)].to_vec()
        } else if turn > 0.0 && min >= max {
            [(least, max, free), (max, min, None), (min, greatest, free)].to_vec()
        } else {
            [(least, min, None), (min, max, free), (max, greatest, None)].to_vec()
        };
        let bands = parts
            .into_iter()
            .map(|(low, high, region)| Band { low, high, region });
        let has_length = |band: &Band| band.region.is_some() || Edge.less(band.low, band.high);
        Self(bands.filter(has_length).collect())
    }

    /// Begins a part at a value, unless one begins or ends there.
    pub(crate) fn split(&mut self, at: f64) {
        let mut bands = self.0.iter_mut().enumerate();
        let within = bands.find(|(_, band)| Edge.less(band.low, at) && Edge.less(at, band.high));
        if let Some((index, band)) = within {
            let upper = Band { low: at, ..*band };
            band.high = at;
            self.0.insert(index + 1, upper);
        }
    }

    /// Paints what lies between two values, is in reach and has a lesser color.
    pub(crate) fn paint(&mut self, low: f64, high: f64, color: Region) {
        if Edge.at_most(high, low) {
            return;
        }
        self.split(low);
        self.split(high);
        for band in &mut self.0 {
            let is_between = Edge.at_most(low, band.low) && Edge.at_most(band.high, high);
            if is_between && band.region.is_some_and(|region| region < color) {
                band.region = Some(color);
            }
        }
    }

    /// Paints everything but the free intervals.
    pub(crate) fn paint_outside(&mut self, free: &Intervals, color: Region) {
        let mut from = f64::NEG_INFINITY;
        for [low, high] in free.iter() {
            self.paint(from, low, color);
            from = high;
        }
        self.paint(from, f64::INFINITY, color);
    }

    /// Paints every interval.
    pub(crate) fn paint_inside(&mut self, ways_out: &Intervals, color: Region) {
        for [low, high] in ways_out.iter() {
            self.paint(low, high, color);
        }
    }

    /// The bands, with neighbours of one color merged. In recovery a free interval is a resolution.
    pub(crate) fn bands(&self, recovers: bool) -> Vec<Band> {
        let way_out = if recovers {
            Region::Recovery
        } else {
            Region::None
        };
        let shown = |band: &Band| Band {
            region: (band.region).map(|color| if color.is_conflict() { color } else { way_out }),
            ..*band
        };
        let mut bands: Vec<Band> = self.0.iter().map(shown).collect();
        bands.dedup_by(|next, band| {
            let is_same = next.region == band.region;
            if is_same {
                band.high = next.high;
            }
            is_same
        });
        bands
    }
}

/// Indices of bands from one to one side, on a circular scale around it.
pub(crate) fn walk(
    from: usize,
    way: Way,
    count: usize,
    modulus: f64,
) -> impl Iterator<Item = usize> {
    core::iter::successors(Some(from), move |at| beside(*at, way, count, modulus)).take(count)
}

/// The next of a number of bands to one side, on a circular scale around it.
fn beside(index: usize, way: Way, count: usize, modulus: f64) -> Option<usize> {
    let around = modulus > 0.0;
    match way {
        Way::Low if index == 0 => around.then_some(count - 1),
        Way::Low => Some(index - 1),
        Way::High if index + 1 == count => around.then_some(0),
        Way::High => Some(index + 1),
    }
}

/// The band of a value; on an edge the one with the lesser conflict.
pub(crate) fn band_at(bands: &[Band], value: f64, modulus: f64) -> Option<usize> {
    let value = wrapped(value, modulus);
    let count = bands.len();
    let (index, band) = bands.iter().enumerate().find(|(index, band)| {
        let closes = index + 1 == count && Edge.same(wrapped(band.high - value, modulus), 0.0);
        closes || Edge.at_most(band.low, value) && Edge.at_most(value, band.high)
    })?;
    let way = if band.region.is_some_and(|region| !region.is_conflict()) {
        return Some(index);
    } else if Edge.same(value, band.low) {
        Way::Low
    } else if Edge.less(value, band.high) {
        return Some(index);
    } else {
        Way::High
    };
    let other = beside(index, way, count, modulus)?;
    // A neighbour below the second band is only a fallback: the tables of the reference
    // show no region there, and the tables must agree.
    let is_milder = match (band.region, bands.get(other)?.region) {
        (Some(_), None) => true,
        (Some(mine), Some(theirs)) => mine.severity() <= theirs.severity(),
        (None, _) => false,
    };
    Some(if other != 0 && is_milder {
        index
    } else {
        other
    })
}

/// The region at a value; `None` out of reach.
pub(crate) fn region_at(bands: &[Band], value: f64, modulus: f64) -> Option<Region> {
    bands.get(band_at(bands, value, modulus)?)?.region
}
