//! Who flies: the states of authority, and what each fault does.
//!
//! ```text
//!            ready                 a manoeuvre begins        the vehicle confirms
//!  Waiting ─────────► Ready ─────────────────────► Taking ────────────────────► InCommand
//!     ▲  ◄─────────── │  ▲                            │                            │
//!     │   not ready      │ confirmed                  │ a fault                    │ back on the way
//!     │                  └──────── Returning ◄────────┴────────────────────────────┤ or a fault
//!     │                                                                            │
//!     └──── armed again ──── Released ◄──── the pilot changed the mode, a fault ───┘
//! ```
//!
//! The pilot always wins: a mode that nobody here asked for ends the authority with the message
//! that tells it, in every state, and nothing is sent that would change it.

use crate::mode::Mode;

/// What can go wrong, or be taken over by others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Fault {
    /// A mode that was not asked for here: the pilot, the ground station or a failsafe.
    ModeChanged,
    /// The vehicle was disarmed.
    Disarmed,
    /// Below the floor.
    BelowFloor,
    /// Position or attitude too old.
    TelemetryStale,
    /// No heartbeat.
    LinkLost,
    /// The take-over was refused, or not answered in time.
    TakeOverRefused,
    /// The return to the previous mode was refused, or not answered in time.
    ReturnRefused,
    /// The vehicle does not do what is commanded.
    NotFollowing,
    /// The autopilot started anew.
    AutopilotRestarted,
    /// The operator ended it by parameter or command.
    OperatorOff,
}

/// What is done about the mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HandBack {
    /// The mode from before the manoeuvre is set.
    Restore,
    /// The mode from before the manoeuvre is set as soon as the vehicle is heard again, unless it
    /// has changed meanwhile.
    RestoreWhenHeard,
    /// Nothing is sent.
    LeaveAlone,
}

/// When it may act again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rearm {
    /// By itself, once all is well for a while.
    Automatic,
    /// When the operator arms it again by `FGA_ENABLE` or the command.
    Operator,
}

/// How grave it is, for the operator's screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// Act now.
    Critical,
    /// Look at it.
    Warning,
    /// Good to know.
    Notice,
    /// Routine.
    Info,
}

/// The reaction to a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reaction {
    /// What happened.
    pub fault: Fault,
    /// What is done about the mode, where a manoeuvre was under way.
    pub hand_back: HandBack,
    /// When it may act again.
    pub rearm: Rearm,
    /// How the operator is told.
    pub severity: Severity,
    /// What the operator is told, 50 characters at most.
    pub text: &'static str,
}

/// Every fault and its reaction: the table of `docs/fly-safety.md`.
pub const REACTIONS: [Reaction; 10] = [
    Reaction {
        fault: Fault::ModeChanged,
        hand_back: HandBack::LeaveAlone,
        rearm: Rearm::Operator,
        severity: Severity::Warning,
        text: "fga: mode changed by others, released",
    },
    Reaction {
        fault: Fault::Disarmed,
        hand_back: HandBack::LeaveAlone,
        rearm: Rearm::Automatic,
        severity: Severity::Notice,
        text: "fga: vehicle disarmed, released",
    },
    Reaction {
        fault: Fault::BelowFloor,
        hand_back: HandBack::Restore,
        rearm: Rearm::Automatic,
        severity: Severity::Critical,
        text: "fga: below the floor, mode restored",
    },
    Reaction {
        fault: Fault::TelemetryStale,
        hand_back: HandBack::Restore,
        rearm: Rearm::Automatic,
        severity: Severity::Critical,
        text: "fga: telemetry stale, mode restored",
    },
    Reaction {
        fault: Fault::LinkLost,
        hand_back: HandBack::RestoreWhenHeard,
        rearm: Rearm::Automatic,
        severity: Severity::Critical,
        text: "fga: link lost",
    },
    Reaction {
        fault: Fault::TakeOverRefused,
        hand_back: HandBack::Restore,
        rearm: Rearm::Automatic,
        severity: Severity::Critical,
        text: "fga: take-over refused, cannot avoid",
    },
    Reaction {
        fault: Fault::ReturnRefused,
        hand_back: HandBack::LeaveAlone,
        rearm: Rearm::Operator,
        severity: Severity::Critical,
        text: "fga: mode not restored, pilot must set it",
    },
    Reaction {
        fault: Fault::NotFollowing,
        hand_back: HandBack::Restore,
        rearm: Rearm::Operator,
        severity: Severity::Critical,
        text: "fga: vehicle does not follow, mode restored",
    },
    Reaction {
        fault: Fault::AutopilotRestarted,
        hand_back: HandBack::LeaveAlone,
        rearm: Rearm::Operator,
        severity: Severity::Critical,
        text: "fga: autopilot restarted, released",
    },
    Reaction {
        fault: Fault::OperatorOff,
        hand_back: HandBack::Restore,
        rearm: Rearm::Operator,
        severity: Severity::Notice,
        text: "fga: switched off by the operator",
    },
];

/// The reaction to a fault.
pub fn reaction(fault: Fault) -> &'static Reaction {
    // The table holds every fault (tested); the first row is the most careful answer.
    REACTIONS
        .iter()
        .find(|row| row.fault == fault)
        .unwrap_or(&REACTIONS[0])
}

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
            Self::Released { .. } => "released",
        }
    }
}

/// What is to be done after an event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Ask for a mode.
    SetMode(Mode),
    /// Stop asking for any mode.
    CancelSetMode,
    /// Tell the operator.
    Tell(Severity, &'static str),
    /// The manoeuvre begins to be flown.
    Began,
    /// Control was handed back as planned.
    Returned,
    /// Control ended by a fault.
    Ended(Fault),
}

/// Time for the take-over to be confirmed, seconds.
const TAKE_OVER_S: f64 = 3.0;
/// Time for the return to be confirmed, seconds.
const RETURN_S: f64 = 5.0;
/// A request that was on its way when the pilot changed the mode arrives within this, seconds. If it
/// does, the pilot's mode is set again.
const LATE_S: f64 = 0.8;
/// All must be well for this long before it is ready again by itself, seconds.
const SETTLE_S: f64 = 3.0;

/// The state machine of authority. It reads no clock and sends nothing itself.
#[derive(Debug)]
pub struct Keeper {
    state: Authority,
    /// The mode that manoeuvres are flown in.
    target: Mode,
    enabled: bool,
    well_since_s: Option<f64>,
}

impl Keeper {
    /// A keeper that flies manoeuvres in `target`; `enabled` lets it act without being armed.
    pub const fn new(target: Mode, enabled: bool) -> Self {
        Self {
            state: Authority::Waiting,
            target,
            enabled,
            well_since_s: None,
        }
    }

    /// Where it stands.
    pub const fn state(&self) -> Authority {
        self.state
    }

    /// Whether the operator lets it act.
    pub const fn is_enabled(&self) -> bool {
        self.enabled
    }

    /// Whether attitude targets and the like are to be sent.
    pub const fn commands(&self) -> bool {
        matches!(
            self.state,
            Authority::Taking { .. } | Authority::InCommand { .. }
        )
    }

    /// Whether the vehicle's mode is not its own affair now.
    pub const fn is_engaged(&self) -> bool {
        matches!(
            self.state,
            Authority::Taking { .. } | Authority::InCommand { .. } | Authority::Returning { .. }
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
                && well_s >= SETTLE_S
                && now_s - since_s >= SETTLE_S =>
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
        vec![Action::SetMode(self.target), Action::Began]
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
        vec![Action::SetMode(previous)]
    }

    /// A heartbeat told the mode.
    pub fn mode(&mut self, mode: Mode, now_s: f64) -> Vec<Action> {
        match self.state {
            Authority::Taking { previous, .. } if mode == self.target => {
                self.state = Authority::InCommand {
                    since_s: now_s,
                    previous,
                };
                vec![Action::CancelSetMode]
            }
            Authority::Taking { previous, .. } if mode == previous => Vec::new(),
            Authority::InCommand { .. } | Authority::Returning { .. } if mode == self.target => {
                Vec::new()
            }
            Authority::Returning { previous, .. } if mode == previous => {
                self.state = Authority::Ready;
                vec![Action::CancelSetMode, Action::Returned]
            }
            Authority::InCommand { .. } => self.fault(Fault::ModeChanged, now_s),
            Authority::Taking { .. } => self.pilot_chose(mode, self.target, now_s),
            Authority::Returning { previous, .. } => self.pilot_chose(mode, previous, now_s),
            Authority::Released {
                since_s,
                fault,
                owed: Some(owed),
                late,
            } => {
                if mode == self.target {
                    return vec![Action::SetMode(owed)];
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
                    return vec![Action::SetMode(late.chosen)];
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

    /// The pilot chose a mode while a request for another one was on its way.
    fn pilot_chose(&mut self, chosen: Mode, asked: Mode, now_s: f64) -> Vec<Action> {
        let actions = self.fault(Fault::ModeChanged, now_s);
        if let Authority::Released { late, .. } = &mut self.state {
            *late = Some(Late { asked, chosen });
        }
        actions
    }

    /// A request for a mode was refused, or not answered.
    pub fn mode_refused(&mut self, now_s: f64) -> Vec<Action> {
        match self.state {
            Authority::Taking { .. } => self.fault(Fault::TakeOverRefused, now_s),
            Authority::Returning { .. } => self.fault(Fault::ReturnRefused, now_s),
            _ => Vec::new(),
        }
    }

    /// Time passes.
    pub fn tick(&mut self, now_s: f64) -> Vec<Action> {
        match self.state {
            Authority::Taking { since_s, .. } if now_s - since_s > TAKE_OVER_S => {
                self.fault(Fault::TakeOverRefused, now_s)
            }
            Authority::Returning { since_s, .. } if now_s - since_s > RETURN_S => {
                self.fault(Fault::ReturnRefused, now_s)
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
            | Authority::Returning { previous, .. } => previous,
            Authority::Ready | Authority::Waiting => {
                // Nothing is flown: what matters is only whether it may act, and readiness says.
                if row.rearm == Rearm::Operator && fault != Fault::OperatorOff {
                    return Vec::new();
                }
                self.state = Authority::Waiting;
                return if fault == Fault::OperatorOff {
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
                // A link that is lost or telemetry that stays away changes nothing any more; what
                // only the operator can undo does.
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
                actions.push(Action::SetMode(previous));
                Some(previous)
            }
            HandBack::RestoreWhenHeard => {
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
        if row.rearm == Rearm::Operator {
            self.enabled = false;
        }
        actions.push(Action::Ended(fault));
        actions.push(Action::Tell(row.severity, row.text));
        actions
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Fault; 10] = [
        Fault::ModeChanged,
        Fault::Disarmed,
        Fault::BelowFloor,
        Fault::TelemetryStale,
        Fault::LinkLost,
        Fault::TakeOverRefused,
        Fault::ReturnRefused,
        Fault::NotFollowing,
        Fault::AutopilotRestarted,
        Fault::OperatorOff,
    ];

    fn in_command() -> Keeper {
        let mut keeper = Keeper::new(Mode::GUIDED, true);
        keeper.readiness(true, 0.0);
        assert_eq!(keeper.state(), Authority::Ready);
        keeper.take_over(Mode::AUTO, 1.0);
        keeper.mode(Mode::GUIDED, 1.1);
        assert!(matches!(keeper.state(), Authority::InCommand { .. }));
        keeper
    }

    /// A keeper in each of the states in which the mode is not the vehicle's own affair.
    fn engaged() -> [Keeper; 3] {
        let mut taking = Keeper::new(Mode::GUIDED, true);
        taking.readiness(true, 0.0);
        taking.take_over(Mode::AUTO, 1.0);
        let mut returning = in_command();
        returning.hand_back(2.0);
        [taking, in_command(), returning]
    }

    #[test]
    fn every_fault_has_a_row_with_a_text_that_fits() {
        for fault in ALL {
            assert_eq!(REACTIONS.iter().filter(|row| row.fault == fault).count(), 1);
            assert!(reaction(fault).text.len() <= 50);
        }
    }

    #[test]
    fn every_fault_does_what_its_row_says_in_every_state() {
        for fault in ALL {
            let row = reaction(fault);
            for mut keeper in engaged() {
                let actions = keeper.fault(fault, 5.0);
                let restores = actions.contains(&Action::SetMode(Mode::AUTO));
                assert_eq!(restores, row.hand_back == HandBack::Restore, "{fault:?}");
                assert!(actions.contains(&Action::Ended(fault)));
                assert!(actions.contains(&Action::Tell(row.severity, row.text)));
                assert!(!keeper.commands());
                assert_eq!(
                    keeper.is_enabled(),
                    row.rearm == Rearm::Automatic,
                    "{fault:?}"
                );
                // The vehicle is heard in its old mode again, and all is well for a while.
                keeper.mode(Mode::AUTO, 6.0);
                keeper.readiness(true, 6.0);
                keeper.readiness(true, 10.0);
                keeper.readiness(true, 10.1);
                let back = keeper.state() == Authority::Ready;
                assert_eq!(back, row.rearm == Rearm::Automatic, "{fault:?}");
                keeper.set_enabled(true, 11.0);
                keeper.readiness(true, 11.1);
                assert_eq!(keeper.state(), Authority::Ready, "{fault:?}");
            }
        }
    }

    #[test]
    fn the_pilot_wins_in_every_state_with_one_message() {
        for mode in [Mode::FBWB, Mode::RTL, Mode(0)] {
            for mut keeper in engaged() {
                let actions = keeper.mode(mode, 3.0);
                assert!(actions.contains(&Action::Ended(Fault::ModeChanged)));
                assert!(actions.contains(&Action::CancelSetMode));
                assert!(
                    !actions
                        .iter()
                        .any(|action| matches!(action, Action::SetMode(_)))
                );
                // Nothing is taken over again, however well all is.
                keeper.readiness(true, 100.0);
                assert!(keeper.take_over(Mode::AUTO, 100.0).is_empty());
            }
        }
        // In command, the pilot may also go back to the old mode.
        let mut keeper = in_command();
        assert!(
            keeper
                .mode(Mode::AUTO, 3.0)
                .contains(&Action::Ended(Fault::ModeChanged))
        );
    }

    #[test]
    fn a_lost_link_is_paid_back_when_the_vehicle_is_heard() {
        let mut keeper = in_command();
        assert!(
            !keeper
                .fault(Fault::LinkLost, 5.0)
                .contains(&Action::SetMode(Mode::AUTO))
        );
        assert_eq!(
            keeper.mode(Mode::GUIDED, 9.0),
            [Action::SetMode(Mode::AUTO)]
        );
        keeper.mode(Mode::AUTO, 9.2);
        // Had it changed meanwhile, nothing would be sent.
        let mut other = in_command();
        other.fault(Fault::LinkLost, 5.0);
        assert_eq!(other.mode(Mode::RTL, 9.0), [Action::CancelSetMode]);
    }

    #[test]
    fn unanswered_requests_end_it() {
        let mut keeper = Keeper::new(Mode::GUIDED, true);
        keeper.readiness(true, 0.0);
        keeper.take_over(Mode::AUTO, 1.0);
        assert!(keeper.tick(2.0).is_empty());
        assert!(
            keeper
                .tick(4.5)
                .contains(&Action::Ended(Fault::TakeOverRefused))
        );
        let mut keeper = in_command();
        keeper.hand_back(10.0);
        assert!(
            keeper
                .tick(15.5)
                .contains(&Action::Ended(Fault::ReturnRefused))
        );
        assert!(!keeper.is_enabled());
    }
}
