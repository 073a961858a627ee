//! The content of a command: a [`Maneuver`], a list of [`Stage`]s.

use crate::limit::Limit as _;
use crate::list::List;

/// Most stages of a manoeuvre: the corners of a mission of short legs up to the horizon, and two turns
/// with their climbs after them. A recorded path that turns has a corner each 0.7 s; what is not predicted of it counts as
/// straight, and let the policy avoid conflicts that the mission does not have.
pub const MAX_STAGES: usize = 40;

/// A command from a moment on, until the next stage begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// Its start, seconds from the moment of the decision.
    pub start_s: f64,
    /// Course to turn to, radians. Not wrapped: the aircraft turns by the plain difference to its
    /// own course, which distinguishes the side and turns beyond 180°.
    pub course_rad: f64,
    /// Climb angle to take up, radians.
    pub climb_rad: f64,
    /// Share of the vehicle's largest course rate to turn with, in (0, 1]; a wider turn takes less.
    pub rate_share: f64,
}

impl Stage {
    /// A stage at the largest course rate.
    pub const fn turn(start_s: f64, course_rad: f64, climb_rad: f64) -> Self {
        Self {
            start_s,
            course_rad,
            climb_rad,
            rate_share: 1.0,
        }
    }
}

/// Some stages `elapsed_s` later: of the past ones only the last one stays.
pub fn later(stages: &[Stage], elapsed_s: f64) -> impl Iterator<Item = Stage> {
    let is_over = |next: &&Stage| next.start_s <= elapsed_s;
    // Of the first stages, which are in order, those whose next one has begun.
    let over = stages.iter().skip(1).take_while(is_over).count();
    stages.iter().skip(over).map(move |stage| Stage {
        start_s: (stage.start_s - elapsed_s).max(0.0),
        ..*stage
    })
}

/// A sequence of stages, first to last; empty means: hold course and climb angle.
///
/// The aircraft flies it if nothing new happens. A plant without lag flies it exactly:
/// course and climb angle move at their rate limits to the commanded values and stay there.
pub type Maneuver = StageList<MAX_STAGES>;

/// At most `N` stages, first to last.
#[derive(Clone, Copy, PartialEq)]
pub struct StageList<const N: usize> {
    list: List<Stage, N>,
    /// Whether a pushed stage was refused.
    is_cut: bool,
}

impl<const N: usize> core::fmt::Debug for StageList<N> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Maneuver")
            .field("stages", &self.stages())
            .field("whole", &self.is_whole())
            .finish_non_exhaustive()
    }
}

impl<const N: usize> Default for StageList<N> {
    fn default() -> Self {
        Self::hold()
    }
}

impl<const N: usize> StageList<N> {
    /// Hold course and climb angle.
    pub const HOLD: Self = Self::hold();

    /// Hold course and climb angle: zeros, which are written without a copy.
    #[inline]
    pub const fn hold() -> Self {
        let stage = Stage {
            start_s: 0.0,
            course_rad: 0.0,
            climb_rad: 0.0,
            rate_share: 0.0,
        };
        Self {
            list: List::new(stage),
            is_cut: false,
        }
    }

    /// Turn to `course_rad` (not wrapped) and take up `climb_rad` from `start_s` on.
    #[inline]
    pub fn turn(start_s: f64, course_rad: f64, climb_rad: f64) -> Self {
        let mut maneuver = Self::hold();
        maneuver.push(Stage::turn(start_s, course_rad, climb_rad));
        maneuver
    }

    /// Takes other stages in place of its own.
    pub fn set(&mut self, stages: impl IntoIterator<Item = Stage>) {
        self.list.clear();
        self.is_cut = false;
        for stage in stages {
            self.push(stage);
        }
    }

    /// The stages that begin before a moment, seconds.
    pub fn before(&self, start_s: f64) -> impl Iterator<Item = Stage> {
        let stages = self.stages().iter();
        stages.filter(move |stage| stage.start_s < start_s).copied()
    }

    /// Keeps only the first stages.
    pub fn truncate(&mut self, most: usize) {
        self.list.truncate(most);
    }

    /// Takes the commands of another manoeuvre `elapsed_s` later.
    pub fn set_later(&mut self, earlier: &Self, elapsed_s: f64) {
        self.set(later(earlier.stages(), elapsed_s));
        self.is_cut |= earlier.is_cut;
    }

    /// The same with room for another number of stages.
    pub fn to<const M: usize>(&self) -> StageList<M> {
        let mut other = StageList::hold();
        other.set(self.stages().iter().copied());
        other.is_cut |= self.is_cut;
        other
    }

    /// Limits its climb angles, radians.
    pub fn limit_climbs(&mut self, low: f64, high: f64) {
        for stage in self.list.iter_mut() {
            stage.climb_rad = stage.climb_rad.limited(low, high);
        }
    }

    /// Appends a stage. It refuses a stage beyond the capacity, one that begins before the last, one with a
    /// number that is not finite, and one with a share of the rate that is not in (0, 1]; then the manoeuvre is no longer [whole](Self::is_whole).
    #[inline]
    pub fn push(&mut self, stage: Stage) -> bool {
        let numbers = [
            stage.start_s,
            stage.course_rad,
            stage.climb_rad,
            stage.rate_share,
        ];
        let in_order = self
            .stages()
            .last()
            .is_none_or(|last| stage.start_s >= last.start_s);
        let usable = in_order
            && numbers.iter().all(|number| number.is_finite())
            && stage.rate_share > 0.0
            && stage.rate_share <= 1.0;
        let is_taken = usable && self.list.push(stage).is_some();
        self.is_cut |= !is_taken;
        is_taken
    }

    /// Whether it took every pushed stage. A manoeuvre that lost a stage is another flight, and no certificate
    /// covers it.
    pub const fn is_whole(&self) -> bool {
        !self.is_cut
    }

    /// Number of free stages.
    pub fn room(&self) -> usize {
        N - self.list.len()
    }

    /// The stages, first to last.
    #[inline]
    pub fn stages(&self) -> &[Stage] {
        &self.list
    }

    /// The same commands `elapsed_s` later: of the past stages only the last one stays.
    #[must_use]
    pub fn after(&self, elapsed_s: f64) -> Self {
        let mut later = Self::hold();
        later.set_later(self, elapsed_s);
        later
    }

    /// The command `at_s` seconds from the decision; `None` before the first stage.
    #[inline]
    pub fn stage_at(&self, at_s: f64) -> Option<&Stage> {
        self.stages()
            .iter()
            .rev()
            .find(|stage| stage.start_s <= at_s)
    }
}
