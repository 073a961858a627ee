//! Published outlines that touch or cross themselves, as polygons that do not.

use fga::Vec2;
use geo::algorithm::bool_ops::FillRule;
use geo::{Area as _, BooleanOps, MultiPolygon};

use super::check::DEGREE_M;
use super::plane::{polygon_of, rings_of};
use crate::zones::{MAX_CORNERS, ZoneError, polygon};

/// Where loops the other way round cover a larger share, the corners may be in a wrong order.
const LOOPS: f64 = 0.01;
/// A part with a smaller area is rounding, square degrees: a hundredth of a square metre.
const SLIVER_DEG2: f64 = 1e-12;

/// All that the edges of an outline surround, without its holes, as polygons of latitudes and longitudes by their rings; `None` where no
/// ring crosses or touches itself, or more of it does than a published outline may.
pub(super) fn mended(rings_deg: &[Vec<[f64; 2]>]) -> Option<Vec<Vec<Vec<[f64; 2]>>>> {
    let on_map = |ring: &Vec<[f64; 2]>| -> Vec<Vec2> {
        let corners = ring.iter();
        let corners = corners.map(|[latitude, longitude]| Vec2::new(*longitude, *latitude));
        corners.collect()
    };
    let rings: Vec<Vec<Vec2>> = rings_deg.iter().map(on_map).collect();
    let outline = polygon_of(rings.get(..1)?);
    let is_long = rings.iter().any(|ring| ring.len() > MAX_CORNERS);
    let touches = |ring: &Vec<Vec2>| {
        let ring = ring.iter().map(|at| DEGREE_M * *at).collect();
        matches!(
            polygon(ring),
            Err(ZoneError::Repeated { .. } | ZoneError::Crosses { .. })
        )
    };
    if !is_long && !rings.iter().any(touches) {
        return None;
    }
    let nothing = MultiPolygon::new(Vec::new());
    let whole = outline.union_with_fill_rule(&nothing, FillRule::NonZero);
    // Loops the other way round take from the area by the corners; loops the same way add to it.
    let share = 1.0 - outline.unsigned_area() / whole.unsigned_area();
    if !(share <= LOOPS && (!is_long || share.abs() > 1e-9)) {
        return None;
    }
    let holes = rings.iter().skip(1);
    let holes = holes.map(|hole| polygon_of(core::slice::from_ref(hole)));
    let parts = whole.difference(&MultiPolygon::new(holes.collect()));
    let parts = parts
        .iter()
        .filter(|part| part.unsigned_area() > SLIVER_DEG2);
    let as_degrees = |ring: Vec<Vec2>| ring.iter().map(|at| [at.y, at.x]).collect();
    // What loops leave free between them is surrounded too.
    let most = if rings.len() > 1 { usize::MAX } else { 1 };
    let parts = parts.map(|part| rings_of(part).into_iter().take(most));
    let parts: Vec<Vec<Vec<[f64; 2]>>> = parts.map(|part| part.map(as_degrees).collect()).collect();
    (!parts.is_empty()).then_some(parts)
}
