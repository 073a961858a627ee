//! Acknowledged commands: repeated until an answer comes, given up after a while.

use mavlink::dialects::ardupilotmega::{
    COMMAND_ACK_DATA, COMMAND_INT_DATA, COMMAND_LONG_DATA, MavCmd, MavFrame, MavMessage, MavResult,
};

use crate::mode::{Mode, ModeChange};
use crate::number::single;
use crate::outgoing::{ANSWER_S, AUTOPILOT, Outbox};

/// Most transmissions of a command.
const MOST_ATTEMPTS: u8 = 6;
/// A command is refused when the vehicle refuses this many of its transmissions: a single answer may be somebody else's.
const REFUSALS: u8 = 3;
/// After the vehicle accepted a change of the mode, the time until its heartbeat reports the mode, seconds; and the time
/// after which the change has happened, or nobody waits for the change.
const SHOWS_S: f64 = 0.6;
const SHOWN_S: f64 = 3.0;
/// Commands that wait; ArduPlane answers one of a kind at a time.
const MOST_WAITING: usize = 32;

/// A command and its numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VehicleCommand {
    /// The command.
    pub command: MavCmd,
    /// Parameters 1 to 7; in a `COMMAND_INT` 5 to 7 are the place.
    pub parameters: [f32; 7],
    /// As `COMMAND_INT`, with its frame; else as `COMMAND_LONG`.
    pub frame: Option<MavFrame>,
    /// A command of another mode, sent only while the vehicle is in the mode that it leaves.
    pub change: Option<ModeChange>,
}

impl VehicleCommand {
    /// A command sent as `COMMAND_LONG`.
    pub fn long(command: MavCmd, first: f32, second: f32) -> Self {
        Self {
            command,
            parameters: [first, second, 0.0, 0.0, 0.0, 0.0, 0.0],
            frame: None,
            change: None,
        }
    }

    /// A command sent as `COMMAND_INT`, in the global frame.
    pub const fn int(command: MavCmd, parameters: [f32; 7]) -> Self {
        Self {
            command,
            parameters,
            frame: Some(MavFrame::MAV_FRAME_GLOBAL),
            change: None,
        }
    }

    /// The command that takes the vehicle from one mode to another.
    pub fn set_mode(to: Mode, from: Mode) -> Self {
        let number = single(f64::from(to.0));
        Self {
            change: Some(ModeChange { from, to }),
            ..Self::long(MavCmd::MAV_CMD_DO_SET_MODE, 1.0, number)
        }
    }

    /// The message; `confirmation` counts the earlier transmissions.
    pub fn message(&self, target_system: u8, confirmation: u8) -> MavMessage {
        let [param1, param2, param3, param4, param5, param6, param7] = self.parameters;
        match self.frame {
            Some(frame) => MavMessage::COMMAND_INT(COMMAND_INT_DATA {
                param1,
                param2,
                param3,
                param4,
                z: param7,
                command: self.command,
                target_system,
                target_component: AUTOPILOT,
                frame,
                ..COMMAND_INT_DATA::DEFAULT
            }),
            None => MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
                param1,
                param2,
                param3,
                param4,
                param5,
                param6,
                param7,
                command: self.command,
                target_system,
                target_component: AUTOPILOT,
                confirmation,
            }),
        }
    }
}

/// How a command ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CommandEnd {
    /// The vehicle accepted it.
    Accepted(VehicleCommand),
    /// The vehicle refused it.
    Refused(VehicleCommand, MavResult),
    /// No answer came.
    Unanswered(VehicleCommand),
}

#[derive(Debug, Clone, Copy)]
struct Waiting {
    command: VehicleCommand,
    attempts: u8,
    again_s: f64,
    /// Whether the last transmission has its answer.
    answered: bool,
    refusals: u8,
    /// When the vehicle first accepted a change of the mode, seconds.
    accepted_s: Option<f64>,
}

/// The pending commands.
#[derive(Debug, Default)]
pub struct Commands(Vec<Waiting>);

impl Commands {
    /// Sends a command. A waiting one of the same kind with other numbers is replaced if it is obsolete
    /// (`replace`); else the new one waits its turn.
    pub fn send(&mut self, command: VehicleCommand, replace: bool) {
        if replace {
            self.0
                .retain(|waiting| waiting.command.command != command.command);
        }
        if self.0.len() < MOST_WAITING {
            self.0.push(Waiting {
                command,
                attempts: 0,
                again_s: f64::NEG_INFINITY,
                answered: false,
                refusals: 0,
                accepted_s: None,
            });
        }
    }

    /// Forgets every command of a kind.
    pub fn cancel(&mut self, command: MavCmd) {
        self.0.retain(|waiting| waiting.command.command != command);
    }

    /// Whether one of a kind waits for its answer.
    pub fn is_waiting(&self, command: MavCmd) -> bool {
        self.0
            .iter()
            .any(|waiting| waiting.command.command == command)
    }

    /// Takes an answer: the first one to each transmission counts.
    ///
    /// Anybody can forge one on a link without signing. So a refusal counts once the vehicle has refused the command again, and a
    /// change of the mode is requested until the heartbeat reports the mode or the companion cancels the request.
    pub fn acknowledge(&mut self, data: &COMMAND_ACK_DATA, now_s: f64) -> Option<CommandEnd> {
        let index = self
            .0
            .iter()
            .position(|waiting| waiting.command.command == data.command && waiting.attempts > 0)?;
        if data.result == MavResult::MAV_RESULT_IN_PROGRESS {
            return None;
        }
        let waiting = self.0.get_mut(index)?;
        let accepted = data.result == MavResult::MAV_RESULT_ACCEPTED;
        if accepted && waiting.command.change.is_none() {
            return Some(CommandEnd::Accepted(self.0.remove(index).command));
        }
        if core::mem::replace(&mut waiting.answered, true) {
            return None;
        }
        if accepted {
            waiting.accepted_s.get_or_insert(now_s);
            waiting.again_s += SHOWS_S - ANSWER_S;
            return None;
        }
        waiting.refusals += 1;
        if waiting.refusals < REFUSALS {
            return None;
        }
        Some(CommandEnd::Refused(
            self.0.remove(index).command,
            data.result,
        ))
    }

    /// Sends due commands; returns those given up. A command for a single mode waits until
    /// `asks` says that the vehicle is in that mode.
    pub fn tick(
        &mut self,
        now_s: f64,
        target_system: u8,
        mut asks: impl FnMut(ModeChange) -> bool,
        outbox: &mut Outbox,
    ) -> Option<CommandEnd> {
        self.0
            .retain(|waiting| waiting.accepted_s.is_none_or(|s| now_s - s < SHOWN_S));
        let mut given_up = None;
        let mut busy: Vec<MavCmd> = Vec::new();
        for waiting in &mut self.0 {
            if busy.contains(&waiting.command.command) {
                continue;
            }
            busy.push(waiting.command.command);
            if now_s < waiting.again_s {
                continue;
            }
            if waiting.attempts >= MOST_ATTEMPTS {
                given_up.get_or_insert(waiting.command);
                continue;
            }
            let message = waiting.command.message(target_system, waiting.attempts);
            match waiting.command.change {
                Some(change) if !asks(change) => continue,
                Some(change) => outbox.send_change(change, message),
                None => outbox.send(message),
            }
            waiting.attempts += 1;
            waiting.again_s = now_s + ANSWER_S;
            waiting.answered = false;
        }
        let command = given_up?;
        self.0
            .retain(|waiting| waiting.attempts < MOST_ATTEMPTS || waiting.command != command);
        Some(CommandEnd::Unanswered(command))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(command: MavCmd, result: MavResult) -> COMMAND_ACK_DATA {
        COMMAND_ACK_DATA {
            command,
            result,
            ..COMMAND_ACK_DATA::DEFAULT
        }
    }

    const SET_MODE: MavCmd = MavCmd::MAV_CMD_DO_SET_MODE;

    #[test]
    fn it_is_sent_again_and_given_up() {
        let (mut commands, mut outbox) = (Commands::default(), Outbox::default());
        let command = VehicleCommand::long(SET_MODE, 1.0, 15.0);
        commands.send(command, false);
        let mut outcome = None;
        for tenth in 0..40_u8 {
            outcome = outcome.or(commands.tick(f64::from(tenth) * 0.1, 1, |_| true, &mut outbox));
        }
        assert_eq!(outbox.take().len(), usize::from(MOST_ATTEMPTS));
        assert_eq!(outcome, Some(CommandEnd::Unanswered(command)));
        assert!(!commands.is_waiting(SET_MODE));
    }

    #[test]
    fn one_of_a_kind_at_a_time() {
        let (mut commands, mut outbox) = (Commands::default(), Outbox::default());
        commands.send(VehicleCommand::long(SET_MODE, 1.0, 15.0), false);
        commands.send(VehicleCommand::long(SET_MODE, 1.0, 10.0), false);
        commands.tick(0.0, 1, |_| true, &mut outbox);
        assert_eq!(outbox.take().len(), 1);
        let refused = answer(SET_MODE, MavResult::MAV_RESULT_DENIED);
        for (time_s, sent) in [(0.0, 0), (0.4, 1), (0.8, 1)] {
            commands.tick(time_s, 1, |_| true, &mut outbox);
            assert_eq!(outbox.take().len(), sent);
            let outcome = commands.acknowledge(&refused, time_s);
            // A copy refuses nothing.
            assert_eq!(commands.acknowledge(&refused, time_s), None);
            assert_eq!(outcome.is_some(), time_s == 0.8);
        }
        commands.tick(0.9, 1, |_| true, &mut outbox);
        assert_eq!(outbox.take().len(), 1);
        let accepted = answer(SET_MODE, MavResult::MAV_RESULT_ACCEPTED);
        assert!(matches!(
            commands.acknowledge(&accepted, 0.9),
            Some(CommandEnd::Accepted(..))
        ));
        assert_eq!(commands.acknowledge(&accepted, 0.9), None, "a copy");
    }

    /// An answer is no proof: a change of the mode is requested until the heartbeat reports the mode, at a slower pace, and is forgotten
    /// when nobody cancels it.
    #[test]
    fn an_accepted_change_of_the_mode_is_sent_until_it_shows() {
        let (mut commands, mut outbox) = (Commands::default(), Outbox::default());
        commands.send(VehicleCommand::set_mode(Mode::GUIDED, Mode::AUTO), true);
        let accepted = answer(SET_MODE, MavResult::MAV_RESULT_ACCEPTED);
        let mut sent_s = Vec::new();
        for twentieth in 0..100_u8 {
            let now_s = f64::from(twentieth) * 0.05;
            let outcome = commands.tick(now_s, 1, |_| true, &mut outbox);
            assert_eq!(outcome, None);
            if !outbox.take().is_empty() {
                sent_s.push(now_s);
            }
            assert_eq!(commands.acknowledge(&accepted, now_s), None);
        }
        assert_eq!(sent_s.len(), 5, "{sent_s:?}");
        assert!(!commands.is_waiting(SET_MODE));
    }

    #[test]
    fn a_mode_waits_until_the_vehicle_is_in_the_one_that_it_leaves() {
        let (mut commands, mut outbox) = (Commands::default(), Outbox::default());
        commands.send(VehicleCommand::set_mode(Mode::AUTO, Mode::GUIDED), true);
        for tenth in 0..60_u8 {
            let outcome = commands.tick(
                f64::from(tenth) * 0.1,
                1,
                |change| change.from != Mode::GUIDED,
                &mut outbox,
            );
            assert_eq!(outcome, None, "it is not given up either");
        }
        assert!(outbox.take().is_empty());
        commands.tick(6.0, 1, |change| change.from == Mode::GUIDED, &mut outbox);
        let sent = outbox.take();
        assert_eq!(sent.len(), 1);
        let change = ModeChange {
            from: Mode::GUIDED,
            to: Mode::AUTO,
        };
        assert_eq!(sent[0].change, Some(change));
    }
}
