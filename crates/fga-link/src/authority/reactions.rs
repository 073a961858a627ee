//! Faults and the reactions to them.

/// A fault, or a take-over by others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Fault {
    /// A mode that the companion did not request: from the pilot, the ground station or a failsafe.
    ModeChanged,
    /// Others command the vehicle in the mode for manoeuvres.
    OthersCommand,
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
    /// When the operator switches it on again by `FGA_ENABLE` or the command.
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
pub struct FaultReaction {
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

/// Rows of the table: fault, reaction on the mode, when it may act again, severity, message.
macro_rules! rows {
    ($($fault:ident: $hand_back:ident, $rearm:ident, $severity:ident, $text:literal;)*) => {
        [$(FaultReaction {
            fault: Fault::$fault,
            hand_back: HandBack::$hand_back,
            rearm: Rearm::$rearm,
            severity: Severity::$severity,
            text: $text,
        }),*]
    };
}

/// Every fault and its reaction: the table of `docs/fly-reactions.md`.
pub const REACTIONS: [FaultReaction; 16] = rows! {
    ModeChanged: LeaveAlone, Operator, Warning, "fga: mode changed by others, released";
    OthersCommand: LeaveAlone, Operator, Warning, "fga: others command GUIDED, released";
    Disarmed: RestoreWhenHeard, Automatic, Notice, "fga: vehicle disarmed, released";
    BelowFloor: Restore, Automatic, Critical, "fga: below the floor, restores the mode";
    TelemetryStale: Restore, Automatic, Critical, "fga: telemetry stale, restores the mode";
    LinkLost: ResumeWhenHeard, Automatic, Critical, "fga: link lost";
    TakeOverRefused: Restore, Automatic, Critical, "fga: take-over refused, cannot avoid";
    ReturnRefused: LeaveAlone, Operator, Critical, "fga: mode not restored, pilot must set it";
    NotFollowing: Restore, Operator, Critical, "fga: vehicle does not follow, restores the mode";
    AutopilotRestarted: LeaveAlone, Operator, Critical, "fga: autopilot restarted, released";
    OperatorOff: Restore, Operator, Notice, "fga: switched off by the operator";
    NoDecision: Restore, Automatic, Critical, "fga: no decision possible, restores the mode";
    Contradiction: LeaveAlone, Operator, Critical, "fga: heartbeats contradict, released";
    ProgramEnds: Restore, Operator, Warning, "fga: program ends, restores the mode";
    Restarted: Restore, Automatic, Critical, "fga: restarted, restores the mode";
    LateRequest: Restore, Automatic, Critical, "fga: late request carried out, restores the mode";
};

/// The reaction to a fault.
pub fn reaction(fault: Fault) -> &'static FaultReaction {
    // The table holds every fault (tested); the first row is the most cautious reaction.
    REACTIONS
        .iter()
        .find(|row| row.fault == fault)
        .unwrap_or(&REACTIONS[0])
}
