//! A line of values painted with regions.

use crate::almost::Closeness::Edge;
use crate::almost::{Closeness, wrapped};
use crate::bands::intervals::Intervals;
use crate::bands::span::Span;
use crate::settings::Region;
use alloc::vec::Vec;

/// A value and the colors on both sides; `None` is out of reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Edge2 {
    pub(crate) left: Option<Region>,
    pub(crate) at: f64,
    pub(crate) right: Option<Region>,
}

/// A line of edges in increasing order; the color right of an edge is the color left of the next.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Colors(pub(crate) Vec<Edge2>);

fn order(color: Option<Region>) -> i8 {
    color.map_or(-1, Region::order)
}

fn edge(left: Option<Region>, at: f64, right: Option<Region>) -> Edge2 {
    Edge2 { left, at, right }
}

impl Colors {
    /// The line of a span, free of conflicts.
    pub(crate) fn of(span: &Span) -> Self {
        let free = Some(Region::None);
        let (least, greatest) = span.bounds;
        let mut edges = Vec::new();
        if span.modulus == 0.0 {
            if Edge.less(least, span.min) {
                edges.push(edge(None, least, None));
            }
            edges.push(edge(None, span.min, free));
            edges.push(edge(free, span.max, None));
            if Edge.less(span.max, greatest) {
                edges.push(edge(None, greatest, None));
            }
            return Self(edges);
        }
        let turn = span.modulus;
        if Edge.same(wrapped(span.max - span.min, turn), 0.0) {
            edges.push(edge(free, 0.0, free));
            edges.push(edge(free, turn, free));
        } else if Edge.same(span.min, span.max) {
            edges.push(edge(None, 0.0, free));
            edges.push(edge(free, turn, None));
        } else if span.min < span.max {
            if !Edge.same(0.0, span.min) {
                edges.push(edge(None, 0.0, None));
            }
            edges.push(edge(None, span.min, free));
            edges.push(edge(free, span.max, None));
            if !Edge.same(span.max, turn) {
                edges.push(edge(None, turn, None));
            }
        } else {
            edges.push(edge(free, 0.0, free));
            edges.push(edge(free, span.max, None));
            edges.push(edge(None, span.min, free));
            edges.push(edge(free, turn, free));
        }
        Self(edges)
    }

    fn ends(&self) -> Option<(f64, f64)> {
        Some((self.0.first()?.at, self.0.last()?.at))
    }

    /// Whether the part right of edge `index` is paintable.
    fn yields(&self, index: usize, color: Region) -> bool {
        self.0
            .get(index)
            .is_some_and(|edge| edge.right.is_some() && order(edge.right) < color.order())
    }

    /// Splits the part right of edge `index` at a value, unless it lies on the edge.
    fn split(&mut self, index: usize, at: f64) -> bool {
        let Some(before) = self.0.get(index).copied() else {
            return false;
        };
        if Edge.same(before.at, at) {
            return false;
        }
        self.0
            .insert(index + 1, edge(before.right, at, before.right));
        true
    }

    /// Paints the part right of edge `index`.
    fn color(&mut self, index: usize, color: Region) {
        if let Some(left) = self.0.get_mut(index) {
            left.right = Some(color);
        }
        if let Some(right) = self.0.get_mut(index + 1) {
            right.left = Some(color);
        }
    }

    /// Paints the paintable parts between two values.
    pub(crate) fn paint(&mut self, low: f64, high: f64, color: Region) {
        let Some((first, last)) = self.ends() else {
            return;
        };
        if Edge.at_most(high, low) || Edge.at_most(high, first) || Edge.at_most(last, low) {
            return;
        }
        let (low, high) = (low.max(first), high.min(last));
        let final_edge = self.0.len() - 1;
        // The edge at the lower end or the last one below it.
        let mut index = self
            .0
            .get(..final_edge)
            .unwrap_or_default()
            .iter()
            .rposition(|edge| Edge.at_most(edge.at, low))
            .unwrap_or(0);
        if self.yields(index, color) && self.split(index, low) {
            index += 1;
        }
        while self
            .0
            .get(index + 1)
            .is_some_and(|next| Edge.at_most(next.at, high))
        {
            if self.yields(index, color) {
                self.color(index, color);
            }
            index += 1;
        }
        if index + 1 < self.0.len() && self.yields(index, color) && self.split(index, high) {
            self.color(index, color);
        }
        self.close_the_circle();
    }

    /// On a circle the ends have the colors of each other.
    fn close_the_circle(&mut self) {
        let (Some(first), Some(last)) = (self.0.first().copied(), self.0.last().copied()) else {
            return;
        };
        if first.left.is_some()
            && let Some(edge) = self.0.first_mut()
        {
            edge.left = last.left;
        }
        if last.right.is_some()
            && let Some(edge) = self.0.last_mut()
        {
            edge.right = first.right;
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
        match (edge.left, edge.right) {
            (None, right) => right,
            (left, None) => left,
            (_, Some(right)) if !right.is_conflict() => Some(right),
            (Some(left), _) if !left.is_conflict() => Some(left),
            (Some(left), Some(right)) => Some(if left.severity() < right.severity() {
                left
            } else {
                right
            }),
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

/// The band of a value; on an edge the one with the lesser conflict.
pub(crate) fn band_at(bands: &[Band], value: f64, modulus: f64) -> Option<usize> {
    let value = wrapped(value, modulus);
    let last = bands.len().checked_sub(1)?;
    let is_free = |region: Option<Region>| region.is_some_and(|region| !region.is_conflict());
    // A neighbour below the second band is only a fallback: the tables of the reference
    // show no region there, and the tables must agree.
    let milder = |own: usize, other: Option<usize>| -> Option<usize> {
        let other = other?;
        let (mine, theirs) = (bands.get(own)?.region, bands.get(other)?.region);
        match (mine, theirs) {
            _ if other == 0 => Some(other),
            (Some(_), None) => Some(own),
            (Some(mine), Some(theirs)) if mine.severity() <= theirs.severity() => Some(own),
            _ => Some(other),
        }
    };
    for (index, band) in bands.iter().enumerate() {
        let within = (band.low < value || Edge.same(band.low, value))
            && (value < band.high || Edge.same(band.high, value));
        let closes = index == last && Edge.same(wrapped(band.high - value, modulus), 0.0);
        if !within && !closes {
            continue;
        }
        if is_free(band.region) {
            return Some(index);
        }
        if Edge.same(value, band.low) {
            let before = match index.checked_sub(1) {
                Some(before) => Some(before),
                None if modulus > 0.0 => Some(last),
                None => None,
            };
            return milder(index, before);
        }
        if Edge.less(value, band.high) {
            return Some(index);
        }
        let after = if index < last {
            Some(index + 1)
        } else if modulus > 0.0 {
            Some(0)
        } else {
            None
        };
        return milder(index, after);
    }
    None
}

/// Whether `a` lies left of (below) `b` or counts as the same.
pub(crate) fn is_left_of(a: f64, b: f64, modulus: f64) -> bool {
    if Closeness::Edge.same(a, b) {
        return true;
    }
    if modulus == 0.0 {
        return Edge.less(a, b);
    }
    Edge.less(wrapped(b - a, modulus), modulus / 2.0)
}
