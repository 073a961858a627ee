//! Well clear for any state within the stated deviations.
//!
//! Source: Narkawicz, Muñoz, Dutle, "Sensor Uncertainty Mitigation and Dynamic Well Clear
//! Volumes in DAIDALUS", DASC 2018: the state in the disks of radius `z·σ` around the reported
//! position and velocity that enters first and leaves last.

use crate::aircraft::Pair;
use crate::almost::Closeness;
use crate::loss::Loss;
use crate::plane::{Crossing, cross, root};
use crate::volume::WellClear;
use glam::DVec2;

/// A smaller deviation (metres, metres per second) counts as this.
const LEAST_DEVIATION: f64 = 0.001;

/// Mitigated standard deviations.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DeviationFactors {
    /// Horizontal position.
    pub horizontal_position: f64,
    /// Horizontal velocity, far away.
    pub horizontal_velocity_least: f64,
    /// Horizontal velocity, close by.
    pub horizontal_velocity_most: f64,
    /// The distance at which the velocity's factor begins to grow, metres.
    pub velocity_distance_m: f64,
    /// Altitude.
    pub vertical_position: f64,
    /// Climb.
    pub vertical_velocity: f64,
}

impl DeviationFactors {
    fn horizontal_velocity(&self, distance_m: f64) -> f64 {
        if distance_m >= self.velocity_distance_m {
            return self.horizontal_velocity_least;
        }
        let part = distance_m / self.velocity_distance_m;
        (1.0 - part) * self.horizontal_velocity_most + part * self.horizontal_velocity_least
    }
}

/// Thresholds of well clear with mitigated deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UncertainWellClear {
    /// The thresholds.
    pub volume: WellClear,
    /// Mitigated standard deviations.
    pub factors: DeviationFactors,
}

/// Radii of the disks and intervals that contain the true relative state.
#[derive(Debug, Clone, Copy)]
struct Spread {
    position_m: f64,
    height_m: f64,
    velocity_mps: f64,
    climb_mps: f64,
}

impl UncertainWellClear {
    /// The uncertainty of the relative state; `None` if it is certain.
    fn spread(&self, pair: &Pair) -> Option<Spread> {
        let (s, _) = pair.plane();
        let deviation = &pair.deviation;
        let factors = &self.factors;
        let position_m = factors.horizontal_position * deviation.horizontal_m;
        let distance_m = (s.length() - position_m).max(0.0);
        let spread = Spread {
            position_m,
            height_m: factors.vertical_position * deviation.vertical_m,
            velocity_mps: factors.horizontal_velocity(distance_m) * deviation.horizontal_mps,
            climb_mps: factors.vertical_velocity * deviation.vertical_mps,
        };
        let none = spread.position_m == 0.0
            && spread.height_m == 0.0
            && spread.velocity_mps == 0.0
            && spread.climb_mps == 0.0;
        (!none).then(|| Spread {
            position_m: spread.position_m.max(LEAST_DEVIATION),
            height_m: spread.height_m.max(LEAST_DEVIATION),
            velocity_mps: spread.velocity_mps.max(LEAST_DEVIATION),
            climb_mps: spread.climb_mps.max(LEAST_DEVIATION),
        })
    }

    pub(super) fn violation(&self, pair: &Pair, from_s: f64, to_s: f64) -> Loss {
        match self.spread(pair) {
            None => self.volume.violation(pair, from_s, to_s),
            Some(spread) => self.spread_violation(pair, &spread, from_s, to_s),
        }
    }

    fn spread_violation(&self, pair: &Pair, spread: &Spread, from_s: f64, to_s: f64) -> Loss {
        let (height_m, climb_mps) = pair.vertical();
        let vertical = self.vertical(
            to_s,
            [height_m - spread.height_m, height_m + spread.height_m],
            [climb_mps - spread.climb_mps, climb_mps + spread.climb_mps],
        );
        let vertical = vertical.and(Loss::new(from_s, to_s));
        if !vertical.is_conflict() {
            return Loss::NEVER;
        }
        let (s, v) = pair.plane();
        let entry_s = self.plane_entry_s(s, v, spread, to_s);
        let exit_s = self.plane_exit_s(s, v, spread, to_s);
        if entry_s > to_s || exit_s < 0.0 || entry_s > exit_s {
            return Loss::NEVER;
        }
        let plane = Loss::new(entry_s.max(0.0), exit_s.min(to_s)).if_lasting();
        vertical.and(plane)
    }

    /// First time of a violation in the plane by any state, after `to_s` without one.
    fn plane_entry_s(&self, s: DVec2, v: DVec2, spread: &Spread, to_s: f64) -> f64 {
        let volume = &self.volume;
        let reach_m = volume.distance_m + spread.position_m;
        if volume.is_violated_in_plane(s, v) || s.length_squared() <= reach_m * reach_m {
            return 0.0;
        }
        if v.length_squared() <= spread.velocity_mps * spread.velocity_mps {
            let loss = self.head_on(s, v, spread, to_s);
            return if loss.is_conflict() {
                loss.entry_s
            } else {
                to_s + 1.0
            };
        }
        let (worst_s, worst_v) = worst_pair(s, v, spread);
        if worst_s.dot(worst_v) >= 0.0 {
            return to_s + 1.0;
        }
        let entry_s = |s, v| volume.plane_violation(to_s, s, v).entry_s;
        entry_s(s, v).min(entry_s(worst_s, worst_v))
    }

    /// Last time of a violation in the plane by any state, negative without one.
    fn plane_exit_s(&self, s: DVec2, v: DVec2, spread: &Spread, to_s: f64) -> f64 {
        let reach_m = self.volume.distance_m + spread.position_m;
        let speed_room = v.length_squared() - spread.velocity_mps * spread.velocity_mps;
        if speed_room <= 0.0 {
            let there = s.length_squared() <= reach_m * reach_m;
            return if there || self.head_on(s, v, spread, to_s).is_conflict() {
                to_s
            } else {
                -1.0
            };
        }
        root(
            speed_room,
            2.0 * (s.dot(v) - spread.velocity_mps * reach_m),
            s.length_squared() - reach_m * reach_m,
            Crossing::Exit,
        )
        .filter(|time_s| time_s.is_finite())
        .unwrap_or(-1.0)
    }

    /// The violation by the state that flies straight at the other aircraft.
    fn head_on(&self, s: DVec2, v: DVec2, spread: &Spread, to_s: f64) -> Loss {
        let ahead = unit(s);
        let distance_m = s.length() - spread.position_m;
        let speed_mps = v.length() + spread.velocity_mps;
        self.volume
            .plane_violation(to_s, ahead * distance_m, ahead * -speed_mps)
    }

    /// The vertical violation within `[0, to_s]` by any height and climb in the intervals.
    fn vertical(&self, to_s: f64, height_m: [f64; 2], climb_mps: [f64; 2]) -> Loss {
        let ([low_m, high_m], [slow_mps, fast_mps]) = (height_m, climb_mps);
        let mut found = Loss::NEVER;
        if low_m >= 0.0 || high_m > 0.0 {
            found = self.vertical_above(to_s, [low_m.max(0.0), high_m], climb_mps);
        }
        if low_m < 0.0 {
            // Mirrored vertically.
            let (height_m, climb_mps) = ([-high_m.min(0.0), -low_m], [-fast_mps, -slow_mps]);
            found = found.hull(self.vertical_above(to_s, height_m, climb_mps));
        }
        found.if_lasting()
    }

    /// The same for a height that is not negative.
    fn vertical_above(&self, to_s: f64, height_m: [f64; 2], climb_mps: [f64; 2]) -> Loss {
        let ([low_m, high_m], [slow_mps, fast_mps]) = (height_m, climb_mps);
        let at = |height_m, climb_mps| {
            self.volume
                .vertical_violation(0.0, to_s, height_m, climb_mps)
        };
        let mut found = Loss::NEVER;
        if slow_mps >= 0.0 || fast_mps > 0.0 {
            found = at(low_m, slow_mps.max(0.0));
        }
        if slow_mps < 0.0 {
            let (first, last) = (at(low_m, slow_mps), at(high_m, fast_mps.min(0.0)));
            if first.entry_s <= first.exit_s {
                let stays = last.entry_s > last.exit_s;
                let exit_s = if stays { to_s } else { last.exit_s };
                found = found.hull(Loss::new(first.entry_s, exit_s));
            }
        }
        found.if_lasting()
    }
}

fn unit(v: DVec2) -> DVec2 {
    let length = v.length();
    if length == 0.0 {
        DVec2::ZERO
    } else {
        v / length
    }
}

/// Direction from `s` to the point where a tangent from `s` touches the circle around the origin; zero
/// if `s` is inside.
fn tangent(s: DVec2, radius_m: f64, side: f64) -> DVec2 {
    let (square, reach) = (s.length_squared(), radius_m * radius_m);
    let aside = DVec2::new(s.y, -s.x) * side;
    if Closeness::Rounding.same(square, reach) {
        return unit(aside);
    }
    if square < reach {
        return DVec2::ZERO;
    }
    let touch = s * (reach / square) + aside * (radius_m * libm::sqrt(square - reach) / square);
    unit(if touch == DVec2::ZERO {
        touch
    } else {
        touch - s
    })
}

/// Whether `w` lies between `a` and `b`.
fn is_between(a: DVec2, b: DVec2, w: DVec2) -> bool {
    let turn = cross(b, a);
    cross(w, a) * turn >= 0.0 && cross(w, b) * turn <= 0.0
}

/// The relative position and velocity within their disks that come closest soonest.
///
/// The position's directions fill the cone between the tangents `p` to its disk, the reversed
/// velocity's the cone between the tangents `w`. Where the cones overlap a head-on approach is
/// possible, along the middle of the overlap; else the two nearest edges count.
fn worst_pair(s: DVec2, v: DVec2, spread: &Spread) -> (DVec2, DVec2) {
    let p = [-1.0, 1.0].map(|side| tangent(s, spread.position_m, side));
    let w = [-1.0, 1.0].map(|side| tangent(-v, spread.velocity_mps, side));
    let ([p1, p2], [w1, w2]) = (p, w);
    let within = |[a, b]: [DVec2; 2], c| is_between(a, b, c);
    let overlaps = [
        (within(p, w1) && within(p, w2), w1, w2),
        (within(w, p1) && within(w, p2), p1, p2),
        (within(w, p1) && within(p, w1), p1, w1),
        (within(w, p1) && within(p, w2), p1, w2),
        (within(w, p2) && within(p, w1), p2, w1),
        (within(w, p2) && within(p, w2), p2, w2),
    ];
    let (position, velocity) = match overlaps.into_iter().find(|(overlaps, ..)| *overlaps) {
        Some((_, a, b)) => (unit(a + b), unit(a + b)),
        // The first of the largest, so that ties resolve in order.
        None => [(p1, w2), (p2, w1), (p2, w2)]
            .into_iter()
            .fold((p1, w1), |best, pair| {
                if pair.0.dot(pair.1) > best.0.dot(best.1) {
                    pair
                } else {
                    best
                }
            }),
    };
    (
        -position * (s.length() - spread.position_m),
        velocity * (v.length() + spread.velocity_mps),
    )
}
