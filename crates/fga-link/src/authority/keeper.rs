//! The state machine.

mod reported;

use super::stray::Requests;
use super::{Action, Authority, Fault, HandBack, Rearm, Severity, reaction};
use crate::mode::Mode;

/// Time for the take-over to be confirmed, seconds.
const TAKE_OVER_S: f64 = 3.0;
/// Time for the return to be confirmed, seconds.
const RETURN_S: f64 = 5.0;
/// All must be well for this long before it is ready again by itself, seconds.
const SETTLE_S: f64 = 3.0;
/// A restarted program, or one that hears the vehicle again, restores the mode if it is not ready within
/// this time, seconds.
const RESUME_S: f64 = 5.0;

/// The same as [`SETTLE_S`] after a gap in the telemetry, which ends as suddenly as it began, seconds.
const GAP_SETTLE_S: f64 = 0.4;

/// How long all must be well after a fault, seconds.
const fn settle_s(fault: Fault) -> f64 {
    match fault {
        Fault::TelemetryStale | Fault::LinkLost => GAP_SETTLE_S,
        _ => SETTLE_S,
    }
}

/// The state machine of authority. It reads no clock and sends no message.
#[derive(Debug)]
pub struct Keeper {
    state: Authority,
    /// The mode for manoeuvres.
    target: Mode,
    enabled: bool,
    well_since_s: Option<f64>,
    /// Requests for the owed mode since the fault.
    tries: u8,
    /// Start of an unbroken series of disarmed heartbeats, seconds.
    disarmed_s: Option<f64>,
    /// The mode in the last heartbeat.
    told: Option<Mode>,
    requests: Requests,
    /// When the operator last read that nobody flies, seconds.
    nobody_told_s: f64,
}

impl Keeper {
    /// A keeper with `target` as its mode for manoeuvres; `enabled` lets it act before the operator switches it on.
    pub const fn new(target: Mode, enabled: bool) -> Self {
        Self {
            state: Authority::Waiting,
            target,
            enabled,
            well_since_s: None,
            tries: 0,
            disarmed_s: None,
            told: None,
            requests: Requests::NONE,
            nobody_told_s: f64::NEG_INFINITY,
        }
    }

    /// The mode for manoeuvres: the one that it owns.
    pub const fn target(&self) -> Mode {
        self.target
    }

    /// The mode to go back to, while the companion has the flight mode or has requested it.
    const fn previous(&self) -> Option<Mode> {
        match self.state {
            Authority::Taking { previous, .. }
            | Authority::InCommand { previous, .. }
            | Authority::Returning { previous, .. }
            | Authority::Resuming { previous, .. } => Some(previous),
            _ => None,
        }
    }

    /// The mode to restore if the program stops now.
    pub const fn owed(&self) -> Option<Mode> {
        match self.state {
            Authority::Released { owed, .. } => owed,
            _ => self.previous(),
        }
    }

    /// The program restarted in a manoeuvre that began in the mode `previous`.
    pub fn resume(&mut self, previous: Mode, now_s: f64) {
        if self.state == Authority::Waiting {
            self.state = Authority::Resuming {
                since_s: now_s,
                previous,
                after: Fault::Restarted,
            };
        }
    }

    const fn take(&self, previous: Mode) -> Action {
        Action::SetMode {
            to: self.target,
            from: previous,
        }
    }

    const fn restore(&self, previous: Mode) -> Action {
        Action::SetMode {
            to: previous,
            from: self.target,
        }
    }

    /// The present state.
    pub const fn state(&self) -> Authority {
        self.state
    }

    /// Whether the operator lets it act.
    pub const fn is_enabled(&self) -> bool {
        self.enabled
    }

    /// Whether to send attitude targets and the like.
    pub const fn commands(&self) -> bool {
        matches!(
            self.state,
            Authority::Taking { .. } | Authority::InCommand { .. }
        )
    }

    /// Whether the companion has the flight mode, or has requested it.
    pub const fn is_engaged(&self) -> bool {
        self.previous().is_some()
    }

    /// The operator's switch.
    pub fn set_enabled(&mut self, enabled: bool, now_s: f64) -> Vec<Action> {
        let was = core::mem::replace(&mut self.enabled, enabled);
        if !enabled {
            return if was {
                self.fault(Fault::OperatorOff, now_s)
            } else {
                Vec::new()
            };
        }
        if let Authority::Released { owed, .. } = self.state
            && owed.is_none()
        {
            self.state = Authority::Waiting;
            self.well_since_s = None;
        }
        vec![Action::Tell(Severity::Info, "fga: switched on by operator")]
    }

    /// Whether all preconditions hold now; called with every tick.
    pub fn readiness(&mut self, ready: bool, now_s: f64) -> Vec<Action> {
        if !ready {
            self.well_since_s = None;
            if self.state == Authority::Ready {
                self.state = Authority::Waiting;
            }
            return Vec::new();
        }
        let well_s = now_s - *self.well_since_s.get_or_insert(now_s);
        match self.state {
            Authority::Resuming {
                previous, after, ..
            } => {
                self.state = Authority::InCommand {
                    since_s: now_s,
                    previous,
                };
                let words = if after == Fault::Restarted {
                    "fga: restarted, goes on avoiding"
                } else {
                    "fga: link back, goes on avoiding"
                };
                vec![Action::Resumed, Action::Tell(Severity::Warning, words)]
            }
            Authority::Waiting if self.enabled => {
                self.state = Authority::Ready;
                vec![Action::Tell(Severity::Info, "fga: ready")]
            }
            Authority::Released {
                since_s,
                fault,
                owed: None,
                ..
            } if self.enabled
                && reaction(fault).rearm == Rearm::Automatic
                && well_s >= settle_s(fault)
                && now_s - since_s >= settle_s(fault) =>
            {
                self.state = Authority::Waiting;
                Vec::new()
            }
            _ => Vec::new(),
        }
    }

    /// The avoider wants to fly.
    pub fn take_over(&mut self, mode: Mode, now_s: f64) -> Vec<Action> {
        if self.state != Authority::Ready {
            return Vec::new();
        }
        self.state = Authority::Taking {
            since_s: now_s,
            previous: mode,
        };
        vec![self.take(mode), Action::Began]
    }

    /// The avoider is done.
    pub fn hand_back(&mut self, now_s: f64) -> Vec<Action> {
        let (Authority::Taking { previous, .. } | Authority::InCommand { previous, .. }) =
            self.state
        else {
            return Vec::new();
        };
        self.state = Authority::Returning {
            since_s: now_s,
            previous,
        };
        vec![self.restore(previous)]
    }

    /// A request for a mode was refused or not answered.
    pub fn mode_refused(&mut self, now_s: f64) -> Vec<Action> {
        match self.state {
            Authority::Taking { .. } => self.fault(Fault::TakeOverRefused, now_s),
            Authority::Returning { .. } => self.fault(Fault::ReturnRefused, now_s),
            _ => Vec::new(),
        }
    }

    /// The vehicle was silent for a while, seconds: it had no chance to confirm anything.
    pub const fn excuse(&mut self, silent_s: f64) {
        if let Authority::Taking { since_s, .. } | Authority::Returning { since_s, .. } =
            &mut self.state
        {
            *since_s += silent_s;
        }
    }

    /// Advances the time.
    pub fn tick(&mut self, now_s: f64) -> Vec<Action> {
        match self.state {
            Authority::Taking { since_s, .. } if now_s - since_s > TAKE_OVER_S => {
                self.fault(Fault::TakeOverRefused, now_s)
            }
            Authority::Returning { since_s, .. } if now_s - since_s > RETURN_S => {
                self.fault(Fault::ReturnRefused, now_s)
            }
            Authority::Resuming { since_s, after, .. } if now_s - since_s > RESUME_S => {
                let fault = if after == Fault::LinkLost {
                    // Heard, but not enough to fly by.
                    Fault::TelemetryStale
                } else {
                    after
                };
                self.fault(fault, now_s)
            }
            _ => Vec::new(),
        }
    }

    /// Something went wrong.
    pub fn fault(&mut self, fault: Fault, now_s: f64) -> Vec<Action> {
        let row = reaction(fault);
        if let Authority::Released {
            fault: before,
            owed,
            late,
            ..
        } = self.state
        {
            // A lost link or missing telemetry changes nothing more; a fault that only the operator can clear
            // does.
            if row.rearm == Rearm::Automatic || reaction(before).rearm == Rearm::Operator {
                return Vec::new();
            }
            self.enabled = false;
            let restores = row.hand_back != HandBack::LeaveAlone;
            self.state = Authority::Released {
                since_s: now_s,
                fault,
                owed: owed.filter(|_| restores),
                late,
            };
            let mut actions = vec![Action::Tell(row.severity, row.text)];
            if !restores {
                actions.push(Action::CancelSetMode);
            }
            return actions;
        }
        let Some(previous) = self.previous() else {
            // No manoeuvre: only readiness matters, which decides whether it may act.
            let is_told = matches!(fault, Fault::OperatorOff | Fault::Contradiction);
            if row.rearm == Rearm::Operator && !is_told {
                return Vec::new();
            }
            self.state = Authority::Waiting;
            let words = is_told.then_some(Action::Tell(row.severity, row.text));
            return words.into_iter().collect();
        };
        let mut actions = Vec::new();
        let owed = match row.hand_back {
            HandBack::LeaveAlone => {
                actions.push(Action::CancelSetMode);
                None
            }
            HandBack::Restore => {
                actions.push(self.restore(previous));
                Some(previous)
            }
            HandBack::RestoreWhenHeard | HandBack::ResumeWhenHeard => {
                actions.push(Action::CancelSetMode);
                Some(previous)
            }
        };
        self.state = Authority::Released {
            since_s: now_s,
            fault,
            owed,
            late: None,
        };
        self.well_since_s = None;
        self.tries = 0;
        if row.rearm == Rearm::Operator {
            self.enabled = false;
        }
        actions.push(Action::Ended(fault));
        actions.push(Action::Tell(row.severity, row.text));
        actions
    }
}
