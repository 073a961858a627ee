//! Which distances of recovery block every maneuver, found without a search for each of them.
//!
//! The window in which a line is in a cylinder grows with the cylinder, also in floating point: radius and half
//! height enter through sums, products, quotients and square roots, whose rounding keeps order. So a line that
//! is in a cylinder for a time beyond rounding is in each larger one too, and one look at a line at the smallest
//! distances in question rules out all larger ones.

use crate::bands::level::Target;
use crate::bands::met::Met;
use crate::bands::met::clear_s;
use crate::bands::path::Line;
use crate::bands::ways::Ways;
use crate::loss::Loss;
use crate::settings::Settings;
use crate::volume::{Approach, Cylinder, Volume};

/// An aircraft that recovery keeps away from.
#[derive(Debug)]
pub(super) struct Avoided<'a> {
    pub(super) met: Met<'a>,
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
                for lines in &fan.sides {
                    self.reduce_by_side(&mut blocked, &mut last, fan.step_s, lines);
                }
            }
            Ways::Levels(levels) => {
                for target in levels.targets() {
                    self.reduce(&mut blocked, &mut last, |avoided, cylinder| {
                        if self.blocks_target(avoided, target, &levels.lines, cylinder) {
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
    fn reduce_by_side(&self, blocked: &mut usize, last: &mut usize, step_s: f64, lines: &[Line]) {
        let lookahead_s = self.settings.lookahead_s;
        let last_step = libm::floor(lookahead_s / step_s);
        for (index, line) in lines.iter().enumerate() {
            let since_s = line.since_s;
            let on_the_way = step_s > 0.0 && since_s < lookahead_s && index as f64 <= last_step;
            let found = self.reduce(blocked, last, |avoided, cylinder| {
                let until_s = if step_s == 0.0 {
                    avoided.horizon_s
                } else {
                    avoided.met.horizon_s(avoided.horizon_s, since_s)
                };
                let window = avoided.window(line, cylinder);
                if on_the_way && self.is_within(window, since_s, since_s + step_s) {
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
        lines: &[Line],
        cylinder: Cylinder,
    ) -> bool {
        let lookahead_s = self.settings.lookahead_s;
        let horizon_s = avoided.horizon_s;
        let until_s = |maneuver_s: f64| avoided.met.horizon_s(horizon_s, maneuver_s.max(0.0));
        let meets = |index: usize, until_s: f64| {
            lines.get(index).is_some_and(|line| {
                let window = avoided.window(line, cylinder);
                self.is_within(window, line.since_s, until_s.min(lookahead_s))
            })
        };
        let Some(way) = target.way() else {
            return meets(target.level(), horizon_s);
        };
        let rate_until_s = until_s(way.rate_since_s).min(way.rate_until_s);
        if meets(way.rate(), rate_until_s) || meets(target.level(), until_s(way.level_since_s)) {
            return true;
        }
        // On the other lines the ownship is for a moment.
        let mut moments = way.early().chain(target.late());
        moments.any(|index| {
            lines.get(index).is_some_and(|line| {
                let since_s = line.since_s;
                let window = avoided.window(line, cylinder);
                since_s < lookahead_s
                    && window.entry_s <= since_s
                    && self.is_within(window, since_s, since_s + 1.0)
            })
        })
    }
}

impl Avoided<'_> {
    /// When a line meets a cylinder around the aircraft.
    fn window(&self, line: &Line, cylinder: Cylinder) -> Loss {
        let approach = Approach::of(&line.state, self.met.intruder);
        let volume = Volume::Cylinder(cylinder);
        self.met.window(&volume, line, &approach)
    }
}
