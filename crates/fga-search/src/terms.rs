//! The terms of a search: what is asked of it, and what it answers.

use fga_proof::maneuver::Maneuver;

/// Largest single turn of a search, radians: short of a full circle.
pub const MAX_TURN_RAD: f64 = 6.0;

/// A search for the largest margin caps margins at this value, m.
pub(super) const ENOUGH_M: f64 = 1e3;

/// The side of a turn, as the pilot sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// Anticlockwise from above: the course ψ increases.
    Left,
    /// Clockwise from above: the course ψ decreases.
    Right,
}

impl Side {
    /// Both sides, left first.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// +1 for left, −1 for right: the sign of the course rate of a turn to this side.
    #[inline]
    pub const fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// The opposite side.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// The side to which `angle_rad` turns; zero counts as left.
    pub const fn of(angle_rad: f64) -> Self {
        if angle_rad < 0.0 {
            Self::Right
        } else {
            Self::Left
        }
    }
}

/// A manoeuvre in the terms of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turns {
    /// Wait on the mission, seconds.
    pub wait_s: f64,
    /// First turn, radians, left positive.
    pub turn_rad: f64,
    /// Climb angle of the first turn, radians.
    pub climb_rad: f64,
    /// The second turn, if any.
    pub second: Option<SecondTurn>,
}

impl Turns {
    /// A manoeuvre that is flown from a course, radians, if it is a member of the family.
    pub fn of(maneuver: &Maneuver, course_rad: f64) -> Option<Self> {
        let (first, second) = match maneuver.stages() {
            [first] => (first, None),
            [first, second] => (first, Some(second)),
            _ => return None,
        };
        Some(Self {
            wait_s: first.start_s,
            turn_rad: first.course_rad - course_rad,
            climb_rad: first.climb_rad,
            second: second.map(|second| SecondTurn {
                after_s: second.start_s - first.start_s,
                turn_rad: second.course_rad - first.course_rad,
                climb_rad: second.climb_rad,
            }),
        })
    }
}

/// The second stage of a manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SecondTurn {
    /// Seconds from the start of the first turn to that of the second.
    pub after_s: f64,
    /// Turn from the first course, radians, left positive.
    pub turn_rad: f64,
    /// Climb angle, radians.
    pub climb_rad: f64,
}

/// A manoeuvre with its certificate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The manoeuvre.
    pub turns: Turns,
    /// Lower bound of its separation beyond the volumes, metres.
    pub margin_m: f64,
    /// Its cost by the scene's objective.
    pub cost: f64,
}

/// What is known of the best manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// It keeps the requested separation: the manoeuvre that was laid last has the proof.
    Proven,
    /// It does not, and another search may find one that does.
    Open,
    /// It does not, and hardly another one will.
    Hopeless,
}

/// The measure of the cheapest manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Objective {
    /// `η_ψ` |Δψ| + `η_θ` |Δθ| (Alg. 2).
    #[default]
    PaperCost,
    /// Least largest distance from the mission (§3.3).
    LeastDeviation,
    /// Least extra path (§3.3).
    ShortestPath,
}

/// The departure of a manoeuvre from the mission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Distance from the mission when the last threatening obstacle has passed, metres.
    pub aside_m: f64,
    /// Its lag behind the mission at that time, metres.
    pub behind_m: f64,
}

impl Departure {
    /// Without work left to measure it: farther than any measured one.
    pub(super) const UNKNOWN: Self = Self {
        aside_m: f64::MAX,
        behind_m: 0.0,
    };

    /// Its addition to the path until the aircraft is back, metres: a way back at a moderate
    /// intercept angle adds about a quarter of the distance.
    fn extra_path_m(&self) -> f64 {
        self.behind_m + 0.27 * self.aside_m
    }

    /// What an objective counts, metres.
    pub(super) fn length_m(&self, objective: Objective) -> f64 {
        match objective {
            Objective::PaperCost => self.aside_m + self.extra_path_m(),
            Objective::LeastDeviation => self.aside_m,
            Objective::ShortestPath => self.extra_path_m(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_that_lowers_the_course_is_to_the_right() {
        assert_eq!(Side::of(-0.1), Side::Right);
        assert!(Side::BOTH.iter().all(|side| Side::of(side.sign()) == *side));
    }
}
