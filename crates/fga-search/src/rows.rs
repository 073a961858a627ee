//! Rows of the family: all manoeuvres that differ only in their last turn.
//!
//! A row has a prefix (a wait, or a first turn with a climb and a gap), a side, and the climb target of its last turn. The
//! aircraft flies the prefix, then turns by any angle of a range. Turns of a row share their arc, so a turn that fails rules out
//! its neighbours.

use crate::Side;
use fga_proof::limit::Limit as _;
use fga_proof::maneuver::Stage;
use fga_proof::prediction::flown;

use super::lattice::{Prefix, Row};
use super::line::Tangent;
use super::tuned::{STEP_RAD, USUAL};
use super::{MAX_TURN_RAD, Search};

/// Most lines on the way to a turn that may stay clear.
const LINES: usize = 24;

/// Least step of a row, radians: a window that is narrower has no margin to speak of.
const LEAST_STEP_RAD: f64 = 1e-2;

/// Most steps towards the least turn that may stay clear.
const NEARER: usize = 3;

impl Search<'_> {
    /// Turns that begin after a wait on the mission.
    pub(super) fn after_wait(&self, wait_s: f64) -> Prefix {
        let entry = self.departure(wait_s);
        Prefix {
            wait_s: entry.time_s,
            from_rad: entry.course_rad,
            first: None,
            entry,
        }
    }

    /// Turns that begin some time after a first turn that begins now.
    pub(super) fn after_first(&self, (turn_rad, climb_rad): (f64, f64), after_s: f64) -> Prefix {
        let scene = self.scene;
        let start = &scene.start;
        let first = [Stage::turn(0.0, start.course_rad + turn_rad, climb_rad)];
        Prefix {
            wait_s: start.time_s,
            from_rad: start.course_rad,
            first: Some((turn_rad, climb_rad)),
            entry: flown(scene.flyer, start, &first, after_s, &self.meter),
        }
    }

    /// The row of turns to a side from rolling out at once on.
    pub(super) fn row(&mut self, prefix: &Prefix, climb_rad: f64, side: Side) -> Option<Row> {
        let bank_rad = side.sign() * prefix.entry.bank_rad;
        Some(Row {
            first: prefix
                .first
                .map_or(side, |(turn_rad, _)| Side::of(turn_rad)),
            side,
            climb_rad,
            at_rad: self.bend(bank_rad, side)?.least_rad(),
            to_rad: MAX_TURN_RAD,
            least_step_rad: LEAST_STEP_RAD,
            ..Row::NONE
        })
    }

    /// Advances a row to about the first turn whose line stays clear and returns that line. `None` where the row has none, which
    /// closes it, or where more looks are needed.
    #[inline(never)]
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
