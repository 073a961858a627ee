//! Which obstacles may come near a line while the aircraft follows it.
//!
//! At the time t ≥ 0 of the line the aircraft is off the place p + v t by at most P and off the velocity v by at most V.
//! An obstacle has the offset r and the relative velocity w at t = 0. A look ahead by s ≥ 0 from t finds it within d only
//! if |r − w u| ≤ d + P + V s at u = t + s. So no look does if |r − w u| > d + P + V u for all u ≥ 0: a quadratic
//! inequality. A distance that grows with time at a rate adds this rate to V.

use crate::kept::block::Slot;
use crate::quiet::LineAhead;
use fga_proof::Vec3;

/// Distance off the line, metres, and off its velocity, metres per second: enough for most flights, for a step is quiet only
/// on the leg itself.
const OFF_M: f64 = 4.0;
const OFF_MPS: f64 = 0.25;

/// The line is followed within this share of these distances: the rest is for rounding.
const FOLLOWED_SHARE: f64 = 0.99;

/// A line ends after this time, seconds: far ahead it is wide.
const LONGEST_S: f64 = 300.0;

/// Beyond these coordinates (metres), times (seconds) and speeds (metres per second) rounding could matter.
const LARGEST: f64 = 1e9;
const FASTEST_MPS: f64 = 1e3;

/// Room for the margin of later steps beyond that of the first one: share and metres.
const MORE_MARGIN: (f64, f64) = (1.25, 1.0);

/// A line that the aircraft follows, within bounds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    ahead: LineAhead,
    since_s: f64,
}

impl Line {
    /// The line ahead.
    pub(super) fn new(ahead: &LineAhead, time_s: f64) -> Self {
        let (share, more_m) = MORE_MARGIN;
        Self {
            ahead: LineAhead {
                margin_m: share * ahead.margin_m + more_m,
                ..*ahead
            },
            since_s: time_s,
        }
    }

    /// Whether the aircraft still follows it, and asks for no more than at its start.
    pub(super) fn is_followed(&self, now: &LineAhead, time_s: f64) -> bool {
        let from = &self.ahead;
        let followed_s = time_s - self.since_s;
        let expected_m = from.position_m + from.velocity_mps * followed_s;
        (0.0..=LONGEST_S).contains(&followed_s)
            && (now.position_m - expected_m).length() <= FOLLOWED_SHARE * OFF_M
            && (now.velocity_mps - from.velocity_mps).length() <= FOLLOWED_SHARE * OFF_MPS
            && now.margin_m <= from.margin_m
            && now.sigmas == from.sigmas
            && now.horizon_s == from.horizon_s
    }

    /// Whether an obstacle may come near the line, or near the aircraft if it may turn.
    pub(super) fn may_meet(&self, slot: &Slot) -> bool {
        let from = &self.ahead;
        let obstacle = slot.at(self.since_s);
        let velocity_mps = obstacle.velocity_mps;
        let speeds_mps = (from.velocity_mps.length(), velocity_mps.length());
        let places = [obstacle.position_m, from.position_m];
        let moderate = places.iter().all(|at| at.abs().max_element() <= LARGEST)
            && slot.reported_s.abs() <= LARGEST
            && self.since_s.abs() <= LARGEST
            && speeds_mps.0.max(speeds_mps.1) <= FASTEST_MPS
            && !(slot.is_at_rest() && velocity_mps != Vec3::ZERO);
        if !moderate {
            return true;
        }
        let mut reach_m = from.reach_m(&obstacle);
        if obstacle.movement.bounds().is_some() {
            let speed_mps = speeds_mps.0 + OFF_MPS + speeds_mps.1;
            reach_m = reach_m.max(from.near_m(&obstacle, speed_mps));
        }
        let wide_m = reach_m + OFF_M;
        let wider_mps = OFF_MPS + from.sigmas * obstacle.uncertainty.velocity_mps;
        let offset = obstacle.position_m - from.position_m;
        let relative = from.velocity_mps - velocity_mps;
        // |r − w u|² > (G + V u)²: c − 2 b u + a u² > 0.
        let square = relative.length_squared();
        let a = square - wider_mps * wider_mps;
        let b = offset.dot(relative) + wide_m * wider_mps;
        let distance = offset.length_squared();
        let c = distance - wide_m * wide_m;
        let outside = c > 1e-9 * distance && a > 1e-9 * square;
        !(outside && (b <= 0.0 || b * b < (1.0 - 1e-9) * a * c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Draw;
    use crate::kept::Kept;
    use crate::kept::block::Block;
    use crate::situation::{Movement, Obstacle, ProtectedVolume, Uncertainty};

    impl Draw {
        /// An obstacle that passes a line at a little more than the distance at which it may be met.
        fn just_clear(&mut self, ahead: &LineAhead) -> (Obstacle, Vec3) {
            let kind = self.within(0.0, 5.0);
            let movement = if kind < 1.0 {
                Movement::AtRest
            } else if kind < 2.0 {
                Movement::CREWED
            } else {
                Movement::Straight
            };
            let velocity_mps = if self.within(0.0, 1.0) < 0.2 {
                Vec3::ZERO
            } else {
                self.vector(30.0)
            };
            let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
            let mut obstacle = Obstacle::straight(1, Vec3::ZERO, velocity_mps, volume);
            obstacle.movement = movement;
            obstacle.uncertainty = Uncertainty {
                position_m: 1.0,
                velocity_mps: self.within(-1.0, 1.0).max(0.0),
            };
            let relative = ahead.velocity_mps - velocity_mps;
            let aside = relative.cross(self.vector(1.0)).normalize_or_zero();
            let mut reach_m = ahead.reach_m(&obstacle);
            if movement.bounds().is_some() {
                let speed_mps = ahead.velocity_mps.length() + velocity_mps.length();
                reach_m = reach_m.max(ahead.near_m(&obstacle, speed_mps));
            }
            let after_s = self.within(-20.0, 250.0);
            let aside_m =
                reach_m + self.within(0.0, 12.0) + self.within(0.0, 0.5) * after_s.max(0.0);
            obstacle.position_m = ahead.position_m + relative * after_s + aside * aside_m;
            (obstacle, aside)
        }
    }

    /// The states of an aircraft that follows a line, at the bounds and somewhat beyond, never meet an obstacle that
    /// the line says cannot come near.
    #[test]
    fn an_obstacle_that_cannot_come_near_a_line_is_not_met_from_it() {
        let mut draw = Draw(1);
        let (mut clear, mut states) = (0, 0);
        let mut blocks = [Block::EMPTY];
        let mut kept = Kept::new(&mut blocks);
        for _ in 0..20_000 {
            let from = LineAhead {
                position_m: draw.vector(1e4),
                velocity_mps: draw.vector(20.0),
                surveillance_radius_m: f64::INFINITY,
                margin_m: draw.within(0.0, 5.0),
                sigmas: 3.0,
                horizon_s: 60.0,
            };
            let since_s = draw.within(-1e3, 1e3);
            let line = Line::new(&from, since_s);
            let (obstacle, aside) = draw.just_clear(&line.ahead);
            kept.put(&obstacle, since_s).unwrap();
            let slot = kept.memory.slot(0).unwrap();
            if line.may_meet(slot) {
                continue;
            }
            clear += 1;
            for _ in 0..40 {
                let followed_s = draw.within(-30.0, 330.0);
                let off_m = aside * draw.within(-1.3, 1.3) * OFF_M;
                let off_mps = aside * draw.within(-1.3, 1.3) * OFF_MPS;
                let now = LineAhead {
                    position_m: from.position_m + from.velocity_mps * followed_s + off_m,
                    velocity_mps: from.velocity_mps + off_mps,
                    margin_m: from.margin_m * draw.within(0.5, 6.0),
                    ..from
                };
                let time_s = since_s + followed_s;
                if line.is_followed(&now, time_s) {
                    states += 1;
                    let met = now.may_meet(&slot.at(time_s));
                    assert!(!met, "{now:?} {:?} after {followed_s} s", slot.obstacle);
                }
            }
        }
        assert!(clear > 1000 && states > 10_000, "{clear} {states}");
    }
}
