//! Zones: airspace that the aircraft keeps out of, or within.
//!
//! A zone is an upright prism or cylinder, fixed over the ground. A flight is as far from it as from the nearest of its convex
//! parts: the triangles of a polygon that is kept out of between two altitudes, the walls of any other one.

use crate::certificate::{Line, Part, ROUNDED_M};
use crate::limit::Limit as _;
use crate::list::List;
use crate::{Vec2, Vec3};

/// Most corners of a polygon.
pub const MAX_CORNERS: usize = 256;

/// A polygon, and the triangles that it consists of; without triangles, by its edges alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    corners_m: List<Vec2, MAX_CORNERS>,
    triangles: List<[u8; 3], { MAX_CORNERS - 2 }>,
}

impl Polygon {
    /// A polygon by its corners, 3 to [`MAX_CORNERS`], in order, either way round, metres east and north; the last is joined to
    /// the first. Its edges must not meet but in common corners: the caller looks. `None` where no triangles are found.
    pub fn new(corners_m: &[Vec2]) -> Option<Self> {
        let mut polygon = Self::by_edges(corners_m)?;
        polygon.cut()?;
        Some(polygon)
    }

    /// The same for a zone that is kept within, or has neither floor nor ceiling: its edges may meet, and what an odd number of
    /// them surrounds is inside. Near any other zone with it nothing is proven.
    pub fn by_edges(corners_m: &[Vec2]) -> Option<Self> {
        let mut polygon = Self {
            corners_m: List::new(Vec2::ZERO),
            triangles: List::new([0; 3]),
        };
        let mut corners_m = corners_m.iter();
        let fits = corners_m.all(|corner_m| polygon.corners_m.push(*corner_m).is_some());
        (fits && polygon.corners_m.len() >= 3).then_some(polygon)
    }

    /// The corners, metres east and north.
    pub fn corners_m(&self) -> &[Vec2] {
        &self.corners_m
    }

    /// Cuts off one corner after the other whose triangle is inside and holds no other corner.
    #[expect(clippy::cast_possible_truncation, reason = "at most 256 corners")]
    fn cut(&mut self) -> Option<()> {
        let mut ring: [u8; MAX_CORNERS] = core::array::from_fn(|index| index as u8);
        let first = *self.corners_m().first()?;
        let twice_m2: f64 = edges(self.corners_m())
            .map(|(a, b)| (a - first).perp_dot(b - first))
            .sum();
        let (mut left, mut at, mut missed) = (self.corners_m.len(), 0, 0);
        for _ in 2..self.corners_m.len() {
            let triangle = loop {
                let index = |ahead: usize| ring.get((at + ahead) % left).copied();
                let triangle = [index(0)?, index(1)?, index(2)?];
                if left == 3 || self.is_ear(triangle, ring.get(..left)?, twice_m2.signum()) {
                    break triangle;
                }
                (at, missed) = ((at + 1) % left, missed + 1);
                (missed <= left).then_some(())?;
            };
            self.triangles.push(triangle)?;
            let gone = (at + 1) % left;
            ring.copy_within(gone + 1..left, gone);
            left -= 1;
            (at, missed) = ((at + usize::from(gone > at)) % left, 0);
        }
        Some(())
    }

    /// Whether a triangle of corners may be cut off a ring that goes round to a side.
    fn is_ear(&self, triangle: [u8; 3], ring: &[u8], side: f64) -> bool {
        let [a, b, c] = places_m(self.corners_m(), triangle);
        let turn = side * (b - a).perp_dot(c - b);
        let holds = |at: Vec2| {
            let edges = [(a, b), (b, c), (c, a)];
            edges
                .iter()
                .all(|(from, to)| side * (*to - *from).perp_dot(at - *from) >= 0.0)
        };
        let mut others = ring.iter().filter(|corner| !triangle.contains(corner));
        // A corner on the straight line between its neighbours has an empty triangle.
        turn == 0.0
            || turn > 0.0
                && !others.any(|corner| holds(places_m(self.corners_m(), [*corner; 3])[0]))
    }

    /// Whether a place is inside or on an edge.
    pub fn contains(&self, at: Vec2) -> bool {
        let mut is_inside = false;
        for (a, b) in edges(self.corners_m()) {
            let side = (b - a).perp_dot(at - a);
            if side == 0.0 && (at - a).dot(at - b) <= 0.0 {
                return true;
            }
            is_inside ^= (a.y > at.y) != (b.y > at.y) && (side > 0.0) == (b.y > a.y);
        }
        is_inside
    }
}

/// The outline of a zone, seen from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outline<'a> {
    /// A polygon.
    Polygon(&'a Polygon),
    /// A circle: centre and radius, metres.
    Circle(Vec2, f64),
}

/// A zone: what is above an outline between two altitudes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zone<'a> {
    /// Whether the aircraft keeps within it, not out of it.
    pub keep_in: bool,
    /// Its outline; a circle has a positive radius.
    pub outline: Outline<'a>,
    /// Its floor and the ceiling above that, metres; infinite without.
    pub heights_m: (f64, f64),
}

impl Zone<'_> {
    /// Number of its parts, about.
    pub fn size(&self) -> usize {
        match self.outline {
            Outline::Polygon(polygon) => polygon.corners_m.len(),
            Outline::Circle(..) => 1,
        }
    }

    fn is_inside(&self, at: Vec2) -> bool {
        match self.outline {
            Outline::Polygon(polygon) => polygon.contains(at),
            Outline::Circle(center_m, radius_m) => (at - center_m).length() <= radius_m,
        }
    }

    /// Whether a place, metres, is on the wrong side.
    pub fn is_entered(&self, at_m: Vec3) -> bool {
        let (floor_m, ceiling_m) = self.heights_m;
        let is_between = (floor_m..=ceiling_m).contains(&at_m.z);
        (is_between && self.is_inside(at_m.truncate())) != self.keep_in
    }

    /// The least distance of a line over the ground from it, metres, at most a given one; negative on the wrong side.
    pub fn nearest_m(&self, line: &Line, most_m: f64) -> f64 {
        let mut least_m = most_m;
        if self.is_entered(line.from_m) {
            least_m = -ROUNDED_M;
        }
        self.each_part(|part| {
            least_m = part.nearest_m(line, least_m);
            least_m >= 0.0
        });
        least_m
    }

    /// The nearest way out for an aircraft on the wrong side, metres: level, but for one that is only too low or too high.
    pub fn way_out_m(&self, at_m: Vec3) -> Vec3 {
        let at = at_m.truncate();
        if self.keep_in && self.is_inside(at) {
            let (floor_m, ceiling_m) = self.heights_m;
            return Vec3::Z * (at_m.z.max(floor_m).min(ceiling_m) - at_m.z);
        }
        let nearest = match self.outline {
            Outline::Polygon(polygon) => edges(polygon.corners_m())
                .map(|(a, b)| nearest_of(a, b, at))
                .min_by(|a, b| a.distance_squared(at).total_cmp(&b.distance_squared(at))),
            Outline::Circle(center_m, radius_m) => {
                Some(center_m + (at - center_m).try_normalize().unwrap_or(Vec2::X) * radius_m)
            }
        };
        (nearest.unwrap_or(at) - at).extend(0.0)
    }

    /// Shows its convex parts until `take` returns false: a flight from the right side is as far from it as from the nearest one.
    pub(crate) fn each_part(&self, mut take: impl FnMut(Part) -> bool) {
        let always_m = (f64::NEG_INFINITY, f64::INFINITY);
        let is_whole = self.heights_m == always_m;
        let _ = match self.outline {
            Outline::Circle(center_m, radius_m) => take(Part::new(
                [center_m; 3],
                radius_m,
                self.heights_m,
                self.keep_in,
            )),
            Outline::Polygon(polygon) if self.keep_in || is_whole => {
                let heights = Part::new([Vec2::ZERO; 3], f64::INFINITY, self.heights_m, true);
                let wall = |(a, b)| Part::new([a, b, b], ROUNDED_M, always_m, false);
                (is_whole || take(heights))
                    && edges(&polygon.corners_m).all(|edge| take(wall(edge)))
            }
            Outline::Polygon(polygon) if polygon.triangles.is_empty() => take(Part::NOWHERE),
            Outline::Polygon(polygon) => polygon.triangles.iter().all(|triangle| {
                let corners_m = places_m(&polygon.corners_m, *triangle);
                take(Part::new(corners_m, ROUNDED_M, self.heights_m, false))
            }),
        };
    }
}

/// Some corners by their indices.
fn places_m(corners_m: &[Vec2], indices: [u8; 3]) -> [Vec2; 3] {
    indices.map(|index| (corners_m.get(usize::from(index)).copied()).unwrap_or(Vec2::ZERO))
}

fn edges(corners_m: &[Vec2]) -> impl Iterator<Item = (Vec2, Vec2)> {
    corners_m
        .iter()
        .copied()
        .zip(corners_m.iter().copied().cycle().skip(1))
}

/// The nearest place of the line from `a` to `b`.
#[inline]
pub(crate) fn nearest_of(a: Vec2, b: Vec2, at: Vec2) -> Vec2 {
    let along = b - a;
    let share = (at - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    a + along * share.limited(0.0, 1.0)
}
