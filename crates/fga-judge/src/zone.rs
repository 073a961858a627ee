//! The distance that a flight keeps from a zone, measured along the flown track.

use fga_proof::zone::{Outline, Zone};
use fga_proof::{Vec2, Vec3};

use crate::arc::Arc;
use crate::separation::Least;

/// The least distance of a track is known to this, metres, ...
const KNOWN_M: f64 = 1e-3;

/// ... and to this share of it.
const KNOWN_SHARE: f64 = 1e-3;

/// How far a place is on the allowed side of a zone's surface, metres; negative on the other side.
pub fn zone_margin_m(zone: &Zone<'_>, at_m: Vec3) -> f64 {
    let at = at_m.truncate();
    let beside_m = match zone.outline {
        Outline::Polygon(corners_m) => beside_m(corners_m, at),
        Outline::Circle(center_m, radius_m) => at.distance(center_m) - radius_m,
    };
    let (floor_m, ceiling_m) = zone.heights_m;
    let above_m = (floor_m - at_m.z).max(at_m.z - ceiling_m);
    let outside_m = if beside_m > 0.0 && above_m > 0.0 {
        beside_m.hypot(above_m)
    } else {
        beside_m.max(above_m)
    };
    if zone.keep_in { -outside_m } else { outside_m }
}

/// Distance from the edge of a polygon, metres; negative inside.
fn beside_m(corners_m: &[Vec2], at: Vec2) -> f64 {
    let mut least_square = f64::INFINITY;
    let mut turns = 0_i32;
    let mut from = corners_m.last().copied().unwrap_or(at);
    for to in corners_m.iter().copied() {
        let (edge, offset) = (to - from, at - from);
        let foot = (offset.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
        least_square = least_square.min((offset - edge * foot).length_squared());
        // The winding number: upward edges to the right of the place less downward ones.
        let left = edge.perp_dot(offset);
        if from.y <= at.y && to.y > at.y && left > 0.0 {
            turns += 1;
        } else if from.y > at.y && to.y <= at.y && left < 0.0 {
            turns -= 1;
        }
        from = to;
    }
    let distance_m = least_square.sqrt();
    if turns == 0 { distance_m } else { -distance_m }
}

/// Measures the margin of a flown arc that ends at `end_m` from a zone.
pub fn observe(least: &mut Least, zone: &Zone<'_>, arc: &Arc, end_m: Vec3) {
    let (from_s, to_s) = (arc.start_s, arc.start_s + arc.duration_s);
    let (from_m, to_m) = (
        zone_margin_m(zone, arc.position_m),
        zone_margin_m(zone, end_m),
    );
    let look = |time_s: f64| zone_margin_m(zone, arc.position_at_m(time_s - from_s));
    least.note(from_m, from_s);
    least.note(to_m, to_s);
    refine(
        least,
        (from_s, from_m),
        (to_s, to_m),
        arc.speed_bound_mps(),
        &look,
    );
}

/// Halves where the margin, which changes by no more than the way flown, may be less than known.
fn refine(
    least: &mut Least,
    from: (f64, f64),
    to: (f64, f64),
    speed_mps: f64,
    look: &impl Fn(f64) -> f64,
) {
    let bound_m = 0.5 * (from.1 + to.1 - speed_mps * (to.0 - from.0));
    let known_m = KNOWN_M + KNOWN_SHARE * least.value_m.abs();
    if bound_m >= least.value_m - known_m {
        return;
    }
    let middle_s = f64::midpoint(from.0, to.0);
    let middle = (middle_s, look(middle_s));
    least.note(middle.1, middle.0);
    refine(least, from, middle, speed_mps, look);
    refine(least, middle, to, speed_mps, look);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_least_margin_is_that_of_fine_sampling(
            course_rad in -3.0..3.0f64,
            course_rate_radps in -0.5..0.5f64,
            x in -80.0..80.0f64, y in -80.0..80.0f64, z in -30.0..30.0f64,
            keep_in: bool, is_circle: bool,
        ) {
            // An L.
            let corners = [[0.0, 0.0], [60.0, 0.0], [60.0, 20.0], [20.0, 20.0], [20.0, 50.0], [0.0, 50.0]];
            let corners = corners.map(|[east, north]| Vec2::new(x + east, y + north));
            let outline = if is_circle {
                Outline::Circle(corners[0], 30.0)
            } else {
                Outline::Polygon(&corners)
            };
            let zone = Zone { keep_in, outline, heights_m: (z - 10.0, z + 10.0) };
            let arc = Arc {
                start_s: 0.0,
                duration_s: 4.0,
                position_m: Vec3::ZERO,
                course_rad,
                climb_rad: 0.1,
                course_rate_radps,
                climb_rate_radps: 0.05,
                airspeed_mps: 15.0,
                wind_mps: Vec3::ZERO,
            };
            let mut least = Least::NONE;
            observe(&mut least, &zone, &arc, arc.end_m());
            let sampled_m = (0..=40_000)
                .map(|step| zone_margin_m(&zone, arc.position_at_m(f64::from(step) * 1e-4)))
                .fold(f64::INFINITY, f64::min);
            // Sampling at 0.1 ms misses at most half a step of closing.
            let known_m = 2.0 * KNOWN_M + KNOWN_SHARE * sampled_m.abs();
            prop_assert!((least.value_m - sampled_m).abs() <= known_m);
            // The core has the same side.
            let inside = zone.is_entered(arc.position_m);
            prop_assert_eq!(inside, zone_margin_m(&zone, arc.position_m) < 0.0);
        }
    }
}
