//! Which distances of recovery block every maneuver, found without a search for each of them.
//!
//! The window in which a line is in a cylinder grows with the cylinder, also in floating point: radius and half
//! height enter through sums, products, quotients and square roots, whose rounding keeps order. So a line that
//! is in a cylinder for a time beyond rounding is in each larger one too, and one look at a line at the smallest
//! distances in question rules out all larger ones.

use crate::bands::level::Target;
use crate::bands::met::{Approaches, Met};
use crate::bands::path::{Fan, Line};
use crate::bands::ways::Ways;
use crate::loss::Loss;
use crate::volume::{Approach, Cylinder, Volume};

/// Lines against one intruder that recovery keeps away from.
pub(super) struct Blocking<'a> {
    pub(super) met: Met<'a>,
    /// Horizon of the conflict, seconds.
    pub(super) horizon_s: f64,
    /// Distances, none of them smaller than the next.
    pub(super) distances: &'a [Cylinder],
}

/// The lines of one side and how they approach the intruder.
type Side<'a> = (&'a [Line], &'a [Approach]);

impl Blocking<'_> {
    /// How many distances surely block every way, counted from the largest; `enough` or less where they are no
    /// more than that.
    pub(super) fn count(&self, ways: &Ways, approaches: &Approaches, enough: usize) -> usize {
        let mut blocked = self.distances.len();
        match ways {
            Ways::Fan(fan) => {
                for side in fan.sides.iter().zip(approaches.sides()) {
                    let side = (side.0.as_slice(), side.1);
                    self.reduce_by_side(&mut blocked, fan, side, enough);
                }
            }
            Ways::Levels(levels) => {
                let [approaches, _] = approaches.sides();
                let side = (levels.lines.as_slice(), approaches);
                for target in levels.targets() {
                    self.reduce(&mut blocked, enough, |cylinder| {
                        self.blocks_target(target, side, cylinder)
                    });
                }
            }
        }
        blocked
    }

    /// Lowers the count to distances that are surely met.
    fn reduce(&self, blocked: &mut usize, enough: usize, mut meets: impl FnMut(Cylinder) -> bool) {
        while *blocked > enough {
            let smallest = self.distances.get(*blocked - 1);
            if smallest.is_some_and(|cylinder| meets(*cylinder)) {
                return;
            }
            *blocked -= 1;
        }
    }

    /// Lowers the count by the steps of one side, up to the one on the way to which the smallest distances are
    /// met.
    fn reduce_by_side(&self, blocked: &mut usize, fan: &Fan, side: Side, enough: usize) {
        let lookahead_s = self.met.settings.lookahead_s;
        let last = libm::floor(lookahead_s / fan.step_s);
        for (index, line) in side.0.iter().enumerate() {
            let since_s = line.since_s;
            let until_s = if fan.step_s == 0.0 {
                self.horizon_s
            } else {
                self.met.horizon_s(self.horizon_s, since_s)
            };
            let on_the_way = fan.step_s > 0.0 && since_s < lookahead_s && index as f64 <= last;
            let mut stops = false;
            self.reduce(blocked, enough, |cylinder| {
                let window = self.window(side, index, cylinder);
                stops = on_the_way && self.is_within(window, since_s, since_s + fan.step_s);
                stops || self.is_within(window, since_s, until_s.min(lookahead_s))
            });
            if stops || *blocked <= enough {
                return;
            }
        }
    }

    fn window(&self, (lines, approaches): Side, index: usize, cylinder: Cylinder) -> Loss {
        match (lines.get(index), approaches.get(index)) {
            (Some(line), Some(approach)) => {
                self.met.window(&Volume::Cylinder(cylinder), line, approach)
            }
            _ => Loss::NEVER,
        }
    }

    /// A time that rounding cannot make, seconds.
    fn clear_s(&self) -> f64 {
        1e-6 * (1.0 + self.met.settings.lookahead_s)
    }

    /// Whether a window surely has a part between two times.
    fn is_within(&self, window: Loss, from_s: f64, to_s: f64) -> bool {
        window.exit_s.min(to_s) - window.entry_s.max(from_s) > self.clear_s()
    }

    /// Whether flying to an altitude surely meets a cylinder.
    fn blocks_target(&self, target: &Target, side: Side, cylinder: Cylinder) -> bool {
        let lookahead_s = self.met.settings.lookahead_s;
        let until_s = |maneuver_s: f64| self.met.horizon_s(self.horizon_s, maneuver_s.max(0.0));
        let meets = |index: usize, until_s: f64| {
            let since_s = side.0.get(index).map_or(f64::INFINITY, |line| line.since_s);
            let window = self.window(side, index, cylinder);
            self.is_within(window, since_s.max(0.0), until_s.min(lookahead_s))
        };
        let Some(way) = target.way() else {
            return meets(target.first_line(), self.horizon_s);
        };
        let (rate, level) = target.rate_and_level();
        let rate_until_s = until_s(way.rate_since_s).min(way.rate_until_s);
        if meets(rate, rate_until_s) || meets(level, until_s(way.level_since_s)) {
            return true;
        }
        // On the other lines the ownship is for a moment.
        (target.first_line()..rate)
            .chain(rate + 1..level)
            .any(|index| {
                side.0.get(index).is_some_and(|line| {
                    let window = self.window(side, index, cylinder);
                    line.since_s < lookahead_s
                        && window.entry_s <= line.since_s
                        && self.is_within(window, line.since_s, line.since_s + 1.0)
                })
            })
    }
}
