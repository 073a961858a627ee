//! The reaction to each mode that the vehicle reports.

use super::super::stray::ModeOrigin;
use super::super::{Action, Authority, Fault, Late, Severity, reaction};
use super::Keeper;
use crate::authority::Beat;
use crate::mode::{Mode, ModeChange};

/// A request that was on its way when the pilot changed the mode arrives within this time, seconds. If it
/// does, the keeper restores the pilot's mode.
const LATE_S: f64 = 0.8;
/// The companion flies on a vehicle that it hears again in the owned mode within this time after losing the
/// link, seconds; later the vehicle has circled for long, and the threat has passed.
const LOST_FOR_S: f64 = 10.0;
/// Most heartbeats answered with a request for the owed mode.
const MOST_TRIES: u8 = 24;
/// A vehicle that stays disarmed for this long has landed, and the debt of a mode ends, seconds.
const LANDED_S: f64 = 5.0;
/// The operator's texts once the vehicle reports the mode that was owed, or another one.
const RESTORED: &str = "fga: mode restored";
const NOT_RESTORED: &str = "fga: mode chosen by others, not restored";
/// The operator's text when nothing shows who chose the mode.
const WHOSE_MODE: &str = "fga: mode is perhaps our late request: set one";
/// The operator's text when the vehicle is in the mode for manoeuvres without a manoeuvre: after a short failsafe ArduPlane sets the
/// mode from before by itself.
const NOBODY_FLIES: &str = "fga: GUIDED, but nobody flies: set a mode";
/// The operator reads [`NOBODY_FLIES`] at most once in this time, seconds.
const NOBODY_AGAIN_S: f64 = 5.0;

impl Keeper {
    /// A heartbeat reported the mode and whether the vehicle is armed. The keeper restores an owed mode only
    /// on an armed vehicle: on the ground the mode is the pilot's business.
    pub fn heartbeat(&mut self, beat: Beat, now_s: f64) -> Vec<Action> {
        let mode = beat.mode;
        self.requests.heard(beat.sequence, Some(mode), now_s);
        if beat.armed {
            let was_disarmed = self.disarmed_s.take().is_some();
            let mut actions = self.mode(mode, now_s);
            if was_disarmed && mode == self.target && self.has_landed() {
                actions.extend(self.tell_nobody_flies(now_s));
            }
            return actions;
        }
        let disarmed_s = *self.disarmed_s.get_or_insert(now_s);
        match &mut self.state {
            Authority::Released { owed, .. } if mode == self.target => {
                let has_landed = now_s - disarmed_s > LANDED_S && owed.take().is_some();
                let mut actions = vec![Action::CancelSetMode];
                if has_landed {
                    actions.extend(self.tell_nobody_flies(now_s));
                }
                actions
            }
            _ => self.mode(mode, now_s),
        }
    }

    /// Whether the debt of a mode ended because the vehicle stayed disarmed.
    const fn has_landed(&self) -> bool {
        matches!(
            self.state,
            Authority::Released {
                fault: Fault::Disarmed,
                owed: None,
                ..
            }
        )
    }

    /// Tells the operator that the vehicle is in the mode for manoeuvres without a manoeuvre.
    fn tell_nobody_flies(&mut self, now_s: f64) -> Option<Action> {
        let is_due = now_s - self.nobody_told_s >= NOBODY_AGAIN_S;
        is_due.then(|| {
            self.nobody_told_s = now_s;
            Action::Tell(Severity::Critical, NOBODY_FLIES)
        })
    }

    /// A request for a mode was sent.
    pub fn asked(&mut self, change: ModeChange, now_s: f64) {
        // What undoes a late request is not undone.
        if change.to == self.target || change.from == self.target {
            self.requests.asked(change.to, now_s);
        }
    }

    /// The vehicle answered a request of ours for a mode, in the frame of this number.
    pub fn answered(&mut self, number: u8, accepted: bool, now_s: f64) -> Vec<Action> {
        let shows = self.requests.answered(number, accepted, now_s);
        self.reconsider(shows, now_s)
    }

    /// A newer heartbeat came before this one.
    pub fn overtaken(&mut self, beat: Beat, now_s: f64) -> Vec<Action> {
        let number = beat.sequence;
        let shows = self.requests.heard(number, Some(beat.mode), now_s);
        self.reconsider(shows, now_s)
    }

    /// A late frame may show which mode the vehicle left for the present one, or that it did so for a request of ours.
    fn reconsider(&mut self, shows: bool, now_s: f64) -> Vec<Action> {
        match self.requests.last_change() {
            Some((change, _)) if shows && self.told == Some(change.to) => {
                let origin = self.requests.origin(change.to, now_s);
                self.stray(origin, change, now_s).unwrap_or_default()
            }
            _ => Vec::new(),
        }
    }

    /// Whether a request for a mode may be on its way that the vehicle has not answered.
    pub fn may_arrive(&self, mode: Mode, now_s: f64) -> bool {
        self.requests.may_arrive(mode, now_s)
    }

    /// An earlier run of the program gave up a request for a mode while the vehicle reported the mode `before`: if the vehicle
    /// reports the requested mode, nothing shows who chose it.
    pub fn doubt(&mut self, requested: Mode, before: Mode, now_s: f64) {
        self.told = Some(before);
        self.requests.doubt(requested, now_s);
    }

    /// A heartbeat of an armed vehicle reported the mode.
    pub fn mode(&mut self, mode: Mode, now_s: f64) -> Vec<Action> {
        let before = self.told.replace(mode);
        let changed = before.filter(|before| *before != mode);
        if let Some(before) = changed {
            let origin = self.requests.origin(mode, now_s);
            if origin == ModeOrigin::Others {
                self.drop_late(|late| late.asked == mode);
            }
            let change = ModeChange {
                from: before,
                to: mode,
            };
            if let Some(actions) = self.stray(origin, change, now_s) {
                return actions;
            }
            if mode == self.target && self.was_displaced() && !self.undoes(mode, now_s) {
                let mut actions = self.advance(mode, now_s);
                actions.extend(self.tell_nobody_flies(now_s));
                return actions;
            }
            if before == self.target && origin != ModeOrigin::Ours && self.ends_what_is_owed(mode) {
                self.requests.doubt(before, now_s);
            }
        }
        self.advance(mode, now_s)
    }

    /// Reacts to a change of the mode that nobody waited for; `None` where it was waited for, or is somebody else's.
    ///
    /// RTL stands for any mode that the pilot, the fence or another failsafe chose, AUTO for the mode that a request of ours leads to.
    ///
    /// | the vehicle's order | who chose AUTO | reaction |
    /// |---|---|---|
    /// | RTL, request accepted, AUTO | we did | RTL is restored |
    /// | RTL, AUTO, and a request without an answer | unknown | the operator is asked; RTL is restored if an answer in between comes later |
    /// | request accepted, AUTO, RTL, AUTO | the pilot | none |
    /// | RTL, AUTO, request accepted | the pilot; the request changes nothing | none |
    /// | RTL, request refused, AUTO | the pilot | none |
    /// | RTL, request accepted, AUTO, which the pilot selects as well | both | RTL is restored: the pilot selects AUTO once more |
    /// | RTL, AUTO that no heartbeat reports yet, request accepted, AUTO | the pilot | RTL is restored: the pilot selects AUTO once more |
    /// | RTL that no heartbeat reports, request accepted, AUTO | we did | none: nobody heard of RTL |
    ///
    /// `ArduPlane` reports each change of its mode at once, so that the last but one case lasts for a moment, or until the next heartbeat
    /// where the network loses the first. It refuses a request while it recovers from a breach of its fence, unless bit 0 of
    /// `FENCE_OPTIONS` is cleared. Vehicles other than `ArduPlane` are not taken over.
    fn stray(&mut self, origin: ModeOrigin, change: ModeChange, now_s: f64) -> Option<Vec<Action>> {
        let ModeChange {
            from: before,
            to: mode,
        } = change;
        match origin {
            ModeOrigin::Others => None,
            // Back from the owned mode is where it was to go.
            _ if self.is_engaged() || self.owed().is_some() || before == self.target => None,
            // The request crossed the pilot's choice: that is undone without another fault.
            _ if self.undoes(mode, now_s) => None,
            ModeOrigin::Ours if mode == self.target => {
                self.state = Authority::InCommand {
                    since_s: now_s,
                    previous: before,
                };
                Some(self.fault(Fault::LateRequest, now_s))
            }
            ModeOrigin::Ours => {
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
            ModeOrigin::Unknown => Some(vec![Action::Tell(Severity::Critical, WHOSE_MODE)]),
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

    /// Forgets the request that crossed the pilot's choice once it does not count any more.
    fn drop_late(&mut self, is_over: impl FnOnce(&mut Late) -> bool) {
        if let Authority::Released { late, .. } = &mut self.state {
            late.take_if(is_over);
        }
    }

    /// What the reported mode means in the present state.
    fn advance(&mut self, mode: Mode, now_s: f64) -> Vec<Action> {
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
                owed: Some(owed), ..
            } => {
                if mode == self.target && self.tries < MOST_TRIES {
                    self.tries += 1;
                    return vec![self.restore(owed)];
                }
                if mode == self.target {
                    return self.give_up(now_s);
                }
                let words = if mode == owed {
                    Action::Tell(Severity::Notice, RESTORED)
                } else {
                    Action::Tell(Severity::Warning, NOT_RESTORED)
                };
                if let Authority::Released { owed, .. } = &mut self.state {
                    *owed = None;
                }
                vec![Action::CancelSetMode, words]
            }
            Authority::Released {
                late: Some(late), ..
            } if self.undoes(mode, now_s) => vec![Action::SetMode {
                to: late.chosen,
                from: late.asked,
            }],
            Authority::Released {
                since_s,
                late: Some(_),
                ..
            } => {
                self.drop_late(|late| mode != late.chosen || now_s - since_s > LATE_S);
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
}
