//! The state machine.

use super::stray::{Origin, Requests};
use super::{Action, Authority, Fault, HandBack, Late, Rearm, Severity, reaction};
use crate::mode::{Mode, ModeChange};

/// Time for the take-over to be confirmed, seconds.
const TAKE_OVER_S: f64 = 3.0;
/// Time for the return to be confirmed, seconds.
const RETURN_S: f64 = 5.0;
/// A request that was on its way when the pilot changed the mode arrives within this time, seconds. If it
/// does, the keeper restores the pilot's mode.
const LATE_S: f64 = 0.8;
/// All must be well for this long before it is ready again by itself, seconds.
const SETTLE_S: f64 = 3.0;
/// A restarted program, or one that hears the vehicle again, restores the mode if it is not ready within
/// this time, seconds.
const RESUME_S: f64 = 5.0;
/// The companion flies on a vehicle that it hears again in the owned mode within this time after losing the
/// link, seconds; later the vehicle has circled for long, and the threat has passed.
const LOST_FOR_S: f64 = 10.0;
/// Most heartbeats answered with a request for the owed mode.
const MOST_TRIES: u8 = 24;
/// A vehicle that stays disarmed for this long has landed, and the debt of a mode ends, seconds.
const LANDED_S: f64 = 5.0;

/// The operator's text when nothing shows who chose the mode.
const WHOSE_MODE: &str = "fga: mode is perhaps our late request: set one";
/// The operator's text when the vehicle is in the mode for manoeuvres without a manoeuvre: after a short failsafe ArduPlane sets the
/// mode from before by itself.
const NOBODY_FLIES: &str = "fga: GUIDED, but nobody flies: set a mode";

/// The operator reads that at most once in this time, seconds.
const NOBODY_AGAIN_S: f64 = 5.0;
/// The same after a gap in the telemetry, which ends as suddenly as it began, seconds.
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
    /// A keeper with `target` as its mode for manoeuvres; `enabled` lets it act before the operator arms it.
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

    /// The mode to restore if the program stops now.
    pub const fn owed(&self) -> Option<Mode> {
        match self.state {
            Authority::Taking { previous, .. }
            | Authority::InCommand { previous, .. }
            | Authority::Returning { previous, .. }
            | Authority::Resuming { previous, .. } => Some(previous),
            Authority::Released { owed, .. } => owed,
            Authority::Waiting | Authority::Ready => None,
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
        matches!(
            self.state,
            Authority::Taking { .. }
                | Authority::InCommand { .. }
                | Authority::Returning { .. }
                | Authority::Resuming { .. }
        )
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
        vec![Action::Tell(Severity::Info, "fga: armed by the operator")]
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

    /// A heartbeat reported the mode and whether the vehicle is armed. The keeper restores an owed mode only
    /// on an armed vehicle: on the ground the mode is the pilot's business.
    pub fn heartbeat(&mut self, mode: Mode, armed: bool, now_s: f64) -> Vec<Action> {
        if armed {
            self.disarmed_s = None;
            return self.mode(mode, now_s);
        }
        let disarmed_s = *self.disarmed_s.get_or_insert(now_s);
        match &mut self.state {
            Authority::Released { owed, .. } if mode == self.target => {
                if now_s - disarmed_s > LANDED_S {
                    *owed = None;
                }
                vec![Action::CancelSetMode]
            }
            _ => self.mode(mode, now_s),
        }
    }

    /// A request for a mode was sent.
    pub fn asked(&mut self, change: ModeChange, now_s: f64) {
        // What undoes a late request is not undone.
        if change.to == self.target || change.from == self.target {
            self.requests.asked(change, now_s);
        }
    }

    /// The vehicle answered a request of ours for a mode.
    pub fn answered(&mut self, accepted: bool, now_s: f64) {
        self.requests.answered(accepted, now_s);
    }

    /// A heartbeat of an armed vehicle reported the mode.
    pub fn mode(&mut self, mode: Mode, now_s: f64) -> Vec<Action> {
        let before = self.told.replace(mode);
        let changed = before.filter(|before| *before != mode);
        if let Some(before) = changed {
            let origin = self.requests.origin(mode, now_s);
            // Back from the owned mode is where it was to go.
            let unwanted = !self.is_engaged() && self.owed().is_none() && before != self.target;
            if unwanted && let Some(actions) = self.stray(origin, mode, before, now_s) {
                return actions;
            }
            if mode == self.target && self.was_displaced() && !self.undoes(mode, now_s) {
                let mut actions = self.mode_told(mode, now_s);
                if now_s - self.nobody_told_s >= NOBODY_AGAIN_S {
                    self.nobody_told_s = now_s;
                    actions.push(Action::Tell(Severity::Critical, NOBODY_FLIES));
                }
                return actions;
            }
            if before == self.target && origin != Origin::Ours && self.ends_what_is_owed(mode) {
                self.requests.doubt(before, now_s);
            }
        }
        self.mode_told(mode, now_s)
    }

    /// The vehicle changed the mode, and nothing is waited for.
    fn stray(
        &mut self,
        origin: Origin,
        mode: Mode,
        before: Mode,
        now_s: f64,
    ) -> Option<Vec<Action>> {
        match origin {
            Origin::Others => None,
            // The request crossed the pilot's choice: that is undone without another fault.
            _ if self.undoes(mode, now_s) => None,
            Origin::Ours if mode == self.target => {
                self.state = Authority::InCommand {
                    since_s: now_s,
                    previous: before,
                };
                Some(self.fault(Fault::LateRequest, now_s))
            }
            Origin::Ours => {
                let row = reaction(Fault::LateRequest);
                self.state = Authority::Released {
                    since_s: now_s,
                    fault: Fault::LateRequest,
                    owed: None,
                    late: Some(Late {
                        asked: mode,
                        chosen: before,
                    }),
                };
                Some(vec![
                    Action::SetMode {
                        to: before,
                        from: mode,
                    },
                    Action::Tell(row.severity, row.text),
                ])
            }
            Origin::Unknown => Some(vec![Action::Tell(Severity::Critical, WHOSE_MODE)]),
        }
    }

    /// Whether others changed the mode in a manoeuvre, and the operator has not armed it again.
    const fn was_displaced(&self) -> bool {
        matches!(
            self.state,
            Authority::Released {
                fault: Fault::ModeChanged,
                owed: None,
                ..
            }
        )
    }

    /// Whether the debt ends once the vehicle reports a mode.
    fn ends_what_is_owed(&self, mode: Mode) -> bool {
        match self.state {
            Authority::Returning { previous, .. } => mode == previous,
            Authority::Released { owed, .. } => owed.is_some(),
            _ => false,
        }
    }

    /// Whether a mode reported now counts as a request that crossed the pilot's choice.
    fn undoes(&self, mode: Mode, now_s: f64) -> bool {
        let Authority::Released {
            since_s,
            late: Some(late),
            ..
        } = self.state
        else {
            return false;
        };
        late.asked == mode && now_s - since_s <= LATE_S
    }

    fn mode_told(&mut self, mode: Mode, now_s: f64) -> Vec<Action> {
        match self.state {
            Authority::Taking { previous, .. } if mode == self.target => {
                self.state = Authority::InCommand {
                    since_s: now_s,
                    previous,
                };
                vec![Action::CancelSetMode]
            }
            Authority::Taking { previous, .. } if mode == previous => Vec::new(),
            Authority::InCommand { .. }
            | Authority::Returning { .. }
            | Authority::Resuming { .. }
                if mode == self.target =>
            {
                Vec::new()
            }
            Authority::Returning { previous, .. } if mode == previous => {
                self.state = if self.enabled {
                    Authority::Ready
                } else {
                    Authority::Waiting
                };
                vec![Action::CancelSetMode, Action::Returned]
            }
            Authority::InCommand { .. } | Authority::Resuming { .. } => {
                self.fault(Fault::ModeChanged, now_s)
            }
            Authority::Taking { .. } => self.pilot_chose(mode, self.target, now_s),
            Authority::Returning { previous, .. } => self.pilot_chose(mode, previous, now_s),
            Authority::Released {
                since_s,
                fault: Fault::LinkLost,
                owed: Some(previous),
                ..
            } if mode == self.target && now_s - since_s <= LOST_FOR_S => {
                self.state = Authority::Resuming {
                    since_s: now_s,
                    previous,
                    after: Fault::LinkLost,
                };
                Vec::new()
            }
            Authority::Released {
                since_s,
                fault,
                owed: Some(owed),
                late,
            } => {
                if mode == self.target && self.tries < MOST_TRIES {
                    self.tries += 1;
                    return vec![self.restore(owed)];
                }
                if mode == self.target {
                    return self.give_up(now_s);
                }
                self.state = Authority::Released {
                    since_s,
                    fault,
                    owed: None,
                    late,
                };
                vec![Action::CancelSetMode]
            }
            Authority::Released {
                since_s,
                fault,
                owed: None,
                late: Some(late),
            } => {
                let is_late = mode == late.asked && now_s - since_s <= LATE_S;
                if is_late {
                    return vec![Action::SetMode {
                        to: late.chosen,
                        from: late.asked,
                    }];
                }
                if mode != late.chosen || now_s - since_s > LATE_S {
                    self.state = Authority::Released {
                        since_s,
                        fault,
                        owed: None,
                        late: None,
                    };
                }
                vec![Action::CancelSetMode]
            }
            _ => Vec::new(),
        }
    }

    /// The vehicle stays in the owned mode despite the requests.
    fn give_up(&mut self, now_s: f64) -> Vec<Action> {
        let row = reaction(Fault::ReturnRefused);
        self.enabled = false;
        self.state = Authority::Released {
            since_s: now_s,
            fault: Fault::ReturnRefused,
            owed: None,
            late: None,
        };
        vec![Action::CancelSetMode, Action::Tell(row.severity, row.text)]
    }

    /// The pilot chose a mode while a request for another one was on its way.
    fn pilot_chose(&mut self, chosen: Mode, asked: Mode, now_s: f64) -> Vec<Action> {
        let actions = self.fault(Fault::ModeChanged, now_s);
        if let Authority::Released { late, .. } = &mut self.state {
            *late = Some(Late { asked, chosen });
        }
        actions
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
        let previous = match self.state {
            Authority::Taking { previous, .. }
            | Authority::InCommand { previous, .. }
            | Authority::Returning { previous, .. }
            | Authority::Resuming { previous, .. } => previous,
            Authority::Ready | Authority::Waiting => {
                // No manoeuvre: only readiness matters, which decides whether it may act.
                let is_told = matches!(fault, Fault::OperatorOff | Fault::Contradiction);
                if row.rearm == Rearm::Operator && !is_told {
                    return Vec::new();
                }
                self.state = Authority::Waiting;
                return if is_told {
                    vec![Action::Tell(row.severity, row.text)]
                } else {
                    Vec::new()
                };
            }
            Authority::Released {
                fault: before,
                owed,
                late,
                ..
            } => {
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
