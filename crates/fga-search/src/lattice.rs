//! The rows of a search, their prefixes, and which row is next.

use crate::Side;
use fga_proof::list::List;
use fga_proof::prediction::MotionState;

use super::tuned::{ASIDE_RAD, CLIMBS, LEVEL_AFTER, STARTS};
use super::{SecondTurn, Turns};

/// Most prefixes: starts, first turns to either side, and climbs and descents that level off.
const PREFIXES: usize = STARTS.len() + 2 * (ASIDE_RAD.len() + 1) + 2 * LEVEL_AFTER.len();

/// Most rows: a start has one for each side and climb target, twice where turns may also lead less far than back to the
/// mission's direction.
pub(super) const ROWS: usize = STARTS.len() * 3 * CLIMBS + PREFIXES;

/// What precedes the last turn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prefix {
    /// When it departs from the mission, seconds, and its course then, radians.
    pub wait_s: f64,
    pub from_rad: f64,
    /// First turn and climb, radians, if the last turn is the second one.
    pub first: Option<(f64, f64)>,
    /// Where the last turn begins.
    pub entry: MotionState,
}

impl Prefix {
    pub(super) const NONE: Self = Self {
        wait_s: 0.0,
        from_rad: 0.0,
        first: None,
        entry: MotionState::ahead(0.0),
    };

    /// The next member of a row.
    pub(super) fn turns(&self, row: &Row) -> Turns {
        let Self { wait_s, entry, .. } = *self;
        let to_rad = entry.course_rad + row.side.sign() * row.at_rad - self.from_rad;
        let climb_rad = row.climb_rad;
        let Some((first_rad, first_climb)) = self.first else {
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
                after_s: entry.time_s - wait_s,
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
    pub prefix: u8,
    /// The side of its first turn.
    pub first: Side,
    /// The side of its last turn, and the climb target taken up during that, radians.
    pub side: Side,
    pub climb_rad: f64,
    /// The next turn, radians towards the side: all from the beginning of the row to here are ruled out.
    pub at_rad: f64,
    /// The last turn of the row, radians.
    pub to_rad: f64,
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
        side: Side::Left,
        climb_rad: 0.0,
        at_rad: 0.0,
        to_rad: 0.0,
        is_ready: false,
        least_step_rad: 0.0,
        cost: 0.0,
    };

    /// +1 if its turns grow, −1 if they shrink.
    pub(super) fn direction(&self) -> f64 {
        libm::copysign(1.0, self.to_rad - self.at_rad)
    }

    /// Advances by some radians; beyond its end the row is empty.
    pub(super) fn step(&mut self, by_rad: f64) {
        let direction = self.direction();
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

/// Rows and their prefixes.
#[derive(Debug, Clone)]
pub(super) struct Lattice {
    pub prefixes: List<Prefix, PREFIXES>,
    pub rows: List<Row, ROWS>,
}

impl Lattice {
    pub(super) const NONE: Self = Self {
        prefixes: List::new(Prefix::NONE),
        rows: List::new(Row::NONE),
    };

    /// Forgets all rows.
    pub(super) const fn clear(&mut self) {
        self.prefixes.clear();
        self.rows.clear();
    }

    /// Adds a prefix; its rows follow.
    pub(super) fn begin(&mut self, prefix: &Prefix) {
        self.prefixes.push(*prefix);
    }

    /// Adds a row of the last prefix.
    pub(super) fn put(&mut self, row: &Row) {
        let prefix = u8::try_from(self.prefixes.len().saturating_sub(1));
        let prefix = prefix.unwrap_or(u8::MAX);
        self.rows.push(Row { prefix, ..*row });
    }

    /// The row that may cost least, and that cost.
    pub(super) fn next(&self) -> Option<(usize, f64)> {
        let mut least = (0, f64::INFINITY);
        for (place, row) in self.rows.iter().enumerate() {
            if row.cost < least.1 {
                least = (place, row.cost);
            }
        }
        (least.1 < f64::INFINITY).then_some(least)
    }

    /// Removes all rows of a prefix.
    pub(super) fn close(&mut self, prefix: u8) {
        for row in self.rows.iter_mut() {
            if row.prefix == prefix {
                row.close();
            }
        }
    }
}
