//! Polygons and zones from files and wires, checked once where they enter.

use fga::Vec2;

/// Most corners of a polygon.
pub const MAX_CORNERS: usize = 256;

/// A corner is at most this far from the origin, metres.
const FARTHEST_M: f64 = 1e7;

/// A polygon narrower than this has no area, metres: two corners, each rounded to 10⁻⁷ degrees.
const NARROWEST_M: f64 = 0.02;

/// Why numbers are no zone; corners and edges count from 1, and edge n leads from corner n to the next one.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ZoneError {
    /// Too few or too many corners.
    #[error("polygon has {0} corners, expected 3 to {MAX_CORNERS}")]
    Corners(usize),
    /// A corner that is no place within 10,000 km.
    #[error("corner {0} is out of range, expected two numbers within 10,000 km")]
    Place(usize),
    /// A corner at the place of an earlier one.
    #[error("corner {again} lies on corner {first}, expected each corner once")]
    Repeated {
        /// The earlier one.
        first: usize,
        /// The later one.
        again: usize,
    },
    /// Two edges that meet elsewhere than in their common corner.
    #[error(
        "polygon crosses itself: edge {one} meets edge {other}, expected edges that meet only in common corners"
    )]
    Crosses {
        /// An edge.
        one: usize,
        /// A later one.
        other: usize,
    },
    /// Corners on one line.
    #[error("polygon has no area, expected one that is wider than {NARROWEST_M} m")]
    Narrow,
    /// A hole that is not inside of the outline, or meets another ring.
    #[error("hole {0} is not inside of the outline and apart from the other holes")]
    Hole(usize),
    /// A floor that is not below its ceiling, metres.
    #[error("floor is {0} m and ceiling {1} m, expected the floor below the ceiling")]
    Heights(f64, f64),
}

/// The corners of a polygon in order, either way round, metres east and north; the last is joined to the first.
///
/// # Errors
/// Fewer than 3 corners or more than [`MAX_CORNERS`], a corner that is no place or repeats another one, edges that meet elsewhere
/// than in their common corner, corners on one line.
pub fn polygon(corners_m: Vec<Vec2>) -> Result<Vec<Vec2>, ZoneError> {
    let count = corners_m.len();
    if !(3..=MAX_CORNERS).contains(&count) {
        return Err(ZoneError::Corners(count));
    }
    let is_place = |at: &Vec2| at.is_finite() && at.abs().max_element() <= FARTHEST_M;
    if let Some(wrong) = corners_m.iter().position(|at| !is_place(at)) {
        return Err(ZoneError::Place(wrong + 1));
    }
    for (later, at) in corners_m.iter().enumerate() {
        if let Some(first) = corners_m.iter().take(later).position(|other| other == at) {
            let (first, again) = (first + 1, later + 1);
            return Err(ZoneError::Repeated { first, again });
        }
    }
    for (other, (c, d)) in edges(&corners_m).enumerate() {
        for (one, (a, b)) in edges(&corners_m).enumerate().take(other) {
            let crosses = if b == c {
                turns_back(a, b, d)
            } else if d == a {
                turns_back(c, d, b)
            } else {
                meet((a, b), (c, d))
            };
            if crosses {
                let (one, other) = (one + 1, other + 1);
                return Err(ZoneError::Crosses { one, other });
            }
        }
    }
    let length_m: f64 = edges(&corners_m).map(|(a, b)| a.distance(b)).sum();
    if twice_area_m2(&corners_m).abs() < NARROWEST_M * length_m {
        return Err(ZoneError::Narrow);
    }
    Ok(corners_m)
}

/// A polygon with holes, each as [`polygon`] takes it, as one ring: an edge leads to each hole and back, over no other one. What an odd
/// number of edges surrounds, and what winds around a place, are the polygon without its holes.
///
/// # Errors
/// Those of [`polygon`], a hole that is not inside of the outline or meets another one, more than [`MAX_CORNERS`] in all.
pub fn with_holes(outline_m: Vec<Vec2>, holes_m: Vec<Vec<Vec2>>) -> Result<Vec<Vec2>, ZoneError> {
    let count = outline_m.len() + holes_m.iter().map(|hole| hole.len() + 2).sum::<usize>();
    if count > MAX_CORNERS {
        return Err(ZoneError::Corners(count));
    }
    let mut ring = polygon(outline_m)?;
    let holes_m = holes_m.into_iter().map(polygon);
    let mut holes: Vec<Vec<Vec2>> = holes_m.collect::<Result<_, _>>()?;
    for (index, hole) in holes.iter().enumerate() {
        let (before, after) = (holes.get(..index), holes.get(index + 1..));
        let others = before.into_iter().chain(after).flatten();
        let is_apart = |other: &Vec<Vec2>| {
            !edges(hole).any(|one| edges(other).any(|edge| meet(one, edge)))
                && !hole.first().is_some_and(|at| surrounds(other, *at))
        };
        let is_inside = !edges(hole).any(|one| edges(&ring).any(|edge| meet(one, edge)))
            && hole.first().is_some_and(|at| surrounds(&ring, *at));
        if !is_inside || !others.into_iter().all(is_apart) {
            return Err(ZoneError::Hole(index + 1));
        }
    }
    // The outline one way round, the holes the other way.
    turn(&mut ring, true);
    for hole in &mut holes {
        turn(hole, false);
    }
    while let Some((from, index, to)) = shortest_bridge(&ring, &holes) {
        let mut hole = holes.swap_remove(index);
        hole.rotate_left(to);
        hole.extend(hole.first().copied());
        hole.extend(ring.get(from).copied());
        let after = from + 1;
        ring.splice(after..after, hole);
    }
    if holes.is_empty() {
        Ok(ring)
    } else {
        Err(ZoneError::Hole(1))
    }
}

/// The shortest way from a corner of a ring to a corner of a hole that meets no edge between: the corner, the hole, its corner.
fn shortest_bridge(ring: &[Vec2], holes: &[Vec<Vec2>]) -> Option<(usize, usize, usize)> {
    let mut bridges = Vec::new();
    for (from, a) in ring.iter().enumerate() {
        for (index, hole) in holes.iter().enumerate() {
            let corners = hole.iter().enumerate();
            bridges.extend(corners.map(|(to, b)| ((*a, *b), (from, index, to))));
        }
    }
    let length = |(a, b): (Vec2, Vec2)| a.distance_squared(b);
    bridges.sort_by(|(one, _), (other, _)| length(*one).total_cmp(&length(*other)));
    let is_free = |(a, b): (Vec2, Vec2)| {
        let mut all = holes
            .iter()
            .map(Vec::as_slice)
            .chain([ring])
            .flat_map(edges);
        let ends = [a, b];
        all.all(|(c, d)| ends.contains(&c) || ends.contains(&d) || !meet((a, b), (c, d)))
    };
    let free = bridges.into_iter().find(|(bridge, _)| is_free(*bridge));
    free.map(|(_, corners)| corners)
}

/// The edges of a ring.
fn edges(ring: &[Vec2]) -> impl Iterator<Item = (Vec2, Vec2)> {
    let next = ring.iter().cycle().skip(1);
    ring.iter().copied().zip(next.copied())
}

/// Whether an odd number of a ring's edges surrounds a place.
pub(crate) fn surrounds(ring: &[Vec2], at: Vec2) -> bool {
    let is_beyond = |(a, b): &(Vec2, Vec2)| {
        (a.y > at.y) != (b.y > at.y) && ((*b - *a).perp_dot(at - *a) > 0.0) == (b.y > a.y)
    };
    edges(ring).filter(is_beyond).count() % 2 == 1
}

/// Twice the area of a ring, square metres; positive to the left.
fn twice_area_m2(ring: &[Vec2]) -> f64 {
    edges(ring).map(|(a, b)| a.perp_dot(b)).sum()
}

/// Turns a ring round, unless it is.
fn turn(ring: &mut [Vec2], to_left: bool) {
    if (twice_area_m2(ring) > 0.0) != to_left {
        ring.reverse();
    }
}

/// The floor and the ceiling of a zone, metres; infinite without.
///
/// # Errors
/// A floor that is not below the ceiling.
pub fn heights_m(floor_m: f64, ceiling_m: f64) -> Result<(f64, f64), ZoneError> {
    if floor_m < ceiling_m {
        Ok((floor_m, ceiling_m))
    } else {
        Err(ZoneError::Heights(floor_m, ceiling_m))
    }
}

/// Whether the way from `a` over `b` to `c` goes back on itself.
fn turns_back(a: Vec2, b: Vec2, c: Vec2) -> bool {
    (b - a).perp_dot(c - b) == 0.0 && (b - a).dot(c - b) < 0.0
}

/// Whether two lines have a place in common.
fn meet((a, b): (Vec2, Vec2), (c, d): (Vec2, Vec2)) -> bool {
    let side = |from: Vec2, to: Vec2, at: Vec2| (to - from).perp_dot(at - from);
    let (of_c, of_d) = (side(a, b, c), side(a, b, d));
    let (of_a, of_b) = (side(c, d, a), side(c, d, b));
    let is_on =
        |side: f64, at: Vec2, from: Vec2, to: Vec2| side == 0.0 && (at - from).dot(at - to) <= 0.0;
    (of_c * of_d < 0.0 && of_a * of_b < 0.0)
        || is_on(of_c, c, a, b)
        || is_on(of_d, d, a, b)
        || is_on(of_a, a, c, d)
        || is_on(of_b, b, c, d)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_numbers_are_named() {
        let at = |rows: &[[f64; 2]]| {
            let corners = rows.iter().map(|row| Vec2::from_array(*row)).collect();
            polygon(corners).unwrap_err()
        };
        assert_eq!(at(&[[0.0, 0.0], [1.0, 0.0]]), ZoneError::Corners(2));
        let many: Vec<[f64; 2]> = (0..257).map(|k| [f64::from(k), f64::from(k * k)]).collect();
        assert_eq!(at(&many), ZoneError::Corners(257));
        let nan = [[0.0, 0.0], [1.0, f64::NAN], [0.0, 1.0]];
        assert_eq!(at(&nan), ZoneError::Place(2));
        let closed = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0]];
        assert_eq!(at(&closed), ZoneError::Repeated { first: 1, again: 4 });
        let crosses = |one, other| ZoneError::Crosses { one, other };
        // A bow tie; an edge that goes back on the one before; a corner on another edge.
        let tie = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert_eq!(at(&tie), crosses(1, 3));
        let back = [[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        assert_eq!(at(&back), crosses(1, 2));
        let touching = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]];
        assert_eq!(at(&touching), crosses(1, 3));
        // Three corners on one line, each within 8 mm of it, as degrees with seven decimals are.
        let line = [[0.0, 0.0], [700.0, 499.992], [1400.0, 1000.008]];
        assert_eq!(at(&line), ZoneError::Narrow);
        let sliver = [[0.0, 0.0], [700.0, 500.0], [1400.0, 1000.2]];
        assert!(polygon(sliver.map(Vec2::from_array).to_vec()).is_ok());
        assert!(heights_m(2.0, 2.0).is_err() && heights_m(f64::NAN, 2.0).is_err());
        assert_eq!(
            heights_m(f64::NEG_INFINITY, 2.0),
            Ok((f64::NEG_INFINITY, 2.0))
        );
    }

    #[test]
    fn a_polygon_with_holes_is_one_ring_around_the_same_places() {
        let square = |[x, y]: [f64; 2], half: f64| {
            let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
            corners
                .map(|[a, b]| Vec2::new(x + half * a, y + half * b))
                .to_vec()
        };
        let outline = square([0.0, 0.0], 100.0);
        let mut holes: Vec<Vec<Vec2>> = (0..12)
            .map(|k| {
                square(
                    [
                        f64::from(k % 4) * 45.0 - 67.0,
                        f64::from(k / 4) * 50.0 - 51.0,
                    ],
                    15.0,
                )
            })
            .collect();
        holes[3].reverse();
        let ring = with_holes(outline.clone(), holes.clone()).unwrap();
        assert_eq!(ring.len(), 4 + 12 * 6);
        let winds = |at: Vec2| {
            let turns = edges(&ring)
                .map(|(a, b)| (a - at).angle_to(b - at))
                .sum::<f64>();
            turns.abs() > 1.0
        };
        let mut free = 0;
        for k in 0..10_000_i32 {
            let at = Vec2::new(f64::from(k % 100), f64::from(k / 100)) * 2.3 - 115.0;
            let at = at + Vec2::new(0.11, 0.07);
            let expected = surrounds(&outline, at) && !holes.iter().any(|hole| surrounds(hole, at));
            free += i32::from(surrounds(&outline, at) && !expected);
            assert_eq!(
                (surrounds(&ring, at), winds(at)),
                (expected, expected),
                "{at}"
            );
        }
        assert!(free > 1_500, "{free}");
        // No bridge leads through a hole or out of the outline.
        let is_edge = |way: &(Vec2, Vec2)| {
            let mut rings = holes.iter().chain([&outline]);
            rings.any(|ring| edges(ring).any(|(a, b)| [(a, b), (b, a)].contains(way)))
        };
        for (a, b) in edges(&ring).filter(|way| !is_edge(way)) {
            for share in [0.01, 0.3, 0.5, 0.7, 0.99] {
                let at = a.lerp(b, share);
                assert!(surrounds(&outline, at) && !holes.iter().any(|hole| surrounds(hole, at)));
            }
        }
        // A hole outside, one that meets the outline, one in another one, two that meet, and too many corners.
        for (holes, wrong) in [
            (vec![square([300.0, 0.0], 10.0)], ZoneError::Hole(1)),
            (vec![square([95.0, 0.0], 10.0)], ZoneError::Hole(1)),
            (vec![square([0.0, 0.0], 200.0)], ZoneError::Hole(1)),
            (
                vec![square([0.0, 0.0], 5.0), square([0.0, 0.0], 10.0)],
                ZoneError::Hole(1),
            ),
            (
                vec![square([0.0, 0.0], 9.0), square([10.0, 0.0], 9.0)],
                ZoneError::Hole(1),
            ),
            (vec![square([0.0, 0.0], 1.0); 60], ZoneError::Corners(364)),
        ] {
            assert_eq!(with_holes(outline.clone(), holes).unwrap_err(), wrong);
        }
    }
}
