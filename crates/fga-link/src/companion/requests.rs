//! What is the vehicle asked for, and what has it answered?
//!
//! Messages at a rate, parameters, its lists, and commands with an answer: each is requested until it is here.

use mavlink::dialects::ardupilotmega::{COMMAND_ACK_DATA, MavCmd, MavMessage};

use super::lists::Lists;
use super::voice::Voice;
use crate::commands::{CommandEnd, Commands, VehicleCommand};
use crate::config::{Config, TerrainSource};
use crate::mode::ModeChange;
use crate::outgoing::OWN_COMPONENT;
use crate::ownship::OwnshipEstimate;
use crate::parameters::{TERRAIN_ENABLE, VehicleParameters};
use crate::rates::Rates;

/// The requests to the vehicle, and its answers.
#[derive(Debug)]
pub(super) struct VehicleRequests {
    rates: Rates,
    parameters: VehicleParameters,
    lists: Lists,
    commands: Commands,
}

impl VehicleRequests {
    /// Nothing is asked for yet; rally points are read where RTL may be flown.
    pub(super) fn new(config: &Config, use_rally: bool) -> Self {
        let mut parameters = VehicleParameters::default();
        if config.terrain.source == Some(TerrainSource::Vehicle) {
            parameters.ask_for(TERRAIN_ENABLE);
        }
        Self {
            rates: Rates::default(),
            parameters,
            lists: Lists::new(config.safety.use_fence, use_rally),
            commands: Commands::default(),
        }
    }

    /// Mission, fence and rally points as far as read.
    pub(super) const fn lists(&self) -> &Lists {
        &self.lists
    }

    /// The parameters as far as read.
    pub(super) const fn parameters(&self) -> &VehicleParameters {
        &self.parameters
    }

    /// Asks for one more parameter.
    pub(super) fn ask_for(&mut self, name: &'static str) {
        self.parameters.ask_for(name);
    }

    /// What is read, and the commands, for whoever sends one.
    pub(super) const fn for_commands(&mut self) -> (&Lists, &VehicleParameters, &mut Commands) {
        (&self.lists, &self.parameters, &mut self.commands)
    }

    /// Interval of position and attitude, seconds; `None` while they come too seldom to fly by.
    pub(super) fn usable_interval_s(&self) -> Option<f64> {
        self.rates.interval_s().filter(|_| self.rates.is_usable())
    }

    /// The vehicle was heard for the first time.
    pub(super) fn begin(&mut self) {
        self.lists.begin();
    }

    /// The mode has changed, and so the vehicle's own target; or the local frame.
    pub(super) const fn mode_changed(&mut self, now_s: f64) {
        self.lists.mode_changed(now_s);
    }

    /// The vehicle restarted: it has forgotten its rates.
    pub(super) fn restart(&mut self) {
        self.rates.restart();
    }

    /// Takes a message of the vehicle; `in_auto` while it flies its mission.
    pub(super) fn hear(
        &mut self,
        message: &MavMessage,
        ownship: &OwnshipEstimate,
        in_auto: bool,
        voice: &mut Voice,
    ) {
        let now_s = voice.now_s();
        self.rates.heard(message, now_s);
        let lists = &mut self.lists;
        match message {
            MavMessage::PARAM_VALUE(data) => {
                self.parameters.take(data);
            }
            MavMessage::MISSION_COUNT(data) => lists.take_count(data, voice),
            MavMessage::MISSION_ITEM_INT(data) => lists.take_item(data, voice),
            MavMessage::MISSION_CURRENT(data) => lists.take_current(data),
            MavMessage::MISSION_ACK(data) => lists.take_ack(data),
            MavMessage::STATUSTEXT(data) => lists.take_text(data),
            MavMessage::POSITION_TARGET_GLOBAL_INT(_) | MavMessage::NAV_CONTROLLER_OUTPUT(_) => {
                lists.take_target(message, ownship, in_auto, now_s);
            }
            _ => {}
        }
    }

    /// Requests what is missing, except for commands; `engaged` in a manoeuvre, `attitude_s` is the wanted interval of attitudes, seconds.
    pub(super) fn tick(&mut self, engaged: bool, attitude_s: f64, voice: &mut Voice) {
        let (now_s, system) = (voice.now_s(), voice.system());
        self.rates.tick(attitude_s, now_s, system, voice.outbox());
        self.parameters.tick(now_s, system, voice.outbox());
        self.lists.tick(engaged, voice);
    }

    /// Commands the vehicle until it answers, instead of an earlier command of the kind.
    pub(super) fn command(&mut self, command: VehicleCommand) {
        self.commands.send(command, true);
    }

    /// Forgets every command of a kind.
    pub(super) fn cancel(&mut self, command: MavCmd) {
        self.commands.cancel(command);
    }

    /// Takes an answer to a command, which may end it. An answer to nobody in particular may be to somebody else's command.
    pub(super) fn acknowledge(
        &mut self,
        data: &COMMAND_ACK_DATA,
        now_s: f64,
    ) -> Option<CommandEnd> {
        let for_us = data.target_component == OWN_COMPONENT || data.target_component == 0;
        if for_us {
            self.commands.acknowledge(data, now_s)
        } else {
            None
        }
    }

    /// Sends the commands that are due; the end of one that is given up. A change of the mode waits until `asks` allows it.
    pub(super) fn send_commands(
        &mut self,
        asks: impl FnMut(ModeChange) -> bool,
        voice: &mut Voice,
    ) -> Option<CommandEnd> {
        let (now_s, system) = (voice.now_s(), voice.system());
        self.commands.tick(now_s, system, asks, voice.outbox())
    }
}

#[cfg(test)]
mod tests {
    use mavlink::dialects::ardupilotmega::{MISSION_CURRENT_DATA, MavResult, PARAM_VALUE_DATA};

    use super::*;

    #[test]
    fn an_answer_to_another_component_ends_no_command() {
        let mut requests = VehicleRequests::new(&Config::default(), false);
        let mut voice = Voice::default();
        let command = MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT;
        requests.command(VehicleCommand::long(command, 1.0, 0.0));
        assert_eq!(requests.send_commands(|_| true, voice.at(1.0)), None);
        let mut answer = COMMAND_ACK_DATA {
            command,
            result: MavResult::MAV_RESULT_ACCEPTED,
            target_component: 190,
            ..COMMAND_ACK_DATA::DEFAULT
        };
        assert_eq!(requests.acknowledge(&answer, 1.1), None);
        answer.target_component = OWN_COMPONENT;
        let end = requests.acknowledge(&answer, 1.2);
        assert!(matches!(end, Some(CommandEnd::Accepted(_))));
        assert_eq!(requests.acknowledge(&answer, 1.3), None, "ended");
    }

    #[test]
    fn each_answer_reaches_what_asked_for_it() {
        let mut requests = VehicleRequests::new(&Config::default(), false);
        let (ownship, mut voice) = (OwnshipEstimate::default(), Voice::default());
        let mut hear = |message, now_s| {
            requests.hear(&message, &ownship, true, voice.at(now_s));
            let item = requests.lists().item();
            (item, requests.parameters().get("WP_RADIUS"))
        };
        let current = MISSION_CURRENT_DATA {
            seq: 4,
            ..MISSION_CURRENT_DATA::DEFAULT
        };
        assert_eq!(
            hear(MavMessage::MISSION_CURRENT(current), 1.0),
            (Some(4), None)
        );
        let radius = PARAM_VALUE_DATA {
            param_id: "WP_RADIUS".into(),
            param_value: 90.0,
            ..PARAM_VALUE_DATA::DEFAULT
        };
        assert_eq!(
            hear(MavMessage::PARAM_VALUE(radius), 1.1),
            (Some(4), Some(90.0))
        );
    }
}
