//! Zones: airspace that the aircraft keeps out of, or within.
//!
//! A zone is an upright prism or cylinder, fixed over the ground. All heights between floor and ceiling count as one height, so a prism
//! is a level polygon, and a straight flight stays straight above, within and below the polygon. A straight flight is therefore
//! nearest to a prism at an edge, or where the flight begins, ends, or meets floor or ceiling over the polygon.

use crate::limit::Limit as _;
use crate::{Vec2, Vec3};

/// At all altitudes, metres.
pub const ALL_HEIGHTS_M: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// The outline of a zone, seen from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outline<'a> {
    /// A circle: centre and positive radius, metres.
    Circle(Vec2, f64),
    /// A polygon by its corners, three or more, in order, either way round, metres east and north; the last is joined to the first.
    /// What an odd number of its edges surrounds is inside.
    Polygon(&'a [Vec2]),
}

/// A zone: what is above an outline between two altitudes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zone<'a> {
    /// Whether the aircraft keeps within it, not out of it.
    pub keep_in: bool,
    /// Its outline.
    pub outline: Outline<'a>,
    /// Its floor and the ceiling above that, metres; infinite without.
    pub heights_m: (f64, f64),
}

/// A box over the ground by its lowest and its highest corner, metres.
pub(crate) type Span = (Vec2, Vec2);

#[inline]
pub(crate) fn meet(one_m: &Span, other_m: &Span) -> bool {
    one_m.0.cmple(other_m.1).all() && one_m.1.cmpge(other_m.0).all()
}

/// The least box around places, metres.
pub(crate) fn span_m(places_m: impl IntoIterator<Item = Vec2>) -> Span {
    let nothing = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    let places_m = places_m.into_iter();
    places_m.fold(nothing, |(low, high), at| (low.min(at), high.max(at)))
}

impl<'a> Zone<'a> {
    /// Its edges; none of a circle.
    pub fn edges(&self) -> impl Iterator<Item = (Vec2, Vec2)> + use<'a> {
        self.edges_from(0)
    }

    /// Its edges from one on, by its index.
    pub(crate) fn edges_from(&self, first: usize) -> impl Iterator<Item = (Vec2, Vec2)> + use<'a> {
        let corners_m = match self.outline {
            Outline::Polygon(corners_m) => corners_m,
            Outline::Circle(..) => &[],
        };
        let from_m = corners_m.get(first..).unwrap_or(&[]).iter();
        let next_m = from_m.clone().skip(1).chain(corners_m.first());
        from_m.copied().zip(next_m.copied())
    }

    /// Its edges that may meet a box.
    pub(crate) fn edges_near(&self, near_m: Span) -> impl Iterator<Item = (Vec2, Vec2)> + use<'a> {
        self.edges()
            .filter(move |(a, b)| meet(&span_m([*a, *b]), &near_m))
    }

    /// Whether a place, metres, is on the wrong side.
    pub fn is_entered(&self, at_m: Vec3) -> bool {
        let (floor_m, ceiling_m) = self.heights_m;
        let is_between = (floor_m..=ceiling_m).contains(&at_m.z);
        (is_between && self.surrounds(|near_m| self.edges_near(near_m), at_m.truncate()))
            != self.keep_in
    }

    /// The nearest way out for an aircraft on the wrong side, metres: level, but for one that is only too low or too high.
    pub fn way_out_m(&self, at_m: Vec3) -> Vec3 {
        let at = at_m.truncate();
        if self.keep_in && self.surrounds(|near_m| self.edges_near(near_m), at) {
            let (floor_m, ceiling_m) = self.heights_m;
            return Vec3::Z * (at_m.z.limited(floor_m, ceiling_m) - at_m.z);
        }
        let way = match self.outline {
            Outline::Polygon(_) => self
                .edges()
                .map(|(a, b)| {
                    let share = (at - a).dot(b - a) / (b - a).length_squared();
                    a + (b - a) * share.limited(0.0, 1.0) - at
                })
                .min_by(|one, other| one.length_squared().total_cmp(&other.length_squared())),
            Outline::Circle(center_m, radius_m) => {
                Some(center_m + (at - center_m).normalize_or(Vec2::X) * radius_m - at)
            }
        };
        way.unwrap_or_default().extend(0.0)
    }

    /// Whether its outline surrounds a place, or an edge leads over it. `edges` gives those that meet a box, and perhaps others.
    pub(crate) fn surrounds<E: Iterator<Item = (Vec2, Vec2)>>(
        &self,
        edges: impl Fn(Span) -> E,
        at: Vec2,
    ) -> bool {
        if let Outline::Circle(center_m, radius_m) = self.outline {
            return at.distance(center_m) <= radius_m;
        }
        let mut is_inside = false;
        for (a, b) in edges((at, at.with_x(f64::INFINITY))) {
            let side = (b - a).perp_dot(at - a);
            if side == 0.0 && (at - a).dot(at - b) <= 0.0 {
                return true;
            }
            is_inside ^= (a.y > at.y) != (b.y > at.y) && (side > 0.0) == (b.y > a.y);
        }
        is_inside
    }
}
