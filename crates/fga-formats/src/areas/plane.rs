//! Areas on the plane of a local frame: edges true within [`TRUE_M`], no more corners than a zone has, nothing but what is near.

use fga::Vec2;
use geo::algorithm::line_measures::{Geodesic, InterpolatePoint};
use geo::buffer::{BufferStyle, LineJoin};
use geo::{
    BooleanOps, BoundingRect, Buffer, Contains, Coord, Intersects, LineString, MapCoords,
    MultiPolygon, Point, Polygon, Rect, Simplify,
};

use super::area::{AreaOutline, EdgeLine, NamedArea};
use crate::geodesy::{Geodetic, LocalFrame};
use crate::zones::{MAX_CORNERS, with_holes};

/// An edge on the plane is nowhere farther from the line that it stands for, metres.
const TRUE_M: f64 = 0.5;
/// An edge is halved at most this often.
const HALVED: u32 = 14;
/// Of an outline that reaches farther from the origin, the part within is taken, degrees of latitude: a mission leads at most 500 km away.
const NEAR_DEG: f64 = 6.0;
/// An edge whose places are all farther from the origin reaches nothing near, metres, whatever line it is.
const FAR_M: f64 = 2e6;
/// A place is on the edge of what is near within this, degrees.
const ON_EDGE_DEG: f64 = 1e-5;
/// An outline with too many corners grows by at most this, metres.
const MOST_GROWN_M: f64 = 1000.0;
/// One to keep out of that would grow by more than this is cut into parts instead, metres.
const CUT_GROWN_M: f64 = 16.0;
/// The parts of an outline that is cut lie on each other by this, metres.
const LAPPED_M: f64 = 1.0;
/// A part is halved at most this often.
const CUT: u32 = 8;
/// A long outline grows by twice this at least, metres: less seldom does, and each try takes long.
const LONG_GROWN_M: f64 = 4.0;
/// A ring is simplified in pieces of so many corners.
const PIECE: usize = 512;
/// An outline with more corners is long.
const LONG: usize = 4096;
/// Most parts.
const PARTS: usize = 64;

/// An area on the plane.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PlaneArea {
    /// The rings of each polygon, the outline before its holes, metres; none if all of it is more than 600 km away.
    pub polygons: Vec<Vec<Vec<Vec2>>>,
    /// How far the outline was moved at most so that it has few corners, metres: outwards, or inwards for an area to stay in.
    pub grown_m: f64,
}

impl NamedArea {
    /// Its polygons on the plane of a frame, as an area to stay in or to keep out of; none for a circle.
    pub fn on_plane(&self, frame: &LocalFrame, keep_in: bool) -> PlaneArea {
        let AreaOutline::Polygon(rings) = &self.outline else {
            return PlaneArea::default();
        };
        let rings = rings
            .iter()
            .map(|ring| self.as_degrees(ring, frame.origin()));
        let mut rings = rings.collect::<Vec<_>>().into_iter();
        let outline = rings.next().unwrap_or(LineString::new(Vec::new()));
        let polygon = Polygon::new(outline, rings.collect());
        let window = window(frame);
        let near = near(&polygon, &window);
        let near: Vec<Vec<Vec<Vec2>>> = near
            .iter()
            .map(|polygon| {
                let rings = [polygon.exterior()].into_iter().chain(polygon.interiors());
                rings.map(|ring| ring_m(ring, frame, &window)).collect()
            })
            .collect();
        let as_it_is = |polygons| PlaneArea {
            polygons,
            grown_m: 0.0,
        };
        let corners = |polygon: &Vec<Vec<Vec2>>| {
            let holes = 2 * polygon.len().saturating_sub(1);
            polygon.iter().map(Vec::len).sum::<usize>() + holes
        };
        if near.iter().all(|polygon| corners(polygon) <= MAX_CORNERS) {
            return as_it_is(near);
        }
        let outwards = if keep_in { -1.0 } else { 1.0 };
        let mut whole = MultiPolygon::new(near.iter().map(|rings| polygon_of(rings)).collect());
        // Grown from the last one, which is simpler, where the outline is long: by more in all, with less work.
        let is_long = near.iter().map(corners).sum::<usize>() > LONG;
        let mut before_m = 0.0;
        let mut half_m = if is_long { LONG_GROWN_M } else { 0.5 };
        while before_m + 2.0 * half_m <= MOST_GROWN_M {
            // What is simplified by less than it has grown holds all of the outline.
            let style = BufferStyle::new(outwards * half_m).line_join(LineJoin::Miter(1.0));
            let grown = whole.buffer_with_style(style);
            let grown: MultiPolygon = grown
                .iter()
                .map(|one| simplified(one, 0.98 * half_m))
                .collect();
            let grown_m = before_m + 2.0 * half_m;
            if is_long && grown_m >= CUT_GROWN_M {
                before_m = grown_m;
                whole = grown.clone();
            }
            let cuts = if keep_in || grown_m < CUT_GROWN_M {
                0
            } else {
                CUT
            };
            if let Some(polygons) =
                zones(grown, cuts).filter(|zones| (1..=PARTS).contains(&zones.len()))
            {
                return PlaneArea { polygons, grown_m };
            }
            half_m *= 2.0;
        }
        as_it_is(near)
    }

    /// A ring in degrees, x the longitude, whose edges are straight there; those that are far from an origin may be off.
    fn as_degrees(&self, ring: &[[f64; 2]], origin: Geodetic) -> LineString<f64> {
        let corner = |[latitude_deg, longitude_deg]: &[f64; 2]| Coord {
            x: *longitude_deg,
            y: *latitude_deg,
        };
        let mut line: Vec<Coord<f64>> = ring.iter().map(corner).collect();
        line.extend(line.first().copied());
        if self.edges == EdgeLine::Degrees {
            return LineString::new(line);
        }
        // The shortest way may cross the antimeridian, where its longitudes go on.
        let near = |longitude_deg: f64, other_deg: f64| {
            longitude_deg + 360.0 * libm::rint((other_deg - longitude_deg) / 360.0)
        };
        let mut before = line.first().map_or(0.0, |at| at.x);
        for at in &mut line {
            at.x = near(at.x, before);
            before = at.x;
        }
        let middle = |from: Coord<f64>, to: Coord<f64>| {
            let (x, y) = Geodesic
                .point_at_ratio_between(Point(from), Point(to), 0.5)
                .x_y();
            Coord {
                x: near(x, from.x),
                y,
            }
        };
        let off_m = |[from, to]: [Coord<f64>; 2], at: Coord<f64>, share: f64| {
            let [begin, end, at] = [from, to, at].map(|at| place(at, 0.0));
            if at.distance_m(origin) > FAR_M + 4.0 * begin.distance_m(end) {
                return 0.0;
            }
            place(from + (to - from) * share, 0.0).distance_m(at)
        };
        LineString::new(halved(&line, &middle, &off_m))
    }
}

/// A line with more corners, between which the middle of a piece and the middles of its halves are off a straight line by at most
/// [`TRUE_M`]; `off_m` says by how much, for a piece, a place on it and its share of the way.
fn halved(
    line: &[Coord<f64>],
    middle: &impl Fn(Coord<f64>, Coord<f64>) -> Coord<f64>,
    off_m: &impl Fn([Coord<f64>; 2], Coord<f64>, f64) -> f64,
) -> Vec<Coord<f64>> {
    let mut all: Vec<Coord<f64>> = line.first().copied().into_iter().collect();
    for (from, to) in line.iter().zip(line.iter().skip(1)) {
        let mut pieces = vec![(*from, *to, 0)];
        while let Some((from, to, depth)) = pieces.pop() {
            let half = middle(from, to);
            let quarters = [
                (middle(from, half), 0.25),
                (half, 0.5),
                (middle(half, to), 0.75),
            ];
            let is_true = |(at, share): (Coord<f64>, f64)| off_m([from, to], at, share) <= TRUE_M;
            if depth >= HALVED || quarters.into_iter().all(is_true) {
                all.push(to);
            } else {
                pieces.push((half, to, depth + 1));
                pieces.push((from, half, depth + 1));
            }
        }
    }
    all
}

/// A ring on the plane, open, metres; where it runs along the edge of what is near, it is nobody's edge and keeps its corners.
fn ring_m(ring: &LineString<f64>, frame: &LocalFrame, window: &Rect<f64>) -> Vec<Vec2> {
    let is_cut = |[from, to]: [Coord<f64>; 2]| {
        let on = |at: f64, edge: f64| (at - edge).abs() < ON_EDGE_DEG;
        let (min, max) = (window.min(), window.max());
        let mut along_x = [min.y, max.y].into_iter();
        let mut along_y = [min.x, max.x].into_iter();
        along_x.any(|edge| on(from.y, edge) && on(to.y, edge))
            || along_y.any(|edge| on(from.x, edge) && on(to.x, edge))
    };
    let local = |at: Coord<f64>| {
        frame
            .to_local_m(place(at, frame.origin().altitude_m))
            .truncate()
    };
    let middle = |from: Coord<f64>, to: Coord<f64>| (from + to) * 0.5;
    let off_m = |piece: [Coord<f64>; 2], at: Coord<f64>, _| {
        if is_cut(piece) {
            return 0.0;
        }
        let [from, to] = piece.map(local);
        let along = (to - from).normalize_or_zero();
        (local(at) - from).perp_dot(along).abs()
    };
    let line = halved(&ring.0, &middle, &off_m);
    let mut corners: Vec<Vec2> = line.into_iter().map(local).collect();
    corners.pop();
    corners
}

fn place(at: Coord<f64>, altitude_m: f64) -> Geodetic {
    Geodetic {
        latitude_deg: at.y,
        longitude_deg: at.x,
        altitude_m,
    }
}

/// What is near the origin of a frame, degrees.
fn window(frame: &LocalFrame) -> Rect<f64> {
    let origin = frame.origin();
    let (x, y) = (origin.longitude_deg, origin.latitude_deg);
    let edge_deg = (y.abs() + NEAR_DEG).min(89.0);
    let east_deg = (NEAR_DEG / libm::cos(edge_deg.to_radians())).min(180.0);
    Rect::new(
        (x - east_deg, (y - NEAR_DEG).max(-90.0)),
        (x + east_deg, (y + NEAR_DEG).min(90.0)),
    )
}

/// The parts of a polygon in degrees within a window; all of it where no corner is outside.
fn near(polygon: &Polygon<f64>, window: &Rect<f64>) -> Vec<Polygon<f64>> {
    let turns = [-360.0, 0.0, 360.0].into_iter();
    let turned = turns.map(|turn| {
        polygon.map_coords(|at| Coord {
            x: at.x + turn,
            y: at.y,
        })
    });
    let parts = turned.flat_map(|polygon| {
        let Some(bounds) = polygon
            .bounding_rect()
            .filter(|bounds| bounds.intersects(window))
        else {
            return Vec::new();
        };
        if window.contains(&bounds) {
            return vec![polygon];
        }
        polygon
            .intersection(&window.to_polygon())
            .into_iter()
            .collect()
    });
    parts.collect()
}

/// A polygon with fewer corners, off by at most this, metres; a long ring in pieces, with which the work grows as their square.
fn simplified(polygon: &Polygon<f64>, by_m: f64) -> Polygon<f64> {
    let simpler = |ring: &LineString<f64>| {
        let last = ring.0.len().saturating_sub(1);
        if last <= PIECE {
            let alone = Polygon::new(ring.clone(), Vec::new());
            return alone.simplify(by_m).into_inner().0;
        }
        let mut corners = Vec::new();
        for first in (0..last).step_by(PIECE) {
            let piece = ring.0.get(first..=(first + PIECE).min(last));
            // The corner that two pieces have.
            corners.pop();
            corners.extend(LineString::from(piece.unwrap_or_default().to_vec()).simplify(by_m));
        }
        LineString::new(corners)
    };
    let holes = polygon.interiors().iter().map(simpler).collect();
    Polygon::new(simpler(polygon.exterior()), holes)
}

/// The rings of zones that are these polygons together, each halved at most so often where it is no zone; `None` where that does not do.
fn zones(polygons: MultiPolygon<f64>, cuts: u32) -> Option<Vec<Vec<Vec<Vec2>>>> {
    let mut all = Vec::new();
    for polygon in polygons {
        let rings = rings_of(&polygon);
        let (outline, holes) = rings.split_first()?;
        if with_holes(outline.clone(), holes.to_vec()).is_ok() {
            all.push(rings);
            continue;
        }
        let bounds = polygon.bounding_rect().filter(|_| cuts > 0)?;
        let (min, max) = (bounds.min(), bounds.max());
        let (low, high) = if bounds.width() > bounds.height() {
            let middle = 0.5 * (min.x + max.x);
            ((middle + LAPPED_M, max.y), (middle, min.y))
        } else {
            let middle = 0.5 * (min.y + max.y);
            ((max.x, middle + LAPPED_M), (min.x, middle))
        };
        for half in [Rect::new(min, low.into()), Rect::new(high.into(), max)] {
            all.extend(zones(polygon.intersection(&half.to_polygon()), cuts - 1)?);
        }
    }
    Some(all)
}

pub(super) fn polygon_of(rings: &[Vec<Vec2>]) -> Polygon<f64> {
    let line = |ring: &Vec<Vec2>| -> LineString<f64> {
        ring.iter().map(|at| Coord { x: at.x, y: at.y }).collect()
    };
    let (outline, holes) = rings.split_first().unzip();
    Polygon::new(
        outline.map_or_else(|| LineString::new(Vec::new()), line),
        holes.unwrap_or_default().iter().map(line).collect(),
    )
}

pub(super) fn rings_of(polygon: &Polygon<f64>) -> Vec<Vec<Vec2>> {
    let rings = [polygon.exterior()].into_iter().chain(polygon.interiors());
    let open = |ring: &LineString<f64>| {
        let mut ring: Vec<Vec2> = ring.coords().map(|at| Vec2::new(at.x, at.y)).collect();
        ring.pop();
        ring
    };
    rings.map(open).collect()
}
