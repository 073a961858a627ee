//! What a policy outside of this crate answers, and how it fails.

use core::fmt;

use fga::avoider::Decision;
use fga::situation::Situation;
use fga::vehicle::Vehicle;

use crate::settings::PolicySettings;

/// How a policy failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FailureKind {
    /// It raised an exception.
    Raised,
    /// It gave no answer within the time limit.
    TimedOut,
    /// Its answer has a number that is not finite.
    NotFinite,
    /// Its answer is of another shape than expected.
    WrongShape,
    /// Its program ended, or could not be started.
    Ended,
}

impl FailureKind {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Raised,
        Self::TimedOut,
        Self::NotFinite,
        Self::WrongShape,
        Self::Ended,
    ];

    /// Its word in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Raised => "raised",
            Self::TimedOut => "timed-out",
            Self::NotFinite => "not-finite",
            Self::WrongShape => "wrong-shape",
            Self::Ended => "ended",
        }
    }

    /// The failure of this word.
    pub fn parse(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == word)
    }
}

/// A failure of a policy, as the one who asked it saw it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PolicyFailure {
    /// How it failed.
    pub kind: FailureKind,
    /// What happened and what was expected, without the name of the policy.
    pub message: String,
}

impl PolicyFailure {
    /// A failure of this kind.
    pub fn new(kind: FailureKind, message: impl Into<String>) -> Self {
        Self {
            kind,
            message: message.into(),
        }
    }
}

impl fmt::Display for PolicyFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// The answer of a policy to a situation.
#[derive(Debug, Clone, PartialEq)]
pub enum PolicyAnswer {
    /// It leaves the mission alone.
    Mission,
    /// It turns the shorter way to a course and takes up a climb angle, within the limits of the vehicle.
    Heading {
        /// The course through the air, radians.
        course_rad: f64,
        /// The climb angle, radians.
        climb_rad: f64,
    },
    /// It decides itself, with its own state.
    Decided(Box<Decision>),
}

/// Someone who answers for a policy in one flight after the other.
pub trait Outside: Send {
    /// The answer to a situation.
    ///
    /// # Errors
    /// How the policy failed; it is not asked again before [`Outside::restart`].
    fn answer(&mut self, situation: &Situation<'_>) -> Result<PolicyAnswer, PolicyFailure>;

    /// Applies changed limits of the vehicle, before the next question.
    fn retune(&mut self, vehicle: &Vehicle);

    /// The next question is the first one of another flight.
    fn restart(&mut self);
}

/// Answers nothing: for flights whose answers come all at once.
pub struct Nobody;

impl Outside for Nobody {
    fn answer(&mut self, _situation: &Situation<'_>) -> Result<PolicyAnswer, PolicyFailure> {
        Ok(PolicyAnswer::Mission)
    }

    fn retune(&mut self, _vehicle: &Vehicle) {}

    fn restart(&mut self) {}
}

/// Makes someone who answers, for the settings and limits of a flight.
pub type Make = dyn Fn(&PolicySettings, &Vehicle) -> Box<dyn Outside> + Send + Sync;
