//! The convex parts of zones for the certificate.

use super::hazards::{Hazard, HazardSet, Line};
use crate::list::List;
use crate::meter::{COMPARED, Meter};
use crate::situation::ProtectedVolume;
use crate::zone::{Zone, nearest_of};
use crate::{Vec2, Vec3};

/// Most parts of all zones near the aircraft: those of one with the most corners, and some more.
pub const MAX_PARTS: usize = 272;

/// Parts that are left out together; they follow one another along an outline.
const GROUP: usize = 16;

/// Farther up or down than any flight, metres.
const HIGHEST_M: f64 = 1e6;

/// A part reaches this far beyond its corners, metres: more than rounding moves its edges, so that no gap lies between two.
pub(crate) const ROUNDED_M: f64 = 1e-6;

/// The places of a hazard's volume that count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// All.
    Whole,
    /// Those above and below a triangle, and within the volume's radius beside it: one corner is at the centre, the others at these
    /// places from it, metres.
    Triangle([Vec2; 2]),
    /// All that is outside of the volume, a cylinder.
    Outside,
}

impl Shape {
    /// A margin within is this, metres: no other aircraft's volume is entered to leave a zone sooner.
    pub(super) const INSIDE_M: f64 = -ROUNDED_M;

    /// The way from the nearest place of a triangle to an offset, metres.
    pub(super) fn beside([b, c]: [Vec2; 2], offset: Vec2) -> Vec2 {
        let a = Vec2::ZERO;
        let beside = |from, to| offset - nearest_of(from, to, offset);
        let first = beside(a, b);
        if b == c {
            return first;
        }
        let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).perp_dot(offset - from));
        if sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0) {
            return Vec2::ZERO;
        }
        let nearer = |one: Vec2, other: Vec2| {
            let is_nearer = other.length_squared() < one.length_squared();
            if is_nearer { other } else { one }
        };
        nearer(nearer(first, beside(b, c)), beside(c, a))
    }
}

/// A convex part of a zone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Part {
    corners_m: [Vec2; 3],
    /// It reaches this far beyond them, metres.
    radius_m: f64,
    /// Its floor and ceiling, metres.
    heights_m: (f64, f64),
    /// Whether it is all outside of that.
    is_outside: bool,
    /// This much is added to margins, metres.
    spare_m: f64,
}

impl Part {
    /// Nothing is inside of a cylinder without a radius: all is on the wrong side.
    pub(crate) const NOWHERE: Self = Self::new([Vec2::ZERO; 3], 0.0, (0.0, 0.0), true);

    pub(crate) const fn new(
        corners_m: [Vec2; 3],
        radius_m: f64,
        (floor_m, ceiling_m): (f64, f64),
        is_outside: bool,
    ) -> Self {
        let heights_m = (
            floor_m.max(-HIGHEST_M) - ROUNDED_M,
            ceiling_m.min(HIGHEST_M) + ROUNDED_M,
        );
        Self {
            corners_m,
            radius_m,
            heights_m,
            is_outside,
            spare_m: 0.0,
        }
    }

    /// The least box around it.
    #[inline]
    fn span_m(&self) -> Span {
        let ([a, b, c], beside) = (self.corners_m, Vec2::splat(self.radius_m));
        let (floor_m, ceiling_m) = self.heights_m;
        if self.is_outside {
            return (Vec3::NEG_INFINITY, Vec3::INFINITY);
        }
        (
            (a.min(b).min(c) - beside).extend(floor_m),
            (a.max(b).max(c) + beside).extend(ceiling_m),
        )
    }

    /// The least distance of a line over the ground from it, metres, at most a given one; negative inside.
    pub(crate) fn nearest_m(&self, line: &Line, most_m: f64) -> f64 {
        if !meet(&self.span_m(), &line.reach_m(most_m.max(0.0))) {
            return most_m;
        }
        let at_rest = self.hazard(Vec3::ZERO, f64::INFINITY);
        let least = at_rest.least_on_line(line, most_m, &Meter::unlimited());
        least.map_or(most_m, |(least_m, _)| least_m)
    }

    /// It as a hazard, in an air mass that moves with `wind_mps`, up to a moment, seconds.
    #[inline]
    fn hazard(&self, wind_mps: Vec3, until_s: f64) -> Hazard {
        let ([a, b, c], (floor_m, ceiling_m)) = (self.corners_m, self.heights_m);
        let volume = ProtectedVolume::Cylinder {
            radius_m: self.radius_m,
            half_height_m: 0.5 * (ceiling_m - floor_m),
        };
        let position_m = a.extend(0.5 * (floor_m + ceiling_m));
        let shape = if self.is_outside {
            Shape::Outside
        } else {
            Shape::Triangle([b - a, c - a])
        };
        Hazard {
            index: u32::MAX,
            window_s: (0.0, until_s),
            allowed_depth_m: self.spare_m,
            shape,
            ..Hazard::exact(u32::MAX, position_m, -wind_mps, volume)
        }
    }
}

/// A box by its lowest and its highest corner, metres.
type Span = (Vec3, Vec3);

#[inline]
fn meet(one_m: &Span, other_m: &Span) -> bool {
    one_m.0.cmple(other_m.1).all() && one_m.1.cmpge(other_m.0).all()
}

/// The parts of the zones near the aircraft.
#[derive(Debug, Clone)]
pub struct Parts {
    all: List<Part, MAX_PARTS>,
    /// Around each [`GROUP`] of them.
    spans_m: [Span; MAX_PARTS / GROUP],
    wind_mps: Vec3,
    until_s: f64,
}

impl Parts {
    pub(super) const NONE: Self = Self {
        all: List::new(Part::NOWHERE),
        spans_m: [(Vec3::ZERO, Vec3::ZERO); MAX_PARTS / GROUP],
        wind_mps: Vec3::ZERO,
        until_s: 0.0,
    };

    /// Their number.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// Forgets all, in a wind, metres per second; those that follow count up to a moment, seconds.
    pub const fn clear(&mut self, wind_mps: Vec3, until_s: f64) {
        self.all.clear();
        (self.wind_mps, self.until_s) = (wind_mps, until_s);
    }

    /// Adds the parts of a zone that are within a distance of the place where flights begin, metres; margins from them count this
    /// much more, metres. False where that place is on the wrong side, or there is no room for a part: then everything counts as
    /// entered, and nothing is proven.
    pub fn add(&mut self, zone: &Zone<'_>, (at_m, within_m): (Vec3, f64), spare_m: f64) -> bool {
        let near_m = Line::at(at_m).reach_m(within_m);
        let mut fits = !zone.is_entered(at_m);
        zone.each_part(|part| {
            let part = Part { spare_m, ..part };
            fits &= !meet(&part.span_m(), &near_m) || self.put(part).is_some();
            fits
        });
        if !fits {
            self.all.clear();
            self.put(Part::NOWHERE);
        }
        fits
    }

    fn put(&mut self, part: Part) -> Option<()> {
        let (index, span_m) = (self.all.push(part)?, part.span_m());
        let around_m = self.spans_m.get_mut(index / GROUP)?;
        *around_m = if index % GROUP == 0 {
            span_m
        } else {
            (around_m.0.min(span_m.0), around_m.1.max(span_m.1))
        };
        Some(())
    }
}

impl HazardSet for Parts {
    /// Shows them as hazards.
    #[inline]
    fn each_close(
        &self,
        line: &Line,
        below_m: f64,
        meter: &Meter,
        mut visit: impl FnMut(&Hazard) -> bool,
    ) -> bool {
        // Over the ground, where they are at rest.
        let over = Line {
            from_m: line.from_m + self.wind_mps * line.at_s,
            velocity_mps: line.velocity_mps + self.wind_mps,
            at_s: line.at_s,
            duration_s: line.duration_s.min(self.until_s - line.at_s),
        };
        if self.all.is_empty() || over.duration_s < 0.0 {
            return true;
        }
        let near_m = &over.reach_m(below_m.max(0.0));
        let mut is_shown = |part: &Part| {
            !meet(&part.span_m(), near_m) || visit(&part.hazard(self.wind_mps, self.until_s))
        };
        let groups = self.all.chunks(GROUP);
        meter.take(groups.len().div_ceil(COMPARED / 2))
            && self.spans_m.iter().zip(groups).all(|(span_m, parts)| {
                !meet(span_m, near_m)
                    || meter.take(GROUP.div_ceil(COMPARED / 2)) && parts.iter().all(&mut is_shown)
            })
    }
}
