//! Rows of the family: all manoeuvres that differ only in their last turn.
//!
//! A row has a prefix (a wait, or a first turn with a climb and a gap), a side, and the climb target of its last turn. The
//! aircraft flies the prefix, then turns by any angle of a range. Turns of a row share their arc, so a turn that fails rules out
//! its neighbours.

use fga_proof::angle::Side;
use fga_proof::limit::Limit as _;
use fga_proof::maneuver::Maneuver;
use fga_proof::prediction::{MotionState, flown};

use super::line::{Climbing, Entry, Tangent, Way};
use super::tuned::{STEP_RAD, USUAL};
use super::{MAX_TURN_RAD, Search, SecondTurn, Turns};

/// Most lines on the way to a turn that may stay clear.
const LINES: usize = 24;

/// Least step of a row, radians: a window that is narrower has no margin to speak of.
const LEAST_STEP_RAD: f64 = 1e-2;

/// Most steps towards the least turn that may stay clear.
const NEARER: usize = 3;

/// What precedes the last turn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prefix {
    /// The aircraft when it departs from the mission.
    pub leaves: MotionState,
    /// First turn and climb, radians, if the last turn is the second one.
    pub first: Option<(f64, f64)>,
    /// Where the last turn begins.
    pub entry: Entry,
}

impl Prefix {
    pub(super) const NONE: Self = Self {
        leaves: MotionState::ahead(0.0),
        first: None,
        entry: Entry::NONE,
    };

    /// The member of a row with this last turn, radians towards its side.
    pub(super) fn turns(&self, way: &Way, turn_rad: f64) -> Turns {
        let Self {
            leaves,
            first,
            entry,
        } = self;
        let to_rad = entry.from.course_rad + way.side.sign() * turn_rad - leaves.course_rad;
        let climb_rad = way.climbing.climb_rad;
        let wait_s = leaves.time_s;
        let Some((first_rad, first_climb)) = *first else {
            return Turns {
                wait_s,
                turn_rad: to_rad,
                climb_rad,
                second: None,
            };
        };
        Turns {
            wait_s,
            turn_rad: first_rad,
            climb_rad: first_climb,
            second: Some(SecondTurn {
                after_s: entry.from.time_s - wait_s,
                turn_rad: to_rad - first_rad,
                climb_rad,
            }),
        }
    }
}

/// A row, and how much of it is ruled out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    /// Its prefix, by number.
    pub prefix: usize,
    /// The side of its first turn.
    pub first: Side,
    pub way: Way,
    /// The next turn, radians towards the side: all from the beginning of the row to here are ruled out.
    pub at_rad: f64,
    /// The last turn of the row, radians.
    pub to_rad: f64,
    /// The last turn that failed, radians.
    pub fails_rad: Option<f64>,
    /// Whether the line of the next turn stays clear.
    pub is_ready: bool,
    /// The least step after a turn that fails, radians; each flight doubles it.
    pub least_step_rad: f64,
    /// Lower bound of the cost of its members; once the next one is ready, about its cost.
    pub cost: f64,
}

impl Row {
    pub(super) const NONE: Self = Self {
        prefix: 0,
        first: Side::Left,
        way: Way {
            side: Side::Left,
            climbing: Climbing::NONE,
        },
        at_rad: 0.0,
        to_rad: 0.0,
        fails_rad: None,
        is_ready: false,
        least_step_rad: 0.0,
        cost: 0.0,
    };

    /// +1 if its turns grow, −1 if they shrink.
    pub(super) fn direction(&self) -> f64 {
        libm::copysign(1.0, self.to_rad - self.at_rad)
    }

    /// Advances by some radians; beyond its end the row is empty.
    fn step(&mut self, by_rad: f64) {
        let direction = self.direction();
        self.fails_rad = Some(self.at_rad);
        self.is_ready = false;
        self.at_rad += direction * by_rad;
        if direction * (self.to_rad - self.at_rad) < 0.0 {
            self.close();
        }
    }

    /// Removes the row from the search.
    pub(super) const fn close(&mut self) {
        self.cost = f64::INFINITY;
    }
}

impl Search<'_> {
    /// Turns that begin after a wait on the mission.
    pub(super) fn after_wait(&self, wait_s: f64) -> Prefix {
        let leaves = self.departure(wait_s);
        Prefix {
            leaves,
            entry: Entry::at(&leaves),
            ..Prefix::NONE
        }
    }

    /// Turns that begin some time after a first turn that begins now.
    pub(super) fn after_first(&self, (turn_rad, climb_rad): (f64, f64), after_s: f64) -> Prefix {
        let scene = &self.scene;
        let leaves = scene.start;
        let first = Maneuver::turn(0.0, leaves.course_rad + turn_rad, climb_rad);
        let from = flown(scene.flyer, &leaves, &first, after_s, &self.meter);
        Prefix {
            leaves,
            first: Some((turn_rad, climb_rad)),
            entry: Entry::at(&from),
        }
    }

    /// The row of turns to a side from rolling out at once on.
    pub(super) fn row(&mut self, prefix: &Prefix, climbing: &Climbing, side: Side) -> Option<Row> {
        let bank_rad = side.sign() * prefix.entry.from.bank_rad;
        Some(Row {
            first: prefix
                .first
                .map_or(side, |(turn_rad, _)| Side::of(turn_rad)),
            way: Way {
                side,
                climbing: *climbing,
            },
            at_rad: self.bend(bank_rad, side)?.least_rad(),
            to_rad: MAX_TURN_RAD,
            least_step_rad: LEAST_STEP_RAD,
            ..Row::NONE
        })
    }

    /// The line of the next turn of a row.
    pub(super) fn line(&mut self, prefix: &Prefix, row: &Row) -> Option<Tangent> {
        self.tangent(&prefix.entry, &row.way, row.at_rad)
    }

    /// Advances a row to about the first turn whose line stays clear and returns that line. `None` where the row has none, which
    /// closes it, or where more looks are needed.
    pub(super) fn advance(&mut self, prefix: &Prefix, row: &mut Row) -> Option<Tangent> {
        let target_m = self.scene.target_m;
        let enough_m = target_m + 2.0 * self.scene.turn_radius_m();
        // The last turn that fails, the last one whose line stays clear, and the margins of their lines beyond the target, metres.
        let (mut fails, mut does) = (None::<(f64, f64)>, None::<(f64, f64, Tangent)>);
        let mut tries = NEARER;
        for _ in 0..LINES {
            if self.limit_met() || row.cost == f64::INFINITY {
                break;
            }
            let tangent = self.line(prefix, row);
            let look = tangent
                .and_then(|tangent| self.look(&tangent, (target_m - tangent.inexact_m, enough_m)));
            let (Some(tangent), Some(look)) = (tangent, look) else {
                row.close();
                break;
            };
            let over_m = look.margin_m - target_m;
            let at_rad = row.at_rad;
            if over_m >= 0.0 {
                does = Some((at_rad, over_m, tangent));
            } else {
                fails = Some((at_rad, over_m));
                if does.is_none() {
                    self.rule_out(row, -over_m, look.left_s);
                    continue;
                }
            }
            let (Some((fails_rad, fails_m)), Some((does_rad, does_m, _))) = (fails, does) else {
                break;
            };
            if tries == 0 || does_m <= self.near_m() {
                break;
            }
            tries -= 1;
            // Where the line between both margins meets the target.
            let share = (0.5 * self.near_m() - fails_m) / (does_m - fails_m);
            row.at_rad = fails_rad + share.limited(0.1, 0.9) * (does_rad - fails_rad);
        }
        let (does_rad, _, tangent) = does?;
        (row.at_rad, row.is_ready) = (does_rad, true);
        row.fails_rad = fails.map(|fails| fails.0).or(row.fails_rad);
        Some(tangent)
    }

    /// Rules out the neighbours of a turn that lacks some metres `left_s` after longer turns part from it.
    pub(super) fn rule_out(&self, row: &mut Row, short_m: f64, left_s: f64) {
        let least_rad = if row.direction() > 0.0 {
            self.least_more_rad(short_m, left_s)
        } else {
            self.least_less_rad(short_m, left_s)
        };
        row.step(
            least_rad
                .max((least_rad / USUAL).min(0.5 * STEP_RAD))
                .max(row.least_step_rad),
        );
    }
}
