//! Polygons and zones from files and wires, checked once where they enter.

use fga::Vec2;

/// Most corners of a polygon.
pub const MAX_CORNERS: usize = 256;

/// A corner is at most this far from the origin, metres.
const FARTHEST_M: f64 = 1e7;

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
    /// A floor that is not below its ceiling, metres.
    #[error("floor is {0} m and ceiling {1} m, expected the floor below the ceiling")]
    Heights(f64, f64),
}

/// The corners of a polygon in order, either way round, metres east and north; the last is joined to the first.
///
/// # Errors
/// Fewer than 3 corners or more than [`MAX_CORNERS`], a corner that is no place or repeats another one, edges that meet elsewhere
/// than in their common corner.
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
    let edges = || corners_m.iter().zip(corners_m.iter().cycle().skip(1));
    for (other, (c, d)) in edges().enumerate() {
        for (one, (a, b)) in edges().enumerate().take(other) {
            let crosses = if b == c {
                turns_back(*a, *b, *d)
            } else if d == a {
                turns_back(*c, *d, *b)
            } else {
                meet((*a, *b), (*c, *d))
            };
            if crosses {
                let (one, other) = (one + 1, other + 1);
                return Err(ZoneError::Crosses { one, other });
            }
        }
    }
    Ok(corners_m)
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
        assert!(heights_m(2.0, 2.0).is_err() && heights_m(f64::NAN, 2.0).is_err());
        assert_eq!(
            heights_m(f64::NEG_INFINITY, 2.0),
            Ok((f64::NEG_INFINITY, 2.0))
        );
    }
}
