//! Zones: airspace that the aircraft keeps out of, or within.
//!
//! A zone is an upright prism or cylinder, fixed over the ground. Up and down, its places between floor and ceiling count as one:
//! there a prism is a level polygon, and what flies straight moves straight above, within and below it. So a straight flight is
//! nearest to a prism at an edge, or where it begins, ends, or meets floor or ceiling over the polygon.

use crate::certificate::{Hazard, Line};
use crate::limit::Limit as _;
use crate::meter::Meter;
use crate::situation::ProtectedVolume;
use crate::{Vec2, Vec3};

/// At all altitudes, metres.
pub const ALL_HEIGHTS_M: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Edges are this thick, metres: more than rounding moves them, so that no gap lies between two.
pub(crate) const ROUNDED_M: f64 = 1e-6;

/// A flight that enters a zone counts as no deeper than this, metres.
const DEEPEST_M: f64 = 1e3;

/// Farther up or down than any flight, metres.
const HIGHEST_M: f64 = 1e6;

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
        let corners_m = match self.outline {
            Outline::Polygon(corners_m) => corners_m,
            Outline::Circle(..) => &[],
        };
        let next_m = corners_m.iter().skip(1).chain(corners_m.first());
        corners_m.iter().copied().zip(next_m.copied())
    }

    /// Its edges that may meet a box.
    fn edges_near(&self, near_m: Span) -> impl Iterator<Item = (Vec2, Vec2)> + use<'a> {
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

    /// The least distance of a line over the ground from it, metres, at most a given one; negative on the wrong side.
    pub fn nearest_m(&self, line: &Line, most_m: f64) -> f64 {
        if self.is_entered(line.from_m) {
            return -ROUNDED_M;
        }
        let least = self.least_on_line(|near_m| self.edges_near(near_m), line, most_m);
        least.map_or(most_m, |(least_m, _)| least_m)
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
    fn surrounds<E: Iterator<Item = (Vec2, Vec2)>>(
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

    /// The least distance of a line over the ground from it, metres, and the moment of that, seconds, if below one. It is negative if
    /// the line, which begins on the right side, enters it: then as far as the line ends beyond its edges.
    pub(crate) fn least_on_line<E: Iterator<Item = (Vec2, Vec2)>>(
        &self,
        edges: impl Fn(Span) -> E,
        line: &Line,
        below_m: f64,
    ) -> Option<(f64, f64)> {
        let (floor_m, ceiling_m) = self.heights_m;
        let (from_m, duration_s) = (line.from_m, line.duration_s);
        let at_m = |after_s| from_m + line.velocity_mps * after_s;
        let mut least = (below_m, 0.0);
        let mut note = |distance_m: f64, after_s| {
            if distance_m - ROUNDED_M < least.0 {
                least = (distance_m - ROUNDED_M, after_s);
            }
            least.0
        };
        match self.outline {
            // What is inside of a convex volume is nearest to its surface at an end of a line.
            _ if self.keep_in => {
                for after_s in [0.0, duration_s] {
                    let at_m = at_m(after_s);
                    note((at_m.z - floor_m).min(ceiling_m - at_m.z), after_s);
                    if let Outline::Circle(center_m, radius_m) = self.outline {
                        note(radius_m - at_m.truncate().distance(center_m), after_s);
                    }
                }
            }
            Outline::Circle(center_m, radius_m) => {
                let (floor_m, ceiling_m) = (floor_m.max(-HIGHEST_M), ceiling_m.min(HIGHEST_M));
                let volume = ProtectedVolume::Cylinder {
                    radius_m,
                    half_height_m: 0.5 * (ceiling_m - floor_m),
                };
                let center_m = center_m.extend(0.5 * (floor_m + ceiling_m));
                let cylinder = Hazard::exact(0, center_m, Vec3::ZERO, volume);
                let found = cylinder.least_on_line(line, below_m, &Meter::unlimited());
                found.map(|(distance_m, at_s)| note(distance_m, at_s - line.at_s));
            }
            Outline::Polygon(_) => {}
        }
        let (low_m, high_m) = if self.keep_in {
            ALL_HEIGHTS_M
        } else {
            self.heights_m
        };
        // Its height above and below all that counts as one.
        let flat_m = |after_s| {
            let at_m = at_m(after_s);
            at_m.with_z(at_m.z - at_m.z.limited(low_m, high_m))
        };
        let [low_s, high_s] = [low_m, high_m]
            .map(|z_m| ((z_m - from_m.z) / line.velocity_mps.z).limited(0.0, duration_s));
        let moments_s = [0.0, low_s.min(high_s), low_s.max(high_s), duration_s];
        let mut from_s = 0.0;
        for (index, to_s) in moments_s.into_iter().enumerate() {
            if to_s == from_s && (1..3).contains(&index) {
                continue;
            }
            let (from_m, to_m) = (flat_m(from_s), flat_m(to_s));
            let is_over = |most_m| to_m.z.abs() < most_m && self.surrounds(&edges, to_m.truncate());
            if (low_m, high_m) != ALL_HEIGHTS_M && is_over(note(f64::INFINITY, 0.0) + ROUNDED_M) {
                note(to_m.z.abs(), to_s);
            }
            if from_s < to_s || duration_s == 0.0 {
                let most_m = Vec2::splat(note(f64::INFINITY, 0.0).max(0.0) + ROUNDED_M);
                let (low_m, high_m) = span_m([from_m, to_m].map(Vec3::truncate));
                for edge_m in edges((low_m - most_m, high_m + most_m)) {
                    let (distance_m, share) = to_edge((from_m, to_m), edge_m, most_m.x);
                    note(distance_m, from_s + share * (to_s - from_s));
                }
            }
            from_s = to_s;
        }
        if least.0 < 0.0 && matches!(self.outline, Outline::Polygon(_)) {
            // The farther from its edges the line ends on the other side, the deeper it enters.
            let ends_m = [flat_m(0.0), flat_m(duration_s)];
            let [from, to] = ends_m.map(Vec3::truncate);
            let is_left = |a: Vec2, b: Vec2, at: Vec2| (b - a).perp_dot(at - a) > 0.0;
            let (mut crosses, mut deep_m) = (false, DEEPEST_M);
            for (a, b) in edges((Vec2::NEG_INFINITY, Vec2::INFINITY)) {
                crosses ^= is_left(from, to, a) != is_left(from, to, b)
                    && is_left(a, b, from) != is_left(a, b, to);
                deep_m = to_edge((ends_m[1], ends_m[1]), (a, b), deep_m)
                    .0
                    .min(deep_m);
            }
            // Of a zone with a floor or a ceiling all edges are known.
            let is_beyond = if (low_m, high_m) == ALL_HEIGHTS_M {
                crosses
            } else {
                ends_m[1].z == 0.0 && self.surrounds(&edges, to)
            };
            if is_beyond {
                least.0 = least.0.min(-deep_m);
            }
        }
        (least.0 < below_m).then_some((least.0, line.at_s + least.1))
    }
}

/// The least distance of what moves from one place to another one from a level edge at height zero, metres, if below one, and the
/// share of its way: that from the straight line through the edge where it is beside the edge then, or else from a corner.
#[inline]
fn to_edge((from_m, to_m): (Vec3, Vec3), (a, b): (Vec2, Vec2), below_m: f64) -> (f64, f64) {
    let (a, b) = (a.extend(0.0), b.extend(0.0));
    let (way, edge) = (to_m - from_m, b - a);
    let nearest = |offset: Vec3, way: Vec3| {
        let share = -offset.dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
        let share = share.limited(0.0, 1.0);
        ((offset + way * share).length(), share)
    };
    let along = |way: Vec3| way.dot(edge) / edge.length_squared().max(f64::MIN_POSITIVE);
    let (begins, goes_on) = (along(from_m - a), along(way));
    let beside = nearest(from_m - a - edge * begins, way - edge * goes_on);
    if beside.0 >= below_m || (0.0..=1.0).contains(&(begins + goes_on * beside.1)) {
        return beside;
    }
    let (of_a, of_b) = (nearest(from_m - a, way), nearest(from_m - b, way));
    if of_b.0 < of_a.0 { of_b } else { of_a }
}
