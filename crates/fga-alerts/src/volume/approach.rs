//! What a volume asks of two straight lines, computed once for every volume.

use crate::aircraft::State;
use crate::plane::{cross, half_roots};
use glam::DVec2;

/// How the ownship's line approaches the intruder's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Approach {
    /// Squared horizontal distance now, m².
    pub(crate) square_m2: f64,
    /// Position times velocity in the plane, m²/s: negative while they converge.
    pub(crate) closing_m2ps: f64,
    /// Squared horizontal relative speed, m²/s².
    pub(crate) speed2_m2ps2: f64,
    /// Squared cross product of position and velocity in the plane, m⁴/s².
    moment2: f64,
    /// Height of the ownship above the intruder, metres.
    pub(crate) height_m: f64,
    /// Its climb relative to the intruder, m/s.
    pub(crate) climb_mps: f64,
}

/// A circle and a height: outside of either a volume is not violated, unless time counts too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Surroundings {
    /// Squared horizontal distance, m².
    pub(crate) square_m2: f64,
    /// Vertical distance, metres.
    pub(crate) height_m: f64,
    /// Modified tau, seconds, that violates too; `None` where another time does.
    pub(crate) tau_s: Option<f64>,
    /// Time, seconds, by which a climb violates before the height does, at most.
    pub(crate) coaltitude_s: f64,
}

/// A part of a size that rounding cannot make.
const MARGIN: f64 = 1e-9;

/// A distance that is less than any accuracy, metres.
const LEAST_M: f64 = 1e-3;

/// A slower relative motion may count as rest, metres per second.
const LEAST_MPS: f64 = 1e-3;

impl Approach {
    #[expect(clippy::inline_always, reason = "asked for each line of each quantity")]
    #[inline(always)]
    pub(crate) fn of(ownship: &State, intruder: &State) -> Self {
        let offset_m = ownship.position_m - intruder.position_m;
        let relative_mps = ownship.velocity_mps - intruder.velocity_mps;
        Self {
            height_m: offset_m.z,
            climb_mps: relative_mps.z,
            ..Self::in_plane(offset_m.truncate(), relative_mps.truncate())
        }
    }

    /// The horizontal part alone.
    #[expect(clippy::inline_always, reason = "asked for each line of each quantity")]
    #[inline(always)]
    pub(crate) fn in_plane(s: DVec2, v: DVec2) -> Self {
        let moment = cross(s, v);
        Self {
            square_m2: s.length_squared(),
            closing_m2ps: s.dot(v),
            speed2_m2ps2: v.length_squared(),
            moment2: moment * moment,
            height_m: 0.0,
            climb_mps: 0.0,
        }
    }

    /// Whether every number is finite: no line is judged that cannot be flown.
    #[inline]
    pub(crate) fn is_finite(&self) -> bool {
        // A sum with a number that is not finite is not finite.
        (self.square_m2 + self.closing_m2ps + self.speed2_m2ps2 + self.height_m + self.climb_mps)
            .is_finite()
    }

    /// Room left inside a circle at the closest approach, times the squared speed: positive where
    /// the line crosses the circle, zero where it touches.
    #[inline]
    pub(crate) fn room(&self, reach_m2: f64) -> f64 {
        reach_m2 * self.speed2_m2ps2 - self.moment2
    }

    /// Whether the line stays out of a circle from now on: it leads away, or misses it.
    #[inline]
    pub(crate) fn passes_by(&self, reach_m2: f64) -> bool {
        self.square_m2 > reach_m2 && (self.closing_m2ps > 0.0 || self.room(reach_m2) < 0.0)
    }

    /// Whether an ownship that comes onto the line at a time, not before now, surely meets nothing within a reach
    /// any more: it is outside and leads away, in the plane or in height.
    ///
    /// The margins exceed the rounding of the times at which the line leaves the reach: these come from the roots
    /// of the same squares, each rounded to 1e-16 of its size.
    #[inline]
    pub(crate) fn is_over(&self, since_s: f64, reach: &Surroundings) -> bool {
        if self.passes_by(reach.square_m2) {
            return true;
        }
        let (turn, grown_m2) = (
            self.speed2_m2ps2 * since_s,
            (2.0 * self.closing_m2ps + self.speed2_m2ps2 * since_s) * since_s,
        );
        let size_m2 = self.square_m2 + turn * since_s;
        let leads_away =
            self.closing_m2ps + turn > 0.0 && self.speed2_m2ps2 > LEAST_MPS * LEAST_MPS;
        if leads_away && self.square_m2 + grown_m2 > reach.square_m2 + MARGIN * size_m2 {
            return true;
        }
        let climbed_m = self.climb_mps * since_s;
        let height_m = self.height_m + climbed_m;
        let size_m = self.height_m.abs() + climbed_m.abs() + reach.height_m;
        height_m * self.climb_mps > 0.0
            && self.climb_mps.abs() > LEAST_MPS
            && height_m.abs() > reach.height_m + MARGIN * size_m
    }

    /// Whether the line surely meets nothing within a reach until a time: it converges all that time, and neither
    /// the distance nor the modified tau come down to the reach.
    ///
    /// Both are violated where `s² + τ (s · v) ≤ D²`. The left side is a parabola in time: at that time it must still
    /// fall, and still exceed D². [`Approach::is_over`] explains the margin.
    #[inline]
    pub(crate) fn is_later(&self, until_s: f64, reach: &Surroundings) -> bool {
        let Some(tau_s) = reach.tau_s else {
            return false;
        };
        let a = self.speed2_m2ps2;
        let b = 2.0 * self.closing_m2ps + tau_s * a;
        let square_m2 = a * until_s * until_s;
        let value_m2 =
            self.square_m2 + tau_s * self.closing_m2ps - reach.square_m2 + b * until_s + square_m2;
        let closing_m2 = self.closing_m2ps.abs() * (until_s + tau_s);
        let size_m2 =
            self.square_m2 + reach.square_m2 + closing_m2 + tau_s * a * until_s + square_m2;
        2.0 * a * until_s + b < 0.0
            && a > LEAST_MPS * LEAST_MPS
            && value_m2 > 4.0 * MARGIN * size_m2
    }

    /// Squared horizontal distance at a time, m², and a size of which a small part exceeds its rounding.
    fn square_at_m2(&self, time_s: f64) -> (f64, f64) {
        let way_m2 = self.speed2_m2ps2 * time_s * time_s;
        let closed_m2 = 2.0 * self.closing_m2ps * time_s;
        (
            self.square_m2 + closed_m2 + way_m2,
            self.square_m2 + closed_m2.abs() + way_m2,
        )
    }

    /// Whether the line surely violates a reach at a time and a little before and after it, by its distance or its
    /// modified tau; for a volume violated where both that and the height are.
    pub(crate) fn is_within(&self, time_s: f64, around_s: f64, reach: &Surroundings) -> bool {
        let height_m = (self.height_m + self.climb_mps * time_s).abs();
        let size_m = self.height_m.abs() + self.climb_mps.abs() * time_s;
        if height_m + self.climb_mps.abs() * around_s + LEAST_M + MARGIN * size_m > reach.height_m {
            return false;
        }
        let (square_m2, size_m2) = self.square_at_m2(time_s);
        let turn = self.speed2_m2ps2 * around_s;
        let closing = self.closing_m2ps + self.speed2_m2ps2 * time_s;
        let moved_m2 = 2.0 * (closing.abs() + turn) * around_s;
        if square_m2 + moved_m2 + MARGIN * size_m2 < reach.square_m2 {
            return true;
        }
        // As in `is_later`, with a line that converges and comes as close as the distance.
        let tau_s = reach.tau_s.unwrap_or(0.0);
        let tau_m2 = tau_s * self.closing_m2ps.abs() + tau_s * self.speed2_m2ps2 * time_s;
        closing + turn < 0.0
            && self.room(reach.square_m2)
                > MARGIN * (self.moment2 + self.square_m2 * self.speed2_m2ps2)
            && square_m2 + tau_s * (closing + turn) + moved_m2 + MARGIN * (size_m2 + tau_m2)
                < reach.square_m2
    }

    /// Whether the line surely lies out of a reach, without its times, from a time on for a while.
    pub(crate) fn is_beyond(&self, time_s: f64, lasts_s: f64, reach: &Surroundings) -> bool {
        let (square_m2, size_m2) = self.square_at_m2(time_s);
        let speed_mps = libm::sqrt(self.speed2_m2ps2);
        let room_m = libm::sqrt(reach.square_m2) + speed_mps * lasts_s + LEAST_M;
        if square_m2 - MARGIN * size_m2 > room_m * room_m {
            return true;
        }
        let height_m = (self.height_m + self.climb_mps * time_s).abs();
        let size_m = self.height_m.abs() + self.climb_mps.abs() * time_s;
        height_m - self.climb_mps.abs() * lasts_s - LEAST_M - MARGIN * size_m > reach.height_m
    }

    /// Least horizontal distance between two times, metres, or a little less.
    pub(crate) fn least_m(&self, from_s: f64, until_s: f64) -> f64 {
        let (closing, a) = (self.closing_m2ps, self.speed2_m2ps2);
        let closest_s = if -closing > a * until_s {
            until_s
        } else if -closing > a * from_s {
            -closing / a
        } else {
            from_s
        };
        let size_m2 = self.square_m2 + (2.0 * closing.abs() + a * closest_s) * closest_s;
        let square_m2 = self.square_m2 + (2.0 * closing + a * closest_s) * closest_s;
        libm::sqrt((square_m2 - MARGIN * size_m2).max(0.0)) - LEAST_M
    }

    /// Least vertical distance between two times, metres, or a little less.
    pub(crate) fn least_height_m(&self, from_s: f64, until_s: f64) -> f64 {
        let height_m = |time_s: f64| self.height_m + self.climb_mps * time_s;
        let (first_m, last_m) = (height_m(from_s), height_m(until_s));
        if first_m * last_m <= 0.0 {
            return 0.0;
        }
        let size_m = self.height_m.abs() + self.climb_mps.abs() * until_s;
        first_m.abs().min(last_m.abs()) - MARGIN * size_m - LEAST_M
    }

    /// When the line enters and leaves a circle, seconds; `None` where it never does.
    #[inline]
    pub(crate) fn crossings_s(&self, reach_m2: f64) -> Option<(f64, f64)> {
        half_roots(
            self.speed2_m2ps2,
            self.closing_m2ps,
            self.square_m2 - reach_m2,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aircraft::Pair;
    use crate::volume::{Cylinder, Volume, WellClear};
    use glam::DVec3;

    /// Drawn numbers between -1 and 1.
    struct Draw(u64);

    impl Draw {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
            self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }

        fn state(&mut self) -> State {
            let position_m = DVec3::new(
                4000.0 * self.next(),
                4000.0 * self.next(),
                300.0 * self.next(),
            );
            let velocity_mps =
                DVec3::new(90.0 * self.next(), 90.0 * self.next(), 5.0 * self.next());
            State {
                position_m,
                velocity_mps,
            }
        }
    }

    #[test]
    fn what_is_sure_without_a_window_agrees_with_the_window() {
        let mut draw = Draw(7);
        let mut seen = [0; 3];
        for volume in [
            Volume::Cylinder(Cylinder::F3442),
            Volume::WellClear(WellClear::EN_ROUTE),
        ] {
            let reach = volume.reach().unwrap();
            for _ in 0..20_000 {
                let (own, other) = (draw.state(), draw.state());
                let approach = Approach::of(&own, &other);
                let loss = volume.violation(&Pair::exact(own, other), 0.0, 500.0);
                let (time_s, lasts_s) = (30.0 * (draw.next() + 1.0), 2.0 * (draw.next() + 1.0));
                if approach.is_within(time_s, 1e-3, &reach) {
                    assert!(
                        loss.entry_s < time_s && time_s < loss.exit_s,
                        "{loss:?} {time_s}"
                    );
                    seen[0] += 1;
                }
                if approach.is_over(time_s, &reach) {
                    assert!(!loss.conflicts_within(time_s, 500.0), "{loss:?} {time_s}");
                    seen[1] += 1;
                }
                if reach.tau_s == Some(0.0) && approach.is_beyond(time_s, lasts_s, &reach) {
                    assert!(!loss.conflicts_within(time_s, time_s + lasts_s), "{loss:?}");
                    seen[2] += 1;
                }
            }
        }
        assert!(seen.into_iter().all(|count| count > 100), "{seen:?}");
    }
}
