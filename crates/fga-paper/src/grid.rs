//! Algorithm 2, corrected: the cheapest direction on a grid of course and climb angle that clears
//! every obstacle (§3.5, Tables 3 and 7).
//!
//! As in the paper, the aircraft flies the new direction at once; the turn-aware search counts the
//! real turn.
//!
//! Course changes: left is positive. Corrections (`docs/errata-algorithms.md`): the grid is mirror-symmetric
//! with both ends and the middle; the separation is that of the relative path while closing; the
//! cost takes absolute deviations.

use crate::conflict::{Relative, inside_during, least_margin};
use fga::angle::direction;
use fga::certificate::Hazard;
use fga::limit::Limit as _;
use fga::situation::Ownship;

/// The allowed directions (§3.5).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TurnMode {
    /// Heading manoeuvres only: the climb angle stays.
    HeadingOnly,
    /// Pitching manoeuvres only: the course stays.
    PitchOnly,
    /// Both at once.
    #[default]
    Spatial,
}

/// The grid and its costs. The default is the paper's: ±135° × ±15°, 0.2 and 0.5 (Tables 4 and 7).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Largest change of course to either side `ψ_range`, radians.
    pub heading_range_rad: f64,
    /// Largest step between two courses, radians; reduced so that the steps fill the range.
    pub heading_step_rad: f64,
    /// Least climb angle, radians.
    pub climb_min_rad: f64,
    /// Largest climb angle, radians.
    pub climb_max_rad: f64,
    /// Largest step between two climb angles, radians; reduced in the same way.
    pub pitch_step_rad: f64,
    /// Cost of a change of course `η_ψ`, per radian.
    pub heading_cost: f64,
    /// Cost of a change of climb angle `η_θ`, per radian.
    pub pitch_cost: f64,
    /// Separation kept beyond every volume, metres.
    pub margin_m: f64,
    /// The allowed directions.
    pub mode: TurnMode,
}

impl Default for Grid {
    fn default() -> Self {
        Self {
            heading_range_rad: 135.0_f64.to_radians(),
            heading_step_rad: 0.1,
            climb_min_rad: -15.0_f64.to_radians(),
            climb_max_rad: 15.0_f64.to_radians(),
            pitch_step_rad: 0.03,
            heading_cost: 0.2,
            pitch_cost: 0.5,
            margin_m: 0.0,
            mode: TurnMode::Spatial,
        }
    }
}

/// Most steps to one side, so that a step near zero does not take forever.
const MAX_STEPS: f64 = 1000.0;

/// Steps that fill `range_rad`, none longer than `step_rad`.
fn steps(range_rad: f64, step_rad: f64) -> i32 {
    // The small allowance keeps 15°/5° at 3 steps.
    let count = libm::ceil(range_rad / step_rad - 1e-9);
    if count.is_nan() || count <= 0.0 {
        return 0;
    }
    #[expect(clippy::cast_possible_truncation, reason = "at most MAX_STEPS")]
    let count = count.min(MAX_STEPS) as i32;
    count
}

/// One row of the cost table (Table 3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridEntry {
    /// Index in the grid: 0 keeps the course, positive to the left.
    pub heading_index: i32,
    /// Index in the grid: 0 keeps the climb angle, positive up.
    pub pitch_index: i32,
    /// Change of course, radians, positive to the left.
    pub heading_change_rad: f64,
    /// New course, radians, not wrapped: the old one plus the change.
    pub course_rad: f64,
    /// New climb angle, radians.
    pub climb_rad: f64,
    /// `η_ψ` |Δψ| + `η_θ` |Δθ| (Alg. 2 line 20).
    pub cost: f64,
    /// Least signed distance to the volumes that the aircraft is outside of, metres (Alg. 2 line
    /// 18); infinite without any.
    pub margin_m: f64,
    /// Time of leaving the last of the volumes that the aircraft is inside of, seconds; 0 without any.
    pub exit_s: f64,
    /// Whether it clears every volume by the wanted margin.
    pub clears: bool,
}

impl GridEntry {
    /// The kind of manoeuvre; `None` if nothing changes.
    pub const fn mode(&self) -> Option<TurnMode> {
        match (self.heading_index, self.pitch_index) {
            (0, 0) => None,
            (_, 0) => Some(TurnMode::HeadingOnly),
            (0, _) => Some(TurnMode::PitchOnly),
            _ => Some(TurnMode::Spatial),
        }
    }
}

/// The choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Choice {
    /// The cheapest direction that clears everything.
    Clear(GridEntry),
    /// None does: the one that leaves the present volumes soonest, then the one with the largest
    /// least separation.
    Best(GridEntry),
}

impl Choice {
    /// The direction, cleared or not.
    pub const fn entry(&self) -> &GridEntry {
        match self {
            Self::Clear(entry) | Self::Best(entry) => entry,
        }
    }
}

impl Grid {
    /// Whether every number is finite and in range.
    pub fn is_valid(&self) -> bool {
        let not_negative = |value: f64| value.is_finite() && value >= 0.0;
        not_negative(self.heading_range_rad)
            && not_negative(self.heading_cost)
            && not_negative(self.pitch_cost)
            && not_negative(self.margin_m)
            && self.heading_step_rad > 0.0
            && self.pitch_step_rad > 0.0
            && self.climb_min_rad.is_finite()
            && self.climb_max_rad.is_finite()
            && self.climb_min_rad <= self.climb_max_rad
    }

    /// The whole cost table (Table 3) for a turn `start_s` seconds from now, until when the aircraft
    /// holds its course: right to left and, within a course, highest to lowest.
    ///
    /// Empty if the grid, the aircraft's state or the time is invalid. Invalid obstacles do not count.
    /// valid is left out.
    pub fn table<'a>(
        &'a self,
        ownship: &'a Ownship,
        obstacles: &'a [Hazard],
        start_s: f64,
    ) -> impl Iterator<Item = GridEntry> + 'a {
        let time_ok = start_s.is_finite() && start_s >= 0.0;
        let usable = self.is_valid() && ownship.is_valid() && time_ok;
        let at_start = Ownship {
            position_m: ownship.position_m + ownship.velocity_mps() * start_s,
            ..*ownship
        };
        let sides = match self.mode {
            TurnMode::PitchOnly => 0,
            _ => steps(self.heading_range_rad, self.heading_step_rad),
        };
        let now_rad = ownship.climb_rad.limited(
            self.climb_min_rad,
            self.climb_max_rad.max(self.climb_min_rad),
        );
        let (down, up) = match self.mode {
            TurnMode::HeadingOnly => (0, 0),
            _ => (
                steps(now_rad - self.climb_min_rad, self.pitch_step_rad),
                steps(self.climb_max_rad - now_rad, self.pitch_step_rad),
            ),
        };
        (-sides..=sides)
            .filter(move |_| usable)
            .flat_map(move |k| (-down..=up).rev().map(move |j| (k, j)))
            .map(move |(k, j)| {
                let change_rad = fraction(k, sides) * self.heading_range_rad;
                let climb_rad = if j < 0 {
                    now_rad - fraction(-j, down) * (now_rad - self.climb_min_rad)
                } else {
                    now_rad + fraction(j, up) * (self.climb_max_rad - now_rad)
                };
                self.entry(
                    &at_start,
                    (obstacles, start_s),
                    (k, j),
                    change_rad,
                    climb_rad,
                )
            })
    }

    fn entry(
        &self,
        ownship: &Ownship,
        (obstacles, start_s): (&[Hazard], f64),
        (heading_index, pitch_index): (i32, i32),
        heading_change_rad: f64,
        climb_rad: f64,
    ) -> GridEntry {
        let course_rad = ownship.course_rad + heading_change_rad;
        let velocity_mps = direction(course_rad, climb_rad) * ownship.airspeed_mps;
        let (mut margin_m, mut exit_s) = (f64::INFINITY, 0.0_f64);
        for obstacle in obstacles {
            let Some(relative) = Relative::new(
                obstacle.position_after_m(start_s) - ownship.position_m,
                velocity_mps - obstacle.velocity_mps,
            ) else {
                continue;
            };
            if obstacle.volume.margin_m(relative.position_m()) < 0.0 {
                let interval = inside_during(&relative, &obstacle.volume);
                exit_s = exit_s.max(interval.map_or(0.0, |(_, exit_s)| exit_s));
            } else {
                margin_m = margin_m.min(least_margin(&relative, &obstacle.volume).margin_m);
            }
        }
        GridEntry {
            heading_index,
            pitch_index,
            heading_change_rad,
            course_rad,
            climb_rad,
            cost: self.heading_cost * heading_change_rad.abs()
                + self.pitch_cost * (climb_rad - ownship.climb_rad).abs(),
            margin_m,
            exit_s,
            clears: exit_s == 0.0 && margin_m >= self.margin_m,
        }
    }
}

fn fraction(index: i32, count: i32) -> f64 {
    if count == 0 {
        0.0
    } else {
        f64::from(index) / f64::from(count)
    }
}

/// Chooses a direction (Alg. 2 lines 10–24, corrected) for a turn that begins `start_s` seconds
/// from now; until then the aircraft holds its course.
///
/// Of equal costs it takes the one with the larger separation, of equal separations the one to the
/// right, then the higher one. `None` if the grid, the aircraft's state or the time is invalid.
pub fn select(
    grid: &Grid,
    ownship: &Ownship,
    obstacles: &[Hazard],
    start_s: f64,
) -> Option<Choice> {
    let mut clear: Option<GridEntry> = None;
    let mut best: Option<GridEntry> = None;
    for entry in grid.table(ownship, obstacles, start_s) {
        if entry.clears && clear.is_none_or(|known| cheaper(&entry, &known)) {
            clear = Some(entry);
        }
        if best.is_none_or(|known| safer(&entry, &known)) {
            best = Some(entry);
        }
    }
    clear.map(Choice::Clear).or(best.map(Choice::Best))
}

/// Differences below rounding do not decide.
const SAME: f64 = 1e-9;

fn cheaper(one: &GridEntry, other: &GridEntry) -> bool {
    if (one.cost - other.cost).abs() > SAME {
        one.cost < other.cost
    } else {
        one.margin_m > other.margin_m + SAME
    }
}

fn safer(one: &GridEntry, other: &GridEntry) -> bool {
    let differs = |a: f64, b: f64| (a - b).abs() > SAME;
    if differs(one.exit_s, other.exit_s) {
        one.exit_s < other.exit_s
    } else if differs(one.margin_m, other.margin_m) {
        one.margin_m > other.margin_m
    } else {
        one.cost < other.cost - SAME
    }
}

#[cfg(test)]
mod tests;
