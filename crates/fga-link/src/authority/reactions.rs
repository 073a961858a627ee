//! Faults and the reactions to them.

/// A fault, or a take-over by others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Fault {
    /// A mode that the companion did not request: from the pilot, the ground station or a failsafe.
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
    /// The vehicle does not follow its commands.
    NotFollowing,
    /// The autopilot restarted.
    AutopilotRestarted,
    /// The operator ended it by parameter or command.
    OperatorOff,
    /// No decision is possible: limits that cannot be flown, a clock that stands.
    NoDecision,
    /// Heartbeats of one system contradict each other.
    Contradiction,
    /// The program got a signal to end.
    ProgramEnds,
    /// The program restarted in a manoeuvre and could not continue it.
    Restarted,
    /// The vehicle carried out a request of ours for the owned mode after the manoeuvre was called off.
    LateRequest,
}

/// The reaction on the mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HandBack {
    /// Restores the mode from before the manoeuvre.
    Restore,
    /// Restores the mode from before the manoeuvre as soon as the vehicle is heard again, unless the mode
    /// has changed meanwhile.
    RestoreWhenHeard,
    /// Continues the manoeuvre if the vehicle is soon heard again in the mode for manoeuvres; later restores
    /// the mode from before.
    ResumeWhenHeard,
    /// Sends nothing.
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

/// The severity on the operator's screen.
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
    /// The fault.
    pub fault: Fault,
    /// The reaction on the mode during a manoeuvre.
    pub hand_back: HandBack,
    /// When it may act again.
    pub rearm: Rearm,
    /// Severity of the message to the operator.
    pub severity: Severity,
    /// Message to the operator, at most 50 characters.
    pub text: &'static str,
}

/// Every fault and its reaction: the table of `docs/fly-safety.md`.
pub const REACTIONS: [Reaction; 15] = [
    Reaction {
        fault: Fault::ModeChanged,
        hand_back: HandBack::LeaveAlone,
        rearm: Rearm::Operator,
        severity: Severity::Warning,
        text: "fga: mode changed by others, released",
    },
    Reaction {
        fault: Fault::Disarmed,
        hand_back: HandBack::RestoreWhenHeard,
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
        hand_back: HandBack::ResumeWhenHeard,
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
    Reaction {
        fault: Fault::NoDecision,
        hand_back: HandBack::Restore,
        rearm: Rearm::Automatic,
        severity: Severity::Critical,
        text: "fga: no decision possible, mode restored",
    },
    Reaction {
        fault: Fault::Contradiction,
        hand_back: HandBack::LeaveAlone,
        rearm: Rearm::Operator,
        severity: Severity::Critical,
        text: "fga: heartbeats contradict, released",
    },
    Reaction {
        fault: Fault::ProgramEnds,
        hand_back: HandBack::Restore,
        rearm: Rearm::Operator,
        severity: Severity::Warning,
        text: "fga: program ends, mode restored",
    },
    Reaction {
        fault: Fault::Restarted,
        hand_back: HandBack::Restore,
        rearm: Rearm::Automatic,
        severity: Severity::Critical,
        text: "fga: restarted, mode restored",
    },
    Reaction {
        fault: Fault::LateRequest,
        hand_back: HandBack::Restore,
        rearm: Rearm::Automatic,
        severity: Severity::Critical,
        text: "fga: late request carried out, mode restored",
    },
];

/// The reaction to a fault.
pub fn reaction(fault: Fault) -> &'static Reaction {
    // The table holds every fault (tested); the first row is the most cautious reaction.
    REACTIONS
        .iter()
        .find(|row| row.fault == fault)
        .unwrap_or(&REACTIONS[0])
}
