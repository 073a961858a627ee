//! Which distances of recovery block every maneuver, found without a search for each of them.
//!
//! The window in which a line is in a cylinder grows with the cylinder, also in floating point: radius and half
//! height enter through sums, products, quotients and square roots, whose rounding keeps order. So a line that
//! is in a cylinder for a time beyond rounding is in each larger one too, and one look at a line at the smallest
//! distances in question rules out all larger ones.

use crate::bands::level::Target;
use crate::bands::met::{Approaches, Met};
use crate::bands::opening::clear_s;
use crate::bands::path::{Fan, Line};
use crate::bands::ways::Ways;
use crate::loss::Loss;
use crate::settings::Settings;
use crate::volume::{Approach, Cylinder, Volume};

/// An aircraft that recovery keeps away from.
#[derive(Debug)]
pub(super) struct Avoided<'a> {
    pub(super) met: Met<'a>,
    pub(super) approaches: &'a Approaches,
    /// Horizon of its conflict, seconds.
    pub(super) horizon_s: f64,
}

/// Distances of recovery from some aircraft.
pub(super) struct Blocking<'a> {
    pub(super) settings: &'a Settings,
    pub(super) aircraft: &'a [Avoided<'a>],
    /// None of them smaller than the next.
    pub(super) distances: &'a [Cylinder],
}

/// What a line meets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Found {
    /// Perhaps nothing.
    Unclear,
    /// The cylinder, on the line.
    Met,
    /// The cylinder, on the way to the next line.
    Stop,
}

impl Blocking<'_> {
    /// How many distances, counted from the largest, surely block every way.
    ///
    /// A step, or an altitude, is blocked where it meets any of the aircraft.
    pub(super) fn count(&self, ways: &Ways) -> usize {
        let mut blocked = self.distances.len();
        // The aircraft that blocked last is asked first.
        let mut last = 0;
        match ways {
            Ways::Fan(fan) => {
                for (side, lines) in fan.sides.iter().enumerate() {
                    self.reduce_by_side(&mut blocked, &mut last, fan, (side, lines));
                }
            }
            Ways::Levels(levels) => {
                for target in levels.targets() {
                    self.reduce(&mut blocked, &mut last, |avoided, cylinder| {
                        let line = SideLines::of(avoided, 0, &levels.lines);
                        if self.blocks_target(avoided, target, &line, cylinder) {
                            Found::Met
                        } else {
                            Found::Unclear
                        }
                    });
                }
            }
        }
        blocked
    }

    /// Lowers the count to distances that surely meet an aircraft; says how.
    fn reduce(
        &self,
        blocked: &mut usize,
        last: &mut usize,
        meets: impl Fn(&Avoided, Cylinder) -> Found,
    ) -> Found {
        while let Some(smallest) = blocked.checked_sub(1) {
            let Some(cylinder) = self.distances.get(smallest) else {
                break;
            };
            let (before, from) = self.aircraft.split_at_checked(*last).unwrap_or_default();
            let asked = from.iter().zip(*last..).chain(before.iter().zip(0..));
            for (avoided, index) in asked {
                let found = meets(avoided, *cylinder);
                if found != Found::Unclear {
                    *last = index;
                    return found;
                }
            }
            *blocked = smallest;
        }
        Found::Unclear
    }

    /// Lowers the count by the steps of one side, up to the one on the way to which the smallest distances are
    /// met.
    fn reduce_by_side(
        &self,
        blocked: &mut usize,
        last: &mut usize,
        fan: &Fan,
        (side, lines): (usize, &[Line]),
    ) {
        let lookahead_s = self.settings.lookahead_s;
        let last_step = libm::floor(lookahead_s / fan.step_s);
        for (index, line) in lines.iter().enumerate() {
            let since_s = line.since_s;
            let on_the_way = fan.step_s > 0.0 && since_s < lookahead_s && index as f64 <= last_step;
            let found = self.reduce(blocked, last, |avoided, cylinder| {
                let until_s = if fan.step_s == 0.0 {
                    avoided.horizon_s
                } else {
                    avoided.met.horizon_s(avoided.horizon_s, since_s)
                };
                let window = SideLines::of(avoided, side, lines).window(index, cylinder);
                if on_the_way && self.is_within(window, since_s, since_s + fan.step_s) {
                    Found::Stop
                } else if self.is_within(window, since_s, until_s.min(lookahead_s)) {
                    Found::Met
                } else {
                    Found::Unclear
                }
            });
            if found == Found::Stop || *blocked == 0 {
                return;
            }
        }
    }

    /// Whether a window surely has a part between two times: for a time that rounding cannot make.
    fn is_within(&self, window: Loss, from_s: f64, to_s: f64) -> bool {
        window.exit_s.min(to_s) - window.entry_s.max(from_s) > clear_s(self.settings.lookahead_s)
    }

    /// Whether flying to an altitude surely meets a cylinder.
    fn blocks_target(
        &self,
        avoided: &Avoided,
        target: &Target,
        lines: &SideLines,
        cylinder: Cylinder,
    ) -> bool {
        let lookahead_s = self.settings.lookahead_s;
        let horizon_s = avoided.horizon_s;
        let until_s = |maneuver_s: f64| avoided.met.horizon_s(horizon_s, maneuver_s.max(0.0));
        let meets = |index: usize, until_s: f64| {
            let since_s = lines.since_s(index);
            let window = lines.window(index, cylinder);
            self.is_within(window, since_s, until_s.min(lookahead_s))
        };
        let Some(way) = target.way() else {
            return meets(target.first_line(), horizon_s);
        };
        let (rate, level) = target.rate_and_level();
        let rate_until_s = until_s(way.rate_since_s).min(way.rate_until_s);
        if meets(rate, rate_until_s) || meets(level, until_s(way.level_since_s)) {
            return true;
        }
        // On the other lines the ownship is for a moment.
        let mut moments = (target.first_line()..rate).chain(rate + 1..level);
        moments.any(|index| {
            let since_s = lines.since_s(index);
            let window = lines.window(index, cylinder);
            since_s < lookahead_s
                && window.entry_s <= since_s
                && self.is_within(window, since_s, since_s + 1.0)
        })
    }
}

/// The lines of one side and how they approach an aircraft.
struct SideLines<'a> {
    met: &'a Met<'a>,
    lines: &'a [Line],
    approaches: &'a [Approach],
}

impl<'a> SideLines<'a> {
    fn of(avoided: &'a Avoided<'a>, side: usize, lines: &'a [Line]) -> Self {
        Self {
            met: &avoided.met,
            lines,
            approaches: avoided.approaches.side(side),
        }
    }

    fn since_s(&self, index: usize) -> f64 {
        self.lines
            .get(index)
            .map_or(f64::INFINITY, |line| line.since_s)
    }

    fn window(&self, index: usize, cylinder: Cylinder) -> Loss {
        match (self.lines.get(index), self.approaches.get(index)) {
            (Some(line), Some(approach)) => {
                self.met.window(&Volume::Cylinder(cylinder), line, approach)
            }
            _ => Loss::NEVER,
        }
    }
}
