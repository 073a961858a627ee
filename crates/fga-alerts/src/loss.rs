//! The time interval of a violation.

use crate::almost::Closeness;

/// Start and end of a violation along straight lines, seconds from now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loss {
    /// Start of the violation.
    pub entry_s: f64,
    /// End of the violation.
    pub exit_s: f64,
}

impl Loss {
    /// No violation at any time.
    pub const NEVER: Self = Self {
        entry_s: f64::INFINITY,
        exit_s: f64::NEG_INFINITY,
    };
    /// A violation at all times.
    pub(crate) const ALWAYS: Self = Self {
        entry_s: f64::NEG_INFINITY,
        exit_s: f64::INFINITY,
    };

    pub(crate) const fn new(entry_s: f64, exit_s: f64) -> Self {
        Self { entry_s, exit_s }
    }

    /// The violation, or [`Loss::NEVER`] for one without duration.
    pub(crate) fn if_lasting(self) -> Self {
        if self.is_conflict() {
            self
        } else {
            Self::NEVER
        }
    }

    /// Whether the violation has a duration.
    pub fn is_conflict(self) -> bool {
        Closeness::Rounding.less(self.entry_s, self.exit_s)
    }

    /// Whether the violation has a duration and starts before `time_s`.
    pub fn begins_before(self, time_s: f64) -> bool {
        (self.entry_s == 0.0 || Closeness::Rounding.less(self.entry_s, time_s))
            && self.is_conflict()
    }

    /// From the first begin to the last end of both, as far as they have a duration.
    pub(crate) fn hull(self, other: Self) -> Self {
        if !other.is_conflict() {
            self.if_lasting()
        } else if !self.is_conflict() {
            other
        } else {
            Self::new(
                self.entry_s.min(other.entry_s),
                self.exit_s.max(other.exit_s),
            )
        }
    }

    /// The intersection.
    pub(crate) fn and(self, other: Self) -> Self {
        Self::new(
            self.entry_s.max(other.entry_s),
            self.exit_s.min(other.exit_s),
        )
    }
}
