//! The switch of this component: a ping, a parameter and a command of the ground station.

use mavlink::dialects::ardupilotmega::{
    COMMAND_ACK_DATA, COMMAND_LONG_DATA, MavCmd, MavMessage, MavParamType, MavResult,
    PARAM_SET_DATA, PARAM_VALUE_DATA, PING_DATA,
};

use super::Companion;
use crate::number::single;
use crate::outgoing::OWN_COMPONENT;

/// Name of the switch among this component's parameters.
const ENABLE: &str = "FGA_ENABLE";

impl Companion {
    /// Requests to this component: ping, its switch as a parameter or a command.
    pub(super) fn take_request(
        &mut self,
        system: u8,
        component: u8,
        message: &MavMessage,
        now_s: f64,
    ) {
        let Some(own) = self.vehicle_system() else {
            return;
        };
        let for_us = |target_system: u8, target_component: u8| {
            target_system == own && target_component == OWN_COMPONENT
        };
        match message {
            MavMessage::PING(data) if data.target_system == 0 && data.target_component == 0 => {
                self.voice.send(MavMessage::PING(PING_DATA {
                    time_usec: data.time_usec,
                    seq: data.seq,
                    target_system: system,
                    target_component: component,
                }));
            }
            MavMessage::PARAM_REQUEST_LIST(data)
                if data.target_system == own
                    && (data.target_component == OWN_COMPONENT || data.target_component == 0) =>
            {
                self.send_switch();
            }
            MavMessage::PARAM_REQUEST_READ(data)
                if for_us(data.target_system, data.target_component) =>
            {
                self.send_switch();
            }
            MavMessage::PARAM_SET(data) if for_us(data.target_system, data.target_component) => {
                self.take_switch(system, data, now_s);
            }
            MavMessage::COMMAND_LONG(data) if for_us(data.target_system, data.target_component) => {
                let result = self.take_command(system, data, now_s);
                self.voice.send(MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
                    command: data.command,
                    result,
                    progress: 0,
                    result_param2: 0,
                    target_system: system,
                    target_component: component,
                }));
            }
            _ => {}
        }
    }

    /// Whether a system may arm and disarm this component: the ground station of the configuration,
    /// else the vehicle's.
    fn is_ground_station(&self, system: u8) -> bool {
        let ground = match self.config.link.ground_system_id {
            0 => self.requests.parameters().ground_system(),
            system_id => f64::from(system_id),
        };
        f64::from(system) == ground
    }

    fn take_switch(&mut self, system: u8, data: &PARAM_SET_DATA, now_s: f64) {
        if data.param_id.to_str() == Ok(ENABLE) && self.is_ground_station(system) {
            self.set_enabled(data.param_value > 0.5, now_s);
        }
        self.send_switch();
    }

    fn send_switch(&mut self) {
        let value = if self.keeper.is_enabled() { 1.0 } else { 0.0 };
        self.voice.send(MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
            param_value: single(value),
            param_count: 1,
            param_index: 0,
            param_id: ENABLE.into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        }));
    }

    fn take_command(&mut self, system: u8, data: &COMMAND_LONG_DATA, now_s: f64) -> MavResult {
        if data.command != MavCmd::MAV_CMD_USER_1 {
            return MavResult::MAV_RESULT_UNSUPPORTED;
        }
        if !self.is_ground_station(system) {
            return MavResult::MAV_RESULT_DENIED;
        }
        if data.param1 == 1.0 {
            self.set_enabled(true, now_s);
        } else if data.param1 == 0.0 {
            self.set_enabled(false, now_s);
        } else {
            return MavResult::MAV_RESULT_DENIED;
        }
        MavResult::MAV_RESULT_ACCEPTED
    }
}
