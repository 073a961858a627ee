//! A scale painted with regions.

use crate::almost::Closeness::Edge;
use crate::almost::wrapped;
use crate::bands::span::BandSpan;
use crate::settings::Region;
use alloc::vec::Vec;

/// The side of a manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ManeuverSide {
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
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Colors {
    pub(crate) bands: Vec<Band>,
    /// Length of a circular scale, else 0.
    modulus: f64,
}

impl Colors {
    /// The scale of a span, free of conflicts from one value to another.
    pub(crate) fn of(span: &BandSpan, (min, max): (f64, f64)) -> Self {
        let (free, turn) = (Some(Region::None), span.modulus);
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
        Self {
            bands: bands.filter(has_length).collect(),
            modulus: turn,
        }
    }

    /// The searched scale of a span, near everywhere.
    pub(crate) fn closed(span: &BandSpan) -> Self {
        let mut colors = Self::of(span, span.searched);
        colors.paint(span.bounds.0, span.bounds.1, Region::Near);
        colors
    }

    /// Begins a part at a value, unless one begins or ends there.
    pub(crate) fn split(&mut self, at: f64) {
        let mut bands = self.bands.iter_mut().enumerate();
        let within = bands.find(|(_, band)| Edge.less(band.low, at) && Edge.less(at, band.high));
        if let Some((index, band)) = within {
            let upper = Band { low: at, ..*band };
            band.high = at;
            self.bands.insert(index + 1, upper);
        }
    }

    /// Paints from one value to another, on a circular scale around it, what is in reach and has a lesser color.
    pub(crate) fn paint(&mut self, low: f64, high: f64, color: Region) {
        if Edge.same(low, high) {
            return;
        }
        let (low, high) = (wrapped(low, self.modulus), wrapped(high, self.modulus));
        self.split(low);
        self.split(high);
        // The same value twice is once around the circle.
        let is_around = self.modulus > 0.0 && Edge.at_most(high, low);
        for band in &mut self.bands {
            let (from, to) = (Edge.at_most(low, band.low), Edge.at_most(band.high, high));
            let is_between = from && to || is_around && (from || to);
            if is_between && band.region.is_some_and(|region| region < color) {
                band.region = Some(color);
            }
        }
    }

    /// Paints what has a color on another scale.
    pub(crate) fn paint_where(&mut self, other: &Self, theirs: Region, color: Region) {
        for band in other.clone().merged().bands {
            if band.region == Some(theirs) {
                self.paint(band.low, band.high, color);
            }
        }
    }

    /// Whether no part with a length is free.
    pub(crate) fn is_closed(&self) -> bool {
        let mut parts = self
            .bands
            .iter()
            .filter(|band| Edge.less(band.low, band.high));
        parts.all(|band| band.region != Some(Region::None))
    }

    /// The scale for the display. In recovery a free interval is a resolution.
    pub(crate) fn shown(mut self, recovers: bool) -> Self {
        let way_out = if recovers {
            Region::Recovery
        } else {
            Region::None
        };
        let colors = self
            .bands
            .iter_mut()
            .filter_map(|band| band.region.as_mut());
        for color in colors.filter(|color| !color.is_conflict()) {
            *color = way_out;
        }
        self.merged()
    }

    /// The scale with neighbours of one color as one.
    fn merged(mut self) -> Self {
        self.bands.dedup_by(|next, band| {
            let is_same = next.region == band.region;
            if is_same {
                band.high = next.high;
            }
            is_same
        });
        self
    }

    /// Bands, with their indices, from one to one side, on a circular scale around it.
    pub(crate) fn walk(
        &self,
        from: usize,
        way: ManeuverSide,
    ) -> impl Iterator<Item = (usize, &Band)> {
        core::iter::successors(Some(from), move |at| self.beside(*at, way))
            .map_while(|at| Some((at, self.bands.get(at)?)))
            .take(self.bands.len())
    }

    /// The next band to one side, on a circular scale around it.
    fn beside(&self, index: usize, way: ManeuverSide) -> Option<usize> {
        let (is_around, count) = (self.modulus > 0.0, self.bands.len());
        match way {
            ManeuverSide::Low if index == 0 => is_around.then_some(count - 1),
            ManeuverSide::Low => Some(index - 1),
            ManeuverSide::High if index + 1 == count => is_around.then_some(0),
            ManeuverSide::High => Some(index + 1),
        }
    }

    /// The band of a value; on an edge the one with the lesser conflict.
    pub(crate) fn band_at(&self, value: f64) -> Option<usize> {
        let value = wrapped(value, self.modulus);
        let count = self.bands.len();
        let (index, band) = self.bands.iter().enumerate().find(|(index, band)| {
            let to_end = wrapped(band.high - value, self.modulus);
            let closes = index + 1 == count && Edge.same(to_end, 0.0);
            closes || Edge.at_most(band.low, value) && Edge.at_most(value, band.high)
        })?;
        let way = if band.region.is_some_and(|region| !region.is_conflict()) {
            return Some(index);
        } else if Edge.same(value, band.low) {
            ManeuverSide::Low
        } else if Edge.less(value, band.high) {
            return Some(index);
        } else {
            ManeuverSide::High
        };
        let other = self.beside(index, way)?;
        // A neighbour below the second band is only a fallback: the tables of the reference
        // show no region there, and the tables must agree.
        let is_milder = match (band.region, self.bands.get(other)?.region) {
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

    /// The conflict band at an index. On a circular scale the bands on both sides of north are one band if they have one
    /// region.
    pub(crate) fn conflict_band(&self, index: usize) -> Option<Band> {
        let (first, last) = (self.bands.first()?, self.bands.last()?);
        let mut band = *self.bands.get(index)?;
        if self.modulus > 0.0 && first.region == last.region {
            if index == 0 {
                band.low = last.low;
            } else if index + 1 == self.bands.len() {
                band.high = first.high;
            }
        }
        band.region.is_some_and(Region::is_conflict).then_some(band)
    }

    /// The region at a value; `None` out of reach.
    pub(crate) fn region_at(&self, value: f64) -> Option<Region> {
        self.bands.get(self.band_at(value)?)?.region
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aircraft::{Aircraft, AircraftId, AircraftState};
    use crate::monitor::Monitor;
    use crate::quantity::Quantity;
    use crate::schemes::f3442;
    use crate::settings::AlertSettings;
    use alloc::vec;
    use core::f64::consts::TAU;
    use glam::DVec3;

    fn free(greatest: f64, modulus: f64) -> Colors {
        let band = Band {
            low: 0.0,
            high: greatest,
            region: Some(Region::None),
        };
        let bands = vec![band];
        Colors { bands, modulus }
    }

    fn painted(colors: &Colors) -> Vec<(f64, f64)> {
        let bands = colors.clone().merged().bands.into_iter();
        let near = bands.filter(|band| band.region == Some(Region::Near));
        near.map(|band| (band.low, band.high)).collect()
    }

    #[test]
    fn parts_that_touch_are_one_and_parts_without_length_are_none() {
        let mut colors = free(10.0, 0.0);
        for (low, high) in [(5.0, 6.0), (1.0, 2.0), (2.000_1, 3.0), (8.0, 8.000_01)] {
            colors.paint(low, high, Region::Near);
        }
        assert_eq!(painted(&colors), [(1.0, 3.0), (5.0, 6.0)]);
        colors.paint(0.0, 9.0, Region::Near);
        assert_eq!(painted(&colors), [(0.0, 9.0)]);
        assert!(!colors.is_closed());
        colors.paint(8.0, 11.0, Region::Far);
        assert!(colors.is_closed() && painted(&colors) == [(0.0, 9.0)]);
    }

    #[test]
    fn a_part_goes_around_north_and_once_around_the_circle() {
        let mut colors = free(TAU, TAU);
        colors.paint(-0.5, 0.25, Region::Near);
        assert_eq!(painted(&colors), [(0.0, 0.25), (TAU - 0.5, TAU)]);
        colors.paint(2.0, 2.0 + TAU, Region::Near);
        assert!(colors.is_closed() && painted(&colors) == [(0.0, TAU)]);
    }

    #[test]
    fn what_one_scale_leaves_free_is_free_on_both() {
        let (mut all, mut theirs) = (free(10.0, 0.0), free(10.0, 0.0));
        all.paint(4.0, 6.0, Region::Near);
        theirs.paint(0.0, 10.0, Region::Near);
        for (low, high) in [(1.0, 2.0), (3.0, 7.0), (8.0, 9.0)] {
            theirs.paint(low, high, Region::Recovery);
        }
        all.paint_where(&theirs, Region::Near, Region::Near);
        let blocked = [(0.0, 1.0), (2.0, 3.0), (4.0, 6.0), (7.0, 8.0), (9.0, 10.0)];
        assert_eq!(painted(&all), blocked);
    }

    #[test]
    fn a_reach_that_ends_at_north_has_there_the_color_of_the_directions_before() {
        // The ownship flies north and turns left only; the intruder hovers.
        let colors_with = |intruder_m: DVec3| {
            let at = |id, position_m, velocity_mps| {
                let state = AircraftState {
                    position_m,
                    velocity_mps,
                };
                Aircraft::new(AircraftId(id), state)
            };
            let settings = AlertSettings {
                left_rad: 1.0,
                right_rad: 0.0,
                ..f3442()
            };
            let mut monitor = Monitor::new(settings);
            let ownship = at(0, DVec3::ZERO.with_z(100.0), DVec3::Y * 30.0);
            let intruder = at(1, intruder_m, DVec3::ZERO);
            monitor.step(0.0, &ownship, &[intruder]).unwrap();
            let bands = monitor.bands(Quantity::Direction).bands().to_vec();
            let regions = bands.iter().map(|band| band.region);
            regions.collect::<Vec<_>>()
        };
        let (free, far) = (Some(Region::None), Some(Region::Far));
        let ahead = colors_with(DVec3::new(0.0, 1800.0, 100.0));
        assert_eq!(ahead, [far, None, free, far]);
        let left = colors_with(DVec3::new(-1100.0, 1400.0, 100.0));
        assert_eq!(left, [free, None, Some(Region::Mid), far, free]);
    }
}
