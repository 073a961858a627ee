//! Where the authority stands, and what is to be done after an event.

use super::reactions::{Fault, Severity};
use crate::mode::Mode;

/// Where the authority stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Authority {
    /// May not act yet.
    Waiting,
    /// May act; the vehicle flies by itself.
    Ready,
    /// The mode was asked for; targets are already sent.
    Taking {
        /// When it was asked for, seconds.
        since_s: f64,
        /// The mode to go back to.
        previous: Mode,
    },
    /// The vehicle flies what is commanded.
    InCommand {
        /// Since when, seconds.
        since_s: f64,
        /// The mode to go back to.
        previous: Mode,
    },
    /// The previous mode was asked for.
    Returning {
        /// When it was asked for, seconds.
        since_s: f64,
        /// The mode asked for.
        previous: Mode,
    },
    /// The program was restarted in a manoeuvre, or the vehicle is heard again in one; it is not ready to
    /// go on yet.
    Resuming {
        /// Since when, seconds.
        since_s: f64,
        /// The mode to go back to.
        previous: Mode,
        /// What interrupted the manoeuvre: [`Fault::Restarted`] or [`Fault::LinkLost`].
        after: Fault,
    },
    /// May not act until the condition of the fault's row is met.
    Released {
        /// Since when, seconds.
        since_s: f64,
        /// Why.
        fault: Fault,
        /// A mode to restore once the vehicle is heard again.
        owed: Option<Mode>,
        /// A request of our own that may still be on its way.
        late: Option<Late>,
    },
}

/// A request for a mode that was sent before the pilot changed the mode, and may arrive after.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Late {
    /// What was asked for.
    pub asked: Mode,
    /// What the pilot chose.
    pub chosen: Mode,
}

impl Authority {
    /// Name in logs and the status line.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Ready => "ready",
            Self::Taking { .. } => "taking",
            Self::InCommand { .. } => "in-command",
            Self::Returning { .. } => "returning",
            Self::Resuming { .. } => "resuming",
            Self::Released { .. } => "released",
        }
    }
}

/// What is to be done after an event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Ask for a mode, as long as the vehicle is in another one.
    SetMode {
        /// The mode asked for.
        to: Mode,
        /// The mode in which it may be asked for.
        from: Mode,
    },
    /// Stop asking for any mode.
    CancelSetMode,
    /// Tell the operator.
    Tell(Severity, &'static str),
    /// The manoeuvre begins to be flown.
    Began,
    /// A manoeuvre that was begun before a restart goes on.
    Resumed,
    /// Control was handed back as planned.
    Returned,
    /// Control ended by a fault.
    Ended(Fault),
}
