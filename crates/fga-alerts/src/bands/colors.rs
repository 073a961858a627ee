//! A line of values painted with regions.

use crate::almost::Closeness::Edge;
use crate::almost::wrapped;
use crate::bands::intervals::Intervals;
use crate::bands::span::Span;
use crate::settings::Region;
use alloc::vec::Vec;

/// A value and the colors on both sides; `None` is out of reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Border {
    pub(crate) left: Option<Region>,
    pub(crate) at: f64,
    pub(crate) right: Option<Region>,
}

/// A line of edges in increasing order; the color right of an edge is the color left of the next.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Colors(pub(crate) Vec<Border>);

/// The side of a manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Way {
    /// Left or down.
    #[default]
    Low,
    /// Right or up.
    High,
}

impl Colors {
    /// The line of a span, free of conflicts.
    pub(crate) fn of(span: &Span) -> Self {
        let (free, min, max) = (Some(Region::None), span.min, span.max);
        let ((least, greatest), turn) = (span.bounds, span.modulus);
        let is_whole = turn > 0.0 && Edge.same(wrapped(max - min, turn), 0.0);
        // What lies beyond the ends, and the values from which on a color holds.
        let (outside, parts) = if is_whole {
            (free, [(least, free), (greatest, free)].to_vec())
        } else if turn > 0.0 && Edge.same(min, max) {
            (None, [(least, free), (greatest, None)].to_vec())
        } else if turn > 0.0 && min >= max {
            let (first, last) = ((least, free), (greatest, free));
            (free, [first, (max, None), (min, free), last].to_vec())
        } else {
            let (first, last) = ((least, None), (greatest, None));
            (None, [first, (min, free), (max, None), last].to_vec())
        };
        let mut edges = Vec::new();
        let mut left = outside;
        for (index, &(at, right)) in parts.iter().enumerate() {
            // An end of the scale that counts as the reachable one is no edge of its own.
            let is_beyond = if index == 0 {
                Edge.less(at, min)
            } else {
                Edge.less(max, at)
            };
            if left.is_some() || right.is_some() || is_beyond {
                edges.push(Border { left, at, right });
            }
            left = right;
        }
        Self(edges)
    }

    fn ends(&self) -> Option<(f64, f64)> {
        Some((self.0.first()?.at, self.0.last()?.at))
    }

    /// Whether the part right of edge `index` is paintable.
    fn yields(&self, index: usize, color: Region) -> bool {
        let right = self.0.get(index).and_then(|edge| edge.right);
        right.is_some_and(|right| right < color)
    }

    /// Splits the part at a value where it is paintable and no edge lies there; returns the edge there or below.
    fn split(&mut self, at: f64, color: Region) -> usize {
        let edges = self.0.iter();
        let below = edges.take_while(|edge| Edge.at_most(edge.at, at)).count();
        let index = below.saturating_sub(1);
        let edge = self.0.get(index).filter(|edge| !Edge.same(edge.at, at));
        let Some(edge) = edge.filter(|_| self.yields(index, color)) else {
            return index;
        };
        let (left, right) = (edge.right, edge.right);
        self.0.insert(index + 1, Border { left, at, right });
        index + 1
    }

    /// Paints the paintable parts between two values.
    pub(crate) fn paint(&mut self, low: f64, high: f64, color: Region) {
        let Some((first, last)) = self.ends() else {
            return;
        };
        if Edge.at_most(high, low) || Edge.at_most(high, first) || Edge.at_most(last, low) {
            return;
        }
        let from = self.split(low.max(first), color);
        for index in from..self.split(high.min(last), color) {
            if self.yields(index, color)
                && let Some([left, right]) = self.0.get_mut(index..index + 2)
            {
                left.right = Some(color);
                right.left = Some(color);
            }
        }
        // On a circle the ends have the colors of each other.
        if let [first, .., last] = self.0.as_mut_slice() {
            if first.left.is_some() {
                first.left = last.left;
            }
            if last.right.is_some() {
                last.right = first.right;
            }
        }
    }

    /// Paints between two values, around the circle if the lower one is not below the upper one.
    pub(crate) fn paint_around(&mut self, low: f64, high: f64, modulus: f64, color: Region) {
        if low < high {
            self.paint(low, high, color);
        } else if modulus > 0.0 {
            self.paint(0.0, high, color);
            self.paint(low, modulus, color);
        }
    }

    /// Paints everything but the free intervals.
    pub(crate) fn paint_outside(&mut self, free: &Intervals, color: Region) {
        let Some((mut from, to)) = self.ends() else {
            return;
        };
        for [low, high] in free.iter() {
            self.paint(from, low, color);
            from = high;
        }
        self.paint(from, to, color);
    }

    /// Paints every interval.
    pub(crate) fn paint_inside(&mut self, ways_out: &Intervals, color: Region) {
        for [low, high] in ways_out.iter() {
            self.paint(low, high, color);
        }
    }

    /// The color at a value; on an edge the lesser conflict.
    pub(crate) fn at(&self, value: f64) -> Option<Region> {
        let edge = self.0.iter().find(|edge| !Edge.less(edge.at, value))?;
        if !Edge.same(edge.at, value) {
            return edge.left;
        }
        let severity = |color: Option<Region>| color.map(Region::severity);
        match (severity(edge.left), severity(edge.right)) {
            (Some(left), Some(right)) if left < right => edge.left,
            (_, Some(_)) => edge.right,
            (_, None) => edge.left,
        }
    }
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

impl Colors {
    /// The bands, with neighbours of one color merged. In recovery a free interval is a resolution.
    pub(crate) fn bands_into(&self, recovers: bool, bands: &mut Vec<Band>) {
        bands.clear();
        let shown = |color: Option<Region>| match color {
            Some(Region::None | Region::Recovery) if recovers => Some(Region::Recovery),
            Some(Region::None | Region::Recovery) => Some(Region::None),
            other => other,
        };
        let Some(first) = self.0.first() else {
            return;
        };
        let mut low = first.at;
        let last = self.0.len() - 1;
        for (index, edge) in self.0.iter().enumerate().skip(1) {
            if shown(edge.left) != shown(edge.right) || index == last {
                bands.push(Band {
                    low,
                    high: edge.at,
                    region: shown(edge.left),
                });
                low = edge.at;
            }
        }
    }
}

/// The next of a number of bands to one side, on a circular scale around it.
pub(crate) fn beside(index: usize, way: Way, count: usize, modulus: f64) -> Option<usize> {
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

/// Whether `a` lies left of (below) `b` or counts as the same.
pub(crate) fn is_left_of(a: f64, b: f64, modulus: f64) -> bool {
    if modulus == 0.0 {
        return Edge.at_most(a, b);
    }
    Edge.same(a, b) || Edge.less(wrapped(b - a, modulus), modulus / 2.0)
}
